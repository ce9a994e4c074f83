//! What has no effect in a block in STL: statements that never run, labels that no jump names, timers that start
//! without a time, outputs that are assigned twice, bits that are set and reset at once, edges that share their edge
//! memory bit. A warning is given only where no path through the block makes the statement useful.

use std::collections::HashMap;

use plcc_binding::rewrite::{self, Form};
use plcc_diag::{Code, Diagnostic, SourceMap, Span};
use plcc_model::{LabelId, Operand, Place, StlStatement, StlStatementKind};
use plcc_syntax::Elementary;
use plcc_syntax::ast::CellKind;
use plcc_syntax::stl::{OperandClass, StlInsn};
use rustc_hash::FxHashSet;

use super::numbers::operand_text;
use crate::bind::declarations::NumberTypes;

/// Most that a counter counts to.
const COUNT_MAX: u32 = 999;
/// What a timer does with what is not an S5TIME.
const TAKES_BCD: &str = "takes the bits of ACCU1 as time base and three BCD digits";

/// Reports labels that no jump of the block names.
pub fn labels(statements: &[StlStatement], sources: &SourceMap, found: &mut Vec<Diagnostic>) {
    let mut used: FxHashSet<LabelId> = FxHashSet::default();
    for statement in statements {
        match &statement.kind {
            StlStatementKind::Instruction { operand: Operand::Label(label), .. } => {
                used.insert(*label);
            }
            StlStatementKind::JumpList { targets, default } => used.extend(targets.iter().chain([default])),
            StlStatementKind::Label(_)
            | StlStatementKind::Instruction { .. }
            | StlStatementKind::Call(_)
            | StlStatementKind::Assert(_)
            | StlStatementKind::Sleep(_) => {}
        }
    }
    for statement in statements {
        if let StlStatementKind::Label(label) = statement.kind
            && !used.contains(&label)
        {
            found.push(unused_label(statement.span, sources));
        }
    }
}

/// The message about a label in a statement.
pub fn unused_label(span: Span, sources: &SourceMap) -> Diagnostic {
    Diagnostic::new(Code::UnusedLabel, name_of(span, sources), "no jump of the block leads to this label")
        .label("is never used")
        .help("remove it, or look whether a jump is missing")
}

/// The label alone, without its colon and what comes after it.
fn name_of(span: Span, sources: &SourceMap) -> Span {
    let text = sources.file(span.file).text.get(span.start as usize..span.end as usize).unwrap_or_default();
    let length = text.find(':').unwrap_or(text.len());
    Span { end: span.start + text[..length].trim_end().len() as u32, ..span }
}

/// Reports statements that no path reaches.
pub fn unreachable(statements: &[StlStatement], found: &mut Vec<Diagnostic>) {
    // The statement after which none is reached.
    let mut end: Option<Span> = None;
    for statement in statements {
        match &statement.kind {
            StlStatementKind::Label(_) => end = None,
            StlStatementKind::Instruction { insn: StlInsn::BlockEnd, .. } => end = Some(statement.span),
            StlStatementKind::Instruction { insn: StlInsn::Nop | StlInsn::Display, .. }
            | StlStatementKind::Assert(_)
            | StlStatementKind::Sleep(_) => {}
            StlStatementKind::Instruction { .. } | StlStatementKind::JumpList { .. } | StlStatementKind::Call(_) => {
                if let Some(span) = end.take() {
                    let message =
                        Diagnostic::new(Code::UnreachableCode, statement.span, "this statement is never reached");
                    found.push(
                        message
                            .label("no path leads here")
                            .also(span, "the program goes on elsewhere")
                            .help("put a label here and jump to it, or remove the statements up to the next label"),
                    );
                    // One message for all of them.
                    continue;
                }
                let leaves = match &statement.kind {
                    StlStatementKind::Instruction { insn, .. } => {
                        matches!(insn, StlInsn::Jump | StlInsn::BlockEndUnconditional)
                    }
                    StlStatementKind::JumpList { .. } => true,
                    _ => false,
                };
                end = leaves.then_some(statement.span);
            }
        }
    }
}

