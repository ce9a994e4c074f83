//! The engine's SCL with its placeholders: parts that a chart does not need are removed before binding.

use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Literal, Statement, StatementKind, UnaryOp};
use plcc_syntax::scl::fragment;

use crate::bind::trees::SYSTEM_FILE;

/// The engine.
pub const ENGINE: &str = include_str!("engine.scl");
/// The short way of a call with one active step.
pub const ALONE: &str = include_str!("alone.scl");
/// The quick way.
pub const QUICK: &str = include_str!("quick.scl");
/// The end of a call.
pub const FINISH: &str = include_str!("finish.scl");
/// Monitoring of a step.
pub const MONITOR: &str = include_str!("monitor.scl");

/// The meaning of a name in a template.
pub enum Meaning {
    /// A variable, or a placeholder.
    Kept,
    /// A feature, or a parameter that the block does not have: it reads as this value.
    Bool(bool),
    /// A parameter of another type that the block does not have, or a number of the chart.
    Number(u64),
}

/// The statements of a template.
pub fn parse(text: &str) -> Vec<Statement> {
    let (statements, messages) = fragment::statements(SYSTEM_FILE, text, 0..text.len(), false);
    debug_assert!(messages.is_empty(), "{messages:?}");
    statements
}

/// Removes code that can never run, and assignments to variables that the block does not have.
pub fn prune(statements: Vec<Statement>, meaning: &dyn Fn(&str) -> Meaning) -> Vec<Statement> {
    let mut kept = Vec::new();
    for mut statement in statements {
        match statement.kind {
            StatementKind::Assign { targets, value } => {
                let absent = targets.iter().any(|(target, _)| !is_kept(target, meaning));
                if absent {
                    continue;
                }
                statement.kind = StatementKind::Assign { targets, value: substituted(value, meaning) };
            }
            StatementKind::If { branches, otherwise } => match pruned_if(branches, otherwise, meaning) {
                Pruned::Statements(inner) => {
                    kept.extend(inner);
                    continue;
                }
                Pruned::Kind(kind) => statement.kind = *kind,
            },
            StatementKind::For { variable, start, end, step, body } => {
                let end = substituted(end, meaning);
                statement.kind = StatementKind::For { variable, start, end, step, body: prune(body, meaning) };
            }
            StatementKind::While { condition, body } => {
                let condition = substituted(condition, meaning);
                statement.kind = StatementKind::While { condition, body: prune(body, meaning) };
            }
            kind => statement.kind = kind,
        }
        kept.push(statement);
    }
    kept
}

enum Pruned {
    Statements(Vec<Statement>),
    Kind(Box<StatementKind>),
}

fn pruned_if(
    branches: Vec<(Expr, Vec<Statement>)>,
    otherwise: Vec<Statement>,
    meaning: &dyn Fn(&str) -> Meaning,
) -> Pruned {
    let mut kept = Vec::new();
    for (condition, body) in branches {
        let condition = substituted(condition, meaning);
        match truth(&condition) {
            Some(false) => {}
            Some(true) => {
                let body = prune(body, meaning);
                return match kept.is_empty() {
                    true => Pruned::Statements(body),
                    false => Pruned::Kind(Box::new(StatementKind::If { branches: kept, otherwise: body })),
                };
            }
            None => kept.push((condition, prune(body, meaning))),
        }
    }
    let otherwise = prune(otherwise, meaning);
    match kept.is_empty() {
        true => Pruned::Statements(otherwise),
        false => Pruned::Kind(Box::new(StatementKind::If { branches: kept, otherwise })),
    }
}

/// Whether a variable exists: the first name of `#G7S[#k].X`.
fn is_kept(target: &Expr, meaning: &dyn Fn(&str) -> Meaning) -> bool {
    match &target.kind {
        ExprKind::Name(name) => matches!(meaning(&name.text), Meaning::Kept),
        ExprKind::Member { base, .. } | ExprKind::Index { base, .. } => is_kept(base, meaning),
        _ => true,
    }
}

/// The expression with constants in place of missing variables; AND, OR and NOT of constants are computed.
fn substituted(mut value: Expr, meaning: &dyn Fn(&str) -> Meaning) -> Expr {
    value.kind = match value.kind {
        ExprKind::Name(name) => match meaning(&name.text) {
            Meaning::Kept => ExprKind::Name(name),
            Meaning::Bool(value) => bool_literal(value),
            Meaning::Number(value) => ExprKind::Literal(Literal::Integer { value, based: false }),
        },
        ExprKind::Unary { op, operand } => {
            let operand = Box::new(substituted(*operand, meaning));
            match (op, truth(&operand)) {
                (UnaryOp::Not, Some(value)) => bool_literal(!value),
                _ => ExprKind::Unary { op, operand },
            }
        }
        ExprKind::Binary { op, left, right, op_span } => {
            let (left, right) = (substituted(*left, meaning), substituted(*right, meaning));
            match (op, truth(&left), truth(&right)) {
                (BinaryOp::And, Some(false), _) | (BinaryOp::And, _, Some(false)) => bool_literal(false),
                (BinaryOp::Or, Some(true), _) | (BinaryOp::Or, _, Some(true)) => bool_literal(true),
                (BinaryOp::And, Some(true), _) | (BinaryOp::Or, Some(false), _) => return right,
                (BinaryOp::And, _, Some(true)) | (BinaryOp::Or, _, Some(false)) => return left,
                _ => ExprKind::Binary { op, left: Box::new(left), right: Box::new(right), op_span },
            }
        }
        kind => kind,
    };
    value
}

fn bool_literal(value: bool) -> ExprKind {
    ExprKind::Literal(Literal::Typed { ty: Elementary::Bool, bits: u64::from(value) })
}

fn truth(value: &Expr) -> Option<bool> {
    match value.kind {
        ExprKind::Literal(Literal::Typed { ty: Elementary::Bool, bits }) => Some(bits != 0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meaning(name: &str) -> Meaning {
        match name {
            "yes" => Meaning::Bool(true),
            "no" | "absent" => Meaning::Bool(false),
            _ => Meaning::Kept,
        }
    }

    #[test]
    fn what_cannot_run_is_left_out() {
        let text =
            "IF yes THEN #a := #b AND NOT #absent; END_IF; IF no THEN #c := 1; ELSIF #d THEN #absent := #e; END_IF;";
        let pruned = prune(parse(text), &meaning);
        let [first, second] = pruned.as_slice() else { panic!("{pruned:?}") };
        let StatementKind::Assign { value, .. } = &first.kind else { panic!("{first:?}") };
        assert!(matches!(&value.kind, ExprKind::Name(name) if name.text == "b"), "{value:?}");
        let StatementKind::If { branches, .. } = &second.kind else { panic!("{second:?}") };
        assert!(branches.len() == 1 && branches[0].1.is_empty(), "{branches:?}");
    }

    #[test]
    fn the_templates_can_be_read() {
        assert!(!parse(ENGINE).is_empty());
        assert!(!parse(ALONE).is_empty());
        assert!(!parse(QUICK).is_empty());
        assert!(!parse(MONITOR).is_empty());
    }
}
