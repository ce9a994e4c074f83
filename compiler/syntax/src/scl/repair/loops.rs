//! Heads of loops of other languages: `for (i = 0; i < 10; i++)`, `FOR i FROM 0 TO 9 DO`, `FOR x IN list DO`. And `DO END_UNTIL`.

use std::ops::Range;

use super::Repair;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// How many tokens the head of a loop may have.
const HEAD_MAX: usize = 60;

impl Repair<'_> {
    /// `FOR i FROM 0 TO 9 DO`, `FOR i IN 0 TO 9 DO`
    pub(super) fn for_from(&mut self) -> bool {
        let at = self.at;
        let variable = self.words(self.operand_start(at), at - 1);
        let to = self.part_of_head(|index| self.keyword(index) == Some(Keyword::To));
        let start = match to.filter(|to| *to > at + 1) {
            Some(to) => self.words(at + 1, to - 1),
            None => self.token(at + 1).map_or("first", |token| self.slice(token)),
        };
        let help = format!("write `{variable} := {start}`");
        self.report(at, at + 1, "the first value of FOR is given with `:=`".to_owned(), "read as `:=`", help);
        self.replace(at, at + 1, RawKind::Assign, None);
        true
    }

    /// `FOR i IN 1..10 DO`, `FOR i IN 0 TO 9 DO`, `FOR x IN list DO`
    pub(super) fn for_in(&mut self) -> bool {
        let at = self.at;
        let links = |index| {
            self.kind(index) == Some(RawKind::DotDot) || matches!(self.keyword(index), Some(Keyword::To | Keyword::Do))
        };
        let Some(link) = self.part_of_head(links).filter(|link| *link > at + 1) else { return false };
        match self.keyword(link) {
            Some(Keyword::To) => self.for_from(),
            Some(_) => self.for_elements(link),
            None => self.for_range(link),
        }
    }

    /// `FOR EACH x IN list DO`
    pub(super) fn for_each(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let is = |index: usize, word: &str| {
            self.token(index).is_some_and(|next| self.slice(next).eq_ignore_ascii_case(word))
        };
        if token.keyword.is_some() || !is(at, "EACH") || !is(at + 2, "IN") {
            return false;
        }
        // What follows IN gives the message.
        self.drop_tokens(at, at + 1);
        true
    }

    /// The first token of the head after the current one of which `is_part` is true.
    pub(super) fn part_of_head(&self, is_part: impl Fn(usize) -> bool) -> Option<usize> {
        let ends = |index: usize| {
            self.kind(index) == Some(RawKind::Semicolon)
                || self.keyword(index).is_some_and(|word| word == Keyword::Do || word.ends_block())
        };
        let first = self.at + 1;
        let found = (first..self.tokens.len().min(first + HEAD_MAX)).find(|index| is_part(*index) || ends(*index))?;
        is_part(found).then_some(found)
    }

    /// `FOR i IN 1..10 DO`, with its points at `points`.
    fn for_range(&mut self, points: usize) -> bool {
        let at = self.at;
        let variable = self.words(self.statement_head(), at - 1).to_owned();
        let first = self.words(at + 1, points - 1).to_owned();
        let last = self.token(points + 1).map_or("10", |token| self.slice(token)).to_owned();
        let help = format!("write `FOR {variable} := {first} TO {last} DO`");
        self.report(at, points + 2, "FOR counts with `:=` and TO".to_owned(), "a form of other languages", help);
        self.replace(at, at + 1, RawKind::Assign, None);
        while self.at < points {
            let token = self.tokens[self.at];
            self.pass(token);
        }
        self.replace(points, points + 1, RawKind::Word, Some(Keyword::To));
        true
    }

    /// `FOR x IN list DO`, with its DO at `end`.
    fn for_elements(&mut self, end: usize) -> bool {
        let at = self.at;
        let first = self.statement_head();
        let (element, list) = (self.words(first, at - 1), self.words(at + 1, end - 1));
        let element = element.split_whitespace().next_back().unwrap_or(element);
        let help = match self.numbers_of_range(at + 1, end) {
            Some((low, high)) => format!("write `FOR {element} := {low} TO {high} DO`"),
            None => {
                let (low, high) = self.declared_bounds(list).unwrap_or(("first", "last"));
                let index = if list.starts_with('#') { "#i" } else { "i" };
                format!("write `FOR {index} := {low} TO {high} DO` with an INT, and `{list}[{index}]` for `{element}`")
            }
        };
        let title = "FOR counts with `:=` and TO".to_owned();
        self.report(first, end, title, "SCL has no loop over elements", help);
        self.replace(first, end, RawKind::Reported, None);
        true
    }

    /// First and last number of `range(10)` or `range(2, 10)` from token `first` up to `end`, exclusive.
    fn numbers_of_range(&self, first: usize, end: usize) -> Option<(&str, String)> {
        let is_range = self.token(first).is_some_and(|token| self.slice(token).eq_ignore_ascii_case("range"));
        let close = self.closing(first + 1).filter(|close| is_range && close + 1 == end)?;
        let parts = self.parts(first + 2, close);
        let text = |part: &(usize, usize)| self.words(part.0, part.1);
        match parts.as_slice() {
            [limit] => Some(("0", moved(text(limit), -1))),
            [low, limit] => Some((text(low), moved(text(limit), -1))),
            _ => None,
        }
    }

    /// The bounds that the last declaration before gives an array of one dimension, as written.
    fn declared_bounds(&self, name: &str) -> Option<(&str, &str)> {
        let at = *self.declared.get(&name.trim_start_matches('#').to_uppercase())?;
        let word = self.token(at + 2).filter(|_| self.kind(at + 1) == Some(RawKind::Colon))?;
        let open = Some(at + 3).filter(|open| self.kind(*open) == Some(RawKind::LeftBracket))?;
        let close = self.closing(open).filter(|_| self.slice(word).eq_ignore_ascii_case("ARRAY"))?;
        let points = (open + 1..close).find(|index| self.kind(*index) == Some(RawKind::DotDot))?;
        let is_list = (open..close).any(|index| self.kind(index) == Some(RawKind::Comma));
        (!is_list && points > open + 1 && points + 1 < close)
            .then(|| (self.words(open + 1, points - 1), self.words(points + 1, close - 1)))
    }

    /// `FOR (i = 0; i < 10; i++) {`
    pub(super) fn for_of_c(&mut self) -> bool {
        let at = self.at;
        let Some(close) = self.closing(at) else { return false };
        let mut ends = (at..close).filter(|index| self.kind(*index) == Some(RawKind::Semicolon));
        let (Some(first), second) = (ends.next(), ends.next()) else { return false };
        let help = self.counted_of_c(at + 1, first, second.unwrap_or(close), close);
        self.report(at, close + 1, "FOR counts with `:=` and TO".to_owned(), "a form of other languages", help);
        self.brackets.clear();
        self.replace(at, close + 1, RawKind::Reported, None);
        true
    }

    /// `FOR i := 0; i < 10; i++ DO`
    pub(super) fn bare_for_of_c(&mut self) -> bool {
        let at = self.at;
        let end = (at + 1..self.tokens.len().min(at + HEAD_MAX)).find(|index| {
            self.keyword(*index) == Some(Keyword::Do) || self.token(*index).is_some_and(|token| token.first_on_line)
        });
        let Some(end) = end.filter(|end| self.keyword(*end) == Some(Keyword::Do)) else { return false };
        let mut ends = (at + 1..end).filter(|index| self.kind(*index) == Some(RawKind::Semicolon));
        let (Some(first), Some(second)) = (ends.next(), ends.next()) else { return false };
        let help = self.counted_of_c(at, first, second, end);
        self.report(at, end, "FOR counts with `:=` and TO".to_owned(), "a form of other languages", help);
        self.replace(at, end, RawKind::Reported, None);
        true
    }

    /// `DO END_UNTIL` after the condition of UNTIL.
    pub(super) fn do_before_end_until(&mut self) -> bool {
        let at = self.at;
        let is_end = self.token(at + 1).is_some_and(|next| self.slice(next).eq_ignore_ascii_case("END_UNTIL"));
        if !is_end {
            return false;
        }
        let until = self.tokens[..at].iter().rposition(|token| token.keyword == Some(Keyword::Until));
        let head = until.map_or("UNTIL …", |until| self.words(until, at - 1));
        let title = "END_REPEAT follows the condition of UNTIL".to_owned();
        self.report(at + 1, at + 2, title, "read as `END_REPEAT`", format!("write `{head} END_REPEAT;`"));
        self.replace(at, at + 2, RawKind::Word, Some(Keyword::EndRepeat));
        true
    }

    /// How SCL writes the head from token `inner` to `close`, whose parts end at `first` and `second`.
    fn counted_of_c(&self, inner: usize, first: usize, second: usize, close: usize) -> String {
        let assigned =
            (inner + 1..first).find(|index| matches!(self.kind(*index), Some(RawKind::Equal | RawKind::Assign)));
        let (variable, start) = match assigned.filter(|assigned| *assigned + 1 < first) {
            Some(assigned) => (self.words(assigned - 1, assigned - 1), self.words(assigned + 1, first - 1)),
            None => ("i", "first"),
        };
        let last = self.last_of_c(first + 1..second).unwrap_or_else(|| "last".to_owned());
        let step = self.step_of_c((second + 1).min(close)..close, variable);
        format!("write `FOR {variable} := {start} TO {last}{step} DO … END_FOR;`")
    }

    /// The last value that `i < 10` lets through.
    fn last_of_c(&self, condition: Range<usize>) -> Option<String> {
        let end = condition.end;
        let (sign, kind) = condition
            .filter_map(|index| Some((index, self.kind(index)?)))
            .find(|(_, kind)| super::signs::is_comparison(*kind))?;
        let limit = if sign + 1 < end { self.words(sign + 1, end - 1) } else { return None };
        let by = match kind {
            RawKind::Less => -1,
            RawKind::Greater => 1,
            RawKind::LessEqual | RawKind::GreaterEqual => 0,
            _ => return None,
        };
        Some(moved(limit, by))
    }

    /// ` BY -2` for `i -= 2`; nothing for a step of 1.
    fn step_of_c(&self, step: Range<usize>, variable: &str) -> String {
        let end = step.end;
        let is_sign =
            |kind| matches!(kind, RawKind::Plus | RawKind::Minus | RawKind::AddAssign | RawKind::SubtractAssign);
        let Some(sign) = step.rev().find(|index| self.kind(*index).is_some_and(is_sign)) else { return String::new() };
        let down = matches!(self.kind(sign), Some(RawKind::Minus | RawKind::SubtractAssign));
        // `i++` has nothing after its signs, `++i` the variable.
        let value = if sign + 1 < end { self.words(sign + 1, end - 1) } else { variable };
        match (down, if value == variable { "1" } else { value }) {
            (false, "1") => String::new(),
            (false, value) => format!(" BY {value}"),
            (true, value) => format!(" BY -{value}"),
        }
    }
}

/// `limit` and `by`, which is -1, 0 or 1, as a number or a sum.
fn moved(limit: &str, by: i64) -> String {
    match limit.parse::<i32>() {
        Ok(value) => (i64::from(value) + by).to_string(),
        Err(_) if by < 0 => format!("{limit} - 1"),
        Err(_) if by > 0 => format!("{limit} + 1"),
        Err(_) => limit.to_owned(),
    }
}
