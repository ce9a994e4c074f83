//! What stands around blocks in other languages and in software units: `NAMESPACE`, `USING`.

use super::Repair;
use crate::scl::raw::{RawKind, RawToken};

impl Repair<'_> {
    /// What stands around a block, or in its place.
    pub(super) fn around_blocks(&mut self, token: RawToken) -> bool {
        let outside = !self.statements_begun && token.first_on_line && self.brackets.is_empty();
        outside && (self.name_space(token) || self.enumeration(token))
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
}
