//! Operators: integers wrap, a division by 0 yields 0. Source: SCL reference, arithmetic, bit and comparison operators.

use plcc_abi::RuntimeFn;
use plcc_abi::image::Family;
use plcc_ir::{BinaryOp as Ir, ConvertOp, FloatCc, IntCc, Type, Value};
use plcc_model::scl::{BinaryOp, CompareOp};
use plcc_model::types::Elementary;

use super::value_type;
use crate::arithmetic::{bits, compare, float, integer};
use crate::block::BlockLowering;

/// A day in the units of TIME_OF_DAY and of LTOD.
const DAY_MS: i64 = 86_400_000;
const DAY_NS: i64 = DAY_MS * 1_000_000;
impl BlockLowering<'_, '_> {
    /// `a op b`; `right` is the type of `b` if it differs (shift counts, milliseconds).
    pub fn binary(&mut self, op: BinaryOp, a: Value, b: Value, ty: Elementary, right: Elementary) -> Value {
        match op {
            BinaryOp::And => self.b.and(a, b),
            BinaryOp::Or => self.b.or(a, b),
            BinaryOp::Xor => self.b.xor(a, b),
            BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply | BinaryOp::Divide if ty.is_float() => {
                let op = match op {
                    BinaryOp::Add => Ir::Fadd,
                    BinaryOp::Subtract => Ir::Fsub,
                    BinaryOp::Multiply => Ir::Fmul,
                    _ => Ir::Fdiv,
                };
                let result = self.b.binary(op, a, b);
                self.float_result(result, a, b, op)
            }
            // The product of two singles is exact in double, so that both ways round once.
            BinaryOp::Power if ty == Elementary::Real && self.b.constant_bits(b) == Some(2.0f32.to_bits().into()) => {
                let square = self.b.binary(Ir::Fmul, a, a);
                self.checked_float(square)
            }
            BinaryOp::Power => {
                let function = if ty == Elementary::Lreal { RuntimeFn::PowLong } else { RuntimeFn::Pow };
                let result = self.b.call_pure(function, &[a, b]);
                self.checked_float(result)
            }
            BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply => self.integer(op, a, b, ty),
            BinaryOp::Divide => self.divide(a, b, ty),
            BinaryOp::Modulo => self.modulo(a, b, ty),
            BinaryOp::ShiftLeft | BinaryOp::ShiftRight => self.shift_by(op, a, b, ty, right),
            BinaryOp::RotateLeft | BinaryOp::RotateRight => {
                let op = if op == BinaryOp::RotateLeft { Ir::Rotl } else { Ir::Rotr };
                let count = bits::count_as(&mut self.b, b, value_type(ty));
                self.b.binary(op, a, count)
            }
            BinaryOp::AddDay | BinaryOp::SubtractDay => self.day_time(op, a, b, ty),
            BinaryOp::Min | BinaryOp::Max => self.min_max(op, a, b, ty),
        }
    }

    // Floats.

    /// A NaN becomes the one NaN; infinities, NaN, denormal numbers and underflows clear the bit.
    fn float_result(&mut self, result: Value, a: Value, b: Value, op: Ir) -> Value {
        let value = self.checked_float(result);
        if self.flushes(self.b.ty(a)) {
            return value;
        }
        if self.wants_flag() && matches!(op, Ir::Fmul | Ir::Fdiv) {
            let zero = self.b.iconst(self.b.ty(a), 0);
            let is_zero = self.b.fcmp(FloatCc::Eq, result, zero);
            let inexact = float::zero_is_inexact(&mut self.b, op, a, b);
            let underflow = self.b.and(is_zero, inexact);
            self.fail_if(underflow);
        }
        value
    }

    /// True if the CPU has no denormal numbers of this type: an S7-1200 turns them into 0 without an error.
    /// Source: S7-1200 reference, math; see decision 46.
    fn flushes(&self, ty: Type) -> bool {
        ty == Type::F32 && self.plan.program.profile.family == Family::S71200
    }

