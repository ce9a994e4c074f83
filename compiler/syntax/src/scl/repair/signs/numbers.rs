//! Numbers of other languages: `0x1F`, `5s`, `3,5`, `.5`.

use plcc_literal::duration::{self, Fraction, Smallest};

use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::repair::{Area, Edit, Repair, ends_operand};

impl Repair<'_> {
    /// `.5`: a digit is before the point.
    pub(super) fn bare_fraction(&mut self) -> bool {
        let at = self.at;
        let digits = self.token(at + 1).filter(|next| next.kind == RawKind::Number && self.adjacent(at));
        let Some(digits) = digits.filter(|_| !self.last.is_some_and(ends_operand)) else { return false };
        let help = format!("write `0.{}`", self.slice(digits));
        self.report(
            at,
            at + 2,
            "a decimal number has a digit before its point".to_owned(),
            "not a number of SCL",
            help,
        );
        self.replace(at, at + 2, RawKind::Reported, None);
        true
    }

    /// `0x1F`, `0b101`, `5L`, `5s`, `3,5`
    pub(in crate::scl::repair) fn repair_number(&mut self, token: RawToken) -> bool {
        if !matches!(token.kind, RawKind::Number | RawKind::Real) {
            return false;
        }
        let at = self.at;
        let number = self.slice(token);
        if token.kind == RawKind::Real {
            // `1.5f`
            let letter = self.token(at + 1).filter(|next| next.kind == RawKind::Word && self.adjacent(at));
            if !letter.is_some_and(|next| matches!(self.slice(next), "f" | "F" | "d" | "D")) {
                return false;
            }
            let help = format!("write `{number}`");
            self.report(at, at + 2, "a REAL number has no letter after it".to_owned(), "not a number of SCL", help);
            self.replace(at, at + 2, RawKind::Reported, None);
            return true;
        }
        let next = self.token(at + 1).filter(|_| self.adjacent(at));
        let Some(next) = next else { return false };
        match next.kind {
            RawKind::Word if self.is_declared(self.words(at, at + 1)) => {
                // The name was reported where it is declared.
                let name = RawToken { kind: RawKind::Word, end: next.end, keyword: None, ..token };
                self.edits.push(Edit { first: at, after: at + 2, with: vec![name] });
                self.at = at + 2;
                self.note(name);
                true
            }
            RawKind::Word => {
                let Some((title, written)) = foreign_number(number, self.slice(next)) else { return false };
                let help = format!("write `{written}`");
                self.report(at, at + 2, title.to_owned(), "not a number of SCL", help);
                self.replace(at, at + 2, RawKind::Reported, None);
                true
            }
            RawKind::Comma => {
                let digits = self.token(at + 2).filter(|next| next.kind == RawKind::Number && self.adjacent(at + 1));
                let alone = self.kind(at + 3) != Some(RawKind::Comma);
                let value = alone && self.brackets.is_empty() && self.is_real_value();
                let Some(digits) = digits.filter(|_| value) else { return false };
                let written = format!("{number}.{}", self.slice(digits));
                let help = format!("write `{written}`");
                self.report(at, at + 3, "a decimal number has a point".to_owned(), "read as one number", help);
                self.replace(at, at + 3, RawKind::Reported, None);
                true
            }
            _ => false,
        }
    }

    /// Whether one number stands here: after `:=` or an operator of a statement, or as the initial value of a REAL.
    fn is_real_value(&self) -> bool {
        let Some(mut last) = self.last else { return false };
        // What counts is before the sign of the number: `-2..-1,7:` are values of CASE.
        if matches!(last.kind, RawKind::Plus | RawKind::Minus)
            && let Some(before) = self.at.checked_sub(2).and_then(|before| self.token(before))
            && !ends_operand(before)
        {
            last = before;
        }
        match self.area {
            Area::Statements | Area::Head => matches!(
                last.kind,
                RawKind::Assign
                    | RawKind::Plus
                    | RawKind::Minus
                    | RawKind::Star
                    | RawKind::Slash
                    | RawKind::Less
                    | RawKind::Greater
                    | RawKind::LessEqual
                    | RawKind::GreaterEqual
            ),
            Area::Declarations => {
                let real =
                    self.at.checked_sub(2).and_then(|before| self.token(before)).is_some_and(|ty| {
                        ["REAL", "LREAL"].iter().any(|name| name.eq_ignore_ascii_case(self.slice(ty)))
                    });
                let array = (self.statement..self.at).any(|index| self.keyword(index) == Some(Keyword::Array));
                last.kind == RawKind::Assign && real && !array
            }
        }
    }
}

/// What is meant by a number and the letters directly after it, and how SCL writes it.
fn foreign_number(number: &str, word: &str) -> Option<(&'static str, String)> {
    let upper = word.to_ascii_uppercase();
    let digits = upper.get(1..).unwrap_or_default();
    let of_base =
        |base: u32| !digits.is_empty() && digits.bytes().all(|byte| byte == b'_' || char::from(byte).is_digit(base));
    Some(match upper.as_str() {
        _ if number == "0" && upper.starts_with('X') && of_base(16) => {
            ("a hexadecimal number begins with `16#`", format!("16#{digits}"))
        }
        _ if number == "0" && upper.starts_with('B') && of_base(2) => {
            ("a binary number begins with `2#`", format!("2#{digits}"))
        }
        _ if number == "0" && upper.starts_with('O') && of_base(8) => {
            ("an octal number begins with `8#`", format!("8#{digits}"))
        }
        "L" | "LL" => ("a number of type DINT begins with `L#`", format!("L#{number}")),
        "U" | "UL" => ("a number without sign has its type before it", format!("UDINT#{number}")),
        "F" => ("a number of type REAL has a point", format!("{number}.0")),
        "MS" | "S" | "M" | "H" | "MIN" | "SEC" => {
            let unit = match upper.as_str() {
                "MIN" => "M",
                "SEC" => "S",
                unit => unit,
            };
            ("a time begins with `T#`", format!("T#{number}{unit}"))
        }
        _ if word.bytes().any(|byte| byte.is_ascii_digit()) && is_duration(&format!("{number}{word}")) => {
            ("a time begins with `T#`", format!("T#{number}{upper}"))
        }
        _ if upper == "H" || upper.bytes().all(|byte| byte.is_ascii_hexdigit()) => {
            ("a hexadecimal number begins with `16#`", format!("16#{number}{upper}"))
        }
        _ => return None,
    })
}

/// `1h30m`
fn is_duration(text: &str) -> bool {
    duration::nanoseconds(text, Smallest::Nanosecond, Fraction::Last).is_ok()
}

#[cfg(test)]
mod tests {
    use super::foreign_number;

    #[test]
    fn numbers_are_written_with_their_digits() {
        let written = |number, word| foreign_number(number, word).map(|(_, written)| written);
        assert_eq!(written("0", "x1f").as_deref(), Some("16#1F"));
        assert_eq!(written("0", "b101").as_deref(), Some("2#101"));
        assert_eq!(written("7", "s").as_deref(), Some("T#7S"));
        assert_eq!(written("1", "h30m").as_deref(), Some("T#1H30M"));
        assert_eq!(written("5", "L").as_deref(), Some("L#5"));
        assert_eq!(written("1", "F").as_deref(), Some("1.0"));
        assert_eq!(written("12", "AB").as_deref(), Some("16#12AB"));
        assert_eq!(written("12", "px"), None);
    }
}
