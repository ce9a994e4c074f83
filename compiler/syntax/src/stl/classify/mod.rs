//! Classifies words: raw tokens to the tokens of the grammar.
//!
//! A word has different meanings in a header, a declaration, before an operand and inside one; line ends end statements in code
//! and have no meaning elsewhere. This pass follows the frame of the file (header, declarations, code, values) and gives each token
//! its meaning. It also closes frames that the source left open, so the grammar always sees balanced frames, and one
//! mistake remains one message.
//!
//! ```text
//! file ──► block ──► header ──► section (VAR … END_VAR, STRUCT … END_STRUCT)   declaration.rs
//!            │          └────► code (statements, calls)                         code.rs, operand.rs
//!            │          └────► values of a data block                           declaration.rs
//!            └── statements without a header: OB 1
//! ```

mod code;
mod declaration;
mod header;
mod operand;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use crate::ast::Pragma;
use crate::comment::{self, Comment};
use crate::literal::{self, Literal};
use crate::stl::mnemonics::{Detected, Upper};
use crate::stl::raw::{RawKind, RawText, RawToken};
use crate::stl::token::{Spanned, Tok};
use crate::stl::{Mnemonics, pragma};

/// How deep STRUCTs may be nested. STEP 7 allows 8 levels; the rest is for other tools.
const STRUCT_DEPTH_MAX: usize = 64;
/// How many `ARRAY … OF` one declaration may have. STEP 7 allows one.
const ARRAY_DEPTH_MAX: usize = 8;
/// How deep parentheses and brackets may be nested outside statements.
const BRACKET_DEPTH_MAX: usize = 16;

/// A text is not a source if it has at least this many lines that are not statements, and more of them than statements.
const NO_SOURCE_STATEMENTS_MIN: usize = 3;

/// The result of classifying a file.
pub struct Classified<'a> {
    pub tokens: Vec<Spanned<'a>>,
    pub diagnostics: Vec<Diagnostic>,
    /// Pragmas that are outside code.
    pub pragmas: Vec<Pragma>,
    pub comments: Vec<Comment>,
}

/// Classifies the words of a file.
pub fn classify<'a>(file: FileId, text: &'a str, raw: RawText, detected: &Detected, pragmas: bool) -> Classified<'a> {
    let mut classifier = Classifier::new(file, text, raw, detected.set);
    classifier.obey_pragmas = pragmas;
    classifier.mixed = detected.first[1].is_some();
    classifier.file();
    Classified {
        tokens: classifier.out,
        diagnostics: classifier.diagnostics,
        pragmas: classifier.pragmas,
        comments: classifier.comments,
    }
}

/// Classifies the words of a side of an assertion: operands, area letters of both sets. `offset`: where `text` begins in the file.
pub fn classify_operand<'a>(
    file: FileId,
    text: &'a str,
    raw: RawText,
    offset: usize,
) -> (Vec<Spanned<'a>>, Vec<Diagnostic>) {
    let mut classifier = Classifier::new(file, text, raw, Mnemonics::En);
    classifier.both_sets = true;
    classifier.assert_side();
    for (start, _, end) in &mut classifier.out {
        *start += offset;
        *end += offset;
    }
    for diagnostic in &mut classifier.diagnostics {
        diagnostic.primary.span.start += offset as u32;
        diagnostic.primary.span.end += offset as u32;
    }
    (classifier.out, classifier.diagnostics)
}

/// What follows a block's header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Frame {
    Code,
    Data,
    Type,
}

struct Classifier<'a> {
    file: FileId,
    text: &'a str,
    raw: Vec<RawToken>,
    comments: Vec<Comment>,
    /// Index of the next raw token.
    at: usize,
    /// Index of the next comment that may be a pragma.
    next_comment: usize,
    out: Vec<Spanned<'a>>,
    diagnostics: Vec<Diagnostic>,
    pragmas: Vec<Pragma>,
    set: Mnemonics,
    /// Area letters of both mnemonic sets are accepted.
    both_sets: bool,
    /// The file has mnemonics of both sets, which has been reported.
    mixed: bool,
    obey_pragmas: bool,
}

