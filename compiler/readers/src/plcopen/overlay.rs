//! The text of a file in which expressions can be read: entities and markup are replaced, and each byte keeps its position.

use std::collections::HashMap;
use std::ops::Range;

use roxmltree::{Document, Node};

/// Text as long as `text`, in which the bodies in ST and all values can be read as SCL.
pub fn overlay(text: &str, document: &Document) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for node in document.descendants().filter(|node| node.is_element()) {
        let is_value = match node.tag_name().name() {
            // With the elements in it, which are not values of their own.
            "ST" | "IL" => true,
            "xhtml" => !node.ancestors().skip(1).any(|parent| matches!(parent.tag_name().name(), "ST" | "IL")),
            "expression" | "variable" => node.children().all(|child| child.is_text()),
            _ => false,
        };
        if is_value && let Some(range) = content(node) {
            blank_markup(&mut bytes, range.clone());
            decode(&mut bytes[range]);
        }
        if let Some(value) = node.attribute_node("value") {
            decode(&mut bytes[value.range_value()]);
        }
    }
    String::from_utf8(bytes).unwrap_or_else(|_| text.to_string())
}

/// `Color#Red` becomes the number of the value, with blanks up to its length.
pub fn typed_values(text: &mut String, values: &HashMap<String, i64>) {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let signs: Vec<usize> = text.match_indices('#').map(|(at, _)| at).collect();
    for sign in signs {
        let start = text[..sign].trim_end_matches(is_word).len();
        let end = text.len() - text[sign + 1..].trim_start_matches(is_word).len();
        let Some(number) = values.get(&text[start..end].to_ascii_lowercase()).map(i64::to_string) else { continue };
        if number.len() <= end - start {
            text.replace_range(start..end, &format!("{number:width$}", width = end - start));
        }
    }
}

/// The text between the tags of an element.
pub fn content(node: Node) -> Option<Range<usize>> {
    // Not the ranges of its children: a text and the CDATA after it are one child, with the range of the first.
    node.first_child()?;
    let range = node.range();
    let text = node.document().input_text().get(range.clone())?;
    let mut quote = None;
    let close = text.char_indices().find(|(_, c)| match quote {
        Some(open) => {
            quote = quote.filter(|_| *c != open);
            false
        }
        None => {
            quote = Some(*c).filter(|c| matches!(c, '"' | '\''));
            *c == '>'
        }
    })?;
    let (start, end) = (range.start + close.0 + 1, range.start + text.rfind("</")?);
    (start <= end).then_some(start..end)
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

/// `&lt;` becomes `   <`. Entities that follow each other remain together, and so do the two characters of an operator; in a text in quotes
/// nothing is inserted, and blanks come after it.
fn decode(bytes: &mut [u8]) {
    let mut out: Vec<u8> = Vec::with_capacity(bytes.len());
    let mut quote = None;
    // After a `$` in a text, a quote is a character of it.
    let mut is_escaped = false;
    let mut owed = 0;
    let mut at = 0;
    while at < bytes.len() {
        let (text, length) = entity(&bytes[at..]).unwrap_or_else(|| (vec![bytes[at]], 1));
        let free = length - text.len();
        at += length;
        match (quote, text.as_slice()) {
            (None, [c @ (b'\'' | b'"')]) => {
                out.resize(out.len() + free, b' ');
                quote = Some(*c);
                out.push(*c);
            }
            (Some(open), [c]) if *c == open && !is_escaped || *c == b'\n' => {
                // A line end ends a text too: the quote was an apostrophe in a comment.
                let line_end = *c == b'\n';
                if !line_end {
                    out.push(*c);
                }
                out.resize(out.len() + free + std::mem::take(&mut owed), b' ');
                if line_end {
                    out.push(*c);
                }
                (quote, is_escaped) = (None, false);
            }
            (Some(_), text) => {
                out.extend_from_slice(text);
                owed += free;
                is_escaped = text == b"$" && !is_escaped;
            }
            (None, text) if free == 0 => out.extend_from_slice(text),
            (None, text) => {
                let mut text = text.to_vec();
                let mut free = free;
                while let Some((more, length)) =
                    entity(&bytes[at..]).filter(|(more, _)| !matches!(more[..], [b'\'' | b'"']))
                {
                    free += length - more.len();
                    at += length;
                    text.extend(more);
                }
                let after = out.last() == Some(&b'=');
                out.resize(out.len() + if after { 0 } else { free }, b' ');
                out.extend(text);
                out.resize(out.len() + if after { free } else { 0 }, b' ');
            }
        }
    }
    out.resize(bytes.len(), b' ');
    bytes.copy_from_slice(&out);
}

/// The text of an entity, and its length in the file; the text is never longer.
fn entity(bytes: &[u8]) -> Option<(Vec<u8>, usize)> {
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
    (text.len() <= end + 1).then(|| (text.into_bytes(), end + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(body: &str) -> String {
        let text = format!("<project><ST>{body}</ST></project>");
        let document = Document::parse(&text).expect("well-formed");
        let all = overlay(&text, &document);
        assert_eq!(all.len(), text.len());
        all["<project><ST>".len()..text.len() - "</ST></project>".len()].to_string()
    }

    #[test]
    fn entities_are_read_as_what_they_mean() {
        assert_eq!(of("a &lt; b"), "a    < b");
        assert_eq!(of("a &gt;= b"), "a    >= b");
        assert_eq!(of("a &lt;&gt; b"), "a       <> b");
        assert_eq!(of("q =&gt; b"), "q =>    b");
        assert_eq!(of("a &amp; b"), "a     & b");
        assert_eq!(of("x := 'a&amp;b'; y"), "x := 'a&b'    ; y");
        assert_eq!(of("x := &apos;a&lt;b&apos;; y"), "x :=      'a<b'        ; y");
        assert_eq!(of("x := &apos;It$&apos;s&apos;; y := 'b'"), "x :=      'It$'s'          ; y := 'b'");
        assert_eq!(of("x := 'cost $$'; y := &apos;b&apos;"), "x := 'cost $$'; y :=      'b'     ");
        assert_eq!(of("don&apos;t\na &lt; b"), "don     't\na    < b");
    }

    #[test]
    fn markup_is_blank() {
        assert_eq!(of("<![CDATA[a < b]]>"), "         a < b   ");
        assert_eq!(of("<x:p xmlns:x=\"x\"><![CDATA[a < b]]></x:p>").trim(), "a < b");
    }

    #[test]
    fn typed_values_are_numbers() {
        let mut text = "a := Color#Red + color#GREEN; b := Other#Red; c := 16#F;".to_string();
        typed_values(&mut text, &HashMap::from([("color#red".to_string(), 0), ("color#green".to_string(), -12)]));
        assert_eq!(text, "a := 0         + -12        ; b := Other#Red; c := 16#F;");
    }
}
