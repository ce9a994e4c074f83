//! Texts of titles and comments in several languages: the `.s7res` next to a `.s7dcl`.
//!
//! ```yaml
//! MultiLingualTexts:
//!   - id: MLC_1
//!     en-US: Motor on
//!     de-DE: Motor ein
//! ```
//!
//! Source: LAD/FBD reference, A.9.

use std::collections::HashMap;
use std::fmt::Write as _;

use plcc_diag::{Code, Diagnostic, FileId, Span};
use saphyr_parser::{Event, Parser};

use super::pragma::Attribute;

/// The language that is used if a text has it; otherwise its first one.
const PREFERRED: &str = "en-US";

/// Texts by their ids (`MLC_…`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Texts {
    by_id: HashMap<String, String>,
    /// A language in which a text says something else than in the one that is used.
    other_language: Option<String>,
}

impl Texts {
    /// Reads a `.s7res`. Texts that cannot be read are left out with a warning.
    pub fn parse(file: FileId, text: &str) -> (Texts, Vec<Diagnostic>) {
        let mut diagnostics = Vec::new();
        let yaml = with_quotes(file, text.trim_start_matches('\u{FEFF}'), &mut diagnostics);
        let mut reader = Reader::default();
        let mut twice = false;
        for event in Parser::new_from_str(&yaml) {
            match event {
                Ok((event, place)) => {
                    if let Some(id) = reader.event(event).filter(|_| !std::mem::replace(&mut twice, true)) {
                        let span = line_span(file, text, place.start.line());
                        let title = format!("the text `{id}` appears twice");
                        let message = Diagnostic::new(Code::TextResource, span, title).label("the second one counts");
                        diagnostics.push(message.help("give each text its own id"));
                    }
                }
                Err(error) => {
                    let span = line_span(file, text, error.marker().line());
                    diagnostics.push(
                        Diagnostic::new(Code::TextResource, span, "the texts cannot be read from here on")
                            .label(error.info().to_owned())
                            .help("a text is `- id: MLC_1` with a line `en-US: text` for each language; put special texts into quotes"),
                    );
                    break;
                }
            }
        }
        (reader.texts, diagnostics)
    }

    /// A language whose texts are not used, although they are others.
    pub fn other_language(&self) -> Option<&str> {
        self.other_language.as_deref()
    }

    /// The text of an id.
    pub fn get(&self, id: &str) -> Option<&str> {
        self.by_id.get(id).map(String::as_str)
    }
}

/// An open list or mapping.
#[derive(Debug)]
enum Open {
    List,
    /// With the key whose value comes next.
    Mapping(Option<String>),
}

/// Collects texts from the events of YAML.
#[derive(Default)]
struct Reader {
    texts: Texts,
    open: Vec<Open>,
    /// Of the mapping in a list that is open: its id, and its text in the best language so far.
    id: Option<String>,
    text: Option<(String, String)>,
}

impl Reader {
    /// The id of a text that appeared before with other words.
    fn event(&mut self, event: Event) -> Option<String> {
        match event {
            Event::SequenceStart(..) => self.open.push(Open::List),
            Event::MappingStart(..) => {
                if matches!(self.open.last(), Some(Open::List)) {
                    (self.id, self.text) = (None, None);
                }
                self.open.push(Open::Mapping(None));
            }
            Event::SequenceEnd => {
                self.open.pop();
                self.value_ends();
            }
            Event::MappingEnd => {
                self.open.pop();
                self.value_ends();
                if let (Some(id), Some((_, text))) = (self.id.take(), self.text.take()) {
                    let other = self.texts.by_id.insert(id.clone(), text.clone()).filter(|other| *other != text);
                    return other.map(|_| id);
                }
            }
            Event::Scalar(text, ..) => self.scalar(&text),
            Event::Alias(_) => self.scalar(""),
            Event::Nothing | Event::StreamStart | Event::StreamEnd | Event::DocumentStart(_) | Event::DocumentEnd => {}
        }
        None
    }

    fn scalar(&mut self, text: &str) {
        let Some(Open::Mapping(key)) = self.open.last_mut() else { return };
        match key.take() {
            None => *key = Some(text.to_owned()),
            Some(name) if name == "id" => self.id = Some(text.to_owned()),
            Some(language) => {
                if let Some((taken, own)) = &self.text
                    && own != text
                    && !own.is_empty()
                    && !text.is_empty()
                {
                    let other = if language == PREFERRED { taken } else { &language };
                    self.texts.other_language.get_or_insert_with(|| other.clone());
                }
                let better = |(taken, _): &(String, String)| taken != PREFERRED && language == PREFERRED;
                if self.text.as_ref().is_none_or(better) {
                    self.text = Some((language, text.to_owned()));
                }
            }
        }
    }

    /// A list or mapping was the value of a key.
    fn value_ends(&mut self) {
        if let Some(Open::Mapping(key)) = self.open.last_mut() {
            *key = None;
        }
    }
}

