//! Texts and characters.

use std::borrow::Cow;

use crate::elementary::Elementary;
use crate::literal::{LiteralError, parse_text};
use crate::scl::ast::Literal;
use crate::scl::literal::number;

/// Bytes of `'text'`, with escapes expanded and breaks (`$>` … `$<`) taken out.
pub fn string(text: &str, value: &str) -> Result<Vec<u8>, LiteralError> {
    match without_breaks(value) {
        Cow::Borrowed(value) if value.len() == text.len() => parse_text(value),
        value => parse_text(&value).map_err(|error| LiteralError { title: titled(text), ..error }),
    }
}

fn titled(text: &str) -> String {
    format!("`{text}` is not a constant as STEP 7 writes it")
}

fn without_breaks(value: &str) -> Cow<'_, str> {
    if !value.contains("$>") {
        return Cow::Borrowed(value);
    }
    let mut out = String::with_capacity(value.len());
    let mut rest = value;
    while let Some(at) = rest.find('$') {
        let (before, escape) = rest.split_at(at);
        out.push_str(before);
        rest = match escape.strip_prefix("$>") {
            Some(inside) => inside.split_once("$<").map_or("", |(_, after)| after),
            None => {
                let length = escape.chars().take(2).map(char::len_utf8).sum();
                out.push_str(&escape[..length]);
                &escape[length..]
            }
        };
    }
    out.push_str(rest);
    Cow::Owned(out)
}

/// Code units of `WSTRING#'text'`. Escapes are those of STRING, numbers have four hexadecimal digits.
pub fn wide(text: &str, value: &str) -> Result<Vec<u16>, LiteralError> {
    let between = |quote: char| value.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote));
    let inner = between('\'').or_else(|| between('"')).ok_or_else(|| {
        LiteralError::malformed(text, "not a text", "write a text in single quotes: `WSTRING#'ABCD'`")
    })?;
    let mut units = Vec::with_capacity(inner.len());
    let mut chars = inner.chars();
    while let Some(c) = chars.next() {
        if c != '$' {
            units.extend_from_slice(c.encode_utf16(&mut [0; 2]));
            continue;
        }
        let escape = chars.next();
        let unit = match escape {
            Some(sign @ ('$' | '\'' | '"')) => sign as u16,
            Some('L' | 'l' | 'N' | 'n') => 10,
            Some('P' | 'p') => 12,
            Some('R' | 'r') => 13,
            Some('T' | 't') => 9,
            Some('>') => {
                let rest = chars.as_str();
                chars = rest.split_once("$<").map_or("", |(_, after)| after).chars();
                continue;
            }
            first => {
                let digits: String = first.into_iter().chain(chars.by_ref().take(3)).collect();
                u16::from_str_radix(&digits, 16).ok().filter(|_| digits.len() == 4).ok_or_else(|| {
                    LiteralError::malformed(
                        text,
                        format!("`${digits}` is not an escape"),
                        "escapes are `$$ $' $L $N $P $R $T` and `$hhhh` with four hexadecimal digits",
                    )
                })?
            }
        };
        units.push(unit);
    }
    Ok(units)
}

/// `CHAR#'A'`, `CHAR#65`, `WCHAR#'A'`.
pub fn character(text: &str, prefix: &str, value: &str) -> Result<Literal, LiteralError> {
    let ty = if prefix == "CHAR" { Elementary::Char } else { Elementary::Wchar };
    if !value.starts_with('\'') {
        return number::typed(text, ty, value).map(|read| read.value);
    }
    let bits = if ty == Elementary::Char {
        match *string(text, value)? {
            [byte] => Some(byte.into()),
            _ => None,
        }
    } else {
        match *wide(text, value)? {
            [unit] => Some(unit.into()),
            _ => None,
        }
    };
    let bits =
        bits.ok_or_else(|| LiteralError::malformed(text, "not one character", format!("write `{prefix}#'A'`")))?;
    Ok(Literal::Typed { ty, bits })
}
