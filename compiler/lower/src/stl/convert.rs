//! Conversions. Source: STL reference, conversion instructions.

use plcc_abi::RuntimeFn;
use plcc_abi::codes::sync;
use plcc_ir::{BinaryOp, ConvertOp, FloatCc, IntCc, Type, UnaryOp, Value};

use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};

/// Largest magnitudes of three and of seven BCD digits.
const BCD3_MAX: i64 = 999;
const BCD7_MAX: i64 = 9_999_999;
/// REALs that a DINT can hold: from -2^31 to the greatest REAL below 2^31.
const DINT_MIN: f32 = -2_147_483_648.0;
const DINT_MAX: f32 = 2_147_483_520.0;

impl BlockLowering<'_, '_> {
    /// `BTI`, `BTD`. A digit above 9 is a synchronous error; ACCU1 then stays.
    pub fn bcd_to_int(&mut self, double: bool) {
        let accu1 = self.accu1();
        let digits = self.b.i32_const(if double { 7 } else { 3 });
        let answer = self.b.call_pure(RuntimeFn::BcdToInt, &[accu1, digits]);
        let ok = self.b.icmp_imm(IntCc::Sge, answer, 0);
        let check = self.bcd_check(ok);
        let guard = self.begin_guard(vec![check], Substitute::None);
        let sign_bit = if double { 31 } else { 15 };
        let sign = self.b.binary_imm(BinaryOp::Lshr, accu1, sign_bit);
        let negative = self.b.trunc(Type::I1, sign);
        let zero = self.b.i32_const(0);
        let minus = self.b.isub(zero, answer);
        let value = self.b.select(negative, minus, answer);
        if double {
            self.set_accu1(value);
        } else {
            let word = self.low_word(value);
            self.set_accu1_low(word);
        }
        self.end_guard(guard);
    }

    /// A BCD error unless `ok`; the fault register is 0: ACCU1.
    pub fn bcd_check(&mut self, ok: Value) -> Check {
        let code = self.b.i32_const(u32::from(sync::BCD));
        let zero = self.b.i32_const(0);
        Check { ok, code, access: zero, info: zero }
    }

    /// `ITB`, `DTB`. A value that does not fit leaves ACCU1 unchanged and sets OV.
    pub fn int_to_bcd(&mut self, double: bool) {
        let accu1 = self.accu1();
        let value = if double {
            accu1
        } else {
            let word = self.low_word(accu1);
            self.b.sext(Type::I32, word)
        };
        let negative = self.b.icmp_imm(IntCc::Slt, value, 0);
        let zero = self.b.i32_const(0);
        let minus = self.b.isub(zero, value);
        let magnitude = self.b.select(negative, minus, value);
        let max = if double { BCD7_MAX } else { BCD3_MAX };
        let too_large = self.b.icmp_imm(IntCc::Ugt, magnitude, max);
        let digits = self.b.i32_const(if double { 7 } else { 3 });
        let within = self.b.select(too_large, zero, magnitude);
        let bcd = self.b.call_pure(RuntimeFn::IntToBcd, &[within, digits]);
        let sign = self.b.i32_const(if double { 0xF000_0000 } else { 0xF000 });
        let sign = self.b.select(negative, sign, zero);
        let result = self.b.or(bcd, sign);
        let result = if double {
            result
        } else {
            let high = self.b.binary_imm(BinaryOp::And, accu1, 0xFFFF_0000);
            self.b.or(high, result)
        };
        let result = self.b.select(too_large, accu1, result);
        self.set_accu1(result);
        self.set_overflow(too_large);
    }

    pub fn int_to_dint(&mut self) {
        let accu1 = self.accu1();
        let word = self.low_word(accu1);
        let value = self.b.sext(Type::I32, word);
        self.set_accu1(value);
    }

    pub fn dint_to_real(&mut self) {
        let accu1 = self.accu1();
        let real = self.b.convert(ConvertOp::FromSint, Type::F32, accu1);
        let bits = self.b.bitcast(Type::I32, real);
        self.set_accu1(bits);
    }

    pub fn invert_int(&mut self) {
        let accu1 = self.accu1();
        let value = self.b.binary_imm(BinaryOp::Xor, accu1, 0xFFFF);
        self.set_accu1(value);
    }

    pub fn invert_dint(&mut self) {
        let accu1 = self.accu1();
        let value = self.b.not(accu1);
        self.set_accu1(value);
    }

    pub fn negate_int(&mut self) {
        let accu1 = self.accu1();
        let word = self.low_word(accu1);
        let result = self.negate(word);
        self.set_accu1_low(result);
    }

    pub fn negate_dint(&mut self) {
        let accu1 = self.accu1();
        let result = self.negate(accu1);
        self.set_accu1(result);
    }

    /// Two's complement with its status bits; the smallest number stays and sets OV.
    fn negate(&mut self, value: Value) -> Value {
        let ty = self.b.ty(value);
        let zero = self.b.iconst(ty, 0);
        let result = self.b.isub(zero, value);
        let least = 1i64 << (ty.bits() - 1);
        let overflow = self.b.icmp_imm(IntCc::Eq, value, least);
        let (cc1, cc0) = self.conditions_of(result);
        self.set_conditions(cc1, cc0);
        self.set_overflow(overflow);
        result
    }

    /// `RND RND+ RND- TRUNC`. NaN and values that a DINT cannot hold leave ACCU1 unchanged and set OV.
    pub fn real_to_dint(&mut self, rounding: UnaryOp) {
        let accu1 = self.accu1();
        let x = self.accu1_real();
        let (min, max) = (self.b.f32_const(DINT_MIN), self.b.f32_const(DINT_MAX));
        let (above, below) = (self.b.fcmp(FloatCc::Ge, x, min), self.b.fcmp(FloatCc::Le, x, max));
        let fits = self.b.and(above, below);
        let rounded = self.b.unary(rounding, x);
        let value = self.b.convert(ConvertOp::ToSint, Type::I32, rounded);
        let result = self.b.select(fits, value, accu1);
        self.set_accu1(result);
        let overflow = self.b.not(fits);
        self.set_overflow(overflow);
    }
}
