//! Logical operations. They only write SM1.0. Source: S7-200 system manual, logical operations.

use plcc_ir::{BinaryOp, IntCc, Value};
use plcc_model::s7200::{Operand, Width};

use super::block::S7200Lowering;
use super::math::ZERO;
use super::operand::Place;

impl S7200Lowering<'_, '_> {
    /// `ANDW` and other operations with two operands.
    pub fn word_logic(&mut self, operands: &[Operand], width: Width, op: BinaryOp) {
        let [input, output] = operands else { return };
        self.boxed(|lowering| {
            let input = lowering.read(input, width);
            let target = lowering.target(output, width);
            let old = lowering.load(target, width);
            let result = lowering.b.binary(op, old, input);
            lowering.finish_logic(target, width, result);
        });
    }

    /// `INVW` and other inversions.
    pub fn invert(&mut self, operands: &[Operand], width: Width) {
        self.boxed(|lowering| {
            let target = lowering.target(&operands[0], width);
            let old = lowering.load(target, width);
            let result = lowering.b.binary_imm(BinaryOp::Xor, old, -1);
            lowering.finish_logic(target, width, result);
        });
    }

    /// Stores a result; SM1.0 shows whether it is 0.
    pub fn finish_logic(&mut self, target: Place, width: Width, result: Value) {
        self.store(target, width, result);
        let zero = self.b.icmp_imm(IntCc::Eq, result, 0);
        self.set_flag(ZERO, zero);
    }
}
