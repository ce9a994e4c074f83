//! Raw tokens to tokens with a meaning, line by line: the first word of a line decides what the line is.

mod call;
mod operand;

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::ast::{BlockKind, Section};
use super::mnemonics::{self, Detected};
use super::raw::{RawKind, RawToken, block_comment};
use super::token::Tok;
use super::{pragma, suggest};
use crate::Elementary;
use crate::front::Classified;
use crate::front::comment::{Comment, CommentForm};
use crate::front::pragma::{is_for_file, is_pragma, nearly};
use crate::front::{frame, frame_words};

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
        let text = self.slice(range.clone()).trim_start_matches("(*").trim_end_matches("*)").trim();
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

    /// `TITLE=text`: the whole rest of the line, `//` included.
    fn title(&mut self, line: &[RawToken]) -> bool {
        let (Some(first), Some(last)) = (line.first(), line.last()) else { return false };
        let sign = line.get(1).map(|token| (token.kind, token.range().end));
        let from = match sign {
            None => first.range().end,
            Some((RawKind::Relation | RawKind::Assign, end)) => end,
            Some((RawKind::Colon, end)) if self.mode == Mode::Code => end,
            Some(_) => return false,
        };
        let text = self.slice(from..last.range().end.max(from)).trim();
        self.push(first.range().start..last.range().end, Tok::Title(text));
        self.end_line();
        true
    }

    /// The keyword of the frame that `word`, the first of its line, is a slip of.
    fn misspelt_frame(&self, word: &str, code: &[RawToken]) -> Option<&'static str> {
        const HEADERS: [&str; 4] = ["ORGANIZATION_BLOCK", "SUBROUTINE_BLOCK", "INTERRUPT_BLOCK", "DATA_BLOCK"];
        const ALONE: [&str; 10] = [
            "END_ORGANIZATION_BLOCK",
            "END_SUBROUTINE_BLOCK",
            "END_INTERRUPT_BLOCK",
            "END_DATA_BLOCK",
            "END_VAR",
            "VAR_INPUT",
            "VAR_OUTPUT",
            "VAR_IN_OUT",
            "VAR_TEMP",
            "BEGIN",
        ];
        const OTHERS: [&str; 3] = ["NETWORK", "VAR_INOUT", "TITLE"];
        const LENGTH_LEAST: usize = 5;
        if word.len() < LENGTH_LEAST || HEADERS.contains(&word) || ALONE.contains(&word) || OTHERS.contains(&word) {
            return None;
        }
        if mnemonics::any(word, self.detected.set).is_some() {
            return None;
        }
        match without_semicolon(code) {
            [_] => match word {
                "END_ORGANIZATION" => Some("END_ORGANIZATION_BLOCK"),
                "END_SUBROUTINE" | "END_SBR" => Some("END_SUBROUTINE_BLOCK"),
                "END_INTERRUPT" | "END_INT" => Some("END_INTERRUPT_BLOCK"),
                "END_DATA" => Some("END_DATA_BLOCK"),
                _ => frame_words::slip_of(word, ALONE),
            },
            [_, next, ..] if word.len() > LENGTH_LEAST && next.kind == RawKind::Word => {
                frame_words::slip_of(word, HEADERS)
            }
            [_, number, ..] if number.kind == RawKind::Integer && self.mode != Mode::Data => {
                frame_words::slip_of(word, ["NETWORK"])
            }
            _ => None,
        }
    }

    /// A line with a keyword of the frame; false: it is another line.
    fn frame(&mut self, word: &str, code: &[RawToken]) -> bool {
        let Some(first) = code.first().copied() else { return false };
        let (mode, token) = match word {
            "ORGANIZATION_BLOCK" => return self.header(Tok::Header(BlockKind::Main), code),
            "SUBROUTINE_BLOCK" => return self.header(Tok::Header(BlockKind::Subroutine), code),
            "INTERRUPT_BLOCK" => return self.header(Tok::Header(BlockKind::Interrupt), code),
            "DATA_BLOCK" => return self.header(Tok::DataHeader, code),
            "END_ORGANIZATION_BLOCK" => (Mode::Code, Tok::EndBlock(BlockKind::Main)),
            "END_SUBROUTINE_BLOCK" => (Mode::Code, Tok::EndBlock(BlockKind::Subroutine)),
            "END_INTERRUPT_BLOCK" => (Mode::Code, Tok::EndBlock(BlockKind::Interrupt)),
            "END_DATA_BLOCK" => (Mode::Code, Tok::EndData),
            "BEGIN" if self.mode == Mode::Data => (Mode::Data, Tok::Begin),
            "BEGIN" => (Mode::Code, Tok::Begin),
            "NETWORK" => return self.network(code),
            "VAR_INPUT" => (Mode::Declarations, Tok::Section(Section::Input)),
            "VAR_OUTPUT" => (Mode::Declarations, Tok::Section(Section::Output)),
            "VAR_IN_OUT" | "VAR_INOUT" => (Mode::Declarations, Tok::Section(Section::InOut)),
            "VAR" | "VAR_TEMP" => (Mode::Declarations, Tok::Section(Section::Temp)),
            "END_VAR" if self.mode == Mode::Skipped => {
                self.mode = Mode::Code;
                self.push(first.range(), Tok::BadLine);
                return true;
            }
            "END_VAR" => (Mode::Code, Tok::EndVar),
            "VAR_GLOBAL" | "VAR_EXTERNAL" | "VAR_CONFIG" | "VAR_ACCESS" => {
                let help =
                    "the S7-200 has global symbols in a symbol table: a name, its address and a comment in each line";
                self.foreign(&first, &format!("`{word}` belongs to the IEC mode of Micro/WIN"), help);
                self.push(first.range(), Tok::BadLine);
                self.mode = Mode::Skipped;
                return true;
            }
            "FUNCTION" | "FUNCTION_BLOCK" if self.function(code) => return true,
            "END_FUNCTION" | "END_FUNCTION_BLOCK" if self.in_function => {
                self.in_function = false;
                (Mode::Code, Tok::EndBlock(BlockKind::Subroutine))
            }
            "FUNCTION" | "FUNCTION_BLOCK" | "TYPE" | "STRUCT" | "END_FUNCTION" | "END_FUNCTION_BLOCK" | "END_TYPE"
            | "END_STRUCT" | "PROGRAM" | "CONFIGURATION"
                if code.get(1).is_none_or(|next| next.kind != RawKind::Colon) =>
            {
                let help = "blocks of the S7-200 are `ORGANIZATION_BLOCK`, `SUBROUTINE_BLOCK`, `INTERRUPT_BLOCK` and `DATA_BLOCK`";
                self.foreign(&first, &format!("the S7-200 has no `{word}`"), help);
                self.push(first.range(), Tok::BadLine);
                return true;
            }
            _ => return false,
        };
        self.mode = mode;
        self.push(first.range(), token);
        // Users of other controllers write `END_VAR;`.
        let rest = code.get(1..).unwrap_or_default();
        self.operands(without_semicolon(rest));
        true
    }

    /// `FUNCTION_BLOCK FB1`, `FUNCTION "Motor" : VOID`: read as a subroutine.
    fn function(&mut self, code: &[RawToken]) -> bool {
        let [keyword, name, rest @ ..] = code else { return false };
        if !matches!(name.kind, RawKind::Word | RawKind::Quoted) {
            return false;
        }
        let written = name.text(self.text).trim_matches('"');
        let digits = written.trim_start_matches(|c: char| c.is_ascii_alphabetic());
        let letters = &written[..written.len() - digits.len()];
        let number = match rest.first() {
            Some(number) if digits.is_empty() && number.kind == RawKind::Integer => number.text(self.text),
            _ => digits,
        };
        let is_number = !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit());
        let numbered = is_number && ["FB", "FC"].iter().any(|known| known.eq_ignore_ascii_case(letters));
        let meant = if numbered { format!("SBR_{number}:SBR{number}") } else { format!("{written}:SBR0") };
        let help = format!("write `SUBROUTINE_BLOCK {meant}`, and `END_SUBROUTINE_BLOCK` at its end");
        self.foreign(keyword, &format!("the S7-200 has no `{}`", keyword.text(self.text)), &help);
        self.mode = Mode::Code;
        self.in_function = true;
        self.push(keyword.range(), Tok::Header(BlockKind::Subroutine));
        self.push(name.range(), Tok::Name(written));
        true
    }

    fn foreign(&mut self, token: &RawToken, title: &str, help: &str) {
        let span = self.span(token.range());
        self.report(Diagnostic::new(Code::ForeignLanguage, span, title).label("not of the S7-200").help(help));
    }

    /// `name:SBR3`, `SBR3` or a name after the keyword of a block.
    fn header(&mut self, token: Tok<'a>, code: &[RawToken]) -> bool {
        self.in_function = false;
        self.mode = if token == Tok::DataHeader { Mode::Data } else { Mode::Code };
        let (Some(first), Some(last)) = (code.first(), code.last()) else { return false };
        self.push(first.range(), token);
        if self.mode == Mode::Data {
            // There is one data block, whatever its name: `DB1`, `Recipe:DB1`.
            return true;
        }
        let from = first.range().end;
        let rest = self.slice(from..last.range().end.max(from));
        let (name, number) = match rest.split_once(':') {
            Some((name, number)) => (name, Some((number, from + name.len() + 1))),
            None => (rest, None),
        };
        let part = |text: &'a str, at: usize| {
            let trimmed = text.trim_start_matches(is_blank);
            let start = at + text.len() - trimmed.len();
            let trimmed = trimmed.trim_end_matches(is_blank);
            (trimmed, start..start + trimmed.len())
        };
        let (name, range) = part(name, from);
        if !name.is_empty() {
            let token = self.block_name(name);
            self.push(range, token);
        }
        let Some((number, at)) = number else { return true };
        let (number, range) = part(number, at);
        if !number.is_empty() || name.is_empty() {
            self.push(at - 1..at, Tok::Colon);
        }
        if !number.is_empty() {
            let token = self.block_name(number);
            self.push(range, token);
        } else if !name.is_empty() {
            let text = self.slice(first.range().start..at);
            self.report(
                Diagnostic::new(Code::BlockFrame, self.span(at - 1..at), "no number follows the `:` of the block")
                    .label("read without it")
                    .help(format!("write `{}`, or its number after the `:`", text.trim_end_matches([':', ' ', '\t']))),
            );
        }
        true
    }

    /// `Fill:SBR0` in a line of its own: the head of a block without its first word.
    fn header_without_keyword(&mut self, code: &[RawToken]) -> bool {
        let [name, colon, number] = without_semicolon(code) else { return false };
        if (name.kind, colon.kind, number.kind) != (RawKind::Word, RawKind::Colon, RawKind::Word) {
            return false;
        }
        let Some((kind, _)) = operand::block(&number.text(self.text).to_ascii_uppercase()) else { return false };
        let range = name.range().start..number.range().end;
        let message = frame::no_keyword_before_name(self.span(range.clone()), kind.keyword(), self.slice(range));
        self.report(message);
        self.mode = Mode::Code;
        self.in_function = false;
        let start = name.range().start;
        self.push(start..start, Tok::Header(kind));
        let (first, second) = (self.block_name(name.text(self.text)), self.block_name(number.text(self.text)));
        self.push(name.range(), first);
        self.push(colon.range(), Tok::Colon);
        self.push(number.range(), second);
        true
    }

    fn block_name(&self, name: &'a str) -> Tok<'a> {
        let name = name.trim_matches('"');
        match operand::block(&name.to_ascii_uppercase()) {
            Some((kind, number)) => Tok::Block(kind, number),
            None => Tok::Name(name),
        }
    }

    /// `NETWORK 1 // title`.
    fn network(&mut self, code: &[RawToken]) -> bool {
        let Some(first) = code.first() else { return false };
        if self.mode == Mode::Declarations && code.get(1).is_some_and(|next| next.kind == RawKind::Colon) {
            return false;
        }
        self.mode = Mode::Code;
        self.push(first.range(), Tok::Network);
        let mut rest = code.get(1..).unwrap_or_default();
        if let [number, after @ ..] = rest
            && number.kind == RawKind::Integer
        {
            self.operands(&rest[..1]);
            rest = after;
        }
        if let [colon, after @ ..] = rest
            && colon.kind == RawKind::Colon
        {
            rest = after;
        }
        // A title without `//`.
        if let (Some(from), Some(to)) = (rest.first(), rest.last()) {
            let range = from.range().start..to.range().end;
            self.push(range.clone(), Tok::Comment(self.slice(range)));
        }
        true
    }

    fn declaration(&mut self, code: &[RawToken]) {
        let start = code.first().map_or(self.end, |token| token.range().start);
        self.push(start..start, Tok::Declaration);
        self.place = Where::Declaration;
        // `list:ARRAY[1..5] OF INT;`: the type is reported, and what follows it is a part of it.
        let is_array = |ty: &RawToken| ty.text(self.text).eq_ignore_ascii_case("ARRAY");
        let code = match code {
            [_, colon, ty, ..] if colon.kind == RawKind::Colon && is_array(ty) => &code[..3],
            _ => code,
        };
        if !self.without_colon(code) {
            self.operands(code);
        }
        self.place = Where::Statement;
    }

    /// `speed INT;`, read as `speed:INT;`.
    fn without_colon(&mut self, code: &[RawToken]) -> bool {
        let [name, ty, ..] = code else { return false };
        let is_type = Elementary::from_word(&ty.text(self.text).to_ascii_uppercase()).is_some();
        if name.kind != RawKind::Word || ty.kind != RawKind::Word || !is_type {
            return false;
        }
        let (name_text, ty_text) = (name.text(self.text), ty.text(self.text));
        let title = format!("`:` is missing between `{name_text}` and its type");
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, self.span(ty.range()), title)
                .label("the type")
                .help(format!("write `{name_text}:{ty_text};`")),
        );
        self.operands(&code[..1]);
        let end = name.range().end;
        self.push(end..end, Tok::Colon);
        self.operands(&code[1..]);
        true
    }

    fn data(&mut self, code: &[RawToken]) {
        let Some(first) = code.first() else { return };
        let addressed = match (first.kind, code.get(1)) {
            (RawKind::Word, next) => {
                let constant = operand::is_bool(&first.text(self.text).to_ascii_uppercase());
                !constant || next.is_some_and(|next| !matches!(next.kind, RawKind::Comma | RawKind::Semicolon))
            }
            (RawKind::Quoted, Some(next)) => !matches!(next.kind, RawKind::Comma | RawKind::Semicolon),
            _ => false,
        };
        let start = first.range().start;
        self.push(start..start, Tok::Data(addressed));
        let (address, mut values) = code.split_at(usize::from(addressed));
        if addressed
            && let [sign, rest @ ..] = values
            && matches!(sign.text(self.text), ":=" | "=")
            && let Some(last) = rest.last()
        {
            let value = self.slice(rest[0].range().start..last.range().end);
            let title = format!("a line of a data block has no `{}`", sign.text(self.text));
            self.report(
                Diagnostic::new(Code::ForeignForm, self.span(sign.range()), title)
                    .label("a form of other languages")
                    .help(format!("write `{} {value}`", first.text(self.text))),
            );
            values = rest;
        }
        self.place = Where::DataAddress;
        self.operands(address);
        self.place = Where::DataValue;
        self.operands(values);
        self.place = Where::Statement;
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
                self.report(message);
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

fn without_semicolon(rest: &[RawToken]) -> &[RawToken] {
    match rest {
        [before @ .., last] if last.kind == RawKind::Semicolon => before,
        _ => rest,
    }
}

fn is_blank(c: char) -> bool {
    c.is_whitespace() || c == '\u{FEFF}' || c.is_control()
}
