//! REAL and LREAL: what a result is, and which integers hold it.

use plcc_ir::{BinaryOp, FloatCc, FunctionBuilder, IntCc, Type, UnaryOp, Value};

/// Every NaN that an operation produces: all bits are 1.
pub const NAN: i64 = -1;
/// The bits of infinity and of the smallest normal number.
pub const INFINITY: i64 = 0x7F80_0000;
const LEAST_NORMAL: i64 = 0x0080_0000;
const INFINITY_LONG: i64 = 0x7FF0_0000_0000_0000;
const LEAST_NORMAL_LONG: i64 = 0x0010_0000_0000_0000;

/// `value` as a constant of type `ty`, f32 or f64.
pub fn constant(b: &mut FunctionBuilder, ty: Type, value: f64) -> Value {
    match ty {
        Type::F32 => b.f32_const(value as f32),
        _ => b.iconst(ty, value.to_bits() as i64),
    }
}

/// i1: neither infinite nor NaN.
pub fn is_finite(b: &mut FunctionBuilder, x: Value) -> Value {
    let magnitude = b.unary(UnaryOp::Fabs, x);
    let infinity = constant(b, b.ty(x), f64::INFINITY);
    b.fcmp(FloatCc::Lt, magnitude, infinity)
}

/// The same from the bits of an f32, where they are needed anyway.
pub fn is_finite_from_bits(b: &mut FunctionBuilder, bits: Value) -> Value {
    let exponent = b.binary_imm(BinaryOp::And, bits, INFINITY);
    b.icmp_imm(IntCc::Ne, exponent, INFINITY)
}

/// The bits of a float, an integer, without its sign.
pub fn magnitude_bits(b: &mut FunctionBuilder, bits: Value) -> Value {
    let mask = if b.ty(bits) == Type::I32 { i64::from(i32::MAX) } else { i64::MAX };
    b.binary_imm(BinaryOp::And, bits, mask)
}

/// Two i1 about [`magnitude_bits`]: the float is not 0; it is infinite, NaN or denormal.
pub fn not_normal(b: &mut FunctionBuilder, magnitude: Value) -> (Value, Value) {
    let (least, infinity) = match b.ty(magnitude) {
        Type::I32 => (LEAST_NORMAL, INFINITY),
        _ => (LEAST_NORMAL_LONG, INFINITY_LONG),
    };
    let not_zero = b.icmp_imm(IntCc::Ne, magnitude, 0);
    let above_least = b.binary_imm(BinaryOp::Isub, magnitude, least);
    let outside = b.icmp_imm(IntCc::Uge, above_least, infinity - least);
    (not_zero, b.and(not_zero, outside))
}

/// i1: not 0 and not denormal, from [`magnitude_bits`] of an f32.
pub fn counts_as_not_zero(b: &mut FunctionBuilder, magnitude: Value) -> Value {
    b.icmp_imm(IntCc::Uge, magnitude, LEAST_NORMAL)
}

/// i1: if `x op y` is 0, the exact result is not: an underflow. Sums are exact there.
pub fn zero_is_inexact(b: &mut FunctionBuilder, op: BinaryOp, x: Value, y: Value) -> Value {
    if !matches!(op, BinaryOp::Fmul | BinaryOp::Fdiv) {
        return b.bool_const(false);
    }
    let zero = constant(b, b.ty(x), 0.0);
    let x_set = b.fcmp(FloatCc::Ne, x, zero);
    let y_set = if op == BinaryOp::Fmul { b.fcmp(FloatCc::Ne, y, zero) } else { is_finite(b, y) };
    b.and(x_set, y_set)
}

/// i1: an integer of this many bits can hold `x`, which is whole or is rounded towards 0; false for NaN.
pub fn fits_integer(b: &mut FunctionBuilder, x: Value, bits: u32, signed: bool) -> Value {
    let above = 2f64.powi((bits - u32::from(signed)) as i32);
    let ty = b.ty(x);
    let (low, high) = (constant(b, ty, if signed { -above } else { 0.0 }), constant(b, ty, above));
    let (at_least, below) = (b.fcmp(FloatCc::Ge, x, low), b.fcmp(FloatCc::Lt, x, high));
    b.and(at_least, below)
}
