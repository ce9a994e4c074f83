//! Comparisons of one value in SCL that are joined the wrong way: every value fulfils `i <> 1 OR i <> 2`, none `i < 1 AND i > 5`.

use plcc_binding::constant::Constant;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{BinaryOp, CompareOp, Expr, ExprKind, Statement, walk};
use plcc_syntax::{Class, Elementary};
use rustc_hash::FxHashSet;

use super::same::calls_block;

/// Reports the conditions of a block. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    walk::statements(list, &mut Conditions { text, told: None, collected: FxHashSet::default(), found });
}

struct Conditions<'r> {
    text: &'r dyn Fn(Span) -> String,
    /// The condition that was reported last; its parts are joined in the same way.
    told: Option<Span>,
    /// Where the parts of conditions begin and end that were looked at with the whole.
    collected: FxHashSet<(u32, u32)>,
    found: &'r mut Vec<Diagnostic>,
}

/// A comparison with a whole number.
struct Comparison {
    /// What is compared, without blanks and in capitals.
    value: String,
    ty: Elementary,
    op: CompareOp,
    number: i128,
    span: Span,
}

impl Comparison {
    const fn holds(&self, value: i128) -> bool {
        match self.op {
            CompareOp::Equal => value == self.number,
            CompareOp::NotEqual => value != self.number,
            CompareOp::Less => value < self.number,
            CompareOp::LessEqual => value <= self.number,
            CompareOp::Greater => value > self.number,
            CompareOp::GreaterEqual => value >= self.number,
        }
    }

    /// Whether the two, joined by `op`, have one outcome for all values: it changes only at their numbers.
    fn has_one_outcome_with(&self, other: &Comparison, op: BinaryOp) -> bool {
        let mut values = [self.number, other.number].into_iter().flat_map(|number| [number - 1, number, number + 1]);
        match op {
            BinaryOp::Or => values.all(|value| self.holds(value) || other.holds(value)),
            _ => !values.any(|value| self.holds(value) && other.holds(value)),
        }
    }
}

impl Conditions<'_> {
    /// The comparisons that `op` joins in `value`. Those before a call, which may change what they compare, are not among them.
    fn collect(&mut self, value: &Expr, op: BinaryOp, list: &mut Vec<Comparison>) {
        match &value.kind {
            ExprKind::Binary { op: inner, left, right } if *inner == op => {
                self.collected.insert((value.span.start, value.span.end));
                self.collect(left, op, list);
                self.collect(right, op, list);
            }
            ExprKind::Compare { op, left, right } if !calls_block(value) => {
                list.extend(self.comparison(*op, left, right, value.span))
            }
            _ if calls_block(value) => list.clear(),
            _ => {}
        }
    }

    fn comparison(&self, op: CompareOp, left: &Expr, right: &Expr, span: Span) -> Option<Comparison> {
        let (op, value, bits) = match (&left.kind, &right.kind) {
            (_, ExprKind::Const(bits)) => (op, left, *bits),
            (ExprKind::Const(bits), _) => (op.turned(), right, *bits),
            _ => return None,
        };
        let ty = value.ty;
        let number = Constant::Typed { ty, bits }.integer()?;
        // The type alone decides it, which is reported where it is bound.
        if ty.class() == Class::Unsigned && number == 0 && matches!(op, CompareOp::Less | CompareOp::GreaterEqual) {
            return None;
        }
        let mut loaded = value;
        while let ExprKind::Convert { operand, .. } = &loaded.kind {
            loaded = operand;
        }
        if !matches!(loaded.kind, ExprKind::Load(_)) {
            return None;
        }
        let value: String = (self.text)(value.span).to_uppercase().split_whitespace().collect();
        Some(Comparison { value, ty, op, number, span })
    }

    fn written(&self, span: Span) -> String {
        (self.text)(span).split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

impl walk::Visitor for Conditions<'_> {
    fn expr(&mut self, value: &Expr) {
        let ExprKind::Binary { op: op @ (BinaryOp::And | BinaryOp::Or), .. } = value.kind else { return };
        let span = value.span;
        let is_told =
            self.told.is_some_and(|told| told.file == span.file && told.start <= span.start && span.end <= told.end);
        if value.ty != Elementary::Bool || is_told || self.collected.contains(&(span.start, span.end)) {
            return;
        }
        let mut list = Vec::new();
        self.collect(value, op, &mut list);
        let pair = list.iter().enumerate().find_map(|(at, second)| {
            let is_pair = |first: &&Comparison| {
                (first.ty, &first.value) == (second.ty, &second.value) && first.has_one_outcome_with(second, op)
            };
            Some((list[..at].iter().find(is_pair)?, second))
        });
        let Some((first, second)) = pair else { return };
        self.told = Some(span);
        let (one, other) = (self.written(first.span), self.written(second.span));
        let (sign, exchanged, meant) = match op {
            BinaryOp::Or => ("AND", BinaryOp::And, "both are to be fulfilled"),
            _ => ("OR", BinaryOp::Or, "one of them is enough"),
        };
        let help = match first.has_one_outcome_with(second, exchanged) {
            true => "compare with other values, or remove the condition".to_owned(),
            false => format!("write `{one} {sign} {other}` if {meant}"),
        };
        let (title, label) = match op {
            BinaryOp::Or => (
                format!("`{one} OR {other}` is always TRUE"),
                format!("TRUE for each value that does not fulfil `{one}`"),
            ),
            _ => (format!("`{one} AND {other}` is always FALSE"), format!("FALSE for each value that fulfils `{one}`")),
        };
        self.found.push(Diagnostic::new(Code::AlwaysSame, second.span, title).label(label).help(help));
    }
}
