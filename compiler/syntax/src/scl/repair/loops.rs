//! Heads of loops of other languages: `for (i = 0; i < 10; i++)`, `FOR i FROM 0 TO 9 DO`.

use std::ops::Range;

use super::Repair;
use crate::scl::keyword::Keyword;
use crate::scl::raw::RawKind;

/// How many tokens the head of a loop may have.
const HEAD_MAX: usize = 60;

impl Repair<'_> {
    /// `FOR i FROM 0 TO 9 DO`
    pub(super) fn for_from(&mut self) -> bool {
        let at = self.at;
        let variable = self.words(self.operand_start(at), at - 1);
        let start = self.token(at + 1).map_or("first", |token| self.slice(token));
        let help = format!("write `{variable} := {start}`");
        self.report(at, at + 1, "the first value of FOR is given with `:=`".to_owned(), "read as `:=`", help);
        self.replace(at, at + 1, RawKind::Assign, None);
        true
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
        Some(match limit.parse::<i32>() {
            Ok(value) => (i64::from(value) + by).to_string(),
            Err(_) if by < 0 => format!("{limit} - 1"),
            Err(_) if by > 0 => format!("{limit} + 1"),
            Err(_) => limit.to_owned(),
        })
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
