//! Comparisons, ranges, validity. Source: LAD/FBD reference C.5.

use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::BinaryOp as Operator;

use super::pins::{and, inverted};
use super::sheet::Sheet;
use crate::bind::scl::value::Value;
use crate::bind::{Binder, Ctx};
use crate::model::scl::{CompareOp, Expr, ExprKind, Function};

impl Binder<'_> {
    pub fn compare_contact(&mut self, ctx: &mut Ctx, sheet: &mut Sheet, at: usize, op: &str) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "pre")?;
        let values = self.typed_inputs(ctx, sheet, at, &["in1", "in2"])?;
        let [left, right] = <[Value; 2]>::try_from(values).ok()?;
        let op = match op {
            "<>" => Operator::NotEqual,
            ">=" => Operator::GreaterEqual,
            "<=" => Operator::LessEqual,
            ">" => Operator::Greater,
            "<" => Operator::Less,
            _ => Operator::Equal,
        };
        let result = self.compare(ctx, op, span, left, right, span)?;
        let result = sheet.keep(ctx, result);
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow, result, span)))
    }

    pub fn range_contact(&mut self, ctx: &mut Ctx, sheet: &mut Sheet, at: usize, inside: bool) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "pre")?;
        let values = self.typed_inputs(ctx, sheet, at, &["min", "in", "max"])?;
        let [min, value, max] = <[Value; 3]>::try_from(values).ok()?;
        let ty = self.common_type(ctx, &[&min, &value, &max], span)?;
        let value = self.scl_convert(ctx, value, ty)?;
        let value = sheet.keep(ctx, value);
        let (min, max) = (self.scl_convert(ctx, min, ty)?, self.scl_convert(ctx, max, ty)?);
        let compare = |op, left: &Expr, right: Expr| Expr {
            kind: ExprKind::Compare { op, left: Box::new(left.clone()), right: Box::new(right) },
            ty: Elementary::Bool,
            span,
        };
        let result = if inside {
            and(compare(CompareOp::GreaterEqual, &value, min), compare(CompareOp::LessEqual, &value, max), span)
        } else {
            super::pins::or(compare(CompareOp::Less, &value, min), compare(CompareOp::Greater, &value, max), span)
        };
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow, result, span)))
    }

    /// A denormal number is computed with as 0 and still no valid one.
    pub fn valid_contact(&mut self, ctx: &mut Ctx, sheet: &mut Sheet, at: usize, valid: bool) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "pre")?;
        let value = self.input(ctx, sheet, at, "operand")?;
        let value = self.scl_own_type(ctx, value)?;
        if !value.ty.is_float() {
            self.wrong_type(value.span, value.ty.name(), "a floating-point number", None);
            return None;
        }
        let value = sheet.keep(ctx, value);
        let check = Expr {
            kind: ExprKind::Function { function: Function::IsValid, arguments: vec![value] },
            ty: Elementary::Bool,
            span,
        };
        let result = if valid { check } else { inverted(check) };
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow, result, span)))
    }
}
