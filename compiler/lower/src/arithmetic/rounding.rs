//! REAL and LREAL as integers of at most 32 bits, without a branch and without a float that is rounded first.
//!
//! Adding 1.5 * 2^52 to an f64 leaves no room for a fraction: the addition rounds to the nearest integer, ties to even, which is then in the
//! low bits of the sum, and the whole sum says whether it fits. The sum less the constant is that integer as a float, which says on which side of
//! the operand it lies.

use plcc_ir::{BinaryOp, ConvertOp, FloatCc, Function, FunctionBuilder, InstData, IntCc, Type, UnaryOp, Value};

use super::float::constant;

/// 1.5 * 2^52.
const NO_FRACTION: f64 = 6_755_399_441_055_744.0;

/// An integer in i32, and an i1: it is what the float rounds to. Otherwise the integer means nothing.
pub struct Whole {
    pub value: Value,
    pub fits: Value,
}

/// `x`, f32 or f64, rounded by `rounding`, as an integer of `bits` bits, at most 32.
pub fn to_integer(b: &mut FunctionBuilder, x: Value, rounding: UnaryOp, bits: u32, signed: bool) -> Whole {
    let x = as_made(b.function(), x);
    let x = b.convert(ConvertOp::Fpromote, Type::F64, x);
    if rounding == UnaryOp::Ftrunc {
        return truncated(b, x, bits, signed);
    }
    let shift = constant(b, Type::F64, NO_FRACTION);
    let sum = b.binary(BinaryOp::Fadd, x, shift);
    let mut wide = b.bitcast(Type::I64, sum);
    if rounding != UnaryOp::Fnearest {
        let nearest = b.binary(BinaryOp::Fsub, sum, shift);
        let (cc, op) = match rounding {
            UnaryOp::Fceil => (FloatCc::Lt, BinaryOp::Iadd),
            _ => (FloatCc::Gt, BinaryOp::Isub),
        };
        let beyond = b.fcmp(cc, nearest, x);
        let beyond = b.zext(Type::I64, beyond);
        wide = b.binary(op, wide, beyond);
    }
    // As bits, sums count up by 1 from integer to integer. Those of floats without a fraction, infinities and NaNs are far away.
    let least = if signed { -(1 << (bits - 1)) } else { 0 };
    let above_least = b.binary_imm(BinaryOp::Iadd, wide, -(NO_FRACTION.to_bits() as i64) - least);
    let fits = b.icmp_imm(IntCc::Ule, above_least, (1 << bits) - 1);
    Whole { value: b.trunc(Type::I32, wide), fits }
}

/// `x`, an f64, rounded towards 0.
fn truncated(b: &mut FunctionBuilder, x: Value, bits: u32, signed: bool) -> Whole {
    // The operands that round to an integer that fits lie between these, which are exact.
    let least = if signed { -2f64.powi(bits as i32 - 1) } else { 0.0 };
    let low = constant(b, Type::F64, least - 1.0);
    let high = constant(b, Type::F64, 2f64.powi((bits - u32::from(signed)) as i32));
    let (not_below, not_above) = (b.fcmp(FloatCc::Gt, x, low), b.fcmp(FloatCc::Lt, x, high));
    let fits = b.and(not_below, not_above);
    let wide = b.convert(ConvertOp::ToSint, Type::I64, x);
    Whole { value: b.trunc(Type::I32, wide), fits }
}

/// What the host made, if `x` is that in the form that the CPU gives to a NaN. Whoever asks for the number does not see the form.
fn as_made(function: &Function, x: Value) -> Value {
    let cast = |value: Value| match function.defining(value) {
        Some(&InstData::Convert { op: ConvertOp::Bitcast, arg }) => Some(arg),
        _ => None,
    };
    // The float that is tested, and what is chosen if it is a number.
    let formed = |value: Value| {
        let &InstData::Select { cond, if_true, if_false } = function.defining(value)? else { return None };
        let &InstData::FloatCompare { cc: FloatCc::Uno, args: [a, b] } = function.defining(cond)? else { return None };
        let ones: u64 = if matches!(function.ty(value), Type::F32 | Type::I32) { u32::MAX.into() } else { u64::MAX };
        let is_form = function.resolve(a) == function.resolve(b) && function.constant(if_true) == Some(ones);
        is_form.then(|| (function.resolve(a), function.resolve(if_false)))
    };
    let bits = cast(x);
    let float = bits.and_then(cast).unwrap_or(x);
    match (formed(float), bits.and_then(formed)) {
        (Some((made, chosen)), _) if made == chosen => made,
        (_, Some((made, chosen))) if cast(chosen).map(|float| function.resolve(float)) == Some(made) => made,
        _ => x,
    }
}

/// `x`, f32 or f64, rounded to the nearest integer of 32 bits, halves away from zero.
pub fn to_integer_half_away(b: &mut FunctionBuilder, x: Value) -> Whole {
    // An f64 holds the sum with a half exactly where it matters.
    let x = b.convert(ConvertOp::Fpromote, Type::F64, x);
    let bits = b.bitcast(Type::I64, x);
    let sign = b.binary_imm(BinaryOp::And, bits, i64::MIN);
    let half = b.binary_imm(BinaryOp::Or, sign, 0.5f64.to_bits() as i64);
    let half = b.bitcast(Type::F64, half);
    let sum = b.binary(BinaryOp::Fadd, x, half);
    to_integer(b, sum, UnaryOp::Ftrunc, 32, true)
}
