//! What an instruction becomes when the ranges of its operands are known.

use super::analysis::Ranges;
use super::interval::{self, Interval};
use plcc_ir::{Address, BinaryOp, ConvertOp, Function, Inst, InstData, Type, Value, eval};

/// Sums with constants that are looked through: a loop that was unrolled twice has two, one for each.
const CHAIN_MAX: usize = 3;

/// What becomes of an instruction.
pub enum Change {
    /// Its result is this constant.
    Constant(u64),
    /// Its result is another value.
    Value(Value),
    /// It is another operation with a constant operand, or with none.
    Shift(BinaryOp, Value, u64),
    /// It is a shifted value, and a constant added.
    ShiftAndAdd(Part, u64),
    /// It is the sum of two shifted values.
    SumOfShifts([Part; 2]),
    /// It is a masked value, and a constant added.
    MaskAndAdd(Value, u64, u64),
    /// It is an extended value, and a constant added.
    ExtendAndAdd(ConvertOp, Value, u64),
    /// Its addresses are these; a copy has two.
    Addresses([Option<Address>; 2]),
    /// Its only address begins at a value and a constant added, which is negative.
    AddressFrom(Value, u64, Address),
}

/// A value that is shifted by a constant, or multiplied with one.
#[derive(Clone, Copy)]
pub struct Part {
    pub op: BinaryOp,
    pub arg: Value,
    pub by: u64,
}

/// What an instruction without memory becomes, if the ranges of its operands or of its result say more than it does.
pub fn change_of(function: &Function, ranges: &Ranges<'_>, inst: Inst) -> Option<Change> {
    let &[result] = &function.results[inst][..] else { return None };
    let ty = function.ty(result);
    let data = &function.insts[inst];
    if matches!(data, InstData::Const { .. }) || data.has_side_effect() || !(ty.is_int() || ty == Type::I1) {
        return None;
    }
    let range = ranges.get(result)?;
    if let Some(number) = range.single()
        && is_computed(data)
    {
        return Some(Change::Constant(eval::mask(ty, number as u64)));
    }
    match *data {
        InstData::Binary { op, args: [a, b] } if ty != Type::I1 => {
            let (of_a, of_b) = (ranges.get(a)?, ranges.get(b)?);
            if op == BinaryOp::Or && of_a.single().is_some() {
                return binary(function, ranges, op, ty, (b, of_b), of_a);
            }
            binary(function, ranges, op, ty, (a, of_a), of_b)
        }
        InstData::Select { cond, if_true, if_false } => {
            let chosen = ranges.get(cond)?.single()?;
            Some(Change::Value(if chosen != 0 { if_true } else { if_false }))
        }
        InstData::Convert { op: op @ (ConvertOp::Sext | ConvertOp::Zext), arg } => match *function.defining(arg)? {
            // Out of the narrow type and back into it.
            InstData::Convert { op: ConvertOp::Trunc, arg: wide } if function.ty(wide) == ty => {
                let narrow = Interval::full(function.ty(arg));
                (function.ty(arg) != Type::I1
                    && narrow.contains(ranges.get(wide)?)
                    && range.contains(ranges.get(wide)?))
                .then_some(Change::Value(wide))
            }
            // An index and a constant: in the wide type, the constant goes into the address.
            InstData::Binary { op: BinaryOp::Iadd, .. } => {
                let (x, by) = sum_with_constant(function, ranges, arg)?;
                let (of_x, full) = (ranges.get(x)?, Interval::full(function.ty(arg)));
                let sum = of_x.lo.checked_add(by)?..=of_x.hi.checked_add(by)?;
                let fits = *sum.start() >= full.lo && *sum.end() <= full.hi;
                let is_same = op == ConvertOp::Sext || of_x.is_natural() && *sum.start() >= 0;
                (fits && is_same && function.constant(x).is_none()).then_some(Change::ExtendAndAdd(op, x, by as u64))
            }
            _ => None,
        },
        _ => None,
    }
}

/// True of operations without memory: a load whose result is known is left to the pass for memory.
fn is_computed(data: &InstData) -> bool {
    matches!(
        data,
        InstData::Binary { .. } | InstData::IntCompare { .. } | InstData::Convert { .. } | InstData::Select { .. }
    )
}

