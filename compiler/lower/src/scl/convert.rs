//! Conversions. Source: SCL reference, explicit conversions and rounding functions.

use plcc_ir::{BinaryOp, ConvertOp, FloatCc, IntCc, Type, UnaryOp, Value};
use plcc_model::scl::{Conversion, Overflow};
use plcc_model::types::{Class, Elementary};

use super::value_type;
use crate::arithmetic::bcd::Bcd;
use crate::arithmetic::{float, rounding};
use crate::block::BlockLowering;
use crate::fault::Substitute;

/// Nanoseconds in a millisecond.
const MS: i64 = 1_000_000;
/// Longest S5TIME, and the longest time that each finer time base holds after cutting, in milliseconds.
const S5_MAX: i64 = 9_990_000;
const S5_BASES: [(i64, i64); 3] = [(9_999, 10), (99_999, 100), (999_999, 1_000)];

impl BlockLowering<'_, '_> {
    /// Converts `value` of type `from` to type `to`.
    pub fn convert(&mut self, conversion: Conversion, value: Value, from: Elementary, to: Elementary) -> Value {
        match conversion {
            Conversion::Value(overflow) => self.by_value(value, from, to, UnaryOp::Fnearest, overflow),
            Conversion::Truncate(overflow) => self.by_value(value, from, to, UnaryOp::Ftrunc, overflow),
            Conversion::Ceil(overflow) => self.by_value(value, from, to, UnaryOp::Fceil, overflow),
            Conversion::Floor(overflow) => self.by_value(value, from, to, UnaryOp::Ffloor, overflow),
            Conversion::Bits { checked } => {
                let result = self.resized(value, from, to);
                if checked && from.bits() != to.bits() && self.wants_flag() {
                    self.check_bits(value, result, from, to);
                }
                result
            }
            Conversion::ToBool => {
                let bits = self.as_bits(value);
                let others = self.b.binary_imm(BinaryOp::Lshr, bits, 1);
                let failed = self.b.icmp_imm(IntCc::Ne, others, 0);
                self.fail_if(failed);
                self.narrowed(bits, Type::I1)
            }
            Conversion::FromBcd { fault } => self.bcd_value(value, to, fault),
            Conversion::ToBcd => self.bcd_of(value, from, to),
            Conversion::FromS5Time => self.s5time_value(value),
            Conversion::ToS5Time => self.s5time_of(value),
            Conversion::MillisToNanos => {
                let wide = self.wide(value, from);
                self.b.binary_imm(BinaryOp::Imul, wide, MS)
            }
            Conversion::NanosToMillis => {
                let divisor = self.b.iconst(Type::I64, MS);
                let ms = self.b.binary(BinaryOp::Sdiv, value, divisor);
                let result = self.b.trunc(Type::I32, ms);
                let back = self.wide(result, to);
                let failed = self.b.icmp(IntCc::Ne, ms, back);
                self.fail_if(failed);
                result
            }
            Conversion::Ranged { max } => {
                let wide = self.wide(value, from);
                let failed = self.b.icmp_imm(IntCc::Ugt, wide, max);
                self.fail_if(failed);
                self.resized(value, from, to)
            }
        }
    }

    // Numbers.

    fn by_value(
        &mut self,
        value: Value,
        from: Elementary,
        to: Elementary,
        rounding: UnaryOp,
        overflow: Overflow,
    ) -> Value {
        match (from.is_float(), to.is_float()) {
            (true, true) => {
                let value = if rounding == UnaryOp::Fnearest && from != to {
                    value
                } else {
                    // The sum makes 0 of -0, which an integer does not have either.
                    let whole = self.b.unary(rounding, value);
                    let zero = self.b.iconst(value_type(from), 0);
                    let whole = self.b.binary(BinaryOp::Fadd, whole, zero);
                    self.checked_float(whole)
                };
                match (from.bits(), to.bits()) {
                    (32, 64) => self.b.convert(ConvertOp::Fpromote, Type::F64, value),
                    (64, 32) => {
                        let narrow = self.b.convert(ConvertOp::Fdemote, Type::F32, value);
                        self.checked_float(narrow)
                    }
                    _ => value,
                }
            }
            (true, false) => self.float_to_integer(value, to, rounding, overflow),
            (false, true) => self.as_float(value, from, value_type(to)),
            (false, false) => self.integer_to_integer(value, from, to),
        }
    }

    fn integer_to_integer(&mut self, value: Value, from: Elementary, to: Elementary) -> Value {
        let result = self.resized(value, from, to);
        if self.wants_flag() {
            let before = self.wide(value, from);
            let after = self.wide(result, to);
            let mut failed = self.b.icmp(IntCc::Ne, before, after);
            let huge = from.bits() == 64 && !from.is_signed() && to.is_signed();
            let negative = from.is_signed() && !to.is_signed() && to.bits() == 64;
            if huge || negative {
                let high_bit = self.b.icmp_imm(IntCc::Slt, before, 0);
                failed = self.b.or(failed, high_bit);
            }
            self.fail_if(failed);
        }
        result
    }

