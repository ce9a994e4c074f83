//! Conversions: which are implicit in which dialect, and what each computes. Source: SCL reference, types and conversions.

use plcc_syntax::{Class, Elementary};

use super::{Rules, constant};
use Elementary::*;
use plcc_model::scl::{BinaryOp, Conversion, Expr, ExprKind, Function, Overflow};

/// Days from 1990-01-01 to 2168-12-31, the last DATE.
const DATE_MAX: i64 = 65_378;
const DAY_MILLISECONDS: i64 = 86_400_000;
const DAY_NANOSECONDS: u64 = 86_400_000_000_000;
/// An LDT is not before 1970.
pub const TO_LDT: Conversion = Conversion::Ranged { max: i64::MAX };

/// Dialects that share implicit conversions.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Group {
    Classic,
    Tia300,
    /// S7-1200 and S7-1500.
    Tia,
}

/// The types to which a type converts implicitly: always, and where the IEC check is off.
struct Row {
    group: Group,
    from: Elementary,
    strict: &'static [Elementary],
    relaxed: &'static [&'static [Elementary]],
}

const INTEGERS: &[Elementary] = &[Sint, Usint, Int, Uint, Dint, Udint, Lint, Ulint];
const BIT_STRINGS: &[Elementary] = &[Byte, Word, Dword, Lword];
const CHARACTERS: &[Elementary] = &[Char, Wchar];

macro_rules! rows {
    ($( $group:ident $from:ident : $($strict:ident)* ; $($relaxed:expr),* ; )*) => {
        &[ $( Row { group: Group::$group, from: $from, strict: &[$($strict),*], relaxed: &[$($relaxed),*] } ),* ]
    };
}

/// Conversions to STRING and among dates of several words have no rows: they are calls.
#[rustfmt::skip]
const IMPLICIT: &[Row] = rows! {
    Classic Bool:   Byte Word Dword;    ;
    Classic Byte:   Word Dword;         ;
    Classic Word:   Dword;              ;
    Classic Int:    Dint Real;          ;
    Classic Dint:   Real;               ;

    Tia300 Byte:    Word Dword;         &[Dint, Char];
    Tia300 Word:    Dword;              &[Byte, Int, Dint, S5Time, Date];
    Tia300 Dword:   ;                   &[Byte, Word, Dint, Time, TimeOfDay];
    Tia300 Int:     Dint Real;          &[Word];
    Tia300 Dint:    Real;               &[Dword, Time];
    Tia300 Time:    ;                   &[Dword, Dint];
    Tia300 S5Time:  ;                   &[Word];
    Tia300 Date:    ;                   &[Word];
    Tia300 TimeOfDay: ;                 &[Dword];
    Tia300 Char:    ;                   &[Byte];

    Tia Byte:       Word Dword Lword;   INTEGERS, CHARACTERS;
    Tia Word:       Dword Lword;        &[Byte, S5Time, Date], INTEGERS, CHARACTERS;
    Tia Dword:      Lword;              &[Byte, Word, Real, Time, TimeOfDay], INTEGERS, CHARACTERS;
    Tia Lword:      ;                   &[Byte, Word, Dword, Lreal, Ltime, Ldt, Ltod], INTEGERS, CHARACTERS;
    Tia Sint:       Int Dint Lint Real Lreal;                       &[Usint, Uint, Udint, Ulint], BIT_STRINGS, CHARACTERS;
    Tia Usint:      Int Uint Dint Udint Lint Ulint Real Lreal;      &[Sint], BIT_STRINGS, CHARACTERS;
    Tia Int:        Dint Lint Real Lreal;                           &[Sint, Usint, Uint, Udint, Ulint, Date], BIT_STRINGS, CHARACTERS;
    Tia Uint:       Dint Udint Lint Ulint Real Lreal;               &[Sint, Usint, Int, Date], BIT_STRINGS, CHARACTERS;
    Tia Dint:       Lint Lreal;         &[Real, Time, TimeOfDay], INTEGERS, BIT_STRINGS, CHARACTERS;
    Tia Udint:      Lint Ulint Lreal;   &[Real, Time, TimeOfDay], INTEGERS, BIT_STRINGS, CHARACTERS;
    Tia Lint:       ;                   &[Real, Lreal, Ltime, Ldt, Ltod], INTEGERS, BIT_STRINGS, CHARACTERS;
    Tia Ulint:      ;                   &[Real, Lreal, Ltime, Ldt, Ltod], INTEGERS, BIT_STRINGS, CHARACTERS;
    Tia Real:       Lreal;              &[Dword], INTEGERS;
    Tia Lreal:      ;                   &[Lword, Real], INTEGERS;
    Tia Time:       Ltime;              &[Dword, Dint, Udint, TimeOfDay];
    Tia Ltime:      ;                   &[Lword, Lint, Ulint, Time, Ldt, Ltod];
    Tia S5Time:     ;                   &[Word];
    Tia Date:       ;                   &[Word, Int, Uint];
    Tia TimeOfDay:  Ltod;               &[Dword, Dint, Udint, Time];
    Tia Ltod:       ;                   &[Lword, Lint, Ulint, Ltime, TimeOfDay];
    Tia Ldt:        ;                   &[Lword, Lint, Ulint, Ltime];
    Tia Char:       ;                   INTEGERS, BIT_STRINGS;
    Tia Wchar:      ;                   INTEGERS, BIT_STRINGS;
};

