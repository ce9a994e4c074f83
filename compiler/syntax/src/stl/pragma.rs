//! Assertion pragmas: comment lines `//@ …`.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use crate::assertion;
use crate::ast::{AssertLiteral, AssertSide, Assertion, Operand, OperandKind, Pragma};
use crate::scl;
use crate::stl::classify::classify_operand;
use crate::stl::context::Context;
use crate::stl::{grammar, raw};

/// Whether the comment is a pragma. Lines of carets mark expected messages; the compiler ignores them.
pub fn is_pragma(comment: &str) -> bool {
    comment.strip_prefix("//@").is_some_and(|text| !text.trim_start().starts_with('^'))
}

/// Whether the pragma applies to the file: `cpu`, `test`.
pub fn is_for_file(pragma: &Pragma) -> bool {
    matches!(pragma.text.split_ascii_whitespace().next(), Some("cpu" | "test"))
}

/// Reads the pragma in the comment at `range` of the file's text.
pub fn parse(file: FileId, source: &str, range: Range<usize>, diagnostics: &mut Vec<Diagnostic>) -> Pragma {
    let start = range.start;
    let comment = source[range].trim_end();
    let text = comment.strip_prefix("//@").unwrap_or(comment).trim();
    let span = Span::new(file, start..start + comment.len());
    let mut pragma = Pragma { text: text.to_owned(), span, assert: None };
    if let Some(sides) = text.strip_prefix("assert")
        && !sides.starts_with(|c: char| c.is_alphanumeric() || c == '_')
    {
        let sides = start + comment.len() - sides.len()..start + comment.len();
        pragma.assert = parse_assert(file, source, sides, span, diagnostics).map(Box::new);
    }
    pragma
}

fn parse_assert(
    file: FileId,
    source: &str,
    range: Range<usize>,
    span: Span,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Assertion> {
    if source[range.clone()].trim().is_empty() {
        diagnostics.push(
            Diagnostic::new(Code::Pragma, span, "plcc cannot read this assertion")
                .label("an assertion is: operand, comparison, operand")
                .help(assertion::HELP),
        );
        return None;
    }
    assertion::parse(file, source, range, diagnostics, &mut |range, diagnostics| side(file, source, range, diagnostics))
}

/// A side of a comparison.
fn side(file: FileId, source: &str, range: Range<usize>, diagnostics: &mut Vec<Diagnostic>) -> Option<AssertSide> {
    let text = &source[range.clone()];
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
            let place = Span::new(file, range);
            diagnostics.push(match found.into_iter().next() {
                Some(first) => Diagnostic::new(Code::Pragma, first.primary.span, first.title)
                    .label(first.primary.text)
                    .help(first.help.unwrap_or_else(|| assertion::HELP.to_owned())),
                None => Diagnostic::new(Code::Pragma, place, "plcc cannot read this assertion")
                    .label("no operand, register or constant")
                    .help(assertion::HELP),
            });
            None
        }
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
    let (tokens, messages) = classify_operand(file, text, raw::scan(text), range.start);
    found.extend(messages);
    if !found.is_empty() {
        return None;
    }
    let mut context = Context::new(file, source, &[]);
    let parsed = grammar::AssertSideParser::new().parse(&mut context, tokens.into_iter().map(Ok::<_, ()>));
    found.append(&mut context.diagnostics);
    match parsed {
        Ok(side) => Some(side),
        Err(error) => {
            let (start, stop) = crate::frame::error_range(&error).unwrap_or((range.start, range.end));
            let place = if start < stop { start..stop } else { range };
            found.push(
                Diagnostic::new(Code::Pragma, Span::new(file, place), "plcc cannot read this assertion")
                    .label("an assertion is: operand, comparison, operand")
                    .help(assertion::HELP),
            );
            None
        }
    }
}
