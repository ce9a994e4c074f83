//! The numbers that an integer can be: an interval, and how many of the lowest bits are 0.

use plcc_ir::{BinaryOp, ConvertOp, IntCc, Type, eval};

/// Numbers from `lo` to `hi`, multiples of 2 to the power of `zeros`. Values are signed, an i1 is 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    pub lo: i64,
    pub hi: i64,
    /// Bits at the low end that are 0; 63 of the number 0.
    pub zeros: u32,
}

impl Interval {
    /// Every number of the type; of floats nothing is known.
    pub fn full(ty: Type) -> Interval {
        let bits = if ty.is_int() || ty == Type::I1 { ty.bits() } else { 64 };
        let (lo, hi) = match bits {
            1 => (0, 1),
            bits @ (8 | 16 | 32) => (-1 << (bits - 1), (1 << (bits - 1)) - 1),
            _ => (i64::MIN, i64::MAX),
        };
        Interval { lo, hi, zeros: 0 }
    }

    /// The constant with these bits.
    pub fn constant(ty: Type, bits: u64) -> Interval {
        let value = if ty == Type::I1 { (bits & 1) as i64 } else { eval::signed(ty, bits) };
        Interval { lo: value, hi: value, zeros: trailing_zeros(value) }
    }

    pub fn between(lo: i64, hi: i64) -> Interval {
        Interval { lo, hi, zeros: if lo == hi { trailing_zeros(lo) } else { 0 } }
    }

    /// The only number.
    pub fn single(self) -> Option<i64> {
        (self.lo == self.hi).then_some(self.lo)
    }

    pub fn is_natural(self) -> bool {
        self.lo >= 0
    }

    pub fn contains(self, other: Interval) -> bool {
        self.lo <= other.lo && other.hi <= self.hi && self.zeros <= other.zeros
    }

    /// Numbers of either.
    pub fn join(self, other: Interval) -> Interval {
        Interval { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi), zeros: self.zeros.min(other.zeros) }
    }

    /// Numbers of both; `None`: there are none.
    pub fn meet(self, other: Interval) -> Option<Interval> {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        (lo <= hi).then(|| Interval { lo, hi, zeros: self.zeros.max(other.zeros) }.rounded())
    }

    /// Those numbers that are a multiple of `stride` away from `first`; all, if there are none.
    pub fn on_strides(self, first: i64, stride: i64) -> Interval {
        let away = |end: i64| end.checked_sub(first).map(|away| away.rem_euclid(stride));
        let lo = away(self.lo).and_then(|over| self.lo.checked_add(if over == 0 { 0 } else { stride - over }));
        let hi = away(self.hi).and_then(|over| self.hi.checked_sub(over));
        match (lo, hi) {
            (Some(lo), Some(hi)) if lo <= hi => Interval { lo, hi, ..self },
            _ => self,
        }
    }

    /// Ends at multiples of the power of two.
    fn rounded(self) -> Interval {
        if self.lo == self.hi || self.zeros == 0 || self.zeros >= 62 {
            return self;
        }
        let step = 1i64 << self.zeros;
        let lo = self.lo.checked_add(step - 1).map_or(self.lo, |lo| lo & !(step - 1));
        let hi = self.hi & !(step - 1);
        if lo <= hi { Interval { lo, hi, ..self } } else { self }
    }

    /// The result of an operation of `ty` that would be from `lo` to `hi` if it did not wrap.
    fn fit(ty: Type, lo: i128, hi: i128, zeros: u32) -> Interval {
        let full = Interval::full(ty);
        if lo >= i128::from(full.lo) && hi <= i128::from(full.hi) {
            Interval { lo: lo as i64, hi: hi as i64, zeros }.rounded()
        } else {
            Interval { zeros: zeros.min(ty.bits().saturating_sub(1)), ..full }.rounded()
        }
    }
}

fn trailing_zeros(value: i64) -> u32 {
    value.trailing_zeros().min(63)
}

/// The least number of the form 2^n - 1 that is not below `value`, which is not negative.
fn ones(value: i64) -> i64 {
    if value == 0 { 0 } else { (u64::MAX >> value.leading_zeros()) as i64 }
}

/// The constant count of a shift.
fn count_of(ty: Type, count: Interval) -> Option<u32> {
    count.single().map(|count| (count & i64::from(ty.bits() - 1)) as u32)
}

/// The bits in which the numbers of an interval differ from each other, and all below them that are not 0 in all of them.
fn free_bits(a: Interval) -> i64 {
    let below = ((a.lo ^ a.hi) as u64).checked_ilog2().map_or(0, |highest| u64::MAX >> (63 - highest));
    (below & u64::MAX << a.zeros.min(63)) as i64
}

