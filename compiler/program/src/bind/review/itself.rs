//! Variables in SCL that meet themselves, `a = a`, `w AND w`, `a - a` and `a := a`, and products with 0.
//!
//! A REAL is compared with itself to find out whether it is a number, and its difference from itself is none if it is infinite, so REALs
//! count in assignments only.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::Place;
use plcc_model::scl::{Access, Base, BinaryOp, CompareOp, Expr, ExprKind, Statement, StatementKind, walk};

use super::region::{Bits, Region};
use super::same::comparable_names;

/// Reports them in a block. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    walk::statements(list, &mut Pairs { text, found });
}

struct Pairs<'r> {
    text: &'r dyn Fn(Span) -> String,
    found: &'r mut Vec<Diagnostic>,
}

impl walk::Visitor for Pairs<'_> {
    fn statement(&mut self, statement: &Statement) {
        let StatementKind::Assign { target, value } = &statement.kind else { return };
        let ExprKind::Load(source) = &value.kind else { return };
        if place(target).is_none_or(|bits| place(source) != Some(bits))
            || self.sign(target.span, source.span) != ":="
            || !self.are_written_alike(target.span, source.span)
        {
            return;
        }
        let name = (self.text)(target.span);
        self.found.push(
            Diagnostic::new(Code::NoEffect, statement.span, format!("`{name}` is assigned to itself"))
                .label("changes nothing")
                .help("assign the value that is meant, or remove the statement"),
        );
    }

    fn expr(&mut self, value: &Expr) {
        match &value.kind {
            ExprKind::Compare { op, left, right } => self.comparison(*op, left, right, value.span),
            ExprKind::Binary { op: BinaryOp::Multiply, left, right } => self.product(left, right, value),
            ExprKind::Binary { op, left, right } => self.operation(*op, left, right, value.span),
            _ => {}
        }
    }
}

impl Pairs<'_> {
    fn comparison(&mut self, op: CompareOp, left: &Expr, right: &Expr, span: Span) {
        // Instructions that are several statements have comparisons of their own.
        let signs = ["=", "<>", "<", "<=", ">", ">="];
        if !self.are_one_variable(left, right) || !signs.contains(&self.sign(left.span, right.span).as_str()) {
            return;
        }
        let always = match op {
            CompareOp::Equal | CompareOp::LessEqual | CompareOp::GreaterEqual => "TRUE",
            CompareOp::NotEqual | CompareOp::Less | CompareOp::Greater => "FALSE",
        };
        let name = (self.text)(left.span);
        self.found.push(
            Diagnostic::new(Code::AlwaysSame, span, format!("`{name}` is compared with itself"))
                .label(format!("always {always}"))
                .help("compare it with the value that is meant"),
        );
    }

    fn operation(&mut self, op: BinaryOp, left: &Expr, right: &Expr, span: Span) {
        let (signs, is_one): (&[&str], bool) = match op {
            // Conditions have a review of their own.
            BinaryOp::And | BinaryOp::Or if left.ty.bits() == 1 => return,
            BinaryOp::And => (&["AND", "&"], true),
            BinaryOp::Or => (&["OR"], true),
            BinaryOp::Xor => (&["XOR"], false),
            BinaryOp::Subtract if left.ty.is_integer() => (&["-"], false),
            _ => return,
        };
        let sign = self.sign(left.span, right.span).to_uppercase();
        if !self.are_one_variable(left, right) || !signs.contains(&sign.as_str()) {
            return;
        }
        let name = (self.text)(left.span);
        let zero = if left.ty.bits() == 1 { "FALSE" } else { "0" };
        let (code, label) = match is_one {
            true => (Code::NoEffect, format!("the same as `{name}` alone")),
            false => (Code::AlwaysSame, format!("always {zero}")),
        };
        let title = format!("both sides of `{sign}` are `{name}`");
        self.found.push(Diagnostic::new(code, span, title).label(label).help("write the other value that is meant"));
    }

    /// `i * 0` of whole numbers.
    fn product(&mut self, left: &Expr, right: &Expr, value: &Expr) {
        let is_zero = |side: &Expr| {
            // A named constant may have another value in the next version.
            matches!(side.kind, ExprKind::Const(0)) && (self.text)(side.span).trim() == "0"
        };
        if !value.ty.is_integer() || is_zero(left) == is_zero(right) || self.sign(left.span, right.span) != "*" {
            return;
        }
        let title = format!("`{}` is always 0", (self.text)(value.span));
        self.found.push(
            Diagnostic::new(Code::AlwaysSame, value.span, title)
                .label("a product with 0")
                .help("write the factor that is meant"),
        );
    }

    /// Whether two values are one variable that has the same value the second time.
    fn are_one_variable(&self, left: &Expr, right: &Expr) -> bool {
        let bits = |value: &Expr| match &value.kind {
            ExprKind::Load(access) => place(access),
            _ => None,
        };
        bits(left).is_some_and(|one| bits(right) == Some(one))
            && left.ty == right.ty
            && !left.ty.is_float()
            && self.are_written_alike(left.span, right.span)
    }

    /// Of `v[FIRST]` and `v[LAST]` the constants may have other values in the next version.
    fn are_written_alike(&self, left: Span, right: Span) -> bool {
        let written = |span| comparable_names((self.text)(span));
        written(left) == written(right)
    }

    /// What is written between two values.
    fn sign(&self, left: Span, right: Span) -> String {
        (self.text)(Span { start: left.end, end: right.start.max(left.end), ..left }).trim().to_owned()
    }
}

/// The place of a variable that has the same value the second time.
fn place(access: &Access) -> Option<Bits> {
    let bits = Bits::of(access)?;
    let is_element = matches!(access.base, Base::Place(Place::Element { .. }));
    let is_fixed = access.indices.is_empty() && access.part.is_none() && !is_element;
    (is_fixed && !matches!(bits.region, Region::PeripheralInput | Region::PeripheralOutput)).then_some(bits)
}
