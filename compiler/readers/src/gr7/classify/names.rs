//! Names of steps and transitions, which have no blanks and no `-`: a name that is written with some is reported once, at its
//! definition, and read as it is written where it is used.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, is_name};
use crate::gr7::lexer::{RawKind, RawToken};
use crate::gr7::pragma::{self, Tag};
use crate::gr7::token::Tok;

impl<'a> Classifier<'a, '_> {
    /// Takes the name of a step or transition; `what`: which of them is defined here.
    pub(super) fn defined_name(&mut self, token: RawToken, what: &str) {
        let parts = self.parts_after_name();
        let text: &'a str = self.text;
        let name = match self.raw.get(self.at + parts) {
            Some(last) if parts > 0 => &text[token.start as usize..last.end as usize],
            _ => return self.step_name(token),
        };
        let span = self.span(token).to(self.span(self.raw[self.at + parts]));
        let parts_of_name = name.split(|c: char| c.is_whitespace() || c == '-').filter(|part| !part.is_empty());
        let joined = parts_of_name.collect::<Vec<_>>().join("_");
        let sign = if name.contains('-') { "no `-`" } else { "no blanks" };
        self.report(
            Diagnostic::new(Code::Syntax, span, format!("the name of a {what} has {sign}"))
                .label("one name is expected here")
                .help(format!("write `{joined}`, here and where it is used")),
        );
        self.spaced.push(name);
        self.take_spaced(token, name, parts);
    }

    /// How many tokens after the name at the current token belong to it: `Tank 1 (*$_NUM 2*)`, `Tank-1:`.
    fn parts_after_name(&self) -> usize {
        let is_part = |index: &usize| {
            let clause = self.is_word(*index, "FROM") || self.is_word(*index, "TO");
            let joins = |kind| is_name(kind) || kind == RawKind::Minus;
            let next = self.raw.get(*index).filter(|next| joins(next.kind) && !next.first_on_line);
            next.is_some() && !clause && self.keyword_at(*index).is_none()
        };
        let parts = (self.at + 1..self.raw.len()).take_while(is_part).count();
        let ends_head = self.raw.get(self.at + 1 + parts).is_some_and(|after| {
            let is_number = after.kind == RawKind::Pragma && pragma::tag(self.slice(*after)) == Some(Tag::Number);
            !after.first_on_line && (is_number || after.kind == RawKind::Colon)
        });
        if ends_head { parts } else { 0 }
    }

    /// Takes the name of a step in a list.
    pub(super) fn used_name(&mut self, token: RawToken) {
        let text: &'a str = self.text;
        let start = token.start as usize;
        let parts = |name: &str| {
            let end = start + name.len();
            let count = self.raw[self.at..].iter().take_while(|next| (next.start as usize) < end).count();
            let last = self.raw.get(self.at + count.checked_sub(1)?)?;
            (text[start..].starts_with(name) && last.end as usize == end).then_some(count - 1)
        };
        match self.spaced.iter().find_map(|name| Some((*name, parts(name)?))) {
            Some((name, parts)) => self.take_spaced(token, name, parts),
            None => self.step_name(token),
        }
    }

    fn take_spaced(&mut self, first: RawToken, name: &'a str, parts: usize) {
        let start = first.start as usize;
        self.push(start, Tok::Word(name), start + name.len());
        self.at += parts + 1;
    }
}
