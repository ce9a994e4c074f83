//! Actions of a call in the ordinary modes, in which ZERO_OP is off: `Q0.0 := TRUE` instead of `Q0.0 := NOT MOP.OPS_ZERO`.
//!
//! The short way has tested the mode. So the test of each row goes, as long as nothing that runs before it can change the mode.

use plcc_diag::Span;
use plcc_syntax::Elementary;

use super::assemble::Assembly;
use super::build::number;
use crate::bind::network::and;
use plcc_model::Place;
use plcc_model::scl::{Base, BinaryOp, Expr, ExprKind, Statement, StatementKind, UnaryOp};

impl Assembly<'_, '_> {
    /// Actions of an active step, where the short way has tested the modes.
    pub fn ordinary_actions(&self, step: usize) -> Vec<Statement> {
        let active = &self.parts.codes[step].active;
        match self.engine.zeroed(self.engine.span).as_ref().and_then(place) {
            Some(zeroed) if self.features.tame_actions => not_zeroed(active, zeroed),
            _ => active.clone(),
        }
    }
}

/// Statements where the bit at `zeroed` is FALSE. They are assignments and IF; others stay as they are.
fn not_zeroed(list: &[Statement], zeroed: &Place) -> Vec<Statement> {
    let one = |statement: &Statement| {
        let kind = match &statement.kind {
            StatementKind::Assign { target, value } => {
                StatementKind::Assign { target: target.clone(), value: value_of(value, zeroed) }
            }
            StatementKind::If { branches, otherwise } => {
                let branch = |(condition, body): &(Expr, Vec<Statement>)| {
                    (value_of(condition, zeroed), not_zeroed(body, zeroed))
                };
                let branches = branches.iter().map(branch).collect();
                StatementKind::If { branches, otherwise: not_zeroed(otherwise, zeroed) }
            }
            kind => kind.clone(),
        };
        Statement { kind, span: statement.span }
    };
    list.iter().map(one).collect()
}

/// The value where the bit at `zeroed` is FALSE; only conditions of rows read it, as `… AND NOT bit`.
fn value_of(value: &Expr, zeroed: &Place) -> Expr {
    match &value.kind {
        ExprKind::Unary { op: UnaryOp::Not, operand } if is_bit(operand, zeroed) => yes(value.span),
        ExprKind::Binary { op: BinaryOp::And, left, right } if value.ty == Elementary::Bool => {
            and(value_of(left, zeroed), value_of(right, zeroed), value.span)
        }
        _ => value.clone(),
    }
}

fn is_bit(value: &Expr, zeroed: &Place) -> bool {
    value.ty == Elementary::Bool && place(value) == Some(zeroed)
}

/// The place that a value is read from, if it is known.
fn place(value: &Expr) -> Option<&Place> {
    let ExprKind::Load(access) = &value.kind else { return None };
    match &access.base {
        Base::Place(place) if access.indices.is_empty() && access.part.is_none() => Some(place),
        Base::Place(_) | Base::Indexed { .. } => None,
    }
}

fn yes(span: Span) -> Expr {
    number(1, Elementary::Bool, span)
}
