//! Enumerated types of other languages, `TYPE "Mode" : USInt (Off := 0, Auto := 2);`. The uses of their values are not reported again.

use std::collections::HashSet;

use super::Repair;
use crate::Elementary;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Values of a list that a message repeats.
const SHOWN: usize = 2;

/// Enumerated types that the text has had so far: names in upper case, without quotes.
#[derive(Default)]
pub(super) struct Enumerations {
    types: HashSet<String>,
    values: HashSet<String>,
}

impl Repair<'_> {
    /// `TYPE State : INT (Idle := 0, Run := 1); END_TYPE`, and `TYPE State : (Idle, Run);`, which the classifier reports.
    pub(super) fn enumeration(&mut self, token: RawToken) -> bool {
        let (name, colon, ty) = (self.at + 1, self.at + 2, self.at + 3);
        let is_head =
            token.keyword == Some(Keyword::Type) && self.is_name(name) && self.kind(colon) == Some(RawKind::Colon);
        if !is_head {
            return false;
        }
        let is_type = |word: RawToken| {
            Elementary::from_word(&self.slice(word).to_ascii_uppercase()).is_some_and(|ty| !ty.is_float())
        };
        let typed = self.token(ty).is_some_and(|word| word.kind == RawKind::Word && is_type(word));
        let open = if typed { ty + 1 } else { ty };
        if self.kind(open) != Some(RawKind::LeftParen) || !self.is_name(open + 1) {
            return false;
        }
        let Some(close) = self.closing(open) else { return false };
        let begins = |index: &usize| {
            self.is_name(*index) && matches!(self.kind(index - 1), Some(RawKind::LeftParen | RawKind::Comma))
        };
        let values: Vec<usize> = (open + 1..close).filter(begins).collect();
        if typed {
            self.report_enumeration(name, open, &values);
        }
        let name = self.upper_name(name);
        self.enumerations.types.insert(name);
        for value in values {
            let value = self.upper_name(value);
            self.enumerations.values.insert(value);
        }
        if typed {
            while self.at < open {
                let token = self.tokens[self.at];
                self.pass(token);
            }
            // The start value, `(…) := Idle;`.
            let ends =
                |next: RawToken| next.kind == RawKind::Semicolon || next.keyword.is_some_and(Keyword::ends_block);
            let mut after = close + 1;
            while self.beside(after).is_some_and(|next| !ends(next)) {
                after += 1;
            }
            self.drop_tokens(open, after);
        }
        typed
    }

    /// The list of values before which an elementary type stands; the values are at these places.
    fn report_enumeration(&mut self, name: usize, open: usize, values: &[usize]) {
        let ty = self.words(open - 1, open - 1);
        let constants: Vec<String> = values
            .iter()
            .take(SHOWN)
            .zip(0..)
            .map(|(&index, number)| {
                let value = match (self.kind(index + 1), self.kind(index + 2)) {
                    (Some(RawKind::Assign), Some(RawKind::Number)) => self.words(index + 2, index + 2).to_owned(),
                    _ => format!("{number}"),
                };
                format!("{} : {ty} := {value};", self.words(index, index).trim_matches('"'))
            })
            .collect();
        let help = format!(
            "declare variables of type {ty}, and the values in VAR CONSTANT of the block, `{}`, or as user constants of a tag table",
            constants.join(" ")
        );
        let label = format!("read as {ty}");
        self.report(name, open, "a data type cannot be a list of values".to_owned(), &label, help);
    }

    /// The use of a value of a type that was reported: `Mode#Off`, `"Mode".Off`, `Off`.
    pub(super) fn enumerated_value(&mut self, token: RawToken) -> bool {
        if self.enumerations.values.is_empty() {
            return false;
        }
        let Some(after) = self.end_of_enumerated_value(token) else { return false };
        self.replace(self.at, after, RawKind::Reported, None);
        true
    }

    /// The same as a start value, `mode : Mode := Off;`.
    pub(super) fn enumerated_start(&mut self, token: RawToken) -> bool {
        let is_value = !self.brackets.is_empty() || self.last.is_some_and(|last| last.kind == RawKind::Assign);
        is_value && self.enumerated_value(token)
    }

    /// Index after the value that begins at the walk's token, if it is one.
    fn end_of_enumerated_value(&self, token: RawToken) -> Option<usize> {
        let at = self.at;
        let name = self.upper_name(at);
        if !self.is_name(at) || self.last.is_some_and(|last| last.kind == RawKind::Dot) {
            return None;
        }
        // A variable often has the name of its type.
        if self.enumerations.types.contains(&name) {
            let value = match self.kind(at + 1) {
                Some(RawKind::Local) if self.adjacent(at) => at + 1,
                Some(RawKind::Dot) => at + 2,
                _ => return None,
            };
            return self.enumerations.values.contains(&self.upper_name(value)).then_some(value + 1);
        }
        let other = matches!(
            self.kind(at + 1),
            Some(RawKind::Assign | RawKind::Arrow | RawKind::Dot | RawKind::LeftParen | RawKind::LeftBracket)
        );
        let alone = token.kind == RawKind::Word && !other && !self.is_declared(&name);
        (alone && self.enumerations.values.contains(&name)).then_some(at + 1)
    }

    fn is_name(&self, index: usize) -> bool {
        let token = self.token(index).filter(|token| token.keyword.is_none());
        token.is_some_and(|token| matches!(token.kind, RawKind::Word | RawKind::Quoted))
    }

    /// The name at `index` in upper case, without its signs.
    fn upper_name(&self, index: usize) -> String {
        super::sections::plain(self.words(index, index))
    }
}
