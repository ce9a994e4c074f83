//! Operators of constant expressions.
//!
//! Integers without a type are computed exactly; an integer with a type gives its type to the other. Source: SCL reference, arithmetic
//! and type of a mixed expression.

use plcc_syntax::scl::ast::{BinaryOp, UnaryOp};
use plcc_syntax::{Class, Elementary};

use super::Constant;
use super::fit;

/// Why an operator has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The operator does not take operands of these types.
    Type,
    /// The result does not fit its type.
    Overflow,
    /// Division by zero.
    Zero,
}

/// The value of an operator with one operand.
pub fn unary(op: UnaryOp, operand: &Constant) -> Result<Constant, Fault> {
    match (op, operand) {
        (UnaryOp::Plus, _) if is_number(operand) => Ok(operand.clone()),
        (UnaryOp::Minus, Constant::Integer { value, based }) => {
            Ok(Constant::Integer { value: value.checked_neg().ok_or(Fault::Overflow)?, based: *based })
        }
        (UnaryOp::Minus, Constant::Real(value)) => Ok(Constant::Real(-value)),
        (UnaryOp::Minus, Constant::Typed { ty, bits }) => match ty {
            Elementary::Real => typed(*ty, u64::from((-f32::from_bits(*bits as u32)).to_bits())),
            Elementary::Lreal => typed(*ty, (-f64::from_bits(*bits)).to_bits()),
            _ if ty.is_signed() => whole(Some(*ty), false, -fit::signed(*ty, *bits)),
            _ => Err(Fault::Type),
        },
        (UnaryOp::Not, Constant::Integer { value, based }) => Ok(Constant::Integer { value: !value, based: *based }),
        (UnaryOp::Not, Constant::Typed { ty, bits }) if ty.class() == Class::Bits || ty.is_integer() => {
            typed(*ty, !bits & fit::mask(*ty))
        }
        _ => Err(Fault::Type),
    }
}

/// The value of an operator with two operands.
pub fn binary(op: BinaryOp, left: &Constant, right: &Constant) -> Result<Constant, Fault> {
    match op {
        BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => bitwise(op, left, right),
        BinaryOp::Power => power(left, right),
        BinaryOp::Add
        | BinaryOp::Subtract
        | BinaryOp::Multiply
        | BinaryOp::Divide
        | BinaryOp::DivideInteger
        | BinaryOp::Modulo => arithmetic(op, left, right),
        BinaryOp::Less
        | BinaryOp::Greater
        | BinaryOp::LessEqual
        | BinaryOp::GreaterEqual
        | BinaryOp::Equal
        | BinaryOp::NotEqual => Err(Fault::Type),
    }
}

/// An operand of arithmetic.
#[derive(Clone, Copy)]
enum Number {
    Whole { value: i128, ty: Option<Elementary>, based: bool },
    Float { value: f64, ty: Option<Elementary> },
    Duration { value: i128, ty: Elementary },
}

fn number(constant: &Constant) -> Option<Number> {
    Some(match constant {
        Constant::Integer { value, based } => Number::Whole { value: *value, ty: None, based: *based },
        Constant::Real(value) => Number::Float { value: *value, ty: None },
        Constant::Typed { ty, bits } => match ty {
            Elementary::Real => Number::Float { value: f64::from(f32::from_bits(*bits as u32)), ty: Some(*ty) },
            Elementary::Lreal => Number::Float { value: f64::from_bits(*bits), ty: Some(*ty) },
            Elementary::Time | Elementary::Ltime => Number::Duration { value: fit::signed(*ty, *bits), ty: *ty },
            _ => Number::Whole { value: fit::integer_of(*ty, *bits)?, ty: Some(unsigned(*ty)), based: false },
        },
        Constant::Text { .. } | Constant::WideText(_) | Constant::DateAndTime(_) | Constant::Dtl(_) => return None,
    })
}

fn is_number(constant: &Constant) -> bool {
    number(constant).is_some()
}

/// A bit string counts as the unsigned integer of its width.
const fn unsigned(ty: Elementary) -> Elementary {
    match ty {
        Elementary::Byte => Elementary::Usint,
        Elementary::Word => Elementary::Uint,
        Elementary::Dword => Elementary::Udint,
        Elementary::Lword => Elementary::Ulint,
        other => other,
    }
}

