//! Integers: the wrapped result, and whether the exact one is another.

use plcc_ir::{BinaryOp, FunctionBuilder, IntCc, Type, Value};

/// An exact signed result and its low half.
pub struct Narrowed {
    /// In twice the width.
    pub exact: Value,
    pub value: Value,
    /// i1: `value` is not the exact result.
    pub overflow: Value,
}

impl Narrowed {
    fn new(b: &mut FunctionBuilder, exact: Value, to: Type) -> Narrowed {
        let value = b.trunc(to, exact);
        let kept = b.sext(b.ty(exact), value);
        Narrowed { exact, value, overflow: b.icmp(IntCc::Ne, exact, kept) }
    }
}

/// The integer type of twice the width of `ty`, 8 to 32 bits.
fn wider(ty: Type) -> Type {
    match ty {
        Type::I8 => Type::I16,
        Type::I16 => Type::I32,
        _ => Type::I64,
    }
}

/// i1: `result`, the wrapped sum or difference of two signed integers, is not the exact one: the signs of the operands do not
/// allow that of the result. Best where the sign of the result is a flag as well.
pub fn sum_overflow(b: &mut FunctionBuilder, op: BinaryOp, x: Value, y: Value, result: Value) -> Value {
    let from_x = b.xor(x, result);
    let other = if op == BinaryOp::Iadd { b.xor(y, result) } else { b.xor(x, y) };
    let both = b.and(from_x, other);
    b.icmp_imm(IntCc::Slt, both, 0)
}

/// i1: `result`, the wrapped sum, difference or product of `x` and `y`, is not the exact one. Best in expressions, where a
/// result is an operand of the next operation.
pub fn overflow(b: &mut FunctionBuilder, op: BinaryOp, signed: bool, x: Value, y: Value, result: Value) -> Value {
    match (op, signed, b.ty(x)) {
        (BinaryOp::Iadd, false, _) => b.icmp(IntCc::Ult, result, x),
        (BinaryOp::Isub, false, _) => b.icmp(IntCc::Ult, x, y),
        (BinaryOp::Iadd | BinaryOp::Isub, true, Type::I64) => sum_overflow(b, op, x, y, result),
        (_, _, Type::I64) => long_product_overflow(b, signed, x, y, result),
        _ => {
            // Extended operands and results are shared with the operations before and after.
            let (x, y) = (extended(b, x, signed), extended(b, y, signed));
            let exact = b.binary(op, x, y);
            let kept = extended(b, result, signed);
            b.icmp(IntCc::Ne, exact, kept)
        }
    }
}

fn extended(b: &mut FunctionBuilder, value: Value, signed: bool) -> Value {
    if signed { b.sext(Type::I64, value) } else { b.zext(Type::I64, value) }
}

/// The product of two signed integers of at most 32 bits.
pub fn product(b: &mut FunctionBuilder, x: Value, y: Value) -> Narrowed {
    let ty = b.ty(x);
    let (x, y) = (b.sext(wider(ty), x), b.sext(wider(ty), y));
    let exact = b.binary(BinaryOp::Imul, x, y);
    Narrowed::new(b, exact, ty)
}

/// The same for a product of integers of 64 bits.
fn long_product_overflow(b: &mut FunctionBuilder, signed: bool, x: Value, y: Value, result: Value) -> Value {
    // The product divided by a factor is the other factor; 0 is always right, and -1 only wrong for the smallest number.
    let zero = b.icmp_imm(IntCc::Eq, x, 0);
    let minus = if signed { b.icmp_imm(IntCc::Eq, x, -1) } else { b.bool_const(false) };
    let trivial = b.or(zero, minus);
    let one = b.iconst(Type::I64, 1);
    let divisor = b.select(trivial, one, x);
    let back = b.binary(if signed { BinaryOp::Sdiv } else { BinaryOp::Udiv }, result, divisor);
    let differs = b.icmp(IntCc::Ne, back, y);
    let usual = b.not(trivial);
    let wrong = b.and(usual, differs);
    let is_least = b.icmp_imm(IntCc::Eq, y, i64::MIN);
    let least_negated = b.and(minus, is_least);
    b.or(wrong, least_negated)
}

/// The quotient of two signed integers of the width of `to` that are sign-extended to twice that: the smallest number divided
/// by -1 does not fit. The divisor is not 0.
pub fn quotient(b: &mut FunctionBuilder, x: Value, divisor: Value, to: Type) -> Narrowed {
    let exact = b.binary(BinaryOp::Sdiv, x, divisor);
    Narrowed::new(b, exact, to)
}

/// Like [`quotient`], for integers of 16 bits; and an i32 with the remainder in the high word, the quotient in the low one.
pub fn quotient_and_remainder(b: &mut FunctionBuilder, x: Value, divisor: Value) -> (Narrowed, Value) {
    let exact = b.binary(BinaryOp::Sdiv, x, divisor);
    let remainder = b.binary(BinaryOp::Srem, x, divisor);
    let quotient = Narrowed::new(b, exact, Type::I16);
    let high = b.binary_imm(BinaryOp::Shl, remainder, 16);
    let low = b.zext(Type::I32, quotient.value);
    let both = b.or(high, low);
    (quotient, both)
}

/// The two's complement; the smallest number stays.
pub fn negated(b: &mut FunctionBuilder, x: Value) -> Value {
    let zero = b.iconst(b.ty(x), 0);
    b.isub(zero, x)
}

/// The smallest number of a signed type of this many bits.
pub const fn least(bits: u32) -> i64 {
    i64::MIN >> (64 - bits)
}
