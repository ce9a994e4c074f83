//! What a head lacks: `#a > 5 THEN` without IF, `#state OF` without CASE, and the operator in `IF #a #b THEN`.

use plcc_diag::{Code, Diagnostic};

use super::{Edit, Repair, begins_operand, ends_operand};
use crate::scl::address;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// A condition that is longer than this is not shown in a help.
const CONDITION_MAX: usize = 60;

impl Repair<'_> {
    /// `#a > 5 THEN` at the beginning of a line.
    pub(super) fn statement_without_keyword(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let begins = at == self.statement && token.first_on_line && self.head.is_none() && self.brackets.is_empty();
        let operand = token.kind == RawKind::LeftParen || begins_operand(token);
        if !begins || !operand || token.keyword.is_some_and(|word| word != Keyword::Not) {
            return false;
        }
        // Two words in a row: the first one may be meant as the keyword.
        if token.kind == RawKind::Word && token.keyword.is_none() && self.token(at + 1).is_some_and(begins_operand) {
            return false;
        }
        let Some(end) = self.end_of_head(at).filter(|end| *end > at) else { return false };
        if self.value_with_word(end) {
            return true;
        }
        let (keyword, what) = match self.keyword(end) {
            Some(Keyword::Then) => (Keyword::If, "condition"),
            Some(Keyword::Of) => (Keyword::Case, "value"),
            Some(Keyword::Do) => (Keyword::While, "condition"),
            _ => return false,
        };
        let head = self.words(at, end);
        let head = if head.len() > CONDITION_MAX { "…" } else { head };
        let word = keyword.word();
        let message =
            Diagnostic::new(Code::Syntax, self.span(at, end), format!("`{word}` is missing before its {what}"));
        self.messages.push(message.label(format!("the head of {word}")).help(format!("write `{word} {head}`")));
        let opening =
            RawToken { kind: RawKind::Word, start: token.start, end: token.start, keyword: Some(keyword), ..token };
        let with = vec![opening, RawToken { first_on_line: false, ..token }];
        self.edits.push(Edit { first: at, after: at + 1, with });
        self.note(opening);
        self.at = at + 1;
        self.note(token);
        true
    }

    /// `IF #a #b THEN`: what follows from the first of the values takes part in nothing.
    pub(super) fn operator_left_out(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let Some(head) = &self.head else { return false };
        let (statement, wanted) = (head.keyword, head.wanted);
        let two = self.last.is_some_and(ends_operand) && begins_operand(token) && !token.first_on_line;
        // A word may be meant as the operator; `FC 1` and `Mode#Off` are one operand.
        let is_word = token.kind == RawKind::Word && !self.is_declared(self.slice(token));
        let block = self.last.is_some_and(|last| address::block_prefix(self.slice(last)).is_some());
        if !two
            || is_word
            || block
            || at == 0
            || self.adjacent(at - 1)
            || !self.brackets.is_empty()
            || token.keyword.is_some()
            || statement == Keyword::For
            || wanted == Keyword::EndRepeat
        {
            return false;
        }
        let Some(end) = self.end_of_head(at).filter(|end| self.keyword(*end) == Some(wanted)) else { return false };
        // `n IN 1..5`
        let is_in = |word: &RawToken| self.slice(*word).eq_ignore_ascii_case("IN") && !self.is_declared("IN");
        if at > 1 && self.kind(at + 1) == Some(RawKind::DotDot) && self.tokens.get(at - 1).is_some_and(is_in) {
            let first = self.operand_start(at - 1);
            // `a + n IN 1..5` is about a sum.
            let calculates = |before: usize| {
                matches!(self.kind(before), Some(RawKind::Plus | RawKind::Minus | RawKind::Star | RawKind::Slash))
                    || matches!(self.keyword(before), Some(Keyword::Mod | Keyword::Div))
            };
            let value = if first.checked_sub(1).is_some_and(calculates) { "value" } else { self.words(first, at - 2) };
            let (low, high) = (self.words(at, at), self.words(at + 2, at + 2));
            let help = format!("write `({value} >= {low} AND {value} <= {high})`");
            self.report(at - 1, at, "SCL has no IN".to_owned(), "a form of other languages", help);
            self.replace(first, end, RawKind::Reported, None);
            return true;
        }
        let (left, right) = self.sides(at, at);
        let title = format!("an operator is missing between `{left}` and `{right}`");
        let message = Diagnostic::new(Code::Syntax, self.span(at, at + 1), title);
        let help = format!("write an operator between them, as in `{left} AND {right}`, or remove one of them");
        self.messages.push(message.label("a second value").help(help));
        self.replace(self.operand_start(at), end, RawKind::Reported, None);
        true
    }

    /// Index of THEN, OF or DO after `at`, before which no statement ends and nothing is assigned.
    fn end_of_head(&self, at: usize) -> Option<usize> {
        const HEAD_MAX: usize = 200;
        let mut depth = 0usize;
        for (index, token) in self.tokens.iter().enumerate().skip(at).take(HEAD_MAX) {
            match token.kind {
                RawKind::LeftParen | RawKind::LeftBracket => depth += 1,
                RawKind::RightParen | RawKind::RightBracket => depth = depth.checked_sub(1)?,
                RawKind::Semicolon | RawKind::Colon => return None,
                kind if depth == 0 && kind.assigns() => return None,
                _ => {}
            }
            match token.keyword {
                Some(Keyword::Then | Keyword::Of | Keyword::Do) => return (depth == 0).then_some(index),
                Some(word) if word.ends_expression() => return None,
                _ => {}
            }
        }
        None
    }
}