fn arithmetic(op: BinaryOp, left: &Constant, right: &Constant) -> Result<Constant, Fault> {
    let (left, right) = (number(left).ok_or(Fault::Type)?, number(right).ok_or(Fault::Type)?);
    match (left, right) {
        (Number::Whole { value: a, ty: ta, based: ba }, Number::Whole { value: b, ty: tb, based: bb }) => {
            whole(wider(ta, tb), ba && bb, integers(op, a, b)?)
        }
        (Number::Duration { value: a, ty }, Number::Duration { value: b, ty: other })
            if matches!(op, BinaryOp::Add | BinaryOp::Subtract) && ty == other =>
        {
            whole(Some(ty), false, integers(op, a, b)?)
        }
        (Number::Duration { value: a, ty }, Number::Whole { value: b, .. })
            if matches!(op, BinaryOp::Multiply | BinaryOp::Divide | BinaryOp::DivideInteger) =>
        {
            whole(Some(ty), false, integers(op, a, b)?)
        }
        (Number::Duration { .. }, _) | (_, Number::Duration { .. }) => Err(Fault::Type),
        (a, b) => {
            let ((a, ta), (b, tb)) = (as_float(a), as_float(b));
            let value = match op {
                BinaryOp::Add => a + b,
                BinaryOp::Subtract => a - b,
                BinaryOp::Multiply => a * b,
                BinaryOp::Divide if b == 0.0 => return Err(Fault::Zero),
                BinaryOp::Divide => a / b,
                _ => return Err(Fault::Type),
            };
            float(wider_float(ta, tb), value)
        }
    }
}

fn as_float(number: Number) -> (f64, Option<Elementary>) {
    match number {
        Number::Whole { value, .. } | Number::Duration { value, .. } => (value as f64, None),
        Number::Float { value, ty } => (value, ty),
    }
}

/// Integers toward zero; the remainder has the sign of the dividend.
fn integers(op: BinaryOp, a: i128, b: i128) -> Result<i128, Fault> {
    let result = match op {
        BinaryOp::Add => a.checked_add(b),
        BinaryOp::Subtract => a.checked_sub(b),
        BinaryOp::Multiply => a.checked_mul(b),
        BinaryOp::Divide | BinaryOp::DivideInteger | BinaryOp::Modulo if b == 0 => return Err(Fault::Zero),
        BinaryOp::Divide | BinaryOp::DivideInteger => a.checked_div(b),
        BinaryOp::Modulo => a.checked_rem(b),
        _ => return Err(Fault::Type),
    };
    result.ok_or(Fault::Overflow)
}

/// `**` yields a REAL, or an LREAL if one side is one.
fn power(left: &Constant, right: &Constant) -> Result<Constant, Fault> {
    let (left, right) = (number(left).ok_or(Fault::Type)?, number(right).ok_or(Fault::Type)?);
    if matches!(left, Number::Duration { .. }) || matches!(right, Number::Duration { .. }) {
        return Err(Fault::Type);
    }
    let ((a, ta), (b, tb)) = (as_float(left), as_float(right));
    let value = a.powf(b);
    if value.is_finite() { float(wider_float(ta, tb), value) } else { Err(Fault::Overflow) }
}

fn bitwise(op: BinaryOp, left: &Constant, right: &Constant) -> Result<Constant, Fault> {
    let combine = |a: u128, b: u128| match op {
        BinaryOp::And => a & b,
        BinaryOp::Or => a | b,
        _ => a ^ b,
    };
    match (left, right) {
        (Constant::Integer { value: a, based: ba }, Constant::Integer { value: b, based: bb }) => {
            Ok(Constant::Integer { value: combine(*a as u128, *b as u128) as i128, based: *ba || *bb })
        }
        (Constant::Typed { ty, bits }, other @ Constant::Integer { .. })
        | (other @ Constant::Integer { .. }, Constant::Typed { ty, bits })
            if ty.class() == Class::Bits || ty.is_integer() =>
        {
            let other = other.bits(*ty).map_err(|_| Fault::Overflow)?;
            typed(*ty, combine(u128::from(*bits), u128::from(other)) as u64)
        }
        (Constant::Typed { ty: ta, bits: a }, Constant::Typed { ty: tb, bits: b }) => {
            let logical = |ty: &Elementary| *ty == Elementary::Bool;
            let bits = |ty: &Elementary| !logical(ty) && (ty.class() == Class::Bits || ty.is_integer());
            if !(logical(ta) && logical(tb) || bits(ta) && bits(tb)) {
                return Err(Fault::Type);
            }
            let ty = if ta.bits() >= tb.bits() { *ta } else { *tb };
            typed(ty, combine(u128::from(*a), u128::from(*b)) as u64)
        }
        _ => Err(Fault::Type),
    }
}

fn typed(ty: Elementary, bits: u64) -> Result<Constant, Fault> {
    Ok(Constant::Typed { ty, bits })
}

/// An integer or duration; without a type it may be as large as the largest type.
fn whole(ty: Option<Elementary>, based: bool, value: i128) -> Result<Constant, Fault> {
    match ty {
        Some(ty) => typed(ty, fit::in_range(ty, value).ok_or(Fault::Overflow)?),
        None if (i128::from(i64::MIN)..=i128::from(u64::MAX)).contains(&value) => {
            Ok(Constant::Integer { value, based })
        }
        None => Err(Fault::Overflow),
    }
}

