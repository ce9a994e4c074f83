//! Classifies the frame of a block: its keyword, its name, and its end.

use plcc_diag::{Code, Diagnostic};

use super::header::Frame;
use super::{Classifier, unquoted};
use crate::article::with_article;
use crate::front;
use crate::front::{frame, frame_words};
use crate::scl::address;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::{CodeKeyword, Tok};

impl Classifier<'_, '_> {
    /// A block from its keyword to its end.
    pub(super) fn block(&mut self) {
        let opening = self.raw[self.at];
        let mut keyword = opening.keyword.expect("the caller saw the keyword");
        if keyword == Keyword::Program
            && !self.iec
            && let Some(meant) = self.meant_by_program()
        {
            self.report(frame_words::misspelt(self.span(opening), self.slice(opening), meant.word()));
            keyword = meant;
        }
        let (tok, frame) = match keyword {
            Keyword::OrganizationBlock => (Tok::Code(CodeKeyword::OrganizationBlock), Frame::Code),
            Keyword::Function => (Tok::Code(CodeKeyword::Function), Frame::Code),
            Keyword::DataBlock => (Tok::DataBlock, Frame::Data),
            Keyword::Type => (Tok::Type, Frame::Type),
            _ => (Tok::Code(CodeKeyword::FunctionBlock), Frame::Code),
        };
        self.labels.clear();
        self.constants.clear();
        self.take(tok);
        if keyword == Keyword::Program && !self.iec {
            self.no_program(opening);
        }
        self.block_name(opening);
        self.second_name(opening, keyword);
        if keyword == Keyword::DataBlock {
            self.of_before_type(opening);
        }
        if keyword == Keyword::Function {
            if self.is_at(RawKind::Colon) && self.type_left_out() {
                let colon = self.raw[self.at];
                self.report(frame::no_type_after_colon(self.span(colon)));
                self.at += 1;
            } else if self.is_at(RawKind::Colon) {
                self.take(Tok::Colon);
                self.type_tokens();
            } else if let Some(ty) = self.peek().filter(|token| token.kind == RawKind::Word && !token.first_on_line)
                && !self.header_keyword(self.at)
                && !ty.keyword.is_some_and(|word| word.begins_section() || word.ends_block() || word == Keyword::Begin)
            {
                self.report(frame::no_colon_before_type(self.span(ty), self.slice(ty)));
                let at = ty.start as usize;
                self.push(at, Tok::Colon, at);
                self.type_tokens();
            }
        } else if keyword == Keyword::Type && self.is_at(RawKind::Colon) {
            self.at += 1;
        }
        if frame == Frame::Code {
            self.options_of_block();
        }
        self.header(frame);
        self.end_of_block(opening, keyword);
    }

    /// Whether the next line begins a header, a section or the statements: no type follows the `:` of a function.
    fn type_left_out(&self) -> bool {
        let next = self.at + 1;
        let Some(token) = self.raw.get(next).filter(|token| token.first_on_line) else { return false };
        let begins = |word: Keyword| word.begins_section() || word.ends_block() || word == Keyword::Begin;
        matches!(token.kind, RawKind::Title | RawKind::LeftBrace)
            || token.keyword.is_some_and(begins)
            || self.header_keyword(next)
    }

