//! Assignments. Source: SCL reference, assignment.

use plcc_diag::{Code, Span};
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::{AssignOp, BinaryOp as Operator, Expr as Node, ExprKind as NodeKind, NameForm};

use super::coerce::{access_has_call, is_untyped};
use super::complex::copied_bytes;
use super::convert;
use super::expression::constant_expr;
use super::place::Thing;
use super::scope::Scope;
use super::value::Value;
use super::{Intent, Rules, message};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_model::layout;
use plcc_model::scl::{Access, Complex, Expr, ExprKind, Function, Statement, StatementKind};
use plcc_model::types::DataType;

impl SclBinder<'_, '_> {
    /// `a := b += e`: from right to left, one statement for each.
    pub(super) fn assign(
        &mut self,
        ctx: &mut SclBlock,
        targets: &[(Node, AssignOp)],
        value: &Node,
        span: Span,
        bound: &mut Vec<Statement>,
    ) {
        if self.is_undefined_in_quotes(ctx, value)
            && targets.iter().any(|(target, _)| self.is_text_operand(ctx, target))
            && self.is_text_in_name_quotes(ctx, value)
        {
            return;
        }
        let special = self.reference_for_target(ctx, targets, value, span);
        ctx.scope.long_texts = self.goes_to_long_text(ctx, targets, value);
        let mut value = match special.or_else(|| self.value_for_target(ctx, targets, value)) {
            Some(value) => value,
            None => self.value(ctx, value),
        };
        ctx.scope.long_texts = false;
        for (at, (target, op)) in targets.iter().enumerate().rev() {
            let read = at > 0;
            value = self.assign_one(ctx, target, *op, value, span, read, bound);
        }
    }

    /// Assigns to one target; returns its value if `read`.
    #[allow(clippy::too_many_arguments, reason = "the parts of one assignment")]
    fn assign_one(
        &mut self,
        ctx: &mut SclBlock,
        target: &Node,
        op: AssignOp,
        value: Option<Value>,
        span: Span,
        read: bool,
        bound: &mut Vec<Statement>,
    ) -> Option<Value> {
        // Anything that can never be a target is reported by the parser.
        if matches!(target.kind, NodeKind::Literal(_) | NodeKind::Unary { .. } | NodeKind::Binary { .. }) {
            return None;
        }
        if let NodeKind::Name(name) = &target.kind
            && name.form == NameForm::Bare
            && ["TRUE", "FALSE"].iter().any(|word| name.text.eq_ignore_ascii_case(word))
        {
            let title = format!("`{}` cannot be assigned", name.text);
            self.refuse(
                Code::OperandKind,
                name.span,
                &title,
                "a constant",
                "write the variable on the left side of `:=`",
            );
            return None;
        }
        if self.is_flag(ctx, target) {
            return self.assign_flag(ctx, target, op, value?, span, read, bound);
        }
        let access = self.access(ctx, target, Intent::Write);
        let (access, value) = (access?, value?);
        if (read || op != AssignOp::Set) && access_has_call(&access) {
            self.refuse(
                Code::OperandKind,
                target.span,
                "the address of this variable depends on a call and is needed twice",
                "a call in an index",
                "assign the index to a variable first",
            );
            return None;
        }
        let current = |access: &Access| value_of(access, target.span);
        let value = match operator(op) {
            None => value,
            Some(op) => {
                let left = current(&access)?;
                self.binary_value(ctx, op, target.span, left, value, span)?
            }
        };
        let result = if read { current(&access) } else { None };
        let value = self.converted_mux(ctx, &access, value, bound)?;
        let kind = self.assignment(ctx, access, value)?;
        bound.push(Statement { kind, span });
        result
    }