/// Reports timers without a time, and outputs that are assigned twice.
pub fn values(statements: &[StlStatement], declared: &NumberTypes, sources: &SourceMap, found: &mut Vec<Diagnostic>) {
    let mut accu_is_loaded = false;
    // What loads ACCU1, if the statements before say so.
    let mut loaded: Option<&StlStatement> = None;
    let mut assigned: HashMap<(u32, u8), Span> = HashMap::new();
    for statement in statements {
        let StlStatementKind::Instruction { insn, operand } = &statement.kind else {
            accu_is_loaded = true;
            loaded = None;
            assigned.clear();
            continue;
        };
        if let Some(load) = loaded
            && is_timer_start(*insn)
        {
            found.extend(not_a_time(load, statement.span, declared, sources));
        }
        if let Some(load) = loaded
            && matches!((insn, operand), (StlInsn::Set, Operand::Cell { kind: CellKind::Counter, .. }))
        {
            found.extend(not_a_count(load, statement.span, sources));
        }
        if is_timer_start(*insn) && !accu_is_loaded {
            let message = Diagnostic::new(Code::TimerWithoutTime, statement.span, "this timer starts without a time");
            found.push(
                message
                    .label("nothing is loaded into ACCU1 before it")
                    .help("load the time before the timer, as in `L S5T#2S`"),
            );
        }
        let keeps_accu = matches!(insn, StlInsn::CloseNest | StlInsn::Not | StlInsn::SetRlo | StlInsn::ClearRlo)
            || matches!(insn, StlInsn::Nop | StlInsn::Display)
            || insn.opens_nesting()
            || matches!(
                insn.operand(),
                OperandClass::Bit
                    | OperandClass::BitWrite
                    | OperandClass::BitOrNone
                    | OperandClass::BitWriteOrCounter
                    | OperandClass::BitWriteOrCell
                    | OperandClass::Timer
            );
        accu_is_loaded |= !keeps_accu;
        if !keeps_accu {
            loaded = (*insn == StlInsn::Load).then_some(statement);
        }
        match (insn, operand) {
            (StlInsn::Assign, Operand::Memory { place: Place::Q { byte, bit }, .. }) => {
                if let Some(first) = assigned.insert((*byte, *bit), statement.span) {
                    let text = format!("Q {byte}.{bit} is assigned twice; the second assignment wins");
                    let message = Diagnostic::new(Code::DoubleCoil, statement.span, text);
                    found.push(
                        message
                            .label("assigned again")
                            .also(first, "this assignment has no effect")
                            .help("combine both conditions with O, or assign different outputs"),
                    );
                }
            }
            (_, Operand::Memory { place: Place::Q { byte, bit }, .. }) if keeps_accu => {
                assigned.remove(&(*byte, *bit));
            }
            // Other places are not this output, and what may read it or change the way makes it useful.
            (_, Operand::Memory { place: Place::I { .. } | Place::M { .. } | Place::L { .. }, .. }) => {}
            (_, Operand::Const { .. } | Operand::Cell { .. } | Operand::Status(_)) => {}
            (_, Operand::None) if keeps_accu => {}
            (StlInsn::Nop | StlInsn::Display, _) => {}
            _ => assigned.clear(),
        }
    }
}

/// Reports edges that share their edge memory bit, unless a jump may part them: each reads what the other one wrote; and those whose
/// edge memory bit is the signal.
pub fn edges(statements: &[StlStatement], sources: &SourceMap, found: &mut Vec<Diagnostic>) {
    let mut first: HashMap<(u8, u16, u32, u8), Span> = HashMap::new();
    for (index, statement) in statements.iter().enumerate() {
        match &statement.kind {
            StlStatementKind::Instruction {
                insn: StlInsn::EdgePositive | StlInsn::EdgeNegative,
                operand: Operand::Memory { place, .. },
            } => {
                let Some(bit) = fixed_bit(place) else { continue };
                if let Some(signal) = own_signal(&statements[..index], bit) {
                    let name = operand_text(statement.span, sources);
                    let text = format!("the edge memory bit `{name}` is the signal itself");
                    let message = Diagnostic::new(Code::EdgeBit, statement.span, text);
                    found.push(
                        message
                            .label("has the value of this cycle, so that there is never an edge")
                            .also(signal, "the signal")
                            .help("name a BOOL of its own, in bit memory or in static data"),
                    );
                    continue;
                }
                let Some(first) = first.insert(bit, statement.span) else { continue };
                let text = format!("two edges share the edge memory bit `{}`", operand_text(statement.span, sources));
                let message = Diagnostic::new(Code::EdgeBit, statement.span, text);
                found.push(
                    message
                        .label("this edge reads what the other one wrote")
                        .also(first, "the first edge")
                        .help("give each edge its own BOOL, in bit memory or in static data"),
                );
            }
            StlStatementKind::Instruction { operand: Operand::Label(_), .. }
            | StlStatementKind::Label(_)
            | StlStatementKind::JumpList { .. } => first.clear(),
            StlStatementKind::Instruction { .. }
            | StlStatementKind::Call(_)
            | StlStatementKind::Assert(_)
            | StlStatementKind::Sleep(_) => {}
        }
    }
}

