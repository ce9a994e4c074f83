//! NOT before a comparison of bit strings or integers in SCL: `NOT w = 16#1` compares the complement of `w`, as NOT comes first.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{CompareOp, Expr, ExprKind, Statement, UnaryOp, walk};

/// Reports the comparisons of a block. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    walk::statements(list, &mut Comparisons { text, found });
}

struct Comparisons<'r> {
    text: &'r dyn Fn(Span) -> String,
    found: &'r mut Vec<Diagnostic>,
}

impl walk::Visitor for Comparisons<'_> {
    fn expr(&mut self, value: &Expr) {
        let ExprKind::Compare { op, left, right } = &value.kind else { return };
        let sign = match op {
            CompareOp::Equal => "=",
            CompareOp::NotEqual => "<>",
            CompareOp::Less => "<",
            CompareOp::LessEqual => "<=",
            CompareOp::Greater => ">",
            CompareOp::GreaterEqual => ">=",
        };
        let mut negation = &**left;
        while let ExprKind::Convert { operand, .. } = &negation.kind {
            negation = operand;
        }
        // Of a BOOL both are the same.
        let ExprKind::Unary { op: UnaryOp::Not, operand } = &negation.kind else { return };
        if operand.ty.bits() == 1 {
            return;
        }
        let written = |start: u32, end: u32| (self.text)(Span { start, end, ..value.span });
        // In brackets it is meant.
        let begins = written(negation.span.start, negation.span.end)
            .get(..3)
            .is_some_and(|word| word.eq_ignore_ascii_case("NOT"));
        if !begins || written(negation.span.end, right.span.start).contains(')') {
            return;
        }
        let (bits, other) = ((self.text)(operand.span), (self.text)(right.span));
        let whole = Span { start: negation.span.start, end: right.span.end, ..value.span };
        self.found.push(
            Diagnostic::new(Code::NegatedSide, whole, "NOT comes before the comparison")
                .label(format!("compares the complement of `{bits}`"))
                .help(format!(
                    "write `NOT ({bits} {sign} {other})`, or `(NOT {bits}) {sign} {other}` if the complement is meant"
                )),
        );
    }
}
