//! Rows of actions: the tokens of a row are written to their positions in the overlay, and parsed there.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic};
use roxmltree::Node;

use super::super::reader::{Reader, Refused, texts};
use super::super::tokens;
use super::{attribute_span, is_true};
use crate::xml::{attribute_range, elements, is, raw_text_of};
use plcc_syntax::chart::action_text;
use plcc_syntax::chart::ast::{Action, Event, Qualifier};

/// Reads the rows of an `Action`; none if it is empty.
pub fn read(reader: &mut Reader, node: Node, whose: &str) -> Vec<Action> {
    let Ok(()) = write(reader, node, whose) else { return Vec::new() };
    let mut messages = Vec::new();
    let rows = action_text::rows(reader.file, reader.overlay.text(), node.range(), &mut messages);
    reader.diagnostics.append(&mut messages);
    if rows.is_empty() {
        return Vec::new();
    }
    let (Some(event), Some(qualifier)) = (event(reader, node), qualifier(reader, node)) else { return Vec::new() };
    let interlock = node.attribute("Interlock").is_some_and(|value| is_true(value) || value.eq_ignore_ascii_case("C"));
    let qualifier_span = attribute_span(reader, node, "Qualifier");
    let comment = comment(node);
    let action = |row: action_text::Row| Action {
        event,
        qualifier,
        interlock,
        qualifier_span,
        body: row.body,
        comment: row.comment.or_else(|| comment.clone()),
        span: row.span,
    };
    rows.into_iter().map(action).collect()
}

/// The event; `Some(None)` without one, `None` if there is no such event.
fn event(reader: &mut Reader, node: Node) -> Option<Option<Event>> {
    let text = node.attribute("Event").unwrap_or_default().trim();
    if text.is_empty() || text.eq_ignore_ascii_case("None") {
        return Some(None);
    }
    let event = Event::of(text);
    if event.is_none() {
        let span = attribute_span(reader, node, "Event");
        let title = format!("`{text}` is not an event of GRAPH");
        let message = Diagnostic::new(Code::ActionEvent, span, title).label("not known");
        reader.diagnostics.push(message.help("the events are S1, S0, V1, V0, L1, L0, A1 and R1"));
    }
    event.map(Some)
}

/// The qualifier; `None` if there is no such qualifier. Assumption: a row without one is `N`, which the editor offers first.
fn qualifier(reader: &mut Reader, node: Node) -> Option<Qualifier> {
    let text = node.attribute("Qualifier").unwrap_or_default().trim();
    if text.is_empty() {
        return Some(Qualifier::N);
    }
    let qualifier = Qualifier::of(text);
    if qualifier.is_none() {
        let span = attribute_span(reader, node, "Qualifier");
        let title = format!("`{text}` is not a qualifier of GRAPH");
        let message = Diagnostic::new(Code::Qualifier, span, title).label("not known");
        let help =
            "the qualifiers are N, S, R, D, L, ON, OFF, CS, CU, CD, CR, TL, TD, TR and TF; calls have the qualifier N";
        reader.diagnostics.push(message.help(help));
    }
    qualifier
}

/// The comment of an action.
fn comment(node: Node) -> Option<String> {
    let line = elements(node).find(|part| is(*part, "LineComment")).map(|line| raw_text_of(line).trim().to_string());
    let text = texts(node, &["Comment"]).into_iter().next();
    line.or(text).filter(|text| !text.is_empty())
}

/// Writes the tokens of an action. Tokens that form one word are written together.
fn write(reader: &mut Reader, node: Node, whose: &str) -> Result<(), Refused> {
    let mut word: Option<Word> = None;
    for part in elements(node) {
        let text = part.attribute("Text").filter(|_| is(part, "Token"));
        if let (Some(word), Some(text)) = (&mut word, text)
            && is_one_word(&word.text, text)
        {
            word.text.push_str(text);
            word.range.end = part.range().end;
            continue;
        }
        if let Some(word) = word.take() {
            word.write(reader);
        }
        match text {
            Some(text) => {
                let wanted = attribute_range(part, "Text").start;
                word = Some(Word { text: text.to_string(), wanted, range: part.range() });
            }
            None if is(part, "LineComment") || is(part, "Title") => {}
            None => tokens::token(reader, part, whose, 0)?,
        }
    }
    if let Some(word) = word {
        word.write(reader);
    }
    Ok(())
}

/// Tokens that are written together.
struct Word {
    text: String,
    wanted: usize,
    range: Range<usize>,
}

impl Word {
    fn write(self, reader: &mut Reader) {
        reader.overlay.place(&self.text, self.wanted, self.range);
    }
}

/// Words that are separate before a name.
const OPERATORS: [&str; 7] = ["AND", "CALL", "DIV", "MOD", "NOT", "OR", "XOR"];

/// Whether two tokens make one word: `#` and a name, `%` and an address, `T` and `#2S`.
fn is_one_word(before: &str, after: &str) -> bool {
    let ends_open = before.ends_with(['#', '%', '.', ':']) && !after.starts_with(char::is_whitespace);
    let last = before.rsplit(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or_default();
    let is_prefix = !last.is_empty() && !OPERATORS.iter().any(|operator| operator.eq_ignore_ascii_case(last));
    ends_open || after.starts_with('.') || after.starts_with('#') && is_prefix
}