/// The kind of an implicit conversion in a dialect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Implicit {
    Yes,
    /// Classic: only newer tools do it, but it loses nothing.
    Unusual,
    No,
}

fn listed(group: Group, from: Elementary, to: Elementary, strict: bool) -> bool {
    IMPLICIT
        .iter()
        .filter(|row| row.group == group && row.from == from)
        .any(|row| row.strict.contains(&to) || (!strict && row.relaxed.iter().any(|targets| targets.contains(&to))))
}

/// Whether `from` converts to `to` implicitly.
pub fn implicit(rules: Rules, strict: bool, from: Elementary, to: Elementary) -> Implicit {
    if from == to {
        return Implicit::Yes;
    }
    let group = match rules {
        Rules::Classic => Group::Classic,
        Rules::Tia300 => Group::Tia300,
        Rules::Tia1200 | Rules::Tia1500 => Group::Tia,
    };
    if listed(group, from, to, strict) {
        return Implicit::Yes;
    }
    // Types that an S7-300/400 lacks convert as on CPUs that have them.
    let foreign = |ty| !on_300(ty);
    match group {
        Group::Classic if listed(Group::Tia300, from, to, strict) => Implicit::Unusual,
        Group::Classic | Group::Tia300 if foreign(from) || foreign(to) => match listed(Group::Tia, from, to, strict) {
            true => Implicit::Yes,
            false => Implicit::No,
        },
        Group::Classic | Group::Tia300 | Group::Tia => Implicit::No,
    }
}

/// Types that an S7-300/400 has.
pub const fn on_300(ty: Elementary) -> bool {
    matches!(ty, Bool | Byte | Word | Dword | Char | Int | Dint | Real | S5Time | Time | Date | TimeOfDay)
}

/// True if a value of `from` may not fit `to`; rounding of an integer to a float does not count.
pub fn narrows(from: Elementary, to: Elementary) -> bool {
    let (a, b) = (from.bits(), to.bits());
    match (from.class(), to.class()) {
        (Class::Signed, Class::Unsigned) => true,
        (Class::Unsigned, Class::Signed) => a >= b,
        (Class::Float, Class::Signed | Class::Unsigned) => true,
        (Class::Signed | Class::Unsigned, Class::Float) => false,
        // What is below 0 has no place there.
        (Class::Duration, Class::Unsigned | Class::Date) | (Class::Signed, Class::Date | Class::Character) => true,
        (Class::Unsigned, Class::Duration) => a >= b,
        // A time of day ends at midnight.
        (Class::Unsigned, Class::Date) => a > 16,
        // An INT ends in 2079.
        (Class::Date, Class::Signed) => a > b || (from == Date && b <= 16),
        _ => a > b,
    }
}