    fn float_to_integer(&mut self, value: Value, to: Elementary, rounding: UnaryOp, overflow: Overflow) -> Value {
        if to.bits() > 32 {
            return self.float_to_long(value, to, rounding, overflow);
        }
        let ty = value_type(to);
        let whole = rounding::to_integer(&mut self.b, value, rounding, to.bits(), to.is_signed());
        let failed = self.b.not(whole.fits);
        self.fail_if(failed);
        let good = self.narrowed(whole.value, ty);
        if overflow == Overflow::Pattern {
            let pattern = self.pattern_of(value, ty);
            return self.b.select(whole.fits, good, pattern);
        }
        if rounding == UnaryOp::Ftrunc {
            return self.low_bits_of_float(value, good, rounding, ty);
        }
        // What does not fit is rare, and takes longer.
        let result = self.b.declare_var(ty);
        let (other, join) = (self.b.create_cold_block(), self.b.create_block());
        self.b.def_var(result, good);
        self.b.branch(whole.fits, join, other);
        self.b.seal_block(other);
        self.b.switch_to(other);
        let low = self.low_bits_of_float(value, good, rounding, ty);
        self.b.def_var(result, low);
        self.b.jump(join, &[]);
        self.b.seal_block(join);
        self.b.switch_to(join);
        self.b.use_var(result)
    }

    /// The low bits of a rounded float; `good`: those of a REAL below 2^51.
    fn low_bits_of_float(&mut self, value: Value, good: Value, rounding: UnaryOp, ty: Type) -> Value {
        let is_real = self.b.ty(value) == Type::F32;
        let x = self.b.convert(ConvertOp::Fpromote, Type::F64, value);
        // The conversion to 64 bits truncates by itself; a large REAL is whole.
        let rounded = if is_real || rounding == UnaryOp::Ftrunc { x } else { self.b.unary(rounding, x) };
        let low = self.low_bits_of(rounded, ty);
        if !is_real || rounding == UnaryOp::Ftrunc {
            return low;
        }
        let large = float::constant(&mut self.b, Type::F64, 2f64.powi(51));
        let magnitude = self.b.unary(UnaryOp::Fabs, x);
        let is_small = self.b.fcmp(FloatCc::Lt, magnitude, large);
        self.b.select(is_small, good, low)
    }

    /// A float as an integer of 64 bits.
    fn float_to_long(&mut self, value: Value, to: Elementary, rounding: UnaryOp, overflow: Overflow) -> Value {
        let rounded = self.b.unary(rounding, value);
        let rounded = self.b.convert(ConvertOp::Fpromote, Type::F64, rounded);
        let fits = float::fits_integer(&mut self.b, rounded, to.bits(), to.is_signed());
        let failed = self.b.not(fits);
        self.fail_if(failed);
        let convert = if to.is_signed() { ConvertOp::ToSint } else { ConvertOp::ToUint };
        let good = self.b.convert(convert, Type::I64, rounded);
        let other = match overflow {
            Overflow::Pattern => self.pattern_of(value, Type::I64),
            Overflow::LowBits => self.low_bits_of(rounded, Type::I64),
        };
        self.b.select(fits, good, other)
    }

    /// The low bits of a whole f64 as a signed integer of 64 bits; 0 where that cannot hold it.
    fn low_bits_of(&mut self, whole: Value, ty: Type) -> Value {
        let edge = float::constant(&mut self.b, Type::F64, 2f64.powi(63));
        let magnitude = self.b.unary(UnaryOp::Fabs, whole);
        let has_bits = self.b.fcmp(FloatCc::Lt, magnitude, edge);
        let signed = self.b.convert(ConvertOp::ToSint, Type::I64, whole);
        let low = self.narrowed(signed, ty);
        let none = self.b.iconst(ty, 0);
        self.b.select(has_bits, low, none)
    }

    // Patterns.

    /// The bits of a float as an integer of type `ty`: the low ones, or with zeros before them.
    fn pattern_of(&mut self, value: Value, ty: Type) -> Value {
        let bits = self.as_bits(value);
        match self.b.ty(bits).bits() < ty.bits() {
            true => self.b.zext(ty, bits),
            false => self.narrowed(bits, ty),
        }
    }

    /// Clears the bit if `result`, the bits of `value` in another width, is a different number. A bit string converted to a signed
    /// integer is read as signed: 16#FFFF_8000 fits an INT, 16#0000_8000 does not.
    fn check_bits(&mut self, value: Value, result: Value, from: Elementary, to: Elementary) {
        let before = match (from.class(), to.is_signed(), self.b.ty(value)) {
            (Class::Bits, true, ty) if ty != Type::I64 => self.b.sext(Type::I64, value),
            _ => self.wide(value, from),
        };
        let after = self.wide(result, to);
        let mut failed = self.b.icmp(IntCc::Ne, before, after);
        // A negative number in 64 bits looks like the bit string.
        if from.is_signed() && to.bits() == 64 {
            let negative = self.b.icmp_imm(IntCc::Slt, before, 0);
            failed = self.b.or(failed, negative);
        }
        self.fail_if(failed);
    }

