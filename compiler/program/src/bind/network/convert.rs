//! CONVERT and rounding. Source: LAD/FBD reference C.11.

use plcc_diag::Code;
use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{Element, TemplateKey};

use super::bits::{argument, call_node};
use super::pins::{connected, inverted, no};
use super::sheet::Sheet;
use crate::bind::network::NetworkBinder;
use crate::bind::scl::SclBlock;
use crate::bind::scl::convert::{converted, rounding};
use crate::bind::scl::expression::constant_expr;
use crate::bind::scl::value::Value;
use plcc_model::scl::{CompareOp, Conversion, Expr, ExprKind, Function, Overflow, StatementKind, UnaryOp};

/// Types that only CONVERT has: numbers in BCD.
fn word(template: &str) -> Option<String> {
    let upper = template.trim().trim_matches('"').to_ascii_uppercase();
    match upper.as_str() {
        "BCD16" | "BCD32" | "STRING" | "WSTRING" => Some(upper),
        _ => Elementary::from_word(&upper).map(|ty| ty.name().to_string()),
    }
}

impl NetworkBinder<'_, '_> {
    /// CONVERT: the function `source_TO_destination` of SCL.
    pub fn convert_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let pin = connected(element, "in")?;
            let (source, target) = binder.conversion_types(ctx, element);
            let Some(target) = target else {
                binder.no_type(span);
                return None;
            };
            let value = binder.pin_value(ctx, sheet, pin)?;
            // The type of the template, except for types that expressions do not have.
            let own = binder.own_type(&value);
            let named = source.as_deref().and_then(Elementary::from_word);
            let (node, from) = match (named, own) {
                (Some(ty), _) => {
                    let value = binder.scl().convert(ctx, value, ty)?;
                    (binder.value_node(ctx, sheet, value), ty.name().to_string())
                }
                (None, _) if source.is_some() => (binder.pin_node(ctx, sheet, pin)?, source.unwrap_or_default()),
                (None, Some(ty)) => {
                    let value = binder.scl().convert(ctx, value, ty)?;
                    (binder.value_node(ctx, sheet, value), ty.name().to_string())
                }
                (None, None) => {
                    let value = binder.scl().own_type(ctx, value)?;
                    let name = value.ty.name().to_string();
                    (binder.value_node(ctx, sheet, value), name)
                }
            };
            let value = if from == target {
                binder.scl().value(ctx, &node)?
            } else {
                let call = call_node(
                    &format!("{}_TO_{}", short(&from), short(&target)),
                    vec![argument("IN", node, false)],
                    span,
                );
                binder.scl().call(ctx, &call, false)?
            };
            binder.box_result(ctx, sheet, at, value)
        })
    }

    /// Source and destination from the settings, or from the variables at the pins.
    fn conversion_types(&mut self, ctx: &mut SclBlock, element: &Element) -> (Option<String>, Option<String>) {
        let named = |key| element.template(key).and_then(|template| word(&template.value));
        let source = named(TemplateKey::Source);
        let target = named(TemplateKey::Destination)
            .or_else(|| self.output_type(ctx, element, "out").map(|ty| ty.name().to_string()));
        (source, target)
    }

    /// ROUND, TRUNC, CEIL, FLOOR: into the type of the destination.
    pub fn round_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let value = binder.input(ctx, sheet, at, "in")?;
            let source = binder.template_type(element, &[TemplateKey::Source]);
            let source = source.or_else(|| binder.own_type(&value)).unwrap_or(Elementary::Real);
            if !source.is_float() {
                binder.impossible_type(element, source);
                return None;
            }
            let value = binder.scl().convert(ctx, value, source)?;
            let target = binder
                .template_type(element, &[TemplateKey::Destination])
                .or_else(|| binder.output_type(ctx, element, "out"))
                .unwrap_or(Elementary::Dint);
            if !target.is_integer() && !target.is_float() {
                binder.scl().refuse(
                    Code::ElementType,
                    span,
                    &format!("{name} cannot convert to {}", target.name()),
                    "the result is a number",
                    "choose an integer or floating-point type as destination",
                );
                return None;
            }
            let value = match target.is_float() {
                false => {
                    let node = binder.value_node(ctx, sheet, value);
                    let call = call_node(&format!("{name}_{}", target.name()), vec![argument("IN", node, false)], span);
                    binder.scl().call(ctx, &call, false)?
                }
                true => binder.rounded_float(ctx, sheet, name, value, target)?,
            };
            binder.box_result(ctx, sheet, at, value)
        })
    }
}

/// A type in the names of functions.
fn short(name: &str) -> &str {
    match name {
        "TIME_OF_DAY" => "TOD",
        other => other,
    }
}

impl NetworkBinder<'_, '_> {
    /// Rounding to a floating-point number: a number too large for a fraction is already whole.
    fn rounded_float(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        name: &str,
        value: Expr,
        target: Elementary,
    ) -> Option<Value> {
        let (ty, span) = (value.ty, value.span);
        let (whole, limit) = match ty {
            Elementary::Lreal => (Elementary::Lint, 2f64.powi(52).to_bits()),
            _ => (Elementary::Dint, u64::from(2f32.powi(23).to_bits())),
        };
        let value = sheet.keep(ctx, value);
        let result = sheet.hidden(ctx, ty);
        sheet.statements.push(result.set(value.clone(), span));
        let conversion = rounding(ctx.scope.rules, name)?;
        let rounded = converted(converted(value.clone(), conversion, whole), Conversion::Value(Overflow::LowBits), ty);
        let amount = Expr { kind: ExprKind::Unary { op: UnaryOp::Abs, operand: Box::new(value.clone()) }, ty, span };
        let small = Expr {
            kind: ExprKind::Compare {
                op: CompareOp::Less,
                left: Box::new(amount),
                right: Box::new(constant_expr(limit, ty, span)),
            },
            ty: Elementary::Bool,
            span,
        };
        self.conditional(sheet, small, StatementKind::Assign { target: result.access(span), value: rounded }, span);
        let valid = Expr {
            kind: ExprKind::Function { function: Function::IsValid, arguments: vec![value] },
            ty: Elementary::Bool,
            span,
        };
        self.conditional(sheet, inverted(valid), StatementKind::SetFlag(no(span)), span);
        let result = self.scl().convert(ctx, Value::Elementary(result.load(span)), target)?;
        Some(Value::Elementary(result))
    }
}
