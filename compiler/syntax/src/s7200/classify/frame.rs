//! Lines of the frame: blocks, networks with their titles, sections of declarations.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, Mode, operand};
use crate::front::{frame, frame_words};
use crate::s7200::ast::{BlockKind, Section};
use crate::s7200::mnemonics;
use crate::s7200::raw::{RawKind, RawToken};
use crate::s7200::token::Tok;

impl<'a> Classifier<'a, '_> {
    /// `TITLE=text`: the whole rest of the line, `//` included.
    pub(super) fn title(&mut self, line: &[RawToken]) -> bool {
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
    pub(super) fn misspelt_frame(&self, word: &str, code: &[RawToken]) -> Option<&'static str> {
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
                frame_words::ANY_BLOCK_END => self.block_end,
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
    pub(super) fn frame(&mut self, word: &str, code: &[RawToken]) -> bool {
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
        if matches!(token, Tok::EndBlock(_) | Tok::EndData) {
            self.block_end = None;
        }
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
        self.block_end = Some(BlockKind::Subroutine.end_keyword());
        self.push(keyword.range(), Tok::Header(BlockKind::Subroutine));
        self.push(name.range(), Tok::Name(written));
        true
    }

    /// `name:SBR3`, `SBR3` or a name after the keyword of a block.
    fn header(&mut self, token: Tok<'a>, code: &[RawToken]) -> bool {
        self.in_function = false;
        self.mode = if token == Tok::DataHeader { Mode::Data } else { Mode::Code };
        self.block_end = Some(if let Tok::Header(kind) = token { kind.end_keyword() } else { "END_DATA_BLOCK" });
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
    pub(super) fn header_without_keyword(&mut self, code: &[RawToken]) -> bool {
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
        self.block_end = Some(kind.end_keyword());
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
}

/// A line without the semicolon at its end.
fn without_semicolon(rest: &[RawToken]) -> &[RawToken] {
    match rest {
        [before @ .., last] if last.kind == RawKind::Semicolon => before,
        _ => rest,
    }
}

fn is_blank(c: char) -> bool {
    c.is_whitespace() || c == '\u{FEFF}' || c.is_control()
}
