//! The meaning of the pure operations, on bit patterns: one implementation for constant folding and the interpreter.
//!
//! A value is a `u64` that holds the bits of its type, zero-extended.

use plcc_abi::Type;

use crate::instructions::{BinaryOp, ConvertOp, FloatCc, IntCc, UnaryOp};

/// `bits` cut to the width of `ty`.
pub fn mask(ty: Type, bits: u64) -> u64 {
    match ty.bits() {
        64 => bits,
        width => bits & ((1 << width) - 1),
    }
}

/// `bits` of type `ty`, sign-extended.
pub fn signed(ty: Type, bits: u64) -> i64 {
    let shift = 64 - ty.bits();
    ((bits << shift) as i64) >> shift
}

fn f32_of(bits: u64) -> f32 {
    f32::from_bits(bits as u32)
}

fn f64_of(bits: u64) -> f64 {
    f64::from_bits(bits)
}

/// Applies `op` to a value of type `ty`.
pub fn unary(op: UnaryOp, ty: Type, arg: u64) -> u64 {
    match (op, ty) {
        (UnaryOp::Bswap, _) => arg.swap_bytes() >> (64 - ty.bits()),
        (UnaryOp::Ctz, _) => u64::from(arg.trailing_zeros().min(ty.bits())),
        (UnaryOp::Fneg, Type::F64) => arg ^ (1 << 63),
        (UnaryOp::Fneg, _) => arg ^ (1 << 31),
        (UnaryOp::Fabs, Type::F64) => arg & !(1 << 63),
        (UnaryOp::Fabs, _) => arg & !(1 << 31),
        (_, Type::F64) => f64_unary(op, f64_of(arg)).to_bits(),
        (_, _) => u64::from(f32_unary(op, f32_of(arg)).to_bits()),
    }
}

fn f32_unary(op: UnaryOp, x: f32) -> f32 {
    match op {
        UnaryOp::Fsqrt => x.sqrt(),
        UnaryOp::Fceil => x.ceil(),
        UnaryOp::Ffloor => x.floor(),
        UnaryOp::Ftrunc => x.trunc(),
        UnaryOp::Fnearest => x.round_ties_even(),
        UnaryOp::Bswap | UnaryOp::Ctz | UnaryOp::Fneg | UnaryOp::Fabs => unreachable!("handled on bits"),
    }
}

fn f64_unary(op: UnaryOp, x: f64) -> f64 {
    match op {
        UnaryOp::Fsqrt => x.sqrt(),
        UnaryOp::Fceil => x.ceil(),
        UnaryOp::Ffloor => x.floor(),
        UnaryOp::Ftrunc => x.trunc(),
        UnaryOp::Fnearest => x.round_ties_even(),
        UnaryOp::Bswap | UnaryOp::Ctz | UnaryOp::Fneg | UnaryOp::Fabs => unreachable!("handled on bits"),
    }
}

/// Applies `op` to two values of type `ty`; `None` for a division that its builder should have guarded.
pub fn binary(op: BinaryOp, ty: Type, a: u64, b: u64) -> Option<u64> {
    let width = ty.bits();
    let count = (b & u64::from(width.max(1) - 1)) as u32;
    Some(mask(
        ty,
        match op {
            BinaryOp::Iadd => a.wrapping_add(b),
            BinaryOp::Isub => a.wrapping_sub(b),
            BinaryOp::Imul => a.wrapping_mul(b),
            BinaryOp::Sdiv => divide(ty, a, b, i64::checked_div)?,
            BinaryOp::Srem => divide(ty, a, b, i64::checked_rem)?,
            BinaryOp::Udiv => a.checked_div(b)?,
            BinaryOp::Urem => a.checked_rem(b)?,
            BinaryOp::And => a & b,
            BinaryOp::Or => a | b,
            BinaryOp::Xor => a ^ b,
            BinaryOp::Shl => a << count,
            BinaryOp::Lshr => a >> count,
            BinaryOp::Ashr => (signed(ty, a) >> count) as u64,
            BinaryOp::Rotl => rotate_left(width, a, count),
            BinaryOp::Rotr => rotate_left(width, a, (width - count) % width),
            BinaryOp::Fadd | BinaryOp::Fsub | BinaryOp::Fmul | BinaryOp::Fdiv => float_binary(op, ty, a, b),
        },
    ))
}

