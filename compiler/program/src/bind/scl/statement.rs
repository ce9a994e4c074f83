//! Statements. Source: SCL reference, statements.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::BlockPrefix;
use plcc_syntax::scl::ast::{
    BinaryOp as Operator, Expr as Node, ExprKind as NodeKind, Literal, Statement as Tree, StatementKind as TreeKind,
};

use super::Intent;
use super::actual::is_variable;
use super::constant;
use super::expression::{constant_expr, typed_constant};
use super::value::Value;
use crate::bind::scl::message::DEPTH_MAX;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_model::scl::{Complex, Expr, ExprKind, Statement, StatementKind};
use plcc_model::types::DataType;
use plcc_model::{self, StlStatementKind};

impl SclBinder<'_, '_> {
    /// A list of statements.
    pub(in crate::bind) fn statements(&mut self, ctx: &mut SclBlock, trees: &[Tree]) -> Vec<Statement> {
        ctx.scope.lists.push(trees.as_ptr() as usize);
        let mut bound = Vec::with_capacity(trees.len());
        for tree in trees {
            if ctx.scope.lists.len() as u32 > DEPTH_MAX {
                self.too_deep(tree.span);
                break;
            }
            self.statement(ctx, tree, &mut bound);
        }
        ctx.scope.lists.pop();
        bound
    }

    pub(in crate::bind) fn statement(&mut self, ctx: &mut SclBlock, tree: &Tree, bound: &mut Vec<Statement>) {
        if has_enable(tree) && self.enabled_function(ctx, tree, bound) {
            return;
        }
        let span = ctx.block.fixed_span.unwrap_or(head(tree));
        let kind = match &tree.kind {
            TreeKind::Empty => None,
            TreeKind::Error => {
                ctx.scope.unread = true;
                None
            }
            TreeKind::Label(name) => self.label(ctx, name).map(StatementKind::Label),
            TreeKind::Expression(node) => self.lone_expression(ctx, node, bound),
            TreeKind::Assign { targets, value } => {
                self.assign(ctx, targets, value, span, bound);
                None
            }
            TreeKind::If { branches, otherwise } => {
                let branches: Vec<Option<(Expr, Vec<Statement>)>> = branches
                    .iter()
                    .map(|(condition, body)| {
                        let condition = self.condition(ctx, condition);
                        let body = self.statements(ctx, body);
                        Some((condition?, body))
                    })
                    .collect();
                let otherwise = self.statements(ctx, otherwise);
                let branches: Option<Vec<_>> = branches.into_iter().collect();
                branches.map(|branches| StatementKind::If { branches, otherwise })
            }
            TreeKind::Case { selector, arms, otherwise } => self.case(ctx, selector, arms, otherwise),
            TreeKind::For { variable, start, end, step, body } => {
                self.for_loop(ctx, variable, (start, end, step.as_ref()), body, head(tree))
            }
            TreeKind::While { condition, body } => {
                let condition = self.condition(ctx, condition);
                let body = self.loop_body(ctx, body);
                condition.map(|condition| StatementKind::While { condition, body })
            }
            TreeKind::Repeat { body, until } => {
                let body = self.loop_body(ctx, body);
                let until = self.condition(ctx, until);
                until.map(|until| StatementKind::Repeat { body, until })
            }
            TreeKind::Exit => self.in_loop(ctx, "EXIT", tree.span).map(|()| StatementKind::Exit),
            TreeKind::Continue => self.in_loop(ctx, "CONTINUE", tree.span).map(|()| StatementKind::Continue),
            TreeKind::Return(None) => Some(StatementKind::Return(None)),
            TreeKind::Return(Some(value)) if self.returns_value(ctx, value) => None,
            TreeKind::Return(Some(value)) => self.condition(ctx, value).map(|value| StatementKind::Return(Some(value))),
            TreeKind::Goto(name) => self.goto(ctx, name).map(StatementKind::Goto),
            TreeKind::Pragma(pragma) => match self.stl().statement_pragma(ctx.block, pragma) {
                Some(StlStatementKind::Assert(assert)) => {
                    let register = |side: &plcc_model::AssertSide| matches!(side, plcc_model::AssertSide::Register(_));
                    if assert.sides().any(register) {
                        self.refuse(
                            Code::Pragma,
                            pragma.span,
                            "SCL has no registers that an assertion could check",
                            "not understood",
                            "name a variable, an address or a constant",
                        );
                        return;
                    }
                    Some(StatementKind::Assert(*assert))
                }
                Some(StlStatementKind::Sleep(milliseconds)) => Some(StatementKind::Sleep(milliseconds)),
                _ => None,
            },
        };
        bound.extend(kind.map(|kind| Statement { kind, span }));
    }

