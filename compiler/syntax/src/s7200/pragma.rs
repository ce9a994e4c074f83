//! Assertion pragmas: comment lines `//@ …`.

use std::ops::Range;

use plcc_diag::{Diagnostic, FileId, Span};

use super::ast::Assert;
use super::mnemonics::Detected;
use super::{classify, grammar, raw};
use crate::assertion;
use crate::ast::Pragma;
use crate::front::{self, ParseState, pragma};

/// Reads the pragma in the comment at `range` of the file's text, and its assertion if it is one.
pub fn parse(
    file: FileId,
    source: &str,
    range: Range<usize>,
    detected: &Detected,
    diagnostics: &mut Vec<Diagnostic>,
) -> (Pragma, Option<Box<Assert>>) {
    let (pragma, sides) = pragma::read(file, source, range);
    let Some(sides) = sides else { return (pragma, None) };
    let help = "write e.g. `assert VW10 as INT >= -5`, `assert S0 == 1 AND TW37 >= 5`, `assert ENO == 0` or `assert SM1.0 == 1`";
    if source.get(sides.clone()).unwrap_or_default().trim().is_empty() {
        diagnostics.push(pragma::unreadable(pragma.span, pragma::FORM, help));
        return (pragma, None);
    }
    let mut side = |range: Range<usize>, diagnostics: &mut Vec<Diagnostic>| {
        let tokens = raw::part(source.get(range.clone()).unwrap_or_default(), range.start);
        let mut classified = classify::classify_assertion(file, source, &tokens, detected);
        if let Some(first) = classified.diagnostics.drain(..).next() {
            diagnostics.push(pragma::about_side(first, help));
            return None;
        }
        let mut state = ParseState::new(file, source, &[], detected.set);
        match grammar::SideParser::new().parse(&mut state, classified.stream()) {
            Ok(side) => Some(side),
            Err(error) => {
                let (start, stop) = front::error_range(&error).unwrap_or((range.start, range.end));
                let place = Span::new(file, if start < stop { start..stop } else { range });
                diagnostics.push(pragma::unreadable(place, pragma::FORM, help));
                None
            }
        }
    };
    let assert = assertion::parse(file, source, sides, diagnostics, &mut side);
    (pragma, assert.map(Box::new))
}
