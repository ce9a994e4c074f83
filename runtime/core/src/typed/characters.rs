//! Characters and texts between quotes, with their escapes.

use plcc_abi::image::AssertType;

use super::ValueType;
use crate::assertion::{Value, windows_1252};

/// Text between quotes, after a prefix such as `STRING#` or without one; a text without quotes is itself.
pub(super) fn characters(text: &str, wanted: ValueType) -> Result<Value, String> {
    let upper = text.to_ascii_uppercase();
    let bare = ["STRING#", "WSTRING#"]
        .iter()
        .find(|prefix| upper.starts_with(**prefix))
        .map_or(text, |prefix| &text[prefix.len()..]);
    let mut characters = match quoted(bare) {
        Some(inner) => expanded(inner, wanted.ty).map_err(|why| format!("`{text}` is not a text: {why}"))?,
        None => bare.encode_utf16().collect(),
    };
    if characters.len() > usize::from(wanted.length) {
        return Err(format!("`{text}` has {} characters; there is room for {}", characters.len(), wanted.length));
    }
    if wanted.ty == AssertType::Text {
        for unit in &mut characters {
            let byte = crate::assertion::byte_of(*unit);
            *unit = byte
                .ok_or_else(|| format!("`{text}` has a character that is not in the code page Windows-1252"))?
                .into();
        }
    }
    Ok(Value::Text(characters))
}

pub(super) fn quoted(text: &str) -> Option<&str> {
    text.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\''))
}

/// What is between the quotes of a literal, with its escapes expanded: `$$ $' $L $N $P $R $T`, and `$` with a code of two hexadecimal digits, of
/// four in WSTRING and WCHAR. `Err`: the wrong escape.
pub(super) fn expanded(inner: &str, ty: AssertType) -> Result<Vec<u16>, String> {
    let is_wide = matches!(ty, AssertType::WideText | AssertType::Wchar);
    let digits = if is_wide { 4 } else { 2 };
    let mut expanded = Vec::with_capacity(inner.len());
    let mut rest = inner;
    while let Some((plain, escape)) = rest.split_once('$') {
        expanded.extend(plain.encode_utf16());
        let sign = escape.chars().next();
        let (unit, length) = match sign {
            Some(sign @ ('$' | '\'' | '"')) => (sign as u16, 1),
            Some('L' | 'l' | 'N' | 'n') => (10, 1),
            Some('P' | 'p') => (12, 1),
            Some('R' | 'r') => (13, 1),
            Some('T' | 't') => (9, 1),
            _ => {
                let code = escape.get(..digits).filter(|code| code.bytes().all(|digit| digit.is_ascii_hexdigit()));
                let code = code.and_then(|code| u16::from_str_radix(code, 16).ok());
                let sign = sign.map_or_else(String::new, String::from);
                let code = code.ok_or_else(|| format!("`${sign}` is not an escape; `$$` is a dollar sign"))?;
                (if is_wide { code } else { windows_1252(code) }, digits)
            }
        };
        expanded.push(unit);
        rest = &escape[length..];
    }
    expanded.extend(rest.encode_utf16());
    Ok(expanded)
}
