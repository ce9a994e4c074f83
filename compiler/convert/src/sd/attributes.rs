//! Attributes in braces of blocks, networks and declarations, and the texts that some of them name.
//!
//! Those of a document of SIMATIC SD stay as their author wrote them, so that its texts (`.s7res`) stay too.

use plcc_diag::Span;
use plcc_syntax::ast::Header;
use plcc_syntax::network::ast::{Language, Network};
use plcc_syntax::scl::raw::{self, RawKind, RawToken};

use crate::writer::Writer;

/// Titles and comments by their ids.
#[derive(Default)]
pub(super) struct Texts {
    list: Vec<String>,
}

impl Texts {
    /// The attribute for a text.
    fn attribute(&mut self, key: &str, text: &str) -> String {
        self.list.push(text.to_string());
        format!("{key} := \"MLC_{}\"", self.list.len())
    }

    pub(super) fn into_text(self) -> Option<String> {
        if self.list.is_empty() {
            return None;
        }
        let mut out = String::from("MultiLingualTexts:\n");
        for (at, text) in self.list.iter().enumerate() {
            out.push_str(&format!("  - id: MLC_{}\n    en-US: |-\n", at + 1));
            text.lines().for_each(|line| out.push_str(&format!("      {line}\n")));
        }
        Some(out)
    }
}

/// The braces of a document of SIMATIC SD.
pub(crate) struct Braces<'s> {
    source: &'s str,
    tokens: Vec<RawToken>,
    /// Networks may be in another language now.
    is_redrawn: bool,
}

/// An attribute as its author wrote it.
pub(crate) struct Attribute<'s> {
    key: &'s str,
    /// Without quotes.
    value: &'s str,
    /// `key := "value"`
    text: &'s str,
}

impl Attribute<'_> {
    pub(crate) fn is(&self, key: &str) -> bool {
        self.key.eq_ignore_ascii_case(key)
    }
}

impl<'s> Braces<'s> {
    pub(super) fn of(source: &'s str, is_redrawn: bool) -> Braces<'s> {
        Braces { source, tokens: raw::scan(source).tokens, is_redrawn }
    }

    /// The attributes directly before a byte: of a block, a network, or a name that is declared.
    fn before(&self, at: u32) -> Vec<Attribute<'s>> {
        let end = self.tokens.partition_point(|token| token.start < at);
        let Some((close, rest)) = self.tokens[..end].split_last() else { return Vec::new() };
        match rest.iter().rposition(|token| token.kind == RawKind::LeftBrace) {
            Some(open) if close.kind == RawKind::RightBrace => self.list(&rest[open + 1..]),
            _ => Vec::new(),
        }
    }

    /// The attributes after the head of a block, whose name ends at a byte; those before a network are not of the block.
    fn after_head(&self, at: u32) -> Vec<Attribute<'s>> {
        let mut open = self.tokens.partition_point(|token| token.start < at);
        let is = |at: usize, kind: RawKind| self.tokens.get(at).is_some_and(|token| token.kind == kind);
        // `: Void`
        if is(open, RawKind::Colon) {
            open += 2;
        }
        let rest = self.tokens.get(open + 1..).unwrap_or_default();
        let close = rest.iter().position(|token| token.kind == RawKind::RightBrace);
        let Some(close) = close.filter(|_| is(open, RawKind::LeftBrace)) else { return Vec::new() };
        let is_network =
            rest.get(close + 1).is_some_and(|token| token.text(self.source).eq_ignore_ascii_case("NETWORK"));
        if is_network { Vec::new() } else { self.list(&rest[..close]) }
    }

    /// An attribute anywhere in a part of the document.
    fn inside(&self, span: Span, key: &str) -> Option<&'s str> {
        let (from, to) = (self.first_from(span.start), self.first_from(span.end));
        let tokens = self.tokens.get(from..to)?;
        let at = tokens.windows(2).position(|pair| {
            pair[1].kind == RawKind::Assign && pair[0].text(self.source).trim_matches('"').eq_ignore_ascii_case(key)
        })?;
        let ends = |token: &RawToken| matches!(token.kind, RawKind::Semicolon | RawKind::RightBrace);
        let length = tokens[at..].iter().position(ends)?;
        self.list(&tokens[at..at + length]).first().map(|attribute| attribute.text)
    }

    /// The first token from a byte on.
    fn first_from(&self, at: u32) -> usize {
        self.tokens.partition_point(|token| token.start < at)
    }

    /// The attributes between braces.
    fn list(&self, tokens: &[RawToken]) -> Vec<Attribute<'s>> {
        let entries = tokens.split(|token| token.kind == RawKind::Semicolon);
        let attribute = |entry: &[RawToken]| {
            let [key, assign, ..] = entry else { return None };
            let end = entry.last()?.end as usize;
            let value = self.source.get(assign.end as usize..end)?.trim();
            let quoted = ['"', '\''].into_iter().find_map(|quote| value.strip_prefix(quote)?.strip_suffix(quote));
            (assign.kind == RawKind::Assign).then_some(Attribute {
                key: self.source.get(key.range())?.trim_matches('"'),
                value: quoted.unwrap_or(value).trim(),
                text: self.source.get(key.start as usize..end)?,
            })
        };
        entries.filter_map(attribute).collect()
    }
}