fn divide(ty: Type, a: u64, b: u64, op: fn(i64, i64) -> Option<i64>) -> Option<u64> {
    let (a, b) = (signed(ty, a), signed(ty, b));
    let least = signed(ty, 1 << (ty.bits() - 1));
    if a == least && b == -1 { None } else { op(a, b).map(|result| result as u64) }
}

fn rotate_left(width: u32, a: u64, count: u32) -> u64 {
    if count == 0 { a } else { (a << count) | (a >> (width - count)) }
}

fn float_binary(op: BinaryOp, ty: Type, a: u64, b: u64) -> u64 {
    if ty == Type::F64 {
        let (a, b) = (f64_of(a), f64_of(b));
        match op {
            BinaryOp::Fadd => a + b,
            BinaryOp::Fsub => a - b,
            BinaryOp::Fmul => a * b,
            _ => a / b,
        }
        .to_bits()
    } else {
        let (a, b) = (f32_of(a), f32_of(b));
        let result = match op {
            BinaryOp::Fadd => a + b,
            BinaryOp::Fsub => a - b,
            BinaryOp::Fmul => a * b,
            _ => a / b,
        };
        u64::from(result.to_bits())
    }
}

/// Compares two integers of type `ty`.
pub fn int_compare(cc: IntCc, ty: Type, a: u64, b: u64) -> bool {
    let (sa, sb) = (signed(ty, a), signed(ty, b));
    match cc {
        IntCc::Eq => a == b,
        IntCc::Ne => a != b,
        IntCc::Slt => sa < sb,
        IntCc::Sle => sa <= sb,
        IntCc::Sgt => sa > sb,
        IntCc::Sge => sa >= sb,
        IntCc::Ult => a < b,
        IntCc::Ule => a <= b,
        IntCc::Ugt => a > b,
        IntCc::Uge => a >= b,
    }
}

/// Compares two floats of type `ty`.
pub fn float_compare(cc: FloatCc, ty: Type, a: u64, b: u64) -> bool {
    let widen = |bits| if ty == Type::F64 { f64_of(bits) } else { f64::from(f32_of(bits)) };
    let (a, b) = (widen(a), widen(b));
    match cc {
        FloatCc::Eq => a == b,
        FloatCc::Ne => a != b,
        FloatCc::Lt => a < b,
        FloatCc::Le => a <= b,
        FloatCc::Gt => a > b,
        FloatCc::Ge => a >= b,
        FloatCc::Uno => a.is_nan() || b.is_nan(),
    }
}

/// Converts a value of type `from` to `to`.
pub fn convert(op: ConvertOp, from: Type, to: Type, arg: u64) -> u64 {
    mask(
        to,
        match op {
            ConvertOp::Zext | ConvertOp::Trunc | ConvertOp::Bitcast => arg,
            ConvertOp::Sext => signed(from, arg) as u64,
            ConvertOp::FromSint if to == Type::F64 => (signed(from, arg) as f64).to_bits(),
            ConvertOp::FromSint => u64::from((signed(from, arg) as f32).to_bits()),
            ConvertOp::ToSint => {
                let x = if from == Type::F64 { f64_of(arg) } else { f64::from(f32_of(arg)) };
                if to == Type::I64 { x as i64 as u64 } else { x as i32 as u64 }
            }
            ConvertOp::FromUint if to == Type::F64 => (arg as f64).to_bits(),
            ConvertOp::FromUint => u64::from((arg as f32).to_bits()),
            ConvertOp::ToUint => {
                let x = if from == Type::F64 { f64_of(arg) } else { f64::from(f32_of(arg)) };
                if to == Type::I64 { x as u64 } else { u64::from(x as u32) }
            }
            ConvertOp::Fpromote => f64::from(f32_of(arg)).to_bits(),
            ConvertOp::Fdemote => u64::from((f64_of(arg) as f32).to_bits()),
        },
    )
}
