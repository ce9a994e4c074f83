//! Constants in parts: durations with blanks or colons, `T#1h 30m`, `T#5 s`, `T#1:30:00`; dates with slashes, `D#2024/5/6`; digits after
//! a blank, `16# FF`.

use plcc_diag::{Code, Diagnostic};
use plcc_literal::duration::{self, Fraction, Smallest};

use super::Repair;
use crate::literal::meant;
use crate::scl::raw::{RawKind, RawToken};

/// What a duration begins with.
const PREFIXES: [&str; 6] = ["T", "TIME", "LT", "LTIME", "S5T", "S5TIME"];

impl Repair<'_> {
    /// A duration that goes on after its first token.
    pub(super) fn parted_duration(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let is_prefix = |word: &str| PREFIXES.iter().any(|prefix| prefix.eq_ignore_ascii_case(word));
        let (first, prefix, value) = match token.kind {
            RawKind::Literal => match self.slice(token).split_once('#') {
                Some((prefix, value)) if is_prefix(prefix) => (at, prefix, value),
                _ => return false,
            },
            RawKind::Hash if at > 0 && self.kind(at - 1) == Some(RawKind::Word) && self.adjacent(at - 1) => {
                let prefix = self.slice(self.tokens[at - 1]);
                if !is_prefix(prefix) || self.is_declared(prefix) {
                    return false;
                }
                (at - 1, prefix, "")
            }
            _ => return false,
        };
        let Some((after, written)) = self.rest_after_blanks(value).or_else(|| self.rest_after_colons(value)) else {
            return false;
        };
        let title = format!("`{}` is not a constant as STEP 7 writes it", self.words(first, after - 1));
        let message = Diagnostic::new(Code::BadLiteral, self.span(first, after), title);
        let label = "no blanks and no colons inside a duration";
        self.messages.push(message.label(label).help(format!("write `{prefix}#{written}`")));
        self.replace(first, after, RawKind::Reported, None);
        true
    }

    /// `16# FF`: a base with its digits after a blank.
    pub(super) fn parted_digits(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let prefix = self.slice(token);
        let base = match prefix.strip_suffix('#').and_then(|prefix| prefix.rsplit('#').next()) {
            Some("16") => 16,
            Some("8") => 8,
            Some("2") => 2,
            _ => return false,
        };
        let mut after = at + 1;
        while self.beside(after).is_some_and(|next| matches!(next.kind, RawKind::Word | RawKind::Number))
            && (after == at + 1 || self.adjacent(after - 1))
        {
            after += 1;
        }
        let digits = if after == at + 1 { "" } else { self.words(at + 1, after - 1) };
        if digits.is_empty() || !digits.chars().all(|digit| digit.is_digit(base)) {
            return false;
        }
        let written = format!("{prefix}{digits}");
        let title = format!("`{}` is not a constant as STEP 7 writes it", self.words(at, after - 1));
        let message = Diagnostic::new(Code::BadLiteral, self.span(at, after), title);
        self.messages.push(message.label("no blanks inside a constant").help(format!("write `{written}`")));
        self.replace(at, after, RawKind::Reported, None);
        true
    }

    /// `12:30:00`: a time of day without its prefix. Called at the first colon.
    pub(super) fn time_with_colons(&mut self) -> bool {
        let at = self.at;
        let Some(first) = at.checked_sub(1).filter(|_| self.is_assigned()) else { return false };
        let kinds = [first, at + 1, at + 2, at + 3].map(|index| self.kind(index));
        let wanted = [RawKind::Number, RawKind::Number, RawKind::Colon, RawKind::Number].map(Some);
        if kinds != wanted || !(first..at + 3).all(|index| self.adjacent(index)) {
            return false;
        }
        let written = self.words(first, at + 3);
        let title = "a time of day begins with `TOD#`".to_owned();
        self.report(first, at + 4, title, "not a constant of SCL", format!("write `TOD#{written}`"));
        self.replace(first, at + 4, RawKind::Reported, None);
        true
    }

    /// `D#2024/5/6`, `DATE#6/5/2024`: a date with slashes.
    pub(super) fn date_with_slashes(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let prefix = match (token.kind, self.slice(token).split_once('#')) {
            (RawKind::Literal, Some((prefix, value))) if value.bytes().all(|digit| digit.is_ascii_digit()) => prefix,
            _ => return false,
        };
        let is_date = ["D", "DATE"].iter().any(|own| own.eq_ignore_ascii_case(prefix));
        let kinds = [at + 1, at + 2, at + 3, at + 4].map(|index| self.kind(index));
        let wanted = [RawKind::Slash, RawKind::Number, RawKind::Slash, RawKind::Number].map(Some);
        if !is_date || kinds != wanted || !(at..at + 4).all(|index| self.adjacent(index)) {
            return false;
        }
        let written = self.words(at, at + 4);
        let help = meant::date(written, &written[prefix.len() + 1..]);
        let title = format!("`{written}` is not a constant as STEP 7 writes it");
        let message = Diagnostic::new(Code::BadLiteral, self.span(at, at + 5), title);
        self.messages.push(message.label("the parts of a date are joined by `-`").help(help));
        self.replace(at, at + 5, RawKind::Reported, None);
        true
    }

    /// ` 30m 5s` after `1h`: the index after it, and the whole value.
    fn rest_after_blanks(&self, value: &str) -> Option<(usize, String)> {
        let mut written = value.trim_end_matches('_').to_ascii_uppercase();
        let mut after = self.at + 1;
        // `T#5 s`
        if let Some(unit) = self.beside(after).filter(|unit| unit.kind == RawKind::Word)
            && value.ends_with(|last: char| last.is_ascii_digit())
        {
            written.push_str(&self.slice(unit).to_ascii_uppercase());
            after += 1;
        }
        while let (Some(number), Some(unit)) = (self.beside(after), self.beside(after + 1))
            && number.kind == RawKind::Number
            && unit.kind == RawKind::Word
            && self.adjacent(after)
        {
            let part = self.words(after, after + 1).to_ascii_uppercase();
            written = if written.is_empty() { part } else { format!("{written}_{part}") };
            after += 2;
        }
        let is_duration = duration::nanoseconds(&written, Smallest::Nanosecond, Fraction::Anywhere).is_ok();
        (after > self.at + 1 && is_duration).then_some((after, written))
    }

    /// `:30:00` after `1`: the index after it, and the whole value.
    fn rest_after_colons(&self, value: &str) -> Option<(usize, String)> {
        let at = self.at;
        let is_number = !value.is_empty() && value.bytes().all(|digit| digit.is_ascii_digit());
        let joined = (at..at + 4).all(|index| self.adjacent(index));
        let kinds = [at + 1, at + 2, at + 3, at + 4].map(|index| self.kind(index));
        let wanted = [RawKind::Colon, RawKind::Number, RawKind::Colon, RawKind::Number].map(Some);
        if !is_number || !joined || kinds != wanted {
            return None;
        }
        let (minutes, seconds) = (self.words(at + 2, at + 2), self.words(at + 4, at + 4));
        Some((at + 5, format!("{value}H_{minutes}M_{seconds}S")))
    }
}