/// Whether `number`, of the integer type `from`, is a value of type `to`, which is not a bit string.
pub fn holds(rules: Rules, from: Elementary, to: Elementary, number: i128) -> bool {
    let below = |bits: u32| (0..1i128 << bits).contains(&number);
    match (to.class(), explicit(rules, from, to)) {
        (Class::Signed | Class::Unsigned, _) => constant::fits(number, false, to),
        (Class::Date, Some(Conversion::Ranged { max })) => (0..=i128::from(max)).contains(&number),
        (Class::Character, _) => below(to.bits()),
        (Class::Duration, _) => below(to.bits() - 1),
        (Class::Date | Class::Bits | Class::Float, _) => false,
    }
}

/// The conversion `from_TO_to`; `None` if there is no such function, or it takes more than one step ([`explicit_expr`]).
pub fn explicit(rules: Rules, from: Elementary, to: Elementary) -> Option<Conversion> {
    let overflow = if rules.is_300() { Overflow::Pattern } else { Overflow::LowBits };
    let value = Conversion::Value(overflow);
    let bits = Conversion::Bits { checked: false };
    let cut = Conversion::Bits { checked: true };
    let (a, b) = (from.bits(), to.bits());
    Some(match (from, to) {
        _ if from == to => return None,
        // Dates and times, each pair on its own.
        (S5Time, Time) => Conversion::FromS5Time,
        (Time, S5Time) => Conversion::ToS5Time,
        (S5Time, Word) | (Word, S5Time) => bits,
        (Time, Ltime) | (TimeOfDay, Ltod) => Conversion::MillisToNanos,
        (Ltime, Time) | (Ltod, TimeOfDay) => Conversion::NanosToMillis,
        (Time, Dword | Dint) | (Dword | Dint, Time) | (Ltime, Lword | Lint) | (Lword | Lint, Ltime) => bits,
        (Time | Ltime, _) if to.is_integer() => value,
        (_, Time | Ltime) if from.is_integer() => value,
        (Ldt | Ltod, Ltime | Lword | Lint | Ulint) => bits,
        (Ltime | Lword | Lint | Ulint, Ldt) => TO_LDT,
        (Ltime | Lword | Lint | Ulint, Ltod) => Conversion::Ranged { max: DAY_NANOSECONDS as i64 - 1 },
        (Date, Word | Uint | Dint | Udint | Dword | Lint | Ulint | Lword) => bits,
        (Date, Int) => Conversion::Ranged { max: i64::from(i16::MAX) },
        (Int | Word | Uint | Dint | Udint | Dword, Date) => Conversion::Ranged { max: DATE_MAX },
        (TimeOfDay, Dint | Udint | Dword | Time | Lint | Ulint | Lword) => bits,
        (Dint | Udint | Dword | Time, TimeOfDay) => Conversion::Ranged { max: DAY_MILLISECONDS - 1 },
        _ => match (from.class(), to.class()) {
            (Class::Bits, Class::Bits | Class::Signed | Class::Unsigned) if from == Bool => bits,
            (Class::Bits | Class::Signed | Class::Unsigned, Class::Bits) if to == Bool => Conversion::ToBool,
            (Class::Bits, Class::Bits | Class::Signed | Class::Unsigned | Class::Character)
            | (Class::Character, Class::Bits | Class::Signed | Class::Unsigned | Class::Character)
            | (Class::Unsigned, Class::Bits | Class::Character)
                if from != Bool && to != Bool =>
            {
                if b >= a {
                    bits
                } else {
                    cut
                }
            }
            (Class::Signed, Class::Bits) => match (rules, a == b) {
                (_, true) => bits,
                // For these, a negative number only fails if bits get lost.
                (Rules::Classic | Rules::Tia1200, false) if b > a => bits,
                (Rules::Classic | Rules::Tia300 | Rules::Tia1200 | Rules::Tia1500, false) => cut,
            },
            (Class::Signed, Class::Character) => cut,
            (Class::Signed | Class::Unsigned, Class::Signed | Class::Unsigned | Class::Float)
            | (Class::Float, Class::Signed | Class::Unsigned | Class::Float) => value,
            (Class::Float, Class::Bits) | (Class::Bits, Class::Float) if a == b => bits,
            _ => return None,
        },
    })
}

