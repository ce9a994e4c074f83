//! Start values that are not constants of STL: `YES`, `5S`, `0xFF`, `FFh`, `A`, `2024-01-01`, `(1, 5)`.

use plcc_diag::{Code, Diagnostic};

use super::messages::State;
use super::token::{Spanned, Tok};

/// How many tokens a declaration is looked through for its `:` and `:=`.
const LOOK_MAX: usize = 50;

const TRUE_WORDS: [&str; 5] = ["YES", "ON", "HIGH", "JA", "EIN"];
const FALSE_WORDS: [&str; 5] = ["NO", "OFF", "LOW", "NEIN", "AUS"];

/// The message for the start value of the declaration that ends with the token at `index`, if it is clear what is meant.
pub fn slip(state: &State, index: usize) -> Option<Diagnostic> {
    let first = index.saturating_sub(LOOK_MAX);
    let declared = state.tokens.get(first..index)?;
    let assign = declared.iter().rposition(|(_, token, _)| matches!(token, Tok::Assign | Tok::Semicolon))?;
    let (_, Tok::Assign, from) = &declared[assign] else { return None };
    let colon = declared[..assign].iter().rposition(|(_, token, _)| matches!(token, Tok::Colon))?;
    let ty = declared.get(colon + 1)?;
    let word = |(start, _, end): &Spanned| state.text.get(*start..*end).unwrap_or_default().to_ascii_uppercase();
    let line = state.text.get(*from..)?.split([';', '\n']).next()?;
    let line = line.split("//").next()?;
    let value = line.trim();
    let (title, written) = match ty.1 {
        Tok::Array => plain_list(value)?,
        _ => meant(value, &word(ty))?,
    };
    let start = from + line.len() - line.trim_start().len();
    Some(
        Diagnostic::new(Code::ForeignForm, state.span(start..start + value.len()), title)
            .label("not a constant of STL")
            .help(format!("write `{written}`")),
    )
}

/// `(1, 5)` without its brackets.
fn plain_list(value: &str) -> Option<(&'static str, String)> {
    let inner = value.strip_prefix('(')?.strip_suffix(')')?;
    let plain = !inner.is_empty() && !inner.contains(['(', ')']);
    plain.then(|| ("the start values of an array have no brackets", inner.trim().to_owned()))
}

/// What the value of a type is called, and how it is written.
fn meant(value: &str, ty: &str) -> Option<(&'static str, String)> {
    let upper = value.to_ascii_uppercase();
    let hexadecimal = upper.strip_prefix("0X").or_else(|| upper.strip_suffix('H'));
    if let Some(written) = hexadecimal.and_then(|digits| of_base_16(digits, ty)) {
        return Some(("a hexadecimal number begins with `16#`", written));
    }
    if let Some(digits) =
        upper.strip_prefix("0B").filter(|digits| digits.bytes().all(|digit| matches!(digit, b'0' | b'1')))
    {
        return (!digits.is_empty()).then(|| ("a binary number begins with `2#`", format!("2#{digits}")));
    }
    match ty {
        "BOOL" if TRUE_WORDS.contains(&upper.as_str()) => Some(("a BOOL is TRUE or FALSE", "TRUE".to_owned())),
        "BOOL" if FALSE_WORDS.contains(&upper.as_str()) => Some(("a BOOL is TRUE or FALSE", "FALSE".to_owned())),
        "TIME" if is_time(&upper) => Some(("a time begins with `T#`", format!("T#{upper}"))),
        "S5TIME" if is_time(&upper) => Some(("a time of a timer begins with `S5T#`", format!("S5T#{upper}"))),
        "DATE" if is_date(value) => Some(("a date begins with `D#`", format!("D#{value}"))),
        "CHAR" if value.len() == 1 && is_plain(value) => {
            Some(("a character is written in quotes", format!("'{value}'")))
        }
        "STRING" if is_plain(value) => Some(("a text is written in quotes", format!("'{value}'"))),
        _ => None,
    }
}

/// A hexadecimal number as a value of the type.
fn of_base_16(digits: &str, ty: &str) -> Option<String> {
    let number = u32::from_str_radix(digits, 16).ok()?;
    Some(match ty {
        "BYTE" => format!("B#16#{digits}"),
        "WORD" => format!("W#16#{digits}"),
        "DWORD" => format!("DW#16#{digits}"),
        "INT" => number.to_string(),
        "DINT" => format!("L#{number}"),
        _ => return None,
    })
}

/// `5S`, `1H30M`
fn is_time(upper: &str) -> bool {
    let mut rest = upper;
    while !rest.is_empty() {
        let after = rest.trim_start_matches(|c: char| c.is_ascii_digit());
        let unit = ["MS", "S", "M", "H", "D"].into_iter().find(|unit| after.starts_with(unit));
        let Some(unit) = unit.filter(|_| after.len() < rest.len()) else { return false };
        rest = &after[unit.len()..];
    }
    !upper.is_empty()
}

/// `2024-01-31`
fn is_date(value: &str) -> bool {
    let parts: Vec<&str> = value.split('-').collect();
    parts.len() == 3 && parts.iter().all(|part| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit()))
}

fn is_plain(value: &str) -> bool {
    !value.is_empty() && value.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::meant;

    #[test]
    fn values_are_written_for_their_type() {
        let written = |value, ty| meant(value, ty).map(|(_, written)| written);
        assert_eq!(written("0xFF", "WORD").as_deref(), Some("W#16#FF"));
        assert_eq!(written("FFh", "INT").as_deref(), Some("255"));
        assert_eq!(written("yes", "BOOL").as_deref(), Some("TRUE"));
        assert_eq!(written("1h30m", "TIME").as_deref(), Some("T#1H30M"));
        assert_eq!(written("h30m", "TIME"), None);
        assert_eq!(written("2024-01-01", "DATE").as_deref(), Some("D#2024-01-01"));
        assert_eq!(written("speed", "INT"), None);
    }
}
