//! Types and ranges as other languages write them: `ARRAY[0 TO 4] OF INT`, `INT(0..100)`, `1 TO 5:` in CASE.

use super::token::{Spanned, Tok};
use crate::elementary::Elementary;

/// Title and help for the token `at` of a declaration, which cannot follow `before`.
pub fn of(text: &str, before: &Spanned, at: &Spanned) -> Option<(&'static str, String)> {
    let sign = text.get(at.0..at.2)?;
    let rest = text.get(at.2..)?;
    match (&before.1, &at.1) {
        // `[0 TO 4]`, `[0:4]`
        (Tok::Literal(_), _) if sign == ":" || sign.eq_ignore_ascii_case("TO") => {
            let low = text.get(..before.2)?.rsplit(['[', ',']).next().unwrap_or_default().trim();
            let high = rest.split([']', ',', '\n']).next().unwrap_or_default().trim();
            let is_number = |bound: &str| bound.parse::<i32>().is_ok();
            (is_number(low) && is_number(high))
                .then(|| ("the bounds of an array are separated by two dots", format!("write `{low}..{high}`")))
        }
        // `INT(0..100)`
        (Tok::Name(name), Tok::LeftParen) if Elementary::from_word(&name.to_ascii_uppercase()).is_some() => {
            let inner = rest.split([')', '\n']).next().unwrap_or_default();
            let (low, high) = inner.split_once("..")?;
            let (low, high) = (low.trim(), high.trim());
            let help = format!(
                "write `{name}`, and keep the limits where the value is assigned: `LIMIT(MN := {low}, IN := …, MX := {high})`"
            );
            Some(("a type of SCL has no limits of its values", help))
        }
        _ => None,
    }
}

/// Title and help for `TO` in a value of CASE.
pub fn range_of_case(text: &str, before: &Spanned, at: &Spanned) -> Option<(&'static str, String)> {
    if !text.get(at.0..at.2)?.eq_ignore_ascii_case("TO") {
        return None;
    }
    let parts = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | ':');
    let low = text.get(..before.2)?.rsplit(parts).next().unwrap_or_default();
    let high = text.get(at.2..)?.split([':', ',', '\n']).next().unwrap_or_default().trim();
    let is_number = |bound: &str| bound.parse::<i64>().is_ok();
    (is_number(low) && is_number(high))
        .then(|| ("the values of a range are separated by two dots", format!("write `{low}..{high}`")))
}
