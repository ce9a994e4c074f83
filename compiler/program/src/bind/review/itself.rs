//! Comparisons in SCL of a variable with itself. Of a REAL they tell whether it is a number, so they do not count.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::Place;
use plcc_model::scl::{Base, CompareOp, Expr, ExprKind, Statement, walk};

use super::region::{Bits, Region};
use super::same::comparable;

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
        let same = variable(left).is_some_and(|bits| variable(right) == Some(bits));
        if !same || left.ty != right.ty || left.ty.is_float() {
            return;
        }
        // Instructions that are several statements have comparisons of their own.
        let sign = (self.text)(Span { start: left.span.end, end: right.span.start, ..value.span });
        if !["=", "<>", "<", "<=", ">", ">="].contains(&sign.trim()) {
            return;
        }
        let always = match op {
            CompareOp::Equal | CompareOp::LessEqual | CompareOp::GreaterEqual => "TRUE",
            CompareOp::NotEqual | CompareOp::Less | CompareOp::Greater => "FALSE",
        };
        let name = (self.text)(left.span);
        // `v[FIRST] = v[LAST]`: the constants may have other values in the next version.
        let written = |text: String| comparable(text).replace('#', "");
        if written(name.clone()) != written((self.text)(right.span)) {
            return;
        }
        self.found.push(
            Diagnostic::new(Code::AlwaysSame, value.span, format!("`{name}` is compared with itself"))
                .label(format!("always {always}"))
                .help("compare it with the value that is meant"),
        );
    }
}

/// The place of a variable that has the same value the second time.
fn variable(value: &Expr) -> Option<Bits> {
    let ExprKind::Load(access) = &value.kind else { return None };
    let bits = Bits::of(access)?;
    let is_element = matches!(access.base, Base::Place(Place::Element { .. }));
    let is_fixed = access.indices.is_empty() && access.part.is_none() && !is_element;
    (is_fixed && !matches!(bits.region, Region::PeripheralInput | Region::PeripheralOutput)).then_some(bits)
}
