//! The types in which operators work. Source: SCL reference, type of a literal and of a mixed expression.

use plcc_syntax::{Class, Elementary};

use super::Rules;
use super::constant;
use super::value::Value;
use plcc_binding::constant::Constant;

/// The known facts about an operand's type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Of(Elementary),
    /// An integer constant without a type.
    Integer(i128),
    /// A floating-point constant without a type.
    Real,
    /// A text of one character: a CHAR next to a CHAR.
    Letter,
    /// No single value.
    Other,
}

impl Shape {
    pub fn of(value: &Value) -> Shape {
        match value {
            Value::Elementary(expr) => Shape::Of(expr.ty),
            Value::Constant(constant, _) => match constant {
                Constant::Integer { value, .. } => Shape::Integer(*value),
                Constant::Real(_) => Shape::Real,
                Constant::Typed { ty, .. } => Shape::Of(*ty),
                Constant::Text { bytes, typed: false } if bytes.len() == 1 => Shape::Letter,
                Constant::WideText(text) if text.len() == 1 => Shape::Of(Elementary::Wchar),
                Constant::Text { .. } | Constant::WideText(_) | Constant::DateAndTime(_) | Constant::Dtl(_) => {
                    Shape::Other
                }
            },
            Value::Cell { .. } => Shape::Of(Elementary::Bool),
            Value::Complex { .. }
            | Value::Parameter { .. }
            | Value::Block { .. }
            | Value::Nothing(_)
            | Value::Statements(..) => Shape::Other,
        }
    }

    pub fn elementary(self) -> Option<Elementary> {
        match self {
            Shape::Of(ty) => Some(ty),
            _ => None,
        }
    }

    pub const fn is_untyped(self) -> bool {
        matches!(self, Shape::Integer(_) | Shape::Real)
    }
}

/// The type of `+ - * / DIV MOD` and of comparisons of numbers; `None`: they do not go together.
pub fn common(rules: Rules, left: Shape, right: Shape) -> Option<Elementary> {
    match (left, right) {
        (Shape::Of(a), Shape::Of(b)) => mixed(rules, a, b),
        (Shape::Of(ty), Shape::Integer(value)) | (Shape::Integer(value), Shape::Of(ty)) => {
            let ty = number(rules, ty)?;
            // Only there can a constant widen the operation.
            let fits = constant::fits(value, false, ty);
            Some(if rules == Rules::Classic && ty == Elementary::Int && !fits { Elementary::Dint } else { ty })
        }
        (Shape::Of(ty), Shape::Real) | (Shape::Real, Shape::Of(ty)) => {
            let ty = number(rules, ty)?;
            Some(if ty == Elementary::Lreal { ty } else { Elementary::Real })
        }
        (Shape::Integer(a), Shape::Integer(b)) => {
            let own = |value| constant::default_type(rules, &Constant::Integer { value, based: false });
            mixed(rules, own(a), own(b))
        }
        (Shape::Real, Shape::Real | Shape::Integer(_)) | (Shape::Integer(_), Shape::Real) => {
            Some(constant::default_type(rules, &Constant::Real(0.0)))
        }
        (Shape::Letter | Shape::Other, _) | (_, Shape::Letter | Shape::Other) => None,
    }
}

/// The number type that arithmetic uses for a type: a bit string is the integer of its width.
fn number(rules: Rules, ty: Elementary) -> Option<Elementary> {
    Some(match (ty, rules.is_300()) {
        (Elementary::Byte, false) => Elementary::Usint,
        (Elementary::Word, false) => Elementary::Uint,
        (Elementary::Dword, false) => Elementary::Udint,
        (Elementary::Byte | Elementary::Word, true) => Elementary::Int,
        (Elementary::Dword, true) => Elementary::Dint,
        (Elementary::Lword, _) => Elementary::Ulint,
        _ if ty.is_integer() || ty.is_float() => ty,
        _ => return None,
    })
}

fn mixed(rules: Rules, a: Elementary, b: Elementary) -> Option<Elementary> {
    let (a, b) = (number(rules, a)?, number(rules, b)?);
    let longer = if a.bits() >= b.bits() { a } else { b };
    Some(match (a.class(), b.class()) {
        (Class::Float, Class::Float) => longer,
        (Class::Float, _) => a,
        (_, Class::Float) => b,
        (a, b) if a == b => longer,
        _ => {
            let (signed, unsigned) = if a.class() == Class::Signed { (a, b) } else { (b, a) };
            match signed.bits().max(2 * unsigned.bits()) {
                16 => Elementary::Int,
                32 => Elementary::Dint,
                // An S7-1200 has no longer integer.
                _ if rules == Rules::Tia1200 && signed.bits() <= 32 && unsigned.bits() <= 32 => Elementary::Dint,
                _ => Elementary::Lint,
            }
        }
    })
}

/// The bit string that AND, OR, XOR and NOT use for a type.
pub fn bit_string(rules: Rules, ty: Elementary) -> Option<Elementary> {
    Some(match (ty.class(), ty.bits()) {
        (Class::Bits, _) => ty,
        // Source: SCL reference, bit operators: relaxed rules of TIA only.
        (Class::Signed | Class::Unsigned, _) if rules == Rules::Classic => return None,
        (Class::Signed | Class::Unsigned, 8) => Elementary::Byte,
        (Class::Signed | Class::Unsigned, 16) => Elementary::Word,
        (Class::Signed | Class::Unsigned, 32) => Elementary::Dword,
        (Class::Signed | Class::Unsigned, _) => Elementary::Lword,
        _ => return None,
    })
}
