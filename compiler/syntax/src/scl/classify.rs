//! Classifies words: raw tokens to the tokens of the grammar.
//!
//! A word has different meanings in a header, a declaration and an expression. This pass follows the frame of the file and gives each token its
//! meaning. It also closes frames, structured statements and brackets that the source left open, and ends each statement,
//! so the grammar always sees a balanced text, and one mistake remains one message.
//!
//! ```text
//! file ──► block ──► header                                                    block.rs, header.rs, attributes.rs
//!            │          ├────► declarations (VAR … END_VAR, STRUCT … END_STRUCT)   declaration.rs
//!            │          ├────► statements                                      code.rs
//!            │          └────► values of a data block                          declaration.rs
//!            ├── options of the compiler                                       options.rs
//!            └── statements without a header: OB 1
//! expressions                                                                  expression.rs
//! ```

mod attributes;
mod block;
mod code;
mod declaration;
mod expression;
mod header;
mod options;

use plcc_diag::FileId;
use std::collections::HashSet;

use super::keyword::Keyword;
use super::raw::{RawKind, RawText};
use super::token::Tok;
use crate::front::{Classified, Cursor, frame};

/// Classifies the words of a file.
pub fn classify<'a>(file: FileId, text: &'a str, raw: &RawText, obey_pragmas: bool) -> Classified<Tok<'a>> {
    let comments = if obey_pragmas { raw.comments.as_slice() } else { &[] };
    let mut classifier = Classifier {
        cursor: Cursor::new(file, text, &raw.tokens, comments),
        iec: raw.iec,
        labels: HashSet::new(),
        constants: HashSet::new(),
        sets_ok: None,
    };
    classifier.file();
    classifier.cursor.finish()
}

struct Classifier<'a, 'r> {
    cursor: Cursor<'a, 'r, RawKind, Option<Keyword>, Tok<'a>>,
    /// Structured text of IEC 61131-3.
    iec: bool,
    /// Labels that the block declares or jumps to, in upper case.
    labels: HashSet<String>,
    /// Constants that the block declares, in upper case.
    constants: HashSet<String>,
    /// The value of the option `SCL_SetOKFlag` for the blocks that follow.
    sets_ok: Option<&'a str>,
}

crate::moves_cursor!(Classifier, RawKind, Option<Keyword>, Tok);

impl<'a> Classifier<'a, '_> {
    /// The whole file: blocks, and statements outside them.
    fn file(&mut self) {
        loop {
            let Some(token) = self.peek() else {
                self.file_pragmas(u32::MAX);
                return;
            };
            match token.keyword {
                _ if token.kind == RawKind::Semicolon => self.at += 1,
                _ if token.kind == RawKind::LeftBrace && (self.options() || self.attributes_before_block()) => {}
                Some(_) if self.block_begins(self.at) => {
                    self.file_pragmas(token.start);
                    self.block();
                }
                Some(word) if word.ends_block() => {
                    self.report(frame::never_began(self.span(token), self.slice(token)));
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

    fn keyword_at(&self, index: usize) -> Option<Keyword> {
        self.raw.get(index).and_then(|token| token.keyword)
    }

    /// Whether a block begins with the keyword at `index`.
    fn block_begins(&self, index: usize) -> bool {
        let Some(keyword) = self.keyword_at(index) else { return false };
        if !keyword.begins_block() {
            return false;
        }
        match self.kind_at(index + 1) {
            Some(RawKind::Word | RawKind::Quoted | RawKind::UnterminatedQuoted | RawKind::Local) | None => true,
            Some(RawKind::Colon) if keyword == Keyword::Function => self.function_without_name(index),
            Some(RawKind::Colon | RawKind::Assign | RawKind::Dot | RawKind::Comma | RawKind::LeftBracket) => false,
            Some(_) => !matches!(keyword, Keyword::Type | Keyword::Program),
        }
    }

    /// `FUNCTION : REAL` in a line of its own, before a section or BEGIN.
    fn function_without_name(&self, index: usize) -> bool {
        let starts_line = |at: usize| self.raw.get(at).is_some_and(|token| token.first_on_line);
        let begins = |word: Keyword| word.begins_section() || word == Keyword::Begin;
        starts_line(index)
            && matches!(self.kind_at(index + 2), Some(RawKind::Word | RawKind::Quoted))
            && !starts_line(index + 2)
            && starts_line(index + 3)
            && self.keyword_at(index + 3).is_some_and(begins)
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
