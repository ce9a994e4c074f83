//! Conversions of numbers. Source: S7-200 system manual, conversion instructions.

use plcc_ir::{BinaryOp, ConvertOp, IntCc, Type, UnaryOp, Value};
use plcc_model::s7200::{Operand, Width};

use super::block::S7200Lowering;
use super::math::{NOT_BCD, OVERFLOW};
use super::plan::ir_type;
use crate::arithmetic::bcd::Bcd;
use crate::arithmetic::bits;
use crate::arithmetic::rounding::{self, Whole};

/// Segments of the digits 0 to 7 and 8 to F, the first one lowest. Source: S7-200 system manual, segment instruction.
const SEGMENTS_LOW: u64 = 0x077D_6D66_4F5B_063F;
const SEGMENTS_HIGH: u64 = 0x7179_5E39_7C77_677F;

impl S7200Lowering<'_, '_> {
    /// Reads operand 0, computes, writes operand 1.
    fn conversion(
        &mut self,
        operands: &[Operand],
        from: Width,
        to: Width,
        compute: impl FnOnce(&mut Self, Value) -> Value,
    ) {
        let [input, output] = operands else { return };
        self.boxed(|lowering| {
            let value = lowering.read(input, from);
            let target = lowering.target(output, to);
            let result = compute(lowering, value);
            lowering.store(target, to, result);
        });
    }

    /// `BTI`.
    pub fn byte_to_int(&mut self, operands: &[Operand]) {
        self.conversion(operands, Width::Byte, Width::Word, |lowering, value| lowering.b.zext(Type::I16, value));
    }

    /// `ITD`.
    pub fn int_to_dint(&mut self, operands: &[Operand]) {
        self.conversion(operands, Width::Word, Width::Dword, |lowering, value| lowering.b.sext(Type::I32, value));
    }

    /// `DTR`: to the nearest REAL.
    pub fn dint_to_real(&mut self, operands: &[Operand]) {
        self.conversion(operands, Width::Dword, Width::Dword, |lowering, value| {
            let real = lowering.b.convert(ConvertOp::FromSint, Type::F32, value);
            lowering.b.bitcast(Type::I32, real)
        });
    }

    /// A conversion that may not fit: SM1.1 is set, OUT stays, ENO is 0. `compute` returns the result and whether it fits.
    fn checked_conversion(
        &mut self,
        operands: &[Operand],
        from: Width,
        to: Width,
        compute: impl FnOnce(&mut Self, Value) -> (Value, Value),
    ) {
        let [input, output] = operands else { return };
        self.boxed(|lowering| {
            let value = lowering.read(input, from);
            let target = lowering.target(output, to);
            let old = lowering.load(target, to);
            let (result, fits) = compute(lowering, value);
            let stored = lowering.b.select(fits, result, old);
            lowering.store(target, to, stored);
            let overflow = lowering.b.not(fits);
            lowering.set_flag(OVERFLOW, overflow);
            lowering.set(lowering.eno, fits);
        });
    }

    /// `ITB` (0 to 255), `DTI`.
    pub fn narrow(&mut self, operands: &[Operand], from: Width, to: Width) {
        self.checked_conversion(operands, from, to, |lowering, value| {
            let result = lowering.b.trunc(ir_type(to), value);
            let back = match to {
                Width::Byte => lowering.b.zext(ir_type(from), result),
                _ => lowering.b.sext(ir_type(from), result),
            };
            (result, lowering.b.icmp(IntCc::Eq, value, back))
        });
    }

    /// `ROUND` (halves away from zero), `TRUNC`.
    pub fn real_to_dint(&mut self, operands: &[Operand], round: bool) {
        self.checked_conversion(operands, Width::Dword, Width::Dword, |lowering, value| {
            let real = lowering.b.bitcast(Type::F32, value);
            let Whole { value, fits } = match round {
                true => rounding::to_integer_half_away(&mut lowering.b, real),
                false => rounding::to_integer(&mut lowering.b, real, UnaryOp::Ftrunc, 32, true),
            };
            (value, fits)
        });
    }

    /// `BCDI`, in place.
    pub fn bcd_to_int(&mut self, operands: &[Operand]) {
        self.bcd(operands, |lowering, wide| {
            let (number, good) = Bcd::UNSIGNED_WORD.magnitude(&mut lowering.b, wide);
            (number, lowering.b.not(good))
        });
    }

    /// `IBCD`, in place.
    pub fn int_to_bcd(&mut self, operands: &[Operand]) {
        self.bcd(operands, |lowering, wide| Bcd::UNSIGNED_WORD.digits(&mut lowering.b, wide));
    }

    /// SM1.6 reports a value without a BCD form; OUT stays.
    fn bcd(&mut self, operands: &[Operand], compute: impl FnOnce(&mut Self, Value) -> (Value, Value)) {
        self.boxed(|lowering| {
            let target = lowering.target(&operands[0], Width::Word);
            let old = lowering.load(target, Width::Word);
            let wide = lowering.b.zext(Type::I32, old);
            let (result, bad) = compute(lowering, wide);
            let result = lowering.b.trunc(Type::I16, result);
            let stored = lowering.b.select(bad, old, result);
            lowering.store(target, Width::Word, stored);
            lowering.set_flag(NOT_BCD, bad);
            let good = lowering.b.not(bad);
            lowering.set(lowering.eno, good);
        });
    }

    /// `DECO`.
    pub fn decode(&mut self, operands: &[Operand]) {
        self.conversion(operands, Width::Byte, Width::Word, |lowering, value| {
            bits::only_bit(&mut lowering.b, Type::I16, value)
        });
    }

    /// `ENCO`: the lowest bit that is set; 0 if none is.
    pub fn encode(&mut self, operands: &[Operand]) {
        self.conversion(operands, Width::Word, Width::Byte, |lowering, value| {
            let (number, _) = bits::lowest_bit(&mut lowering.b, value);
            lowering.b.trunc(Type::I8, number)
        });
    }

    /// `SEG`.
    pub fn segments(&mut self, operands: &[Operand]) {
        self.conversion(operands, Width::Byte, Width::Byte, |lowering, value| {
            let wide = lowering.b.zext(Type::I64, value);
            let high = lowering.b.binary_imm(BinaryOp::And, wide, 8);
            let is_high = lowering.b.icmp_imm(IntCc::Ne, high, 0);
            let (low, high) =
                (lowering.b.iconst(Type::I64, SEGMENTS_LOW as i64), lowering.b.iconst(Type::I64, SEGMENTS_HIGH as i64));
            let table = lowering.b.select(is_high, high, low);
            let place = lowering.b.binary_imm(BinaryOp::And, wide, 7);
            let place = lowering.b.binary_imm(BinaryOp::Shl, place, 3);
            let shifted = lowering.b.binary(BinaryOp::Lshr, table, place);
            lowering.b.trunc(Type::I8, shifted)
        });
    }
}
