//! Comparisons and arithmetic in a chart of S7-GRAPH V5: those of LAD, of INT, DINT, REAL and TIME.
//!
//! The text of a condition does not say which one is meant, so that the operands do: an address such as MD4 is the number of its width, or
//! what it is combined with, and milliseconds in a DWORD or DINT are a TIME. Source: GRAPH reference A.6, D.8.

use plcc_syntax::{Class, Elementary};

use crate::bind::constant::Constant;
use crate::bind::scl::convert::explicit_expr;
use crate::bind::scl::numeric::Shape;
use crate::bind::scl::value::Value;
use crate::bind::{Binder, Ctx};

impl Binder<'_> {
    /// The two sides of an operator, as it takes them.
    pub(in crate::bind) fn chart_operands(&mut self, ctx: &mut Ctx, left: Value, right: Value) -> (Value, Value) {
        let (left_type, right_type) = (compared_as(&left, &right), compared_as(&right, &left));
        (self.taken_as(ctx, left, left_type), self.taken_as(ctx, right, right_type))
    }

    fn taken_as(&mut self, ctx: &mut Ctx, value: Value, ty: Option<Elementary>) -> Value {
        let Some(ty) = ty else { return value };
        let kept = value.clone();
        let Some(value) = self.scl_own_type(ctx, value) else { return kept };
        explicit_expr(ctx.scl.rules, value, ty).map_or(kept, Value::Elementary)
    }
}

/// The type of its width that a value beside `other` has; none: its own.
fn compared_as(value: &Value, other: &Value) -> Option<Elementary> {
    let number = match Shape::of(value) {
        Shape::Of(Elementary::Word) => Elementary::Int,
        Shape::Of(Elementary::Dword) => Elementary::Dint,
        Shape::Of(Elementary::Dint) if Shape::of(other) == Shape::Of(Elementary::Time) => {
            return Some(Elementary::Time);
        }
        _ => return None,
    };
    match Shape::of(other) {
        Shape::Integer(_) if matches!(other, Value::Constant(Constant::Integer { based: true, .. }, _)) => None,
        Shape::Of(ty) if ty.class() == Class::Bits => (ty.bits() >= 16).then_some(number),
        Shape::Of(ty) if ty.bits() == number.bits() => Some(ty),
        Shape::Real if number == Elementary::Dint => Some(Elementary::Real),
        Shape::Of(_) | Shape::Integer(_) => Some(number),
        Shape::Real | Shape::Letter | Shape::Other => None,
    }
}
