//! Shift and rotate. SM1.1 is the last bit that was shifted out; it does not change if nothing is shifted. Source: S7-200 system manual,
//! shift and rotate instructions.

use plcc_abi::s7200::system;
use plcc_ir::{Address, BinaryOp, IntCc, Region, Type, Value};
use plcc_model::s7200::{Operand, Width};

use super::block::S7200Lowering;
use super::math::OVERFLOW;
use super::plan::ir_type;
use crate::arithmetic::bits;

impl S7200Lowering<'_, '_> {
    /// `SRB SRW SRD SLB SLW SLD`: by at most the width.
    pub fn shift(&mut self, operands: &[Operand], width: Width, op: BinaryOp) {
        let [output, count] = operands else { return };
        self.boxed(|lowering| {
            let count = lowering.read(count, Width::Byte);
            let target = lowering.target(output, width);
            let old = lowering.load(target, width);
            let bits = i64::from(width.bits());
            let count = lowering.b.zext(Type::I64, count);
            let most = lowering.b.iconst(Type::I64, bits);
            let too_many = lowering.b.icmp(IntCc::Ugt, count, most);
            let count = lowering.b.select(too_many, most, count);
            let wide = lowering.b.zext(Type::I64, old);
            let (result, out) = bits::shift(&mut lowering.b, op, wide, count, width.bits());
            let result = lowering.b.trunc(ir_type(width), result);
            lowering.finish_logic(target, width, result);
            let none = lowering.b.icmp_imm(IntCc::Eq, count, 0);
            lowering.set_bit_out(none, out);
        });
    }

    /// `RRB RRW RRD RLB RLW RLD`: modulo the width.
    pub fn rotate(&mut self, operands: &[Operand], width: Width, op: BinaryOp) {
        let [output, count] = operands else { return };
        self.boxed(|lowering| {
            let count = lowering.read(count, Width::Byte);
            let target = lowering.target(output, width);
            let old = lowering.load(target, width);
            let ty = ir_type(width);
            let bits = i64::from(width.bits());
            let count = lowering.b.binary_imm(BinaryOp::And, count, bits - 1);
            let places = if ty == Type::I8 { count } else { lowering.b.zext(ty, count) };
            let (result, out) = bits::rotate(&mut lowering.b, op, old, places);
            lowering.finish_logic(target, width, result);
            let none = lowering.b.icmp_imm(IntCc::Eq, count, 0);
            lowering.set_bit_out(none, out);
        });
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
