//! Classifies the words of a header, and which part of the block follows it.

use plcc_diag::{Code, Diagnostic, Span};

use super::Classifier;
use super::expression::Run;
use crate::front::frame::{self, not_in_header};
use crate::front::frame_words;
use crate::scl::address;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::{HeaderField, HeaderFlag, Tok};

/// What follows a block's header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Frame {
    Code,
    Data,
    Type,
}

/// How far a header is looked through for its end: each of its lines may be one that no header has.
const HEADER_TOKENS_MAX: usize = 200;

impl Classifier<'_, '_> {
    /// Everything after the name: header, declarations, then statements or values.
    pub(super) fn header(&mut self, frame: Frame) {
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
                (RawKind::Word, None) if token.first_on_line && self.constants_in_one_word(token) => has_content = true,
                (RawKind::Word, None) if token.first_on_line && self.misspelt_header(frame) => {}
                (RawKind::Word, None) if frame == Frame::Data && !has_content && self.letters_before_name(token) => {}
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
                (RawKind::LeftParen, _) if frame == Frame::Type && !has_content && self.enumeration(token) => {
                    has_content = true;
                }
                (RawKind::Word | RawKind::Local | RawKind::Quoted, _)
                    if frame == Frame::Code && token.first_on_line && self.declarations_without_section() =>
                {
                    has_content = true;
                    self.section_without_keyword(token);
                }
                (_, Some(Keyword::EndVar)) if frame == Frame::Code => self.ends_no_section(token),
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

    /// `TYPE "Colour" : (Red, Green);` of other tools; `false`: it is something else.
    fn enumeration(&mut self, opening: RawToken) -> bool {
        let rest = self.raw.iter().enumerate().skip(self.at + 1).take(HEADER_TOKENS_MAX);
        let ends = |token: &RawToken| {
            matches!(token.kind, RawKind::RightParen | RawKind::Semicolon)
                || token.keyword.is_some_and(Keyword::ends_block)
        };
        let Some((at, close)) = rest.map(|(at, token)| (at, *token)).find(|(_, token)| ends(token)) else {
            return false;
        };
        let first = self.raw[self.at + 1];
        if close.kind != RawKind::RightParen || !matches!(first.kind, RawKind::Word | RawKind::Quoted) {
            return false;
        }
        let first = self.slice(first).trim_matches('"');
        self.report(
            Diagnostic::new(
                Code::ForeignForm,
                self.span_of(opening.start as usize, close.end as usize),
                "STEP 7 has no enumerated types",
            )
            .label("read as INT")
            .help(format!(
                "declare the values as constants, as `VAR CONSTANT {first} : INT := 0; END_VAR` or in a tag table, and \
                 write INT in place of the type"
            )),
        );
        self.at = at + 1;
        let is_rest = |token: RawToken| {
            token.kind != RawKind::Semicolon && !token.first_on_line && !token.keyword.is_some_and(Keyword::ends_block)
        };
        while self.peek().is_some_and(is_rest) {
            self.at += 1;
        }
        self.push_here(Tok::Content);
        self.push_here(Tok::Name("INT"));
        if self.is_at(RawKind::Semicolon) {
            self.take(Tok::End);
        } else {
            self.push_here(Tok::End);
        }
        true
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

    /// Whether the word at `index` belongs to headers.
    pub(super) fn header_keyword(&self, index: usize) -> bool {
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

    /// Pragmas in the head of a data block or type belong to the file; those before statements belong to them.
    fn file_pragmas_of_frame(&mut self, before: u32, frame: Frame) {
        if frame != Frame::Code {
            self.file_pragmas(before);
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

    /// `VAR_CONSTANT`, alone on its line.
    fn constants_in_one_word(&mut self, word: RawToken) -> bool {
        let text = self.slice(word);
        let is_meant = ["VAR_CONSTANT", "VAR_CONSTANTS", "VAR_CONST"].iter().any(|own| own.eq_ignore_ascii_case(text));
        let alone = self.raw.get(self.at + 1).is_none_or(|next| next.first_on_line);
        if is_meant && alone {
            self.report(frame_words::misspelt(self.span(word), text, "VAR CONSTANT"));
            self.constant_section(word, Keyword::EndVar);
        }
        is_meant && alone
    }

    /// `DATA_BLOCK "M1" FB "Motor"`
    fn letters_before_name(&mut self, letters: RawToken) -> bool {
        let text = self.slice(letters);
        let is_block = ["FB", "SFB", "UDT"].iter().any(|own| own.eq_ignore_ascii_case(text));
        let next = self.raw.get(self.at + 1).filter(|next| is_block && next.kind == RawKind::Quoted).copied();
        let Some(next) = next else { return false };
        let (name, ty) = (self.last_token().map_or("", |name| self.slice(name)), self.slice(next));
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(letters), format!("`{text}` is not written before a name"))
                .label("read without it")
                .help(format!("write `DATA_BLOCK {name} {ty}`")),
        );
        self.at += 1;
        true
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

    /// Reports a form that STEP 7 does not accept but that has only one meaning.
    pub(super) fn tolerate(&mut self, span: Span, title: &str, label: &str, help: &str) {
        self.report(Diagnostic::new(Code::Tolerated, span, title).label(label).help(help));
    }
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
