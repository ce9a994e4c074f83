//! Numbers in a form that the S7-200 does not have.

use plcc_diag::{Code, Diagnostic};

use super::Classifier;
use super::operand::Where;
use crate::s7200::raw::{RawKind, RawToken};
use crate::s7200::token::Tok;

impl Classifier<'_, '_> {
    /// `.5`, `5.`: a number with digits on one side of its point only, which is reported; false: the tokens do not begin with one.
    pub fn bare_point(&mut self, tokens: &[RawToken]) -> bool {
        let [first, second, rest @ ..] = tokens else { return false };
        let (before, after) = (first.text(self.text), second.text(self.text));
        let is_number = matches!(second.kind, RawKind::Integer | RawKind::Real) && !after.contains('.');
        let (written, side) = match (before, after) {
            (".", digits) if is_number => (format!("0.{digits}"), "before"),
            (digits, ".") if first.kind == RawKind::Integer => (format!("{digits}.0"), "after"),
            _ => return false,
        };
        // `1..3` is not a number.
        let goes_on = rest.first().is_some_and(|next| {
            let is_part = matches!(next.kind, RawKind::Integer | RawKind::Real | RawKind::Word | RawKind::Stray);
            is_part && next.range().start == second.range().end
        });
        // Nor is the end of `1.5.2`.
        let before = first.range().start.checked_sub(1).and_then(|at| self.text.as_bytes().get(at));
        let has_begun = before.is_some_and(|before| before.is_ascii_alphanumeric() || *before == b'.');
        let is_alone = !has_begun && !goes_on;
        if self.place == Where::Declaration || first.range().end != second.range().start || !is_alone {
            return false;
        }
        let range = first.range().start..second.range().end;
        let (span, text) = (self.span(range.clone()), self.slice(range.clone()));
        self.report(
            Diagnostic::new(Code::BadLiteral, span, format!("`{text}` is not a constant of the S7-200"))
                .label(format!("a REAL has digits {side} its point, too"))
                .help(format!("write `{written}`")),
        );
        self.push(range, Tok::BadOperand);
        true
    }
}
