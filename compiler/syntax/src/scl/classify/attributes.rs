//! Classifies lists of attributes: `{ name := 'value'; name := 'value' }`.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, unquoted};
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::Tok;

impl Classifier<'_, '_> {
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
