//! Assertion pragmas: they read the CPU without changing it.

use plcc_abi::RuntimeFn;
use plcc_diag::Span;
use plcc_ir::{Type, Value};
use plcc_model::s7200::{Assert, AssertSide, Operand, Width};
use plcc_model::{Compared, ComparedValue};

use super::block::S7200Lowering;

impl S7200Lowering<'_, '_> {
    /// `//@ assert`. An assertion whose pointer is bad is an error of the program, and fails by not being executed.
    pub fn assert(&mut self, assert: &Assert, span: Span) {
        let id = self.output.register_assert(assert, span);
        self.guarded(|lowering| {
            for (index, comparison) in assert.comparisons.iter().enumerate() {
                let mut value = |side: &Compared<AssertSide>| match &side.value {
                    ComparedValue::Constant(_) => None,
                    ComparedValue::Code(side) => Some(lowering.assert_side(side)),
                };
                let sides = [value(&comparison.left), value(&comparison.right)];
                let (function, values) = crate::assertion::call(&mut lowering.b, comparison, sides);
                let mut arguments = vec![lowering.b.i32_const(id), lowering.b.i32_const(index as u32)];
                arguments.extend(values);
                lowering.b.call_runtime(function, &arguments);
            }
        });
    }

    /// Value of one side, an i32.
    fn assert_side(&mut self, side: &AssertSide) -> Value {
        let value = match side {
            AssertSide::Operand(operand) => {
                let width = width_of(operand);
                self.read(operand, width)
            }
            AssertSide::Stack(level) => match self.stack.get(usize::from(*level)) {
                Some(&var) => self.get(var),
                None => self.b.bool_const(false),
            },
            AssertSide::Eno => self.get(self.eno),
        };
        if self.b.ty(value) == Type::I32 { value } else { self.b.zext(Type::I32, value) }
    }

    /// `//@ sleep N`.
    pub fn sleep(&mut self, ms: u32) {
        let ms = self.b.i32_const(ms);
        let stop = self.b.call_runtime(RuntimeFn::Sleep, &[ms]).expect("sleep has a result");
        self.stop_check(stop);
    }
}

/// The width with which an operand is written.
fn width_of(operand: &Operand) -> Width {
    match operand {
        Operand::Memory { width, .. }
        | Operand::Timer { width, .. }
        | Operand::Counter { width, .. }
        | Operand::Accumulator { width, .. }
        | Operand::Indirect { width, .. } => *width,
        Operand::AnalogInput { .. } | Operand::AnalogOutput { .. } => Width::Word,
        Operand::Const(_) | Operand::HighSpeedCounter(_) | Operand::Text(_) => Width::Dword,
    }
}
