//! Arithmetic and word logic. Source: STL reference, integer and floating-point math, word logic.

use plcc_abi::RuntimeFn;
use plcc_ir::{BinaryOp, FloatCc, IntCc, Type, UnaryOp, Value};
use plcc_model::Operand;

use crate::arithmetic::float;
use crate::arithmetic::integer::{self, Narrowed};
use crate::block::BlockLowering;

impl BlockLowering<'_, '_> {
    /// ACCU2-L and ACCU1-L, as i16.
    fn int_operands(&mut self) -> (Value, Value) {
        let (a, b) = (self.accu2(), self.accu1());
        (self.low_word(a), self.low_word(b))
    }

    /// `+I`, `-I`. CC1 and CC0 follow the wrapped result.
    pub fn add_sub_int(&mut self, op: BinaryOp) {
        let (a, b) = self.int_operands();
        let result = self.b.binary(op, a, b);
        let overflow = integer::sum_overflow(&mut self.b, op, a, b, result);
        self.set_accu1_low(result);
        let (cc1, cc0) = self.conditions_of(result);
        self.set_conditions(cc1, cc0);
        self.set_overflow(overflow);
        self.shift_down();
    }

    /// `+D`, `-D`.
    pub fn add_sub_dint(&mut self, op: BinaryOp) {
        let (a, b) = (self.accu2(), self.accu1());
        let result = self.b.binary(op, a, b);
        let overflow = integer::sum_overflow(&mut self.b, op, a, b, result);
        self.set_accu1(result);
        let (cc1, cc0) = self.conditions_of(result);
        self.set_conditions(cc1, cc0);
        self.set_overflow(overflow);
        self.shift_down();
    }

    /// `*I`: the whole product of 32 bits.
    pub fn mul_int(&mut self) {
        let (a, b) = self.int_operands();
        let Narrowed { exact, overflow, .. } = integer::product(&mut self.b, a, b);
        self.set_accu1(exact);
        let (cc1, cc0) = self.conditions_of(exact);
        self.set_conditions(cc1, cc0);
        self.set_overflow(overflow);
        self.shift_down();
    }

    /// `*D`: the low 32 bits; CC1 and CC0 by the true product.
    pub fn mul_dint(&mut self) {
        let (a, b) = (self.accu2(), self.accu1());
        let Narrowed { exact, value, overflow } = integer::product(&mut self.b, a, b);
        self.set_accu1(value);
        let (cc1, cc0) = self.conditions_of(exact);
        self.set_conditions(cc1, cc0);
        self.set_overflow(overflow);
        self.shift_down();
    }

    /// `/I`: quotient in ACCU1-L, remainder in ACCU1-H.
    pub fn div_int(&mut self) {
        let (a, b) = self.int_operands();
        let (a, b) = (self.b.sext(Type::I32, a), self.b.sext(Type::I32, b));
        let (zero, divisor) = self.guard_divisor(b);
        let (quotient, result) = integer::quotient_and_remainder(&mut self.b, a, divisor);
        self.set_quotient(zero, result, quotient.exact, quotient.overflow);
    }

    /// `/D`: the quotient.
    pub fn div_dint(&mut self) {
        let (a, b) = (self.accu2(), self.accu1());
        // In 64 bits, so the smallest number divided by -1 is representable.
        let (a, b) = (self.b.sext(Type::I64, a), self.b.sext(Type::I64, b));
        let (zero, divisor) = self.guard_divisor(b);
        let quotient = integer::quotient(&mut self.b, a, divisor, Type::I32);
        self.set_quotient(zero, quotient.value, quotient.exact, quotient.overflow);
    }

    /// `MOD`: the remainder, with the sign of the dividend.
    pub fn mod_dint(&mut self) {
        let (a, b) = (self.accu2(), self.accu1());
        let (a, b) = (self.b.sext(Type::I64, a), self.b.sext(Type::I64, b));
        let (zero, divisor) = self.guard_divisor(b);
        let remainder = self.b.binary(BinaryOp::Srem, a, divisor);
        let low = self.b.trunc(Type::I32, remainder);
        let never = self.b.bool_const(false);
        self.set_quotient(zero, low, remainder, never);
    }

    /// Whether `divisor` is 0, and a usable divisor: 1 instead of 0.
    fn guard_divisor(&mut self, divisor: Value) -> (Value, Value) {
        let zero = self.b.icmp_imm(IntCc::Eq, divisor, 0);
        let one = self.b.iconst(self.b.ty(divisor), 1);
        (zero, self.b.select(zero, one, divisor))
    }

    /// Result of a division: `result` into ACCU1, CC by `sign_of`; a divisor of 0 yields 0, CC 11 and OV.
    fn set_quotient(&mut self, zero: Value, result: Value, sign_of: Value, too_large: Value) {
        let nothing = self.b.i32_const(0);
        let accu1 = self.b.select(zero, nothing, result);
        self.set_accu1(accu1);
        let (above, below) = self.conditions_of(sign_of);
        let (cc1, cc0) = (self.b.or(above, zero), self.b.or(below, zero));
        self.set_conditions(cc1, cc0);
        let overflow = self.b.or(zero, too_large);
        self.set_overflow(overflow);
        self.shift_down();
    }

