//! `{ … }` in structured text: attributes of editors, which have no effect, and code in other languages, which plcc cannot compile.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::editor::Editor;

/// Words that begin a pragma without an effect on what the program computes.
const HARMLESS: &[&str] = &[
    "attribute",
    "region",
    "endregion",
    "end_region",
    "warning",
    "text",
    "info",
    "analysis",
    "nowarn",
    "flag",
    "s",
    "w",
];

/// Replaces all pragmas of a part of the text with blanks. Pragmas with an effect are reported.
pub fn clear(file: FileId, editor: Editor, text: &mut String, range: Range<usize>, messages: &mut Vec<Diagnostic>) {
    let Some(part) = text.get(range.clone()).filter(|part| part.contains('{')) else { return };
    let found = pragmas(part, editor.nests_comments());
    for pragma in found {
        let place = range.start + pragma.start..range.start + pragma.end;
        let written = text.get(place.clone()).unwrap_or_default();
        let inner = written.trim_matches(['{', '}', ' ', '\t', '\r', '\n']);
        let word: String = inner.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let code = written.starts_with("{{") || editor == Editor::Matiec;
        if (code || !HARMLESS.contains(&word.to_ascii_lowercase().as_str())) && !inner.is_empty() {
            let line = place.start..place.start + written.find('\n').unwrap_or(written.len());
            let span = Span::new(file, line);
            let message = match code {
                true => Diagnostic::new(Code::ForeignContent, span, "plcc does not read code in C")
                    .label("nothing is compiled in its place")
                    .help(
                        "write it in ST; the compiler of the editor passes the text between braces to its C compiler",
                    ),
                false => Diagnostic::new(Code::ForeignContent, span, format!("plcc does not know the pragma `{word}`"))
                    .label("may change what is compiled")
                    .help("remove it if it has no effect on the program"),
            };
            messages.push(message);
        }
        let blank: String = written
            .chars()
            .flat_map(|c| match c {
                '\n' => vec!['\n'],
                c => vec![' '; c.len_utf8()],
            })
            .collect();
        text.replace_range(place, &blank);
    }
}

/// The positions of `{ … }` and `{{ … }}` outside comments and texts.
fn pragmas(text: &str, nested_comments: bool) -> Vec<Range<usize>> {
    let bytes = text.as_bytes();
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let rest = &text.as_bytes()[at..];
        if rest.starts_with(b"(*") {
            at += comment(rest, nested_comments);
        } else if rest.starts_with(b"/*") {
            at += end_of(rest, b"*/");
        } else if rest.starts_with(b"//") {
            at += rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        } else if let quote @ (b'\'' | b'"') = rest[0] {
            at += quoted(rest, quote);
        } else if rest.starts_with(b"{{") {
            let end = at + end_of(rest, b"}}");
            found.push(at..end);
            at = end;
        } else if rest[0] == b'{' {
            let end = at + braces(rest);
            found.push(at..end);
            at = end;
        } else {
            at += 1;
        }
    }
    found
}

fn end_of(bytes: &[u8], close: &[u8]) -> usize {
    bytes.windows(close.len()).skip(2).position(|part| part == close).map_or(bytes.len(), |at| at + 2 + close.len())
}

/// Bytes of a comment; if inner ones are not closed, up to its first end.
fn comment(bytes: &[u8], nested: bool) -> usize {
    let (mut at, mut depth) = (2, 1);
    while nested && at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"*)" if depth == 1 => return at + 2,
            b"*)" => (at, depth) = (at + 2, depth - 1),
            b"(*" => (at, depth) = (at + 2, depth + 1),
            _ => at += 1,
        }
    }
    end_of(bytes, b"*)")
}

/// Bytes of a text, which ends on its line.
fn quoted(bytes: &[u8], quote: u8) -> usize {
    let mut at = 1;
    while at < bytes.len() {
        match bytes[at] {
            b'$' => at += 2,
            byte if byte == quote => return at + 1,
            b'\n' => return at,
            _ => at += 1,
        }
    }
    bytes.len()
}

/// Bytes of a pragma with the texts and braces in it.
fn braces(bytes: &[u8]) -> usize {
    let (mut at, mut depth) = (0, 0);
    while at < bytes.len() {
        match bytes[at] {
            b'{' => depth += 1,
            b'}' if depth == 1 => return at + 1,
            b'}' => depth -= 1,
            _ => {}
        }
        at += 1;
    }
    bytes.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cleared(editor: Editor, text: &str) -> (String, usize) {
        let (mut text, mut messages) = (text.to_string(), Vec::new());
        let range = 0..text.len();
        clear(FileId(0), editor, &mut text, range, &mut messages);
        (text, messages.len())
    }

    #[test]
    fn attributes_are_left_out_and_code_is_told() {
        assert_eq!(cleared(Editor::Codesys, "{attribute 'x'} a := 1;"), ("                a := 1;".to_string(), 0));
        assert_eq!(cleared(Editor::Codesys, "{IF defined (x)} a := 1;").1, 1);
        assert_eq!(cleared(Editor::Codesys, "{{ GLOBALS = 1; }} a := 1;").1, 1);
        assert_eq!(cleared(Editor::Matiec, "{ int x; if (x) { x++; } }\na := 1;").1, 1);
        assert_eq!(cleared(Editor::Other, "(* {x} *) a := '{y}'; // {z}\n").1, 0);
    }
}