/// The bits of all numbers of the interval outside `mask`, if those are the same.
pub fn common_bits(a: Interval, mask: i64) -> Option<i64> {
    let a = a.rounded();
    (free_bits(a) & !mask == 0).then_some(a.lo & !mask)
}

/// A mask or a constant joined by OR keeps the order of numbers that only differ in bits that stay.
fn ordered(op: BinaryOp, a: Interval, b: Interval) -> Option<Interval> {
    let (a, constant) = match (a.single(), b.single()) {
        (_, Some(constant)) => (a, constant),
        (Some(constant), _) => (b, constant),
        _ => return None,
    };
    let a = a.rounded();
    let free = free_bits(a);
    let (lo, hi) = match op {
        BinaryOp::And if free & constant == 0 => return Some(Interval::between(a.lo & constant, a.lo & constant)),
        BinaryOp::And if free & !constant == 0 => (a.lo & constant, a.hi & constant),
        BinaryOp::Or if free & constant == 0 => (a.lo | constant, a.hi | constant),
        _ => return None,
    };
    let zeros = if op == BinaryOp::And { a.zeros } else { a.zeros.min(trailing_zeros(constant)) };
    Some(Interval { lo, hi, zeros: zeros.min(62) }.rounded())
}

/// The result of `op` on integers of type `ty`.
pub fn binary(op: BinaryOp, ty: Type, a: Interval, b: Interval) -> Interval {
    let full = Interval::full(ty);
    let wide = |value: i64| i128::from(value);
    if matches!(op, BinaryOp::And | BinaryOp::Or)
        && let Some(result) = ordered(op, a, b)
    {
        return result;
    }
    match op {
        BinaryOp::Iadd => Interval::fit(ty, wide(a.lo) + wide(b.lo), wide(a.hi) + wide(b.hi), a.zeros.min(b.zeros)),
        BinaryOp::Isub => Interval::fit(ty, wide(a.lo) - wide(b.hi), wide(a.hi) - wide(b.lo), a.zeros.min(b.zeros)),
        BinaryOp::Imul => {
            let ends = [(a.lo, b.lo), (a.lo, b.hi), (a.hi, b.lo), (a.hi, b.hi)].map(|(x, y)| wide(x) * wide(y));
            let (lo, hi) = (ends.into_iter().min().unwrap_or(0), ends.into_iter().max().unwrap_or(0));
            Interval::fit(ty, lo, hi, (a.zeros + b.zeros).min(63))
        }
        BinaryOp::And => {
            let zeros = a.zeros.max(b.zeros);
            let hi = match (a.is_natural(), b.is_natural()) {
                (true, true) => a.hi.min(b.hi),
                (true, false) => a.hi,
                (false, true) => b.hi,
                (false, false) => return Interval { zeros: zeros.min(ty.bits() - 1), ..full }.rounded(),
            };
            // Nothing is left of a multiple of 8 below 8.
            if zeros < 63 && hi < 1 << zeros {
                return Interval::between(0, 0);
            }
            Interval { lo: 0, hi, zeros }.rounded()
        }
        BinaryOp::Or | BinaryOp::Xor if a.is_natural() && b.is_natural() => {
            let lo = if op == BinaryOp::Or { a.lo.max(b.lo) } else { 0 };
            Interval { lo, hi: ones(a.hi | b.hi), zeros: a.zeros.min(b.zeros) }
        }
        BinaryOp::Shl => match count_of(ty, b) {
            Some(count) => {
                let zeros = (a.zeros + count).min(63);
                Interval::fit(ty, wide(a.lo) << count, wide(a.hi) << count, zeros)
            }
            None => full,
        },
        BinaryOp::Lshr => match count_of(ty, b) {
            Some(0) => a,
            Some(count) if a.is_natural() => {
                Interval { lo: a.lo >> count, hi: a.hi >> count, zeros: a.zeros.saturating_sub(count) }
            }
            Some(count) if a.hi < 0 => {
                let [lo, hi] = [a.lo, a.hi].map(|end| (eval::mask(ty, end as u64) >> count) as i64);
                Interval { zeros: a.zeros.saturating_sub(count), ..Interval::between(lo, hi) }
            }
            Some(count) => Interval::between(0, (eval::mask(ty, u64::MAX) >> count) as i64),
            None if a.is_natural() => Interval::between(0, a.hi),
            None => full,
        },
        BinaryOp::Ashr => match count_of(ty, b) {
            Some(count) => Interval { lo: a.lo >> count, hi: a.hi >> count, zeros: a.zeros.saturating_sub(count) },
            None => Interval::between(a.lo.min(0), a.hi.max(-1)),
        },
        BinaryOp::Sdiv => match b.single() {
            Some(divisor) if divisor > 0 => Interval::between(a.lo / divisor, a.hi / divisor),
            _ if a.is_natural() && b.lo > 0 => Interval::between(0, a.hi),
            _ => full,
        },
        BinaryOp::Udiv if a.is_natural() && b.lo > 0 => Interval::between(a.lo / b.hi, a.hi / b.lo),
        BinaryOp::Srem if b.lo > 0 => {
            let most = b.hi - 1;
            let lo = if a.is_natural() { 0 } else { (-most).max(a.lo) };
            Interval::between(lo, most.min(a.hi.max(0)))
        }
        BinaryOp::Urem if b.lo > 0 => Interval::between(0, if a.is_natural() { a.hi.min(b.hi - 1) } else { b.hi - 1 }),
        _ => full,
    }
}

