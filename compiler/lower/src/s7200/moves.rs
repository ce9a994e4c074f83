//! Moves. Source: S7-200 system manual, move instructions.

use plcc_abi::RuntimeFn;
use plcc_ir::{Type, UnaryOp};
use plcc_model::s7200::{Operand, Width};

use super::block::S7200Lowering;

impl S7200Lowering<'_, '_> {
    /// `MOVB MOVW MOVD MOVR`.
    pub fn copy_value(&mut self, operands: &[Operand], width: Width) {
        let [input, output] = operands else { return };
        self.boxed(|lowering| {
            let value = lowering.read(input, width);
            let target = lowering.target(output, width);
            lowering.store(target, width, value);
        });
    }

    /// `SWAP`.
    pub fn swap(&mut self, operands: &[Operand]) {
        self.boxed(|lowering| {
            let target = lowering.target(&operands[0], Width::Word);
            let old = lowering.load(target, Width::Word);
            let swapped = lowering.b.unary(UnaryOp::Bswap, old);
            lowering.store(target, Width::Word, swapped);
        });
    }

    /// `BIR`: the image does not change.
    pub fn read_input_now(&mut self, operands: &[Operand]) {
        let [Operand::Memory { byte, .. }, output] = operands else { return };
        self.boxed(|lowering| {
            let (address, bytes) = (lowering.b.i32_const(*byte), lowering.b.i32_const(1));
            let value =
                lowering.b.call_runtime(RuntimeFn::PeripheralRead, &[address, bytes]).expect("it returns a value");
            let value = lowering.b.trunc(Type::I8, value);
            let target = lowering.target(output, Width::Byte);
            lowering.store(target, Width::Byte, value);
        });
    }

    /// `BIW`: image and module.
    pub fn write_output_now(&mut self, operands: &[Operand]) {
        let [input, Operand::Memory { byte, .. }] = operands else { return };
        self.boxed(|lowering| {
            let value = lowering.read(input, Width::Byte);
            let value = lowering.b.zext(Type::I32, value);
            let (address, bytes) = (lowering.b.i32_const(*byte), lowering.b.i32_const(1));
            lowering.b.call_runtime(RuntimeFn::PeripheralWrite, &[address, bytes, value]);
        });
    }
}