    /// `FUNCTION "Motor" FC1 : Void`, `DATA_BLOCK "Data" DB5` before a structure: the second name is reported and passed over.
    fn second_name(&mut self, opening: RawToken, keyword: Keyword) {
        let Some(second) = self.peek().filter(|token| {
            !token.first_on_line && matches!(token.kind, RawKind::Word | RawKind::Quoted) && token.keyword.is_none()
        }) else {
            return;
        };
        let next = self.raw.get(self.at + 1);
        let is_name = match keyword {
            Keyword::Function => next.is_some_and(|next| next.kind == RawKind::Colon && !next.first_on_line),
            Keyword::DataBlock | Keyword::Type => {
                next.is_some_and(|next| next.keyword == Some(Keyword::Struct) && next.first_on_line)
            }
            _ => false,
        };
        if !is_name || self.header_keyword(self.at) {
            return;
        }
        let head = self.text[opening.start as usize..second.start as usize].trim_end();
        let help = format!("write `{head}`; the other one is in the symbol table or the properties of the block");
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(second), "the head of a block has one name")
                .label("not read")
                .help(help),
        );
        self.at += 1;
    }

    /// `DATA_BLOCK "Data" OF "Type"`: the word is reported and passed over.
    fn of_before_type(&mut self, opening: RawToken) {
        let is_word = |token: &RawToken| {
            !token.first_on_line && matches!(token.kind, RawKind::Word | RawKind::Quoted | RawKind::Absolute)
        };
        let Some(of) = self.peek().filter(|token| token.keyword == Some(Keyword::Of)) else { return };
        let Some(ty) = self.raw_at(self.at + 1).filter(is_word) else { return };
        // `FB 10`
        let number = self.raw_at(self.at + 2).filter(|next| !next.first_on_line && next.kind == RawKind::Number);
        let end = number.map_or(ty.end, |number| number.end);
        let head = self.text[opening.start as usize..of.start as usize].trim_end();
        let help = format!("write `{head} {}`", &self.text[ty.start as usize..end as usize]);
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(of), "the type of a data block follows its name")
                .label("one word too many")
                .help(help),
        );
        self.at += 1;
    }

    /// The keyword that belongs to the end of `PROGRAM Main … END_ORGANIZATION_BLOCK`.
    fn meant_by_program(&self) -> Option<Keyword> {
        let frames =
            |index: &usize| self.keyword_at(*index).is_some_and(Keyword::ends_block) || self.block_begins(*index);
        let end = (self.at + 1..self.raw.len()).find(frames)?;
        match self.keyword_at(end)? {
            Keyword::EndOrganizationBlock => Some(Keyword::OrganizationBlock),
            Keyword::EndFunctionBlock => Some(Keyword::FunctionBlock),
            _ => None,
        }
    }

    /// `PROGRAM Main`, which no CPU calls.
    fn no_program(&mut self, opening: RawToken) {
        let name = self.peek().map_or("Main", |name| unquoted(self.slice(name)));
        let help = format!(
            "write `FUNCTION_BLOCK \"{name}\"`, `DATA_BLOCK \"{name}_DB\" \"{name}\" BEGIN END_DATA_BLOCK`, \
             and `\"{name}_DB\"();` in ORGANIZATION_BLOCK OB 1"
        );
        self.report(
            Diagnostic::new(
                Code::ForeignForm,
                self.span(opening),
                "the program of a CPU is in its organization blocks",
            )
            .label("read as FUNCTION_BLOCK")
            .help(help),
        );
    }

    /// `FC 7`, `FC7`, `"Tank control"`, `TankControl`.
    fn block_name(&mut self, keyword: RawToken) {
        match self.peek() {
            Some(token) if token.kind == RawKind::Quoted => {
                let name = unquoted(self.slice(token));
                self.take(Tok::Quoted(name));
            }
            Some(token)
                if token.kind == RawKind::UnterminatedQuoted && !token.first_on_line && self.slice(token).len() > 1 =>
            {
                // The rest of the line is in it.
                let text = self.slice(token);
                let (name, ty) = text[1..].split_once(':').unwrap_or((&text[1..], ""));
                let (name, ty) = (name.trim_end(), ty.trim());
                let result = if ty.is_empty() { String::new() } else { format!(" : {ty}") };
                let help = format!("write `{} \"{name}\"{result}`", self.slice(keyword));
                self.report(front::unterminated_name(self.span(token), "name").help(help));
                self.take(Tok::Quoted(name));
                if keyword.keyword == Some(Keyword::Function) {
                    self.result_in_name(token, ty);
                }
            }
            Some(token)
                if token.kind == RawKind::Word
                    && !token
                        .keyword
                        .is_some_and(|word| word.begins_section() || word.ends_block() || word == Keyword::Begin)
                    && !(token.first_on_line && self.header_keyword(self.at)) =>
            {
                if !self.numbered_block() {
                    let name = self.slice(token);
                    self.take(Tok::Name(name));
                }
            }
            found => {
                let text = self.slice(keyword);
                self.report(
                    Diagnostic::new(Code::BlockFrame, self.span(keyword), format!("`{text}` names no block"))
                        .label("the block's number or name is missing")
                        .help("write e.g. `FUNCTION FC 1 : VOID`, `DATA_BLOCK DB 10` or `FUNCTION_BLOCK \"Motor\"`"),
                );
                if found.is_some_and(|token| {
                    !token.first_on_line && matches!(token.kind, RawKind::UnterminatedQuoted | RawKind::Local)
                }) {
                    self.at += 1;
                }
                self.push_here(Tok::Name(""));
            }
        }
    }

    /// Takes `FC 7`, `FC7`; `false`: it is a name.
    pub(super) fn numbered_block(&mut self) -> bool {
        let token = self.raw[self.at];
        let word = self.slice(token);
        let (prefix, number, end, count) = if let Some((prefix, number)) = address::numbered_block(word) {
            (prefix, number, token.end, 1)
        } else {
            let Some(prefix) = address::block_prefix(word) else { return false };
            let beside = |index: usize| self.raw.get(index).copied().filter(|next| !next.first_on_line);
            match (beside(self.at + 1), beside(self.at + 2)) {
                (Some(next), _) if next.kind == RawKind::Number => {
                    (prefix, self.slice(next).replace('_', "").parse().unwrap_or(u32::MAX), next.end, 2)
                }
                // `FC -1`
                (Some(sign), Some(next))
                    if sign.kind == RawKind::Minus && next.kind == RawKind::Number && sign.end == next.start =>
                {
                    (prefix, u32::MAX, next.end, 3)
                }
                _ => return false,
            }
        };
        self.at += count;
        if number == u32::MAX {
            self.report(
                Diagnostic::new(
                    Code::LiteralRange,
                    self.span_of(token.start as usize, end as usize),
                    "no block can have this number",
                )
                .label(if count == 3 { "below 0" } else { "too large" })
                .help("blocks are numbered 0 to 65535"),
            );
        }
        self.push(token.start as usize, Tok::Block(prefix, number), end as usize);
        true
    }

    /// The block's own end, or whatever is there instead.
    fn end_of_block(&mut self, opening: RawToken, keyword: Keyword) {
        let text = self.slice(opening);
        let end_word = match keyword {
            Keyword::OrganizationBlock => Keyword::EndOrganizationBlock,
            Keyword::Function => Keyword::EndFunction,
            Keyword::DataBlock => Keyword::EndDataBlock,
            Keyword::Type => Keyword::EndType,
            Keyword::Program => Keyword::EndProgram,
            _ => Keyword::EndFunctionBlock,
        };
        if let Some(token) = self.peek()
            && let Some(word) = token.keyword.filter(|word| word.ends_block())
        {
            if word != end_word {
                let found = self.slice(token);
                self.report(
                    Diagnostic::new(
                        Code::BlockFrame,
                        self.span(token),
                        format!("`{found}` cannot end {}", with_article(&format!("`{text}`"))),
                    )
                    .label("the block ends here")
                    .also(self.span(opening), "the block begins here")
                    .help(format!("write `{}`", end_word.word())),
                );
            }
            return self.take(Tok::EndBlock);
        }
        let end = end_word.word();
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(opening), format!("the block is not closed with `{end}`"))
                .label("begins here")
                .help(format!("write `{end}` after the last line of the block")),
        );
        self.push_here(Tok::EndBlock);
    }
}