/// The result of a conversion between integers.
pub fn convert(op: ConvertOp, from: Type, to: Type, arg: Interval) -> Interval {
    match op {
        ConvertOp::Sext if from != Type::I1 => arg,
        ConvertOp::Zext if from == Type::I1 || arg.is_natural() => arg,
        ConvertOp::Zext if from.bits() < 64 => {
            let hi = (1i64 << from.bits()) - 1;
            Interval { lo: 0, hi, zeros: arg.zeros.min(from.bits()) }.rounded()
        }
        ConvertOp::Trunc if to == Type::I1 => Interval::full(to),
        ConvertOp::Trunc => {
            let full = Interval::full(to);
            if full.lo <= arg.lo && arg.hi <= full.hi {
                arg
            } else {
                Interval { zeros: arg.zeros.min(to.bits() - 1), ..full }.rounded()
            }
        }
        _ => Interval::full(to),
    }
}

/// Whether a comparison holds, if the intervals decide it.
pub fn compare(cc: IntCc, a: Interval, b: Interval) -> Option<bool> {
    let less = |a: Interval, b: Interval| match (a.hi < b.lo, a.lo >= b.hi) {
        (true, _) => Some(true),
        (_, true) => Some(false),
        _ => None,
    };
    // Unsigned numbers are in the order of the signed ones on each side of 0; a negative one is above all others.
    let below = |a: Interval, b: Interval| match (a.is_natural(), b.is_natural()) {
        (true, true) => less(a, b),
        (true, false) if b.hi < 0 => Some(true),
        (false, true) if a.hi < 0 => Some(false),
        (false, false) if a.hi < 0 && b.hi < 0 => less(a, b),
        _ => None,
    };
    let not = |known: Option<bool>| known.map(|known| !known);
    match cc {
        IntCc::Eq => {
            if a.hi < b.lo || b.hi < a.lo {
                return Some(false);
            }
            let odd = |number: Interval, other: Interval| {
                number.single().is_some_and(|number| number != 0 && trailing_zeros(number) < other.zeros)
            };
            if odd(a, b) || odd(b, a) {
                return Some(false);
            }
            (a.single().is_some() && a.single() == b.single()).then_some(true)
        }
        IntCc::Ne => not(compare(IntCc::Eq, a, b)),
        IntCc::Slt => less(a, b),
        IntCc::Sge => not(less(a, b)),
        IntCc::Sgt => less(b, a),
        IntCc::Sle => not(less(b, a)),
        IntCc::Ult => below(a, b),
        IntCc::Uge => not(below(a, b)),
        IntCc::Ugt => below(b, a),
        IntCc::Ule => not(below(b, a)),
    }
}

/// The opposite comparison.
pub fn negated(cc: IntCc) -> IntCc {
    match cc {
        IntCc::Eq => IntCc::Ne,
        IntCc::Ne => IntCc::Eq,
        IntCc::Slt => IntCc::Sge,
        IntCc::Sge => IntCc::Slt,
        IntCc::Sgt => IntCc::Sle,
        IntCc::Sle => IntCc::Sgt,
        IntCc::Ult => IntCc::Uge,
        IntCc::Uge => IntCc::Ult,
        IntCc::Ugt => IntCc::Ule,
        IntCc::Ule => IntCc::Ugt,
    }
}

/// The comparison with its operands exchanged.
pub fn swapped(cc: IntCc) -> IntCc {
    match cc {
        IntCc::Eq | IntCc::Ne => cc,
        IntCc::Slt => IntCc::Sgt,
        IntCc::Sgt => IntCc::Slt,
        IntCc::Sle => IntCc::Sge,
        IntCc::Sge => IntCc::Sle,
        IntCc::Ult => IntCc::Ugt,
        IntCc::Ugt => IntCc::Ult,
        IntCc::Ule => IntCc::Uge,
        IntCc::Uge => IntCc::Ule,
    }
}

