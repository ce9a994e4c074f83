//! Divisions of whole numbers in SCL that become a REAL, or are multiplied: `r := i / j` has lost its fraction before it is converted.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{BinaryOp, Conversion, Expr, ExprKind, Statement, UnaryOp, walk};
use plcc_syntax::Elementary;
use plcc_syntax::article::with_article;
use rustc_hash::FxHashSet;

use super::same::comparable;

/// Reports the divisions of a block. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    let mut remainders = Remainders { text, found: FxHashSet::default() };
    walk::statements(list, &mut remainders);
    let remainders = remainders.found;
    walk::statements(list, &mut Divisions { text, remainders, statement: None, found });
}

/// Looks for the dividends and divisors of MOD.
struct Remainders<'r> {
    text: &'r dyn Fn(Span) -> String,
    found: FxHashSet<(String, String)>,
}

impl walk::Visitor for Remainders<'_> {
    fn expr(&mut self, value: &Expr) {
        if let ExprKind::Binary { op: BinaryOp::Modulo, left, right } = &value.kind {
            self.found.insert((comparable((self.text)(left.span)), comparable((self.text)(right.span))));
        }
    }
}

struct Divisions<'r> {
    text: &'r dyn Fn(Span) -> String,
    /// The dividends and divisors whose remainder the block computes as well.
    remainders: FxHashSet<(String, String)>,
    /// The statement that is looked at.
    statement: Option<Span>,
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

    /// Looks at a constant that is calculated from whole numbers, as `1/3`.
    fn constant(&mut self, value: &Expr) {
        let text = (self.text)(value.span);
        let begin = value.span.range().start;
        let is_digit = |sign: char| sign.is_ascii_digit() || sign == '_';
        let calculates = |sign: char| is_digit(sign) || sign.is_ascii_whitespace() || "+-*/()".contains(sign);
        if !text.chars().all(calculates) {
            return;
        }
        for (at, _) in text.match_indices('/') {
            let (left, right) = (text[..at].trim_end(), text[at + 1..].trim_start());
            let start = left.trim_end_matches(is_digit).len();
            let divisor = &right[..right.len() - right.trim_start_matches(is_digit).len()];
            let (before, dividend) = left.split_at(start);
            // Of `2 * 100 / 3` the dividend is 200.
            let is_part = before.trim_end().ends_with(['*', '/']);
            let number = |digits: &str| digits.replace('_', "").parse::<u64>().ok();
            let (Some(a), Some(b)) = (number(dividend), number(divisor)) else { continue };
            if is_part || a.checked_rem(b).is_none_or(|rest| rest == 0) {
                continue;
            }
            let end = text.len() - right.len() + divisor.len();
            // `text` has one blank in the place of several.
            let division = match text.len() == value.span.range().len() {
                true => Span::new(value.span.file, begin + start..begin + end),
                false => value.span,
            };
            let fraction = format!("{dividend} / {divisor}.0");
            if !self.is_explicit() {
                self.report(division, value.ty, &fraction, &format!("{dividend} DIV {divisor}"));
            }
            return;
        }
    }

    /// Whether the statement has a function of conversion, which says what is meant.
    fn is_explicit(&self) -> bool {
        self.statement.is_some_and(|span| (self.text)(span).to_ascii_uppercase().contains("TO_"))
    }

    /// A quotient of whole numbers that is multiplied: `i / j * 100` is 0 for each `i` below `j`. With a constant divisor, the same number as
    /// divisor and factor, or `i MOD j` in the block, the fraction is mostly meant to go.
    fn multiplied(&mut self, left: &Expr, right: &Expr) {
        let divided = |value: &Expr| matches!(value.kind, ExprKind::Binary { op: BinaryOp::Divide, .. });
        let (quotient, factor) = if divided(left) { (left, right) } else { (right, left) };
        let ExprKind::Binary { op: BinaryOp::Divide, left: dividend, right: divisor } = &quotient.kind else { return };
        let sign = Span { end: divisor.span.start, start: dividend.span.end, ..quotient.span };
        let (dividend, by, factor) = ((self.text)(dividend.span), (self.text)(divisor.span), (self.text)(factor.span));
        let is_told = self.found.last().is_some_and(|last| last.primary.span == quotient.span);
        let has_remainder = !self.remainders.is_empty()
            && self.remainders.contains(&(comparable(dividend.clone()), comparable(by.clone())));
        let is_meant = matches!(divisor.kind, ExprKind::Const(_)) || by == factor || !(self.text)(sign).contains('/');
        if is_told || is_meant || has_remainder {
            return;
        }
        self.found.push(
            Diagnostic::new(Code::WholeDivision, quotient.span, "this division has no fraction")
                .label("both sides are whole numbers; only the whole part is multiplied")
                .help(format!("multiply first, as in `{dividend} * {factor} / {by}`, or write DIV if that is meant")),
        );
    }

    /// `fraction`, `whole`: how the author writes a division with a fraction, and one without.
    fn report(&mut self, division: Span, ty: Elementary, fraction: &str, whole: &str) {
        self.found.push(
            Diagnostic::new(Code::WholeDivision, division, "this division has no fraction")
                .label(format!("both sides are whole numbers; the result becomes {} later", with_article(ty.name())))
                .help(format!("write `{fraction}`, or `{whole}` if the whole number is meant")),
        );
    }
}

impl walk::Visitor for Divisions<'_> {
    fn statement(&mut self, statement: &Statement) {
        self.statement = Some(statement.span);
    }

    fn expr(&mut self, value: &Expr) {
        if let ExprKind::Binary { op: BinaryOp::Multiply, left, right } = &value.kind
            && value.ty.is_integer()
        {
            self.multiplied(left, right);
        }
        if !value.ty.is_float() {
            return;
        }
        let operand = match &value.kind {
            ExprKind::Convert { conversion: Conversion::Value(_), operand } if operand.ty.is_integer() => operand,
            ExprKind::Const(_) => return self.constant(value),
            _ => return,
        };
        let Some((division, left, right)) = self.division(operand) else { return };
        if self.is_explicit() {
            return;
        }
        let (dividend, divisor) = ((self.text)(left.span), (self.text)(right.span));
        let fraction = match divisor.bytes().all(|byte| byte.is_ascii_digit()) {
            true => format!("{dividend} / {divisor}.0"),
            false => format!("{}_TO_{}({dividend}) / {divisor}", left.ty.name(), value.ty.name()),
        };
        self.report(division.span, value.ty, &fraction, &format!("{dividend} DIV {divisor}"));
    }
}
