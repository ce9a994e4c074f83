//! A message about a source.

use crate::codes::{Code, Severity};
use crate::source::Span;

/// A place with what stands there.
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
    /// What stands at the place.
    pub primary: Label,
    pub secondary: Vec<Label>,
    /// What to write instead.
    pub help: Option<String>,
    /// Lines that are shown as they stand: a network as a drawing.
    pub note: Option<String>,
    /// Overrides the severity of the code: `check --partial` turns some errors into warnings.
    pub severity: Severity,
}

impl Diagnostic {
    /// A message of `code` at `span`.
    pub fn new(code: Code, span: Span, title: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code,
            title: title.into(),
            primary: Label { span, text: String::new() },
            secondary: Vec::new(),
            help: None,
            note: None,
            severity: code.severity(),
        }
    }

    /// What stands at the primary place.
    pub fn label(mut self, text: impl Into<String>) -> Diagnostic {
        self.primary.text = text.into();
        self
    }

    /// Another place that matters.
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.secondary.push(Label { span, text: text.into() });
        self
    }

    /// What to write.
    pub fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help = Some(text.into());
        self
    }

    /// Lines to show as they stand.
    pub fn note(mut self, text: impl Into<String>) -> Diagnostic {
        self.note = Some(text.into());
        self
    }

    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}
