//! Divisions of whole numbers in SCL that become a REAL: `r := i / j` has lost its fraction before it is converted.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{BinaryOp, Conversion, Expr, ExprKind, Statement, UnaryOp, walk};
use plcc_syntax::article::with_article;

/// Reports the divisions of a block. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    walk::statements(list, &mut Divisions { text, explicit: false, found });
}

struct Divisions<'r> {
    text: &'r dyn Fn(Span) -> String,
    /// The statement has a function of conversion, which says what is meant.
    explicit: bool,
    found: &'r mut Vec<Diagnostic>,
}

impl Divisions<'_> {
    /// The division with `/` in a calculation with whole numbers.
    fn division<'e>(&self, value: &'e Expr) -> Option<(&'e Expr, &'e Expr, &'e Expr)> {
        match &value.kind {
            ExprKind::Binary { op: BinaryOp::Divide, left, right } => {
                let sign = (self.text)(Span { end: right.span.start, start: left.span.end, ..value.span });
                sign.contains('/').then_some((value, &**left, &**right))
            }
            ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply, left, right } => {
                self.division(left).or_else(|| self.division(right))
            }
            ExprKind::Unary { op: UnaryOp::Negate, operand } => self.division(operand),
            _ => None,
        }
    }
}

impl walk::Visitor for Divisions<'_> {
    fn statement(&mut self, statement: &Statement) {
        self.explicit = (self.text)(statement.span).to_ascii_uppercase().contains("TO_");
    }

    fn expr(&mut self, value: &Expr) {
        let ExprKind::Convert { conversion: Conversion::Value(_), operand } = &value.kind else { return };
        if self.explicit || !value.ty.is_float() || !operand.ty.is_integer() {
            return;
        }
        let Some((division, left, right)) = self.division(operand) else { return };
        let (dividend, divisor) = ((self.text)(left.span), (self.text)(right.span));
        let fraction = match divisor.bytes().all(|byte| byte.is_ascii_digit()) {
            true => format!("{dividend} / {divisor}.0"),
            false => format!("{}_TO_{}({dividend}) / {divisor}", left.ty.name(), value.ty.name()),
        };
        self.found.push(
            Diagnostic::new(Code::WholeDivision, division.span, "this division has no fraction")
                .label(format!(
                    "both sides are whole numbers; the result becomes {} later",
                    with_article(value.ty.name())
                ))
                .help(format!("write `{fraction}`, or `{dividend} DIV {divisor}` if the whole number is meant")),
        );
    }
}
