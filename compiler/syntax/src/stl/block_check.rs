//! Checks of a block's statements that need no names: parentheses, zones of the MCR, and labels without an instruction.

use std::collections::BTreeMap;

use plcc_diag::{Code, Diagnostic, Severity, Span};

use crate::ast::{CodeBlock, OperandKind, Statement, StatementKind};
use crate::stl::{Mnemonics, StlInsn, suggest};

/// Entries of the nesting stack. Source: Statement List (STL), chapter 1 (bit logic), nesting.
const NESTING_DEPTH_MAX: usize = 7;
/// Entries of the stack of the master control relay. Source: Statement List (STL), master control relay.
const ZONES_MAX: usize = 8;

/// Reports what is wrong in the order of statements. Messages have the mnemonics `set` of the file.
pub fn check(text: &str, block: &CodeBlock, set: Mnemonics, diagnostics: &mut Vec<Diagnostic>) {
    let statements = || block.networks().iter().flat_map(|network| &network.statements);
    // A statement that could not be read may be a parenthesis, or the instruction of a label.
    if statements().any(|statement| statement.kind == StatementKind::Error) {
        return;
    }
    nesting(text, statements(), set, diagnostics);
    zones(statements(), diagnostics);
    labels(statements(), diagnostics);
}

fn nesting<'s>(
    text: &str,
    statements: impl Iterator<Item = &'s Statement>,
    set: Mnemonics,
    diagnostics: &mut Vec<Diagnostic>,
) {
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
                        .help(suggest::in_set("remove it, or open the parenthesis with e.g. `A(`", set)),
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

/// Warns of zones of the master control relay that do not match: the CPU goes to STOP when it executes a `)MCR` too many, and `MCR(` and
/// `)MCR` are always used in pairs. Zones act by their order in time: if a jump changes how many are open, their order in the text says
/// nothing. Source: Statement List (STL), master control relay.
fn zones<'s>(statements: impl Iterator<Item = &'s Statement>, diagnostics: &mut Vec<Diagnostic>) {
    let mut open: Vec<Span> = Vec::new();
    let mut found = Vec::new();
    // With the number of open zones.
    let (mut labels, mut jumps) = (BTreeMap::new(), Vec::new());
    for statement in statements {
        if let Some(label) = &statement.label {
            labels.insert(label.name.as_str(), open.len());
        }
        let StatementKind::Instruction { insn, mnemonic_span: span, operand } = &statement.kind else { continue };
        if let Some(OperandKind::Label(name)) = operand.as_ref().map(|operand| &operand.kind) {
            jumps.push((name.as_str(), open.len()));
        }
        let message = match insn {
            StlInsn::McrOpen => {
                open.push(*span);
                if open.len() != ZONES_MAX + 1 {
                    continue;
                }
                Diagnostic::new(Code::Nesting, *span, "zones of the MCR are nested too deeply")
                    .label("the ninth zone: the CPU goes to STOP here (16#4572)")
                    .also(open[0], "the first zone begins here")
                    .help("close a zone with `)MCR` before, or combine two conditions")
            }
            StlInsn::McrClose if open.pop().is_none() => {
                Diagnostic::new(Code::Nesting, *span, "`)MCR` closes a zone that this block has not opened")
                    .label("the CPU goes to STOP here (16#4572)")
                    .help("remove it, or open the zone with `MCR(` in the same block")
            }
            _ => continue,
        };
        found.push(message);
    }
    found.extend(open.iter().map(|opening| {
        Diagnostic::new(Code::Nesting, *opening, "the zone of the MCR is not closed in its block")
            .label("no `)MCR` closes it")
            .help("write `)MCR` after the last instruction of the zone")
    }));
    if jumps.iter().all(|(name, zones)| labels.get(name).is_none_or(|there| there == zones)) {
        diagnostics.extend(found.into_iter().map(|message| Diagnostic { severity: Severity::Warning, ..message }));
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
