//! The text of a file with its expressions as they mean: entities and markup in them replaced, each byte at its place.

use std::ops::Range;

use roxmltree::{Document, Node};

/// Text as long as `text`, in which the bodies in ST and all values can be read as SCL.
pub fn overlay(text: &str, document: &Document) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for node in document.descendants().filter(|node| node.is_element()) {
        if matches!(node.tag_name().name(), "xhtml" | "ST" | "expression" | "variable")
            && let Some(range) = content(node)
            && (node.tag_name().name() == "xhtml" || node.children().all(|child| child.is_text()))
        {
            blank_markup(&mut bytes, range);
        }
    }
    decode_entities(&mut bytes);
    addresses(&mut bytes);
    String::from_utf8(bytes).unwrap_or_else(|_| text.to_string())
}

/// What stands between the tags of an element.
pub fn content(node: Node) -> Option<Range<usize>> {
    let (first, last) = (node.first_child()?, node.last_child()?);
    // The range of a text in CDATA leaves its markers out.
    let range = first.range().start..last.range().end;
    (range.start <= range.end).then_some(range)
}

fn blank(bytes: &mut [u8]) {
    bytes.iter_mut().filter(|byte| !matches!(**byte, b'\n' | b'\r')).for_each(|byte| *byte = b' ');
}

fn find(bytes: &[u8], from: usize, end: usize, what: &[u8]) -> usize {
    bytes[from..end].windows(what.len()).position(|part| part == what).map_or(end, |at| from + at + what.len())
}

/// Tags, comments and the markers of CDATA become blanks.
fn blank_markup(bytes: &mut [u8], range: Range<usize>) {
    const CDATA: &[u8] = b"<![CDATA[";
    let end = range.end.min(bytes.len());
    let mut at = range.start;
    while at < end {
        if bytes[at..end].starts_with(CDATA) {
            let close = find(bytes, at, end, b"]]>");
            blank(&mut bytes[at..at + CDATA.len()]);
            blank(&mut bytes[close.saturating_sub(3).max(at)..close]);
            at = close;
        } else if bytes[at] == b'<' {
            let close = if bytes[at..end].starts_with(b"<!--") {
                find(bytes, at, end, b"-->")
            } else {
                find(bytes, at, end, b">")
            };
            blank(&mut bytes[at..close]);
            at = close;
        } else {
            at += 1;
        }
    }
}

/// `&lt;` becomes `   <`; entities that follow each other stay together, and so do the two characters of an operator.
fn decode_entities(bytes: &mut [u8]) {
    let mut at = 0;
    while at < bytes.len() {
        if bytes[at] != b'&' {
            at += 1;
            continue;
        }
        let start = at;
        let mut decoded = Vec::new();
        while let Some((text, length)) = entity(&bytes[at..]) {
            decoded.extend_from_slice(text.as_bytes());
            at += length;
        }
        if decoded.is_empty() {
            at += 1;
            continue;
        }
        let free = at - start - decoded.len().min(at - start);
        let left = if start > 0 && bytes[start - 1] == b'=' { 0 } else { free };
        bytes[start..at].fill(b' ');
        bytes[start + left..start + left + decoded.len()].copy_from_slice(&decoded);
    }
}

/// The text of an entity, and its length in the file; the text is never longer.
fn entity(bytes: &[u8]) -> Option<(String, usize)> {
    if bytes.first() != Some(&b'&') {
        return None;
    }
    let end = bytes.iter().take(12).position(|byte| *byte == b';')?;
    let name = std::str::from_utf8(&bytes[1..end]).ok()?;
    let text = match name {
        "lt" => "<".to_string(),
        "gt" => ">".to_string(),
        "amp" => "&".to_string(),
        "quot" => "\"".to_string(),
        "apos" => "'".to_string(),
        _ => {
            let digits = name.strip_prefix('#')?;
            let code = match digits.strip_prefix(['x', 'X']) {
                Some(digits) => u32::from_str_radix(digits, 16).ok()?,
                None => digits.parse().ok()?,
            };
            char::from_u32(code)?.to_string()
        }
    };
    (text.len() <= end + 1).then_some((text, end + 1))
}

/// `%IX0.0` becomes ` %I0.0`.
fn addresses(bytes: &mut [u8]) {
    for at in 0..bytes.len().saturating_sub(3) {
        if bytes[at] == b'%'
            && matches!(bytes[at + 1], b'I' | b'Q' | b'M' | b'i' | b'q' | b'm')
            && matches!(bytes[at + 2], b'X' | b'x')
            && bytes[at + 3].is_ascii_digit()
        {
            (bytes[at + 2], bytes[at + 1], bytes[at]) = (bytes[at + 1], b'%', b' ');
        }
    }
}
