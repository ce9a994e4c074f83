//! The extent of tokens for which a regular expression is not enough: constants with `#`, texts, addresses with a point.

use super::pointer::{self, Tail};
use crate::scl::address;

/// Bytes between the two parts of a text that continues after a line end.
const BREAK_MAX: usize = 4096;

/// How the text after the `#` of a constant is built.
#[derive(Clone, Copy)]
enum Form {
    /// `W#16#3A2F`, `INT#-5`, `REAL#1.5`, `BOOL#TRUE`, `CHAR#'a'`.
    Value,
    /// `T#1h_2m`, `S5T#2s`.
    Duration,
    /// `D#2000-6-20`, `DT#2000-6-20-12:0:0.5`, `TOD#5:45:00`.
    Date,
    /// `P#M 10.0`.
    Pointer,
}

/// The words that are allowed before the `#` of a constant.
const PREFIXES: &[(&str, Form)] = &[
    ("BOOL", Form::Value),
    ("B", Form::Value),
    ("BYTE", Form::Value),
    ("W", Form::Value),
    ("WORD", Form::Value),
    ("DW", Form::Value),
    ("DWORD", Form::Value),
    ("LW", Form::Value),
    ("LWORD", Form::Value),
    ("L", Form::Value),
    ("SINT", Form::Value),
    ("USINT", Form::Value),
    ("INT", Form::Value),
    ("UINT", Form::Value),
    ("DINT", Form::Value),
    ("UDINT", Form::Value),
    ("LINT", Form::Value),
    ("ULINT", Form::Value),
    ("REAL", Form::Value),
    ("LREAL", Form::Value),
    ("CHAR", Form::Value),
    ("WCHAR", Form::Value),
    ("STRING", Form::Value),
    ("WSTRING", Form::Value),
    ("C", Form::Value),
    ("Z", Form::Value),
    ("S5T", Form::Duration),
    ("S5TIME", Form::Duration),
    ("T", Form::Duration),
    ("TIME", Form::Duration),
    ("LT", Form::Duration),
    ("LTIME", Form::Duration),
    ("D", Form::Date),
    ("DATE", Form::Date),
    ("LDATE", Form::Date),
    ("TOD", Form::Date),
    ("TIME_OF_DAY", Form::Date),
    ("LTOD", Form::Date),
    ("LTIME_OF_DAY", Form::Date),
    ("DT", Form::Date),
    ("DATE_AND_TIME", Form::Date),
    ("LDT", Form::Date),
    ("DATE_AND_LTIME", Form::Date),
    ("LDATE_AND_TIME", Form::Date),
    ("DTL", Form::Date),
    ("P", Form::Pointer),
];

/// Bytes of the constant after `prefix` and `#`; `None`: they do not make a constant, as in `T#name`.
pub fn literal(prefix: &str, rest: &str) -> Option<usize> {
    let (_, form) = PREFIXES.iter().find(|(name, _)| name.eq_ignore_ascii_case(prefix))?;
    let length = match form {
        Form::Value if rest.starts_with('\'') => 1 + text(&rest[1..]).0,
        // `WSTRING#"x"` of IEC 61131-3.
        Form::Value if prefix.eq_ignore_ascii_case("WSTRING") && rest.starts_with('"') => {
            rest[1..].find(['"', '\n']).filter(|end| rest[1 + end..].starts_with('"')).map(|end| end + 2)?
        }
        Form::Value => value(rest),
        Form::Duration => {
            let sign = sign(rest);
            let length = sign + with_points(&rest[sign..], b".");
            length + decimal_comma(&rest[..length], &rest[length..])
        }
        Form::Date => with_points(rest, b"-:."),
        Form::Pointer => return pointer::length(rest, Tail::Separate),
    };
    // Letters such as `T#name` of sources without blanks are not constants.
    let short = prefix.len() == 1 && !rest.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+'));
    if short || length == 0 && rest.starts_with(['"', '#']) { None } else { Some(length) }
}

/// Bytes of `,5s` after the digits of a duration: a fraction with a comma, which `T#1,5s` has in other languages. It is not a constant, but
/// one mistake.
pub fn decimal_comma(duration: &str, rest: &str) -> usize {
    const UNITS: [&str; 7] = ["D", "H", "M", "S", "MS", "US", "NS"];
    let Some(fraction) = rest.strip_prefix(',').filter(|_| duration.ends_with(|c: char| c.is_ascii_digit())) else {
        return 0;
    };
    let length = word(fraction);
    let letters = fraction[..length].trim_start_matches(|c: char| c.is_ascii_digit());
    let unit = UNITS.iter().any(|unit| unit.eq_ignore_ascii_case(letters));
    if unit && letters.len() < length { 1 + length } else { 0 }
}

/// Length of the rest of a word: letters, digits, `_`.
pub fn word(rest: &str) -> usize {
    rest.find(|c: char| !is_word(c)).unwrap_or(rest.len())
}

