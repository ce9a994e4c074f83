//! Bytes of a source file to text.

/// Text of a file: by its byte order mark, else UTF-8 if it is that, else Windows-1252.
///
/// STEP 7 writes Windows-1252, newer tools UTF-8. Bytes that Windows-1252 leaves open keep their number as a character.
pub fn decode(bytes: &[u8]) -> String {
    let text = decode_bytes(bytes);
    match has_lone_returns(&text) {
        true => lines_of_returns(&text),
        false => text,
    }
}

/// Whether a carriage return stands before neither a line feed nor another one.
fn has_lone_returns(text: &str) -> bool {
    let bytes = text.as_bytes();
    let lone = |at: &usize| bytes[*at] == b'\r' && !matches!(bytes.get(at + 1), Some(b'\n' | b'\r'));
    (0..bytes.len()).any(|at| lone(&at))
}

/// Lone carriage returns end lines in files of old editors: they become line feeds, at the same bytes.
fn lines_of_returns(text: &str) -> String {
    let mut rest = text.chars().peekable();
    let mut lines = String::with_capacity(text.len());
    while let Some(c) = rest.next() {
        let lone = c == '\r' && !matches!(rest.peek(), Some('\n' | '\r'));
        lines.push(if lone { '\n' } else { c });
    }
    lines
}

fn decode_bytes(bytes: &[u8]) -> String {
    if let Some((encoding, length)) = encoding_rs::Encoding::for_bom(bytes) {
        return encoding.decode_without_bom_handling(&bytes[length..]).0.into_owned();
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes).0.into_owned(),
    }
}