/// Where the bit alone is the RLO after the statements.
fn own_signal(statements: &[StlStatement], bit: (u8, u16, u32, u8)) -> Option<Span> {
    let (signal, before) = statements.split_last()?;
    let StlStatementKind::Instruction { insn: StlInsn::And | StlInsn::Or, operand: Operand::Memory { place, .. } } =
        &signal.kind
    else {
        return None;
    };
    let ends = |statement: &StlStatement| {
        matches!(
            statement.kind,
            StlStatementKind::Instruction { insn: StlInsn::Assign | StlInsn::Set | StlInsn::Reset, .. }
        )
    };
    (before.last().is_none_or(ends) && fixed_bit(place) == Some(bit)).then_some(signal.span)
}

/// Reports a bit that one statement sets and the next one resets, or the other way round: between them the RLO is the same, so that
/// the second one always undoes the first.
pub fn set_and_reset(statements: &[StlStatement], sources: &SourceMap, found: &mut Vec<Diagnostic>) {
    let written = |statement: &StlStatement| {
        let StlStatementKind::Instruction { insn, operand: Operand::Memory { place, .. } } = &statement.kind else {
            return None;
        };
        matches!(insn, StlInsn::Set | StlInsn::Reset).then_some((*insn, fixed_bit(place)?))
    };
    for pair in statements.windows(2) {
        let [first, second] = pair else { continue };
        let (Some((one, bit)), Some((other, same))) = (written(first), written(second)) else { continue };
        if one == other || bit != same {
            continue;
        }
        let name = operand_text(second.span, sources);
        let (verb, done) = if other == StlInsn::Set { ("sets", "reset") } else { ("resets", "set") };
        let text = format!("the same RLO sets and resets `{name}`; the second statement wins");
        let message = Diagnostic::new(Code::DoubleCoil, second.span, text);
        found.push(
            message
                .label(format!("{verb} what was just {done}"))
                .also(first.span, "this has no effect")
                .help("write the condition of its own before each of them"),
        );
    }
}

/// A bit whose place is the same wherever it is named.
fn fixed_bit(place: &Place) -> Option<(u8, u16, u32, u8)> {
    match *place {
        Place::M { byte, bit } => Some((0, 0, byte, bit)),
        Place::Q { byte, bit } => Some((1, 0, byte, bit)),
        Place::Db { number, byte, bit } => Some((2, number, byte, bit)),
        Place::Instance { byte, bit } => Some((3, 0, byte, bit)),
        Place::I { .. }
        | Place::Pi { .. }
        | Place::Pq { .. }
        | Place::L { .. }
        | Place::OpenDb { .. }
        | Place::OpenDi { .. }
        | Place::Parameter { .. }
        | Place::ThroughPointer { .. }
        | Place::Indirect { .. }
        | Place::Register { .. }
        | Place::Element { .. } => None,
    }
}