    /// `RETURN 5;` as other languages write it, which is reported: SCL assigns the value of a function to its name.
    fn returns_value(&mut self, ctx: &mut SclBlock, value: &Node) -> bool {
        if !self.is_result(ctx, value) {
            return false;
        }
        let text = self.program.globals.text(value.span);
        let function = ctx.block.bound.interface.parameters.iter().any(|parameter| parameter.name == "RET_VAL");
        ctx.scope.value_set = true;
        let name = self.program.globals.shown(ctx.block.key).trim_matches('`').replace(' ', "");
        let name = if name.starts_with("FC") { name } else { format!("#{name}") };
        let help = match function {
            true => format!("write `{name} := {text}; RETURN;`"),
            false => "write `RETURN;`, and give the value to an output parameter".to_string(),
        };
        self.refuse(Code::ForeignForm, value.span, "RETURN takes no value", "a form of other languages", &help);
        true
    }

    /// Whether what follows RETURN is a value of another type than BOOL, which would be a condition.
    fn is_result(&mut self, ctx: &mut SclBlock, node: &Node) -> bool {
        match &node.kind {
            NodeKind::Literal(Literal::Integer { .. } | Literal::Real(_) | Literal::Text { .. }) => true,
            NodeKind::Name(_) | NodeKind::Member { .. } | NodeKind::Index { .. } => {
                let access = self.quietly(ctx, |binder, ctx| binder.access(ctx, node, super::Intent::Read));
                access.is_some_and(|access| access.elementary() != Some(plcc_syntax::Elementary::Bool))
            }
            NodeKind::Binary { .. } | NodeKind::Unary { .. } => match self.quiet_value(ctx, node) {
                Some(Value::Elementary(expr)) => expr.ty != Elementary::Bool,
                Some(Value::Constant(Constant::Integer { .. } | Constant::Real(_), _)) => true,
                _ => false,
            },
            _ => false,
        }
    }

    /// A condition: BOOL only.
    fn condition(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        self.convert(ctx, value, Elementary::Bool)
    }

    /// A call, or an expression that was meant as something else.
    fn lone_expression(
        &mut self,
        ctx: &mut SclBlock,
        node: &Node,
        bound: &mut Vec<Statement>,
    ) -> Option<StatementKind> {
        match &node.kind {
            NodeKind::Call { callee, .. } if let Some(filling) = hole(ctx, callee) => {
                bound.extend(filling);
                None
            }
            NodeKind::Call { .. } => match self.call(ctx, node, true)? {
                Value::Nothing(call) => Some(StatementKind::Call(call)),
                Value::Complex { value: Complex::Call(call), .. } => Some(StatementKind::Call(call)),
                Value::Elementary(Expr { kind: ExprKind::Call(call), .. }) => Some(StatementKind::Call(call)),
                Value::Elementary(expr) => Some(StatementKind::Evaluate(expr)),
                Value::Statements(statements, _) => {
                    let place = |statement: Statement| Statement {
                        span: ctx.block.fixed_span.unwrap_or(statement.span),
                        ..statement
                    };
                    bound.extend(statements.into_iter().map(place));
                    None
                }
                _ => None,
            },
            NodeKind::Binary { .. } if let Some((target, sign)) = compared_first(node) => {
                let value = Span { start: sign.end, end: node.span.end, ..sign };
                let length = (value.end - value.start) as usize;
                let (target, value) = (self.program.globals.text(target.span), self.program.globals.text(value));
                // `#count =+ 1` may be meant as `+=`.
                let adds = match value.split_at_checked(1) {
                    Some((sign @ ("+" | "-"), rest)) if rest.starts_with(' ') && value.len() == length => {
                        let word = if sign == "+" { "add" } else { "subtract" };
                        format!(", to {word} write `{target} := {target} {sign} {};`", rest.trim_start())
                    }
                    _ => String::new(),
                };
                ctx.scope.value_set = true;
                self.program.report(
                    Diagnostic::new(Code::AssignSign, sign, "this compares and does nothing with the result")
                        .label("a comparison")
                        .help(format!("to assign write `{target} := {value};`{adds}")),
                );
                None
            }
            NodeKind::Binary { op: Operator::Equal, op_span, left, right } => {
                let text = |span| self.program.globals.text(span);
                let help = if matches!(left.kind, NodeKind::Literal(_)) && is_variable(right) {
                    format!("to assign write `{} := {};`", text(right.span), text(left.span))
                } else {
                    let whole = text(node.span);
                    format!("use the result, as in `IF {whole} THEN`, or assign it to a variable with `:=`")
                };
                ctx.scope.value_set = true;
                self.program.report(
                    Diagnostic::new(Code::AssignSign, *op_span, "this compares and does nothing with the result")
                        .label("a comparison")
                        .help(help),
                );
                None
            }
            NodeKind::Error => {
                ctx.scope.unread = true;
                None
            }
            _ => {
                let text = self.program.globals.text(node.span);
                let help = match self.may_be_called(ctx, node) {
                    true => format!("to call it, write `{text}( … );`"),
                    false => "assign it, or call the block with parentheses: `name();`".to_owned(),
                };
                let title = format!("`{text}` alone is not a statement");
                self.refuse(Code::Syntax, node.span, &title, "its value is not used", &help);
                None
            }
        }
    }

