//! Assertion pragmas: comment lines `//@ …`.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::ast::Assert;
use super::context::Context;
use super::mnemonics::Detected;
use super::{classify, grammar, raw};
use crate::assertion;
use crate::ast::Pragma;

/// Reads the pragma in the comment at `range` of the file's text, and its assertion if it is one.
pub fn parse(
    file: FileId,
    source: &str,
    range: Range<usize>,
    detected: &Detected,
    diagnostics: &mut Vec<Diagnostic>,
) -> (Pragma, Option<Box<Assert>>) {
    let start = range.start;
    let comment = source.get(range).unwrap_or_default().trim_end();
    let text = comment.strip_prefix("//@").unwrap_or(comment).trim();
    let end = start + comment.len();
    let span = Span::new(file, start..end);
    let pragma = Pragma { text: text.to_owned(), span, assert: None };
    let Some(sides) = text.strip_prefix("assert") else { return (pragma, None) };
    if sides.starts_with(|c: char| c.is_alphanumeric() || c == '_') {
        return (pragma, None);
    }
    let sides = end - sides.len()..end;
    let assert = parse_assert(file, source, sides, span, detected, diagnostics);
    (pragma, assert.map(Box::new))
}

fn parse_assert(
    file: FileId,
    source: &str,
    range: Range<usize>,
    span: Span,
    detected: &Detected,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Assert> {
    let help = "write e.g. `assert VW10 as INT >= -5`, `assert S0 == 1 AND TW37 >= 5`, `assert ENO == 0` or `assert SM1.0 == 1`";
    if source.get(range.clone()).unwrap_or_default().trim().is_empty() {
        diagnostics.push(
            Diagnostic::new(Code::Pragma, span, "plcc cannot read this assertion")
                .label("an assertion is: operand, comparison, operand")
                .help(help),
        );
        return None;
    }
    let mut side = |range: Range<usize>, diagnostics: &mut Vec<Diagnostic>| {
        let place = Span::new(file, range.clone());
        let tokens = raw::part(source.get(range.clone()).unwrap_or_default(), range.start);
        let (tokens, mut found) = classify::classify_assertion(file, source, &tokens, detected);
        if let Some(first) = found.drain(..).next() {
            diagnostics.push(
                Diagnostic::new(Code::Pragma, first.primary.span, first.title)
                    .label(first.primary.text)
                    .help(first.help.unwrap_or_else(|| help.to_owned())),
            );
            return None;
        }
        let mut context = Context::new(file, source, &[], detected.set);
        match grammar::SideParser::new().parse(&mut context, tokens.into_iter().map(Ok::<_, ()>)) {
            Ok(side) => Some(side),
            Err(error) => {
                let (start, stop) = crate::frame::error_range(&error).unwrap_or((range.start, range.end));
                let place = if start < stop { Span::new(file, start..stop) } else { place };
                diagnostics.push(
                    Diagnostic::new(Code::Pragma, place, "plcc cannot read this assertion")
                        .label("an assertion is: operand, comparison, operand")
                        .help(help),
                );
                None
            }
        }
    };
    assertion::parse(file, source, range, diagnostics, &mut side)
}
