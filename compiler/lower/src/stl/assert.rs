//! Assertion pragmas: they read the CPU state without changing it.

use plcc_abi::RuntimeFn;
use plcc_diag::Span;
use plcc_ir::{Type, Value};
use plcc_model::{Assert, AssertRegister, AssertSide, CellKind, Compared, ComparedValue, Operand, Place, Width};

use super::cells::CellRead;
use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};
use crate::place::{Direction, TargetKind};

impl BlockLowering<'_, '_> {
    pub fn assert(&mut self, assert: &Assert, span: Span) {
        let id = self.output.register_assert(assert, span);
        for (index, comparison) in assert.comparisons.iter().enumerate() {
            // A fully qualified address opens its DB, which an assertion must not.
            let db = self.get(self.regs.db);
            let mut checks = Vec::new();
            let left = self.compared(&comparison.left, &mut checks);
            let right = self.compared(&comparison.right, &mut checks);
            self.set(self.regs.db, db);
            let guard = self.begin_guard(checks, Substitute::None);
            let (function, values) = crate::assertion::call(&mut self.b, comparison, [left, right]);
            let mut arguments = vec![self.b.i32_const(id), self.b.i32_const(index as u32)];
            arguments.extend(values);
            self.b.call_runtime(function, &arguments);
            self.end_guard(guard);
        }
    }

    /// The value that code supplies for a side.
    fn compared(&mut self, side: &Compared<AssertSide>, checks: &mut Vec<Check>) -> Option<Value> {
        match &side.value {
            ComparedValue::Constant(_) => None,
            ComparedValue::Code(AssertSide::Memory(place)) => Some(self.where_is(place, checks)),
            ComparedValue::Code(side) => Some(self.assert_side(side)),
        }
    }

    /// Offset of a place from the memory base.
    fn where_is(&mut self, place: &Place, checks: &mut Vec<Check>) -> Value {
        let target = self.target(place, Width::Byte, Direction::Read);
        checks.extend(target.checks);
        match target.kind {
            TargetKind::Memory { addr, .. } | TargetKind::Either { addr, .. } => self.b.address_of(addr),
            TargetKind::Peripheral { .. } => unreachable!("the binder only passes places in memory"),
        }
    }

    /// Value of one side, an i32 or i64.
    fn assert_side(&mut self, side: &AssertSide) -> Value {
        match side {
            AssertSide::Operand(Operand::Memory { place, width: Width::Bit }) => {
                let bit = self.read(place, Width::Bit);
                self.b.zext(Type::I32, bit)
            }
            // A timer or counter alone is its status bit.
            AssertSide::Operand(Operand::Cell { kind, number }) => {
                let bit = self.cell_scan(*kind, number);
                self.b.zext(Type::I32, bit)
            }
            AssertSide::Operand(operand) => self.load_value(operand),
            AssertSide::CellValue { kind, number } => {
                let read = match kind {
                    CellKind::Timer => CellRead::Bcd,
                    CellKind::Counter => CellRead::Binary,
                };
                self.cell_value(*kind, number, read)
            }
            AssertSide::Memory(_) => unreachable!("its place is used instead"),
            AssertSide::Register(register) => self.assert_register(*register),
        }
    }

    fn assert_register(&mut self, register: AssertRegister) -> Value {
        let var = match register {
            AssertRegister::Accu(number) => self.regs.accu[usize::from(number - 1) & 3],
            AssertRegister::Ar1 => self.regs.ar[0],
            AssertRegister::Ar2 => self.regs.ar[1],
            AssertRegister::Stw => return self.status_word(true),
            AssertRegister::Br => self.regs.br,
            AssertRegister::Cc1 => self.regs.cc1,
            AssertRegister::Cc0 => self.regs.cc0,
            AssertRegister::Ov => self.regs.ov,
            AssertRegister::Os => self.regs.os,
            AssertRegister::Or => self.regs.or_,
            AssertRegister::Sta => self.regs.sta,
            AssertRegister::Rlo => self.regs.rlo,
            AssertRegister::Fc => self.regs.fc,
            AssertRegister::DbNumber => self.regs.db,
            AssertRegister::DiNumber => self.regs.di,
        };
        let value = self.get(var);
        self.b.zext(Type::I32, value)
    }

    /// `//@ sleep N`.
    pub fn sleep(&mut self, ms: u32) {
        let ms = self.b.i32_const(ms);
        let stop = self.b.call_runtime(RuntimeFn::Sleep, &[ms]).expect("sleep has a result");
        self.stop_check(stop);
    }
}
