//! Attributes in braces: `{ S7_Language := "LAD"; S7_NetworkTitle := "MLC_1" }`.

use plcc_diag::{Code, Diagnostic, FileId, Span};

use plcc_syntax::scl::raw::{RawKind, RawToken};

/// `key := value`.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    pub key: String,
    /// Without quotes and outer blanks.
    pub value: String,
    pub key_span: Span,
    /// Inside the quotes.
    pub value_span: Span,
}

impl Attribute {
    pub fn is(&self, key: &str) -> bool {
        self.key.eq_ignore_ascii_case(key)
    }

    /// `TRUE` or `FALSE`; none: another text.
    pub fn truth(&self) -> Option<bool> {
        match () {
            () if self.value.eq_ignore_ascii_case("TRUE") => Some(true),
            () if self.value.eq_ignore_ascii_case("FALSE") => Some(false),
            () => None,
        }
    }
}

/// The attribute `key`, the last one if there are several.
pub fn find<'p>(attributes: &'p [Attribute], key: &str) -> Option<&'p Attribute> {
    attributes.iter().rev().find(|attribute| attribute.is(key))
}

/// Index after the `}` that closes the brace at `open`; none if it is not closed.
pub fn end(tokens: &[RawToken], open: usize) -> Option<usize> {
    let brace = |token: &RawToken| matches!(token.kind, RawKind::LeftBrace | RawKind::RightBrace);
    let next = open + 1 + tokens[open + 1..].iter().position(brace)?;
    (tokens[next].kind == RawKind::RightBrace).then_some(next + 1)
}

/// Reads the attributes in the braces that begin at `open`; returns the index after them. Braces that are not closed end at their line.
pub fn read(
    file: FileId,
    text: &str,
    tokens: &[RawToken],
    open: usize,
    diagnostics: &mut Vec<Diagnostic>,
) -> (Vec<Attribute>, usize) {
    let span = |token: RawToken| Span { file, start: token.start, end: token.end };
    let (after, inner) = match end(tokens, open) {
        Some(after) => (after, &tokens[open + 1..after - 1]),
        None => {
            diagnostics.push(
                Diagnostic::new(Code::Syntax, span(tokens[open]), "the list of attributes is not closed")
                    .label("begins here")
                    .help("close it with `}`"),
            );
            let rest = &tokens[open + 1..];
            let length = rest.iter().position(|token| token.first_on_line).unwrap_or(rest.len());
            (open + 1 + length, &rest[..length])
        }
    };
    let mut attributes = Vec::new();
    for entry in inner.split(|token| token.kind == RawKind::Semicolon).filter(|entry| !entry.is_empty()) {
        match entry {
            [key, assign, value @ ..]
                if matches!(key.kind, RawKind::Word | RawKind::Quoted) && assign.kind == RawKind::Assign =>
            {
                attributes.push(attribute(file, text, *key, *assign, value));
            }
            _ => diagnostics.push(
                Diagnostic::new(
                    Code::Syntax,
                    span(entry[0]).to(span(entry[entry.len() - 1])),
                    "this is not an attribute",
                )
                .label("`name := \"value\"` is expected here")
                .help("write attributes as `{ name := \"value\"; name := \"value\" }`"),
            ),
        }
    }
    (attributes, after)
}

fn attribute(file: FileId, text: &str, key: RawToken, assign: RawToken, value: &[RawToken]) -> Attribute {
    let (start, end) = match value {
        [] => (assign.end as usize, assign.end as usize),
        [first, ..] => (first.start as usize, value[value.len() - 1].end as usize),
    };
    let whole = &text[start..end];
    let quoted = ['"', '\''].into_iter().find_map(|quote| {
        whole.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote)).map(|inner| (start + 1, inner))
    });
    let (start, inner) = quoted.unwrap_or((start, whole));
    let lead = inner.len() - inner.trim_start().len();
    let trimmed = inner.trim();
    Attribute {
        key: text[key.range()].trim_matches('"').to_owned(),
        value: trimmed.to_owned(),
        key_span: Span { file, start: key.start, end: key.end },
        value_span: Span::new(file, start + lead..start + lead + trimmed.len()),
    }
}
