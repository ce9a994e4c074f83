//! A message about a source.

use crate::codes::{Code, Severity};
use crate::source::Span;

/// A place with a note about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    pub span: Span,
    pub text: String,
}

/// A message: what is wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    pub code: Code,
    /// What is wrong, in the user's words.
    pub title: String,
    /// The note at the place.
    pub primary: Label,
    pub secondary: Vec<Label>,
    /// What to write instead.
    pub help: Option<String>,
    /// Lines that are shown unchanged: a network as a drawing.
    pub note: Option<String>,
    /// Overrides the severity of the code: `check --partial` turns some errors into warnings.
    pub severity: Severity,
}

/// Maximum bytes of a title or label, which may quote the source.
const TEXT_MAX: usize = 1000;
/// Maximum bytes of a help text, which may list names.
const HELP_MAX: usize = 30_000;

/// The text; `…` replaces the part that is too long.
fn cut(mut text: String, most: usize) -> String {
    if text.len() > most {
        let end = (0..=most).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
        text.truncate(end);
        text.push('…');
    }
    text
}

impl Diagnostic {
    /// A message of `code` at `span`.
    pub fn new(code: Code, span: Span, title: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code,
            title: cut(title.into(), TEXT_MAX),
            primary: Label { span, text: String::new() },
            secondary: Vec::new(),
            help: None,
            note: None,
            severity: code.severity(),
        }
    }

    /// Sets the note at the primary place.
    pub fn label(mut self, text: impl Into<String>) -> Diagnostic {
        self.primary.text = cut(text.into(), TEXT_MAX);
        self
    }

    /// Adds another place that matters.
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.secondary.push(Label { span, text: cut(text.into(), TEXT_MAX) });
        self
    }

    /// Adds what to write instead.
    pub fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help = Some(cut(text.into(), HELP_MAX));
        self
    }

    /// Adds lines to show unchanged.
    pub fn note(mut self, text: impl Into<String>) -> Diagnostic {
        self.note = Some(text.into());
        self
    }

    /// True of an error, false of a warning.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FileId;

    #[test]
    fn quotations_are_cut() {
        let span = Span::new(FileId(0), 0..1);
        let message =
            Diagnostic::new(Code::Syntax, span, "ä".repeat(100_000)).label("x".repeat(1000)).help("y".repeat(99_999));
        assert_eq!((message.title.chars().count(), message.title.ends_with('…')), (501, true));
        assert_eq!(message.primary.text.len(), 1000);
        assert_eq!(message.help.map(|help| help.len()), Some(30_003));
    }
}