fn binary(
    function: &Function,
    ranges: &Ranges<'_>,
    op: BinaryOp,
    ty: Type,
    (a, of_a): (Value, Interval),
    of_b: Interval,
) -> Option<Change> {
    let constant = of_b.single()?;
    let count = (constant & i64::from(ty.bits() - 1)) as u32;
    match op {
        // The low bits of a sum with a multiple of a power of two.
        BinaryOp::And
            if is_low_mask(constant)
                && let Some(low) = low_bits_of_sum(function, ranges, a, constant) =>
        {
            Some(Change::Constant(low))
        }
        BinaryOp::And if is_low_mask(constant) => match sum_with_constant(function, ranges, a) {
            // The address in a pointer that stays within its area: the constant goes into the address.
            Some((x, by))
                if let Some(of_x) = ranges.get(x)
                    && is_within_area(of_x, by, constant) =>
            {
                mask(a, of_a, constant).or(Some(Change::MaskAndAdd(x, constant as u64, by as u64)))
            }
            _ => mask(a, of_a, constant),
        },
        BinaryOp::And => mask(a, of_a, constant),
        // Bits that were cleared come back.
        BinaryOp::Or => match *function.defining(a)? {
            InstData::Binary { op: BinaryOp::And, args: [x, kept] } => {
                let kept = ranges.get(kept)?.single()?;
                let cleared = interval::common_bits(ranges.get(x)?, kept)?;
                (constant == cleared).then_some(Change::Value(x))
            }
            _ => None,
        },
        // The multiple of a sum with a constant is a sum of multiples, whose constant goes into the address.
        BinaryOp::Shl if let Some((x, by)) = sum_with_constant(function, ranges, a) => {
            let by = (by as u64).wrapping_shl(count);
            let part = Part { op, arg: x, by: u64::from(count) };
            function.constant(x).is_none().then_some(Change::ShiftAndAdd(part, by))
        }
        // Multiples, of indices, are shifted one by one: that ends their shift left.
        BinaryOp::Ashr | BinaryOp::Lshr if let Some(parts) = shifted_parts(function, ranges, a, count) => {
            Some(Change::SumOfShifts(parts.map(|arg| part_of(function, ranges, op, arg, count))))
        }
        // The shifted sum of a multiple and a constant is the sum of both shifted.
        BinaryOp::Ashr | BinaryOp::Lshr
            if let Some((x, of_x, by)) = shifted_sum(function, ranges, a, count)
                && (op == BinaryOp::Ashr || of_x.is_natural() && of_a.is_natural()) =>
        {
            Some(Change::ShiftAndAdd(part_of(function, ranges, op, x, count), by as u64))
        }
        // A multiple that is shifted right: the bits of an index are those of its bytes.
        BinaryOp::Ashr | BinaryOp::Lshr if let Some((x, factor)) = shifted_product(function, ranges, op, a, count) => {
            Some(Change::Shift(BinaryOp::Imul, x, factor))
        }
        // Left and right again: without a wrap it is one shift.
        BinaryOp::Ashr | BinaryOp::Lshr => {
            let (inner, first) = match *function.defining(a)? {
                InstData::Binary { op: BinaryOp::Shl, args: [x, first] } => (x, ranges.get(first)?.single()?),
                _ => return natural(op, a, of_a, constant),
            };
            let first = (first & i64::from(ty.bits() - 1)) as u32;
            let of_inner = ranges.get(inner)?;
            let whole = interval::binary(BinaryOp::Shl, ty, of_inner, Interval::between(first.into(), first.into()));
            let fits = i128::from(of_inner.lo) << first == i128::from(whole.lo)
                && i128::from(of_inner.hi) << first == i128::from(whole.hi);
            if !fits || (op == BinaryOp::Lshr && !of_inner.is_natural()) {
                return natural(op, a, of_a, constant);
            }
            Some(match first.cmp(&count) {
                std::cmp::Ordering::Equal => Change::Value(inner),
                std::cmp::Ordering::Greater => Change::Shift(BinaryOp::Shl, inner, u64::from(first - count)),
                std::cmp::Ordering::Less => Change::Shift(op, inner, u64::from(count - first)),
            })
        }
        // Divisions of natural numbers by a power of two.
        BinaryOp::Sdiv | BinaryOp::Udiv if of_a.is_natural() && constant > 0 && constant.count_ones() == 1 => {
            Some(Change::Shift(BinaryOp::Lshr, a, constant.trailing_zeros().into()))
        }
        BinaryOp::Srem | BinaryOp::Urem if of_a.is_natural() && constant > of_a.hi => Some(Change::Value(a)),
        BinaryOp::Srem if of_a.is_natural() && constant > 0 && constant.count_ones() == 1 => {
            Some(Change::Shift(BinaryOp::And, a, constant as u64 - 1))
        }
        // Others by a product, which is right as it is where no number is negative.
        BinaryOp::Sdiv | BinaryOp::Srem if of_a.is_natural() && constant > 2 && ty.bits() <= 16 => {
            let op = if op == BinaryOp::Sdiv { BinaryOp::Udiv } else { BinaryOp::Urem };
            Some(Change::Shift(op, a, constant as u64))
        }
        _ => None,
    }
}

