//! Statements and expressions in files of other notations: networks in SCL, operands of elements, ST in XML.
//!
//! Spans are those of `text`, of which only `range` is read.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::ast::{Expr, ExprKind, Statement, StatementKind};
use super::{extensions, raw};
use crate::ast::{Block, Code as BlockCode, Pragma};
use crate::front::pragma::is_for_file;

/// The statements in a part of a text. `pragmas`: assertions are read.
pub fn statements(file: FileId, text: &str, range: Range<usize>, pragmas: bool) -> (Vec<Statement>, Vec<Diagnostic>) {
    let raw = raw::scan(text.get(range.clone()).unwrap_or_default());
    scanned(file, text, range, raw, pragmas)
}

/// As [`statements`], of structured text as IEC 61131-3 has it; assertions are read.
pub fn iec_statements(
    file: FileId,
    text: &str,
    range: Range<usize>,
    rules: raw::Iec,
) -> (Vec<Statement>, Vec<Diagnostic>) {
    let part = text.get(range.clone()).unwrap_or_default();
    let mut raw = raw::scan_iec(part, rules);
    let mut diagnostics = extensions::replace(file, part, range.start as u32, &mut raw);
    let (statements, more) = scanned(file, text, range, raw, true);
    diagnostics.extend(more);
    (statements, diagnostics)
}

fn scanned(
    file: FileId,
    text: &str,
    range: Range<usize>,
    mut raw: raw::RawText,
    pragmas: bool,
) -> (Vec<Statement>, Vec<Diagnostic>) {
    raw.shift(range.start as u32);
    let parsed = super::parse_raw(file, text, &raw, pragmas);
    let mut found = Vec::new();
    for block in parsed.blocks {
        if let Block::Code(block) = block
            && let BlockCode::Scl(body) = block.code
        {
            found.extend(body.statements);
        }
    }
    // Assertions and pauses where there is no statement.
    let alone = parsed.pragmas.into_iter().filter(|pragma| !is_for_file(pragma));
    found.extend(alone.map(|pragma| Statement { span: pragma.span, kind: StatementKind::Pragma(pragma) }));
    (found, parsed.diagnostics)
}

/// Blocks and file pragmas of tokens from another text: frames and declarations of a notation that is otherwise not SCL.
pub fn blocks(
    file: FileId,
    text: &str,
    raw: &raw::RawText,
    pragmas: bool,
) -> (Vec<Block>, Vec<Pragma>, Vec<Diagnostic>) {
    let parsed = super::parse_raw(file, text, raw, pragmas);
    (parsed.blocks, parsed.pragmas, parsed.diagnostics)
}

/// The expression in a part of a text; an error node if there is none.
pub fn expression(file: FileId, text: &str, range: Range<usize>) -> (Expr, Vec<Diagnostic>) {
    let span = Span::new(file, range.clone());
    let (statements, diagnostics) = statements(file, text, range, false);
    only(span, statements, diagnostics)
}

/// As [`expression`], of structured text as IEC 61131-3 has it.
pub fn iec_expression(file: FileId, text: &str, range: Range<usize>, rules: raw::Iec) -> (Expr, Vec<Diagnostic>) {
    let span = Span::new(file, range.clone());
    let (statements, diagnostics) = iec_statements(file, text, range, rules);
    only(span, statements, diagnostics)
}

/// The statements as one expression. More than one is an error.
fn only(span: Span, mut statements: Vec<Statement>, mut diagnostics: Vec<Diagnostic>) -> (Expr, Vec<Diagnostic>) {
    match (statements.pop(), statements.is_empty()) {
        (Some(Statement { kind: StatementKind::Expression(expr), .. }), true) => (expr, diagnostics),
        _ => {
            if !diagnostics.iter().any(Diagnostic::is_error) {
                let message = Diagnostic::new(Code::Syntax, span, "this is not one expression");
                diagnostics.push(
                    message.label("an operand is expected").help("write a variable, a constant or an expression"),
                );
            }
            (Expr { kind: ExprKind::Error, span }, diagnostics)
        }
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

    #[test]
    fn a_misspelt_word_of_structured_text_is_one_message() {
        let rules = raw::Iec { nested_comments: true };
        for text in [
            "IF a THN b := 1; END_IF;",
            "IF a THEN b := 1; ENDIF;",
            "IF a ANDD b THEN c := 1; END_IF;",
            "WHILE a < 5 DOO a := a + 1; END_WHILE;",
        ] {
            let (found, messages) = iec_statements(FileId::default(), text, 0..text.len(), rules);
            assert!(messages.len() == 1 && messages[0].code == Code::MisspeltKeyword, "{text}: {messages:?}");
            assert!(!found.is_empty(), "{text}");
        }
        // Variables may be called like words of other languages.
        for text in ["Break", "NOT Next AND Default", "Thn > Doo"] {
            let (_, messages) = iec_expression(FileId::default(), text, 0..text.len(), rules);
            assert!(messages.is_empty(), "{text}: {messages:?}");
        }
        let text = "CASE a OF Default: IF Thn THEN Fi := 1; END_IF; Esac: ; END_CASE;";
        let (_, messages) = iec_statements(FileId::default(), text, 0..text.len(), rules);
        assert!(messages.is_empty(), "{messages:?}");
    }
}
