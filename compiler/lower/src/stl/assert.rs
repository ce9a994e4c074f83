//! Assertion pragmas: they look at the CPU state without touching it.

use plcc_abi::RuntimeFn;
use plcc_diag::Span;
use plcc_ir::{Type, Value};
use plcc_program::model::{Assert, AssertRegister, AssertSide, CellKind, Operand, Width};

use crate::context::Context;

impl Context<'_, '_> {
    pub fn assert(&mut self, assert: &Assert, span: Span) {
        let id = self.output.register_assert(assert, span);
        // A fully qualified address opens its DB, which an assertion must not.
        let db = self.get(self.regs.db);
        let left = self.assert_side(&assert.left);
        let right = self.assert_side(&assert.right);
        self.set(self.regs.db, db);
        let id = self.b.i32_const(id);
        self.b.call_runtime(RuntimeFn::Assert, &[id, left, right]);
    }

    /// Value of one side, an i32.
    fn assert_side(&mut self, side: &AssertSide) -> Value {
        match side {
            AssertSide::Operand(Operand::Memory { place, width: Width::Bit }) => {
                let bit = self.read(place, Width::Bit);
                self.b.zext(Type::I32, bit)
            }
            // A timer or counter alone is its status bit.
            AssertSide::Operand(Operand::Cell { kind, number }) => {
                let bit = match kind {
                    CellKind::Timer => self.timer_scan(number),
                    CellKind::Counter => self.counter_scan(number),
                };
                self.b.zext(Type::I32, bit)
            }
            AssertSide::Operand(operand) => self.load_value(operand),
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
