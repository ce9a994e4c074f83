//! Classifies the words of a block: its name, its header, and which part follows.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, Frame, is_end_of_block, is_section, unquoted};
use crate::article::with_article;
use crate::ast::BlockPrefix;
use crate::front::frame::{self, not_in_header};
use crate::stl::mnemonics::{block_prefix, letters_and_digits};
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::{CodeKeyword, HeaderField, HeaderFlag, Tok};

/// Tokens of a type after the name of a data block, and the one after it.
const TYPE_TOKENS_MAX: usize = 8;

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
            Frame::Data => self.colon_before_type(opening),
            Frame::Type => {}
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

    /// `DATA_BLOCK DB 1 : "Motor"`, if it has no structure of its own.
    fn colon_before_type(&mut self, opening: RawToken) {
        let Some(colon) = self.peek().filter(|token| token.kind == RawKind::Colon && !token.first_on_line) else {
            return;
        };
        let mut rest = self.raw.iter().enumerate().skip(self.at + 1).take(TYPE_TOKENS_MAX);
        let next_line = rest.find(|(_, token)| token.first_on_line).map_or(usize::MAX, |(at, _)| at);
        if next_line == self.at + 1 || self.upper(next_line).as_str() == "STRUCT" {
            return;
        }
        let head = self.text[opening.start as usize..colon.start as usize].trim_end();
        let ty = self.text[colon.end as usize..].lines().next().unwrap_or_default().trim();
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(colon), "a data block has no `:` before its type")
                .label("read without it")
                .help(format!("write `{head} {ty}`")),
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

    /// Whether the word at `index` belongs to headers.
    pub(super) fn header_keyword(&self, index: usize) -> bool {
        let upper = self.upper(index);
        let word = upper.as_str();
        let field = header_field(word).is_some() && self.kind_at(index + 1) == Some(RawKind::Colon);
        field
            || header_flag(word).is_some()
            || is_section(word)
            || is_end_of_block(word)
            || matches!(word, "BEGIN" | "NETWORK")
    }

    /// Everything after the name: header, declarations, then code or values.
    fn header(&mut self, frame: Frame) {
        let mut has_content = false;
        while let Some(token) = self.peek() {
            self.file_pragmas(token.start);
            let upper = self.upper(self.at);
            let word = upper.as_str();
            match token.kind {
                RawKind::Semicolon => self.at += 1,
                RawKind::Title => {
                    let text = title_text(self.slice(token));
                    self.take(Tok::Title(text));
                }
                RawKind::LeftBrace => self.attributes(),
                RawKind::Word if word == "TITLE" => self.title_without_sign(),
                RawKind::Word if is_end_of_block(word) || self.block_keyword(self.at).is_some() => return,
                RawKind::Word if word == "BEGIN" => {
                    self.take(Tok::Begin);
                    match frame {
                        Frame::Code => self.code(),
                        Frame::Data => self.values(),
                        Frame::Type => {}
                    }
                    return;
                }
                RawKind::Word if word == "CONST" && token.first_on_line && frame == Frame::Code => {
                    self.no_constants(token)
                }
                RawKind::Word if is_section(word) => {
                    has_content = true;
                    self.section();
                }
                RawKind::Word
                    if header_field(word).is_some()
                        && matches!(self.kind_at(self.at + 1), Some(RawKind::Colon | RawKind::Equal)) =>
                {
                    self.header_text();
                }
                RawKind::Word if header_flag(word).is_some() => {
                    let flag = header_flag(word).expect("the guard saw it");
                    self.take(Tok::HeaderFlag(flag));
                }
                RawKind::Word if frame != Frame::Code && word == "STRUCT" => {
                    has_content = true;
                    self.top_struct();
                }
                RawKind::Word if frame == Frame::Code && self.chart_begins() => return self.skip_chart(),
                RawKind::Word if token.first_on_line && self.misspelt_header(frame) => {}
                RawKind::Word | RawKind::Quoted
                    if frame != Frame::Code && !has_content && self.kind_at(self.at + 1) == Some(RawKind::Colon) =>
                {
                    has_content = true;
                    self.struct_not_opened(token);
                }
                RawKind::Word | RawKind::Quoted if frame == Frame::Data && !has_content => {
                    has_content = true;
                    self.type_name();
                }
                RawKind::Word | RawKind::Quoted if frame == Frame::Code && self.declarations_without_section() => {
                    self.section_without_keyword(token);
                }
                RawKind::Word if frame == Frame::Code && word == "END_VAR" => {
                    self.report(frame::ends_no_section(self.span(token), self.slice(token)));
                    self.at += 1;
                }
                _ if frame == Frame::Code && self.line_before_declarations() => {
                    let help =
                        "a header has TITLE, VERSION, AUTHOR, FAMILY and NAME; then come declarations and `BEGIN`";
                    self.report(not_in_header(self.span(token), "header", self.slice(token), help));
                    self.skip_line();
                }
                _ if frame == Frame::Code => {
                    let span = self.span(token);
                    self.report(
                        Diagnostic::new(Code::BlockFrame, span, "`BEGIN` is missing before the statements")
                            .label("statements begin here")
                            .help("write `BEGIN` on a line between the declarations and the first statement"),
                    );
                    let start = token.start as usize;
                    self.push(start, Tok::Begin, start);
                    return self.code();
                }
                _ => self.skip_in_header(frame),
            }
        }
    }

    /// Whether the first part of a chart is here: `INITIAL_STEP Wait`. Function blocks with charts are read elsewhere.
    fn chart_begins(&self) -> bool {
        let named = self.raw_at(self.at + 1).is_some_and(|name| !name.first_on_line && name.kind == RawKind::Word);
        named
            && self.peek().is_some_and(|token| token.first_on_line)
            && matches!(self.upper(self.at).as_str(), "INITIAL_STEP" | "STEP" | "TRANSITION")
    }

    fn skip_chart(&mut self) {
        let span = self.span(self.raw[self.at]);
        self.report(
            Diagnostic::new(Code::BlockFrame, span, "a chart of GRAPH is a function block")
                .label("a chart begins here")
                .help("begin the block with `FUNCTION_BLOCK` and its name, and end it with `END_FUNCTION_BLOCK`"),
        );
        while self.peek().is_some_and(|token| {
            let next_begins = token.first_on_line && self.block_keyword(self.at).is_some();
            !(next_begins || is_end_of_block(self.upper(self.at).as_str()))
        }) {
            self.at += 1;
        }
    }

    /// `CONST … END_CONST` of SCL, which is reported and skipped.
    fn no_constants(&mut self, token: RawToken) {
        self.report(
            Diagnostic::new(Code::ForeignForm, self.span(token), "STL has no section CONST")
                .label("a form of SCL")
                .help("write `VAR CONSTANT`, `name : type := value;` for each constant, and `END_VAR`"),
        );
        self.at += 1;
        while self.peek().is_some() && !self.header_keyword(self.at) {
            let ends = self.upper(self.at).as_str() == "END_CONST";
            self.at += 1;
            if ends {
                return;
            }
        }
    }

    /// A line of the header whose word is misspelt or has no colon: reported and skipped.
    fn misspelt_header(&mut self, frame: Frame) -> bool {
        let token = self.raw[self.at];
        let (span, word) = (self.span(token), self.slice(token));
        let next = self.raw_at(self.at + 1).filter(|next| !next.first_on_line);
        let message = match next.map(|next| next.kind) {
            Some(RawKind::Colon | RawKind::Equal) => frame::misspelt_in_header(span, word),
            Some(_) if frame == Frame::Code && header_field(self.upper(self.at).as_str()).is_some() => {
                let line = self.text[token.end as usize..].lines().next().unwrap_or_default();
                Some(frame::no_colon_in_header(span, word, line.trim()))
            }
            _ => None,
        };
        let Some(message) = message else { return false };
        self.report(message);
        self.skip_line();
        true
    }

    fn skip_line(&mut self) {
        self.at += 1;
        while self.peek().is_some_and(|token| !token.first_on_line) {
            self.at += 1;
        }
    }

    /// Whether only the rest of this line is between the header and a section or BEGIN.
    fn line_before_declarations(&self) -> bool {
        let next = (self.at + 1..self.raw.len()).find(|index| self.raw[*index].first_on_line);
        next.is_some_and(|next| {
            let upper = self.upper(next);
            is_section(upper.as_str()) || upper.as_str() == "BEGIN"
        })
    }

    /// Skips text that no header has, up to the next line that begins with a known word.
    fn skip_in_header(&mut self, frame: Frame) {
        let token = self.raw[self.at];
        let what = if frame == Frame::Data { "data block" } else { "data type" };
        let help = match frame {
            Frame::Data => {
                "a data block consists of `STRUCT … END_STRUCT` or the name of a UDT or FB, then `BEGIN` and values"
            }
            Frame::Code | Frame::Type => "a data type consists of `STRUCT … END_STRUCT;`",
        };
        self.report(not_in_header(self.span(token), what, self.slice(token), help));
        self.at += 1;
        while let Some(token) = self.peek() {
            let upper = self.upper(self.at);
            let ends = is_end_of_block(upper.as_str()) || self.block_keyword(self.at).is_some();
            if ends || token.first_on_line && (self.header_keyword(self.at) || upper.as_str() == "STRUCT") {
                return;
            }
            self.at += 1;
        }
    }

    /// `TITLE : text`, `TITLE text`: accepted as `TITLE = text`.
    pub(super) fn title_without_sign(&mut self) {
        let start = self.raw[self.at].start as usize;
        self.at += 1;
        if self.peek().is_some_and(|token| !token.first_on_line && token.kind == RawKind::Colon) {
            self.at += 1;
        }
        let text_start = self.last_end();
        while self.peek().is_some_and(|token| !token.first_on_line) {
            self.at += 1;
        }
        let end = self.last_end();
        let title = self.text[text_start..end].trim();
        self.push(start, Tok::Title(title), end);
    }

    /// `AUTHOR : text`: to the end of the line, or to the next header keyword on it.
    fn header_text(&mut self) {
        let token = self.raw[self.at];
        let field = header_field(self.upper(self.at).as_str()).expect("the caller saw it");
        let first = self.at + 2;
        let mut last = first;
        while let Some(next) = self.raw_at(last) {
            let standard = self.upper(last).as_str() == "STANDARD";
            if next.first_on_line
                || next.kind == RawKind::LeftBrace
                || next.kind == RawKind::Title
                || self.header_keyword(last) && !standard
            {
                break;
            }
            last += 1;
        }
        let (text, end) = match (self.raw_at(first), last > first) {
            (Some(begin), true) => {
                let end = self.raw[last - 1].end as usize;
                (self.text[begin.start as usize..end].trim_end_matches([';', ' ', '\t']).trim_matches('\'').trim(), end)
            }
            _ => ("", self.raw[self.at + 1].end as usize),
        };
        self.push(token.start as usize, Tok::HeaderText(field, text), end);
        self.at = last;
    }

    /// `{ name := 'value'; name := 'value' }`.
    pub(super) fn attributes(&mut self) {
        let opening = self.raw[self.at];
        self.take(Tok::LeftBrace);
        while let Some(token) = self.peek() {
            let upper = self.upper(self.at);
            let word = upper.as_str();
            let value = matches!(self.last(), Some(Tok::Assign));
            match token.kind {
                RawKind::RightBrace => {
                    if matches!(self.last(), Some(Tok::AttributeEnd)) {
                        self.out.pop();
                    }
                    return self.take(Tok::RightBrace);
                }
                RawKind::Semicolon | RawKind::Comma => {
                    if matches!(self.last(), Some(Tok::AttributeEnd | Tok::LeftBrace)) {
                        self.at += 1;
                    } else {
                        self.take(Tok::AttributeEnd);
                    }
                }
                // `name { attribute := 'value' : INT;`, and the next line of the header.
                RawKind::Colon | RawKind::Title => break,
                RawKind::Word if !value && self.kind_at(self.at + 1) == Some(RawKind::Colon) => break,
                RawKind::Assign => self.take(Tok::Assign),
                RawKind::Equal => {
                    self.equal_for_assign();
                }
                RawKind::Text | RawKind::Quoted | RawKind::UnterminatedText if value => {
                    let text = self.slice(token).trim_matches(['\'', '"']);
                    self.take(Tok::AttributeValue(text));
                }
                _ if is_end_of_block(word) || is_section(word) || word == "BEGIN" || word == "END_VAR" => break,
                RawKind::Quoted => {
                    let name = unquoted(self.slice(token));
                    self.take(Tok::Name(name));
                }
                _ if value => {
                    let text = self.slice(token);
                    self.take(Tok::AttributeValue(text));
                }
                RawKind::Word => {
                    let name = self.slice(token);
                    self.take(Tok::Name(name));
                }
                _ => {
                    let text = self.slice(token);
                    self.take(Tok::AttributeValue(text));
                }
            }
        }
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, self.span(opening), "the attribute list is not closed")
                .label("begins here")
                .help("close it with `}`"),
        );
        if matches!(self.last(), Some(Tok::AttributeEnd)) {
            self.out.pop();
        }
        let end = self.last_end();
        self.push(end, Tok::RightBrace, end);
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

