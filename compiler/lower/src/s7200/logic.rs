//! Logical operations. They only write SM1.0. Source: S7-200 system manual, logical operations.

use plcc_ir::{BinaryOp, IntCc, Value};
use plcc_model::s7200::{Operand, Width};

use super::context::Context;
use super::math::ZERO;
use super::operand::Place;

impl Context<'_, '_> {
    /// `ANDW` and other operations with two operands.
    pub fn word_logic(&mut self, operands: &[Operand], width: Width, op: BinaryOp) {
        let [input, output] = operands else { return };
        self.boxed(|context| {
            let input = context.read(input, width);
            let target = context.target(output, width);
            let old = context.load(target, width);
            let result = context.b.binary(op, old, input);
            context.finish_logic(target, width, result);
        });
    }

    /// `INVW` and other inversions.
    pub fn invert(&mut self, operands: &[Operand], width: Width) {
        self.boxed(|context| {
            let target = context.target(&operands[0], width);
            let old = context.load(target, width);
            let result = context.b.binary_imm(BinaryOp::Xor, old, -1);
            context.finish_logic(target, width, result);
        });
    }

    /// Stores a result; SM1.0 shows whether it is 0.
    pub fn finish_logic(&mut self, target: Place, width: Width, result: Value) {
        self.store(target, width, result);
        let zero = self.b.icmp_imm(IntCc::Eq, result, 0);
        self.set_flag(ZERO, zero);
    }
}
