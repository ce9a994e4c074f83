//! The text of an instruction list: its comments, its lines with label, operator and operand, and lists of operands.

use std::ops::Range;

use super::binary;

/// A line: its label, its operator and what follows.
#[derive(Debug)]
pub(super) struct Line {
    pub label: Option<Range<usize>>,
    pub operator: Option<Range<usize>>,
    pub operand: Range<usize>,
}

/// The text with blanks in place of comments.
pub fn without_comments(text: &str) -> String {
    let mut bytes = text.as_bytes().to_vec();
    let mut at = 0;
    while at < bytes.len() {
        let rest = &bytes[at..];
        let end = |close: &[u8]| {
            rest.windows(close.len())
                .skip(2)
                .position(|part| part == close)
                .map_or(rest.len(), |at| at + 2 + close.len())
        };
        let (length, is_comment) = if rest.starts_with(b"(*") {
            (end(b"*)"), true)
        } else if rest.starts_with(b"//") {
            (rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len()), true)
        } else if rest[0] == b'\'' {
            (rest[1..].iter().position(|byte| matches!(byte, b'\'' | b'\n')).map_or(rest.len(), |at| at + 2), false)
        } else {
            (1, false)
        };
        if is_comment {
            bytes[at..at + length].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
        }
        at += length.max(1);
    }
    String::from_utf8(bytes).unwrap_or_else(|_| text.to_string())
}

/// The lines of a text; a list of parameters may extend over several.
pub(super) fn lines(text: &str, start: usize) -> Vec<Line> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let mut end = text[at..].find('\n').map_or(text.len(), |length| at + length);
        let mut line = read_line(&text[at..end]);
        // `CAL Timer(` and functions with formals continue until their parenthesis is closed.
        let joins = line.operator.clone().is_some_and(|range| {
            let word = text[at + range.start..at + range.end].to_ascii_uppercase();
            word.starts_with("CAL") || !is_operator(&word)
        });
        while joins && depth(&text[at..end]) > 0 && end < text.len() {
            end = text[end + 1..].find('\n').map_or(text.len(), |length| end + 1 + length);
            line = read_line(&text[at..end]);
        }
        let moved = |range: Range<usize>| start + at + range.start..start + at + range.end;
        if line.label.is_some() || line.operator.is_some() {
            found.push(Line {
                label: line.label.map(moved),
                operator: line.operator.map(moved),
                operand: moved(line.operand),
            });
        }
        at = end + 1;
    }
    found
}

fn read_line(text: &str) -> Line {
    let skip = |at: usize| at + text[at..].len() - text[at..].trim_start().len();
    let word = |at: usize| at + text[at..].find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len() - at);
    let mut at = skip(0);
    let mut label = None;
    let end = word(at);
    let colon = skip(end);
    if end > at && text[colon..].starts_with(':') && !text[colon..].starts_with(":=") {
        label = Some(at..end);
        at = skip(colon + 1);
    }
    let end = match text[at..].chars().next() {
        Some(')') => at + 1,
        Some('&') => at + 1 + usize::from(text[at + 1..].starts_with(['N', 'n'])),
        _ => word(at).max(at),
    };
    if end == at {
        // The reader of expressions reports text that is not an operator.
        let rest = text[at..].trim_end().len();
        let operator = (rest > 0).then_some(at..at + rest);
        return Line { label, operator, operand: at + rest..at + rest };
    }
    let from = skip(end).min(text.len());
    let operand = from..from + text[from..].trim_end().len();
    Line { label, operator: Some(at..end), operand }
}

fn is_operator(word: &str) -> bool {
    binary(word).is_some() || matches!(word, "LD" | "LDN" | "ST" | "STN" | "S" | "R" | "NOT" | ")" | "RET")
}

fn depth(text: &str) -> i32 {
    text.chars().fold(0, |depth, c| depth + i32::from(c == '(') - i32::from(c == ')'))
}

/// Parts between commas outside parentheses.
pub(super) fn split(text: &str, start: usize) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let (mut depth, mut begin) = (0i32, 0);
    for (at, c) in text.char_indices().chain([(text.len(), ',')]) {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            ',' if depth <= 0 => {
                if !text[begin..at].trim().is_empty() {
                    parts.push(start + begin..start + at);
                }
                begin = at + 1;
            }
            _ => {}
        }
    }
    parts
}
