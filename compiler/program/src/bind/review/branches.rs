//! Branches of IF in SCL that never run, as an earlier condition is TRUE whenever theirs is: `IF a THEN … ELSIF a AND b THEN …`.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::Place;
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Base, BinaryOp, Expr, ExprKind, Statement, StatementKind};
use plcc_syntax::Elementary;
use rustc_hash::FxHashMap;

use super::same::{comparable, is_more_than_variables};

/// Reports the branches of a block. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    walk::statements(list, &mut Branches { text, found });
}

struct Branches<'r> {
    text: &'r dyn Fn(Span) -> String,
    found: &'r mut Vec<Diagnostic>,
}

impl Branches<'_> {
    /// The conditions that AND joins in `value`, each once. Empty: one of them is a constant, or cannot be compared with others.
    fn joined(&self, value: &Expr) -> Vec<String> {
        let mut list = Vec::new();
        if !self.collect(value, &mut list) {
            list.clear();
        }
        list.sort();
        list.dedup();
        list
    }

    fn collect(&self, value: &Expr, list: &mut Vec<String>) -> bool {
        match &value.kind {
            ExprKind::Binary { op: BinaryOp::And, left, right } if value.ty == Elementary::Bool => {
                self.collect(left, list) && self.collect(right, list)
            }
            ExprKind::Const(_) => false,
            _ => {
                let text = (self.text)(value.span);
                // It has one blank in the place of several, also inside of quotes.
                let is_exact = text.len() == value.span.range().len() || !text.contains(['\'', '"']);
                list.push(comparable(text));
                is_exact
            }
        }
    }
}

impl Visitor for Branches<'_> {
    fn statement(&mut self, statement: &Statement) {
        let StatementKind::If { branches, .. } = &statement.kind else { return };
        if branches.len() < 2 {
            return;
        }
        // What is FALSE where the next condition is evaluated, by the first of the conditions that AND joins in it.
        let mut earlier: FxHashMap<String, Vec<(Vec<String>, Span)>> = FxHashMap::default();
        for (condition, _) in branches {
            if may_differ(condition) {
                earlier.clear();
                continue;
            }
            let joined = self.joined(condition);
            let is_covered = |whole: &Vec<String>| whole.iter().all(|one| joined.binary_search(one).is_ok());
            let mut candidates = joined.iter().filter_map(|one| earlier.get(one)).flatten();
            if let Some((_, first)) = candidates.find(|(whole, _)| is_covered(whole)) {
                self.found.push(
                    Diagnostic::new(Code::UnreachableCode, condition.span, "this branch is never reached")
                        .label("an earlier condition is TRUE whenever this one is")
                        .also(*first, "the branch that runs")
                        .help("remove one of the two, or write the condition that is meant"),
                );
            } else if let Some(first) = joined.first() {
                earlier.entry(first.clone()).or_default().push((joined.clone(), condition.span));
            }
        }
    }
}

/// Whether a condition may have another value the next time, or change a variable.
pub(super) fn may_differ(condition: &Expr) -> bool {
    let mut looked = Differs(false);
    walk::expr(condition, &mut looked);
    looked.0
}

struct Differs(bool);

impl Visitor for Differs {
    fn expr(&mut self, value: &Expr) {
        self.0 |= is_more_than_variables(value);
    }

    fn access(&mut self, access: &Access, _role: Role) {
        self.0 |= match &access.base {
            // Peripheral inputs are read each time.
            Base::Place(place) => {
                matches!(place, Place::Pi { .. } | Place::Pq { .. } | Place::Indirect { .. } | Place::Register { .. })
            }
            Base::Indexed { .. } => true,
        };
    }
}