    /// A MUX without ELSE whose value is converted to the type of the variable: the variable keeps its own value, not what is left of it
    /// after conversions, if no input has the number. K is evaluated once.
    fn converted_mux(
        &mut self,
        ctx: &mut SclBlock,
        target: &Access,
        value: Value,
        bound: &mut Vec<Statement>,
    ) -> Option<Value> {
        let mut expr = match value {
            Value::Elementary(expr) => expr,
            other => return Some(other),
        };
        let span = expr.span;
        let is_open = inputs_without_else(&mut expr).is_some();
        let is_text = matches!(target.ty, DataType::String(_) | DataType::WideString(_));
        if is_open && is_text && matches!(expr.kind, ExprKind::Function { .. }) {
            let help = "add `INELSE := …`, the value for all other numbers";
            self.refuse(Code::OperandKind, span, "this MUX of texts cannot be computed", "INELSE is missing", help);
            return None;
        }
        let keeps = matches!(ctx.scope.rules, Rules::Tia1200 | Rules::Tia1500)
            && !access_has_call(target)
            && !is_untyped(ctx, target.span);
        let ty = match target.elementary() {
            Some(ty) if is_open && keeps => ty,
            _ => return Some(Value::Elementary(expr)),
        };
        let mut expr = self.convert(ctx, Value::Elementary(expr), ty)?;
        if !matches!(expr.kind, ExprKind::Convert { .. }) {
            return Some(Value::Elementary(expr));
        }
        let Some(inputs) = inputs_without_else(&mut expr) else { return Some(Value::Elementary(expr)) };
        let mut code = Vec::new();
        let selector = self.kept(ctx, &mut code, inputs[0].clone());
        inputs[0] = selector.clone();
        let count = inputs.len() - 1;
        bound.extend(code.into_iter().map(|kind| Statement { kind, span }));
        // TRUE for each input, FALSE for all other numbers.
        let found = (0..=count).map(|at| constant_expr(u64::from(at < count), Elementary::Bool, span));
        let arguments = std::iter::once(selector).chain(found).collect();
        let found = Function::Mux { has_else: true };
        let found = Expr { kind: ExprKind::Function { function: found, arguments }, ty: Elementary::Bool, span };
        let old = Expr { kind: ExprKind::Load(Box::new(target.clone())), ty, span };
        let kind = ExprKind::Function { function: Function::Select, arguments: vec![found, old, expr] };
        Some(Value::Elementary(Expr { kind, ty, span }))
    }

    pub(in crate::bind) fn binary_value(
        &mut self,
        ctx: &mut SclBlock,
        op: Operator,
        op_span: Span,
        left: Value,
        right: Value,
        span: Span,
    ) -> Option<Value> {
        match self.time_arithmetic(ctx, op, op_span, left, right, span) {
            Ok(value) => value,
            Err((left, right)) => self.arithmetic(ctx, op, op_span, left, right, span),
        }
    }

    /// The statement that assigns `value` to `target`, by the target's type.
    pub(in crate::bind) fn assignment(
        &mut self,
        ctx: &mut SclBlock,
        target: Access,
        value: Value,
    ) -> Option<StatementKind> {
        let value = match self.result_in_place(&target, value) {
            Ok(call) => return Some(call),
            Err(value) => value,
        };
        if let Some(ty) = target.elementary() {
            let value = self.for_address(ctx, value, target.span, ty);
            self.number_for_duration(ctx, &value, ty);
            let value = self.convert(ctx, value, ty)?;
            let value = with_else(ctx.scope.rules, &target, value);
            return Some(StatementKind::Assign { target, value });
        }
        let ty = target.ty.clone();
        match &ty {
            DataType::Elementary(_) | DataType::Void => None,
            DataType::String(_) | DataType::WideString(_) => {
                let value = self.complex_value(ctx, value, &ty)?;
                Some(StatementKind::AssignText { target, value })
            }
            DataType::Array(_) if matches!(value, Value::Constant(..) | Value::Elementary(_)) => {
                self.single_value_for_array(&ctx.scope, &ty, target.span, &value);
                None
            }
            DataType::DateAndTime | DataType::Array(_) | DataType::Struct(_) | DataType::Parameter(_) => {
                let source = self.complex_value(ctx, value, &ty)?;
                Some(StatementKind::Copy { target, source, bytes: copied_bytes(&ty) })
            }
            DataType::OpenArray(_) => {
                let is = layout::type_name(&ty);
                let help = "copy the elements in a loop, or with MOVE_BLK";
                let title = format!("a variable of type {is} cannot be assigned as a whole");
                self.refuse(Code::TypeMismatch, target.span, &title, &is, help);
                None
            }
        }
    }

