//! Arithmetic and word logic. Source: STL reference, integer and floating-point math, word logic.

use plcc_abi::RuntimeFn;
use plcc_ir::{BinaryOp, FloatCc, IntCc, Type, UnaryOp, Value};
use plcc_model::Operand;

use crate::block::BlockLowering;

/// Every NaN that an instruction produces has this pattern.
pub const NAN: u32 = 0xFFFF_FFFF;
/// Bits of a REAL without its sign: infinity, the smallest normal number.
const INFINITY: i64 = 0x7F80_0000;
const LEAST_NORMAL: i64 = 0x0080_0000;

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
        let overflow = self.overflow(op, a, b, result);
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
        let overflow = self.overflow(op, a, b, result);
        self.set_accu1(result);
        let (cc1, cc0) = self.conditions_of(result);
        self.set_conditions(cc1, cc0);
        self.set_overflow(overflow);
        self.shift_down();
    }

    /// Overflow of a sum or difference: the operands' signs do not allow the result's.
    fn overflow(&mut self, op: BinaryOp, a: Value, b: Value, result: Value) -> Value {
        let from_a = self.b.xor(a, result);
        let other = if op == BinaryOp::Iadd { self.b.xor(b, result) } else { self.b.xor(a, b) };
        let both = self.b.and(from_a, other);
        self.b.icmp_imm(IntCc::Slt, both, 0)
    }

    /// `*I`: the whole product of 32 bits.
    pub fn mul_int(&mut self) {
        let (a, b) = self.int_operands();
        let (a, b) = (self.b.sext(Type::I32, a), self.b.sext(Type::I32, b));
        let product = self.b.binary(BinaryOp::Imul, a, b);
        let low = self.low_word(product);
        let fits = self.b.sext(Type::I32, low);
        let overflow = self.b.icmp(IntCc::Ne, product, fits);
        self.set_accu1(product);
        let (cc1, cc0) = self.conditions_of(product);
        self.set_conditions(cc1, cc0);
        self.set_overflow(overflow);
        self.shift_down();
    }

    /// `*D`: the low 32 bits; CC1 and CC0 by the true product.
    pub fn mul_dint(&mut self) {
        let (a, b) = (self.accu2(), self.accu1());
        let (a, b) = (self.b.sext(Type::I64, a), self.b.sext(Type::I64, b));
        let product = self.b.binary(BinaryOp::Imul, a, b);
        let low = self.b.trunc(Type::I32, product);
        let fits = self.b.sext(Type::I64, low);
        let overflow = self.b.icmp(IntCc::Ne, product, fits);
        self.set_accu1(low);
        let (cc1, cc0) = self.conditions_of(product);
        self.set_conditions(cc1, cc0);
        self.set_overflow(overflow);
        self.shift_down();
    }

    /// `/I`: quotient in ACCU1-L, remainder in ACCU1-H.
    pub fn div_int(&mut self) {
        let (a, b) = self.int_operands();
        let (a, b) = (self.b.sext(Type::I32, a), self.b.sext(Type::I32, b));
        let (zero, divisor) = self.guard_divisor(b);
        let quotient = self.b.binary(BinaryOp::Sdiv, a, divisor);
        let remainder = self.b.binary(BinaryOp::Srem, a, divisor);
        let low = self.low_word(quotient);
        // Only -32768 / -1 does not fit.
        let fits = self.b.sext(Type::I32, low);
        let too_large = self.b.icmp(IntCc::Ne, quotient, fits);
        let high = self.b.binary_imm(BinaryOp::Shl, remainder, 16);
        let low = self.b.zext(Type::I32, low);
        let result = self.b.or(high, low);
        self.set_quotient(zero, result, quotient, too_large);
    }

    /// `/D`: the quotient.
    pub fn div_dint(&mut self) {
        let (a, b) = (self.accu2(), self.accu1());
        // In 64 bits, so the smallest number divided by -1 is representable.
        let (a, b) = (self.b.sext(Type::I64, a), self.b.sext(Type::I64, b));
        let (zero, divisor) = self.guard_divisor(b);
        let quotient = self.b.binary(BinaryOp::Sdiv, a, divisor);
        let low = self.b.trunc(Type::I32, quotient);
        let fits = self.b.sext(Type::I64, low);
        let too_large = self.b.icmp(IntCc::Ne, quotient, fits);
        self.set_quotient(zero, low, quotient, too_large);
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
        // A zero that is not exact is an underflow; sums are exact there.
        let inexact_zero = match op {
            BinaryOp::Fmul => {
                let (a, b) = (self.is_not(a, 0.0), self.is_not(b, 0.0));
                self.b.and(a, b)
            }
            BinaryOp::Fdiv => {
                let magnitude = self.b.unary(UnaryOp::Fabs, b);
                let (a, b) = (self.is_not(a, 0.0), self.is_not(magnitude, f32::INFINITY));
                self.b.and(a, b)
            }
            _ => self.b.bool_const(false),
        };
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
        let pattern = self.b.i32_const(NAN);
        let accu1 = self.b.select(nan, pattern, bits);
        self.set_accu1(accu1);
        let magnitude = self.b.binary_imm(BinaryOp::And, bits, 0x7FFF_FFFF);
        let counts = self.b.icmp_imm(IntCc::Uge, magnitude, LEAST_NORMAL);
        let negative = self.b.icmp_imm(IntCc::Slt, bits, 0);
        let positive = self.b.not(negative);
        let (above, below) = (self.b.or(positive, nan), self.b.or(negative, nan));
        let (cc1, cc0) = (self.b.and(counts, above), self.b.and(counts, below));
        self.set_conditions(cc1, cc0);
        // Not 0, and not between the smallest normal number and infinity.
        let not_zero = self.b.icmp_imm(IntCc::Ne, magnitude, 0);
        let above_least = self.b.binary_imm(BinaryOp::Isub, magnitude, LEAST_NORMAL);
        let not_normal = self.b.icmp_imm(IntCc::Uge, above_least, INFINITY - LEAST_NORMAL);
        let not_representable = self.b.and(not_zero, not_normal);
        let zero = self.b.not(not_zero);
        let underflow = self.b.and(zero, inexact_zero);
        let overflow = self.b.or(not_representable, underflow);
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
