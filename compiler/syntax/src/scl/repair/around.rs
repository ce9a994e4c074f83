//! What stands around blocks in other languages and in software units: `NAMESPACE`, `USING`, data types that are lists of values.

use super::Repair;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Values of a list that a message repeats.
const SHOWN: usize = 2;

impl Repair<'_> {
    /// What stands around a block, or in its place.
    pub(super) fn around_blocks(&mut self, token: RawToken) -> bool {
        let outside = !self.statements_begun && token.first_on_line && self.brackets.is_empty();
        outside && (self.name_space(token) || self.choice_by_name(token))
    }

    /// `NAMESPACE Plant.Line … END_NAMESPACE`, `USING Plant.Line;`
    fn name_space(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token).to_ascii_uppercase();
        let begins = match word.as_str() {
            "NAMESPACE" | "USING" => true,
            "END_NAMESPACE" if self.name_spaces > 0 => false,
            _ => return false,
        };
        if self.is_declared(&word) {
            return false;
        }
        let mut after = at + 1;
        if begins {
            let is_name =
                |next: RawToken| matches!(next.kind, RawKind::Word | RawKind::Quoted) && next.keyword.is_none();
            if !self.beside(after).is_some_and(is_name) {
                return false;
            }
            while self.beside(after).is_some_and(|next| is_name(next) || next.kind == RawKind::Dot) {
                after += 1;
            }
            let name = self.words(at + 1, after - 1).to_owned();
            let help = match word.as_str() {
                "USING" => "remove it: each block is called by its own name".to_owned(),
                _ => format!("remove it and END_NAMESPACE; a call has the name of the block alone, without `{name}.`"),
            };
            self.report(at, after, "plcc has no namespaces".to_owned(), "all blocks are in one program", help);
        }
        match word.as_str() {
            "NAMESPACE" => self.name_spaces += 1,
            "USING" => {}
            _ => self.name_spaces -= 1,
        }
        let ends = self.beside(after).is_some_and(|next| next.kind == RawKind::Semicolon);
        self.drop_tokens(at, if ends { after + 1 } else { after });
        self.statement = self.at;
        true
    }

    /// `TYPE State : INT (Idle := 0, Run := 1); END_TYPE`
    fn choice_by_name(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.keyword != Some(Keyword::Type) {
            return false;
        }
        let is_name = |kind| matches!(kind, Some(RawKind::Word | RawKind::Quoted));
        let (name, colon) = (at + 1, at + 2);
        if !is_name(self.kind(name)) || self.kind(colon) != Some(RawKind::Colon) {
            return false;
        }
        // `TYPE State : (Idle, Run);` is read as INT with its header.
        if self.kind(colon + 1) != Some(RawKind::Word) || self.keyword(colon + 1).is_some() {
            return false;
        }
        let open = colon + 2;
        if self.kind(open) != Some(RawKind::LeftParen) || !is_name(self.kind(open + 1)) {
            return false;
        }
        let is_limit = |token: &RawToken| token.keyword.is_some_and(|word| word.begins_block() || word.ends_block());
        let end = self.tokens[open..].iter().position(is_limit).map(|found| open + found);
        let Some(end) = end.filter(|end| self.keyword(*end) == Some(Keyword::EndType)) else { return false };
        let ty = self.words(colon + 1, colon + 1).to_owned();
        let names = (open + 1..end).filter(|&index| {
            is_name(self.kind(index)) && matches!(self.kind(index - 1), Some(RawKind::LeftParen | RawKind::Comma))
        });
        let constants: Vec<String> = names
            .take(SHOWN)
            .zip(0..)
            .map(|(index, number)| {
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
        let title = "a data type cannot be a list of values".to_owned();
        self.report(name, open, title, "a form of other languages", help);
        self.drop_tokens(at, end + 1);
        self.statement = self.at;
        true
    }
}
