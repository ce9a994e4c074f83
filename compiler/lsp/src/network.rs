//! Elements, pins and wires of networks in SIMATIC SD.

use plcc_syntax::Language;
use plcc_syntax::network::elements::{self, PinDirection, PinRow};

use crate::facts::ParameterFacts;
use crate::names::open_bracket;
use crate::role::{in_rung, is_wire};
use crate::words::Words;

/// Markdown about a piece of a rung that is not an operand.
pub fn hover(words: &Words, at: usize) -> Option<String> {
    if words.language(at) != Language::Sd || !in_rung(words, at) {
        return None;
    }
    let word = words.word(at);
    if is_wire(words, at) {
        return Some(wire(word));
    }
    if word.eq_ignore_ascii_case("wire") && is_wire(words, at + 1) {
        return Some(wire(words.word(at + 1)));
    }
    if words.word(at + 1) == "(" {
        return element(word);
    }
    if matches!(words.word(at + 1), ":=" | "=>") {
        let before = open_bracket(words, at)?.checked_sub(1)?;
        let (row, _) = elements::find_sd(words.word(before))?;
        let (pin, name) = row.pin(word)?;
        return Some(format!("```plc\n{}.{name}\n```\n{} of {}\n", row.name, direction(pin), row.name));
    }
    None
}

fn wire(word: &str) -> String {
    let name = word.trim_start_matches('#');
    let what = if name.eq_ignore_ascii_case("powerrail") {
        "the power rail: TRUE"
    } else {
        "a wire of this network: the value that feeds it, or the OR of several"
    };
    format!("```plc\nwire#{name}\n```\n{what}\n")
}

/// The names of the wires of the network around a piece, without the piece.
pub fn wires<'t>(words: &Words<'t>, at: usize) -> Vec<&'t str> {
    let is_end = |at: &usize| ["NETWORK", "END_NETWORK"].iter().any(|own| own.eq_ignore_ascii_case(words.word(*at)));
    let first = (0..at).rev().find(is_end).unwrap_or(0);
    let last = (at..words.pieces.len()).find(is_end).unwrap_or(words.pieces.len());
    let mut names: Vec<&str> = vec!["powerrail"];
    for other in (first..last).filter(|other| *other != at && is_wire(words, *other)) {
        let name = words.word(other).trim_start_matches('#');
        if !name.is_empty() && !names.iter().any(|own| own.eq_ignore_ascii_case(name)) {
            names.push(name);
        }
    }
    names
}

/// `Contact( #on )`, `#t.TON( pt := T#1s )`.
fn element(word: &str) -> Option<String> {
    let (row, negated) = elements::find_sd(word)?;
    let chapter = elements::CHAPTERS.iter().find(|chapter| chapter.rows.iter().any(|own| own.name == row.name));
    let mut text = format!("```plc\n{word}\n```\n{}: {}", chapter.map_or("element", |chapter| chapter.title), row.name);
    if negated {
        text.push_str(", with the operand negated");
    }
    text.push_str("\n\n");
    for pin in row.pins() {
        let more = if pin.numbered { " …" } else { "" };
        let optional = if pin.optional { ", may be missing" } else { "" };
        text.push_str(&format!("- `{}`{more} {}{optional}\n", pin.name(), direction(pin)));
    }
    Some(text)
}

/// The element whose bracket opens at a piece, and its pins. The flow comes and goes on wires.
pub fn signature(words: &Words, open: usize) -> Option<(String, Vec<ParameterFacts>)> {
    if words.language(open) != Language::Sd || !in_rung(words, open) {
        return None;
    }
    let name = words.word(open.checked_sub(1)?);
    let (row, _) = elements::find_sd(name)?;
    let parameter = |pin: PinRow| ParameterFacts {
        name: pin.name().to_owned(),
        also: pin.spellings().skip(1).map(str::to_owned).collect(),
        direction: match pin.direction {
            PinDirection::Input => "IN",
            PinDirection::Output => "OUT",
            PinDirection::InOut => "IN_OUT",
        },
        is_numbered: pin.numbered,
        is_optional: pin.optional,
        ..ParameterFacts::default()
    };
    let pins = row.pins().filter(|pin| pin.numbered || ![row.flow.0, row.flow.1].contains(&pin.name()));
    Some((name.to_owned(), pins.map(parameter).collect()))
}

/// What a pin is for.
pub const fn direction(pin: PinRow) -> &'static str {
    match pin.direction {
        PinDirection::Input => "input",
        PinDirection::Output => "output",
        PinDirection::InOut => "input and output",
    }
}