/// The text with quotes around values that contain `: `, which YAML does not allow; line numbers remain.
fn with_quotes(file: FileId, text: &str, diagnostics: &mut Vec<Diagnostic>) -> String {
    let mut out = String::with_capacity(text.len());
    // Column of the key whose block of lines is open.
    let mut block: Option<usize> = None;
    for (number, line) in text.lines().enumerate() {
        let rest = line.trim_start();
        let indent = line.len() - rest.len();
        if block.is_some_and(|key| indent > key || rest.is_empty()) {
            let _ = writeln!(out, "{line}");
            continue;
        }
        block = None;
        let key_text = rest.trim_start_matches("- ").trim_start();
        let column = line.len() - key_text.len();
        let value = key_text.split_once(": ").map(|(_, value)| value.trim()).unwrap_or_default();
        if value.starts_with(['|', '>']) {
            block = Some(column);
        }
        let plain = !value.is_empty() && !value.starts_with(['\'', '"', '|', '>', '[', '{', '&', '*', '!', '#']);
        if plain && (value.contains(": ") || value.ends_with(':')) {
            diagnostics.push(
                Diagnostic::new(Code::TextResource, line_span(file, text, number + 1), "a text with `: ` needs quotes")
                    .label("the TIA Portal refuses the whole file")
                    .help("put the text into single quotes"),
            );
            let start = line.trim_end().len() - value.len();
            let _ = writeln!(out, "{}'{}'", &line[..start], value.replace('\'', "''"));
        } else {
            let _ = writeln!(out, "{line}");
        }
    }
    out
}

/// Line `number` (from 1) of a text.
fn line_span(file: FileId, text: &str, number: usize) -> Span {
    let start: usize = text.split_inclusive('\n').take(number.saturating_sub(1)).map(str::len).sum();
    let length = text[start..].lines().next().unwrap_or_default().trim_end().len();
    Span::new(file, start..start + length)
}

/// Finds the texts that attributes name.
pub struct Lookup<'a> {
    texts: Option<&'a Texts>,
}

impl<'a> Lookup<'a> {
    pub fn new(texts: Option<&'a Texts>) -> Lookup<'a> {
        Lookup { texts }
    }

    /// The text whose id the attribute holds; without a file of texts, the id itself.
    pub fn find(&mut self, attribute: &Attribute, diagnostics: &mut Vec<Diagnostic>) -> Option<String> {
        if attribute.value.is_empty() {
            return None;
        }
        let Some(texts) = self.texts else { return Some(attribute.value.clone()) };
        let found = texts.get(&attribute.value);
        if found.is_none() {
            diagnostics.push(
                Diagnostic::new(
                    Code::TextResource,
                    attribute.value_span,
                    format!("the text `{}` is not in the .s7res file", attribute.value),
                )
                .label("names a text")
                .help("export the block again with its texts, or remove the attribute"),
            );
        }
        found.map(str::to_owned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Texts, usize) {
        let (texts, diagnostics) = Texts::parse(FileId::default(), text);
        (texts, diagnostics.len())
    }

    #[test]
    fn an_id_that_is_there_twice_is_told() {
        let (texts, warnings) =
            read("M:\n  - id: A\n    en-US: one\n  - id: A\n    en-US: two\n  - id: A\n    en-US: three\n");
        assert_eq!((warnings, texts.get("A")), (1, Some("three")));
        assert_eq!(read("M:\n  - id: A\n    en-US: one\n  - id: A\n    en-US: one\n").1, 0);
    }

    #[test]
    fn texts_are_found_by_id() {
        let (texts, warnings) = read(
            "\u{FEFF}MultiLingualTexts:\r\n  - id: MLC_1\r\n    de-DE: Motor ein\r\n    en-US: 'Motor: on'\r\n  - id: MLC_2\r\n    de-DE: |-\r\n      eins\r\n      a: b: c\r\n",
        );
        assert_eq!(warnings, 0);
        assert_eq!(texts.get("MLC_1"), Some("Motor: on"));
        assert_eq!(texts.get("MLC_2"), Some("eins\na: b: c"));
        assert_eq!(texts.get("MLC_3"), None);
    }

    #[test]
    fn a_plain_text_with_a_colon_is_read_with_a_warning() {
        let (texts, warnings) = read("MultiLingualTexts:\n  - id: MLC_1\n    en-US: Motor: it's on\n");
        assert_eq!((texts.get("MLC_1"), warnings), (Some("Motor: it's on"), 1));
    }

    #[test]
    fn what_is_no_yaml_is_told_at_its_line() {
        let text = "MultiLingualTexts:\n  - id: MLC_1\n    en-US: on\n  - id: [MLC_2\n";
        let (texts, diagnostics) = Texts::parse(FileId::default(), text);
        assert_eq!(texts.get("MLC_1"), Some("on"));
        assert_eq!(diagnostics.len(), 1);
    }
}
