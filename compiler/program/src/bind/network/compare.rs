//! Comparisons, ranges, validity. Source: LAD/FBD reference C.5.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::network::elements::VariantQuestion;
use plcc_syntax::scl::ast::BinaryOp as Operator;

use super::pins::{and, inverted, or};
use super::sheet::Sheet;
use crate::bind::network::NetworkBinder;
use crate::bind::scl::SclBlock;
use crate::bind::scl::expression::constant_expr;
use crate::bind::scl::value::Value;
use crate::bind::scl::variant::{Question, null_answer};
use plcc_model::scl::{CompareOp, Expr, ExprKind, Function};

/// The bits of the smallest REAL that is not denormal.
const LEAST_NORMAL: u64 = 0x0080_0000;
/// The same for LREAL.
const LEAST_NORMAL_LONG: u64 = 0x0010_0000_0000_0000;

impl NetworkBinder<'_, '_> {
    pub fn compare_contact(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, op: &str) -> Option<()> {
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
        let result = self.box_compare(ctx, op, left, right, span)?;
        let result = sheet.keep(ctx, result);
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow, result, span)))
    }

    /// A comparison by a box: unlike in SCL, a NaN is equal to nothing, except on an S7-300/400.
    pub fn box_compare(
        &mut self,
        ctx: &mut SclBlock,
        op: Operator,
        left: Value,
        right: Value,
        span: Span,
    ) -> Option<Expr> {
        let result = self.scl().compare(ctx, op, span, left, right, span)?;
        let ExprKind::Compare { op: CompareOp::NotEqual, left, right } = &result.kind else { return Some(result) };
        if !left.ty.is_float() || ctx.scope.rules.is_300() {
            return Some(result);
        }
        let equal = ExprKind::Compare { op: CompareOp::Equal, left: left.clone(), right: right.clone() };
        Some(inverted(Expr { kind: equal, ..result }))
    }

    pub fn range_contact(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, inside: bool) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "pre")?;
        let values = self.typed_inputs(ctx, sheet, at, &["min", "in", "max"])?;
        let [min, value, max] = <[Value; 3]>::try_from(values).ok()?;
        self.scl().check_limits(&min, &max, ["MIN", "MAX"]);
        let ty = self.common_type(ctx, &[&min, &value, &max], span)?;
        let value = self.scl().convert(ctx, value, ty)?;
        let value = sheet.keep(ctx, value);
        let min = self.scl().convert(ctx, min, ty)?;
        let min = sheet.keep(ctx, min);
        let max = self.scl().convert(ctx, max, ty)?;
        let max = sheet.keep(ctx, max);
        let compare = |op, left: &Expr, right: Expr| Expr {
            kind: ExprKind::Compare { op, left: Box::new(left.clone()), right: Box::new(right) },
            ty: Elementary::Bool,
            span,
        };
        let result = if inside {
            and(compare(CompareOp::GreaterEqual, &value, min), compare(CompareOp::LessEqual, &value, max), span)
        } else {
            let below = compare(CompareOp::Less, &value, min.clone());
            let above = compare(CompareOp::Greater, &value, max.clone());
            let outside = or(below, above, span);
            if ty.is_float() {
                // Nothing is outside a limit that is NaN.
                let numbers = and(
                    compare(CompareOp::Equal, &min, min.clone()),
                    compare(CompareOp::Equal, &max, max.clone()),
                    span,
                );
                and(outside, numbers, span)
            } else {
                outside
            }
        };
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow, result, span)))
    }

    /// A denormal number counts as 0 in computations, but is not valid.
    pub fn valid_contact(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, valid: bool) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "pre")?;
        let value = self.input(ctx, sheet, at, "operand")?;
        let value = self.scl().own_type(ctx, value)?;
        if !value.ty.is_float() {
            self.scl().wrong_type(value.span, value.ty.name(), "a floating-point number", None);
            return None;
        }
        let value = sheet.keep(ctx, value);
        let finite = Expr {
            kind: ExprKind::Function { function: Function::IsValid, arguments: vec![value.clone()] },
            ty: Elementary::Bool,
            span,
        };
        let least = if value.ty == Elementary::Real { LEAST_NORMAL } else { LEAST_NORMAL_LONG };
        let sign = 1 << (value.ty.bits() - 1);
        let against = |op, bits| Expr {
            kind: ExprKind::Compare {
                op,
                left: Box::new(value.clone()),
                right: Box::new(constant_expr(bits, value.ty, span)),
            },
            ty: Elementary::Bool,
            span,
        };
        let large = or(against(CompareOp::GreaterEqual, least), against(CompareOp::LessEqual, least | sign), span);
        let normal = or(large, against(CompareOp::Equal, 0), span);
        let check = and(finite, normal, span);
        let result = if valid { check } else { inverted(check) };
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow, result, span)))
    }

    /// IS_NULL, IS_ARRAY, EQ_Type and their relatives.
    pub fn variant_contact(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        question: VariantQuestion,
    ) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "pre")?;
        let answer = match question {
            VariantQuestion::IsNull { null } => {
                let value = self.input(ctx, sheet, at, "operand")?;
                let op = if null { CompareOp::Equal } else { CompareOp::NotEqual };
                let answer = null_answer(op, &value, span);
                if answer.is_none() {
                    let is = crate::bind::scl::message::described(&value);
                    self.scl().wrong_type(value.span(), &is, "a VARIANT", None);
                }
                self.scl().convert(ctx, answer?, Elementary::Bool)?
            }
            VariantQuestion::IsArray => {
                let value = self.input(ctx, sheet, at, "operand")?;
                let answer = self.scl().type_answer(Question::IsArray, &value, span)?;
                self.scl().convert(ctx, answer, Elementary::Bool)?
            }
            VariantQuestion::SameType { elements, same } => {
                let asked = if elements { Question::ElementType } else { Question::Type };
                let (left, right) = (self.input(ctx, sheet, at, "in1")?, self.input(ctx, sheet, at, "in2")?);
                let left = self.scl().type_answer(asked, &left, span)?;
                let right = self.scl().type_answer(Question::Type, &right, span)?;
                let left = self.scl().convert(ctx, left, Elementary::Dword)?;
                let right = self.scl().convert(ctx, right, Elementary::Dword)?;
                let op = if same { CompareOp::Equal } else { CompareOp::NotEqual };
                let kind = ExprKind::Compare { op, left: Box::new(left), right: Box::new(right) };
                Expr { kind, ty: Elementary::Bool, span }
            }
        };
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow, answer, span)))
    }
}
