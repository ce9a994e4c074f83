//! Raw tokens to tokens with a meaning, line by line: the first word of a line decides what the line is.
//!
//! - Here: lines in general, comments, and statements; `operand`: their operands, with those of `CALL` in other languages in `call` and
//!   numbers in other forms in `number`.
//! - `frame`: blocks, networks and sections; `declaration`: variables, and lines of a data block.

mod call;
mod declaration;
mod frame;
mod number;
mod operand;

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::ast::BlockKind;
use super::mnemonics::{self, Detected};
use super::raw::{RawKind, RawToken, block_comment};
use super::token::Tok;
use super::{meant, pragma, suggest};
use crate::front::Classified;
use crate::front::comment::{Comment, CommentForm};
use crate::front::frame_words;
use crate::front::pragma::{is_for_file, is_pragma, nearly};

pub use operand::{Where, block};

/// Whether `word` (upper case) numbers a block: `SBR3`.
pub fn is_block(word: &str) -> bool {
    block(word).is_some()
}

/// The kind of lines without a keyword.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mode {
    Code,
    Declarations,
    /// Declarations of a section that the S7-200 does not have.
    Skipped,
    Data,
}

/// Gives the raw tokens of a file their meaning. `data`: the file has only lines of a data block.
pub fn classify<'a>(
    file: FileId,
    text: &'a str,
    lines: &[Vec<RawToken>],
    detected: &Detected,
    pragmas: bool,
    data: bool,
) -> Classified<Tok<'a>> {
    let mode = if data { Mode::Data } else { Mode::Code };
    let classified = Classified { tokens: Vec::new(), pragmas: Vec::new(), diagnostics: Vec::new() };
    let mut classifier = Classifier {
        file,
        text,
        detected,
        pragmas,
        mode,
        place: Where::Statement,
        end: 0,
        parentheses: 0,
        in_function: false,
        block_end: None,
        classified,
    };
    for line in lines {
        classifier.line(line);
    }
    classifier.classified
}

/// The tokens of the sides of an assertion, which begin at byte `offset` of the file.
pub fn classify_assertion<'a>(
    file: FileId,
    text: &'a str,
    tokens: &[RawToken],
    detected: &Detected,
) -> Classified<Tok<'a>> {
    let classified = Classified { tokens: Vec::new(), pragmas: Vec::new(), diagnostics: Vec::new() };
    let mut classifier = Classifier {
        file,
        text,
        detected,
        pragmas: false,
        mode: Mode::Code,
        place: Where::Assertion,
        end: 0,
        parentheses: 0,
        in_function: false,
        block_end: None,
        classified,
    };
    classifier.operands(tokens);
    classifier.classified
}

struct Classifier<'a, 'd> {
    file: FileId,
    text: &'a str,
    detected: &'d Detected,
    pragmas: bool,
    mode: Mode,
    /// Where the operands of the line are.
    place: Where,
    /// End of the last token.
    end: usize,
    /// Open parentheses that were reported.
    parentheses: usize,
    /// In a FUNCTION or FUNCTION_BLOCK, which was reported and is read as a subroutine.
    in_function: bool,
    /// What ends the block that is open.
    block_end: Option<&'static str>,
    classified: Classified<Tok<'a>>,
}

