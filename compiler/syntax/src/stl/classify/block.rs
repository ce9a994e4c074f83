//! Classifies the frame of a block: its keyword, its name, and its end.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, Frame, is_end_of_block, is_section, unquoted};
use crate::article::with_article;
use crate::ast::BlockPrefix;
use crate::front::frame;
use crate::stl::mnemonics::{block_prefix, letters_and_digits};
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::{CodeKeyword, Tok};

/// Tokens of a type after the name of a data block, and the one after it.
const TYPE_TOKENS_MAX: usize = 8;

/// Words that begin a block, with the letters of its number.
const BLOCK_LETTERS: [(&str, &str, BlockPrefix); 5] = [
    ("FUNCTION_BLOCK", "FB", BlockPrefix::Fb),
    ("FUNCTION", "FC", BlockPrefix::Fc),
    ("ORGANIZATION_BLOCK", "OB", BlockPrefix::Ob),
    ("DATA_BLOCK", "DB", BlockPrefix::Db),
    ("TYPE", "UDT", BlockPrefix::Udt),
];

impl<'a> Classifier<'a, '_> {
    /// A block from its keyword to its end.
    pub(super) fn block(&mut self) {
        let opening = self.raw[self.at];
        let keyword = self.block_keyword(self.at).expect("the caller saw the keyword");
        let program = self.upper(self.at).as_str() == "PROGRAM";
        self.take(keyword.clone());
        if program {
            self.no_program(opening);
        }
        self.after_keyword(opening, &keyword, program);
    }

    /// A block from its name to its end. `opening`: the first word of the block.
    pub(super) fn after_keyword(&mut self, opening: RawToken, keyword: &Tok<'_>, program: bool) {
        let (frame, end_word) = match keyword {
            _ if program => (Frame::Code, "END_PROGRAM"),
            Tok::Code(CodeKeyword::OrganizationBlock) => (Frame::Code, "END_ORGANIZATION_BLOCK"),
            Tok::Code(CodeKeyword::Function) => (Frame::Code, "END_FUNCTION"),
            Tok::Code(CodeKeyword::FunctionBlock) => (Frame::Code, "END_FUNCTION_BLOCK"),
            Tok::DataBlock => (Frame::Data, "END_DATA_BLOCK"),
            _ => (Frame::Type, "END_TYPE"),
        };
        let function = *keyword == Tok::Code(CodeKeyword::Function);
        self.block_name(self.slice(opening));
        match frame {
            Frame::Code => self.second_name(opening, function),
            Frame::Data => self.sign_before_type(opening),
            Frame::Type => self.colon_after_name(opening),
        }
        if function && self.kind_at(self.at) == Some(RawKind::Colon) {
            let next = self.at + 1;
            let no_type = self.header_keyword(next)
                || self.upper(next).as_str() == "TITLE"
                || self.kind_at(next).is_none_or(|kind| matches!(kind, RawKind::Title | RawKind::LeftBrace));
            if no_type {
                // Told as a function without a type.
                self.at = next;
            } else {
                self.take(Tok::Colon);
                self.type_name();
            }
        } else if function
            && let Some(ty) = self.peek().filter(|token| token.kind == RawKind::Word && !token.first_on_line)
            && !self.header_keyword(self.at)
            && self.upper(self.at).as_str() != "TITLE"
        {
            self.report(frame::no_colon_before_type(self.span(ty), self.slice(ty)));
            let at = ty.start as usize;
            self.push(at, Tok::Colon, at);
            self.type_name();
        }
        // `FUNCTION_BLOCK FB 1 : VOID`: other blocks return nothing anyway.
        if !function
            && frame == Frame::Code
            && self.kind_at(self.at) == Some(RawKind::Colon)
            && self.upper(self.at + 1).as_str() == "VOID"
        {
            self.at += 2;
        }
        if !program || !self.statements_of_program() {
            self.header(frame);
        }
        self.end_of_block(opening, end_word);
    }

    /// `FUNCTION_BLOCK FB 1 "Motor"`, `FUNCTION_BLOCK "Motor" : FB 1`: what follows the name of a block on its line, up to the type of a
    /// function.
    fn second_name(&mut self, opening: RawToken, function: bool) {
        let Some(first) = self.peek().filter(|token| !token.first_on_line) else { return };
        let colon = first.kind == RawKind::Colon && !function && self.upper(self.at + 1).as_str() != "VOID";
        if !colon && first.kind != RawKind::Quoted {
            return;
        }
        let head = self.text[opening.start as usize..first.start as usize].trim_end();
        let mut end = first.end;
        self.at += 1;
        while let Some(token) = self.peek().filter(|token| {
            let is_part = !matches!(token.kind, RawKind::LeftBrace | RawKind::Title);
            !token.first_on_line && is_part && !(function && token.kind == RawKind::Colon)
        }) {
            end = token.end;
            self.at += 1;
        }
        let span = self.span_of(first.start as usize, end as usize);
        let help = match colon {
            true => format!("write `{head}`: only a FUNCTION has a type, and a symbol table has the other name"),
            false => format!("write `{head}`: a symbol table has the other name"),
        };
        self.report(
            Diagnostic::new(Code::BlockFrame, span, "the head of a block has one name").label("not read").help(help),
        );
    }

    /// `DATA_BLOCK DB 1 : "Motor"`, `DATA_BLOCK DB 1, FB 1`, if it has no structure of its own.
    fn sign_before_type(&mut self, opening: RawToken) {
        let is_sign = |token: &RawToken| matches!(token.kind, RawKind::Colon | RawKind::Comma) && !token.first_on_line;
        let Some(sign) = self.peek().filter(is_sign) else { return };
        let mut rest = self.raw.iter().enumerate().skip(self.at + 1).take(TYPE_TOKENS_MAX);
        let next_line = rest.find(|(_, token)| token.first_on_line).map_or(usize::MAX, |(at, _)| at);
        if next_line == self.at + 1 || self.upper(next_line).as_str() == "STRUCT" {
            return;
        }
        let head = self.text[opening.start as usize..sign.start as usize].trim_end();
        let ty = self.text[sign.end as usize..].lines().next().unwrap_or_default().trim();
        let title = format!("a data block has no `{}` before its type", self.slice(sign));
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(sign), title)
                .label("read without it")
                .help(format!("write `{head} {ty}`")),
        );
        self.at += 1;
    }

    /// `TYPE UDT 1 : STRUCT`
    fn colon_after_name(&mut self, opening: RawToken) {
        let Some(colon) = self.peek().filter(|token| token.kind == RawKind::Colon && !token.first_on_line) else {
            return;
        };
        if self.raw_at(self.at + 1).is_some_and(|next| !next.first_on_line)
            && self.upper(self.at + 1).as_str() != "STRUCT"
        {
            return;
        }
        let head = self.text[opening.start as usize..colon.start as usize].trim_end();
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(colon), "a data type has no `:` after its name")
                .label("read without it")
                .help(format!("write `{head}`, and `STRUCT` on the next line")),
        );
        self.at += 1;
    }

    /// `PROGRAM Main`, which no CPU of STEP 7 calls; read as a function block.
    fn no_program(&mut self, opening: RawToken) {
        self.report(
            Diagnostic::new(
                Code::ForeignForm,
                self.span(opening),
                "the program of a CPU is in its organization blocks",
            )
            .label("a form of other languages")
            .help(
                "write `ORGANIZATION_BLOCK OB 1`, after the declarations `BEGIN`, and `END_ORGANIZATION_BLOCK` at the end",
            ),
        );
    }

    /// The declarations and statements of a PROGRAM, which has no BEGIN; `false`: it has one.
    fn statements_of_program(&mut self) -> bool {
        while is_section(self.upper(self.at).as_str()) {
            self.section();
        }
        if self.header_keyword(self.at) && self.upper(self.at).as_str() != "NETWORK" {
            return false;
        }
        let end = self.last_end();
        self.push(end, Tok::Begin, end);
        self.code();
        true
    }

    /// `FC 7`, `FC7`, `"Tank control"`, `TankControl`.
    fn block_name(&mut self, keyword: &str) {
        match self.peek() {
            Some(token) if token.kind == RawKind::Quoted => {
                let name = unquoted(self.slice(token));
                self.take(Tok::Quoted(name));
            }
            Some(token)
                if token.kind == RawKind::Word
                    && !(token.first_on_line
                        && (self.header_keyword(self.at) || self.kind_at(self.at + 1) == Some(RawKind::Colon)))
                    && !self.header_keyword(self.at) =>
            {
                if !self.numbered_block() {
                    let name = self.slice(token);
                    self.take(Tok::Name(name));
                }
            }
            // `FUNCTION_BLOCK 10`
            Some(token) if token.kind == RawKind::Number && !token.first_on_line => {
                let number = self.slice(token);
                let known = BLOCK_LETTERS.iter().find(|(word, ..)| word.eq_ignore_ascii_case(keyword));
                let (_, letters, prefix) = known.copied().unwrap_or(BLOCK_LETTERS[0]);
                self.report(
                    Diagnostic::new(Code::BlockFrame, self.span(token), "the letters before the number are missing")
                        .label("only a number")
                        .help(format!("write `{keyword} {letters} {number}`")),
                );
                self.take(Tok::Block(prefix, number.replace('_', "").parse().unwrap_or(u32::MAX)));
            }
            found => {
                let end = self.last_end();
                let span = match found {
                    Some(token) if !token.first_on_line => self.span(token),
                    _ => self.span_of(end - keyword.len().min(end), end),
                };
                self.report(
                    Diagnostic::new(Code::BlockFrame, span, format!("no block name follows `{keyword}`"))
                        .label("the block's number or name is missing")
                        .help("write e.g. `FUNCTION FC 1 : VOID`, `DATA_BLOCK DB 10` or `FUNCTION_BLOCK \"Motor\"`"),
                );
                if found.is_some_and(|token| !token.first_on_line && matches!(token.kind, RawKind::UnterminatedQuoted))
                {
                    self.at += 1;
                }
                self.push(end, Tok::Name(""), end);
            }
        }
    }

    /// Takes `FC 7`, `FC7`; `false`: it is a name.
    pub(super) fn numbered_block(&mut self) -> bool {
        let token = self.raw[self.at];
        let word = self.slice(token);
        let upper = self.upper(self.at);
        let (letters, digits) = letters_and_digits(upper.as_str());
        let Some(prefix) = block_prefix(letters) else { return false };
        let beside = |index: usize| self.raw_at(index).filter(|next| !next.first_on_line);
        let (number, end, count) = if digits.is_empty() {
            match (beside(self.at + 1), beside(self.at + 2)) {
                (Some(next), _) if next.kind == RawKind::Number => (self.slice(next), next.end, 2),
                // `FC -1`
                (Some(sign), Some(next))
                    if sign.kind == RawKind::Minus && next.kind == RawKind::Number && sign.end == next.start =>
                {
                    ("", next.end, 3)
                }
                _ => return false,
            }
        } else {
            (&word[letters.len()..], token.end, 1)
        };
        self.at += count;
        let tok = match number.replace('_', "").parse::<u32>() {
            Ok(number) if number < u32::MAX => Tok::Block(prefix, number),
            _ => {
                let span = self.span_of(token.start as usize, end as usize);
                self.report(
                    Diagnostic::new(Code::LiteralRange, span, "no block can have this number")
                        .label(if number.is_empty() { "below 0" } else { "too large" })
                        .help("blocks are numbered 0 to 65535"),
                );
                Tok::Block(prefix, u32::MAX)
            }
        };
        self.push(token.start as usize, tok, end as usize);
        true
    }

    /// The block's own end, or whatever is there instead.
    fn end_of_block(&mut self, opening: RawToken, end_word: &str) {
        let end = self.last_end();
        let keyword = self.slice(opening);
        if let Some(token) = self.peek() {
            let upper = self.upper(self.at);
            if upper.as_str() == end_word {
                return self.take(Tok::EndBlock);
            }
            if is_end_of_block(upper.as_str()) {
                // What PROGRAM is to be has been said.
                if end_word == "END_PROGRAM" {
                    return self.take(Tok::EndBlock);
                }
                let found = self.slice(token);
                self.report(
                    Diagnostic::new(
                        Code::BlockFrame,
                        self.span(token),
                        format!("`{found}` cannot end {}", with_article(&format!("`{keyword}`"))),
                    )
                    .label("the block ends here")
                    .also(self.span(opening), "the block begins here")
                    .help(format!("write `{end_word}`")),
                );
                return self.take(Tok::EndBlock);
            }
        }
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(opening), format!("the block is not closed with `{end_word}`"))
                .label("begins here")
                .help(format!("write `{end_word}` after the last line of the block")),
        );
        self.push(end, Tok::EndBlock, end);
    }
}
