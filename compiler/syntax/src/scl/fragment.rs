//! Statements and expressions that stand in files of other notations: networks in SCL, operands of elements, ST in XML.
//!
//! Spans are those of `text`, of which only `range` is read.

use std::ops::Range;

use plcc_diag::{Diagnostic, FileId, Span};

use super::ast::{Expr, ExprKind, Statement, StatementKind};
use super::raw;
use crate::ast::{Block, Code, Pragma};

/// The statements in a part of a text. `pragmas`: assertions are read.
pub fn statements(file: FileId, text: &str, range: Range<usize>, pragmas: bool) -> (Vec<Statement>, Vec<Diagnostic>) {
    let mut raw = raw::scan(text.get(range.clone()).unwrap_or_default());
    raw.shift(range.start as u32);
    let parsed = super::parse_raw(file, text, raw, pragmas);
    let mut found = Vec::new();
    for block in parsed.blocks {
        if let Block::Code(block) = block
            && let Code::Scl(body) = block.code
        {
            found.extend(body.statements);
        }
    }
    // Assertions where there is no statement.
    let alone = parsed.pragmas.into_iter().filter(|pragma| pragma.assert.is_some());
    found.extend(alone.map(|pragma| Statement { span: pragma.span, kind: StatementKind::Pragma(pragma) }));
    (found, parsed.diagnostics)
}

/// Blocks and file pragmas of tokens that were taken from a text: frames and declarations of a notation that is otherwise not SCL.
pub(crate) fn blocks(
    file: FileId,
    text: &str,
    raw: raw::RawText,
    pragmas: bool,
) -> (Vec<Block>, Vec<Pragma>, Vec<Diagnostic>) {
    let parsed = super::parse_raw(file, text, raw, pragmas);
    (parsed.blocks, parsed.pragmas, parsed.diagnostics)
}

/// The expression in a part of a text; an error node if there is none.
pub fn expression(file: FileId, text: &str, range: Range<usize>) -> (Expr, Vec<Diagnostic>) {
    let span = Span::new(file, range.clone());
    let (mut statements, diagnostics) = statements(file, text, range, false);
    match (statements.pop(), statements.is_empty()) {
        (Some(Statement { kind: StatementKind::Expression(expr), .. }), true) => (expr, diagnostics),
        _ => (Expr { kind: ExprKind::Error, span }, diagnostics),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assertions_without_a_statement_are_kept() {
        let text = "//@ assert %M0.0 == 1\n;";
        let (found, messages) = statements(FileId::default(), text, 0..text.len(), true);
        assert!(messages.is_empty(), "{messages:?}");
        assert!(matches!(found.as_slice(), [Statement { kind: StatementKind::Pragma(_), .. }]), "{found:?}");
    }
}
