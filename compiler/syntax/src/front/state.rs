//! What the actions of a grammar work with: the text, its tokens and comments, and the messages.

use std::ops::Range;

use lalrpop_util::{ErrorRecovery, ParseError};
use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::comment::{self, Comment};
use super::cursor::Spanned;

/// A place of a grammar where it recovers from errors, and what it says there.
pub trait Place<T, R>: Copy {
    /// The message for the token at byte `found`.
    fn message(self, state: &ParseState<T, R>, found: usize) -> Diagnostic;
}

/// State of a parse of tokens `T`, with what a notation needs besides, `R`.
pub struct ParseState<'a, T, R = ()> {
    pub file: FileId,
    pub text: &'a str,
    /// All tokens, for messages.
    pub tokens: &'a [Spanned<T>],
    pub comments: &'a [Comment],
    pub diagnostics: Vec<Diagnostic>,
    /// Starts of earlier messages, in order: where there is one, the grammar reports nothing.
    reported: Vec<u32>,
    pub rules: R,
    /// What a program stores values in, for help.
    store: &'static str,
}

impl<'a, T, R> ParseState<'a, T, R> {
    pub fn new(file: FileId, text: &'a str, tokens: &'a [Spanned<T>], rules: R) -> ParseState<'a, T, R> {
        ParseState {
            file,
            text,
            tokens,
            comments: &[],
            diagnostics: Vec::new(),
            reported: Vec::new(),
            rules,
            store: "variable",
        }
    }

    /// The grammar keeps silent where there are messages already.
    pub fn after<'d>(mut self, earlier: impl IntoIterator<Item = &'d Diagnostic>) -> Self {
        self.reported = earlier.into_iter().map(|diagnostic| diagnostic.primary.span.start).collect();
        self.reported.sort_unstable();
        self
    }

    pub fn with_comments(self, comments: &'a [Comment]) -> Self {
        ParseState { comments, ..self }
    }

    /// The program stores values in something else than a variable.
    pub fn storing_in(self, store: &'static str) -> Self {
        ParseState { store, ..self }
    }

    pub fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range.start..range.end.max(range.start))
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Reports a recovered error, unless there is a message within `range`.
    pub fn syntax_error(&mut self, error: ErrorRecovery<usize, T, ()>, place: impl Place<T, R>, range: Range<usize>) {
        let found = error_range(&error.error).unwrap_or((range.end, range.end));
        if self.is_reported(range.start.min(found.0)..range.end.max(found.1)) {
            return;
        }
        let diagnostic = place.message(self, found.0);
        self.report(diagnostic);
    }

    /// Reports an expression with more than `depth_max` operators.
    pub fn too_many_parts(&mut self, span: Span, depth_max: usize) {
        let store = self.store;
        self.report(
            Diagnostic::new(Code::Syntax, Span { end: span.start + 1, ..span }, "this expression has too many parts")
                .label("begins here")
                .help(format!("at most {depth_max} operators may follow one another; store a part of it in a {store}")),
        );
    }

    /// Whether there is a message within `range`: an earlier one, or the last one of the grammar.
    fn is_reported(&self, range: Range<usize>) -> bool {
        let first = self.reported.partition_point(|&reported| (reported as usize) < range.start);
        let inside = |start: u32| (range.start..=range.end).contains(&(start as usize));
        self.reported.get(first).is_some_and(|&start| inside(start))
            || self.diagnostics.last().is_some_and(|last| inside(last.primary.span.start))
    }

    /// Index of the first token that does not begin before byte `found`. Tokens without width come first.
    pub fn index_of(&self, found: usize) -> usize {
        let index = self.tokens.partition_point(|(start, ..)| *start < found);
        // Declarations among statements were moved to where they belong: these tokens are in another order.
        match self.tokens.get(index) {
            Some((start, ..)) if *start != found => {
                self.tokens.iter().position(|(start, ..)| *start == found).unwrap_or(index)
            }
            _ => index,
        }
    }

    /// The message for a token that is not expected in `what`: the one at `at`, which follows the one at `before`, or which begins it.
    /// Without `at`, `what` ends too early, after `last`.
    pub fn misplaced(
        &self,
        code: Code,
        what: &str,
        at: Option<Range<usize>>,
        before: Option<Range<usize>>,
        last: Range<usize>,
    ) -> Diagnostic {
        let slice = |range: Range<usize>| self.text.get(range).unwrap_or_default();
        let Some(at) = at else {
            return Diagnostic::new(code, self.span(last), format!("this {what} is not complete"))
                .label("something is missing after this");
        };
        let text = slice(at.clone());
        let title = match before {
            Some(before) => format!("`{text}` cannot follow `{}` in this {what}", slice(before)),
            None => format!("`{text}` cannot begin this {what}"),
        };
        Diagnostic::new(code, self.span(at), title).label("not expected here")
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

/// Bytes of the token at which a parse error was found.
pub fn error_range<T>(error: &ParseError<usize, T, ()>) -> Option<(usize, usize)> {
    match error {
        ParseError::UnrecognizedToken { token, .. } | ParseError::ExtraToken { token } => Some((token.0, token.2)),
        ParseError::UnrecognizedEof { location, .. } | ParseError::InvalidToken { location } => {
            Some((*location, *location))
        }
        ParseError::User { .. } => None,
    }
}