    /// The bits of a value, as an integer.
    pub fn as_bits(&mut self, value: Value) -> Value {
        match self.b.ty(value) {
            Type::F32 => self.b.bitcast(Type::I32, value),
            Type::F64 => self.b.bitcast(Type::I64, value),
            _ => value,
        }
    }

    /// The bits as an i64: sign-extended from a signed integer or TIME, otherwise zero-extended.
    pub fn wide(&mut self, value: Value, ty: Elementary) -> Value {
        let bits = self.as_bits(value);
        match (self.b.ty(bits), ty.is_signed()) {
            (Type::I64, _) => bits,
            (_, true) => self.b.sext(Type::I64, bits),
            (_, false) => self.b.zext(Type::I64, bits),
        }
    }

    /// The bits, extended by the source's sign or truncated, as a value of `to`.
    fn resized(&mut self, value: Value, from: Elementary, to: Elementary) -> Value {
        let bits = self.as_bits(value);
        let target = match value_type(to) {
            Type::F32 => Type::I32,
            Type::F64 => Type::I64,
            ty => ty,
        };
        let (have, want) = (self.b.ty(bits).bits(), target.bits());
        let sized = if have == want {
            bits
        } else if have > want {
            self.b.trunc(target, bits)
        } else if from.is_signed() {
            self.b.sext(target, bits)
        } else {
            self.b.zext(target, bits)
        };
        if to.class() == Class::Float { self.b.bitcast(value_type(to), sized) } else { sized }
    }

    // BCD.

    fn bcd_value(&mut self, value: Value, to: Elementary, fault: bool) -> Value {
        let form = if to.bits() == 32 { Bcd::DWORD } else { Bcd::WORD };
        let wide = self.b.zext(Type::I32, value);
        let (magnitude, ok) = form.magnitude(&mut self.b, wide);
        let number = form.with_sign(&mut self.b, wide, magnitude);
        let zero = self.b.i32_const(0);
        let number = self.b.select(ok, number, zero);
        if fault {
            let check = self.bcd_check(ok);
            let guard = self.begin_guard(vec![check], Substitute::None);
            self.end_guard(guard);
        } else {
            let failed = self.b.not(ok);
            self.fail_if(failed);
        }
        self.narrowed(number, value_type(to))
    }

    fn bcd_of(&mut self, value: Value, from: Elementary, to: Elementary) -> Value {
        let number = self.as_i32(value, from);
        let form = if to.bits() == 32 { Bcd::DWORD } else { Bcd::WORD };
        let (result, too_large) = form.digits_and_sign(&mut self.b, number);
        let result = self.b.select(too_large, number, result);
        self.fail_if(too_large);
        self.narrowed(result, value_type(to))
    }

    // S5TIME.

    /// Bits 12 and 13 are the base, 10 ms, 100 ms, 1 s or 10 s; below are three digits.
    fn s5time_value(&mut self, value: Value) -> Value {
        let wide = self.b.zext(Type::I32, value);
        let mut number = self.b.i32_const(0);
        for shift in [8, 4, 0] {
            let digit = self.b.binary_imm(BinaryOp::Lshr, wide, shift);
            let digit = self.masked(digit, 0xF);
            let tens = self.b.binary_imm(BinaryOp::Imul, number, 10);
            number = self.b.iadd(tens, digit);
        }
        let base = self.b.binary_imm(BinaryOp::Lshr, wide, 12);
        let base = self.masked(base, 3);
        let mut factor = self.b.i32_const(10);
        for (code, value) in [(1, 100), (2, 1_000), (3, 10_000)] {
            let is_this = self.b.icmp_imm(IntCc::Eq, base, code);
            let this = self.b.i32_const(value);
            factor = self.b.select(is_this, this, factor);
        }
        self.b.binary(BinaryOp::Imul, number, factor)
    }

    /// With the finest base that fits the time, truncated. A negative time yields 0, one that is too long the longest.
    fn s5time_of(&mut self, value: Value) -> Value {
        let negative = self.b.icmp_imm(IntCc::Slt, value, 0);
        let too_long = self.b.icmp_imm(IntCc::Sgt, value, S5_MAX);
        let failed = self.b.or(negative, too_long);
        self.fail_if(failed);
        let (zero, longest) = (self.b.i32_const(0), self.b.i32_const(S5_MAX as u32));
        let time = self.b.select(too_long, longest, value);
        let time = self.b.select(negative, zero, time);
        let (mut divisor, mut base) = (self.b.i32_const(10_000), self.b.i32_const(3));
        for (code, (max, factor)) in S5_BASES.iter().enumerate().rev() {
            let fits = self.b.icmp_imm(IntCc::Sle, time, *max);
            let (this, number) = (self.b.i32_const(*factor as u32), self.b.i32_const(code as u32));
            divisor = self.b.select(fits, this, divisor);
            base = self.b.select(fits, number, base);
        }
        let number = self.b.binary(BinaryOp::Sdiv, time, divisor);
        let bcd = Bcd::WORD.digits_of_small(&mut self.b, number);
        let base = self.b.binary_imm(BinaryOp::Shl, base, 12);
        let result = self.b.or(base, bcd);
        self.b.trunc(Type::I16, result)
    }
}
