//! Variables in SCL that are assigned again before anything reads what they were assigned first.
//!
//! Only two assignments in one list of statements count, and only if everything between them is an assignment too. A constant may be
//! a value to begin with, and a call is made for its effects, so the first assignment is neither.

use std::collections::BTreeMap;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Access, Call, Expr, ExprKind, Statement, StatementKind, walk};

use super::region::{Bits, Region};

/// Longest elementary value, in bits.
const VALUE_BITS: u64 = 64;

/// Reports what `list` and the lists inside it assign for nothing. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    let mut pending = Pending::default();
    for statement in list {
        let StatementKind::Assign { target, value } = &statement.kind else {
            pending.values.clear();
            for body in statement.kind.bodies() {
                review(body, text, found);
            }
            continue;
        };
        let has_call = pending.read(target, value);
        let bits = Bits::of(target)
            .filter(|bits| target.indices.is_empty() && !matches!(bits.region, Region::PeripheralOutput));
        match bits {
            Some(bits) if target.part.is_none() => {
                let first = pending.values.remove(&(bits.region, bits.first));
                if let Some((_, first)) = first.filter(|(end, first)| *end == bits.end && *first != statement.span) {
                    found.push(overwritten(target, first, statement.span, text));
                }
                pending.forget(bits);
                if !has_call && !matches!(value.kind, ExprKind::Const(_)) {
                    pending.values.insert((bits.region, bits.first), (bits.end, statement.span));
                }
            }
            // An element or a part: the rest keeps its value.
            Some(bits) => pending.forget(bits),
            None => pending.values.clear(),
        }
    }
}

fn overwritten(target: &Access, first: Span, second: Span, text: &dyn Fn(Span) -> String) -> Diagnostic {
    let text = text(target.span);
    Diagnostic::new(Code::DoubleCoil, second, format!("`{text}` is assigned twice; the second assignment wins"))
        .label("assigned again")
        .also(first, "nothing reads what this assigns")
        .help("remove one of them, or look whether one should assign another variable")
}

/// Assignments that nothing has read so far: by region and first bit, with the end and the statement.
#[derive(Default)]
struct Pending {
    values: BTreeMap<(Region, u64), (u64, Span)>,
    has_call: bool,
}

impl Pending {
    /// What an assignment reads; true if it calls something.
    fn read(&mut self, target: &Access, value: &Expr) -> bool {
        self.has_call = false;
        walk::expr(value, self);
        target.indices.iter().for_each(|index| walk::expr(&index.value, self));
        if self.has_call {
            self.values.clear();
        }
        self.has_call
    }

    fn forget(&mut self, bits: Bits) {
        let from = bits.first.saturating_sub(VALUE_BITS - 1);
        let near = self.values.range((bits.region, from)..(bits.region, bits.end));
        let touched: Vec<_> = near.filter(|(_, (end, _))| *end > bits.first).map(|(key, _)| *key).collect();
        touched.iter().for_each(|key| {
            self.values.remove(key);
        });
    }
}

impl walk::Visitor for Pending {
    fn access(&mut self, access: &Access, _role: walk::Role) {
        match Bits::of(access) {
            Some(bits) => self.forget(bits),
            None => self.values.clear(),
        }
    }

    fn expr(&mut self, value: &Expr) {
        self.has_call |= matches!(value.kind, ExprKind::Call(_) | ExprKind::Timer(_) | ExprKind::Counter(_));
    }

    fn call(&mut self, _call: &Call) {
        self.has_call = true;
    }
}