    /// 0 of the same sign in place of a denormal number.
    fn flushed(&mut self, result: Value) -> Value {
        let bits = self.b.bitcast(Type::I32, result);
        let exponent = self.b.binary_imm(Ir::And, bits, float::INFINITY);
        let small = self.b.icmp_imm(IntCc::Eq, exponent, 0);
        let sign = self.b.binary_imm(Ir::And, bits, i64::from(i32::MIN));
        let zero = self.b.bitcast(Type::F32, sign);
        self.b.select(small, zero, result)
    }

    /// Like `float_result`, for results that cannot underflow to 0.
    pub fn checked_float(&mut self, result: Value) -> Value {
        let ty = self.b.ty(result);
        let result = if self.flushes(ty) { self.flushed(result) } else { result };
        let nan = self.b.fcmp(FloatCc::Uno, result, result);
        let pattern = self.b.iconst(ty, float::NAN);
        let value = self.b.select(nan, pattern, result);
        if self.wants_flag() {
            let bits = self.as_bits(result);
            let magnitude = float::magnitude_bits(&mut self.b, bits);
            let (_, failed) = float::not_normal(&mut self.b, magnitude);
            self.fail_if(failed);
        }
        value
    }

    // Integers.

    fn integer(&mut self, op: BinaryOp, a: Value, b: Value, ty: Elementary) -> Value {
        let ir = match op {
            BinaryOp::Add => Ir::Iadd,
            BinaryOp::Subtract => Ir::Isub,
            _ => Ir::Imul,
        };
        let result = self.b.binary(ir, a, b);
        if self.wants_flag() {
            let failed = integer::overflow(&mut self.b, ir, ty.is_signed(), a, b, result);
            self.fail_if(failed);
        }
        result
    }

    /// The divisor, made harmless: 1 in place of 0 and -1; and whether it is 0 and -1.
    fn divisor(&mut self, b: Value, ty: Elementary) -> (Value, Value, Value) {
        let zero = self.b.icmp_imm(IntCc::Eq, b, 0);
        let minus = if ty.is_signed() { self.b.icmp_imm(IntCc::Eq, b, -1) } else { self.b.bool_const(false) };
        let special = self.b.or(zero, minus);
        let one = self.b.iconst(self.b.ty(b), 1);
        (self.b.select(special, one, b), zero, minus)
    }

    /// Towards zero; by 0: 0; the smallest number by -1: itself.
    fn divide(&mut self, a: Value, b: Value, ty: Elementary) -> Value {
        let (divisor, by_zero, by_minus) = self.divisor(b, ty);
        let op = if ty.is_signed() { Ir::Sdiv } else { Ir::Udiv };
        let quotient = self.b.binary(op, a, divisor);
        let none = self.zero(ty);
        let minus = self.b.isub(none, a);
        let quotient = self.b.select(by_minus, minus, quotient);
        if self.wants_flag() {
            let is_least = self.b.icmp_imm(IntCc::Eq, a, integer::least(ty.bits()));
            let overflow = self.b.and(by_minus, is_least);
            let failed = self.b.or(by_zero, overflow);
            self.fail_if(failed);
        }
        self.b.select(by_zero, none, quotient)
    }

    /// Sign of the dividend; by 0: 0.
    fn modulo(&mut self, a: Value, b: Value, ty: Elementary) -> Value {
        let (divisor, by_zero, by_minus) = self.divisor(b, ty);
        let op = if ty.is_signed() { Ir::Srem } else { Ir::Urem };
        let rest = self.b.binary(op, a, divisor);
        let none = self.zero(ty);
        self.fail_if(by_zero);
        let special = self.b.or(by_zero, by_minus);
        self.b.select(special, none, rest)
    }

    // Shifts.