/// Whether a word may contain the character.
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn sign(rest: &str) -> usize {
    usize::from(rest.starts_with(['-', '+']))
}

/// `16#FF`, `-7`, `1.5e+3`, `TRUE`.
fn value(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let mut at = sign(rest);
    at += word(&rest[at..]);
    if bytes.get(at) == Some(&b'#') {
        at += 1;
        at += sign(&rest[at..]);
        at += word(&rest[at..]);
        return at;
    }
    if bytes.get(at) == Some(&b'.') && bytes.get(at + 1).is_some_and(u8::is_ascii_digit) {
        at += 1;
        at += word(&rest[at..]);
    }
    let exponent = at > 1 && matches!(bytes[at - 1], b'e' | b'E') && bytes[at - 2].is_ascii_digit();
    if exponent && matches!(bytes.get(at), Some(b'+' | b'-')) && bytes.get(at + 1).is_some_and(u8::is_ascii_digit) {
        at += 1;
        at += word(&rest[at..]);
    }
    at
}

/// Words with one of `points` between them, each before a digit.
fn with_points(rest: &str, points: &[u8]) -> usize {
    let bytes = rest.as_bytes();
    let mut at = word(rest);
    while let (Some(point), Some(digit)) = (bytes.get(at), bytes.get(at + 1)) {
        if !points.contains(point) || !digit.is_ascii_digit() {
            break;
        }
        at += 1;
        at += word(&rest[at..]);
    }
    at
}

/// Bytes of a text after its opening quote, and whether it is closed. With `$>` and `$<` it continues after a line end.
pub fn text(rest: &str) -> (usize, bool) {
    let bytes = rest.as_bytes();
    let mut at = 0;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'\'' => return (at + 1, true),
            b'\n' => break,
            b'$' if bytes.get(at + 1) == Some(&b'>') => {
                let inside = &bytes[at..bytes.len().min(at + BREAK_MAX)];
                match inside.windows(2).position(|pair| pair == b"$<") {
                    Some(end) => at += end + 2,
                    None => break,
                }
            }
            b'$' if bytes.get(at + 1).is_some_and(|next| *next != b'\n') => at += 2,
            _ => at += 1,
        }
    }
    // An escape may have skipped the first byte of a longer character.
    while !rest.is_char_boundary(at) {
        at += 1;
    }
    (rest[..at].trim_end_matches('\r').len(), false)
}

/// Bytes of the `.7` that makes an address of `word` and a bit number: `M10.7`, and after a point `DX0.7`.
pub fn bit_number(word: &str, rest: &str, member: bool) -> Option<usize> {
    const AREAS: [&str; 10] = ["I", "E", "Q", "A", "M", "IX", "EX", "QX", "AX", "MX"];
    const MEMBERS: [&str; 3] = ["D", "DX", "DBX"];
    let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let known: &[&str] = if member { &MEMBERS } else { &AREAS };
    let digits = rest.strip_prefix('.')?.bytes().take_while(u8::is_ascii_digit).count();
    let fits = letters.len() < word.len() && digits > 0 && known.iter().any(|area| area.eq_ignore_ascii_case(letters));
    fits.then_some(1 + digits)
}

/// Bytes after `%` and a word that belong to the address: `.7`, `.DBX1.0`, `:P`.
pub fn absolute(letters: &str, numbered: bool, rest: &str) -> usize {
    if !numbered {
        return 0;
    }
    let point = |rest: &str| {
        let digits = rest.strip_prefix('.').map_or(0, |digits| digits.bytes().take_while(u8::is_ascii_digit).count());
        if digits > 0 { 1 + digits } else { 0 }
    };
    let mut at = point(rest);
    if letters.eq_ignore_ascii_case("DB")
        && let Some(member) = rest.strip_prefix('.')
    {
        let name = member.bytes().take_while(u8::is_ascii_alphabetic).count();
        let number = member[name..].bytes().take_while(u8::is_ascii_digit).count();
        let known = address::db_area_word(&member[..name]).is_some();
        if known && number > 0 && word(member) == name + number {
            at = 1 + name + number;
            at += point(&rest[at..]);
        }
    }
    if peripheral(&rest[at..]) { at + 2 } else { at }
}

/// Bytes after the first number of a directly represented variable of IEC 61131-3: `.0.2` of `%QX1.0.2`, `*` of `%QX*`.
pub fn directly_represented(rest: &str) -> usize {
    if rest.starts_with('*') {
        return 1;
    }
    let mut at = 0;
    while let Some(number) = rest[at..].strip_prefix('.') {
        let digits = number.bytes().take_while(u8::is_ascii_digit).count();
        if digits == 0 {
            break;
        }
        at += 1 + digits;
    }
    at
}

/// Whether `:P` follows.
pub fn peripheral(rest: &str) -> bool {
    let bytes = rest.as_bytes();
    matches!(bytes, [b':', b'P' | b'p', ..]) && word(&rest[2..]) == 0
}
