//! Words of other languages that leave a branch, a loop or a block: `break;`, `EXIT FOR;`, `EXIT IF c;`, `exit(1);`, `NEXT i;`.

use super::words::alias;
use super::{Repair, closer};
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

impl Repair<'_> {
    /// `BREAK;` leaves a loop as EXIT does. It means nothing at the end of a branch of CASE, and where no loop is open.
    pub(super) fn break_word(&mut self, word: &str) -> bool {
        let at = self.at;
        let has_end = self.kind(at + 1) == Some(RawKind::Semicolon);
        let closed = self.keyword(at + 1).is_some_and(Keyword::ends_expression);
        // A block may have this name.
        let alone = has_end || closed || self.beside(at + 1).is_none();
        if alias(word) != Some(Keyword::Exit) || !alone {
            return false;
        }
        let is_left = |keyword: &Keyword| *keyword == Keyword::Case || is_loop(*keyword);
        let inner = self.open.iter().rev().map(|open| open.keyword).find(is_left);
        let after = if has_end { at + 2 } else { at + 1 };
        let statement = self.words(at, after - 1);
        let (title, label, help) = match inner {
            Some(Keyword::Case) => (
                "a branch of CASE ends before the next value".to_owned(),
                "a form of other languages",
                format!("remove `{statement}`"),
            ),
            Some(_) => return self.take_keyword(Keyword::Exit),
            None => (
                format!("`{word}` is outside of a loop"),
                "there is no loop around it",
                format!("remove `{statement}`, or write `RETURN;` to leave the block"),
            ),
        };
        self.report(at, at + 1, title, label, help);
        // The branch may have no other statement.
        self.replace(at, after, RawKind::Semicolon, None);
        true
    }

    /// `EXIT FOR;`, `EXIT IF i > 5;`, `exit(1);`, `NEXT i;`
    pub(super) fn leaving(&mut self, token: RawToken) -> bool {
        token.kind == RawKind::Word
            && self.starts(token)
            && (self.named_loop(token)
                || self.leaving_if(token)
                || self.exit_with_value(token)
                || self.next_with_variable(token))
    }

    /// `EXIT IF i > 5;`, `EXIT WHEN i > 5;`, and the same with CONTINUE and RETURN.
    fn leaving_if(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let leaves = [Keyword::Exit, Keyword::Continue, Keyword::Return];
        let word = self.slice(token);
        let meant = token.keyword.or_else(|| alias(word)).filter(|keyword| leaves.contains(keyword));
        let Some(keyword) = meant else { return false };
        let asks = self.beside(at + 1).is_some_and(|next| {
            next.keyword == Some(Keyword::If) || next.keyword.is_none() && self.slice(next).eq_ignore_ascii_case("WHEN")
        });
        if !asks {
            return false;
        }
        let end = self.end_of_statement(at + 2);
        if self.kind(end) != Some(RawKind::Semicolon) || end == at + 2 {
            return false;
        }
        let condition = self.words(at + 2, end - 1);
        let help = format!("write `IF {condition} THEN {}; END_IF;`", keyword.word());
        self.report(at, end, format!("{word} has no condition"), "a form of other languages", help);
        self.replace(at, end, RawKind::Reported, None);
        true
    }

    /// `EXIT FOR;`
    fn named_loop(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let named = self.keyword(at + 1).is_some_and(|word| is_loop(word) || word == Keyword::Do);
        if token.keyword != Some(Keyword::Exit) || !named || self.kind(at + 2) != Some(RawKind::Semicolon) {
            return false;
        }
        let title = "EXIT leaves the loop around it, without its name".to_owned();
        self.report(at, at + 2, title, "a form of other languages", "write `EXIT;`".to_owned());
        self.replace(at, at + 2, RawKind::Word, Some(Keyword::Exit));
        true
    }

    /// `exit(1);`
    fn exit_with_value(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.keyword != Some(Keyword::Exit) || self.kind(at + 1) != Some(RawKind::LeftParen) {
            return false;
        }
        let end = self.end_of_statement(at + 1);
        let Some(close) = self.closing(at + 1).filter(|close| *close < end) else { return false };
        let inside = self.open.iter().any(|open| is_loop(open.keyword));
        let meant = if inside { Keyword::Exit } else { Keyword::Return };
        let help = format!("write `{};`", meant.word());
        self.report(at, close + 1, "EXIT has no value".to_owned(), "a form of other languages", help);
        self.replace(at, close + 1, RawKind::Word, Some(meant));
        true
    }

    /// `NEXT i;` at the end of FOR.
    fn next_with_variable(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token);
        let variable = self
            .beside(at + 1)
            .filter(|next| matches!(next.kind, RawKind::Word | RawKind::Local) && next.keyword.is_none());
        let ends = self.kind(at + 2) == Some(RawKind::Semicolon) || self.beside(at + 2).is_none();
        let Some(open) = self.open.last().filter(|_| variable.is_some() && ends) else { return false };
        let end = closer(open.keyword);
        if token.keyword.is_some() || alias(word) != Some(end) || self.is_declared(word) {
            return false;
        }
        self.misspelt(at, at + 2, end);
        self.replace(at, at + 2, RawKind::Word, Some(end));
        true
    }
}

fn is_loop(keyword: Keyword) -> bool {
    matches!(keyword, Keyword::For | Keyword::While | Keyword::Repeat)
}
