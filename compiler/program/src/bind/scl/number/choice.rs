//! Functions that choose among values: MIN, MAX, LIMIT, SEL and MUX, also of texts and dates.

use plcc_diag::{Code, Span};
use plcc_syntax::Elementary;

use super::computed;
use crate::bind::scl::coerce::has_call;
use crate::bind::scl::complex::is_dtl;
use crate::bind::scl::expression::constant_expr;
use crate::bind::scl::function::Row;
use crate::bind::scl::numeric::Shape;
use crate::bind::scl::pins::Pins;
use crate::bind::scl::text::is_wide_text;
use crate::bind::scl::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_model::scl::{BinaryOp, Expr, ExprKind, Function};
use plcc_model::types::DataType;

impl SclBinder<'_, '_> {
    /// MIN and MAX.
    pub(super) fn extreme(
        &mut self,
        ctx: &mut SclBlock,
        row: &Row,
        op: BinaryOp,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Value> {
        let nodes = pins.numbered("IN1");
        let values: Vec<Option<Value>> = nodes.iter().map(|node| self.value(ctx, node)).collect();
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        if let [only] = values.as_slice() {
            let text = self.program.globals.text(only.span());
            self.refuse(
                Code::MissingParameter,
                pins.name,
                &format!("{} chooses among several values, but only `{text}` is given", row.name),
                "`IN2` is missing",
                "add `IN2 := …`",
            );
            return None;
        }
        if let Some(kind) = ordered_kind(&values) {
            let name = if op == BinaryOp::Min { "MIN" } else { "MAX" };
            let mut values = values.into_iter();
            let mut best = values.next()?;
            for value in values {
                best = self.instruction_value(ctx, &format!("{name}_{kind}"), vec![best, value], span)?;
            }
            return Some(best);
        }
        let (values, ty) = self.alike_values(ctx, values, suffix)?;
        let fold = |left: Expr, right: Expr| Expr {
            kind: ExprKind::Binary { op, left: Box::new(left), right: Box::new(right) },
            ty,
            span,
        };
        values.into_iter().reduce(fold).map(Value::Elementary)
    }

    /// LIMIT.
    pub(super) fn limit(
        &mut self,
        ctx: &mut SclBlock,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Value> {
        let nodes = [pins.get("MN")?, pins.get("IN")?, pins.get("MX")?];
        let values = nodes.map(|node| self.value(ctx, node));
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        if let [low, _, high] = &values[..] {
            self.check_limits(low, high, ["MN", "MX"]);
        }
        if let Some(kind) = ordered_kind(&values) {
            return self.instruction_value(ctx, &format!("LIMIT_{kind}"), values, span);
        }
        let (arguments, ty) = self.alike_values(ctx, values, suffix)?;
        Some(Value::Elementary(computed(Function::Limit, arguments, ty, span)))
    }

    /// SEL.
    pub(super) fn select(
        &mut self,
        ctx: &mut SclBlock,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Value> {
        let selector = self.of_type(ctx, pins.get("G")?, Elementary::Bool);
        let values = [pins.get("IN0")?, pins.get("IN1")?].map(|node| self.value(ctx, node));
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        if let Some(kind) = complex_kind(&values) {
            let inputs = std::iter::once(Value::Elementary(selector?)).chain(values).collect();
            return self.instruction_value(ctx, &format!("SEL_{kind}"), inputs, span);
        }
        let (mut arguments, ty) = self.alike_values(ctx, values, suffix)?;
        arguments.insert(0, selector?);
        Some(Value::Elementary(computed(Function::Select, arguments, ty, span)))
    }

    /// MUX.
    pub(super) fn mux(
        &mut self,
        ctx: &mut SclBlock,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Value> {
        let selector = self.count_value(ctx, pins.get("K")?, "write the number of an input: 0 for IN0");
        let mut nodes = pins.numbered("IN0");
        let otherwise = pins.get("INELSE");
        if let Some(selector) = &selector {
            self.check_selector(selector, "IN", nodes.len(), otherwise.map(|node| node.span));
        }
        nodes.extend(otherwise);
        let values: Vec<Option<Value>> = nodes.iter().map(|node| self.value(ctx, node)).collect();
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        if let Some(kind) = complex_kind(&values) {
            return self.mux_by_selection(ctx, kind, selector?, values, otherwise.is_some(), span);
        }
        let (mut arguments, ty) = self.alike_values(ctx, values, suffix)?;
        arguments.insert(0, selector?);
        let function = Function::Mux { has_else: otherwise.is_some() };
        Some(Value::Elementary(computed(function, arguments, ty, span)))
    }

    /// MUX of values that are not single values: INELSE, unless K is the number of an input.
    fn mux_by_selection(
        &mut self,
        ctx: &mut SclBlock,
        kind: &str,
        selector: Expr,
        mut values: Vec<Value>,
        has_else: bool,
        span: Span,
    ) -> Option<Value> {
        if !has_else || has_call(&selector) {
            let (label, help) = if has_else {
                ("K is evaluated once for each input", "assign K to a variable first")
            } else {
                ("INELSE is missing", "add `INELSE := …`, the value for all other numbers")
            };
            self.refuse(Code::OperandKind, span, "this MUX of texts or dates cannot be computed", label, help);
            return None;
        }
        let mut result = values.pop()?;
        let inputs = values.len();
        for (number, value) in values.into_iter().enumerate().rev() {
            // A separate MUX, so that a K without an input is an error here as well.
            let flags = (0..=inputs).map(|at| constant_expr(u64::from(at == number), Elementary::Bool, span));
            let arguments = std::iter::once(selector.clone()).chain(flags).collect();
            let meant = computed(Function::Mux { has_else: true }, arguments, Elementary::Bool, span);
            let given = vec![Value::Elementary(meant), result, value];
            result = self.instruction_value(ctx, &format!("SEL_{kind}"), given, span)?;
        }
        Some(result)
    }
}

/// The block for MIN, MAX and LIMIT of values that are not single values.
fn ordered_kind(values: &[Value]) -> Option<&'static str> {
    let of_variables = values.iter().filter_map(own_kind).find(|kind| *kind != "DT");
    of_variables.or_else(|| constant_kind(values)).filter(|kind| *kind != "DT")
}

/// The block for SEL of values that are not single values.
fn complex_kind(values: &[Value]) -> Option<&'static str> {
    values.iter().find_map(own_kind).or_else(|| constant_kind(values))
}

/// What a value is that is not a single value; a constant of a date is what the others are.
fn own_kind(value: &Value) -> Option<&'static str> {
    match value {
        Value::Complex { ty: DataType::DateAndTime, .. } => Some("DT"),
        Value::Complex { ty: DataType::Struct(structure), .. } if is_dtl(structure) => Some("DTL"),
        value if is_wide_text(value) => Some("WSTRING"),
        value if is_long_text(value) => Some("STRING"),
        _ => None,
    }
}

/// What constants of dates are if there is nothing else.
fn constant_kind(values: &[Value]) -> Option<&'static str> {
    let of_dtl = |value: &Value| matches!(value, Value::Constant(Constant::Dtl(_), _));
    let is_date = |value: &Value| of_dtl(value) || matches!(value, Value::Constant(Constant::DateAndTime(_), _));
    let kind = if values.iter().any(of_dtl) { "DTL" } else { "DT" };
    (!values.is_empty() && values.iter().all(is_date)).then_some(kind)
}

/// True of a text of more than one character.
fn is_long_text(value: &Value) -> bool {
    match value {
        Value::Complex { ty, .. } => matches!(ty, DataType::String(_)),
        Value::Constant(Constant::Text { .. }, _) => Shape::of(value) != Shape::Letter,
        _ => false,
    }
}