/// True if the bits of `mask`, the low ones, do not overflow when `by` is added: all numbers have the same bits above them, before and after.
fn is_within_area(range: Interval, by: i64, mask: i64) -> bool {
    let (Some(lo), Some(hi)) = (range.lo.checked_add(by), range.hi.checked_add(by)) else { return false };
    let above = |number: i64| number & !mask;
    [range.hi, lo, hi].into_iter().all(|end| above(end) == above(range.lo))
}

/// A mask that keeps all bits that can be set changes nothing.
fn mask(a: Value, of_a: Interval, constant: i64) -> Option<Change> {
    let low = (1i64 << of_a.zeros.min(62)) - 1;
    let keeps = if constant >= 0 {
        of_a.is_natural() && bits_of(of_a) & !low & !constant == 0
    } else {
        of_a.zeros > 0 && constant | low == -1
    };
    keeps.then_some(Change::Value(a))
}

/// Whether the ones of a constant are its low bits; also of the largest.
const fn is_low_mask(constant: i64) -> bool {
    constant > 0 && constant & constant.wrapping_add(1) == 0
}

/// Whether an operation clears bits.
pub fn is_mask(data: &InstData) -> bool {
    matches!(data, InstData::Binary { op: BinaryOp::And, .. })
}

/// The operand of a sum with a constant, and the constant.
pub fn sum_with_constant(function: &Function, ranges: &Ranges<'_>, sum: Value) -> Option<(Value, i64)> {
    match *function.defining(sum)? {
        InstData::Binary { op: BinaryOp::Iadd, args: [x, by] } => Some((x, ranges.get(by)?.single()?)),
        _ => None,
    }
}

/// The operand of a sum with a constant that does not wrap, and that constant shifted right by `count`, if the bits that are shifted
/// out do not carry.
fn shifted_sum(function: &Function, ranges: &Ranges<'_>, sum: Value, count: u32) -> Option<(Value, Interval, i64)> {
    let full = Interval::full(function.ty(sum));
    let (mut x, mut by) = sum_with_constant(function, ranges, sum)?;
    for _ in 0..CHAIN_MAX {
        let of_x = ranges.get(x)?;
        let fits = of_x.lo.checked_add(by)? >= full.lo && of_x.hi.checked_add(by)? <= full.hi;
        // A multiple of 4 has room for 3.
        let low = by & ((1i64 << count.min(62)) - 1);
        let carries = low >= 1i64 << of_x.zeros.min(62);
        if fits && !carries && count > 0 && function.constant(x).is_none() {
            return Some((x, of_x, by >> count));
        }
        let (inner, more) = sum_with_constant(function, ranges, x)?;
        (x, by) = (inner, by.checked_add(more)?);
    }
    None
}

/// The bits of `mask`, the low ones, of a multiple of a power of two above them and constants.
fn low_bits_of_sum(function: &Function, ranges: &Ranges<'_>, sum: Value, mask: i64) -> Option<u64> {
    let (mut x, mut by) = sum_with_constant(function, ranges, sum)?;
    for _ in 0..CHAIN_MAX {
        if ranges.get(x)?.zeros >= mask.trailing_ones() {
            return Some((by & mask) as u64);
        }
        let (inner, more) = sum_with_constant(function, ranges, x)?;
        (x, by) = (inner, by.wrapping_add(more));
    }
    None
}

