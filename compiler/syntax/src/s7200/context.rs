//! What the actions of the grammar work with: the text, its tokens, and the messages.

use std::ops::Range;

use lalrpop_util::ErrorRecovery;
use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::Insn;
use super::ast::{Declaration, Operand, Section};
use super::line::{Line, LineKind};
use super::token::{Spanned, Tok};
use crate::frame;
use crate::stl::Mnemonics;

/// Where a syntax error was recovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Frame,
    Declaration,
    Data,
    Statement(Insn),
}

/// Context of a parse.
pub struct Context<'a> {
    pub file: FileId,
    pub text: &'a str,
    /// All tokens, for messages.
    pub tokens: &'a [Spanned<'a>],
    pub diagnostics: Vec<Diagnostic>,
    /// Starts of the messages of `classify`, in order: where there is one, the grammar reports nothing.
    pub reported: Vec<u32>,
    pub set: Mnemonics,
}

impl<'a> Context<'a> {
    pub fn new(file: FileId, text: &'a str, tokens: &'a [Spanned<'a>], set: Mnemonics) -> Context<'a> {
        Context { file, text, tokens, diagnostics: Vec::new(), reported: Vec::new(), set }
    }

    pub fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range.start..range.end.max(range.start))
    }

    pub fn slice(&self, range: Range<usize>) -> (String, Span) {
        (self.text.get(range.clone()).unwrap_or_default().to_owned(), self.span(range))
    }

    pub fn line(&self, kind: LineKind, comment: Option<&str>, range: Range<usize>) -> Line {
        Line { kind, comment: comment.map(str::to_owned), span: self.span(range) }
    }

    /// The number of a block; too large ones are reported.
    pub fn number(&mut self, number: i64, range: Range<usize>) -> Option<(u32, Span)> {
        let span = self.span(range);
        match u32::try_from(number) {
            Ok(number) if number <= 0xFFFF => Some((number, span)),
            _ => {
                self.diagnostics.push(
                    Diagnostic::new(Code::AddressRange, span, format!("no block has the number {number}"))
                        .label("too large")
                        .help("subroutines are SBR0 to SBR127, interrupt routines INT0 to INT127"),
                );
                None
            }
        }
    }

    pub fn declaration(
        &self,
        (name, name_range): (&str, Range<usize>),
        (ty, ty_range): (&str, Range<usize>),
        initial: Option<Operand>,
    ) -> Declaration {
        Declaration {
            // The line is in a section, which `blocks` knows.
            section: Section::Temp,
            name: name.to_owned(),
            name_span: self.span(name_range),
            ty: ty.to_ascii_uppercase(),
            ty_span: self.span(ty_range),
            initial,
            comment: None,
        }
    }

    /// Reports a recovered error, unless there is a message within `range`.
    pub fn syntax_error(&mut self, error: ErrorRecovery<usize, Tok<'a>, ()>, place: Place, range: Range<usize>) {
        let found = frame::error_range(&error.error).unwrap_or((range.end, range.end));
        if frame::is_reported(&self.reported, &self.diagnostics, range.start.min(found.0)..range.end.max(found.1)) {
            return;
        }
        let message = self.message(found.0, place);
        self.diagnostics.push(message);
    }

    /// The message for the token at byte `found`, or for the one before it if the line ends too early.
    fn message(&self, found: usize, place: Place) -> Diagnostic {
        let (code, what, help) = match place {
            Place::Frame => (
                Code::BlockFrame,
                "line",
                "a block begins with `SUBROUTINE_BLOCK name:SBR3`, its statements with `BEGIN` and `NETWORK 1`"
                    .to_owned(),
            ),
            Place::Declaration => (
                Code::DeclarationSyntax,
                "declaration",
                "a declaration is `name:TYPE;`, and the section ends with `END_VAR`".to_owned(),
            ),
            Place::Data => {
                (Code::Syntax, "line of a data block", "a line is an address and its values: `VW10 -5, 300`".to_owned())
            }
            Place::Statement(insn) => (Code::Syntax, "statement", self.form(insn)),
        };
        let index = self.tokens.partition_point(|(start, ..)| *start < found);
        let wide = |token: &&Spanned| token.0 < token.2;
        let before = self.tokens.get(..index).unwrap_or_default().iter().rev().find(wide);
        let slice = |start: usize, end: usize| self.text.get(start..end).unwrap_or_default();
        // A line's end is a token without width at the end of the one before.
        let here =
            self.tokens.get(index..).unwrap_or_default().iter().take_while(|token| token.1 != Tok::End).find(wide);
        match here {
            Some((start, _, end)) => {
                let text = slice(*start, *end);
                let title = match before.filter(|(_, token, _)| *token != Tok::End) {
                    Some((from, _, to)) if !slice(*to, *start).contains(['\n', '\r']) => {
                        format!("`{text}` cannot follow `{}` in this {what}", slice(*from, *to))
                    }
                    _ => format!("`{text}` cannot begin this {what}"),
                };
                Diagnostic::new(code, self.span(*start..*end), title).label("not expected here").help(help)
            }
            None => {
                let (start, end) = before.map_or((found, found), |(start, _, end)| (*start, *end));
                Diagnostic::new(code, self.span(start..end), format!("this {what} is not complete"))
                    .label("something is missing after this")
                    .help(help)
            }
        }
    }

    /// How many operands a statement has, as help.
    fn form(&self, insn: Insn) -> String {
        let mnemonic = insn.mnemonic(self.set);
        match insn.operands().len() {
            0 => format!("`{mnemonic}` has no operands"),
            1 => format!("`{mnemonic}` has one operand"),
            count => format!("`{mnemonic}` has {count} operands, separated by `,`"),
        }
    }
}