    /// Whether the node names a function, or an instance of a function block.
    fn may_be_called(&self, ctx: &SclBlock, node: &Node) -> bool {
        match self.quiet_block(ctx, node) {
            Some((BlockPrefix::Fc | BlockPrefix::Sfc, _)) => true,
            Some((BlockPrefix::Db, number)) => {
                self.program.data.blocks.get(&number).is_some_and(|db| db.block.instance_of.is_some())
            }
            Some(_) => false,
            None => {
                let NodeKind::Name(name) = &node.kind else { return false };
                let local = ctx.block.bound.locals.get(&fold(&name.text)).map(|local| &local.ty);
                matches!(local, Some(DataType::Struct(structure)) if structure.instance_of.is_some())
            }
        }
    }

    fn in_loop(&mut self, ctx: &SclBlock, word: &str, span: Span) -> Option<()> {
        if ctx.scope.loops > 0 {
            return Some(());
        }
        let help = match word {
            "EXIT" => "to leave the block write RETURN",
            _ => "it continues with the next pass of FOR, WHILE or REPEAT",
        };
        let title = format!("{word} is outside of a loop");
        let span = Span { end: span.end.min(span.start + word.len() as u32), ..span };
        self.refuse(Code::LoopControl, span, &title, "there is no loop around it", help);
        None
    }

    fn loop_body(&mut self, ctx: &mut SclBlock, body: &[Tree]) -> Vec<Statement> {
        ctx.scope.loops += 1;
        let body = self.statements(ctx, body);
        ctx.scope.loops -= 1;
        body
    }

    fn for_loop(
        &mut self,
        ctx: &mut SclBlock,
        variable: &Node,
        (start, end, step): (&Node, &Node, Option<&Node>),
        body: &[Tree],
        span: Span,
    ) -> Option<StatementKind> {
        let spot = self.spot(ctx, variable, Intent::Write);
        let ty = match spot.as_ref().map(|spot| (&spot.ty, spot.part)) {
            Some((DataType::Elementary(ty), None)) if ty.is_integer() => Some(*ty),
            Some(_) => {
                let text = self.program.globals.text(variable.span);
                self.refuse(
                    Code::TypeMismatch,
                    variable.span,
                    &format!("`{text}` cannot count a loop"),
                    "not an integer variable",
                    "declare a variable of type INT or DINT for it",
                );
                None
            }
            None => None,
        };
        let mut limit = |binder: &mut Self, node: &Node| match ty {
            Some(ty) => binder.of_type(ctx, node, ty),
            None => binder.value(ctx, node).and(None),
        };
        let start = limit(self, start);
        let end = limit(self, end);
        let step = match (step, ty) {
            (Some(step), Some(ty)) => self.step(ctx, step, ty, variable.span),
            (Some(step), None) => self.value(ctx, step).and(None),
            (None, _) => ty.map(|ty| constant_expr(1, ty, span)),
        };
        if let Some(spot) = &spot {
            // The loop writes the variable that it counts with.
            ctx.scope.loop_variables.push((spot.clone(), variable.span));
        }
        let bound = self.loop_body(ctx, body);
        if spot.is_some() {
            ctx.scope.loop_variables.pop();
        }
        let (spot, ty, start, end, step) = (spot?, ty?, start?, end?, step?);
        self.check_end(ty, [&start, &end, &step], &bound, span)?;
        let variable = spot.access(variable.span);
        Some(StatementKind::For { variable, start, end, step, body: bound })
    }