impl<'a> Classifier<'a, '_> {
    fn push(&mut self, range: Range<usize>, token: Tok<'a>) {
        self.end = range.end.max(self.end);
        self.classified.tokens.push((range.start, token, range.end));
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.classified.diagnostics.push(diagnostic);
    }

    fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range)
    }

    fn end_line(&mut self) {
        self.push(self.end..self.end, Tok::End);
    }

    fn slice(&self, range: Range<usize>) -> &'a str {
        self.text.get(range).unwrap_or_default()
    }

    fn line(&mut self, line: &[RawToken]) {
        let (code, comment) = match line {
            [code @ .., last] if last.kind == RawKind::Comment => (code, Some(*last)),
            _ => (line, None),
        };
        if let Some(RawToken { start, end, .. }) = comment.filter(|_| self.pragmas) {
            let form = CommentForm::Line;
            let comment = Comment { start, end, own_line: code.is_empty(), form };
            self.classified.diagnostics.extend(nearly(self.file, self.text, comment));
        }
        let Some(first) = code.first().copied() else {
            return if let Some(comment) = comment {
                self.own_comment(comment)
            };
        };
        let word = match first.kind {
            RawKind::Word => first.text(self.text).to_ascii_uppercase(),
            _ => String::new(),
        };
        if word == "TITLE" && self.title(line) {
            return;
        }
        let code = if self.mode == Mode::Skipped { code } else { self.without_block_comment(code) };
        if code.is_empty() {
            return;
        }
        let meant = self.misspelt_frame(&word, code);
        if let Some(keyword) = meant {
            self.report(frame_words::misspelt(self.span(first.range()), first.text(self.text), keyword));
        }
        if !self.frame(meant.unwrap_or(&word), code) {
            match self.mode {
                Mode::Code => self.statement(code),
                Mode::Declarations => self.declaration(code),
                Mode::Data => self.data(code),
                Mode::Skipped => return,
            }
        }
        if let Some(comment) = comment {
            self.comment(comment);
        }
        self.end_line();
    }

    /// `LD I0.0 (* start *)`: what is before the comment, which is reported.
    fn without_block_comment<'l>(&mut self, code: &'l [RawToken]) -> &'l [RawToken] {
        let (Some(at), Some(last)) = (block_comment(self.text, code), code.last()) else { return code };
        let range = code[at].range().start..last.range().end;
        let text = self.slice(range.clone()).trim_start_matches(['(', '/']).trim_end_matches([')', '/']);
        let text = text.trim_matches('*').trim();
        self.report(
            Diagnostic::new(Code::ForeignForm, self.span(range), "a comment begins with `//`")
                .label("a form of other languages")
                .help(format!("write `// {text}`")),
        );
        &code[..at]
    }

    fn comment(&mut self, comment: RawToken) {
        let text = comment.text(self.text);
        if !text.starts_with("//@") {
            self.push(comment.range(), Tok::Comment(text.strip_prefix("//").unwrap_or(text).trim()));
        }
    }

    fn own_comment(&mut self, comment: RawToken) {
        let text = comment.text(self.text);
        if !is_pragma(text) {
            if !text.starts_with("//@") {
                self.comment(comment);
                self.end_line();
            }
            return;
        }
        if !self.pragmas {
            return;
        }
        let (pragma, assert) =
            pragma::parse(self.file, self.text, comment.range(), self.detected, &mut self.classified.diagnostics);
        if is_for_file(&pragma) {
            self.classified.pragmas.push(pragma);
        } else {
            self.push(comment.range(), Tok::Pragma(Box::new(pragma), assert));
            self.end_line();
        }
    }

    fn foreign(&mut self, token: &RawToken, title: &str, help: &str) {
        let span = self.span(token.range());
        self.report(Diagnostic::new(Code::ForeignLanguage, span, title).label("not of the S7-200").help(help));
    }

    fn statement(&mut self, code: &[RawToken]) {
        let Some(first) = code.first().copied() else { return };
        if self.header_without_keyword(code) {
            return;
        }
        if code.get(1).is_some_and(|next| matches!(next.kind, RawKind::Colon)) && first.kind == RawKind::Word {
            let name = first.text(self.text);
            let title = format!("`{name}:` is a label of S7-300/400");
            self.foreign(
                &first,
                &title,
                "labels of the S7-200 are statements with a number: `LBL 3`, reached by `JMP 3`",
            );
            return self.push(first.range(), Tok::BadLine);
        }
        let Some(head) = mnemonics::head(self.text, code) else {
            let span = self.span(first.range());
            if first.text(self.text) == ")" && self.parentheses > 0 {
                self.parentheses -= 1;
                return self.push(first.range(), Tok::BadLine);
            }
            self.report(
                Diagnostic::new(Code::Syntax, span, format!("`{}` cannot begin a statement", first.text(self.text)))
                    .label("a mnemonic is expected here")
                    .help("a statement is a mnemonic and its operands: `LD I0.0`, `MOVW VW0, VW2`"),
            );
            return self.push(first.range(), Tok::BadLine);
        };
        let range = head.start..head.end;
        let rest = code.get(head.tokens..).unwrap_or_default();
        if let Some(kind) = marker(&head.mnemonic, rest) {
            self.push(range, Tok::Marker(kind));
            return self.operands(rest);
        }
        if let (Some((kind, number)), []) = (operand::block(&head.mnemonic), rest)
            && kind != BlockKind::Main
        {
            self.push(range.clone(), Tok::Marker(kind));
            return self.push(range, Tok::Integer(i64::from(number)));
        }
        match mnemonics::any(&head.mnemonic, self.detected.set) {
            Some(insn) => {
                let rest = self.without_not(insn, &range, rest);
                self.push(range, Tok::Insn(insn));
                self.statement_operands(insn, rest);
            }
            None => {
                let message = suggest::unknown(
                    self.span(range.clone()),
                    &head.mnemonic,
                    self.slice(range.clone()),
                    rest.first().is_none_or(|next| next.kind == RawKind::Comma),
                    self.detected.set,
                );
                let end = code.last().unwrap_or(&first).range().end;
                self.report(match meant::statement(self.slice(range.start..end)) {
                    Some(statement) => message.help(format!("write {statement}")),
                    None => message,
                });
                self.push(range, Tok::BadLine);
            }
        }
    }
}

/// `SBR 3`, `INT 0`.
fn marker(mnemonic: &str, rest: &[RawToken]) -> Option<BlockKind> {
    let kind = match mnemonic {
        "SBR" => BlockKind::Subroutine,
        "INT" => BlockKind::Interrupt,
        _ => return None,
    };
    rest.first().is_some_and(|next| next.kind == RawKind::Integer).then_some(kind)
}
