//! Inputs that a file names by their places. CODESYS calls the inputs of an operator `In1`, `In2` …, also those of SEL, MUX, LIMIT and SHL.

use super::super::objects::Connection;
use plcc_syntax::network::elements::{PinDirection, PinRow, Row};

/// The inputs with their numbers from 0; EN has none of its own.
pub fn numbered(inputs: &[Connection]) -> impl Iterator<Item = (usize, &Connection)> {
    inputs.iter().scan(0, |next, input| {
        let number = *next;
        *next += usize::from(!is_enable(input));
        Some((number, input))
    })
}

fn is_enable(input: &Connection) -> bool {
    input.formal.eq_ignore_ascii_case("EN")
}

/// Whether the inputs of an element are named by their places, which are not names of its pins.
pub fn are_inputs(row: &Row, inputs: &[Connection]) -> bool {
    // Such inputs have these names in any file.
    if pins(row).next().is_none_or(|first| first.name() == "in1") {
        return false;
    }
    let named = inputs.iter().filter(|input| !is_enable(input));
    named.clone().count() > 1 && named.zip(0..).all(|(input, at)| place(&input.formal) == Some(at))
}

/// The pin at the place that `formal` names, `In2` for example; none: it names no place.
pub fn input(row: &Row, formal: &str) -> Option<String> {
    let at = place(formal)?;
    let many = pins(row).zip(0..).find(|(pin, from)| pin.numbered && *from <= at);
    if let Some((pin, from)) = many {
        let stem = pin.name().trim_end_matches(|c: char| c.is_ascii_digit());
        let first: usize = pin.name()[stem.len()..].parse().ok()?;
        return Some(format!("{stem}{}", first + at - from));
    }
    pins(row).nth(at).map(|pin| pin.name().to_string())
}

/// The inputs for values.
fn pins(row: &Row) -> impl Iterator<Item = PinRow> {
    row.pins().filter(|pin| pin.direction == PinDirection::Input && !["en", "pre", "operand"].contains(&pin.name()))
}

/// The number of a place, from 0.
fn place(formal: &str) -> Option<usize> {
    let digits = formal.get(..2).filter(|head| head.eq_ignore_ascii_case("In")).and_then(|_| formal.get(2..))?;
    digits.parse::<usize>().ok()?.checked_sub(1)
}
