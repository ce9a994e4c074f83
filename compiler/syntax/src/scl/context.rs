//! What the actions of the grammar work with: the text, its comments, and the messages.

use std::ops::Range;

use lalrpop_util::ErrorRecovery;
use plcc_diag::{Diagnostic, FileId, Span};

use super::ast::{Dialect, Name, NameForm};
use super::messages;
use super::token::{Spanned, Tok};
use crate::comment::{self, Comment};
use crate::frame;

/// Where a syntax error was recovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Block,
    Declaration,
    Constant,
    Labels,
    Assignment,
    Statement,
    Condition,
    For,
    CaseValue,
    Argument,
}

/// Context of a parse.
pub struct Context<'a> {
    pub file: FileId,
    pub text: &'a str,
    /// All tokens, for messages.
    pub tokens: &'a [Spanned<'a>],
    pub comments: &'a [Comment],
    pub diagnostics: Vec<Diagnostic>,
    /// Starts of the messages of `classify`, in order: where there is one, the grammar reports nothing.
    pub reported: Vec<u32>,
    pub dialect: Dialect,
}

impl<'a> Context<'a> {
    pub fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, start..end.max(start))
    }

    pub fn name(&self, text: &str, form: NameForm, start: usize, end: usize) -> Name {
        // Of `"tag":P` the letter stays.
        let text = if form == NameForm::Quoted { text.replace('"', "") } else { text.to_owned() };
        Name { text, form, span: self.span(start, end) }
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Reports a recovered error, unless `classify` has reported one within `range`.
    pub fn syntax_error(&mut self, error: ErrorRecovery<usize, Tok<'a>, ()>, place: Place, range: Range<usize>) {
        let found = frame::error_range(&error.error).unwrap_or((range.end, range.end));
        if frame::is_reported(&self.reported, &self.diagnostics, range.start.min(found.0)..range.end.max(found.1)) {
            return;
        }
        let diagnostic = messages::syntax_error(self, found.0, place);
        self.diagnostics.push(diagnostic);
    }

    /// Comments between the bytes that have their own line, without `//`.
    pub fn comment_lines(&self, range: Range<usize>) -> Vec<String> {
        comment::lines(self.text, self.comments, range)
    }

    /// The comment after byte `end`, on the same line.
    pub fn comment_after(&self, end: usize) -> Option<String> {
        comment::after(self.text, self.comments, end)
    }
}
