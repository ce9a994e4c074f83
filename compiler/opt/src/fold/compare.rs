//! Rules for comparisons.
//!
//! A comparison is the set of outcomes (less, equal, greater, unordered) for which it is true, so that combining two
//! comparisons of the same operands is combining sets. CC1 and CC0 are such pairs.

use plcc_ir::{BinaryOp, ConvertOp, FloatCc, InstData, IntCc, Type, Value, eval};

use super::{Change, Folder, constant};
use crate::known_bits::unsigned_max;

const LESS: u8 = 1;
const EQUAL: u8 = 2;
const GREATER: u8 = 4;
const UNORDERED: u8 = 8;
const INT_OUTCOMES: u8 = LESS | EQUAL | GREATER;
const FLOAT_OUTCOMES: u8 = INT_OUTCOMES | UNORDERED;

/// Signedness matters only for `less` and `greater`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    Signed,
    Unsigned,
    Either,
}

fn int_outcomes(cc: IntCc) -> (u8, Sign) {
    match cc {
        IntCc::Eq => (EQUAL, Sign::Either),
        IntCc::Ne => (LESS | GREATER, Sign::Either),
        IntCc::Slt => (LESS, Sign::Signed),
        IntCc::Sle => (LESS | EQUAL, Sign::Signed),
        IntCc::Sgt => (GREATER, Sign::Signed),
        IntCc::Sge => (GREATER | EQUAL, Sign::Signed),
        IntCc::Ult => (LESS, Sign::Unsigned),
        IntCc::Ule => (LESS | EQUAL, Sign::Unsigned),
        IntCc::Ugt => (GREATER, Sign::Unsigned),
        IntCc::Uge => (GREATER | EQUAL, Sign::Unsigned),
    }
}

fn float_outcomes(cc: FloatCc) -> u8 {
    match cc {
        FloatCc::Eq => EQUAL,
        FloatCc::Ne => LESS | GREATER | UNORDERED,
        FloatCc::Lt => LESS,
        FloatCc::Le => LESS | EQUAL,
        FloatCc::Gt => GREATER,
        FloatCc::Ge => GREATER | EQUAL,
        FloatCc::Uno => UNORDERED,
    }
}

fn int_cc(outcomes: u8, sign: Sign) -> Option<IntCc> {
    IntCc::ALL.iter().copied().find(|&cc| {
        let (set, its_sign) = int_outcomes(cc);
        set == outcomes && (its_sign == sign || its_sign == Sign::Either)
    })
}

fn float_cc(outcomes: u8) -> Option<FloatCc> {
    FloatCc::ALL.iter().copied().find(|&cc| float_outcomes(cc) == outcomes)
}

/// Outcomes with the operands exchanged.
fn mirrored(outcomes: u8) -> u8 {
    let swap = |from, to| if outcomes & from != 0 { to } else { 0 };
    outcomes & (EQUAL | UNORDERED) | swap(LESS, GREATER) | swap(GREATER, LESS)
}

fn combine(op: BinaryOp, a: u8, b: u8) -> Option<u8> {
    match op {
        BinaryOp::And => Some(a & b),
        BinaryOp::Or => Some(a | b),
        BinaryOp::Xor => Some(a ^ b),
        _ => None,
    }
}

/// A number that is compared with a constant: the least or the greatest that it can be, and whether they are signed.
struct Bound {
    number: Value,
    is_signed: bool,
    is_least: bool,
    bits: u64,
}

/// A float that is compared with a constant, and whether that is the least or the greatest that it can be.
struct FloatBound {
    number: Value,
    is_least: bool,
    limit: f64,
}

