//! Conditions in SCL that have a part twice, or a part and its opposite: `a OR b OR a`, `a AND NOT a`.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{BinaryOp, Expr, ExprKind, Statement, StatementKind, UnaryOp, walk};
use plcc_syntax::Elementary;
use rustc_hash::{FxHashMap, FxHashSet};

use super::branches::may_differ;
use super::same::{calls_block, comparable_names};

/// Reports the conditions of a block. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    walk::statements(list, &mut Conditions { text, collected: FxHashSet::default(), assigned: None, found });
}

struct Conditions<'r> {
    text: &'r dyn Fn(Span) -> String,
    /// Where the parts of conditions begin and end that were looked at with the whole.
    collected: FxHashSet<(u32, u32)>,
    /// Where the value begins and ends that the current statement assigns.
    assigned: Option<(u32, u32)>,
    found: &'r mut Vec<Diagnostic>,
}

impl Conditions<'_> {
    /// The parts that `op` joins in `value`.
    fn collect<'v>(&mut self, value: &'v Expr, op: BinaryOp, parts: &mut Vec<&'v Expr>) {
        match &value.kind {
            ExprKind::Binary { op: inner, left, right } if *inner == op => {
                self.collected.insert((value.span.start, value.span.end));
                self.collect(left, op, parts);
                self.collect(right, op, parts);
            }
            _ => parts.push(value),
        }
    }

    fn told(&self, op: BinaryOp, first: (Span, bool), second: (Span, bool)) -> Diagnostic {
        if first.1 == second.1 {
            let title = format!("`{}` is there twice in this condition", (self.text)(second.0));
            return Diagnostic::new(Code::NoEffect, second.0, title)
                .label("changes nothing")
                .also(first.0, "the first time")
                .help("write the other condition that is meant, or remove this one");
        }
        let always = if op == BinaryOp::And { "FALSE" } else { "TRUE" };
        Diagnostic::new(Code::AlwaysSame, second.0, format!("this condition is always {always}"))
            .label("the opposite of another part")
            .also(first.0, "the other part")
            .help("write the condition that is meant")
    }
}

impl walk::Visitor for Conditions<'_> {
    fn statement(&mut self, statement: &Statement) {
        self.assigned = match &statement.kind {
            StatementKind::Assign { value, .. } => Some((value.span.start, value.span.end)),
            _ => None,
        };
    }

    fn expr(&mut self, value: &Expr) {
        let ExprKind::Binary { op: op @ (BinaryOp::And | BinaryOp::Or), .. } = value.kind else { return };
        let span = value.span;
        if value.ty != Elementary::Bool || self.collected.contains(&(span.start, span.end)) {
            return;
        }
        let mut parts = Vec::new();
        self.collect(value, op, &mut parts);
        // `always := a OR NOT a` makes a bit that is always TRUE, as usual in STL and LAD.
        let makes_constant = parts.len() == 2 && self.assigned == Some((span.start, span.end));
        // By what is written: the place, and whether NOT is before it.
        let mut seen: FxHashMap<String, (Span, bool)> = FxHashMap::default();
        for part in parts {
            // It may change what the parts before it look at.
            if calls_block(part) {
                seen.clear();
                continue;
            }
            let (inner, negated) = match &part.kind {
                ExprKind::Unary { op: UnaryOp::Not, operand } => (&**operand, true),
                _ => (part, false),
            };
            let written = comparable_names((self.text)(inner.span));
            if written.is_empty() || matches!(inner.kind, ExprKind::Const(_)) || may_differ(inner) {
                continue;
            }
            let own = (part.span, negated);
            match seen.get(&written) {
                // What one instruction computes in several steps is written once.
                Some(first) if first.0.file == part.span.file && first.0.end <= part.span.start => {
                    if first.1 == negated || !makes_constant {
                        let message = self.told(op, *first, own);
                        self.found.push(message);
                    }
                    return;
                }
                Some(_) => {}
                None => {
                    seen.insert(written, own);
                }
            }
        }
    }
}
