//! Conditions with their comparisons: what is on both sides of an operator, and comparisons with one side.

use super::is_comparison;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::repair::{Edit, Repair, begins_operand, ends_operand};

/// How many tokens a condition may have that a help shows.
const CONDITION_MAX: usize = 24;

impl Repair<'_> {
    /// The conditions before token `at` and from token `after` on, with their comparisons; `…` for what is itself written as in
    /// another language, or is long.
    pub(super) fn conditions(&self, at: usize, after: usize) -> (String, String) {
        let (mut first, mut depth) = (at, 0usize);
        while first > self.statement && at - first < CONDITION_MAX {
            let token = self.tokens[first - 1];
            match token.kind {
                RawKind::RightParen | RawKind::RightBracket => depth += 1,
                RawKind::LeftParen | RawKind::LeftBracket if depth == 0 => break,
                RawKind::LeftParen | RawKind::LeftBracket => depth -= 1,
                _ if depth == 0 && ends_condition(token) => break,
                _ => {}
            }
            first -= 1;
        }
        let left = if depth == 0 { self.condition(first, at) } else { None };
        let mut end = after;
        depth = 0;
        while let Some(token) = self.token(end).filter(|_| end - after < CONDITION_MAX) {
            match token.kind {
                RawKind::LeftParen | RawKind::LeftBracket => depth += 1,
                RawKind::RightParen | RawKind::RightBracket if depth == 0 => break,
                RawKind::RightParen | RawKind::RightBracket => depth -= 1,
                _ if depth > 0 => {}
                _ if ends_condition(token) => break,
                // Two operands in a row belong to different parts.
                _ if end > after && begins_operand(token) && ends_operand(self.tokens[end - 1]) => break,
                _ => {}
            }
            end += 1;
        }
        let right = if depth == 0 { self.condition(after, end) } else { None };
        let shown = |condition: Option<&str>| condition.unwrap_or("…").to_owned();
        (shown(left), shown(right))
    }

    /// The text of a condition, if it is one of SCL.
    fn condition(&self, first: usize, end: usize) -> Option<&str> {
        let tokens = self.tokens.get(first..end).filter(|tokens| !tokens.is_empty() && tokens.len() < CONDITION_MAX)?;
        let foreign = tokens.iter().any(|token| matches!(token.kind, RawKind::Stray | RawKind::Arrow))
            || tokens.windows(2).any(|pair| is_comparison(pair[0].kind) && is_comparison(pair[1].kind));
        (!foreign).then(|| self.words(first, end - 1))
    }

    /// `a > 5 AND < 10`: a comparison without its left side.
    pub(super) fn half_comparison(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let links = |word: Keyword| matches!(word, Keyword::And | Keyword::Or | Keyword::Xor);
        let is_link = |token: RawToken| token.kind == RawKind::Ampersand || token.keyword.is_some_and(links);
        let value = |token: RawToken| begins_operand(token) || token.kind == RawKind::Minus;
        if !self.last.is_some_and(is_link) || !self.token(at + 1).is_some_and(value) {
            return false;
        }
        let (_, right) = self.sides(at, at + 1);
        let written = self.words(at - 1, at - 1);
        let sign = self.slice(token);
        let help = match self.compared_before(at - 1) {
            Some(left) => format!("write `{written} {left} {sign} {right}`"),
            None => format!("write the value that is compared with `{right}` before `{sign}`"),
        };
        let title = format!("the value before `{sign}` is missing");
        self.report(at, at + 1, title, "a comparison has two sides", help);
        let missing = RawToken { kind: RawKind::Reported, keyword: None, ..token };
        self.edits.push(Edit { first: at, after: at + 1, with: vec![missing, token] });
        self.at += 1;
        self.note(token);
        true
    }

    /// The left side of the comparison that ends before `end`.
    fn compared_before(&self, end: usize) -> Option<String> {
        // From the sign to the beginning of its left side, past brackets.
        let (mut sign, mut first, mut depth) = (None, end, 0usize);
        while first > self.statement {
            let token = self.tokens[first - 1];
            match token.kind {
                RawKind::RightParen | RawKind::RightBracket => depth += 1,
                RawKind::LeftParen | RawKind::LeftBracket if depth == 0 => break,
                RawKind::LeftParen | RawKind::LeftBracket => depth -= 1,
                _ if depth > 0 => {}
                kind if is_comparison(kind) && sign.is_none() => sign = Some(first - 1),
                RawKind::Assign | RawKind::Comma | RawKind::Semicolon | RawKind::Ampersand => break,
                _ if token.keyword.is_some_and(|word| !matches!(word, Keyword::Mod | Keyword::Div)) => break,
                _ => {}
            }
            first -= 1;
        }
        let sign = sign.filter(|sign| first < *sign)?;
        Some(self.words(first, sign - 1).to_owned())
    }
}

/// Whether a condition cannot contain the token, outside of brackets.
fn ends_condition(token: RawToken) -> bool {
    let foreign = matches!(
        token.kind,
        RawKind::Assign | RawKind::Comma | RawKind::Semicolon | RawKind::Colon | RawKind::Ampersand | RawKind::Stray
    );
    foreign || token.keyword.is_some_and(|word| !matches!(word, Keyword::Mod | Keyword::Div | Keyword::Not))
}
