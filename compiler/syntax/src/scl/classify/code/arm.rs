//! Arms of CASE: where one begins.

use plcc_diag::{Code, Diagnostic, Span};

use super::super::Classifier;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// How many tokens the values of an arm of CASE may have.
const ARM_TOKENS_MAX: usize = 500;

impl Classifier<'_, '_> {
    /// Whether values and `:` follow rather than a statement.
    pub(super) fn arm_begins(&self) -> bool {
        let mut depth = 0usize;
        for (index, token) in self.raw[self.at..].iter().take(ARM_TOKENS_MAX).enumerate() {
            match token.kind {
                RawKind::Colon => return depth == 0,
                RawKind::LeftParen | RawKind::LeftBracket => depth += 1,
                RawKind::RightParen | RawKind::RightBracket => depth = depth.saturating_sub(1),
                RawKind::Semicolon => return false,
                kind if depth == 0 && kind.assigns() => return false,
                _ if index > 0 && token.keyword.is_some_and(Keyword::ends_expression) => return false,
                _ => {}
            }
        }
        false
    }

    /// Numbers alone on a line, from token `first` on: the values of an arm of CASE, without their `:`.
    pub(super) fn value_without_colon(&mut self, first: usize) -> bool {
        let values = self.raw.get(first..self.at).unwrap_or_default();
        let (Some(&start), Some(&end)) = (values.first(), values.last()) else { return false };
        let is_value = |token: &RawToken| matches!(token.kind, RawKind::Number | RawKind::Minus | RawKind::DotDot);
        let alone = self.peek().is_some_and(|next| next.first_on_line && next.kind != RawKind::Semicolon);
        if !alone || end.kind != RawKind::Number || !values.iter().all(is_value) {
            return false;
        }
        let text = self.head_text(start, end);
        let span = Span { file: self.file, start: start.start, end: end.end };
        self.report(
            Diagnostic::new(Code::Syntax, span, format!("`:` is missing after `{text}`"))
                .label("a value of this CASE")
                .help(format!("write `{text}:`")),
        );
        true
    }
}