/// `{ key := "value"; key := "value" }`
pub(crate) fn in_braces(list: &[Attribute]) -> String {
    let texts: Vec<&str> = list.iter().map(|attribute| attribute.text).collect();
    format!("{{ {} }}", texts.join("; "))
}

impl<'a> Writer<'a> {
    /// The attributes that the document has directly before a byte.
    pub(crate) fn attributes_before(&self, at: u32) -> Vec<Attribute<'a>> {
        self.braces.as_ref().map_or_else(Vec::new, |braces| braces.before(at))
    }

    /// Those after the head of a block.
    pub(super) fn attributes_after_head(&self, at: u32) -> Vec<Attribute<'a>> {
        self.braces.as_ref().map_or_else(Vec::new, |braces| braces.after_head(at))
    }

    /// A list on a line of its own.
    pub(super) fn attribute_line(&mut self, list: &[Attribute]) {
        if !list.is_empty() {
            self.out.line(in_braces(list));
        }
    }

    /// The attributes before a block; `needs_number`: it is found by its number; `elsewhere`: those that stand in another place.
    pub(super) fn sd_header(
        &mut self,
        (header, needs_number): (&Header, bool),
        span: Span,
        elsewhere: &[Attribute],
        texts: &mut Texts,
    ) {
        let own = self.attributes_before(span.start);
        let is_there = |key: &str| own.iter().chain(elsewhere).any(|attribute| attribute.is(key));
        let known = |key: &str| is_there(key) || header.attributes.iter().any(|(own, _)| own.eq_ignore_ascii_case(key));
        let mut list: Vec<String> = own.iter().map(|attribute| attribute.text.to_string()).collect();
        // Without a number, the project chooses one.
        let is_own = needs_number || !header.auto_number;
        if let Some(number) = header.number.filter(|_| is_own && !known("S7_BlockNumber")) {
            list.push(format!("S7_BlockNumber := \"{number}\""));
        }
        for (key, value) in header.attributes.iter().filter(|(key, _)| !is_there(key)) {
            let key = match key.as_str() {
                key if key.eq_ignore_ascii_case("S7_Optimized_Access") => "S7_Optimized",
                "SecondaryType" => "S7_EventClass",
                key => key,
            };
            list.push(format!("{key} := \"{value}\""));
        }
        let words = [
            ("S7_Author", &header.author),
            ("S7_Family", &header.family),
            ("S7_HeaderName", &header.name),
            ("S7_Version", &header.version),
        ];
        for (key, value) in words {
            if let Some(value) = value.as_ref().filter(|_| !known(key)) {
                list.push(format!("{key} := \"{value}\""));
            }
        }
        let title = header.title.clone().filter(|title| !title.is_empty());
        let comment = Some(header.comment.join("\n")).filter(|_| !header.comment.is_empty());
        for (key, text) in [("S7_BlockTitle", title), ("S7_BlockComment", comment)] {
            let Some(text) = text.filter(|_| !is_there(key)) else { continue };
            match &self.braces {
                // Comments after the head stay where they are.
                Some(braces) => list.extend(braces.inside(span, key).map(str::to_string)),
                None => list.push(texts.attribute(key, &text)),
            }
        }
        // What is in the texts is not written as a comment as well.
        if self.braces.is_none() {
            // Assertions are no texts.
            let lines = header.comment.iter().map(|line| line.trim()).filter(|line| !line.starts_with('@'));
            let known: Vec<String> =
                lines.filter(|line| self.trivia.has_text(line, span.end)).map(str::to_string).collect();
            self.written.extend(known);
        }
        if !list.is_empty() {
            self.out.line(format!("{{ {} }}", list.join("; ")));
        }
    }

    /// The attributes before a network.
    pub(super) fn network_attributes(&mut self, network: &Network, texts: &mut Texts) {
        let language = match network.language {
            Language::Lad => "LAD",
            Language::Fbd => "FBD",
            Language::Scl => "SCL",
            Language::Stl => "STL",
        };
        let own = self.attributes_before(network.span.start);
        let is_there = |key: &str| own.iter().any(|attribute| attribute.is(key));
        let is_same = |value: &str| value.strip_prefix("F_").unwrap_or(value).eq_ignore_ascii_case(language);
        // Without the attribute, a document that nobody has redrawn says its language in another way.
        let is_drawn = self.braces.as_ref().is_none_or(|braces| braces.is_redrawn);
        let mut list = Vec::new();
        if is_drawn && !is_there("S7_Language") {
            list.push(format!("S7_Language := \"{language}\""));
        }
        for attribute in &own {
            match is_drawn && attribute.is("S7_Language") && !is_same(attribute.value) {
                true => list.push(format!("S7_Language := \"{language}\"")),
                false => list.push(attribute.text.to_string()),
            }
        }
        let title = network.title.clone().filter(|title| !title.is_empty());
        let comment = Some(network.comment.join("\n")).filter(|_| !network.comment.is_empty());
        for (key, text) in [("S7_NetworkTitle", title), ("S7_NetworkComment", comment)] {
            if let Some(text) = text.filter(|_| self.braces.is_none()) {
                list.push(texts.attribute(key, &text));
            }
        }
        if !list.is_empty() {
            self.out.line(format!("{{ {} }}", list.join("; ")));
        }
    }
}
