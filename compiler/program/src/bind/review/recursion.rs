//! Calls that never end: blocks that call themselves, or each other, in each of their calls. A call under a condition may end, and is not
//! looked at: STEP 7 allows recursion up to the nesting depth of the CPU.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Call, Complex, Expr, ExprKind, Statement, StatementKind, walk};
use plcc_model::{BlockKey, Body, CodeBlock, Number, Operand, StlStatement, StlStatementKind};
use plcc_syntax::stl::StlInsn;
use rustc_hash::FxHashMap;

use super::Language;

/// How many calls of a chain are shown.
const SHOWN_MAX: usize = 4;

/// Reports chains of calls that lead back to their first block without a condition. `shown`: the name of a block.
pub fn review(blocks: &[(&CodeBlock, Language)], shown: &dyn Fn(BlockKey) -> String, found: &mut Vec<Diagnostic>) {
    let places: FxHashMap<BlockKey, usize> =
        blocks.iter().enumerate().map(|(at, (block, _))| (block.key(), at)).collect();
    let certain = |(block, language): &(&CodeBlock, Language)| match language {
        Language::Chart => Vec::new(),
        Language::Stl | Language::Scl | Language::Networks => {
            let calls = certain_calls(&block.body).into_iter();
            calls.filter_map(|(key, span)| Some((*places.get(&key)?, span))).collect()
        }
    };
    let calls: Vec<Vec<(usize, Span)>> = blocks.iter().map(certain).collect();
    let mut seen = vec![false; blocks.len()];
    let mut told = vec![false; blocks.len()];
    // Where a block is on the path.
    let mut on_path: Vec<Option<usize>> = vec![None; blocks.len()];
    for start in 0..blocks.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        on_path[start] = Some(0);
        // Blocks, with how many of their calls have been followed.
        let mut path: Vec<(usize, usize)> = vec![(start, 0)];
        while let Some(&(block, next)) = path.last() {
            let Some(&(target, _)) = calls[block].get(next) else {
                on_path[block] = None;
                path.pop();
                continue;
            };
            let last = path.len() - 1;
            path[last].1 = next + 1;
            match on_path[target] {
                Some(first) => {
                    let chain = &path[first..];
                    if chain.iter().any(|(block, _)| told[*block]) {
                        continue;
                    }
                    let call = |(block, followed): &(usize, usize)| {
                        (shown(blocks[*block].0.key()), calls[*block][*followed - 1].1)
                    };
                    let links: Vec<(String, Span)> = chain.iter().map(call).collect();
                    found.extend(message(&links));
                    chain.iter().for_each(|(block, _)| told[*block] = true);
                }
                None if !seen[target] => {
                    seen[target] = true;
                    on_path[target] = Some(path.len());
                    path.push((target, 0));
                }
                None => {}
            }
        }
    }
}

/// The message for a chain: each block with its call of the next one, the last with that of the first.
fn message(links: &[(String, Span)]) -> Option<Diagnostic> {
    let ((name, span), others) = links.split_first()?;
    let title = match others {
        [] => format!("{name} calls itself in each of its calls"),
        [(other, _)] => format!("{name} calls {other}, and {other} calls {name}, in each of their calls"),
        _ => format!("{name} calls itself in each of its calls, by way of {} other blocks", others.len()),
    };
    let mut message = Diagnostic::new(Code::NothingLeaves, *span, title).label("no condition ends these calls");
    for (at, (other, span)) in others.iter().enumerate().take(SHOWN_MAX) {
        let next = others.get(at + 1).map_or(name, |(next, _)| next);
        message = message.also(*span, format!("{other} calls {next}"));
    }
    let help =
        "remove the call, or make it under a condition that ends: the CPU stops when blocks are nested too deeply";
    Some(message.help(help))
}

/// The blocks that are called whenever the block is, with the places of the calls.
fn certain_calls(body: &Body) -> Vec<(BlockKey, Span)> {
    let mut calls = Vec::new();
    match body {
        Body::Stl(statements) => {
            for statement in statements {
                if !goes_on(statement, &mut calls) {
                    break;
                }
            }
        }
        Body::Scl(body) => of_list(&body.statements, &mut calls),
        Body::S7200(_) | Body::Runtime => {}
    }
    calls
}

/// Notes the call of a statement. False: what follows may be skipped.
fn goes_on(statement: &StlStatement, calls: &mut Vec<(BlockKey, Span)>) -> bool {
    match &statement.kind {
        StlStatementKind::Call(call) => calls.push((call.target, statement.span)),
        StlStatementKind::Instruction {
            insn: StlInsn::CallUnconditional,
            operand: Operand::Block { kind, number: Number::Known(number) },
        } => calls.push((BlockKey { kind: *kind, number: *number }, statement.span)),
        StlStatementKind::JumpList { .. } | StlStatementKind::Instruction { operand: Operand::Label(_), .. } => {
            return false;
        }
        StlStatementKind::Instruction { insn, .. } => {
            return !matches!(insn, StlInsn::BlockEnd | StlInsn::BlockEndUnconditional | StlInsn::BlockEndConditional);
        }
        StlStatementKind::Label(_) | StlStatementKind::Assert(_) | StlStatementKind::Sleep(_) => {}
    }
    true
}

fn of_list(list: &[Statement], calls: &mut Vec<(BlockKey, Span)>) {
    for statement in list {
        let call = match &statement.kind {
            StatementKind::Call(call) => Some(call.as_ref()),
            StatementKind::Assign { value, .. } | StatementKind::Evaluate(value) => called(value),
            StatementKind::AssignText { value: Complex::Call(call), .. }
            | StatementKind::Copy { source: Complex::Call(call), .. } => Some(call.as_ref()),
            StatementKind::Stl(statement) => {
                if !goes_on(statement, calls) {
                    return;
                }
                None
            }
            _ => None,
        };
        calls.extend(call.filter(|call| call.enable.is_none()).map(|call| (call.target, call.span)));
        let leaves = |one: &Statement| {
            let leaves = matches!(
                one.kind,
                StatementKind::Return(_) | StatementKind::Goto(_) | StatementKind::Exit | StatementKind::Continue
            );
            leaves.then_some(())
        };
        if walk::find(std::slice::from_ref(statement), &leaves).is_some() {
            return;
        }
    }
}

/// The call whose value the expression is.
fn called(value: &Expr) -> Option<&Call> {
    match &value.kind {
        ExprKind::Call(call) => Some(call.as_ref()),
        ExprKind::Convert { operand, .. } => called(operand),
        _ => None,
    }
}
