//! Moves. Source: S7-200 system manual, move instructions.

use plcc_abi::RuntimeFn;
use plcc_ir::{Type, UnaryOp};
use plcc_model::s7200::{Operand, Width};

use super::context::Context;

impl Context<'_, '_> {
    /// `MOVB MOVW MOVD MOVR`.
    pub fn copy_value(&mut self, operands: &[Operand], width: Width) {
        let [input, output] = operands else { return };
        self.boxed(|context| {
            let value = context.read(input, width);
            let target = context.target(output, width);
            context.store(target, width, value);
        });
    }

    /// `SWAP`.
    pub fn swap(&mut self, operands: &[Operand]) {
        self.boxed(|context| {
            let target = context.target(&operands[0], Width::Word);
            let old = context.load(target, Width::Word);
            let swapped = context.b.unary(UnaryOp::Bswap, old);
            context.store(target, Width::Word, swapped);
        });
    }

    /// `BIR`: the image does not change.
    pub fn read_input_now(&mut self, operands: &[Operand]) {
        let [Operand::Memory { byte, .. }, output] = operands else { return };
        self.boxed(|context| {
            let (address, bytes) = (context.b.i32_const(*byte), context.b.i32_const(1));
            let value =
                context.b.call_runtime(RuntimeFn::PeripheralRead, &[address, bytes]).expect("it returns a value");
            let value = context.b.trunc(Type::I8, value);
            let target = context.target(output, Width::Byte);
            context.store(target, Width::Byte, value);
        });
    }

    /// `BIW`: image and module.
    pub fn write_output_now(&mut self, operands: &[Operand]) {
        let [input, Operand::Memory { byte, .. }] = operands else { return };
        self.boxed(|context| {
            let value = context.read(input, Width::Byte);
            let value = context.b.zext(Type::I32, value);
            let (address, bytes) = (context.b.i32_const(*byte), context.b.i32_const(1));
            context.b.call_runtime(RuntimeFn::PeripheralWrite, &[address, bytes, value]);
        });
    }
}
