//! S5 timers. Source: STL reference, timer instructions.
//!
//! A running timer has the time at which it ends, on a clock that counts down; at rest that time is 0, to which the clock never
//! comes. So one comparison tells that there is nothing to do, and what is in the cell is up to date:
//!
//! ```text
//! v1 = load.i64 state 32      ; COUNTDOWN
//! v2 = load.i64 cells 160     ; END of T 5
//! v3 = icmp uge v2, v1        ; else the status is that in the cell
//! ```
//!
//! Otherwise the runtime renews the cell first (`timer_settle`). Under the real clock COUNTDOWN is `ASK`, so that it always does
//! this for a running timer, and starts all timers (`timer_start`).

use plcc_abi::RuntimeFn;
use plcc_abi::functions::TimerMode;
use plcc_abi::layout::{state, timer_cell};
use plcc_ir::{Address, BinaryOp, Block, IntCc, Region, Type, Value};
use plcc_model::{CellKind, Operand};
use plcc_syntax::stl::StlInsn;

use super::cells::{Cell, CellRead};
use crate::arithmetic::bcd::Bcd;
use crate::block::BlockLowering;
use crate::fault::Substitute;

/// What an edge of the RLO does.
#[derive(Clone, Copy)]
enum Action {
    /// Loads the time and runs with this status; `None`: with the one it has.
    Run(Option<bool>),
    /// Stops with this status and keeps the remaining time.
    Freeze(bool),
    Nothing,
}

/// What rising and falling edges do.
fn actions(mode: TimerMode) -> (Action, Action) {
    match mode {
        TimerMode::Pulse => (Action::Run(Some(true)), Action::Freeze(false)),
        TimerMode::ExtendedPulse => (Action::Run(Some(true)), Action::Nothing),
        TimerMode::OnDelay => (Action::Run(Some(false)), Action::Freeze(false)),
        TimerMode::RetentiveOnDelay => (Action::Run(None), Action::Nothing),
        TimerMode::OffDelay => (Action::Freeze(true), Action::Run(Some(true))),
    }
}

/// Status of a timer whose time is over.
fn is_on_after(mode: TimerMode) -> bool {
    matches!(mode, TimerMode::OnDelay | TimerMode::RetentiveOnDelay)
}

/// A start instruction whose time is known at compile time.
struct Start {
    cell: Cell,
    mode: TimerMode,
    /// The S5TIME, and RLO, each an i32, as the runtime wants them.
    value: Value,
    rlo: Value,
    /// The RLO as edge memory, an i8.
    edge: Value,
    units: u32,
    base: u32,
    after: Block,
}

impl BlockLowering<'_, '_> {
    /// What `read` reads of a timer, an i32.
    pub(super) fn timer_read(&mut self, cell: Cell, read: CellRead) -> Value {
        let due = match read {
            CellRead::Status => timer_cell::END,
            CellRead::Binary | CellRead::Bcd => timer_cell::STEP,
        };
        self.settle_if_due(cell, due);
        let info = self.b.load(Type::I32, cell.field(timer_cell::INFO));
        match read {
            CellRead::Status => self.b.binary_imm(BinaryOp::And, info, i64::from(timer_cell::STATUS)),
            CellRead::Binary => self.b.binary_imm(BinaryOp::And, info, 0xFFFF),
            CellRead::Bcd => {
                let units = self.b.binary_imm(BinaryOp::And, info, 0xFFFF);
                let digits = Bcd::WORD.digits_of_small(&mut self.b, units);
                let base = self.b.binary_imm(BinaryOp::Lshr, info, i64::from(timer_cell::BASE_SHIFT - 12));
                let base = self.b.binary_imm(BinaryOp::And, base, 0x3000);
                self.b.or(base, digits)
            }
        }
    }

    fn countdown(&mut self) -> Value {
        self.b.load(Type::I64, Address::direct(Region::State, state::COUNTDOWN))
    }

