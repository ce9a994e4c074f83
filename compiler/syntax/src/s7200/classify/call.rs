//! Operands of `CALL` in forms of other languages.

use plcc_diag::{Code, Diagnostic};

use super::Classifier;
use super::operand::block;
use crate::s7200::raw::{RawKind, RawToken};
use crate::s7200::token::Tok;

impl Classifier<'_, '_> {
    /// `CALL Init:Fill`, `CALL Init(VW0)`, `CALL SBR 0`; reads the operands of the first two as meant.
    pub(super) fn foreign_call(&mut self, tokens: &[RawToken]) -> bool {
        let [name, second, rest @ ..] = tokens else { return false };
        let called = self.slice(name.range());
        let sign = second.text(self.text);
        if second.kind == RawKind::Integer && ["SBR", "SUB"].iter().any(|word| word.eq_ignore_ascii_case(called)) {
            let range = name.range().start..second.range().end;
            let title = format!("`{}` has a blank before its number", self.slice(range.clone()));
            self.report(
                Diagnostic::new(Code::Syntax, self.span(range.clone()), title)
                    .label("two words")
                    .help(format!("write `CALL SBR{sign}`")),
            );
            self.push(range, Tok::BadOperand);
            self.operands(rest);
            return true;
        }
        if let (RawKind::Colon, Some((number, rest))) = (second.kind, rest.split_first())
            && block(&self.slice(number.range()).to_ascii_uppercase()).is_none()
        {
            let span = self.span(second.range().start..number.range().end);
            self.report(
                Diagnostic::new(Code::Syntax, span, "a call names the subroutine once")
                    .label("belongs to the header of the subroutine")
                    .help(format!("write `CALL {called}`")),
            );
            self.operands(&tokens[..1]);
            self.operands(rest);
            return true;
        }
        if self.named_parameters(tokens) {
            return true;
        }
        let close = rest.iter().rposition(|token| token.text(self.text) == ")");
        let Some((inner, after)) = close.filter(|_| sign == "(").map(|close| (&rest[..close], &rest[close + 1..]))
        else {
            return false;
        };
        let range = second.range().start..rest[inner.len()].range().end;
        let listed = match (inner.first(), inner.last()) {
            (Some(first), Some(last)) => format!(", {}", self.slice(first.range().start..last.range().end)),
            _ => String::new(),
        };
        self.report(
            Diagnostic::new(Code::ForeignForm, self.span(range), "the S7-200 calls without parentheses")
                .label("a form of other languages")
                .help(format!("write `CALL {called}{listed}`")),
        );
        self.operands(&tokens[..1]);
        if !inner.is_empty() {
            self.push(second.range(), Tok::Comma);
            self.operands(inner);
        }
        self.operands(after);
        true
    }

    /// `CALL Scale, raw := VW0, out := VW2`: parameters with names, which are not read.
    fn named_parameters(&mut self, tokens: &[RawToken]) -> bool {
        let is_assign = |token: &&RawToken| token.kind == RawKind::Assign;
        let (Some(sign), [first, .., last]) = (tokens.iter().find(is_assign), tokens) else { return false };
        let mut parts = vec![String::new()];
        for (at, token) in tokens.iter().enumerate() {
            match self.slice(token.range()) {
                "," | "(" | ")" => parts.push(String::new()),
                ":=" => {}
                // The comma before the name may be missing.
                _ if tokens.get(at + 1).is_some_and(|next| next.kind == RawKind::Assign) => parts.push(String::new()),
                text => {
                    if let Some(part) = parts.last_mut() {
                        part.push_str(text);
                    }
                }
            }
        }
        parts.retain(|part| !part.is_empty());
        self.report(
            Diagnostic::new(
                Code::ForeignForm,
                self.span(sign.range()),
                "a call of the S7-200 has values without names",
            )
            .label("a form of other languages")
            .help(format!("write `CALL {}`, in the order of the declarations", parts.join(", "))),
        );
        self.push(first.range().start..last.range().end, Tok::BadOperand);
        true
    }
}
