//! Source files, spans, diagnostic codes and their drawing, for every language.
//!
//! [`drawing`] shows messages to people, [`json`] and [`sarif`] to tools.

mod codes;
mod diagnostic;
pub mod drawing;
pub mod json;
pub mod sarif;
mod source;

pub use codes::{Code, Severity};
pub use diagnostic::{Diagnostic, Label};
pub use source::{FileId, SourceFile, SourceMap, Span};

/// Sorts messages by file and place; at the same place errors come before warnings.
pub fn sort(diagnostics: &mut [Diagnostic]) {
    diagnostics.sort_by_key(|d| (d.primary.span.file, d.primary.span.start, std::cmp::Reverse(d.severity), d.code));
}

/// Maximum number of messages that are written. More would fill the memory, and would not be read.
pub const SHOWN_MAX: usize = 5000;

/// The messages that are written, and the number of the others. With more than [`SHOWN_MAX`], errors go before warnings.
pub fn shown(diagnostics: &[Diagnostic]) -> (Vec<&Diagnostic>, usize) {
    let omitted = diagnostics.len().saturating_sub(SHOWN_MAX);
    let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    let mut room = [(Severity::Error, errors.min(SHOWN_MAX)), (Severity::Warning, SHOWN_MAX.saturating_sub(errors))];
    let mut take = |severity: Severity| {
        room.iter_mut().find(|(own, left)| *own == severity && *left > 0).map(|(_, left)| *left -= 1).is_some()
    };
    let shown = diagnostics.iter().filter(|d| omitted == 0 || take(d.severity)).collect();
    (shown, omitted)
}

/// The line after the messages if some are not written.
pub(crate) fn omitted_text(omitted: usize) -> String {
    format!("... and {omitted} more messages, which are not shown")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100,000 messages on one line.
    #[test]
    fn messages_are_capped() {
        let mut sources = SourceMap::default();
        let file = sources.add(SourceFile::new("x.stl", "A MW 1; ".repeat(50_000)));
        let message = |code, at: usize| Diagnostic::new(code, Span::new(file, at..at + 4), "no");
        let messages: Vec<Diagnostic> = (0..50_000)
            .flat_map(|index| [message(Code::BlockComment, 8 * index), message(Code::OperandKind, 8 * index + 2)])
            .collect();
        let (written, omitted) = shown(&messages);
        assert_eq!((written.len(), omitted), (SHOWN_MAX, 95_000));
        assert!(written.iter().all(|message| message.severity == Severity::Error));
        let more = "... and 95000 more messages";
        let text = drawing::draw(&messages, &sources, false);
        assert!(text.contains(more) && text.len() < 1_000_000, "{}", text.len());
        let lines = json::lines(&messages, &sources);
        assert_eq!(lines.lines().count(), SHOWN_MAX + 1);
        assert!(lines.lines().last().unwrap().contains(more));
        let document: serde_json::Value = serde_json::from_str(&sarif::document(&messages, &sources)).unwrap();
        assert_eq!(document["runs"][0]["results"].as_array().map(Vec::len), Some(SHOWN_MAX));
        let note = &document["runs"][0]["invocations"][0]["toolExecutionNotifications"][0];
        assert!(note["message"]["text"].as_str().unwrap().contains(more));
    }
}