fn float(ty: Option<Elementary>, value: f64) -> Result<Constant, Fault> {
    if !value.is_finite() {
        return Err(Fault::Overflow);
    }
    match ty {
        None => Ok(Constant::Real(value)),
        Some(Elementary::Real) => {
            let value = value as f32;
            if value.is_finite() { typed(Elementary::Real, u64::from(value.to_bits())) } else { Err(Fault::Overflow) }
        }
        Some(ty) => typed(ty, value.to_bits()),
    }
}

fn wider_float(a: Option<Elementary>, b: Option<Elementary>) -> Option<Elementary> {
    match (a, b) {
        (Some(Elementary::Lreal), _) | (_, Some(Elementary::Lreal)) => Some(Elementary::Lreal),
        _ => a.or(b),
    }
}

/// The type of a mixed expression of integers.
fn wider(a: Option<Elementary>, b: Option<Elementary>) -> Option<Elementary> {
    let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
    if a.class() == b.class() {
        return Some(if a.bits() >= b.bits() { a } else { b });
    }
    let (signed, unsigned) = if a.class() == Class::Signed { (a, b) } else { (b, a) };
    Some(match signed.bits().max(2 * unsigned.bits()) {
        8 => Elementary::Sint,
        16 => Elementary::Int,
        32 => Elementary::Dint,
        _ => Elementary::Lint,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn int(value: i128) -> Constant {
        Constant::Integer { value, based: false }
    }

    const fn of(ty: Elementary, bits: u64) -> Constant {
        Constant::Typed { ty, bits }
    }

    #[test]
    fn untyped_integers_are_exact() {
        assert_eq!(binary(BinaryOp::Multiply, &int(30_000), &int(30_000)), Ok(int(900_000_000)));
        assert_eq!(binary(BinaryOp::Divide, &int(-7), &int(2)), Ok(int(-3)));
        assert_eq!(binary(BinaryOp::Modulo, &int(-7), &int(2)), Ok(int(-1)));
        assert_eq!(binary(BinaryOp::Modulo, &int(1), &int(0)), Err(Fault::Zero));
        let largest = int(i128::from(u64::MAX));
        assert_eq!(binary(BinaryOp::Add, &largest, &int(1)), Err(Fault::Overflow));
    }

    #[test]
    fn a_type_spreads() {
        let five = of(Elementary::Int, 5);
        assert_eq!(binary(BinaryOp::Subtract, &int(2), &five), Ok(of(Elementary::Int, 0xFFFD)));
        assert_eq!(binary(BinaryOp::Multiply, &five, &int(10_000)), Err(Fault::Overflow));
        assert_eq!(binary(BinaryOp::Add, &five, &of(Elementary::Dint, 1)), Ok(of(Elementary::Dint, 6)));
        assert_eq!(binary(BinaryOp::Add, &five, &of(Elementary::Uint, 1)), Ok(of(Elementary::Dint, 6)));
        assert_eq!(binary(BinaryOp::Add, &five, &Constant::Real(0.5)), Ok(Constant::Real(5.5)));
        assert_eq!(binary(BinaryOp::Power, &int(2), &int(3)), Ok(Constant::Real(8.0)));
    }

    #[test]
    fn durations() {
        let second = of(Elementary::Time, 1000);
        assert_eq!(binary(BinaryOp::Multiply, &second, &int(3)), Ok(of(Elementary::Time, 3000)));
        assert_eq!(unary(UnaryOp::Minus, &second), Ok(of(Elementary::Time, 0xFFFF_FC18)));
        assert_eq!(binary(BinaryOp::Add, &second, &int(3)), Err(Fault::Type));
    }

    #[test]
    fn bits() {
        let based = Constant::Integer { value: 0xF0, based: true };
        assert_eq!(binary(BinaryOp::And, &based, &int(0x3C)), Ok(Constant::Integer { value: 0x30, based: true }));
        assert_eq!(binary(BinaryOp::Or, &of(Elementary::Byte, 1), &based), Ok(of(Elementary::Byte, 0xF1)));
        assert_eq!(
            binary(BinaryOp::Xor, &of(Elementary::Bool, 1), &of(Elementary::Bool, 1)),
            Ok(of(Elementary::Bool, 0))
        );
        assert_eq!(unary(UnaryOp::Not, &of(Elementary::Word, 0xF0)), Ok(of(Elementary::Word, 0xFF0F)));
        assert_eq!(unary(UnaryOp::Not, &based).unwrap().bits(Elementary::Word), Ok(0xFF0F));
        assert_eq!(binary(BinaryOp::And, &of(Elementary::Bool, 1), &of(Elementary::Byte, 1)), Err(Fault::Type));
    }
}
