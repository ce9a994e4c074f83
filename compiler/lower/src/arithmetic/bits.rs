//! Shifts and rotates with the last bit out, and numbers of bits.

use plcc_ir::{BinaryOp, ConvertOp, FunctionBuilder, IntCc, Type, Value};

/// Shifts `wide`, the value extended to an i64, by `count`, an i64 of at most `width` + 1: the low `width` bits of the result,
/// and the bit that was shifted out last, an i1.
///
/// There is one bit of room at the end where bits leave, so that the last one out can be read there.
pub fn shift(b: &mut FunctionBuilder, op: BinaryOp, wide: Value, count: Value, width: u32) -> (Value, Value) {
    let (shifted, last) = if op == BinaryOp::Shl {
        let shifted = b.binary(BinaryOp::Shl, wide, count);
        (shifted, b.binary_imm(BinaryOp::Lshr, shifted, i64::from(width)))
    } else {
        let room = b.binary_imm(BinaryOp::Shl, wide, 1);
        let last = b.binary(op, room, count);
        (b.binary_imm(op, last, 1), last)
    };
    (shifted, b.trunc(Type::I1, last))
}

/// Rotates by `count`, of the value's type; and the bit that was moved last from one end to the other, an i1.
pub fn rotate(b: &mut FunctionBuilder, op: BinaryOp, value: Value, count: Value) -> (Value, Value) {
    let result = b.binary(op, value, count);
    let highest = i64::from(b.ty(value).bits()) - 1;
    let last = if op == BinaryOp::Rotl { result } else { b.binary_imm(BinaryOp::Lshr, result, highest) };
    (result, b.trunc(Type::I1, last))
}

/// Number of the lowest bit that is 1, an i64, 0 if there is none; and i1: there is none.
pub fn lowest_bit(b: &mut FunctionBuilder, x: Value) -> (Value, Value) {
    let wide = b.zext(Type::I64, x);
    let zero = b.iconst(Type::I64, 0);
    let minus = b.isub(zero, wide);
    let lowest = b.and(wide, minus);
    // The exponent of that bit alone as a float.
    let float = b.convert(ConvertOp::FromUint, Type::F64, lowest);
    let bits = b.bitcast(Type::I64, float);
    let exponent = b.binary_imm(BinaryOp::Lshr, bits, 52);
    let number = b.binary_imm(BinaryOp::Isub, exponent, 1023);
    let none = b.icmp_imm(IntCc::Eq, wide, 0);
    (b.select(none, zero, number), none)
}

/// A value of `ty` in which only bit `number`, modulo the width, is 1.
pub fn only_bit(b: &mut FunctionBuilder, ty: Type, number: Value) -> Value {
    let one = b.iconst(ty, 1);
    let count = count_as(b, number, ty);
    b.binary(BinaryOp::Shl, one, count)
}

/// A count as a value of the shifted type, its low bits: the IR takes it modulo the width, which is a power of two.
pub fn count_as(b: &mut FunctionBuilder, count: Value, ty: Type) -> Value {
    if b.ty(count).bits() < ty.bits() { b.zext(ty, count) } else { b.trunc(ty, count) }
}
