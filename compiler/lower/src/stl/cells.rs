//! Counters, and what timers and counters share. Source: STL reference, timer and counter instructions.
//!
//! Cells are a region of their own, with the fields of `layout::timer_cell` and `layout::counter_cell`; counting
//! needs no call of the runtime.

use plcc_abi::codes::sync;
use plcc_abi::layout::{self, counter_cell, timer_cell};
use plcc_ir::{Address, BinaryOp, Block, IntCc, Region, Type, Value};
use plcc_model::{CellKind, Number, Operand, Width};

use crate::arithmetic::bcd::Bcd;
use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};

/// Largest count.
const COUNT_MAX: i64 = 999;

/// What an instruction reads of a timer or counter.
#[derive(Clone, Copy)]
pub enum CellRead {
    /// Not 0: the status is 1.
    Status,
    /// `L`: the remaining time in units of its base, or the count.
    Binary,
    /// `LC`: the same in BCD, for a timer with its base.
    Bcd,
}

/// The cell of a timer or counter that exists.
#[derive(Clone, Copy)]
pub struct Cell {
    /// Its number, an i32.
    pub number: Value,
    /// Distance of a cell whose number is not known from the first cell of its kind.
    distance: Option<Value>,
    start: u32,
}

impl Cell {
    /// The place of a field.
    pub fn field(self, field: u32) -> Address {
        Address { region: Region::Cells, base: self.distance, offset: self.start + field }
    }
}

impl BlockLowering<'_, '_> {
    /// A number known at compile time or run time, an i32.
    pub fn number(&mut self, number: &Number) -> Value {
        match number {
            Number::Known(number) => self.b.i32_const(u32::from(*number)),
            Number::Word(place) => self.read(place, Width::Word),
            Number::Parameter(parameter) => self.parameters[*parameter][0],
        }
    }

    /// The cell, on the path where the CPU has it.
    pub fn begin_cell(&mut self, kind: CellKind, number: &Number, substitute: Substitute) -> (Cell, Option<Block>) {
        let profile = &self.plan.program.profile;
        let (count, code, start, bytes) = match kind {
            CellKind::Timer => (profile.timers, sync::TIMER_NUMBER, 0, layout::TIMER_CELL_BYTES),
            CellKind::Counter => {
                (profile.counters, sync::COUNTER_NUMBER, layout::C - layout::T, layout::COUNTER_CELL_BYTES)
            }
        };
        let value = self.number(number);
        if let Number::Known(number) = number {
            // Checked when bound.
            let start = start + bytes * u32::from(*number);
            return (Cell { number: value, distance: None, start }, None);
        }
        let ok = self.b.icmp_imm(IntCc::Ult, value, i64::from(count));
        let code = self.b.i32_const(u32::from(code));
        let access = self.b.i32_const(0);
        let guard = self.begin_guard(vec![Check { ok, code, access, info: value, db: None }], substitute);
        let distance = self.b.binary_imm(BinaryOp::Shl, value, i64::from(bytes.ilog2()));
        (Cell { number: value, distance: Some(distance), start }, guard)
    }

    /// What `read` reads of the cell, an i32.
    pub fn cell_value(&mut self, kind: CellKind, number: &Number, read: CellRead) -> Value {
        let (cell, guard) = self.begin_cell(kind, number, Substitute::Word);
        let value = match kind {
            CellKind::Timer => self.timer_read(cell, read),
            CellKind::Counter => self.counter_read(cell, read),
        };
        if guard.is_none() {
            return value;
        }
        self.set(self.result, value);
        self.end_guard(guard);
        self.get(self.result)
    }

    fn counter_read(&mut self, cell: Cell, read: CellRead) -> Value {
        let count = self.b.load(Type::I16, cell.field(counter_cell::COUNT));
        let count = self.b.zext(Type::I32, count);
        match read {
            CellRead::Status | CellRead::Binary => count,
            CellRead::Bcd => Bcd::WORD.digits_of_small(&mut self.b, count),
        }
    }

    /// Status of a timer or counter, an i1. That of a counter: its count is not 0.
    pub fn cell_scan(&mut self, kind: CellKind, number: &Number) -> Value {
        let value = self.cell_value(kind, number, CellRead::Status);
        self.b.icmp_imm(IntCc::Ne, value, 0)
    }

    /// `LC`.
    pub fn load_bcd(&mut self, operand: &Operand) {
        let Operand::Cell { kind, number } = operand else {
            unreachable!("the binder only passes timers and counters");
        };
        let value = self.cell_value(*kind, number, CellRead::Bcd);
        self.load_accu1(value);
    }