    /// ACCU1 as REAL.
    pub fn accu1_real(&mut self) -> Value {
        let accu1 = self.accu1();
        self.b.bitcast(Type::F32, accu1)
    }

    /// `+R -R *R /R`.
    pub fn real_binary(&mut self, op: BinaryOp) {
        let (a, b) = (self.accu2(), self.accu1());
        let (a, b) = (self.b.bitcast(Type::F32, a), self.b.bitcast(Type::F32, b));
        let result = self.b.binary(op, a, b);
        let inexact_zero = float::zero_is_inexact(&mut self.b, op, a, b);
        self.set_real(result, inexact_zero);
        self.shift_down();
    }

    pub fn square(&mut self) {
        let x = self.accu1_real();
        let result = self.b.binary(BinaryOp::Fmul, x, x);
        let inexact_zero = self.is_not(x, 0.0);
        self.set_real(result, inexact_zero);
    }

    pub fn square_root(&mut self) {
        let x = self.accu1_real();
        let result = self.b.unary(UnaryOp::Fsqrt, x);
        let never = self.b.bool_const(false);
        self.set_real(result, never);
    }

    pub fn real_function(&mut self, function: RuntimeFn) {
        let x = self.accu1_real();
        let result = self.b.call_pure(function, &[x]);
        // Of the functions, only EXP gets this close to 0; the others are 0 if their argument is, or LN and ACOS of 1.
        let inexact_zero = match function {
            RuntimeFn::Exp => self.is_not(x, f32::NEG_INFINITY),
            _ => self.b.bool_const(false),
        };
        self.set_real(result, inexact_zero);
    }

    /// i1: `x` differs from `value`.
    fn is_not(&mut self, x: Value, value: f32) -> Value {
        let value = self.b.f32_const(value);
        self.b.fcmp(FloatCc::Ne, x, value)
    }

    /// `ABS`, `NEGR`: only the sign, even of NaN; no status.
    pub fn real_sign(&mut self, clear: bool) {
        let accu1 = self.accu1();
        let value = if clear {
            self.b.binary_imm(BinaryOp::And, accu1, 0x7FFF_FFFF)
        } else {
            self.b.binary_imm(BinaryOp::Xor, accu1, 0x8000_0000)
        };
        self.set_accu1(value);
    }

    /// A REAL result into ACCU1 with its status bits. Infinities, NaN, denormal numbers, and a zero where `inexact_zero` (an i1)
    /// shows that the true result differs, set OV; a denormal number counts as 0 for CC1 and CC0.
    fn set_real(&mut self, result: Value, inexact_zero: Value) {
        let nan = self.b.fcmp(FloatCc::Uno, result, result);
        let bits = self.b.bitcast(Type::I32, result);
        let pattern = self.b.iconst(Type::I32, float::NAN);
        let accu1 = self.b.select(nan, pattern, bits);
        self.set_accu1(accu1);
        let magnitude = float::magnitude_bits(&mut self.b, bits);
        let counts = float::counts_as_not_zero(&mut self.b, magnitude);
        let negative = self.b.icmp_imm(IntCc::Slt, bits, 0);
        let positive = self.b.not(negative);
        let (above, below) = (self.b.or(positive, nan), self.b.or(negative, nan));
        let (cc1, cc0) = (self.b.and(counts, above), self.b.and(counts, below));
        self.set_conditions(cc1, cc0);
        let (not_zero, not_normal) = float::not_normal(&mut self.b, magnitude);
        let zero = self.b.not(not_zero);
        let underflow = self.b.and(zero, inexact_zero);
        let overflow = self.b.or(not_normal, underflow);
        self.set_overflow(overflow);
    }

    /// `AW OW XOW`.
    pub fn word_logic(&mut self, op: BinaryOp, operand: &Operand) {
        let accu1 = self.accu1();
        let a = self.low_word(accu1);
        let b = match Self::constant(operand) {
            Some((value, _)) => self.b.iconst(Type::I16, i64::from(value)),
            None => {
                let accu2 = self.accu2();
                self.low_word(accu2)
            }
        };
        let result = self.b.binary(op, a, b);
        self.set_accu1_low(result);
        self.set_logic_status(result);
    }

    /// `AD OD XOD`.
    pub fn dword_logic(&mut self, op: BinaryOp, operand: &Operand) {
        let a = self.accu1();
        let b = match Self::constant(operand) {
            Some((value, _)) => self.b.i32_const(value),
            None => self.accu2(),
        };
        let result = self.b.binary(op, a, b);
        self.set_accu1(result);
        self.set_logic_status(result);
    }

    /// CC1: the result is not 0; CC0 and OV are 0.
    fn set_logic_status(&mut self, result: Value) {
        let not_zero = self.b.icmp_imm(IntCc::Ne, result, 0);
        self.set(self.regs.cc1, not_zero);
        self.set_bit(self.regs.cc0, false);
        self.set_bit(self.regs.ov, false);
    }
}
