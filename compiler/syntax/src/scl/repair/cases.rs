//! CASE as other languages write it: `SELECT CASE x … END SELECT`, `WHEN 1 =>`, and values that end with another sign or word than `:`, as in
//! `1 := x := 2;`.

use super::words::alias;
use super::{Repair, ends_operand};
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

impl Repair<'_> {
    /// A sign for `:` after the values of CASE.
    pub(super) fn value_with_sign(&mut self) -> bool {
        let (first, at) = (self.statement, self.at);
        let inside = self.open.last().is_some_and(|open| open.keyword == Keyword::Case) && self.head.is_none();
        let values = first < at && (first..at).all(|index| self.kind(index).is_some_and(is_part_of_values));
        if !inside || !values || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let help = format!("write `{}:`", self.words(first, at - 1));
        self.report(at, at + 1, "a value of CASE ends with `:`".to_owned(), "read as `:`", help);
        self.replace(at, at + 1, RawKind::Colon, None);
        true
    }

    /// `1 THEN` and `2, 3 DO`, whose word is at `end`.
    pub(super) fn value_with_word(&mut self, end: usize) -> bool {
        let inside = self.open.last().is_some_and(|open| open.keyword == Keyword::Case);
        let is_word = matches!(self.keyword(end), Some(Keyword::Then | Keyword::Do));
        let values = (self.at..end).all(|index| self.kind(index).is_some_and(is_part_of_values));
        if !inside || !is_word || !values || !ends_operand(self.tokens[end - 1]) {
            return false;
        }
        self.pass_up_to(end);
        self.value_with_sign()
    }

    /// `case 1:`, `WHEN 1 THEN`, `WHEN OTHERS =>`
    pub(super) fn value_after_word(&mut self, token: RawToken) -> bool {
        const LOOK_MAX: usize = 8;
        let at = self.at;
        let inside = self.open.last().is_some_and(|open| open.keyword == Keyword::Case) && self.head.is_none();
        let word = self.slice(token);
        let is_when = token.keyword.is_none() && self.starts(token) && word.eq_ignore_ascii_case("WHEN");
        if !inside || token.keyword != Some(Keyword::Case) && (!is_when || self.is_declared(word)) {
            return false;
        }
        let is_word = |index| matches!(self.keyword(index), Some(Keyword::Of | Keyword::Then | Keyword::Do));
        let is_sign = |kind| matches!(kind, RawKind::Colon | RawKind::Semicolon | RawKind::Assign | RawKind::Arrow);
        let ends = (at + 1..self.tokens.len().min(at + LOOK_MAX))
            .find(|index| is_word(*index) || self.kind(*index).is_some_and(is_sign));
        let ends_value = |end: usize| match (self.kind(end), self.keyword(end)) {
            (Some(RawKind::Colon), _) => true,
            (Some(RawKind::Arrow), _) | (_, Some(Keyword::Then | Keyword::Do)) => is_when,
            _ => false,
        };
        let Some(end) = ends.filter(|end| *end > at + 1 && ends_value(*end)) else { return false };
        let others = self.token(at + 1).is_some_and(|next| alias(self.slice(next)) == Some(Keyword::Else));
        if is_when && others && end == at + 2 {
            self.misspelt(at, end + 1, Keyword::Else);
            self.replace(at, end + 1, RawKind::Word, Some(Keyword::Else));
            return true;
        }
        let value = self.words(at + 1, end - 1);
        let title = "a value of CASE needs no word before it".to_owned();
        self.report(at, at + 1, title, "a form of other languages", format!("write `{value}:`"));
        self.drop_tokens(at, at + 1);
        self.statement = self.at;
        if self.kind(end) != Some(RawKind::Colon) {
            self.pass_up_to(end);
            self.replace(end, end + 1, RawKind::Colon, None);
        }
        true
    }

    /// `CASE OF x`, whose value comes before OF.
    pub(super) fn value_after_of(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let Some(of) = self.token(at + 1).filter(|next| next.keyword == Some(Keyword::Of)) else { return false };
        let is_name = |kind| matches!(kind, RawKind::Word | RawKind::Quoted | RawKind::Local);
        let names = |index| self.beside(index).is_some_and(|next| is_name(next.kind) && next.keyword.is_none());
        if token.keyword != Some(Keyword::Case) || !names(at + 2) {
            return false;
        }
        let mut after = at + 3;
        while self.kind(after) == Some(RawKind::Dot) && names(after + 1) {
            after += 2;
        }
        if self.beside(after).is_some_and(|next| !is_part_of_values(next.kind)) {
            return false;
        }
        let help = format!("write `CASE {} OF`", self.words(at + 2, after - 1));
        self.report(at, after, "the value of CASE comes before OF".to_owned(), "exchanged", help);
        let mut with = vec![token];
        with.extend_from_slice(&self.tokens[at + 2..after]);
        with.push(of);
        self.edits.push(super::Edit { first: at, after, with });
        self.at = after;
        self.note(token);
        self.note(of);
        true
    }

    /// Goes past the tokens before `end`, which stay as they are.
    fn pass_up_to(&mut self, end: usize) {
        while self.at < end {
            let token = self.tokens[self.at];
            self.pass(token);
        }
    }

    /// `SWITCH x … END_SWITCH`, `SELECT CASE x … END SELECT`
    pub(super) fn switch_in_words(&mut self, word: &str) -> bool {
        if !is_switch(word) {
            return false;
        }
        let at = self.at;
        // `SELECT CASE x`, `SWITCH x CASE 1: …`
        let first = if self.keyword(at + 1) == Some(Keyword::Case) { at + 2 } else { at + 1 };
        let end = (first..self.tokens.len()).find(|index| self.end_of_switch(*index) > 0 || self.leaves_block(*index));
        let Some(end) = end.filter(|end| *end > first) else { return false };
        let next_line = (first..end).find(|index| self.tokens[*index].first_on_line);
        let case = (first..end).find(|index| self.keyword(*index) == Some(Keyword::Case));
        // After the value: `CASE 1:`, or the next line.
        let head = next_line.unwrap_or(end).min(case.unwrap_or(end)).max(first + 1);
        let value = self.words(first, head - 1).trim_end_matches([';', ':']).trim();
        self.report_switch(word, value, head, end + self.end_of_switch(end));
        true
    }

    /// Number of tokens of `END_SWITCH`, `END SELECT` at the index; 0: something else.
    fn end_of_switch(&self, at: usize) -> usize {
        let Some(token) = self.token(at) else { return 0 };
        let word = self.slice(token).to_ascii_uppercase().replace('_', "");
        let of_switch = |word: &str| is_switch(word) || word.eq_ignore_ascii_case("CASE");
        match word.strip_prefix("END") {
            Some("") if self.beside(at + 1).is_some_and(|next| of_switch(self.slice(next))) => 2,
            Some(rest) if of_switch(rest) => 1,
            _ => 0,
        }
    }

    fn leaves_block(&self, at: usize) -> bool {
        self.keyword(at).is_some_and(Keyword::ends_block)
    }

    /// Reports a choice whose head ends before `head`, and gives up its statements, which end before `after`.
    pub(super) fn report_switch(&mut self, word: &str, value: &str, head: usize, after: usize) {
        let is_value = |kind| is_part_of_values(kind) || kind == RawKind::Word;
        let cases = (head..after.saturating_sub(1)).filter(|index| self.keyword(*index) == Some(Keyword::Case));
        let mut values = cases.map(|case| case + 1).filter(|index| self.keyword(*index).is_none());
        let first = values.find(|index| self.kind(*index).is_some_and(is_value));
        let first = first.map_or("1", |first| self.words(first, first));
        let is_else =
            |token: &RawToken| token.keyword == Some(Keyword::Else) || alias(self.slice(*token)) == Some(Keyword::Else);
        let otherwise = if self.tokens[head..after].iter().any(is_else) { " ELSE …" } else { "" };
        let help = format!("write `CASE {value} OF {first}: …{otherwise} END_CASE;`");
        let title = format!("SCL chooses with CASE, not with `{word}`");
        self.report(self.at, head, title, "a form of other languages", help);
        self.give_up(after);
    }
}

/// Whether other languages choose with the word.
pub(super) fn is_switch(word: &str) -> bool {
    ["SWITCH", "SELECT"].iter().any(|known| known.eq_ignore_ascii_case(word))
}

fn is_part_of_values(kind: RawKind) -> bool {
    matches!(
        kind,
        RawKind::Number | RawKind::Literal | RawKind::Text | RawKind::Minus | RawKind::Comma | RawKind::DotDot
    )
}
