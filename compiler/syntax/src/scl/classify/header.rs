//! Classifies the words of a block: its name, its header, and which part follows.

use plcc_diag::{Code, Diagnostic, Span};

use super::expression::Run;
use super::{Classifier, unquoted};
use crate::article::with_article;
use crate::front;
use crate::front::frame::{self, not_in_header};
use crate::scl::address;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::{CodeKeyword, HeaderField, HeaderFlag, Tok};

/// What follows a block's header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Frame {
    Code,
    Data,
    Type,
}

/// How far a header is looked through for its end: each of its lines may be one that no header has.
const HEADER_TOKENS_MAX: usize = 200;

impl<'a> Classifier<'a, '_> {
    /// A block from its keyword to its end.
    pub(super) fn block(&mut self) {
        let opening = self.raw[self.at];
        let keyword = opening.keyword.expect("the caller saw the keyword");
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
        if keyword == Keyword::Function {
            if self.is_at(RawKind::Colon) {
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

    /// Whether the word at `index` belongs to headers.
    fn header_keyword(&self, index: usize) -> bool {
        let Some(token) = self.raw.get(index).copied() else { return false };
        if token.kind != RawKind::Word {
            return false;
        }
        let word = self.slice(token);
        header_field(word).is_some() && self.kind_at(index + 1) == Some(RawKind::Colon)
            || header_flag(word).is_some() && self.flag_stands_alone(index)
    }

    /// The word at `index` is not an operand of a statement.
    fn flag_stands_alone(&self, index: usize) -> bool {
        !matches!(
            self.kind_at(index + 1),
            Some(
                RawKind::Assign
                    | RawKind::Dot
                    | RawKind::LeftParen
                    | RawKind::LeftBracket
                    | RawKind::Colon
                    | RawKind::Comma
                    | RawKind::AddAssign
            )
        )
    }

    /// Everything after the name: header, declarations, then statements or values.
    fn header(&mut self, frame: Frame) {
        let mut has_content = false;
        while let Some(token) = self.peek() {
            self.file_pragmas_of_frame(token.start, frame);
            match (token.kind, token.keyword) {
                (RawKind::Title, _) => {
                    let text = title_text(self.slice(token));
                    self.take(Tok::Title(text));
                }
                (RawKind::LeftBrace, _) => self.attributes(),
                (_, Some(word)) if word.ends_block() || self.block_begins(self.at) => break,
                (_, Some(Keyword::Begin)) => {
                    self.begin(frame);
                    return;
                }
                (_, Some(word)) if word.begins_section() => {
                    has_content = true;
                    self.section();
                }
                (RawKind::Word, _) if self.header_keyword(self.at) => self.header_word(token),
                (RawKind::Word, None) if token.first_on_line && self.misspelt_header(frame) => {}
                (RawKind::Semicolon, _) if frame != Frame::Code => self.at += 1,
                (RawKind::Colon, _) if frame == Frame::Data && !has_content && self.type_after_colon() => {
                    self.colon_before_type(token);
                }
                (RawKind::Word | RawKind::Quoted, _)
                    if frame != Frame::Code
                        && !has_content
                        && token.first_on_line
                        && self.kind_at(self.at + 1) == Some(RawKind::Colon) =>
                {
                    has_content = true;
                    self.bare_components(token);
                }
                (RawKind::Word | RawKind::Quoted | RawKind::Local, _) if frame != Frame::Code && !has_content => {
                    has_content = true;
                    self.content();
                }
                _ if frame == Frame::Code && !has_content && self.header_goes_on() => self.skip_line_of_header(token),
                _ if frame == Frame::Code => break,
                _ => self.skip_in_header(frame),
            }
        }
        if frame == Frame::Code {
            self.push_here(Tok::Begin);
            self.collect_labels();
            self.code();
        }
    }

    /// Pragmas in the head of a data block or type belong to the file; those before statements belong to them.
    fn file_pragmas_of_frame(&mut self, before: u32, frame: Frame) {
        if frame != Frame::Code {
            self.file_pragmas(before);
        }
    }

    fn begin(&mut self, frame: Frame) {
        match frame {
            Frame::Code => {
                let start = self.raw[self.at].start;
                // Pragmas between declarations do not belong to statements.
                self.file_pragmas(start);
                self.take(Tok::Begin);
                self.collect_labels();
                self.code();
            }
            Frame::Data => {
                self.take(Tok::Begin);
                self.values();
            }
            Frame::Type => {
                self.at += 1;
                while let Some(token) = self.peek() {
                    if token.keyword.is_some_and(Keyword::ends_block) || self.block_begins(self.at) {
                        break;
                    }
                    self.skip_in_header(frame);
                }
            }
        }
    }

    /// `DATA_BLOCK "M1" : "Motor"`: whether a type follows the colon.
    fn type_after_colon(&self) -> bool {
        let next = self.raw.get(self.at + 1);
        next.is_some_and(|next| matches!(next.kind, RawKind::Word | RawKind::Quoted) && !next.first_on_line)
    }

    fn colon_before_type(&mut self, colon: RawToken) {
        let name = self.last_token().map_or("", |name| self.slice(name));
        let ty = self.raw.get(self.at + 1).map_or("", |ty| self.slice(*ty));
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(colon), "a data block has no `:` before its type")
                .label("read without it")
                .help(format!("write `DATA_BLOCK {name} {ty}`")),
        );
        self.at += 1;
    }

    /// Components without `STRUCT` around them.
    fn bare_components(&mut self, first: RawToken) {
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(first), "`STRUCT` is missing before the components")
                .label("the first component")
                .help("write `STRUCT` on a line before it, and `END_STRUCT;` after the last component"),
        );
        self.push_here(Tok::Content);
        self.push_here(Tok::Struct);
        self.declarations(1);
        if self.keyword_at(self.at) == Some(Keyword::EndStruct) {
            self.take(Tok::EndStruct);
        } else {
            self.push_here(Tok::EndStruct);
        }
        if self.is_at(RawKind::Semicolon) {
            self.take(Tok::End);
        } else {
            self.push_here(Tok::End);
        }
    }

    /// `STRUCT … END_STRUCT`, `ARRAY[…] OF …`, or the name of a UDT or FB.
    fn content(&mut self) {
        self.push_here(Tok::Content);
        self.type_tokens();
        if self.is_at(RawKind::Assign) {
            self.take(Tok::Assign);
            self.run(Run::Value);
        }
        if self.is_at(RawKind::Semicolon) {
            self.take(Tok::End);
        } else {
            self.push_here(Tok::End);
        }
    }

    /// A line of the header whose word is misspelt or has no colon: reported and skipped.
    fn misspelt_header(&mut self, frame: Frame) -> bool {
        let token = self.raw[self.at];
        let (span, word) = (self.span(token), self.slice(token));
        let next = self.raw.get(self.at + 1).filter(|next| !next.first_on_line);
        let message = match next.map(|next| next.kind) {
            Some(RawKind::Colon | RawKind::Equal) => frame::misspelt_in_header(span, word),
            Some(RawKind::Number | RawKind::Real | RawKind::Text)
                if frame == Frame::Code && header_field(word).is_some() =>
            {
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

    /// Whether declarations or BEGIN follow soon, with no statement before them, so this is a part of the header.
    fn header_goes_on(&self) -> bool {
        let mut inside = false;
        for (index, token) in self.raw.iter().enumerate().skip(self.at).take(HEADER_TOKENS_MAX) {
            match (token.kind, token.keyword) {
                (RawKind::LeftBrace, _) => inside = true,
                (RawKind::RightBrace, _) => inside = false,
                (RawKind::Assign | RawKind::Semicolon, _) if !inside => return false,
                (_, Some(Keyword::Begin)) => return token.first_on_line,
                (_, Some(word)) if word.begins_section() => return token.first_on_line,
                (_, Some(_)) if index > self.at => return false,
                _ => {}
            }
        }
        false
    }

    /// Reports and skips a line that no header has.
    fn skip_line_of_header(&mut self, token: RawToken) {
        let word = self.slice(token);
        if self.kind_at(self.at + 1) == Some(RawKind::Equal) && header_field(word).is_some() {
            let line = self.text[self.raw[self.at + 1].end as usize..].lines().next().unwrap_or_default();
            self.report(
                Diagnostic::new(
                    Code::BlockFrame,
                    self.span(token),
                    format!("`{word}` is given with `:`, not with `=`"),
                )
                .label("a part of the header")
                .help(format!("write `{word} : {}`", line.trim())),
            );
            return self.skip_line();
        }
        let help = match address::numbered_block(word) {
            Some(_) => format!("a block has a name or a number: write one of them, such as `{word}`"),
            None => {
                "a header has TITLE, VERSION, AUTHOR, FAMILY and NAME; then come declarations and `BEGIN`".to_owned()
            }
        };
        self.report(not_in_header(self.span(token), "header", word, &help));
        self.skip_line();
    }

    fn skip_line(&mut self) {
        self.at += 1;
        while self.peek().is_some_and(|token| !token.first_on_line) {
            self.at += 1;
        }
    }

    /// Skips text that no header has, up to the next line that begins with a known word.
    fn skip_in_header(&mut self, frame: Frame) {
        let token = self.raw[self.at];
        let what = if frame == Frame::Data { "data block" } else { "data type" };
        let help = if frame == Frame::Data {
            "a data block consists of `STRUCT … END_STRUCT`, VAR sections, an ARRAY, or the name of a UDT or FB, then `BEGIN` and values"
        } else {
            "a data type consists of `STRUCT … END_STRUCT;`"
        };
        self.report(not_in_header(self.span(token), what, self.slice(token), help));
        self.at += 1;
        while let Some(token) = self.peek() {
            let ends = token.keyword.is_some_and(|word| {
                word.ends_block() || word.begins_section() || matches!(word, Keyword::Begin | Keyword::Struct)
            });
            if ends || self.block_begins(self.at) {
                return;
            }
            self.at += 1;
        }
    }

    fn header_word(&mut self, token: RawToken) {
        let word = self.slice(token);
        if let Some(flag) = header_flag(word) {
            return self.take(Tok::HeaderFlag(flag));
        }
        let field = header_field(word).expect("the caller saw a field or a flag");
        let first = self.at + 2;
        let mut last = first;
        while let Some(next) = self.raw.get(last) {
            if next.first_on_line
                || matches!(next.kind, RawKind::LeftBrace | RawKind::Title)
                || next.keyword.is_some_and(|word| {
                    word.begins_section() || word.ends_block() || matches!(word, Keyword::Begin | Keyword::Struct)
                })
                || last > first && self.header_keyword(last)
            {
                break;
            }
            last += 1;
        }
        let (text, end) = if last > first {
            let (start, end) = (self.raw[first].start as usize, self.raw[last - 1].end as usize);
            (self.text[start..end].trim_end_matches([';', ' ', '\t']).trim_matches(['\'', '"']).trim(), end)
        } else {
            ("", self.raw[self.at + 1].end as usize)
        };
        self.push(token.start as usize, Tok::HeaderText(field, text), end);
        self.at = last;
    }

    /// `{ name := 'value'; name := 'value' }`.
    pub(super) fn attributes(&mut self) {
        let opening = self.raw[self.at];
        self.at += 1;
        loop {
            let Some(token) = self.peek() else { return self.unclosed_attributes(opening) };
            match (token.kind, token.keyword) {
                (RawKind::RightBrace, _) => {
                    self.at += 1;
                    return;
                }
                (RawKind::Semicolon | RawKind::Comma, _) => self.at += 1,
                (_, Some(word))
                    if word.ends_block() || word.begins_section() || word.ends_section() || word == Keyword::Begin =>
                {
                    return self.unclosed_attributes(opening);
                }
                (RawKind::Word | RawKind::Quoted, _) => self.attribute(token),
                _ => {
                    self.report(
                        Diagnostic::new(
                            Code::DeclarationSyntax,
                            self.span(token),
                            format!("a list of attributes cannot contain `{}`", self.slice(token)),
                        )
                        .label("not the name of an attribute")
                        .help("write attributes as `{ name := 'value'; name := 'value' }`"),
                    );
                    self.skip_attribute();
                }
            }
        }
    }

    /// `name := value`; the value may be a text, a word, a number, or several tokens.
    fn attribute(&mut self, name: RawToken) {
        self.at += 1;
        let key = unquoted(self.slice(name));
        if !self.is_at(RawKind::Assign) {
            self.report(
                Diagnostic::new(
                    Code::DeclarationSyntax,
                    self.span(name),
                    format!("the attribute `{key}` has no value"),
                )
                .label("`:=` must follow")
                .help("write attributes as `{ name := 'value'; name := 'value' }`"),
            );
            return self.skip_attribute();
        }
        self.at += 1;
        let first = self.at;
        self.skip_attribute();
        let end = self.last_end();
        let value = match self.raw.get(first) {
            Some(value) if self.at > first => self.text[value.start as usize..end].trim_matches(['\'', '"']),
            _ => "",
        };
        if let Some(meant) = misspelt_attribute(key) {
            self.report(
                Diagnostic::new(Code::AttributeValue, self.span(name), format!("the attribute `{key}` is not known"))
                    .label("has no effect")
                    .help(format!("is `{meant}` meant?")),
            );
        }
        self.push(name.start as usize, Tok::Attribute(key, value), end);
    }

    fn skip_attribute(&mut self) {
        while let Some(token) = self.peek() {
            let ends =
                token.keyword.is_some_and(|word| word.ends_block() || word.begins_section() || word.ends_section());
            if ends || matches!(token.kind, RawKind::Semicolon | RawKind::Comma | RawKind::RightBrace) {
                return;
            }
            self.at += 1;
        }
    }

    fn unclosed_attributes(&mut self, opening: RawToken) {
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, self.span(opening), "the attribute list is not closed")
                .label("begins here")
                .help("close it with `}`"),
        );
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

    /// Reports a form that STEP 7 does not accept but that has only one meaning.
    pub(super) fn tolerate(&mut self, span: Span, title: &str, label: &str, help: &str) {
        self.report(Diagnostic::new(Code::Tolerated, span, title).label(label).help(help));
    }
}

/// The attribute with an effect that `key` is a slip of. Many others are known to the tools of Siemens only.
fn misspelt_attribute(key: &str) -> Option<&'static str> {
    const EFFECTIVE: [&str; 9] = [
        "S7_Optimized_Access",
        "S7_IECCheck",
        "SetENOAutomatically",
        "SCL_SetOKFlag",
        "S7_EventClass",
        "SecondaryType",
        "S7_StandardRetain",
        "S7_BlockNumber",
        "S7_PreferredLanguage",
    ];
    const OTHERS: [&str; 5] =
        ["S7_SetENOAutomatically", "S7_Optimized", "BlockNumber", "ProgrammingLanguage", "S7_Language"];
    let known = EFFECTIVE.iter().chain(&OTHERS).any(|known| known.eq_ignore_ascii_case(key));
    if known { None } else { crate::front::frame_words::slip_of(key, EFFECTIVE) }
}