/// What is wrong if a timer starts with the value of `load`, which is not an S5TIME.
fn not_a_time(load: &StlStatement, timer: Span, declared: &NumberTypes, sources: &SourceMap) -> Option<Diagnostic> {
    if declared.get(&(load.span.file, load.span.end)) == Some(&Elementary::Time) {
        let variable = operand_text(load.span, sources);
        let title = format!("`{variable}` is a TIME, not an S5TIME");
        let message = Diagnostic::new(Code::TimerWithoutTime, timer, title).label(TAKES_BCD);
        let help = format!("convert it before, as FC 40 TIM_S5TI does, or declare `{variable}` as S5TIME");
        return Some(message.also(load.span, "loaded here").help(help));
    }
    let StlStatementKind::Instruction { operand: Operand::Const { value, wide }, .. } = load.kind else { return None };
    let text = sources.file(load.span.file).text.get(load.span.start as usize..load.span.end as usize)?;
    let text = text.split_whitespace().next_back()?.trim_end_matches(';');
    if let Some((title, help)) = rewrite::cut_s5time(text, value as u16) {
        let label = if value == 0 { "the time is over at once" } else { "the time is over sooner" };
        let message = Diagnostic::new(Code::TimerWithoutTime, timer, title).label(label);
        return Some(message.also(load.span, "loaded here").help(help));
    }
    let is_decimal = text.bytes().all(|byte| byte.is_ascii_digit()) && value != 0;
    let count = without_prefix(text, &["C#"]).filter(|_| value != 0);
    if !wide && !is_decimal && count.is_none() && (0..3).all(|digit| value >> (4 * digit) & 0xF <= 9) {
        return None;
    }
    let message = Diagnostic::new(Code::TimerWithoutTime, timer, format!("`{text}` is not an S5TIME"));
    // A pattern of bits is not a number of seconds.
    let help = match text.contains("16#") && !wide {
        true => {
            format!("digits go from 0 to 9: `W#16#{:X}999` is the longest time with this time base", value >> 12 & 3)
        }
        false => rewrite::help(Elementary::S5Time, count.unwrap_or(text), Form::Stl),
    };
    Some(message.label(TAKES_BCD).also(load.span, "loaded here").help(help))
}

/// What is wrong if a counter is preset with the constant of `load`, whose bits are not the BCD number that was meant.
fn not_a_count(load: &StlStatement, set: Span, sources: &SourceMap) -> Option<Diagnostic> {
    let StlStatementKind::Instruction { operand: Operand::Const { value, wide }, .. } = load.kind else { return None };
    let text = sources.file(load.span.file).text.get(load.span.start as usize..load.span.end as usize)?;
    let text = text.split_whitespace().next_back()?.trim_end_matches(';');
    let digit = |at: u32| value >> (4 * at) & 0xF;
    let is_bcd = (0..3).all(|at| digit(at) <= 9);
    let is_decimal = text.bytes().all(|byte| byte.is_ascii_digit()) && value > 9;
    // Of a double word the counter takes the low digits, which hexadecimal ones show as they are.
    let shows_digits = !wide || text.contains("16#");
    let is_time = without_prefix(text, &["S5T#", "S5TIME#"]).is_some() && value != 0;
    if shows_digits && !is_time && !is_decimal && is_bcd {
        return None;
    }
    let label = match is_bcd {
        true => {
            format!("takes its BCD digits, 16#{value:04X}: starts at {}", digit(2) * 100 + digit(1) * 10 + digit(0))
        }
        false => format!("16#{value:04X} is not a number in BCD: an error at run time"),
    };
    let help = match text.parse::<u32>().ok().or((!wide && !is_time).then_some(value)) {
        Some(count @ 0..=COUNT_MAX) => format!("write `C#{count}`"),
        _ => format!("write a value from 0 to {COUNT_MAX} after `C#`"),
    };
    let message = Diagnostic::new(Code::TimerWithoutTime, set, format!("`{text}` is not the value of a counter"));
    Some(message.label(label).also(load.span, "loaded here").help(help))
}

/// What follows one of `prefixes` in a constant.
fn without_prefix<'a>(constant: &'a str, prefixes: &[&str]) -> Option<&'a str> {
    let cut = |prefix: &&str| {
        let (start, rest) = constant.split_at_checked(prefix.len())?;
        start.eq_ignore_ascii_case(prefix).then_some(rest)
    };
    prefixes.iter().find_map(cut)
}

const fn is_timer_start(insn: StlInsn) -> bool {
    matches!(
        insn,
        StlInsn::TimerPulse
            | StlInsn::TimerExtendedPulse
            | StlInsn::TimerOnDelay
            | StlInsn::TimerRetentiveOnDelay
            | StlInsn::TimerOffDelay
    )
}