    /// Takes the RLO into the edge memory at `edge`. Result: i8, 1 on a rising edge.
    fn rising(&mut self, edge: Address) -> Value {
        let old = self.b.load(Type::I8, edge);
        let rlo = self.rlo();
        let new = self.b.zext(Type::I8, rlo);
        self.b.store(edge, new);
        let was_off = self.b.binary_imm(BinaryOp::Xor, old, 1);
        self.b.and(new, was_off)
    }

    /// `CU`, or `CD` if not `up`.
    pub fn count(&mut self, operand: &Operand, up: bool) {
        let Operand::Cell { kind, number } = operand else { return };
        let (cell, guard) = self.begin_cell(*kind, number, Substitute::None);
        let edge = if up { counter_cell::UP_EDGE } else { counter_cell::DOWN_EDGE };
        let rising = self.rising(cell.field(edge));
        let count = self.b.load(Type::I16, cell.field(counter_cell::COUNT));
        let end = if up { COUNT_MAX } else { 0 };
        let free = self.b.icmp_imm(IntCc::Ne, count, end);
        let free = self.b.zext(Type::I8, free);
        let step = self.b.and(rising, free);
        let step = self.b.zext(Type::I16, step);
        let counted = self.b.binary(if up { BinaryOp::Iadd } else { BinaryOp::Isub }, count, step);
        self.b.store(cell.field(counter_cell::COUNT), counted);
        self.end_guard(guard);
        self.end_logic_string();
    }

    /// `S C n`: an invalid digit is an error on a rising edge, which then is still to come.
    pub fn counter_set(&mut self, number: &Number) {
        let (cell, guard) = self.begin_cell(CellKind::Counter, number, Substitute::None);
        let (accu1, rlo) = (self.accu1(), self.rlo());
        let (preset, valid) = Bcd::WORD.magnitude(&mut self.b, accu1);
        let edge = self.b.load(Type::I8, cell.field(counter_cell::SET_EDGE));
        let was_on = self.b.icmp_imm(IntCc::Ne, edge, 0);
        let off = self.b.not(rlo);
        let stays = self.b.or(was_on, off);
        let ok = self.b.or(valid, stays);
        let check = self.bcd_check(ok);
        let inner = self.begin_guard(vec![check], Substitute::None);
        let rising = self.rising(cell.field(counter_cell::SET_EDGE));
        let rising = self.b.icmp_imm(IntCc::Ne, rising, 0);
        let count = self.b.load(Type::I16, cell.field(counter_cell::COUNT));
        let preset = self.b.trunc(Type::I16, preset);
        let count = self.b.select(rising, preset, count);
        self.b.store(cell.field(counter_cell::COUNT), count);
        self.end_guard(inner);
        self.end_guard(guard);
        self.end_logic_string();
    }

    /// `R T n`, `R C n`: while the RLO is 1; the edge memories stay.
    pub fn cell_reset(&mut self, kind: CellKind, number: &Number) {
        let (cell, guard) = self.begin_cell(kind, number, Substitute::None);
        match kind {
            CellKind::Timer => self.timer_reset(cell),
            CellKind::Counter => {
                let rlo = self.rlo();
                let count = self.b.load(Type::I16, cell.field(counter_cell::COUNT));
                let zero = self.b.iconst(Type::I16, 0);
                let count = self.b.select(rlo, zero, count);
                self.b.store(cell.field(counter_cell::COUNT), count);
            }
        }
        self.end_guard(guard);
        self.end_logic_string();
    }

    /// `FR`: a rising edge of the RLO clears the edge memories of the start instruction, or of CU, CD and S.
    pub fn cell_enable(&mut self, operand: &Operand) {
        let Operand::Cell { kind, number } = operand else { return };
        let (cell, guard) = self.begin_cell(*kind, number, Substitute::None);
        let (enable, edges): (u32, &[u32]) = match kind {
            CellKind::Timer => (timer_cell::ENABLE_EDGE, &[timer_cell::START_EDGE]),
            CellKind::Counter => {
                (counter_cell::ENABLE_EDGE, &[counter_cell::UP_EDGE, counter_cell::DOWN_EDGE, counter_cell::SET_EDGE])
            }
        };
        let rising = self.rising(cell.field(enable));
        let kept = self.b.binary_imm(BinaryOp::Xor, rising, 1);
        for &edge in edges {
            let old = self.b.load(Type::I8, cell.field(edge));
            let new = self.b.and(old, kept);
            self.b.store(cell.field(edge), new);
        }
        self.end_guard(guard);
        self.end_logic_string();
    }
}