/// The conversion between types of the same width that changes no bit.
pub fn same_bits(rules: Rules, from: Elementary, to: Elementary) -> Option<Conversion> {
    let is_bits = from.class() == Class::Bits || to.class() == Class::Bits;
    let conversion = explicit(rules, from, to).filter(|_| is_bits && from.bits() == to.bits() && from != Bool)?;
    matches!(conversion, Conversion::Bits { .. }).then_some(conversion)
}

/// `from_TO_to` of a value, in as many steps as it takes.
pub fn explicit_expr(rules: Rules, value: Expr, to: Elementary) -> Option<Expr> {
    let from = value.ty;
    if let Some(conversion) = explicit(rules, from, to) {
        return Some(converted(value, conversion, to));
    }
    let through = match (from, to) {
        _ if from == to => return Some(value),
        (S5Time, Ltime) | (Ltime, S5Time) => Time,
        (Ldt, Date) => return Some(converted(days(value), Conversion::Ranged { max: DATE_MAX }, Date)),
        (Ldt, Ltod) => return Some(time_of_day(value)),
        (Ldt, TimeOfDay) => Ltod,
        (Date, Ldt) => return Some(midnight(value)),
        _ => return None,
    };
    let step = explicit_expr(rules, value, through)?;
    explicit_expr(rules, step, to)
}

/// An index or a count as a DINT. A number of 64 bits that a DINT cannot hold becomes the nearest that it can, which no array has.
pub fn index(rules: Rules, value: Expr) -> Option<Expr> {
    let value = match value.ty {
        _ if matches!(value.kind, ExprKind::Const(_)) => value,
        Lint => up_to_dint(value, i64::from(i32::MIN)),
        Ulint => up_to_dint(value, 0),
        Lword => up_to_dint(converted(value, Conversion::Bits { checked: false }, Ulint), 0),
        _ => value,
    };
    explicit_expr(rules, value, Dint)
}

/// A number of 64 bits, from `low` to the largest DINT.
fn up_to_dint(value: Expr, low: i64) -> Expr {
    let (ty, span) = (value.ty, value.span);
    let limit = |bound: i64| Expr { kind: ExprKind::Const(bound as u64), ty, span };
    let arguments = vec![limit(low), value, limit(i64::from(i32::MAX))];
    Expr { kind: ExprKind::Function { function: Function::Limit, arguments }, ty, span }
}

/// A ULINT as a LINT, at most the largest one.
pub fn up_to_lint(value: Expr) -> Expr {
    let (ty, span) = (value.ty, value.span);
    let limit = |bits: u64| Expr { kind: ExprKind::Const(bits), ty, span };
    let arguments = vec![limit(0), value, limit(i64::MAX as u64)];
    let limited = Expr { kind: ExprKind::Function { function: Function::Limit, arguments }, ty, span };
    converted(limited, Conversion::Bits { checked: false }, Lint)
}

/// Days from 1970-01-01 to 1990-01-01: 20 years, five of them leap years.
const EPOCH_DAYS: u64 = 20 * 365 + 5;

/// Days since 1990-01-01 of an LDT, as LINT.
fn days(value: Expr) -> Expr {
    let bits = Conversion::Bits { checked: false };
    let days = binary(BinaryOp::Divide, converted(value, bits, Ulint), DAY_NANOSECONDS);
    binary(BinaryOp::Subtract, converted(days, bits, Lint), EPOCH_DAYS)
}