/// What is left of `a` where `a cc b` holds; `None`: it cannot hold.
pub fn refined(cc: IntCc, a: Interval, b: Interval) -> Option<Interval> {
    let keep = |lo: i64, hi: i64| a.meet(Interval { lo, hi, zeros: 0 });
    match cc {
        IntCc::Eq => a.meet(b),
        IntCc::Ne => match b.single() {
            Some(number) if a.single() == Some(number) => None,
            Some(number) if number == a.lo => Some(Interval { lo: a.lo + 1, ..a }.rounded()),
            Some(number) if number == a.hi => Some(Interval { hi: a.hi - 1, ..a }.rounded()),
            _ => Some(a),
        },
        IntCc::Slt => keep(i64::MIN, b.hi.checked_sub(1)?),
        IntCc::Sle => keep(i64::MIN, b.hi),
        IntCc::Sgt => keep(b.lo.checked_add(1)?, i64::MAX),
        IntCc::Sge => keep(b.lo, i64::MAX),
        // Below a natural number is a natural number.
        IntCc::Ult if b.is_natural() => keep(0, b.hi - 1),
        IntCc::Ule if b.is_natural() => keep(0, b.hi),
        IntCc::Ugt if a.is_natural() && b.is_natural() => keep(b.lo.checked_add(1)?, i64::MAX),
        IntCc::Uge if a.is_natural() && b.is_natural() => keep(b.lo, i64::MAX),
        IntCc::Ult | IntCc::Ule | IntCc::Ugt | IntCc::Uge => Some(a),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation on all i8 of small intervals stays in the interval that is computed for it.
    #[test]
    fn a_multiple_of_bytes_has_no_bits_of_a_byte() {
        let pointer = Interval { lo: -0x7C00_0000, hi: -0x7C00_0000 + 2240, zeros: 6 };
        let mask = Interval::constant(Type::I32, 0xFF00_0007);
        assert_eq!(binary(BinaryOp::And, Type::I32, pointer, mask).single(), Some(-0x7C00_0000));
        assert_eq!(common_bits(pointer, 0x00FF_FFF8), Some(-0x7C00_0000));
    }

    #[test]
    fn intervals_contain_every_result() {
        use BinaryOp::*;
        let ends = [-128i64, -127, -65, -8, -1, 0, 1, 2, 7, 8, 24, 63, 100, 127];
        let steps = [0u32, 1, 3];
        let intervals: Vec<Interval> = ends
            .iter()
            .flat_map(|&lo| ends.iter().filter(move |&&hi| lo <= hi).map(move |&hi| (lo, hi)))
            .flat_map(|(lo, hi)| steps.iter().map(move |&zeros| Interval { lo, hi, zeros }))
            .collect();
        let numbers = |interval: Interval| {
            (interval.lo..=interval.hi).filter(move |number| number & ((1 << interval.zeros) - 1) == 0)
        };
        for (index, &a) in intervals.iter().enumerate() {
            for &b in intervals.iter().skip(index % 7).step_by(7) {
                for op in [Iadd, Isub, Imul, Sdiv, Srem, Udiv, Urem, And, Or, Xor, Shl, Lshr, Ashr] {
                    let result = binary(op, Type::I8, a, b);
                    for x in
                        numbers(a).step_by(5).chain([a.lo, a.hi].into_iter().filter(|x| x & ((1 << a.zeros) - 1) == 0))
                    {
                        for y in numbers(b).step_by(3) {
                            let Some(bits) = eval::binary(op, Type::I8, x as u64 & 0xFF, y as u64 & 0xFF) else {
                                continue;
                            };
                            let value = Interval::constant(Type::I8, bits);
                            assert!(
                                result.contains(value),
                                "{op:?} {a:?} {b:?}: {x}, {y} is {value:?} not in {result:?}"
                            );
                        }
                    }
                }
                for &cc in IntCc::ALL {
                    for x in numbers(a).step_by(4) {
                        for y in numbers(b).step_by(3) {
                            let holds = eval::int_compare(cc, Type::I8, x as u64 & 0xFF, y as u64 & 0xFF);
                            assert!(compare(cc, a, b).is_none_or(|known| known == holds), "{cc:?} {a:?} {b:?} {x} {y}");
                            if holds {
                                let left = refined(cc, a, b).expect("it can hold");
                                assert!(left.contains(Interval::between(x, x)), "{cc:?} {a:?} {b:?} {x} {y}: {left:?}");
                            }
                        }
                    }
                }
            }
        }
    }
}