/// Words that begin a block, with the letters of its number.
const BLOCK_LETTERS: [(&str, &str, BlockPrefix); 5] = [
    ("FUNCTION_BLOCK", "FB", BlockPrefix::Fb),
    ("FUNCTION", "FC", BlockPrefix::Fc),
    ("ORGANIZATION_BLOCK", "OB", BlockPrefix::Ob),
    ("DATA_BLOCK", "DB", BlockPrefix::Db),
    ("TYPE", "UDT", BlockPrefix::Udt),
];

/// Text after `TITLE =`.
pub(super) fn title_text(token: &str) -> &str {
    token.split_once('=').map_or("", |(_, text)| text.trim())
}

fn header_field(word: &str) -> Option<HeaderField> {
    Some(match word {
        "AUTHOR" => HeaderField::Author,
        "FAMILY" => HeaderField::Family,
        "NAME" => HeaderField::Name,
        "VERSION" => HeaderField::Version,
        _ => return None,
    })
}

fn header_flag(word: &str) -> Option<HeaderFlag> {
    Some(match word {
        "KNOW_HOW_PROTECT" => HeaderFlag::KnowHowProtect,
        "STANDARD" => HeaderFlag::Standard,
        "CODE_VERSION1" => HeaderFlag::CodeVersion1,
        "UNLINKED" => HeaderFlag::Unlinked,
        "READ_ONLY" => HeaderFlag::ReadOnly,
        "NON_RETAIN" => HeaderFlag::NonRetain,
        _ => return None,
    })
}
