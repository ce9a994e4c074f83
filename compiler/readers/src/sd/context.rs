//! What the actions of the grammar work with: the text, its tokens, and the messages.

use std::ops::Range;

use lalrpop_util::ErrorRecovery;
use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::token::{Spanned, Tok};
use plcc_syntax::frame;

/// Where a syntax error was recovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Network,
    Rung,
    Argument,
}

/// Context of a parse.
pub struct Context<'a, 't> {
    pub file: FileId,
    pub text: &'a str,
    /// All tokens, for messages.
    pub tokens: &'t [Spanned<'a>],
    pub diagnostics: Vec<Diagnostic>,
    /// Starts of the messages of `classify`, in order: where there is one, the grammar reports nothing.
    pub reported: Vec<u32>,
}

impl<'a> Context<'a, '_> {
    pub fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, start..end.max(start))
    }

    /// Reports a recovered error, unless there is a message within `range`.
    pub fn syntax_error(&mut self, error: ErrorRecovery<usize, Tok<'a>, ()>, place: Place, range: Range<usize>) {
        let found = frame::error_range(&error.error).unwrap_or((range.end, range.end));
        if frame::is_reported(&self.reported, &self.diagnostics, range.start.min(found.0)..range.end.max(found.1)) {
            return;
        }
        let diagnostic = self.message(found.0, place);
        self.diagnostics.push(diagnostic);
    }

    /// The message for the token at byte `found`.
    pub fn message(&self, found: usize, place: Place) -> Diagnostic {
        let (what, help) = match place {
            Place::Network => {
                ("network", "a network contains rungs: `RUNG wire#powerrail Contact( #a ) Coil( #q ) END_RUNG`")
            }
            Place::Rung => {
                ("rung", "a rung contains elements with their pins in parentheses, wires `wire#w1`, and in FBD `NOT`")
            }
            Place::Argument => {
                ("pin", "write `pin := operand` for inputs and `pin => operand` for outputs, separated by `,`")
            }
        };
        let index = self.tokens.partition_point(|(start, ..)| *start < found);
        let (start, end) = match self.tokens.get(index) {
            Some((start, _, end)) => (*start, *end),
            None => self.tokens.last().map_or((0, 0), |(start, _, end)| (*start, *end)),
        };
        let title = match self.text.get(start..end) {
            Some(text) if !text.is_empty() => format!("`{text}` cannot stand here in a {what}"),
            _ => format!("this {what} is not complete"),
        };
        Diagnostic::new(Code::Syntax, self.span(start, end), title).label("not expected here").help(help)
    }
}
