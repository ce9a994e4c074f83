//! Between which values an expression stays, as far as its operators tell: `#word AND 16#FF` fits a BYTE.

use plcc_syntax::{Class, Elementary};

use super::constant;
use plcc_model::scl::{BinaryOp, Conversion, Expr, ExprKind, Function};

/// Whether each value that an integer or bit string can have is one of type `ty` too.
pub fn fits(expr: &Expr, ty: Elementary) -> bool {
    is_whole(ty) && of(expr).is_some_and(|values| is_within(values, ty))
}

/// Whether each product of values of two integers is one of type `ty`, an integer.
pub fn product_fits(left: &Expr, right: &Expr, ty: Elementary) -> bool {
    binary(BinaryOp::Multiply, left, right).is_some_and(|values| is_within(values, ty))
}

fn is_within((low, high): (i128, i128), ty: Elementary) -> bool {
    let (least, greatest) = constant::range(ty);
    least <= low && high <= greatest
}

/// Integers and bit strings of several bits.
fn is_whole(ty: Elementary) -> bool {
    ty.is_integer() || (ty.class() == Class::Bits && ty != Elementary::Bool)
}

/// The least and the greatest value; none: not an integer or bit string.
fn of(expr: &Expr) -> Option<(i128, i128)> {
    if !is_whole(expr.ty) {
        return None;
    }
    let (least, greatest) = constant::range(expr.ty);
    let known = match &expr.kind {
        ExprKind::Const(bits) => {
            let value = constant::integer(expr.ty, *bits);
            Some((value, value))
        }
        ExprKind::Binary { op, left, right } => binary(*op, left, right),
        ExprKind::Function { function: Function::Select | Function::Mux { has_else: true }, arguments } => {
            one_of(arguments.get(1..).unwrap_or(&[]))
        }
        ExprKind::Function { function: Function::Limit, arguments } => limited(arguments),
        ExprKind::Convert { conversion: Conversion::Value(_) | Conversion::Bits { .. }, operand } => of(operand),
        _ => None,
    };
    // What leaves the range of its type wraps.
    Some(known.filter(|(low, high)| least <= *low && *high <= greatest).unwrap_or((least, greatest)))
}

fn one_of(values: &[Expr]) -> Option<(i128, i128)> {
    let mut all = values.iter().map(of);
    let first = all.next()??;
    all.try_fold(first, |(low, high), value| value.map(|(least, greatest)| (low.min(least), high.max(greatest))))
}

/// MN, IN, MX.
fn limited(arguments: &[Expr]) -> Option<(i128, i128)> {
    let [low, _, high] = arguments else { return None };
    let (low, high) = (of(low)?, of(high)?);
    (low.1 <= high.0).then_some((low.0, high.1))
}

fn binary(op: BinaryOp, left: &Expr, right: &Expr) -> Option<(i128, i128)> {
    let (a, b) = (of(left)?, of(right)?);
    let positive = a.0 >= 0 && b.0 >= 0;
    match op {
        BinaryOp::Add => Some((a.0 + b.0, a.1 + b.1)),
        BinaryOp::Subtract => Some((a.0 - b.1, a.1 - b.0)),
        BinaryOp::Multiply => {
            let products = [a.0.checked_mul(b.0)?, a.0.checked_mul(b.1)?, a.1.checked_mul(b.0)?, a.1.checked_mul(b.1)?];
            Some((*products.iter().min()?, *products.iter().max()?))
        }
        BinaryOp::Modulo if b.0 > 0 => Some((if a.0 < 0 { 1 - b.1 } else { 0 }, b.1 - 1)),
        BinaryOp::Min => Some((a.0.min(b.0), a.1.min(b.1))),
        BinaryOp::Max => Some((a.0.max(b.0), a.1.max(b.1))),
        BinaryOp::And if positive => Some((0, a.1.min(b.1))),
        BinaryOp::Or | BinaryOp::Xor if positive => {
            let bits = 128 - a.1.max(b.1).leading_zeros();
            Some((0, (1_i128 << bits) - 1))
        }
        BinaryOp::And
        | BinaryOp::Or
        | BinaryOp::Xor
        | BinaryOp::Divide
        | BinaryOp::Modulo
        | BinaryOp::Power
        | BinaryOp::ShiftLeft
        | BinaryOp::ShiftRight
        | BinaryOp::RotateLeft
        | BinaryOp::RotateRight
        | BinaryOp::AddDay
        | BinaryOp::SubtractDay => None,
    }
}
