//! Assertion pragmas: comment lines `//@ …`.

use std::ops::Range;

use plcc_diag::{Diagnostic, FileId, Span};

use crate::assertion;
use crate::ast::{AssertLiteral, AssertSide, Operand, OperandKind, Pragma};
use crate::front::{self, ParseState, pragma};
use crate::scl;
use crate::stl::classify::classify_operand;
use crate::stl::{Mnemonics, grammar, raw};

/// Reads the pragma in the comment at `range` of the file's text.
pub fn parse(file: FileId, source: &str, range: Range<usize>, diagnostics: &mut Vec<Diagnostic>) -> Pragma {
    let (mut pragma, sides) = pragma::read(file, source, range);
    let Some(sides) = sides else { return pragma };
    if source[sides.clone()].trim().is_empty() {
        diagnostics.push(pragma::unreadable(pragma.span, pragma::FORM, assertion::HELP));
        return pragma;
    }
    let mut side = |range, diagnostics: &mut Vec<Diagnostic>| side(file, source, range, diagnostics);
    pragma.assert = assertion::parse(file, source, sides, diagnostics, &mut side).map(Box::new);
    pragma
}

/// A side of a comparison.
fn side(file: FileId, source: &str, range: Range<usize>, diagnostics: &mut Vec<Diagnostic>) -> Option<AssertSide> {
    let text = &source[range.clone()];
    if let Some(cell) = cell_value(file, source, text, range.start) {
        return Some(AssertSide::CellValue(cell));
    }
    let mut found = Vec::new();
    let mut operand = operand(file, source, text, range.clone(), &mut found);
    // SCL of STEP 7 has no `#` before names of local variables: `a[1]` is `#a[1]`.
    if operand.is_none() && is_element(text) && range.start > 0 {
        let mut other = Vec::new();
        let signed = format!("#{text}");
        let local = self::operand(file, source, &signed, range.start - 1..range.end, &mut other);
        if local.is_some() && other.is_empty() {
            (operand, found) = (local, other);
        }
    }
    match operand {
        Some(AssertSide::Operand(Operand { kind: OperandKind::Literal(loaded), .. })) => {
            let (negative, exact) = exact(text);
            Some(AssertSide::Literal(AssertLiteral { loaded: Some(loaded), exact, negative }))
        }
        Some(side) if found.is_empty() => Some(side),
        _ => {
            // STL has neither constants of 64 bits nor texts of two bytes a character.
            if let (negative, Some(exact)) = exact(text) {
                return Some(AssertSide::Literal(AssertLiteral { loaded: None, exact: Some(exact), negative }));
            }
            if let Some(at) = followed(text) {
                let place = Span::new(file, range.start + at..range.start + at + 1);
                let help = format!("assign `{}` to a variable, and compare that", text[..=at].trim());
                diagnostics.push(pragma::unreadable(place, "an assertion does not follow references", &help));
                return None;
            }
            if let Some(sign) = calculates(text) {
                let place = Span::new(file, range.start + sign..range.start + sign + 1);
                let help = format!("assign `{}` to a variable, and compare that", text.trim());
                diagnostics.push(pragma::unreadable(place, "an assertion does not calculate", &help));
                return None;
            }
            let place = Span::new(file, range);
            diagnostics.push(match found.into_iter().next() {
                Some(first) => pragma::about_side(first, assertion::HELP),
                None => pragma::unreadable(place, "no operand, register or constant", assertion::HELP),
            });
            None
        }
    }
}

/// The timer or counter of `T1.VALUE`. One that has a symbol is found by the binder.
fn cell_value(file: FileId, source: &str, text: &str, start: usize) -> Option<Operand> {
    let (cell, value) = text.rsplit_once('.')?;
    if !value.trim().eq_ignore_ascii_case("VALUE") {
        return None;
    }
    let cell = cell.trim_end();
    match operand(file, source, cell, start..start + cell.len(), &mut Vec::new())? {
        AssertSide::Operand(operand) => {
            matches!(operand.kind, OperandKind::Cell { .. } | OperandKind::CellIndirect { .. }).then_some(operand)
        }
        AssertSide::CellValue(_) | AssertSide::Register(_) | AssertSide::Literal(_) => None,
    }
}

/// Sign and constant of a text that SCL reads as one.
fn exact(text: &str) -> (bool, Option<scl::ast::Literal>) {
    let (negative, unsigned) = match text.strip_prefix('-') {
        Some(rest) => (true, rest.trim_start()),
        None => (false, text.strip_prefix('+').map_or(text, str::trim_start)),
    };
    (negative, scl::literal::parse(unsigned).ok().map(|read| read.value))
}

/// Where `^` follows a reference of SCL: `#r^`, `"Data".r^.speed`.
fn followed(text: &str) -> Option<usize> {
    let at = text.find('^')?;
    let is_outside = |quote: char| text[..at].matches(quote).count().is_multiple_of(2);
    (is_outside('"') && is_outside('\'') && text.trim_start().starts_with(['#', '"'])).then_some(at)
}

/// Where the sign of a calculation is between two operands: `#a + 1`.
fn calculates(text: &str) -> Option<usize> {
    let sign = |at: &usize| matches!(text.as_bytes()[*at], b'+' | b'-' | b'*' | b'/');
    let mut signs = (1..text.len().saturating_sub(1)).filter(sign);
    signs.find(|at| text[..*at].ends_with(' ') && text[at + 1..].starts_with(' ') && !text.contains(['\'', '"']))
}

/// True for a name with an index.
fn is_element(text: &str) -> bool {
    let name = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    text.starts_with(|c: char| c.is_alphabetic() || c == '_') && text[name..].starts_with('[')
}

/// The operand written as `text`, at `range` of the source.
fn operand(
    file: FileId,
    source: &str,
    text: &str,
    range: Range<usize>,
    found: &mut Vec<Diagnostic>,
) -> Option<AssertSide> {
    let raw = raw::scan(text);
    let classified = classify_operand(file, text, &raw, range.start);
    found.extend_from_slice(&classified.diagnostics);
    if !found.is_empty() {
        return None;
    }
    let mut state = ParseState::new(file, source, &[], Mnemonics::En);
    let parsed = grammar::AssertSideParser::new().parse(&mut state, classified.stream());
    found.append(&mut state.diagnostics);
    match parsed {
        Ok(side) => Some(side),
        Err(error) => {
            let (start, stop) = front::error_range(&error).unwrap_or((range.start, range.end));
            let place = Span::new(file, if start < stop { start..stop } else { range });
            found.push(pragma::unreadable(place, pragma::FORM, assertion::HELP));
            None
        }
    }
}