    /// The step of a loop whose variable has type `ty`. One without a sign cannot count down. Source: SCL reference, FOR.
    fn step(&mut self, ctx: &mut SclBlock, node: &Node, ty: Elementary, variable: Span) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        let number = match &value {
            Value::Constant(Constant::Integer { value, .. }, _) => Some(*value),
            other => typed_constant(other)
                .filter(|(own, _)| own.is_integer())
                .map(|(own, bits)| constant::integer(own, bits)),
        };
        if ty.is_signed() || number.is_none_or(|number| number >= 0) {
            return self.convert(ctx, value, ty);
        }
        let text = self.program.globals.text(variable);
        let signed = if ty == Elementary::Usint { "INT" } else { "DINT" };
        self.refuse(
            Code::TypeMismatch,
            node.span,
            &format!("`{text}` of type {} cannot count down", ty.name()),
            &format!("a negative step, but no value of type {} is negative", ty.name()),
            &format!("declare `{text}` as {signed}"),
        );
        None
    }

    /// Limits that are known and never reached. Source: SCL reference, FOR.
    fn check_end(&mut self, ty: Elementary, limits: [&Expr; 3], body: &[Statement], span: Span) -> Option<()> {
        let known = |expr: &Expr| {
            let (ty, bits) = typed_constant(&Value::Elementary(expr.clone()))?;
            Some(constant::integer(ty, bits))
        };
        let [start, end, step] = limits.map(known);
        let (low, high) = constant::range(ty);
        let (Some(end), Some(step)) = (end, step) else { return Some(()) };
        let runs = |start: i128| if step >= 0 { start <= end } else { start >= end };
        let endless = match start {
            Some(start) if !runs(start) => false,
            _ if step == 0 => start.is_some(),
            // The first value that fails the test.
            Some(start) => {
                let first = start + ((end - start) / step + 1) * step;
                first > high || first < low
            }
            None => (step > 0 && end == high) || (step < 0 && end == low),
        };
        if !endless || body.iter().any(leaves) {
            return Some(());
        }
        let (label, help) = match step {
            0 => ("the step is 0".to_string(), "write another number after BY; without BY the loop counts by 1"),
            _ => (
                format!("after {end} the variable of type {} begins again at its other end", ty.name()),
                "use a longer type for its variable",
            ),
        };
        self.refuse(Code::EndlessLoop, span, "this loop cannot end", &label, help);
        None
    }
}

/// The text of a statement in messages: the first line of compound ones.
fn head(tree: &Tree) -> Span {
    const REPEAT: u32 = 6;
    let end = match &tree.kind {
        TreeKind::If { branches, .. } => branches.first().map(|(condition, _)| condition.span.end),
        TreeKind::Case { selector, .. } => Some(selector.span.end),
        TreeKind::For { end, step, .. } => Some(step.as_ref().unwrap_or(end).span.end),
        TreeKind::While { condition, .. } => Some(condition.span.end),
        TreeKind::Repeat { .. } => Some((tree.span.start + REPEAT).min(tree.span.end)),
        TreeKind::Empty
        | TreeKind::Label(_)
        | TreeKind::Expression(_)
        | TreeKind::Assign { .. }
        | TreeKind::Exit
        | TreeKind::Continue
        | TreeKind::Return(_)
        | TreeKind::Goto(_)
        | TreeKind::Pragma(_)
        | TreeKind::Error => None,
    };
    Span { end: end.unwrap_or(tree.span.end), ..tree.span }
}

/// True of a call, alone or assigned, with an argument EN or ENO.
fn has_enable(tree: &Tree) -> bool {
    let (TreeKind::Expression(node) | TreeKind::Assign { value: node, .. }) = &tree.kind else { return false };
    let NodeKind::Call { arguments, .. } = &node.kind else { return false };
    let names = arguments.iter().filter_map(|argument| argument.name.as_ref());
    names.into_iter().any(|name| name.text.eq_ignore_ascii_case("EN") || name.text.eq_ignore_ascii_case("ENO"))
}

/// A statement that may leave the loop around it.
pub(in crate::bind) fn leaves(statement: &Statement) -> bool {
    match &statement.kind {
        StatementKind::Exit | StatementKind::Return(_) | StatementKind::Goto(_) => true,
        // EXIT leaves the inner loop only.
        StatementKind::For { body, .. } | StatementKind::While { body, .. } | StatementKind::Repeat { body, .. } => {
            body.iter().any(|inner| !matches!(inner.kind, StatementKind::Exit) && leaves(inner))
        }
        other => other.bodies().into_iter().flatten().any(leaves),
    }
}

/// The placeholder of a call in a template.
fn hole(ctx: &SclBlock, callee: &Node) -> Option<Vec<Statement>> {
    match &callee.kind {
        NodeKind::Name(name) => ctx.scope.holes.get(name.text.as_str()).cloned(),
        _ => None,
    }
}

/// The variable that a lone expression begins with, and the `=` after it: `x = a AND b`.
fn compared_first(node: &Node) -> Option<(&Node, Span)> {
    let mut current = node;
    while let NodeKind::Binary { op, left, op_span, .. } = &current.kind {
        if *op == Operator::Equal && is_variable(left) {
            return (left.span.start == node.span.start).then_some((&**left, *op_span));
        }
        current = left;
    }
    None
}