    /// Renews the cell if the moment in its field `due` has come.
    fn settle_if_due(&mut self, cell: Cell, due: u32) {
        let due = self.b.load(Type::I64, cell.field(due));
        let countdown = self.countdown();
        let is_due = self.b.icmp(IntCc::Uge, due, countdown);
        let (settle, after) = (self.b.create_cold_block(), self.b.create_block());
        self.b.branch(is_due, settle, after);
        self.b.seal_block(settle);
        self.b.switch_to(settle);
        self.b.call_runtime(RuntimeFn::TimerSettle, &[cell.number]);
        self.go_on(after);
    }

    /// Jumps to `after`, to which all jumps are now built, and goes on there.
    fn go_on(&mut self, after: Block) {
        self.b.jump(after, &[]);
        self.b.seal_block(after);
        self.b.switch_to(after);
    }

    /// `SP SE SD SS SF`.
    pub fn timer_start(&mut self, insn: StlInsn, operand: &Operand) {
        let mode = match insn {
            StlInsn::TimerPulse => TimerMode::Pulse,
            StlInsn::TimerExtendedPulse => TimerMode::ExtendedPulse,
            StlInsn::TimerOnDelay => TimerMode::OnDelay,
            StlInsn::TimerRetentiveOnDelay => TimerMode::RetentiveOnDelay,
            _ => TimerMode::OffDelay,
        };
        let Operand::Cell { number, .. } = operand else { return };
        let (cell, guard) = self.begin_cell(CellKind::Timer, number, Substitute::None);
        let (accu1, rlo) = (self.accu1(), self.rlo());
        let value = self.b.binary_imm(BinaryOp::And, accu1, 0xFFFF);
        let (units, valid) = Bcd::WORD.magnitude(&mut self.b, value);
        let mut ok = valid;
        if mode == TimerMode::OnDelay {
            // SD with RLO 0 stops, whatever the value: an invalid one shows in OV only.
            let old = self.get(self.regs.ov);
            let invalid = self.b.not(valid);
            let ov = self.b.select(rlo, old, invalid);
            self.set(self.regs.ov, ov);
            let off = self.b.not(rlo);
            ok = self.b.or(valid, off);
        }
        let check = self.bcd_check(ok);
        let inner = self.begin_guard(vec![check], Substitute::None);
        let known = match (self.b.constant_bits(value), self.b.constant_bits(units), self.b.constant_bits(valid)) {
            (Some(value), Some(units), Some(1)) => Some((units as u32, value as u32 >> 12 & 3)),
            _ => None,
        };
        self.start_by_edge(cell, mode, value, rlo, known);
        self.end_guard(inner);
        self.end_guard(guard);
        self.end_logic_string();
    }

    /// The start; `known` are units and base, if they are known.
    fn start_by_edge(&mut self, cell: Cell, mode: TimerMode, value: Value, rlo: Value, known: Option<(u32, u32)>) {
        let old = self.b.load(Type::I8, cell.field(timer_cell::START_EDGE));
        let edge = self.b.zext(Type::I8, rlo);
        let changed = self.b.icmp(IntCc::Ne, old, edge);
        let (change, after) = (self.b.create_block(), self.b.create_block());
        self.b.branch(changed, change, after);
        self.b.seal_block(change);
        self.b.switch_to(change);
        let wide = self.b.zext(Type::I32, rlo);
        let Some((units, base)) = known else {
            self.start_in_runtime(cell, mode, value, wide);
            return self.go_on(after);
        };
        let start = Start { cell, mode, value, rlo: wide, edge, units, base, after };
        let (on_rising, on_falling) = actions(mode);
        let (rising, falling) = (self.b.create_block(), self.b.create_block());
        self.b.branch(rlo, rising, falling);
        for (block, action) in [(rising, on_rising), (falling, on_falling)] {
            self.b.seal_block(block);
            self.b.switch_to(block);
            self.act(&start, action);
            self.b.jump(after, &[]);
        }
        self.b.seal_block(after);
        self.b.switch_to(after);
    }

    fn start_in_runtime(&mut self, cell: Cell, mode: TimerMode, value: Value, rlo: Value) {
        let mode = self.b.i32_const(mode as u32);
        self.b.call_runtime(RuntimeFn::TimerStart, &[cell.number, mode, value, rlo]);
    }