impl<'a> Classifier<'a> {
    fn new(file: FileId, text: &'a str, raw: RawText, set: Mnemonics) -> Classifier<'a> {
        Classifier {
            file,
            text,
            out: Vec::with_capacity(raw.tokens.len() + raw.tokens.len() / 4),
            raw: raw.tokens,
            comments: raw.comments,
            at: 0,
            next_comment: 0,
            diagnostics: Vec::new(),
            pragmas: Vec::new(),
            set,
            both_sets: false,
            mixed: false,
            obey_pragmas: false,
        }
    }

    /// The whole file: blocks, and statements outside them.
    fn file(&mut self) {
        loop {
            let Some(token) = self.peek() else {
                self.file_pragmas(u32::MAX);
                return;
            };
            match token.kind {
                RawKind::Semicolon => self.at += 1,
                _ if self.block_keyword(self.at).is_some() => {
                    self.file_pragmas(token.start);
                    self.block();
                }
                RawKind::Word if is_end_of_block(self.upper(self.at).as_str()) => {
                    let word = self.slice(token);
                    self.report(
                        Diagnostic::new(
                            Code::BlockFrame,
                            self.span(token),
                            format!("`{word}` ends a block that never began"),
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
        let (first_token, first_message) = (self.out.len(), self.diagnostics.len());
        self.push(start, Tok::ImpliedOb, start);
        self.code();
        let tokens = &self.out[first_token..];
        let bad = tokens.iter().filter(|(_, token, _)| *token == Tok::BadStatement).count();
        let good =
            tokens.iter().filter(|(_, token, _)| matches!(token, Tok::Insn(_) | Tok::Jump(_) | Tok::Call)).count();
        if bad >= NO_SOURCE_STATEMENTS_MIN && bad > good {
            let (start, _, end) =
                tokens.iter().find(|(_, token, _)| *token == Tok::BadStatement).expect("some were counted");
            let span = self.span_of(*start, *end);
            self.out.truncate(first_token);
            self.diagnostics.truncate(first_message);
            return self.report(not_a_source(span, "neither a statement of STL nor a block begins here"));
        }
        let end = self.last_end();
        self.push(end, Tok::EndBlock, end);
    }

    // Raw tokens.

    fn peek(&self) -> Option<RawToken> {
        self.raw.get(self.at).copied()
    }

    fn raw_at(&self, index: usize) -> Option<RawToken> {
        self.raw.get(index).copied()
    }

    fn kind_at(&self, index: usize) -> Option<RawKind> {
        self.raw.get(index).map(|token| token.kind)
    }

    fn slice(&self, token: RawToken) -> &'a str {
        &self.text[token.range()]
    }

    /// The word at `index` in upper case; empty if there is no word.
    fn upper(&self, index: usize) -> Upper {
        match self.raw.get(index) {
            Some(token) if token.kind == RawKind::Word => Upper::new(&self.text[token.range()]),
            _ => Upper::new(""),
        }
    }

    /// Whether nothing is between the tokens at `index` and `index + 1`.
    fn adjacent(&self, index: usize) -> bool {
        match (self.raw.get(index), self.raw.get(index + 1)) {
            (Some(token), Some(next)) => token.end == next.start,
            _ => false,
        }
    }

    fn span(&self, token: RawToken) -> Span {
        Span { file: self.file, start: token.start, end: token.end }
    }

    fn span_of(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, start..end)
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

    fn last(&self) -> Option<&Tok<'a>> {
        self.out.last().map(|(_, token, _)| token)
    }

    /// The end of the last raw token before the current one.
    fn last_end(&self) -> usize {
        self.at.checked_sub(1).map_or(0, |before| self.raw[before].end as usize)
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    // Keywords of frames.

    /// The keyword at `index` that begins a block. A component named `TYPE` is not one: a name follows a keyword.
    fn block_keyword(&self, index: usize) -> Option<Tok<'static>> {
        use crate::stl::token::CodeKeyword;
        let keyword = match self.upper(index).as_str() {
            "ORGANIZATION_BLOCK" => Tok::Code(CodeKeyword::OrganizationBlock),
            "FUNCTION" => Tok::Code(CodeKeyword::Function),
            "FUNCTION_BLOCK" => Tok::Code(CodeKeyword::FunctionBlock),
            "DATA_BLOCK" => Tok::DataBlock,
            "TYPE" => Tok::Type,
            _ => return None,
        };
        let before = index.checked_sub(1).and_then(|before| self.kind_at(before));
        if matches!(before, Some(RawKind::Hash | RawKind::Dot | RawKind::Assign)) {
            return None;
        }
        match self.kind_at(index + 1) {
            Some(RawKind::Word | RawKind::Quoted | RawKind::Hash | RawKind::UnterminatedQuoted) | None => Some(keyword),
            Some(_) if keyword != Tok::Type => match self.kind_at(index + 1) {
                Some(RawKind::Colon | RawKind::Assign | RawKind::Dot | RawKind::Comma) => None,
                _ => Some(keyword),
            },
            Some(_) => None,
        }
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

    // Constants, common to declarations, values and operands.

    /// Takes the current constant (a number, text or `#` constant), with the sign before it.
    fn literal(&mut self) {
        let first = self.raw[self.at];
        let signed = matches!(first.kind, RawKind::Minus | RawKind::Plus);
        if signed {
            self.at += 1;
        }
        let token = self.raw[self.at];
        let text = if signed { &self.text[first.start as usize..token.end as usize] } else { self.slice(token) };
        self.at += 1;
        let tok = self.literal_token(text, self.span_of(first.start as usize, token.end as usize));
        self.push(first.start as usize, tok, token.end as usize);
    }

    fn literal_token(&mut self, text: &str, span: Span) -> Tok<'a> {
        let compact: String;
        let value = if text.starts_with(['-', '+']) {
            compact = text.chars().filter(|c| !matches!(c, ' ' | '\t')).collect();
            &compact
        } else {
            text
        };
        match literal::parse(value) {
            Ok(value) => {
                self.warn_of_blanks(&value, text, span);
                Tok::Literal(value)
            }
            Err(error) => {
                let mut diagnostic = Diagnostic::new(error.code, span, error.title).label(error.label);
                diagnostic.help = error.help;
                self.report(diagnostic);
                Tok::BadOperand
            }
        }
    }

    fn warn_of_blanks(&mut self, value: &Literal, text: &str, span: Span) {
        if matches!(value, Literal::Date(_) | Literal::DateAndTime(_)) && text.contains([' ', '\t']) {
            let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect();
            self.report(
                Diagnostic::new(Code::BlanksInLiteral, span, "STEP 7 allows no blanks inside a constant")
                    .label("read as one constant")
                    .help(format!("write `{compact}`")),
            );
        }
    }

    /// Whether a constant begins at `index`: a value, or a sign with a number after it.
    fn is_literal(&self, index: usize) -> bool {
        match self.kind_at(index) {
            Some(RawKind::Number | RawKind::Real | RawKind::Text | RawKind::Literal) => true,
            Some(RawKind::Minus | RawKind::Plus) => {
                matches!(self.kind_at(index + 1), Some(RawKind::Number | RawKind::Real))
            }
            _ => false,
        }
    }

    /// Reports the current raw token, which is allowed nowhere, and advances. A `BadOperand` takes its place.
    fn stray(&mut self) {
        let token = self.raw[self.at];
        let span = self.span(token);
        let slice = self.slice(token);
        let diagnostic = match token.kind {
            RawKind::UnterminatedText => {
                Diagnostic::new(Code::UnterminatedText, span, "the text is not closed on its line")
                    .label("begins here")
                    .help("close it with `'`; write a quote inside as `$'`")
            }
            RawKind::UnterminatedQuoted => {
                Diagnostic::new(Code::UnterminatedText, span, "the symbol is not closed on its line")
                    .label("begins here")
                    .help("close it with `\"`")
            }
            RawKind::Stray => {
                let c = slice.chars().next().unwrap_or(' ');
                Diagnostic::new(
                    Code::UnexpectedCharacter,
                    span,
                    format!("`{}` cannot be part of a statement", c.escape_debug()),
                )
                .label("not a character of STL outside texts and comments")
                .help(stray_help(c))
            }
            _ => Diagnostic::new(Code::Syntax, span, format!("`{slice}` cannot stand here"))
                .label("not expected")
                .help("an operand is an address (`M 10.0`), a name (`#name`, `\"symbol\"`) or a constant"),
        };
        self.report(diagnostic);
        self.take(Tok::BadOperand);
        if token.kind == RawKind::Stray {
            // Text after a character without a meaning has no meaning either.
            while self.peek().is_some_and(|next| {
                !next.first_on_line
                    && !matches!(
                        next.kind,
                        RawKind::Semicolon | RawKind::Comma | RawKind::RightParen | RawKind::RightBracket
                    )
            }) {
                self.at += 1;
            }
        }
    }
}

/// The text at `span` belongs to no PLC source.
pub fn not_a_source(span: Span, label: &str) -> Diagnostic {
    Diagnostic::new(Code::NotASource, span, "this file does not contain a PLC source")
        .label(label)
        .help("pass a source in STL or SCL as STEP 7 or the TIA Portal exports it: blocks, or statements such as `A I 0.0`, but not a printout")
}

fn stray_help(c: char) -> &'static str {
    match c {
        '‘' | '’' | '`' => "write texts in straight quotes: `'text'`",
        '“' | '”' | '„' => "write symbols in straight quotes: `\"symbol\"`",
        '–' | '—' | '−' => "write the sign as `-`",
        '\\' => "comments begin with `//`",
        _ => "remove it, or put it into a comment after `//`",
    }
}

/// Whether the word (upper case) ends a block.
fn is_end_of_block(word: &str) -> bool {
    matches!(word, "END_ORGANIZATION_BLOCK" | "END_FUNCTION" | "END_FUNCTION_BLOCK" | "END_DATA_BLOCK" | "END_TYPE")
}

/// Whether the word (upper case) begins a declaration section.
fn is_section(word: &str) -> bool {
    matches!(word, "VAR" | "VAR_INPUT" | "VAR_OUTPUT" | "VAR_IN_OUT" | "VAR_TEMP")
}

/// Text between the quotes of a `"name"`.
fn unquoted(text: &str) -> &str {
    text.trim_matches('"').trim()
}
