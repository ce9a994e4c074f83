//! Numbers in a chart of S7-GRAPH V5: its comparisons and its arithmetic are those of INT, DINT, REAL and TIME.
//!
//! The operands decide the type, because the text does not show it: an address such as MD4 is the number of its width, or has the type of
//! the other side, and milliseconds in a DWORD or DINT are a TIME. Source: GRAPH reference A.6, D.8.

use plcc_syntax::{Class, Elementary};

use crate::bind::scl::convert::explicit_expr;
use crate::bind::scl::numeric::Shape;
use crate::bind::scl::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;

impl SclBinder<'_, '_> {
    /// The two sides of a comparison or of `+ - * /`, in the types that it uses.
    pub fn address_operands(&mut self, ctx: &mut SclBlock, left: Value, right: Value) -> (Value, Value) {
        let (left_type, right_type) = (taken_as(&left, &right), taken_as(&right, &left));
        (self.address_operand(ctx, left, left_type), self.address_operand(ctx, right, right_type))
    }

    fn address_operand(&mut self, ctx: &mut SclBlock, value: Value, ty: Option<Elementary>) -> Value {
        let Some(ty) = ty else { return value };
        let kept = value.clone();
        let Some(value) = self.own_type(ctx, value) else { return kept };
        explicit_expr(ctx.scope.rules, value, ty).map_or(kept, Value::Elementary)
    }
}

/// The type that a value has next to `other`; none: its own.
fn taken_as(value: &Value, other: &Value) -> Option<Elementary> {
    let beside = Shape::of(other);
    let number = match Shape::of(value) {
        Shape::Of(Elementary::Word) => Elementary::Int,
        Shape::Of(Elementary::Dword) => Elementary::Dint,
        Shape::Of(Elementary::Int | Elementary::Dint | Elementary::S5Time) | Shape::Integer(_)
            if beside == Shape::Of(Elementary::Time) =>
        {
            return Some(Elementary::Time);
        }
        _ => return None,
    };
    match beside {
        Shape::Integer(_) if matches!(other, Value::Constant(Constant::Integer { based: true, .. }, _)) => None,
        Shape::Of(ty) if ty.class() == Class::Bits => (ty.bits() >= 16).then_some(number),
        Shape::Of(ty) if ty.bits() == number.bits() => Some(ty),
        Shape::Real if number == Elementary::Dint => Some(Elementary::Real),
        Shape::Of(_) | Shape::Integer(_) => Some(number),
        Shape::Real | Shape::Letter | Shape::Other => None,
    }
}