impl Folder<'_> {
    /// A float that is below one constant and above a greater one does not exist: limits in both orders are tested where which one is the
    /// upper one is only known when the program runs.
    pub(super) fn never_both(&self, op: BinaryOp, a: Value, b: Value) -> Option<Change> {
        if op != BinaryOp::And {
            return None;
        }
        let (one, two) = (self.float_bound(a)?, self.float_bound(b)?);
        let (least, greatest) = if one.is_least { (one, two) } else { (two, one) };
        let is_pair = least.is_least && !greatest.is_least && least.number == greatest.number;
        if is_pair && least.limit > greatest.limit { constant(0) } else { None }
    }

    fn float_bound(&self, compare: Value) -> Option<FloatBound> {
        let &InstData::FloatCompare { cc, args: [a, b] } = self.function.defining(compare)? else { return None };
        let is_least = match cc {
            FloatCc::Gt | FloatCc::Ge => true,
            FloatCc::Lt | FloatCc::Le => false,
            FloatCc::Eq | FloatCc::Ne | FloatCc::Uno => return None,
        };
        let (number, bits, is_least) = match (self.constant(a), self.constant(b)) {
            (None, Some(bits)) => (a, bits, is_least),
            (Some(bits), None) => (b, bits, !is_least),
            _ => return None,
        };
        let limit = match self.ty(number) {
            Type::F32 => f32::from_bits(bits as u32).into(),
            _ => f64::from_bits(bits),
        };
        Some(FloatBound { number, is_least, limit })
    }

    /// A number between two constants, by one comparison of its distance from the first.
    pub(super) fn between(&mut self, op: BinaryOp, a: Value, b: Value) -> Option<Change> {
        if op != BinaryOp::And || self.ty(a) != Type::I1 {
            return None;
        }
        let (one, two) = (self.bound(a)?, self.bound(b)?);
        let (least, greatest) = if one.is_least { (one, two) } else { (two, one) };
        let is_pair = least.is_least && !greatest.is_least && least.is_signed == greatest.is_signed;
        if !is_pair || least.number != greatest.number {
            return None;
        }
        let ty = self.ty(least.number);
        let is_ordered = match least.is_signed {
            true => eval::signed(ty, least.bits) <= eval::signed(ty, greatest.bits),
            false => least.bits <= greatest.bits,
        };
        if !is_ordered || least.bits == 0 {
            return None;
        }
        let back = self.emit_const(ty, least.bits.wrapping_neg());
        let distance = self.emit(InstData::Binary { op: BinaryOp::Iadd, args: [least.number, back] }, ty);
        let most = self.emit_const(ty, greatest.bits.wrapping_sub(least.bits));
        Some(Change::Data(InstData::IntCompare { cc: IntCc::Ule, args: [distance, most] }))
    }

    fn bound(&self, compare: Value) -> Option<Bound> {
        let &InstData::IntCompare { cc, args: [number, constant] } = self.function.defining(compare)? else {
            return None;
        };
        let (ty, bits) = (self.ty(number), self.constant(constant)?);
        if ty == Type::I1 {
            return None;
        }
        let step = |by: i64| {
            let next = eval::mask(ty, bits.wrapping_add(by as u64));
            // Without a bound there is nothing beyond it.
            let (old, new) = match cc {
                IntCc::Sgt | IntCc::Slt => (eval::signed(ty, bits), eval::signed(ty, next)),
                _ => (bits as i64, next as i64),
            };
            (bits >> 63 == 0 && next >> 63 == 0 && new - old == by).then_some(next)
        };
        let (is_signed, is_least, bits) = match cc {
            IntCc::Uge => (false, true, bits),
            IntCc::Ugt => (false, true, step(1)?),
            IntCc::Ule => (false, false, bits),
            IntCc::Ult => (false, false, step(-1)?),
            IntCc::Sge => (true, true, bits),
            IntCc::Sgt => (true, true, step(1)?),
            IntCc::Sle => (true, false, bits),
            IntCc::Slt => (true, false, step(-1)?),
            IntCc::Eq | IntCc::Ne => return None,
        };
        Some(Bound { number, is_signed, is_least, bits })
    }

    pub(super) fn int_compare(&mut self, cc: IntCc, [a, b]: [Value; 2]) -> Option<Change> {
        let ty = self.ty(a);
        let (ca, cb) = (self.constant(a), self.constant(b));
        let (outcomes, sign) = int_outcomes(cc);
        if let (Some(ca), Some(cb)) = (ca, cb) {
            return constant(u64::from(eval::int_compare(cc, ty, ca, cb)));
        }
        if a == b {
            return constant(u64::from(outcomes & EQUAL != 0));
        }
        if ca.is_some() {
            let cc = int_cc(mirrored(outcomes), sign)?;
            return Some(Change::Data(InstData::IntCompare { cc, args: [b, a] }));
        }
        // Places in one frame lie as their offsets do.
        if let (Some((in_a, first)), Some((in_b, second))) = (self.local_place(a), self.local_place(b))
            && in_a == in_b
        {
            return constant(u64::from(eval::int_compare(cc, ty, first, second)));
        }
        match cb {
            Some(cb) => self.compare_with_constant(cc, ty, a, b, cb),
            None => self.compare_extended(cc, a, b),
        }
    }

    fn compare_with_constant(&mut self, cc: IntCc, ty: Type, a: Value, b: Value, cb: u64) -> Option<Change> {
        let equality = matches!(cc, IntCc::Eq | IntCc::Ne);
        if ty == Type::I1 && equality {
            // `eq x, 1` is x, `eq x, 0` its negation.
            if (cc == IntCc::Eq) == (cb == 1) {
                return Some(Change::Value(a));
            }
            let one = self.emit_const(Type::I1, 1);
            return Some(Change::Data(InstData::Binary { op: BinaryOp::Xor, args: [a, one] }));
        }
        if let Some(holds) = self.decided_by_range(cc, ty, a, cb) {
            return constant(u64::from(holds));
        }
        match (cc, cb) {
            (IntCc::Ult, 1) | (IntCc::Ule, 0) => {
                let zero = self.emit_const(ty, 0);
                return Some(Change::Data(InstData::IntCompare { cc: IntCc::Eq, args: [a, zero] }));
            }
            (IntCc::Ugt, 0) => return Some(Change::Data(InstData::IntCompare { cc: IntCc::Ne, args: [a, b] })),
            (IntCc::Uge, 1) => {
                let zero = self.emit_const(ty, 0);
                return Some(Change::Data(InstData::IntCompare { cc: IntCc::Ne, args: [a, zero] }));
            }
            _ => {}
        }
        match *self.function.defining(a)? {
            InstData::Convert { op: ConvertOp::Zext, arg } => {
                // The constant fits the narrow type, or the range had decided.
                let narrow = self.ty(arg);
                let cc = if narrow == Type::I1 { equality_of_bit(cc, cb)? } else { unsigned(cc) };
                let cb = self.emit_const(narrow, cb);
                Some(Change::Data(InstData::IntCompare { cc, args: [arg, cb] }))
            }
            InstData::Convert { op: ConvertOp::Sext, arg } if equality || is_signed(cc) => {
                let narrow = self.ty(arg);
                let cut = eval::mask(narrow, cb);
                if narrow == Type::I1 || eval::signed(narrow, cut) != eval::signed(ty, cb) {
                    return None;
                }
                let cb = self.emit_const(narrow, cut);
                Some(Change::Data(InstData::IntCompare { cc, args: [arg, cb] }))
            }
            // A number that is 0 or 1 is a bit.
            InstData::Binary { op: BinaryOp::And, .. }
                if equality && cb <= 1 && unsigned_max(self.function, a) == 1 =>
            {
                let bit = InstData::Convert { op: ConvertOp::Trunc, arg: a };
                if (cc == IntCc::Eq) == (cb == 1) {
                    return Some(Change::Data(bit));
                }
                let (bit, one) = (self.emit(bit, Type::I1), self.emit_const(Type::I1, 1));
                Some(Change::Data(InstData::Binary { op: BinaryOp::Xor, args: [bit, one] }))
            }
            InstData::Binary { op: BinaryOp::Isub | BinaryOp::Xor, args } if equality && cb == 0 => {
                Some(Change::Data(InstData::IntCompare { cc, args }))
            }
            InstData::Binary { op: BinaryOp::Iadd, args: [x, c] } if equality => {
                let bits = self.constant(c)?;
                let cb = self.emit_const(ty, cb.wrapping_sub(bits));
                Some(Change::Data(InstData::IntCompare { cc, args: [x, cb] }))
            }
            InstData::Select { cond, if_true, if_false } => {
                let (t, f) = (self.constant(if_true)?, self.constant(if_false)?);
                let (t, f) = (eval::int_compare(cc, ty, t, cb), eval::int_compare(cc, ty, f, cb));
                let (if_true, if_false) =
                    (self.emit_const(Type::I1, u64::from(t)), self.emit_const(Type::I1, u64::from(f)));
                Some(Change::Data(InstData::Select { cond, if_true, if_false }))
            }
            _ => None,
        }
    }

    /// The outcome, if the range of `a` leaves only one.
    fn decided_by_range(&self, cc: IntCc, ty: Type, a: Value, cb: u64) -> Option<bool> {
        let max = unsigned_max(self.function, a);
        let all = eval::mask(ty, u64::MAX);
        let holds = |a| eval::int_compare(cc, ty, a, cb);
        match cc {
            IntCc::Eq | IntCc::Ne => (max < cb).then_some(cc == IntCc::Ne),
            // The comparison changes its outcome at most once from 0 to the maximum.
            IntCc::Ult | IntCc::Ule | IntCc::Ugt | IntCc::Uge => (holds(0) == holds(max)).then_some(holds(0)),
            // As signed numbers too, if the sign is surely 0.
            IntCc::Slt | IntCc::Sle | IntCc::Sgt | IntCc::Sge => {
                (max <= all >> 1 && holds(0) == holds(max)).then_some(holds(0))
            }
        }
    }

    /// A comparison of two values that were both widened in the same way.
    fn compare_extended(&mut self, cc: IntCc, a: Value, b: Value) -> Option<Change> {
        let (
            Some(&InstData::Convert { op: op_a @ (ConvertOp::Zext | ConvertOp::Sext), arg: x }),
            Some(&InstData::Convert { op: op_b, arg: y }),
        ) = (self.function.defining(a), self.function.defining(b))
        else {
            return None;
        };
        if op_a != op_b || self.ty(x) != self.ty(y) || self.ty(x) == Type::I1 {
            return None;
        }
        // Filled with zeros both are positive; filled with signs the order stays in either sense.
        let cc = if op_a == ConvertOp::Zext { unsigned(cc) } else { cc };
        Some(Change::Data(InstData::IntCompare { cc, args: [x, y] }))
    }

    pub(super) fn float_compare(&mut self, cc: FloatCc, [a, b]: [Value; 2]) -> Option<Change> {
        if let (Some(ca), Some(cb)) = (self.constant(a), self.constant(b)) {
            return constant(u64::from(eval::float_compare(cc, self.ty(a), ca, cb)));
        }
        if a == b && matches!(cc, FloatCc::Lt | FloatCc::Gt) {
            return constant(0);
        }
        None
    }

    /// The negation of a comparison, if there is an instruction for it.
    pub(super) fn inverted_compare(&self, value: Value) -> Option<Change> {
        match *self.function.defining(value)? {
            InstData::IntCompare { cc, args } => {
                let (outcomes, sign) = int_outcomes(cc);
                let cc = int_cc(!outcomes & INT_OUTCOMES, sign)?;
                Some(Change::Data(InstData::IntCompare { cc, args }))
            }
            InstData::FloatCompare { cc, args } => {
                let cc = float_cc(!float_outcomes(cc) & FLOAT_OUTCOMES)?;
                Some(Change::Data(InstData::FloatCompare { cc, args }))
            }
            _ => None,
        }
    }

    /// Two comparisons of the same operands combined by a Boolean operation.
    pub(super) fn combined_compares(&self, op: BinaryOp, a: Value, b: Value) -> Option<Change> {
        match (self.function.defining(a)?, self.function.defining(b)?) {
            (&InstData::IntCompare { cc: cc_a, args }, &InstData::IntCompare { cc: cc_b, args: args_b }) => {
                let ((set_a, sign_a), (set_b, sign_b)) = (int_outcomes(cc_a), int_outcomes(cc_b));
                let set_b = same_order(args, args_b, set_b)?;
                let sign = match (sign_a, sign_b) {
                    (Sign::Either, sign) | (sign, Sign::Either) => sign,
                    (a, b) if a == b => a,
                    _ => return None,
                };
                match combine(op, set_a, set_b)? {
                    0 => constant(0),
                    INT_OUTCOMES => constant(1),
                    outcomes => Some(Change::Data(InstData::IntCompare { cc: int_cc(outcomes, sign)?, args })),
                }
            }
            (&InstData::FloatCompare { cc: cc_a, args }, &InstData::FloatCompare { cc: cc_b, args: args_b }) => {
                let set_b = same_order(args, args_b, float_outcomes(cc_b))?;
                match combine(op, float_outcomes(cc_a), set_b)? {
                    0 => constant(0),
                    FLOAT_OUTCOMES => constant(1),
                    outcomes => Some(Change::Data(InstData::FloatCompare { cc: float_cc(outcomes)?, args })),
                }
            }
            _ => None,
        }
    }
}

/// Outcomes of a comparison of `other` as those of one of `args`.
fn same_order(args: [Value; 2], other: [Value; 2], outcomes: u8) -> Option<u8> {
    if args == other {
        Some(outcomes)
    } else if args == [other[1], other[0]] {
        Some(mirrored(outcomes))
    } else {
        None
    }
}

fn is_signed(cc: IntCc) -> bool {
    int_outcomes(cc).1 == Sign::Signed
}

/// The comparison as unsigned: of two numbers that are not negative it is the same.
fn unsigned(cc: IntCc) -> IntCc {
    let (outcomes, _) = int_outcomes(cc);
    int_cc(outcomes, Sign::Unsigned).unwrap_or(cc)
}

/// A comparison of a widened bit with 0 or 1 that the range did not decide, as `eq` or `ne`.
fn equality_of_bit(cc: IntCc, cb: u64) -> Option<IntCc> {
    match cc {
        IntCc::Eq | IntCc::Ne => (cb <= 1).then_some(cc),
        _ => None,
    }
}
