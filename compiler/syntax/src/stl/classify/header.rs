//! Classifies the words of the header of a block, and which part follows.

use plcc_diag::{Code, Diagnostic, Severity, Span};

use super::{Classifier, Frame, is_end_of_block, is_section, unquoted};
use crate::front::frame::{self, not_in_header};
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::{HeaderField, HeaderFlag, Tok};

impl<'a> Classifier<'a, '_> {
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
    pub(super) fn header(&mut self, frame: Frame) {
        let mut has_content = false;
        let mut title = None;
        while let Some(token) = self.peek() {
            self.file_pragmas(token.start);
            let upper = self.upper(self.at);
            let word = upper.as_str();
            match token.kind {
                RawKind::Semicolon => self.at += 1,
                RawKind::Title | RawKind::Word if token.kind == RawKind::Title || word == "TITLE" => {
                    match title {
                        None => title = Some(self.title()),
                        Some(first) => {
                            // The block is complete, whichever of them is meant.
                            let message = self.second_title("block", first);
                            self.report(Diagnostic { severity: Severity::Warning, ..message });
                        }
                    }
                }
                RawKind::LeftBrace => self.attributes(),
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

    /// Declarations after `BEGIN`, which are reported, count as if they were before `BEGIN`, unless too many statements come first.
    pub(super) fn section_after_begin(&mut self) {
        const TOKENS_MAX: usize = 4000;
        self.end_of_label();
        let end = self.out.len();
        let mut tokens = self.out.iter().enumerate().rev().take(TOKENS_MAX);
        let last = tokens.find(|(_, (_, token, _))| matches!(token, Tok::Begin | Tok::EndBlock));
        let Some((begin, (_, Tok::Begin, _))) = last else { return self.skip_section() };
        while is_section(self.upper(self.at).as_str()) {
            self.section();
        }
        let sections = self.out.split_off(end);
        self.out.splice(begin..begin, sections);
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

    /// Takes a title. Where it is.
    pub(super) fn title(&mut self) -> Span {
        let (span, text) = self.title_text();
        self.push(span.start as usize, Tok::Title(text), span.end as usize);
        span
    }

    /// The message for a title, which is left out: `what` had one before, `first`.
    pub(super) fn second_title(&mut self, what: &str, first: Span) -> Diagnostic {
        let (span, text) = self.title_text();
        let help = match text {
            "" => "remove it".to_owned(),
            text => format!("write one title; more text is a comment: `// {text}`"),
        };
        Diagnostic::new(Code::Syntax, span, format!("the {what} has a title already"))
            .label("a second title")
            .also(first, "the first one")
            .help(help)
    }

    /// Goes past `TITLE = text`; `TITLE : text` and `TITLE text` are accepted as the same. Where it is, and its text.
    fn title_text(&mut self) -> (Span, &'a str) {
        let token = self.raw[self.at];
        self.at += 1;
        if token.kind == RawKind::Title {
            let text = self.slice(token).split_once('=').map_or("", |(_, text)| text.trim());
            return (self.span(token), text);
        }
        if self.peek().is_some_and(|token| !token.first_on_line && token.kind == RawKind::Colon) {
            self.at += 1;
        }
        let start = self.last_end();
        while self.peek().is_some_and(|token| !token.first_on_line) {
            self.at += 1;
        }
        let end = self.last_end();
        (self.span_of(token.start as usize, end), self.text[start..end].trim())
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
