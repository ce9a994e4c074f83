//! Comments of other languages, and ends of comments that do not begin.

use crate::scl::raw::{RawKind, RawToken};
use crate::scl::repair::Repair;

impl Repair<'_> {
    /// `# comment` at the beginning of a line.
    pub(super) fn comment_with_hash(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let blank =
            self.text.as_bytes().get(token.end as usize).is_some_and(|byte| matches!(byte, b' ' | b'\t' | b'#'));
        if !blank || !(token.first_on_line || self.last.is_some_and(|last| last.kind == RawKind::Semicolon)) {
            return false;
        }
        let mut after = at + 1;
        while self.beside(after).is_some() {
            after += 1;
        }
        let text = self.words(at, after - 1).trim_start_matches('#').trim().to_owned();
        let help = format!("write `// {text}`");
        self.report(at, at + 1, "a comment begins with `//`".to_owned(), "read as a comment", help);
        self.drop_tokens(at, after);
        self.statement = self.at;
        true
    }

    /// `/ comment` at the beginning of a line.
    pub(super) fn half_comment(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let begins = self.brackets.is_empty() && self.head.is_none() && at == self.statement;
        if !begins || !token.first_on_line {
            return false;
        }
        let mut after = at + 1;
        while self.beside(after).is_some() {
            after += 1;
        }
        let text = self.words(at, after - 1).trim_start_matches('/').trim().to_owned();
        let help = format!("write `// {text}`");
        self.report(at, at + 1, "a comment begins with `//`".to_owned(), "read as a comment", help);
        self.drop_tokens(at, after);
        self.statement = self.at;
        true
    }

    /// `*)` without a comment that it ends.
    pub(super) fn end_of_no_comment(&mut self) -> bool {
        let at = self.at;
        if self.kind(at + 1) != Some(RawKind::RightParen) || !self.adjacent(at) || !self.brackets.is_empty() {
            return false;
        }
        let help = "remove it, or write `(*` where the comment begins".to_owned();
        self.report(at, at + 2, "`*)` ends no comment".to_owned(), "no comment is open here", help);
        self.drop_tokens(at, at + 2);
        if at == self.statement {
            self.statement = self.at;
        }
        true
    }
}
