//! EN and ENO of functions of the language, where the call is the whole statement or the whole right side of an assignment.
//!
//! Blocks have both by themselves; functions computed in place get them from the statements around them. Source: SCL reference, parameters, OK
//! and ENO.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::{
    Argument, Expr as Node, ExprKind as NodeKind, Statement as Tree, StatementKind as TreeKind,
};

use super::Intent;
use super::arguments::names_eno;
use super::expression::constant_expr;
use super::function::Named;
use super::memory::load;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::fold;
use plcc_model::layout;
use plcc_model::scl::{Access, Base, Expr, ExprKind, Statement, StatementKind, UnaryOp};

impl SclBinder<'_, '_> {
    /// Binds a statement whose function has EN or ENO; false: it has neither.
    pub(super) fn enabled_function(&mut self, ctx: &mut SclBlock, tree: &Tree, bound: &mut Vec<Statement>) -> bool {
        let mut plain = tree.clone();
        let call = match &mut plain.kind {
            TreeKind::Expression(node) | TreeKind::Assign { value: node, .. } => node,
            _ => return false,
        };
        let NodeKind::Call { callee, arguments } = &mut call.kind else { return false };
        if !self.computed_in_place(ctx, callee) {
            return false;
        }
        let (enable, result) = (taken(ctx, arguments, "en"), taken(ctx, arguments, "eno"));
        if enable.is_none() && result.is_none() {
            return false;
        }
        let span = ctx.block.fixed_span.unwrap_or(tree.span);
        let condition = enable.as_ref().map(|node| self.of_type(ctx, node, Elementary::Bool));
        let target = result.as_ref().map(|node| self.result_of_enable(ctx, node));
        let mut body = Vec::new();
        self.statement(ctx, &plain, &mut body);
        let (Some(condition), Some(target)) =
            (condition.map_or(Some(None), |bound| bound.map(Some)), target.map_or(Some(None), |bound| bound.map(Some)))
        else {
            return true;
        };
        if let Some(target) = &target {
            body = self.with_result(ctx, body, target, span);
        }
        match condition {
            Some(condition) => {
                let skipped = target.map(|target| assign(target, constant_expr(0, Elementary::Bool, span), span));
                let otherwise = skipped.into_iter().collect();
                bound
                    .push(Statement { kind: StatementKind::If { branches: vec![(condition, body)], otherwise }, span });
            }
            None => bound.append(&mut body),
        }
        true
    }

    /// True if a call means a function of the language, not something that the program defines.
    fn computed_in_place(&self, ctx: &SclBlock, callee: &Node) -> bool {
        match &callee.kind {
            NodeKind::Name(name) => {
                !self.is_instance(ctx, name)
                    && !self.program.globals.names.symbols.contains_key(&fold(&name.text))
                    && Named::find(&name.text).is_some()
            }
            _ => false,
        }
    }

    /// The variable after `ENO =>`.
    fn result_of_enable(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Access> {
        let target = self.access(ctx, node, Intent::Write)?;
        if target.elementary() == Some(Elementary::Bool) {
            return Some(target);
        }
        let is = format!("of type {}", layout::type_name(&target.ty));
        self.wrong_type(node.span, &is, "BOOL", None);
        None
    }

    /// Statements, followed by a test whether each of their operations was possible. A failure clears the bit of the block only if other
    /// operations of the block do.
    fn with_result(&mut self, ctx: &mut SclBlock, body: Vec<Statement>, target: &Access, span: Span) -> Vec<Statement> {
        let before = self.temp(ctx, Elementary::Bool, span);
        let after = self.temp(ctx, Elementary::Bool, span);
        let flag = || Expr { kind: ExprKind::Flag, ty: Elementary::Bool, span };
        let statement = |kind| Statement { kind, span };
        // Indices count as they are before the function, which may change them: `#i := LIMIT( … , ENO => #good[#i])`.
        let (mut indices, mut target) = (Vec::new(), target.clone());
        for index in &mut target.indices {
            index.value = self.kept(ctx, &mut indices, index.value.clone());
        }
        if let Base::Indexed { byte, bit, .. } = &mut target.base {
            for number in std::iter::once(byte).chain(bit) {
                **number = self.kept(ctx, &mut indices, (**number).clone());
            }
        }
        let mut code: Vec<Statement> = indices.into_iter().map(statement).collect();
        code.extend([
            assign(before.clone(), flag(), span),
            statement(StatementKind::SetFlag(constant_expr(1, Elementary::Bool, span))),
            statement(StatementKind::Watch(true)),
        ]);
        code.extend(body);
        code.push(statement(StatementKind::Watch(false)));
        code.push(assign(after.clone(), flag(), span));
        code.push(statement(StatementKind::SetFlag(load(&before, Elementary::Bool))));
        code.push(assign(target, load(&after, Elementary::Bool), span));
        let operand = Box::new(load(&after, Elementary::Bool));
        let failed = Expr { kind: ExprKind::Unary { op: UnaryOp::Not, operand }, ty: Elementary::Bool, span };
        let branches = vec![(failed, vec![statement(StatementKind::Failed)])];
        code.push(statement(StatementKind::If { branches, otherwise: Vec::new() }));
        code
    }
}

fn assign(target: Access, value: Expr, span: Span) -> Statement {
    Statement { kind: StatementKind::Assign { target, value }, span }
}

/// Takes the argument of this name out of a list; `ENO => ENO` has no effect.
fn taken(ctx: &SclBlock, arguments: &mut Vec<Argument>, name: &str) -> Option<Node> {
    let found = arguments.iter().position(|argument| {
        let named = argument.name.as_ref().is_some_and(|own| fold(&own.text) == name);
        named && argument.value.as_ref().is_some_and(|value| name == "en" || !names_eno(ctx, value))
    })?;
    arguments.remove(found).value
}
