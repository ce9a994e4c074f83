//! Checks of a block's statements that need no names: parentheses, and labels without an instruction.

use plcc_diag::{Code, Diagnostic, Span};

use crate::ast::{CodeBlock, Statement, StatementKind};
use crate::stl::StlInsn;

/// Entries of the nesting stack. Source: Statement List (STL), chapter 1 (bit logic), nesting.
const NESTING_DEPTH_MAX: usize = 7;

/// Reports what is wrong in the order of statements.
pub fn check(text: &str, block: &CodeBlock, diagnostics: &mut Vec<Diagnostic>) {
    let statements = || block.networks().iter().flat_map(|network| &network.statements);
    // A statement that could not be read may be a parenthesis, or the instruction of a label.
    if statements().any(|statement| statement.kind == StatementKind::Error) {
        return;
    }
    nesting(text, statements(), diagnostics);
    labels(statements(), diagnostics);
}

fn nesting<'s>(text: &str, statements: impl Iterator<Item = &'s Statement>, diagnostics: &mut Vec<Diagnostic>) {
    let mut open: Vec<Span> = Vec::new();
    for statement in statements {
        let StatementKind::Instruction { insn, mnemonic_span, .. } = &statement.kind else { continue };
        let span = *mnemonic_span;
        match insn {
            insn if insn.opens_nesting() => {
                open.push(span);
                if open.len() == NESTING_DEPTH_MAX + 1 {
                    diagnostics.push(
                        Diagnostic::new(Code::Nesting, span, "parentheses are nested too deeply")
                            .label("the eighth level")
                            .also(open[0], "the first level begins here")
                            .help("the nesting stack has 7 entries; keep an intermediate result in a bit"),
                    );
                }
            }
            StlInsn::CloseNest if open.pop().is_none() => {
                diagnostics.push(
                    Diagnostic::new(Code::Nesting, span, "`)` closes a parenthesis that was never opened")
                        .label("no parenthesis is open here")
                        .help("remove it, or open the parenthesis with e.g. `A(`"),
                );
            }
            StlInsn::BlockEnd | StlInsn::BlockEndUnconditional | StlInsn::BlockEndConditional => {
                if let Some(opening) = open.last() {
                    let word = &text[span.range()];
                    diagnostics.push(
                        Diagnostic::new(Code::Nesting, span, format!("a parenthesis cannot contain `{word}`"))
                            .label("the block cannot end here")
                            .also(*opening, "opened here")
                            .help("close the parenthesis with `)` before it"),
                    );
                    open.clear();
                }
            }
            _ => {}
        }
    }
    if let Some(opening) = open.last() {
        diagnostics.push(
            Diagnostic::new(Code::Nesting, *opening, "the parenthesis is not closed in its block")
                .label("opened here")
                .help("write `)` after the last instruction of the parenthesis"),
        );
    }
}

fn labels<'s>(statements: impl Iterator<Item = &'s Statement>, diagnostics: &mut Vec<Diagnostic>) {
    let mut waiting: Vec<(&str, Span)> = Vec::new();
    for statement in statements {
        match (&statement.kind, &statement.label) {
            (StatementKind::Empty, Some(label)) => waiting.push((&label.name, label.span)),
            (StatementKind::Empty | StatementKind::Pragma(_), _) => {}
            (StatementKind::Instruction { .. } | StatementKind::Call(_) | StatementKind::Error, _) => waiting.clear(),
        }
    }
    for (name, span) in waiting {
        diagnostics.push(
            Diagnostic::new(Code::LabelWithoutStatement, span, format!("no instruction follows the label `{name}`"))
                .label("a jump to it would have no target")
                .help(format!("write e.g. `{name}: NOP 0`")),
        );
    }
}
