//! Classifies words: raw tokens to the tokens of the grammar.
//!
//! A word has different meanings in a header, a declaration and an expression. This pass follows the frame of the file and gives each token its
//! meaning. It also closes frames, structured statements and brackets that the source left open, and ends each statement,
//! so the grammar always sees a balanced text, and one mistake remains one message.
//!
//! ```text
//! file ──► block ──► header                                                    header.rs
//!            │          ├────► declarations (VAR … END_VAR, STRUCT … END_STRUCT)   declaration.rs
//!            │          ├────► statements                                      code.rs
//!            │          └────► values of a data block                          declaration.rs
//!            └── statements without a header: OB 1
//! expressions                                                                  expression.rs
//! ```

mod code;
mod declaration;
mod expression;
mod header;

use std::collections::HashSet;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::keyword::Keyword;
use super::raw::{RawKind, RawText, RawToken};
use super::token::{Spanned, Tok};
use crate::ast::Pragma;
use crate::comment::{self, Comment};
use crate::stl::pragma;

/// How deep structured statements, STRUCTs and brackets may be nested.
const NESTING_MAX: usize = 200;

/// The result of classifying a file.
pub struct Classified<'a> {
    pub tokens: Vec<Spanned<'a>>,
    pub diagnostics: Vec<Diagnostic>,
    /// Pragmas that are outside code.
    pub pragmas: Vec<Pragma>,
    pub comments: Vec<Comment>,
}

/// Classifies the words of a file.
pub fn classify<'a>(file: FileId, text: &'a str, raw: RawText, obey_pragmas: bool) -> Classified<'a> {
    let mut classifier = Classifier {
        file,
        text,
        iec: raw.iec,
        out: Vec::with_capacity(raw.tokens.len() + raw.tokens.len() / 8),
        raw: raw.tokens,
        comments: raw.comments,
        at: 0,
        next_comment: 0,
        diagnostics: Vec::new(),
        pragmas: Vec::new(),
        obey_pragmas,
        labels: HashSet::new(),
        constants: HashSet::new(),
    };
    classifier.file();
    Classified {
        tokens: classifier.out,
        diagnostics: classifier.diagnostics,
        pragmas: classifier.pragmas,
        comments: classifier.comments,
    }
}

struct Classifier<'a> {
    file: FileId,
    text: &'a str,
    /// Structured text of IEC 61131-3.
    iec: bool,
    raw: Vec<RawToken>,
    comments: Vec<Comment>,
    /// Index of the next raw token.
    at: usize,
    /// Index of the next comment that may be a pragma.
    next_comment: usize,
    out: Vec<Spanned<'a>>,
    diagnostics: Vec<Diagnostic>,
    pragmas: Vec<Pragma>,
    obey_pragmas: bool,
    /// Labels that the block declares or jumps to, in upper case.
    labels: HashSet<String>,
    /// Constants that the block declares, in upper case.
    constants: HashSet<String>,
}

impl<'a> Classifier<'a> {
    /// The whole file: blocks, and statements outside them.
    fn file(&mut self) {
        loop {
            let Some(token) = self.peek() else {
                self.file_pragmas(u32::MAX);
                return;
            };
            match token.keyword {
                _ if token.kind == RawKind::Semicolon => self.at += 1,
                Some(_) if self.block_begins(self.at) => {
                    self.file_pragmas(token.start);
                    self.block();
                }
                Some(word) if word.ends_block() => {
                    self.report(
                        Diagnostic::new(
                            Code::BlockFrame,
                            self.span(token),
                            format!("`{}` ends a block that never began", self.slice(token)),
                        )
                        .label("no block is open here")
                        .help("remove it, or write the header of its block before the statements"),
                    );
                    self.at += 1;
                }
                _ => self.implied_ob(),
            }
        }
    }

    /// Statements without a header.
    fn implied_ob(&mut self) {
        let start = self.peek().map_or(self.text.len(), |token| token.start as usize);
        let start = self.next_pragma(start as u32).map_or(start, |pragma| pragma.start as usize);
        self.push(start, Tok::ImpliedOb, start);
        self.labels.clear();
        self.constants.clear();
        self.collect_labels();
        self.code();
        let end = self.last_end();
        self.push(end, Tok::EndBlock, end);
    }

    // Raw tokens.

    fn peek(&self) -> Option<RawToken> {
        self.raw.get(self.at).copied()
    }

    fn kind_at(&self, index: usize) -> Option<RawKind> {
        self.raw.get(index).map(|token| token.kind)
    }

    fn keyword_at(&self, index: usize) -> Option<Keyword> {
        self.raw.get(index).and_then(|token| token.keyword)
    }

    fn is_at(&self, kind: RawKind) -> bool {
        self.kind_at(self.at) == Some(kind)
    }

    fn slice(&self, token: RawToken) -> &'a str {
        &self.text[token.range()]
    }

    fn span(&self, token: RawToken) -> Span {
        Span { file: self.file, start: token.start, end: token.end }
    }

    fn span_of(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, start..end)
    }

    /// Whether a block begins with the keyword at `index`.
    fn block_begins(&self, index: usize) -> bool {
        let Some(keyword) = self.keyword_at(index) else { return false };
        if !keyword.begins_block() {
            return false;
        }
        match self.kind_at(index + 1) {
            Some(RawKind::Word | RawKind::Quoted | RawKind::UnterminatedQuoted | RawKind::Local) | None => true,
            Some(RawKind::Colon | RawKind::Assign | RawKind::Dot | RawKind::Comma | RawKind::LeftBracket) => false,
            Some(_) => !matches!(keyword, Keyword::Type | Keyword::Program),
        }
    }

    // Tokens of the grammar.

    fn push(&mut self, start: usize, token: Tok<'a>, end: usize) {
        self.out.push((start, token, end));
    }

    /// Pushes `token` for the current raw token and advances.
    fn take(&mut self, token: Tok<'a>) {
        let raw = self.raw[self.at];
        self.push(raw.start as usize, token, raw.end as usize);
        self.at += 1;
    }

    /// Pushes a token of no width after what has been read.
    fn push_here(&mut self, token: Tok<'a>) {
        let end = self.last_end();
        self.push(end, token, end);
    }

    /// The end of the last raw token before the current one.
    fn last_end(&self) -> usize {
        self.at.checked_sub(1).map_or(0, |before| self.raw[before].end as usize)
    }

    fn last_token(&self) -> Option<RawToken> {
        self.at.checked_sub(1).map(|before| self.raw[before])
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    // Pragmas.

    /// The next comment line `//@` before byte `before`, if pragmas are read.
    fn next_pragma(&mut self, before: u32) -> Option<Comment> {
        if !self.obey_pragmas {
            return None;
        }
        comment::next_pragma(self.text, &self.comments, &mut self.next_comment, before)
    }

    fn read_pragma(&mut self, comment: Comment) -> Pragma {
        self.next_comment += 1;
        let range = comment.start as usize..comment.end as usize;
        pragma::parse(self.file, self.text, range, &mut self.diagnostics)
    }

    /// Pragmas before byte `before` that are outside code belong to the file.
    fn file_pragmas(&mut self, before: u32) {
        while let Some(comment) = self.next_pragma(before) {
            let pragma = self.read_pragma(comment);
            self.pragmas.push(pragma);
        }
    }
}

/// Text between the quotes of a `"name"`, `#"name"`, without outer blanks.
fn unquoted(text: &str) -> &str {
    let inner = text.strip_prefix('#').unwrap_or(text);
    match inner.strip_prefix('"') {
        Some(inner) => inner.strip_suffix('"').unwrap_or(inner).trim(),
        None => inner,
    }
}