    /// Does `action` and takes the RLO over.
    fn act(&mut self, start: &Start, action: Action) {
        match action {
            Action::Run(status) => self.run_timer(start, status),
            Action::Freeze(status) => {
                self.settle_if_due(start.cell, timer_cell::STEP);
                self.stop_timer(start.cell);
                let info_at = start.cell.field(timer_cell::INFO);
                let info = self.b.load(Type::I32, info_at);
                let kept = self.b.binary_imm(BinaryOp::And, info, i64::from(timer_cell::STATUS - 1));
                let status = if status { timer_cell::STATUS } else { 0 };
                let info = self.b.binary_imm(BinaryOp::Or, kept, i64::from(status));
                self.b.store(info_at, info);
            }
            Action::Nothing => {}
        }
        self.b.store(start.cell.field(timer_cell::START_EDGE), start.edge);
    }

    fn run_timer(&mut self, start: &Start, status: Option<bool>) {
        let cell = start.cell;
        let is_on_after = is_on_after(start.mode);
        let after = if is_on_after { timer_cell::STATUS_AFTER } else { 0 };
        let info = start.units | start.base << timer_cell::BASE_SHIFT | after;
        if start.units == 0 {
            // Over at once.
            self.stop_timer(cell);
            let info = self.b.i32_const(info | if is_on_after { timer_cell::STATUS } else { 0 });
            return self.b.store(cell.field(timer_cell::INFO), info);
        }
        let countdown = self.countdown();
        let asks = self.b.icmp_imm(IntCc::Eq, countdown, state::ASK as i64);
        let (ask, go) = (self.b.create_cold_block(), self.b.create_block());
        self.b.branch(asks, ask, go);
        self.b.seal_block(ask);
        self.b.switch_to(ask);
        self.start_in_runtime(cell, start.mode, start.value, start.rlo);
        self.b.jump(start.after, &[]);
        self.b.seal_block(go);
        self.b.switch_to(go);
        let info = match status {
            Some(status) => self.b.i32_const(info | if status { timer_cell::STATUS } else { 0 }),
            None => {
                let status = self.status_now(cell, countdown);
                self.b.binary_imm(BinaryOp::Or, status, i64::from(info))
            }
        };
        self.b.store(cell.field(timer_cell::INFO), info);
        let unit = 10_000_000 * 10i64.pow(start.base);
        for (field, units) in [(timer_cell::END, start.units), (timer_cell::STEP, 1)] {
            let time = self.b.iconst(Type::I64, unit * i64::from(units));
            let moment = self.b.isub(countdown, time);
            self.b.store(cell.field(field), moment);
        }
    }

    /// `STATUS` if the status is 1 at `countdown`, else 0.
    fn status_now(&mut self, cell: Cell, countdown: Value) -> Value {
        let end = self.b.load(Type::I64, cell.field(timer_cell::END));
        let is_over = self.b.icmp(IntCc::Uge, end, countdown);
        let info = self.b.load(Type::I32, cell.field(timer_cell::INFO));
        let after = self.b.binary_imm(BinaryOp::Lshr, info, 1);
        let status = self.b.select(is_over, after, info);
        self.b.binary_imm(BinaryOp::And, status, i64::from(timer_cell::STATUS))
    }

    /// From now on nothing is due.
    fn stop_timer(&mut self, cell: Cell) {
        let zero = self.b.iconst(Type::I64, 0);
        self.b.store(cell.field(timer_cell::END), zero);
        self.b.store(cell.field(timer_cell::STEP), zero);
    }

    /// `R T n`: stops, and clears value, base and status.
    pub(super) fn timer_reset(&mut self, cell: Cell) {
        let rlo = self.rlo();
        let (reset, after) = (self.b.create_block(), self.b.create_block());
        self.b.branch(rlo, reset, after);
        self.b.seal_block(reset);
        self.b.switch_to(reset);
        self.stop_timer(cell);
        let zero = self.b.i32_const(0);
        self.b.store(cell.field(timer_cell::INFO), zero);
        self.go_on(after);
    }
}