/// Text after `TITLE` and `=`, without quotes.
fn title_text(token: &str) -> &str {
    let text = token.get("TITLE".len()..).unwrap_or("").trim();
    let text = text.strip_prefix('=').unwrap_or(text).trim();
    match text.strip_prefix('\'').and_then(|text| text.strip_suffix('\'')) {
        Some(inner) if !inner.contains('\'') => inner,
        _ => text,
    }
}

fn header_field(word: &str) -> Option<HeaderField> {
    const FIELDS: [(&str, HeaderField); 4] = [
        ("AUTHOR", HeaderField::Author),
        ("FAMILY", HeaderField::Family),
        ("NAME", HeaderField::Name),
        ("VERSION", HeaderField::Version),
    ];
    FIELDS.iter().find(|(name, _)| name.eq_ignore_ascii_case(word)).map(|(_, field)| *field)
}

/// A single word of the header.
fn header_flag(word: &str) -> Option<HeaderFlag> {
    const FLAGS: [(&str, HeaderFlag); 7] = [
        ("KNOW_HOW_PROTECT", HeaderFlag::KnowHowProtect),
        ("STANDARD", HeaderFlag::Standard),
        ("CODE_VERSION1", HeaderFlag::CodeVersion1),
        ("UNLINKED", HeaderFlag::Unlinked),
        ("READ_ONLY", HeaderFlag::ReadOnly),
        ("NON_RETAIN", HeaderFlag::NonRetain),
        ("RETAIN", HeaderFlag::Retain),
    ];
    FLAGS.iter().find(|(name, _)| name.eq_ignore_ascii_case(word)).map(|(_, flag)| *flag)
}