/// The operands of a sum that does not wrap, natural numbers that were shifted left by `count` at least. One of them may be a masked
/// number: the address of an instance, which other accesses shift as well.
fn shifted_parts(function: &Function, ranges: &Ranges<'_>, sum: Value, count: u32) -> Option<[Value; 2]> {
    let &InstData::Binary { op: BinaryOp::Iadd, args } = function.defining(sum)? else { return None };
    let [a, b] = [ranges.get(args[0])?, ranges.get(args[1])?];
    let full = Interval::full(function.ty(sum));
    let fits = a.is_natural() && b.is_natural() && a.hi.checked_add(b.hi)? <= full.hi;
    let is_shifted = |value: Value| match function.defining(value) {
        Some(InstData::Binary { op: BinaryOp::Shl, .. }) => true,
        Some(InstData::Binary { op: BinaryOp::Imul, .. }) => {
            shifted_product(function, ranges, BinaryOp::Lshr, value, count).is_some()
        }
        Some(InstData::Binary { op: BinaryOp::Iadd, .. }) => shifted_parts(function, ranges, value, count).is_some(),
        _ => false,
    };
    let is_masked = |value: Value| function.defining(value).is_some_and(is_mask);
    let [first, second] = args;
    let is_cheap = match (is_shifted(first), is_shifted(second)) {
        (true, true) => true,
        (true, false) => is_masked(second),
        (false, true) => is_masked(first),
        (false, false) => false,
    };
    (count > 0 && fits && a.zeros >= count && b.zeros >= count && is_cheap).then_some(args)
}

/// `arg` shifted right: what was shifted left without a wrap is shifted less, and a product has a smaller factor.
fn part_of(function: &Function, ranges: &Ranges<'_>, op: BinaryOp, arg: Value, count: u32) -> Part {
    if let Some((x, factor)) = shifted_product(function, ranges, op, arg, count) {
        return Part { op: BinaryOp::Imul, arg: x, by: factor };
    }
    let less = || {
        let &InstData::Binary { op: BinaryOp::Shl, args: [x, by] } = function.defining(arg)? else { return None };
        let (of_x, by) = (ranges.get(x)?, u32::try_from(ranges.get(by)?.single()?).ok()?);
        let ty = function.ty(arg);
        let fits = by < ty.bits() && of_x.is_natural() && of_x.hi <= Interval::full(ty).hi >> by;
        (fits && by >= count).then_some(Part { op: BinaryOp::Shl, arg: x, by: u64::from(by - count) })
    };
    less().unwrap_or(Part { op, arg, by: u64::from(count) })
}

/// The operand of a product with a constant that does not wrap, and that constant shifted right by `count`, if only zeros go.
fn shifted_product(
    function: &Function,
    ranges: &Ranges<'_>,
    op: BinaryOp,
    product: Value,
    count: u32,
) -> Option<(Value, u64)> {
    let &InstData::Binary { op: BinaryOp::Imul, args: [x, factor] } = function.defining(product)? else { return None };
    let (of_x, factor) = (ranges.get(x)?, ranges.get(factor)?.single()?);
    let full = Interval::full(function.ty(product));
    let (lo, hi) = (of_x.lo.checked_mul(factor)?, of_x.hi.checked_mul(factor)?);
    let fits = factor > 0 && lo >= full.lo && hi <= full.hi && (op == BinaryOp::Ashr || of_x.is_natural());
    let is_multiple = count > 0 && factor.trailing_zeros() >= count;
    (fits && is_multiple && function.constant(x).is_none()).then_some((x, (factor >> count) as u64))
}

/// Of natural numbers both shifts right are the same: one form is shared and combined.
fn natural(op: BinaryOp, a: Value, of_a: Interval, count: i64) -> Option<Change> {
    (op == BinaryOp::Ashr && of_a.is_natural()).then_some(Change::Shift(BinaryOp::Lshr, a, count as u64))
}

/// The bits that a natural number of the interval can have set.
fn bits_of(range: Interval) -> i64 {
    if range.hi == 0 { 0 } else { (u64::MAX >> range.hi.leading_zeros()) as i64 }
}