    /// A count of at least the width leaves zeros, or copies of the sign. A negative count is taken modulo 256.
    fn shift_by(&mut self, op: BinaryOp, a: Value, count: Value, ty: Elementary, count_ty: Elementary) -> Value {
        let signed = op == BinaryOp::ShiftRight && ty.is_signed();
        let count = match self.b.ty(count) {
            Type::I64 => count,
            _ => self.as_i32(count, count_ty),
        };
        let count = if count_ty.is_signed() {
            let negative = self.b.icmp_imm(IntCc::Slt, count, 0);
            let low = self.masked(count, 0xFF);
            self.b.select(negative, low, count)
        } else {
            count
        };
        let width = i64::from(ty.bits());
        let beyond = self.b.icmp_imm(IntCc::Uge, count, width);
        let ir_count = bits::count_as(&mut self.b, count, value_type(ty));
        let ir = match (op, signed) {
            (BinaryOp::ShiftLeft, _) => Ir::Shl,
            (_, true) => Ir::Ashr,
            (_, false) => Ir::Lshr,
        };
        let shifted = self.b.binary(ir, a, ir_count);
        let left = if signed { self.b.binary_imm(Ir::Ashr, a, width - 1) } else { self.zero(ty) };
        self.b.select(beyond, left, shifted)
    }

    // Times of day.

    fn day_time(&mut self, op: BinaryOp, a: Value, b: Value, ty: Elementary) -> Value {
        let day = if ty == Elementary::Ltod { DAY_NS } else { DAY_MS };
        let a64 = if ty.bits() == 64 { a } else { self.b.zext(Type::I64, a) };
        // A TIME has a sign, whatever type its bits come as.
        let b64 = if self.b.ty(b).bits() == 64 { b } else { self.b.sext(Type::I64, b) };
        let day_value = self.b.iconst(Type::I64, day);
        let rest = self.b.binary(Ir::Srem, b64, day_value);
        let sum = if op == BinaryOp::AddDay { self.b.iadd(a64, rest) } else { self.b.isub(a64, rest) };
        let below = self.b.icmp_imm(IntCc::Slt, sum, 0);
        let above = self.b.icmp_imm(IntCc::Sge, sum, day);
        let (more, less) = (self.b.iadd(sum, day_value), self.b.isub(sum, day_value));
        let result = self.b.select(above, less, sum);
        let result = self.b.select(below, more, result);
        if self.wants_flag() {
            let whole_days = self.b.icmp(IntCc::Ne, rest, b64);
            let wrapped = self.b.or(below, above);
            let failed = self.b.or(wrapped, whole_days);
            self.fail_if(failed);
        }
        self.narrowed(result, value_type(ty))
    }

    // Comparisons.

    pub fn compare(&mut self, op: CompareOp, a: Value, b: Value, ty: Elementary) -> Value {
        if ty.is_float() {
            return compare::floats(&mut self.b, compare::float_condition(op), a, b);
        }
        let cc = compare::integer_condition(op, ty.is_signed());
        if ty == Elementary::Bool {
            let (a, b) = (self.b.zext(Type::I32, a), self.b.zext(Type::I32, b));
            return self.b.icmp(cc, a, b);
        }
        self.b.icmp(cc, a, b)
    }

    fn min_max(&mut self, op: BinaryOp, a: Value, b: Value, ty: Elementary) -> Value {
        let compare = if op == BinaryOp::Min { CompareOp::Less } else { CompareOp::Greater };
        let second = self.compare(compare, b, a, ty);
        let chosen = self.b.select(second, b, a);
        if !ty.is_float() {
            return chosen;
        }
        // A first operand that is not a number has been chosen already.
        let nan = self.b.fcmp(FloatCc::Uno, b, b);
        let result = self.b.select(nan, b, chosen);
        self.checked_float(result)
    }

    /// An integer as a float of `to`.
    pub fn as_float(&mut self, value: Value, ty: Elementary, to: Type) -> Value {
        let (op, wide) = match (ty.is_signed(), self.b.ty(value).bits()) {
            (true, 32 | 64) => (ConvertOp::FromSint, value),
            (true, _) => (ConvertOp::FromSint, self.b.sext(Type::I32, value)),
            (false, 64) => (ConvertOp::FromUint, value),
            (false, _) => (ConvertOp::FromSint, self.b.zext(Type::I64, value)),
        };
        self.b.convert(op, to, wide)
    }
}