fn time_of_day(value: Expr) -> Expr {
    let bits = Conversion::Bits { checked: false };
    converted(binary(BinaryOp::Modulo, converted(value, bits, Ulint), DAY_NANOSECONDS), bits, Ltod)
}

/// An LDT at 0:00.
fn midnight(date: Expr) -> Expr {
    let bits = Conversion::Bits { checked: false };
    let days = binary(BinaryOp::Add, converted(date, bits, Ulint), EPOCH_DAYS);
    converted(binary(BinaryOp::Multiply, days, DAY_NANOSECONDS), bits, Ldt)
}

/// `left op right` in the type of `left`.
fn binary(op: BinaryOp, left: Expr, right: u64) -> Expr {
    let (ty, span) = (left.ty, left.span);
    let right = Expr { kind: ExprKind::Const(right), ty, span };
    Expr { kind: ExprKind::Binary { op, left: Box::new(left), right: Box::new(right) }, ty, span }
}

/// A conversion as an expression.
pub fn converted(value: Expr, conversion: Conversion, ty: Elementary) -> Expr {
    let span = value.span;
    Expr { kind: ExprKind::Convert { conversion, operand: Box::new(value) }, ty, span }
}

/// Names of BCD conversions, with the types of argument and result.
#[rustfmt::skip]
pub const BCD: &[(&str, Elementary, Elementary)] = &[
    ("BCD_TO_INT", Word, Int), ("WORD_BCD_TO_INT", Word, Int), ("BCD16_TO_INT", Word, Int),
    ("BCD_TO_DINT", Dword, Dint), ("DWORD_BCD_TO_DINT", Dword, Dint), ("BCD32_TO_DINT", Dword, Dint),
    ("INT_TO_BCD", Int, Word), ("INT_TO_BCD_WORD", Int, Word), ("INT_TO_BCD16", Int, Word),
    ("DINT_TO_BCD", Dint, Dword), ("DINT_TO_BCD_DWORD", Dint, Dword), ("DINT_TO_BCD32", Dint, Dword),
];

/// The BCD conversion with this name (upper case): type of the argument, conversion, type of the result.
pub fn bcd(rules: Rules, name: &str) -> Option<(Elementary, Conversion, Elementary)> {
    let &(_, from, to) = BCD.iter().find(|(known, ..)| *known == name)?;
    let conversion = match from {
        Word | Dword => Conversion::FromBcd { fault: rules.is_300() },
        _ => Conversion::ToBcd,
    };
    Some((from, conversion, to))
}

/// The types in a name `X_TO_Y` (upper case).
pub fn pair(name: &str) -> Option<(Elementary, Elementary)> {
    let (from, to) = name.split_once("_TO_")?;
    Some((Elementary::from_word(from)?, Elementary::from_word(to)?))
}

/// The rounding of ROUND, TRUNC, CEIL and FLOOR (upper case, without suffix) from a float to an integer.
pub fn rounding(rules: Rules, name: &str) -> Option<Conversion> {
    let overflow = if rules.is_300() { Overflow::Pattern } else { Overflow::LowBits };
    Some(match name {
        "ROUND" => Conversion::Value(overflow),
        "TRUNC" => Conversion::Truncate(overflow),
        "CEIL" => Conversion::Ceil(overflow),
        "FLOOR" => Conversion::Floor(overflow),
        _ => return None,
    })
}

/// A float, rounded to a number of type `ty`. If that is a float too, the value is rounded in its own type first.
pub fn rounded(value: Expr, rounding: Conversion, ty: Elementary) -> Expr {
    let own = value.ty;
    if !ty.is_float() || ty == own {
        return converted(value, rounding, ty);
    }
    converted(converted(value, rounding, own), Conversion::Value(Overflow::LowBits), ty)
}

#[cfg(test)]
mod tests;
