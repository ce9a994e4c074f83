//! Signs of drawings in a rung, `& %I0.1`, `>=1( in2 := #b )`, `=( #q )`, and wires with a blank or without `wire#`: each is reported
//! once.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, is_word};
use crate::sd::token::Tok;
use plcc_syntax::scl::raw::{RawKind, RawToken};

impl<'a> Classifier<'a, '_> {
    /// The name of the current wire that is written with a blank, `wire #w1`.
    pub(super) fn spaced_wire(&self) -> Option<&'a str> {
        let next = self.raw.get(self.at + 1).filter(|next| next.kind == RawKind::Local && !next.first_on_line)?;
        let text: &'a str = self.text;
        self.is_word("wire").then(|| text[next.range()].trim_start_matches('#').trim_matches('"'))
    }

    /// Reports a wire with a blank, and takes it.
    pub(super) fn take_spaced_wire(&mut self, token: RawToken, name: &'a str) {
        self.report(
            Diagnostic::new(Code::Syntax, self.span(token), "the name of a wire follows without a blank")
                .label("a blank comes after this")
                .help(format!("write `wire#{name}`")),
        );
        self.take_wire(Tok::Wire(name));
    }

    /// The current word after `END_RUNG`, if another rung near it has a wire of this name.
    pub(super) fn bare_wire(&self) -> Option<&'a str> {
        const LOOK_MAX: usize = 500;
        let token = self.raw.get(self.at).filter(|token| !token.first_on_line)?;
        let text: &'a str = self.text;
        let name = text[token.range()].trim_start_matches('#');
        let is_wire = |at: usize| {
            let wire = is_word(text, self.raw, at, "wire") && self.kind_at(at + 1) == Some(RawKind::Local);
            wire && text[self.raw[at + 1].range()].trim_start_matches('#').eq_ignore_ascii_case(name)
        };
        let is_name = matches!(token.kind, RawKind::Word | RawKind::Local);
        let near = self.at.saturating_sub(LOOK_MAX)..self.raw.len().min(self.at + LOOK_MAX);
        (is_name && near.into_iter().any(is_wire)).then_some(name)
    }

    /// Reports a wire without `wire#`, and takes it.
    pub(super) fn take_bare_wire(&mut self, name: &'a str) {
        if let Some(token) = self.raw.get(self.at).copied() {
            self.report(
                Diagnostic::new(Code::Syntax, self.span(token), format!("`wire#` is missing before `{name}`"))
                    .label("the name of a wire")
                    .help(format!("write `END_RUNG wire#{name}`")),
            );
            self.take(Tok::Wire(name));
        }
    }

    /// A sign of a box or of an assignment, with what belongs to it: reported and skipped.
    pub(super) fn sign_of_drawing(&mut self, token: RawToken) -> bool {
        let is_or = self.raw.get(self.at + 1).is_some_and(|next| &self.text[next.range()] == "1");
        let (first, element) = match token.kind {
            RawKind::Ampersand => (self.at + 1, "A"),
            RawKind::GreaterEqual if is_or => (self.at + 2, "O"),
            RawKind::Equal => (self.at + 1, "Coil"),
            _ => return false,
        };
        let Some((inner, after)) = self.operands(first) else { return false };
        let named = inner.contains(":=") || element == "Coil";
        let help = match named {
            true => format!("write `{element}( {inner} )`"),
            false => format!("write `{element}( in2 := {inner} )`"),
        };
        let title = format!("the sign `{}` is an element of its own", &self.text[token.range()]);
        self.report(Diagnostic::new(Code::ForeignForm, self.span(token), title).label("a form of drawings").help(help));
        self.take_up_to(Tok::Stray, after);
        true
    }

    /// What is in the parentheses at index `first`, or the operand there, and the index after it.
    fn operands(&self, first: usize) -> Option<(&'a str, usize)> {
        let text: &'a str = self.text;
        let opening = self.raw.get(first)?;
        if opening.kind != RawKind::LeftParen {
            let is_operand = matches!(opening.kind, RawKind::Local | RawKind::Quoted | RawKind::Absolute);
            return is_operand.then(|| (&text[opening.range()], first + 1));
        }
        let mut depth = 0usize;
        let mut rest = (first..self.raw.len()).take_while(|index| !is_word(text, self.raw, *index, "END_RUNG"));
        let close = rest.find(|index| {
            match self.raw[*index].kind {
                RawKind::LeftParen => depth += 1,
                RawKind::RightParen => depth = depth.saturating_sub(1),
                _ => {}
            }
            depth == 0
        })?;
        let inner = text.get(opening.end as usize..self.raw[close].start as usize)?;
        Some((inner.trim(), close + 1))
    }
}
