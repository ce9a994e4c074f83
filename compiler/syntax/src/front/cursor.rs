//! A place in the raw tokens of a text, and the tokens of the grammar that were made so far.

use std::fmt::{Debug, Write as _};

use plcc_diag::{Diagnostic, FileId, Span};

use super::comment::Comment;
use super::pragma;
use super::scan::RawToken;
use crate::ast::Pragma;

/// A token of a grammar with its first byte and the byte after it.
pub type Spanned<T> = (usize, T, usize);

/// What classifying a text gives.
pub struct Classified<T> {
    pub tokens: Vec<Spanned<T>>,
    pub diagnostics: Vec<Diagnostic>,
    /// Pragmas that are outside code.
    pub pragmas: Vec<Pragma>,
}

impl<T: Clone> Classified<T> {
    /// The tokens as a parser of lalrpop takes them.
    pub fn stream(&self) -> impl Iterator<Item = Result<Spanned<T>, ()>> {
        self.tokens.iter().map(|token| Ok(token.clone()))
    }
}

/// Reads raw tokens of kinds `K` with keywords `W`, and makes tokens `T` of a grammar.
pub struct Cursor<'a, 'r, K, W, T> {
    pub file: FileId,
    pub text: &'a str,
    pub raw: &'r [RawToken<K, W>],
    /// Index of the next raw token.
    pub at: usize,
    pub out: Vec<Spanned<T>>,
    pub diagnostics: Vec<Diagnostic>,
    /// Pragmas that are outside code.
    pub pragmas: Vec<Pragma>,
    /// Comments that may be pragmas; none if pragmas are not read.
    pub(super) comments: &'r [Comment],
    /// Index of the next comment that may be a pragma.
    pub(super) next_comment: usize,
}

impl<'a, 'r, K: Copy + PartialEq, W: Copy, T> Cursor<'a, 'r, K, W, T> {
    /// A cursor before the first raw token. `comments`: those that may be pragmas.
    pub fn new(file: FileId, text: &'a str, raw: &'r [RawToken<K, W>], comments: &'r [Comment]) -> Self {
        Cursor {
            file,
            text,
            raw,
            at: 0,
            out: Vec::with_capacity(raw.len() + raw.len() / 4),
            diagnostics: Vec::new(),
            pragmas: Vec::new(),
            comments,
            next_comment: 0,
        }
    }

    pub fn finish(mut self) -> Classified<T> {
        let (file, text) = (self.file, self.text);
        self.diagnostics.extend(self.comments.iter().filter_map(|comment| pragma::nearly(file, text, *comment)));
        Classified { tokens: self.out, diagnostics: self.diagnostics, pragmas: self.pragmas }
    }

    // Raw tokens.

    pub fn peek(&self) -> Option<RawToken<K, W>> {
        self.raw_at(self.at)
    }

    pub fn raw_at(&self, index: usize) -> Option<RawToken<K, W>> {
        self.raw.get(index).copied()
    }

    pub fn kind_at(&self, index: usize) -> Option<K> {
        self.raw.get(index).map(|token| token.kind)
    }

    /// Whether the next raw token is of the kind.
    pub fn is_at(&self, kind: K) -> bool {
        self.kind_at(self.at) == Some(kind)
    }

    /// Whether nothing is between the tokens at `index` and `index + 1`.
    pub fn adjacent(&self, index: usize) -> bool {
        match (self.raw.get(index), self.raw.get(index + 1)) {
            (Some(token), Some(next)) => token.end == next.start,
            _ => false,
        }
    }

    pub fn slice(&self, token: RawToken<K, W>) -> &'a str {
        token.text(self.text)
    }

    pub fn span(&self, token: RawToken<K, W>) -> Span {
        Span { file: self.file, start: token.start, end: token.end }
    }

    pub fn span_of(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, start..end)
    }

    /// The last raw token before the next one.
    pub fn last_token(&self) -> Option<RawToken<K, W>> {
        self.at.checked_sub(1).map(|before| self.raw[before])
    }

    /// The end of the last raw token before the next one.
    pub fn last_end(&self) -> usize {
        self.last_token().map_or(0, |before| before.end as usize)
    }

    // Tokens of the grammar.

    pub fn push(&mut self, start: usize, token: T, end: usize) {
        self.out.push((start, token, end));
    }

    /// Pushes `token` for the next raw token and advances.
    pub fn take(&mut self, token: T) {
        self.take_up_to(token, self.at + 1);
    }

    /// Pushes `token` for the raw tokens from the next one to index `after`, exclusive, and advances to it.
    pub fn take_up_to(&mut self, token: T, after: usize) {
        let (start, end) = (self.raw[self.at].start, self.raw[after - 1].end);
        self.push(start as usize, token, end as usize);
        self.at = after;
    }

    /// Pushes a token of no width after what has been read.
    pub fn push_here(&mut self, token: T) {
        let end = self.last_end();
        self.push(end, token, end);
    }

    /// The last token that was pushed.
    pub fn last(&self) -> Option<&T> {
        self.out.last().map(|(_, token, _)| token)
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}

/// Lets a classifier with a field `cursor` be used as its cursor, of raw tokens `$kind` with `$keyword` and tokens `$token`.
#[macro_export]
macro_rules! moves_cursor {
    ($classifier:ident, $kind:ty, $keyword:ty, $token:ident) => {
        impl<'a, 'r> std::ops::Deref for $classifier<'a, 'r> {
            type Target = $crate::front::Cursor<'a, 'r, $kind, $keyword, $token<'a>>;

            fn deref(&self) -> &Self::Target {
                &self.cursor
            }
        }

        impl std::ops::DerefMut for $classifier<'_, '_> {
            fn deref_mut(&mut self) -> &mut Self::Target {
                &mut self.cursor
            }
        }

        impl $classifier<'_, '_> {
            /// As [`Cursor::report`]($crate::front::Cursor::report); the message may be made from the classifier.
            fn report(&mut self, diagnostic: plcc_diag::Diagnostic) {
                self.cursor.report(diagnostic);
            }
        }
    };
}

/// Tokens one per line, each with the number of its line, for `--emit tokens`.
pub fn tokens_text<'t, T: Debug + 't>(text: &str, tokens: impl IntoIterator<Item = &'t Spanned<T>>) -> String {
    let mut out = String::new();
    let (mut line, mut counted) = (1usize, 0usize);
    for (start, token, _) in tokens {
        if let Some(passed) = text.get(counted..*start) {
            line += passed.bytes().filter(|byte| *byte == b'\n').count();
            counted = *start;
        }
        writeln!(out, "{line}: {token:?}").expect("a String takes all text");
    }
    out
}
