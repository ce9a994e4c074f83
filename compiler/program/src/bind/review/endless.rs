//! Loops that nothing leaves: `WHILE TRUE` and `UNTIL FALSE` in SCL, and in STL a jump back past statements that all go on.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{ExprKind, Statement, StatementKind};
use plcc_model::{LabelId, Operand, StlStatement, StlStatementKind};
use plcc_syntax::stl::{Mnemonics, StlInsn};
use rustc_hash::FxHashMap;

use crate::bind::scl::leaves;

/// Reports the loops in `list`, and in the lists inside it, whose condition is a constant and that no statement leaves.
pub fn loops(list: &[Statement], found: &mut Vec<Diagnostic>) {
    for statement in list {
        let (condition, goes_on, body) = match &statement.kind {
            StatementKind::While { condition, body } => (condition, true, body),
            StatementKind::Repeat { body, until } => (until, false, body),
            other => {
                other.bodies().into_iter().for_each(|body| loops(body, found));
                continue;
            }
        };
        let endless = matches!(condition.kind, ExprKind::Const(value) if (value != 0) == goes_on);
        if endless && !body.iter().any(leaves) {
            let label = match goes_on {
                true => "its condition is always TRUE, and no EXIT is inside",
                false => "its condition is always FALSE, and no EXIT is inside",
            };
            found.push(message(
                statement.span,
                label,
                "leave it with `IF … THEN EXIT; END_IF;`, or write when it ends",
            ));
        }
        loops(body, found);
    }
}

/// Reports unconditional jumps back to a label from which every path leads to the jump. `set`: the mnemonics of the file.
pub fn jumps(statements: &[StlStatement], set: Mnemonics, found: &mut Vec<Diagnostic>) {
    let mut labels: FxHashMap<LabelId, usize> = FxHashMap::default();
    // The last statement after which the program may go on elsewhere.
    let mut branch: Option<usize> = None;
    for (at, statement) in statements.iter().enumerate() {
        let leads_away = match &statement.kind {
            StlStatementKind::Label(label) => {
                labels.insert(*label, at);
                false
            }
            StlStatementKind::Instruction { insn, operand: Operand::Label(label) } => {
                let from = labels.get(label).copied().filter(|_| *insn == StlInsn::Jump);
                if from.is_some_and(|from| branch.is_none_or(|branch| branch < from)) {
                    let jump = StlInsn::JumpIf.mnemonic(set);
                    let help = format!("write a conditional jump, such as `{jump}`, or a jump out of the loop");
                    found.push(message(statement.span, "every path from the label leads back to it", &help));
                }
                true
            }
            StlStatementKind::Instruction { insn, .. } => matches!(
                insn,
                StlInsn::BlockEnd
                    | StlInsn::BlockEndUnconditional
                    | StlInsn::BlockEndConditional
                    | StlInsn::CallUnconditional
                    | StlInsn::CallConditional
            ),
            StlStatementKind::JumpList { .. } | StlStatementKind::Call(_) => true,
            StlStatementKind::Assert(_) | StlStatementKind::Sleep(_) => false,
        };
        if leads_away {
            branch = Some(at);
        }
    }
}

fn message(span: Span, label: &str, help: &str) -> Diagnostic {
    Diagnostic::new(Code::NothingLeaves, span, "nothing leaves this loop").label(label).help(help)
}
