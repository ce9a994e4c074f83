//! S5 timers. Source: STL reference, timer instructions.
//!
//! A running timer has the time at which it ends, on a clock that counts down; at rest that time is 0, which the
//! clock never reaches. So one comparison tells that there is nothing to do, and what is in the cell is up to date:
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

/// The start of a timer.
#[derive(Clone, Copy)]
struct Start {
    cell: Cell,
    mode: TimerMode,
    /// The S5TIME, an i32.
    value: Value,
    /// An i1.
    rlo: Value,
    /// Units and base of the S5TIME, i32.
    units: Value,
    base: Value,
}

/// What a start or stop writes into the cell.
struct Fields {
    end: Value,
    step: Value,
    info: Value,
}

/// Status of a timer whose time is over.
fn is_on_after(mode: TimerMode) -> bool {
    matches!(mode, TimerMode::OnDelay | TimerMode::RetentiveOnDelay)
}

/// `STATUS` as it is in INFO.
fn status_bit(status: bool) -> u32 {
    if status { timer_cell::STATUS } else { 0 }
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
        let base = self.b.binary_imm(BinaryOp::Lshr, value, 12);
        let base = self.b.binary_imm(BinaryOp::And, base, 3);
        self.start_by_edge(Start { cell, mode, value, rlo, units, base });
        self.end_guard(inner);
        self.end_guard(guard);
        self.end_logic_string();
    }

    fn start_in_runtime(&mut self, cell: Cell, mode: TimerMode, value: Value, rlo: Value) {
        let mode = self.b.i32_const(mode as u32);
        let rlo = self.b.zext(Type::I32, rlo);
        self.b.call_runtime(RuntimeFn::TimerStart, &[cell.number, mode, value, rlo]);
    }

    /// Begins the path on which `condition` holds. Result: where it ends, for [`BlockLowering::go_on`].
    fn begin_when(&mut self, condition: Value) -> Block {
        let (then, after) = (self.b.create_block(), self.b.create_block());
        self.b.branch(condition, then, after);
        self.b.seal_block(then);
        self.b.switch_to(then);
        after
    }

    /// Acts on an edge. Both edges of a timer are one path, since what comes next in a program is often hard to foresee.
    fn start_by_edge(&mut self, start: Start) {
        let edge_at = start.cell.field(timer_cell::START_EDGE);
        let old = self.b.load(Type::I8, edge_at);
        let edge = self.b.zext(Type::I8, start.rlo);
        // The status that stopping gives, if an edge stops.
        let stopped = match start.mode {
            TimerMode::Pulse | TimerMode::OnDelay => Some(false),
            TimerMode::OffDelay => Some(true),
            TimerMode::ExtendedPulse | TimerMode::RetentiveOnDelay => None,
        };
        let Some(stopped) = stopped else {
            let was_off = self.b.icmp_imm(IntCc::Eq, old, 0);
            let rising = self.b.and(start.rlo, was_off);
            let after = self.begin_when(rising);
            let run = self.run_fields(&start, after);
            self.set_fields(start.cell, &run);
            self.go_on(after);
            return self.b.store(edge_at, edge);
        };
        let changed = self.b.icmp(IntCc::Ne, old, edge);
        let after = self.begin_when(changed);
        let run = self.run_fields(&start, after);
        self.settle_if_due(start.cell, timer_cell::STEP);
        let stop = self.stop_fields(start.cell, stopped);
        let stops_on_rising = start.mode == TimerMode::OffDelay;
        let (rising, falling) = if stops_on_rising { (stop, run) } else { (run, stop) };
        let fields = Fields {
            end: self.b.select(start.rlo, rising.end, falling.end),
            step: self.b.select(start.rlo, rising.step, falling.step),
            info: self.b.select(start.rlo, rising.info, falling.info),
        };
        self.set_fields(start.cell, &fields);
        self.b.store(edge_at, edge);
        self.go_on(after);
    }

    fn set_fields(&mut self, cell: Cell, fields: &Fields) {
        self.b.store(cell.field(timer_cell::END), fields.end);
        self.b.store(cell.field(timer_cell::STEP), fields.step);
        self.b.store(cell.field(timer_cell::INFO), fields.info);
    }

    /// Stopped with `status`; the remaining time stays.
    fn stop_fields(&mut self, cell: Cell, status: bool) -> Fields {
        let info = self.b.load(Type::I32, cell.field(timer_cell::INFO));
        let kept = self.b.binary_imm(BinaryOp::And, info, i64::from(timer_cell::STATUS - 1));
        let info = self.b.binary_imm(BinaryOp::Or, kept, i64::from(status_bit(status)));
        let never = self.b.iconst(Type::I64, 0);
        Fields { end: never, step: never, info }
    }

    /// Started. Under the real clock the runtime does what the edge asks for, and the path ends at `after`.
    fn run_fields(&mut self, start: &Start, after: Block) -> Fields {
        let is_on_after = is_on_after(start.mode);
        let status_after = if is_on_after { timer_cell::STATUS_AFTER } else { 0 };
        let base = self.b.binary_imm(BinaryOp::Shl, start.base, i64::from(timer_cell::BASE_SHIFT));
        let info = self.b.or(start.units, base);
        let info = self.b.binary_imm(BinaryOp::Or, info, i64::from(status_after));
        let is_over = self.b.icmp_imm(IntCc::Eq, start.units, 0);
        let is_known = self.b.constant_bits(is_over);
        if is_known == Some(1) {
            return self.fields_at_once(info, is_on_after);
        }
        let countdown = self.countdown();
        let asks = self.b.icmp_imm(IntCc::Eq, countdown, state::ASK as i64);
        let (ask, go) = (self.b.create_cold_block(), self.b.create_block());
        self.b.branch(asks, ask, go);
        self.b.seal_block(ask);
        self.b.switch_to(ask);
        self.start_in_runtime(start.cell, start.mode, start.value, start.rlo);
        self.b.jump(after, &[]);
        self.b.seal_block(go);
        self.b.switch_to(go);
        let running = match start.mode {
            TimerMode::Pulse | TimerMode::ExtendedPulse | TimerMode::OffDelay => {
                self.b.binary_imm(BinaryOp::Or, info, i64::from(timer_cell::STATUS))
            }
            TimerMode::OnDelay => info,
            TimerMode::RetentiveOnDelay => {
                let status = self.status_now(start.cell, countdown);
                self.b.or(status, info)
            }
        };
        let unit = self.unit(start.base);
        let units = self.b.zext(Type::I64, start.units);
        let time = self.b.binary(BinaryOp::Imul, unit, units);
        let fields = Fields { end: self.b.isub(countdown, time), step: self.b.isub(countdown, unit), info: running };
        if is_known == Some(0) {
            return fields;
        }
        let over = self.fields_at_once(info, is_on_after);
        Fields {
            end: self.b.select(is_over, over.end, fields.end),
            step: self.b.select(is_over, over.step, fields.step),
            info: self.b.select(is_over, over.info, fields.info),
        }
    }

    /// Of a time of 0: over at once.
    fn fields_at_once(&mut self, info: Value, is_on_after: bool) -> Fields {
        let never = self.b.iconst(Type::I64, 0);
        let info = self.b.binary_imm(BinaryOp::Or, info, i64::from(status_bit(is_on_after)));
        Fields { end: never, step: never, info }
    }

    /// Nanoseconds of a unit, an i64: 10 ms, 100 ms, 1 s or 10 s.
    fn unit(&mut self, base: Value) -> Value {
        let unit = |base: u32| 10_000_000 * 10i64.pow(base);
        if let Some(base) = self.b.constant_bits(base) {
            return self.b.iconst(Type::I64, unit(base as u32));
        }
        let [odd, upper] = [1, 2].map(|bit| {
            let bit = self.b.binary_imm(BinaryOp::And, base, bit);
            self.b.icmp_imm(IntCc::Ne, bit, 0)
        });
        let [unit_0, unit_1, unit_2, unit_3] = [0, 1, 2, 3].map(|base| self.b.iconst(Type::I64, unit(base)));
        let (lower_units, upper_units) = (self.b.select(odd, unit_1, unit_0), self.b.select(odd, unit_3, unit_2));
        self.b.select(upper, upper_units, lower_units)
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

    /// `R T n`: stops, and clears value, base and status.
    pub(super) fn timer_reset(&mut self, cell: Cell) {
        let rlo = self.rlo();
        let after = self.begin_when(rlo);
        let never = self.b.iconst(Type::I64, 0);
        let info = self.b.i32_const(0);
        self.set_fields(cell, &Fields { end: never, step: never, info });
        self.go_on(after);
    }
}
