//! Classifies lists of attributes: `{ name := 'value'; name := 'value' }`.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, unquoted};
use crate::front;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::Tok;

/// A longer list is not looked through for its end.
const LIST_MAX: usize = 400;

impl Classifier<'_, '_> {
    /// `{ name := 'value'; name := 'value' }`.
    pub(super) fn attributes(&mut self) {
        let opening = self.raw[self.at];
        self.at += 1;
        let mut separated = true;
        while let Some(token) = self.peek() {
            match token.kind {
                RawKind::RightBrace => {
                    self.at += 1;
                    return;
                }
                RawKind::Semicolon | RawKind::Comma => {
                    self.at += 1;
                    separated = true;
                }
                _ if !self.attributes_end() => break,
                RawKind::Word | RawKind::Quoted => {
                    if !separated && self.is_attribute_name(token) {
                        self.no_separator(token);
                    }
                    self.attribute(token);
                    separated = false;
                }
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
                    separated = false;
                }
            }
        }
        self.unclosed_attributes(opening);
    }

    /// Goes past a list before the keyword of a block, where a block cannot have it; false: none is here.
    pub(super) fn attributes_before_block(&mut self) -> bool {
        let opening = self.raw[self.at];
        let tokens = self.raw[self.at..].iter().take(LIST_MAX);
        let length = tokens.take_while(|token| token.kind != RawKind::RightBrace).count();
        let block = self.at + length + 1;
        if self.kind_at(block - 1) != Some(RawKind::RightBrace) || !self.block_begins(block) {
            return false;
        }
        self.at = block;
        let head = &self.text[self.raw[block].start as usize..];
        let message = front::frame::attributes_before_block(self.span(opening), head);
        self.report(message);
        true
    }

    /// Reports a list without its end, and goes past its attributes. A text without its quote may have taken the end.
    fn unclosed_attributes(&mut self, opening: RawToken) {
        let mut open_text = None;
        while let Some(token) = self.peek() {
            let next = token.first_on_line && !self.is_attribute_name(token);
            if next || is_outside(token) {
                break;
            }
            if token.kind == RawKind::UnterminatedText {
                open_text = Some(token);
            }
            self.at += 1;
        }
        self.report(match open_text {
            Some(text) => front::unterminated_text(self.span(text)),
            None => Diagnostic::new(Code::DeclarationSyntax, self.span(opening), "the attribute list is not closed")
                .label("begins here")
                .help("close it with `}`"),
        });
    }

    /// Whether a `}` follows before anything that no list of attributes contains.
    pub(super) fn attributes_end(&self) -> bool {
        for token in self.raw[self.at..].iter().take(LIST_MAX) {
            if token.kind == RawKind::RightBrace {
                return true;
            }
            if is_outside(*token) {
                return false;
            }
        }
        self.raw.len() - self.at >= LIST_MAX
    }

    /// Whether the current token, `token`, is followed by `:=`.
    fn is_attribute_name(&self, token: RawToken) -> bool {
        matches!(token.kind, RawKind::Word | RawKind::Quoted) && self.kind_at(self.at + 1) == Some(RawKind::Assign)
    }

    fn no_separator(&mut self, name: RawToken) {
        let key = self.slice(name);
        self.report(
            Diagnostic::new(
                Code::DeclarationSyntax,
                self.span(name),
                format!("`;` is missing before the attribute `{}`", unquoted(key)),
            )
            .label("the next attribute")
            .help(format!("write `; {key}`")),
        );
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
        self.skip_value();
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

    /// Goes to the end of an attribute.
    fn skip_attribute(&mut self) {
        while self.peek().is_some_and(|token| !ends_attribute(token)) {
            self.at += 1;
        }
    }

    /// Goes to the end of a value: the next line and the next `name :=` are not part of it.
    fn skip_value(&mut self) {
        let first = self.at;
        while let Some(token) = self.peek().filter(|token| !ends_attribute(*token)) {
            if self.at > first && (token.first_on_line || self.is_attribute_name(token)) {
                return;
            }
            self.at += 1;
        }
    }
}

fn ends_attribute(token: RawToken) -> bool {
    is_outside(token) || matches!(token.kind, RawKind::Semicolon | RawKind::Comma | RawKind::RightBrace)
}

/// Nothing that a list of attributes can contain.
fn is_outside(token: RawToken) -> bool {
    let ends =
        |word: Keyword| word.ends_block() || word.begins_section() || word.ends_section() || word == Keyword::Begin;
    matches!(token.kind, RawKind::LeftBrace | RawKind::Colon) || token.keyword.is_some_and(ends)
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
