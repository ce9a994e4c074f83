//! Which bits of a value are surely 0.
//!
//! The accumulators are 32 bits wide and most instructions work on their low word, so that values are cut apart and put
//! together all the time. Facts about zero bits undo this, and decide bounds checks.

use plcc_abi::layout;
use plcc_ir::{Address, BinaryOp, ConvertOp, Function, InstData, Region, Value, eval};

/// How far operands are followed: deep enough for a word that went through an accumulator.
const DEPTH_MAX: u32 = 4;

/// Bits of `value` that are 0 whenever it is computed; those above its type are set too.
pub fn known_zero(function: &Function, value: Value) -> u64 {
    zero_bits(function, value, DEPTH_MAX)
}

/// The largest value that an integer can have, unsigned.
pub fn unsigned_max(function: &Function, value: Value) -> u64 {
    let possible = !known_zero(function, value);
    // Any bit below the highest possible one may be set.
    let bits_max = if possible == 0 { 0 } else { u64::MAX >> possible.leading_zeros() };
    match function.defining(value) {
        Some(InstData::Const { bits }) => *bits,
        Some(InstData::Binary { op: BinaryOp::Iadd, args: [a, b] }) => {
            let sum = simple_max(function, *a).saturating_add(simple_max(function, *b));
            // Beyond the type it may have wrapped.
            if sum <= eval::mask(function.ty(value), u64::MAX) { sum.min(bits_max) } else { bits_max }
        }
        _ => bits_max,
    }
}

fn simple_max(function: &Function, value: Value) -> u64 {
    match function.constant(value) {
        Some(bits) => bits,
        None => {
            let possible = !known_zero(function, value);
            if possible == 0 { 0 } else { u64::MAX >> possible.leading_zeros() }
        }
    }
}

fn zero_bits(function: &Function, value: Value, depth: u32) -> u64 {
    let ty = function.ty(value);
    let above = !eval::mask(ty, u64::MAX);
    let Some(data) = function.defining(value) else { return above };
    if let InstData::Const { bits } = data {
        return !bits;
    }
    if depth == 0 || !ty.is_int() {
        return above;
    }
    let of = |value| zero_bits(function, value, depth - 1);
    let zeros = match *data {
        InstData::Binary { op, args: [a, b] } => match op {
            BinaryOp::And => of(a) | of(b),
            BinaryOp::Or | BinaryOp::Xor => of(a) & of(b),
            BinaryOp::Shl => match shift_count(function, ty, b) {
                Some(count) => (of(a) << count) | ((1 << count) - 1),
                None => 0,
            },
            BinaryOp::Lshr => match shift_count(function, ty, b) {
                Some(count) => !(!of(a) >> count),
                None => 0,
            },
            BinaryOp::Iadd
            | BinaryOp::Isub
            | BinaryOp::Imul
            | BinaryOp::Sdiv
            | BinaryOp::Srem
            | BinaryOp::Udiv
            | BinaryOp::Urem
            | BinaryOp::Ashr
            | BinaryOp::Rotl
            | BinaryOp::Rotr
            | BinaryOp::Fadd
            | BinaryOp::Fsub
            | BinaryOp::Fmul
            | BinaryOp::Fdiv => 0,
        },
        InstData::Convert { op: ConvertOp::Zext | ConvertOp::Trunc, arg } => of(arg),
        // All L stacks are below the DB table.
        InstData::AddressOf { addr: Address { region: Region::L | Region::V, base: None, offset } }
            if offset <= layout::L_CLASS_BYTES =>
        {
            !u64::from(layout::DB_TABLE.next_power_of_two() - 1)
        }
        InstData::DbBase { .. } => !u64::from(layout::END_MAX - 1),
        InstData::Select { if_true, if_false, .. } => of(if_true) & of(if_false),
        _ => 0,
    };
    zeros | above
}

/// The constant count of a shift of a `ty`, modulo its width.
pub fn shift_count(function: &Function, ty: plcc_ir::Type, count: Value) -> Option<u32> {
    function.constant(count).map(|bits| (bits & u64::from(ty.bits() - 1)) as u32)
}
