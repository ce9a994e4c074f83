//! Shift and rotate. SM1.1 is the last bit that was shifted out; it does not change if nothing is shifted. Source: S7-200 system manual,
//! shift and rotate instructions.

use plcc_abi::s7200::system;
use plcc_ir::{Address, BinaryOp, IntCc, Region, Type, Value};
use plcc_model::s7200::{Operand, Width};

use super::context::Context;
use super::math::OVERFLOW;
use super::plan::ir_type;

impl Context<'_, '_> {
    /// `SRB SRW SRD SLB SLW SLD`: by at most the width.
    pub fn shift(&mut self, operands: &[Operand], width: Width, op: BinaryOp) {
        let [output, count] = operands else { return };
        self.boxed(|context| {
            let count = context.read(count, Width::Byte);
            let target = context.target(output, width);
            let old = context.load(target, width);
            let bits = i64::from(width.bits());
            let count = context.b.zext(Type::I64, count);
            let most = context.b.iconst(Type::I64, bits);
            let too_many = context.b.icmp(IntCc::Ugt, count, most);
            let count = context.b.select(too_many, most, count);
            let wide = context.b.zext(Type::I64, old);
            let (result, out) = if op == BinaryOp::Shl {
                let shifted = context.b.binary(BinaryOp::Shl, wide, count);
                (shifted, context.bit_of(shifted, bits))
            } else {
                // One position to the left first, so that the bit shifted out last is bit 0.
                let doubled = context.b.binary_imm(BinaryOp::Shl, wide, 1);
                let shifted = context.b.binary(BinaryOp::Lshr, doubled, count);
                (context.b.binary_imm(BinaryOp::Lshr, shifted, 1), context.bit_of(shifted, 0))
            };
            let result = context.b.trunc(ir_type(width), result);
            context.finish_logic(target, width, result);
            let none = context.b.icmp_imm(IntCc::Eq, count, 0);
            context.set_bit_out(none, out);
        });
    }

    /// `RRB RRW RRD RLB RLW RLD`: modulo the width.
    pub fn rotate(&mut self, operands: &[Operand], width: Width, op: BinaryOp) {
        let [output, count] = operands else { return };
        self.boxed(|context| {
            let count = context.read(count, Width::Byte);
            let target = context.target(output, width);
            let old = context.load(target, width);
            let ty = ir_type(width);
            let bits = i64::from(width.bits());
            let count = context.b.binary_imm(BinaryOp::And, count, bits - 1);
            let places = if ty == Type::I8 { count } else { context.b.zext(ty, count) };
            let result = context.b.binary(op, old, places);
            context.finish_logic(target, width, result);
            let out = context.bit_of(result, if op == BinaryOp::Rotr { bits - 1 } else { 0 });
            let none = context.b.icmp_imm(IntCc::Eq, count, 0);
            context.set_bit_out(none, out);
        });
    }

    /// Bit `bit` of a value, an i1.
    fn bit_of(&mut self, value: Value, bit: i64) -> Value {
        let shifted = self.b.binary_imm(BinaryOp::Lshr, value, bit);
        let masked = self.b.binary_imm(BinaryOp::And, shifted, 1);
        self.b.icmp_imm(IntCc::Ne, masked, 0)
    }

    fn set_bit_out(&mut self, none: Value, out: Value) {
        let bit = match self.b.constant_bits(none) {
            Some(0) => out,
            Some(_) => return,
            None => {
                let old = self.b.load_bit(Address::direct(Region::System, system::SM + 1), OVERFLOW);
                self.b.select(none, old, out)
            }
        };
        self.set_flag(OVERFLOW, bit);
    }
}
