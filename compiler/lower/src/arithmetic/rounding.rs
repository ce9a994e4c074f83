//! REAL and LREAL as integers of at most 32 bits, without a branch and without a float that is rounded first.
//!
//! Adding 1.5 * 2^52 to an f64 leaves no room for a fraction: the addition rounds to the nearest integer, ties to even, which is then in the
//! low bits of the sum. The sum less the constant is that integer as a float, which says on which side of the operand it lies.

use plcc_ir::{BinaryOp, ConvertOp, FloatCc, FunctionBuilder, Type, UnaryOp, Value};

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
    let x = b.convert(ConvertOp::Fpromote, Type::F64, x);
    let least = if signed { -2f64.powi(bits as i32 - 1) } else { 0.0 };
    let above = 2f64.powi((bits - u32::from(signed)) as i32);
    // The operands that round to an integer that fits, as an interval. All limits are exact.
    let (low, high) = match rounding {
        UnaryOp::Fnearest => ((FloatCc::Ge, least - 0.5), (FloatCc::Lt, above - 0.5)),
        UnaryOp::Fceil => ((FloatCc::Gt, least - 1.0), (FloatCc::Le, above - 1.0)),
        UnaryOp::Ffloor => ((FloatCc::Ge, least), (FloatCc::Lt, above)),
        _ => ((FloatCc::Gt, least - 1.0), (FloatCc::Lt, above)),
    };
    let mut compare = |(cc, limit)| {
        let limit = constant(b, Type::F64, limit);
        b.fcmp(cc, x, limit)
    };
    let (not_below, not_above) = (compare(low), compare(high));
    let fits = b.and(not_below, not_above);
    let value = match rounding {
        UnaryOp::Fnearest => nearest(b, x).0,
        UnaryOp::Fceil => {
            let (value, float) = nearest(b, x);
            let beyond = is(b, FloatCc::Lt, float, x);
            b.binary(BinaryOp::Iadd, value, beyond)
        }
        UnaryOp::Ffloor => {
            let (value, float) = nearest(b, x);
            let beyond = is(b, FloatCc::Gt, float, x);
            b.binary(BinaryOp::Isub, value, beyond)
        }
        _ => {
            let wide = b.convert(ConvertOp::ToSint, Type::I64, x);
            b.trunc(Type::I32, wide)
        }
    };
    Whole { value, fits }
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

/// The nearest integer, ties to even, as i32 and as f64.
fn nearest(b: &mut FunctionBuilder, x: Value) -> (Value, Value) {
    let shift = constant(b, Type::F64, NO_FRACTION);
    let sum = b.binary(BinaryOp::Fadd, x, shift);
    let bits = b.bitcast(Type::I64, sum);
    let float = b.binary(BinaryOp::Fsub, sum, shift);
    (b.trunc(Type::I32, bits), float)
}

/// 1 in i32 if the comparison holds, else 0.
fn is(b: &mut FunctionBuilder, cc: FloatCc, left: Value, right: Value) -> Value {
    let holds = b.fcmp(cc, left, right);
    b.zext(Type::I32, holds)
}
