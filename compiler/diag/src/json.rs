//! Messages for tools: one JSON object per line.

use serde::Serialize;

use crate::diagnostic::{Diagnostic, Label};
use crate::drawing::severity_word;
use crate::source::SourceMap;

/// A message with everything that the drawing shows. Lines and columns count from 1, columns in characters.
#[derive(Serialize)]
struct Message<'a> {
    code: &'static str,
    severity: &'static str,
    title: &'a str,
    #[serde(flatten)]
    place: Place<'a>,
    secondary: Vec<Place<'a>>,
    help: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<&'a str>,
}

#[derive(Serialize)]
struct Place<'a> {
    file: &'a str,
    line: u32,
    column: u32,
    end_line: u32,
    end_column: u32,
    label: &'a str,
}

/// `diagnostics` as JSON objects, one per line. Of more than [`SHOWN_MAX`](crate::SHOWN_MAX), the last object has the number of the
/// others, and no place.
pub fn lines(diagnostics: &[Diagnostic], sources: &SourceMap) -> String {
    let (shown, omitted) = crate::shown(diagnostics);
    let mut lines: String = shown.into_iter().map(|diagnostic| line(diagnostic, sources) + "\n").collect();
    if omitted > 0 {
        let title = crate::omitted_text(omitted);
        lines.push_str(&serde_json::json!({ "severity": "warning", "title": title, "omitted": omitted }).to_string());
        lines.push('\n');
    }
    lines
}

fn line(diagnostic: &Diagnostic, sources: &SourceMap) -> String {
    let message = Message {
        code: diagnostic.code.name(),
        severity: severity_word(diagnostic.severity),
        title: &diagnostic.title,
        place: place(&diagnostic.primary, sources),
        secondary: diagnostic.secondary.iter().map(|label| place(label, sources)).collect(),
        help: diagnostic.help.as_deref(),
        note: diagnostic.note.as_deref(),
    };
    serde_json::to_string(&message).expect("a structure of texts and numbers is JSON")
}

fn place<'a>(label: &'a Label, sources: &'a SourceMap) -> Place<'a> {
    let file = sources.file(label.span.file);
    let (line, column) = file.line_column(label.span.start);
    let (end_line, end_column) = file.line_column(label.span.end);
    Place { file: &file.name, line, column, end_line, end_column, label: &label.text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Code, SourceFile, Span};

    #[test]
    fn one_object_a_line() {
        let mut sources = SourceMap::default();
        let file = sources.add(SourceFile::new("x.stl", "A I 0.0\nÄ MW 1\n"));
        let message =
            Diagnostic::new(Code::OperandKind, Span::new(file, 11..15), "no").also(Span::new(file, 0..1), "here");
        let text = lines(&[message.clone(), message], &sources);
        assert_eq!(text.lines().count(), 2);
        let value: serde_json::Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
        assert_eq!(value["code"], "P0203");
        assert_eq!((value["line"].as_u64(), value["column"].as_u64()), (Some(2), Some(3)));
        assert_eq!(value["secondary"][0]["label"], "here");
    }
}