    /// Reports `array := 0`.
    fn single_value_for_array(&mut self, scope: &Scope, ty: &DataType, target: Span, value: &Value) {
        let DataType::Array(array) = ty else { return };
        let text = |span| self.program.globals.text(span);
        let (target, written) = (text(target), text(value.span()));
        let low: Vec<String> = array.bounds.iter().map(|(low, _)| low.to_string()).collect();
        let element = format!("{target}[{}]", low.join(","));
        let count = layout::element_count(&array.bounds);
        let single = array.bounds.len() == 1 && matches!(array.element, DataType::Elementary(_));
        let help = match scope.rules != Rules::Classic && single {
            true if scope.is_network() => format!(
                "use the element `FILL_BLK( in := {written}, count := {count}, out => {element} )`, or for one element connect `{element}`"
            ),
            true => format!(
                "write `FILL_BLK(IN := {written}, COUNT := {count}, OUT => {element});`, or for one element `{element} := {written};`"
            ),
            false => format!("assign the elements in a loop, each as in `{element} := {written};`"),
        };
        self.wrong_type(value.span(), &message::described(value), &layout::type_name(ty), Some(help));
    }

    /// The target is `OK` or `ENO`.
    fn is_flag(&mut self, ctx: &mut SclBlock, target: &Node) -> bool {
        let NodeKind::Name(name) = &target.kind else { return false };
        if !name.text.eq_ignore_ascii_case("OK") && !name.text.eq_ignore_ascii_case("ENO") {
            return false;
        }
        matches!(self.thing(ctx, target, Intent::Write), Some(Thing::Flag | Thing::LastEno))
    }

    #[allow(clippy::too_many_arguments, reason = "the parts of one assignment")]
    fn assign_flag(
        &mut self,
        ctx: &mut SclBlock,
        target: &Node,
        op: AssignOp,
        value: Value,
        span: Span,
        read: bool,
        bound: &mut Vec<Statement>,
    ) -> Option<Value> {
        if op != AssignOp::Set {
            let is = message::described(&value);
            self.wrong_type(target.span, "a BOOL", "a number", Some(format!("assign {is} with `:=`")));
            return None;
        }
        let value = self.convert(ctx, value, Elementary::Bool)?;
        bound.push(Statement { kind: StatementKind::SetFlag(value), span });
        read.then_some(Value::Elementary(Expr { kind: ExprKind::Flag, ty: Elementary::Bool, span }))
    }
}

/// MUX without ELSE keeps the variable if no input has the number. Source: S7-1200 reference, MUX.
fn with_else(rules: Rules, target: &Access, mut value: Expr) -> Expr {
    let usable = matches!(rules, Rules::Tia1200 | Rules::Tia1500) && !access_has_call(target);
    if let (Some(ty), true) = (target.elementary(), usable) {
        let (kind, span) = (ExprKind::Load(Box::new(target.clone())), value.span);
        add_else(rules, Expr { kind, ty, span }, &mut value);
    }
    value
}

/// K and the inputs of a MUX without ELSE, even if its value is converted.
fn inputs_without_else(value: &mut Expr) -> Option<&mut Vec<Expr>> {
    match &mut value.kind {
        ExprKind::Function { function: Function::Mux { has_else: false }, arguments } => Some(arguments),
        ExprKind::Convert { operand, .. } => inputs_without_else(operand),
        _ => None,
    }
}

/// Sets `otherwise` of a MUX, even if its value is converted.
fn add_else(rules: Rules, otherwise: Expr, value: &mut Expr) {
    let ty = value.ty;
    match &mut value.kind {
        ExprKind::Function { function: Function::Mux { has_else: has_else @ false }, arguments } => {
            if let Some(otherwise) = convert::explicit_expr(rules, otherwise, ty) {
                *has_else = true;
                arguments.push(otherwise);
            }
        }
        ExprKind::Convert { operand, .. } => add_else(rules, otherwise, operand),
        _ => {}
    }
}

/// The value of a variable.
pub(in crate::bind) fn value_of(access: &Access, span: Span) -> Option<Value> {
    Some(match (access.elementary(), &access.ty) {
        (Some(ty), _) => Value::Elementary(Expr { kind: ExprKind::Load(Box::new(access.clone())), ty, span }),
        (None, DataType::Parameter(_) | DataType::OpenArray(_)) => Value::Parameter { access: access.clone(), span },
        (None, DataType::Void) => return None,
        (None, ty) => Value::Complex { value: Complex::Variable(access.clone()), ty: ty.clone(), span },
    })
}

const fn operator(op: AssignOp) -> Option<Operator> {
    match op {
        AssignOp::Add => Some(Operator::Add),
        AssignOp::Subtract => Some(Operator::Subtract),
        AssignOp::Multiply => Some(Operator::Multiply),
        AssignOp::Divide => Some(Operator::Divide),
        AssignOp::Set | AssignOp::Attempt => None,
    }
}
