//! Assertion pragmas: comment lines `//@ …`.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use crate::ast::{AssertPragma, Pragma};
use crate::stl::context::Context;
use crate::stl::layout::lay_out_operand;
use crate::stl::{grammar, raw};

/// Whether the comment is a pragma. Lines of carets mark expected messages and are none for the compiler.
pub fn is_pragma(comment: &str) -> bool {
    comment.strip_prefix("//@").is_some_and(|text| !text.trim_start().starts_with('^'))
}

/// Whether the pragma holds for the file: `cpu`, `test`.
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
) -> Option<AssertPragma> {
    let help = "write e.g. `assert MW 10 == 5`, `assert ACCU1 == W#16#8000` or `assert STW.OV == 1`";
    let offset = range.start;
    let sides = &source[range];
    let (tokens, mut found) = lay_out_operand(file, sides, raw::scan(sides), offset);
    if let Some(first) = found.drain(..).next() {
        let mut diagnostic =
            Diagnostic::new(Code::Pragma, first.primary.span, first.title).label(first.primary.text).help(help);
        if let Some(help) = first.help {
            diagnostic = diagnostic.help(help);
        }
        diagnostics.push(diagnostic);
        return None;
    }
    let mut context = Context::new(file, source, &[]);
    let end = span.end as usize;
    match grammar::AssertionParser::new().parse(&mut context, tokens.into_iter().map(Ok::<_, ()>)) {
        Ok(assertion) => {
            if let Some(first) = context.diagnostics.drain(..).next() {
                diagnostics.push(
                    Diagnostic::new(Code::Pragma, first.primary.span, first.title).label(first.primary.text).help(help),
                );
                return None;
            }
            Some(assertion)
        }
        Err(error) => {
            let (start, stop) = crate::frame::error_range(&error).unwrap_or((span.start as usize, end));
            let place = if start < stop { Span::new(file, start..stop) } else { span };
            diagnostics.push(
                Diagnostic::new(Code::Pragma, place, "this assertion cannot be understood")
                    .label("an assertion is: operand, comparison, operand")
                    .help(help),
            );
            None
        }
    }
}
