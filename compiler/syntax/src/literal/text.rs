//! Texts in `'`.

use super::LiteralError;

/// Bytes of `'text'`, quotes included in `text`, with escapes expanded.
///
/// Escapes: `$$ $' $L $N $P $R $T $hh`. `$N` and `$L` are a line feed, as in IEC 61131-3.
/// Errors: `BadLiteral` for any other escape or a character that Windows-1252 does not have.
pub fn parse_text(text: &str) -> Result<Vec<u8>, LiteralError> {
    let inner = text.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\''));
    let Some(inner) = inner else {
        return Err(LiteralError::malformed(text, "not a text", "write a text in single quotes: `'ABCD'`"));
    };
    let mut bytes = Vec::with_capacity(inner.len());
    let mut chars = inner.chars();
    while let Some(c) = chars.next() {
        if c != '$' {
            bytes.push(windows_1252(c).ok_or_else(|| {
                LiteralError::malformed(
                    text,
                    format!("`{c}` is not in the Windows-1252 code page"),
                    "a CHAR is one byte; write the byte as `$hh` with two hexadecimal digits",
                )
            })?);
            continue;
        }
        let escape = chars.next();
        let byte = match escape {
            Some('$') => b'$',
            Some('\'') => b'\'',
            Some('"') => b'"',
            Some('L' | 'l' | 'N' | 'n') => 10,
            Some('P' | 'p') => 12,
            Some('R' | 'r') => 13,
            Some('T' | 't') => 9,
            Some(high) => {
                let low = chars.next();
                match (high.to_digit(16), low.and_then(|low| low.to_digit(16))) {
                    (Some(high), Some(low)) => (high << 4 | low) as u8,
                    _ => return Err(bad_escape(text, high)),
                }
            }
            None => return Err(bad_escape(text, '\'')),
        };
        bytes.push(byte);
    }
    Ok(bytes)
}

fn bad_escape(text: &str, c: char) -> LiteralError {
    LiteralError::malformed(
        text,
        format!("`${c}` is not an escape"),
        "escapes are `$$ $' $L $N $P $R $T` and `$hh` with two hexadecimal digits",
    )
}

/// The byte of `c` in Windows-1252; bytes without a character keep their number.
pub fn windows_1252(c: char) -> Option<u8> {
    if c.is_ascii() {
        return Some(c as u8);
    }
    let mut buffer = [0; 4];
    let (bytes, _, unmappable) = encoding_rs::WINDOWS_1252.encode(c.encode_utf8(&mut buffer));
    if unmappable { None } else { bytes.first().copied() }
}
