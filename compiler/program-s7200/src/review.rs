//! Warnings about statements that are valid but useless: outputs that are assigned twice, bits that are set and reset at once, code that is
//! never reached, local memory that is read before it is written, timers that do not wait.
//!
//! A warning is given only where no path through the block makes the statement useful.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::s7200::{Area, Direction, Operand, S7200Body, Statement, StatementKind, Width};
use plcc_model::{Body, CodeBlock};
use plcc_syntax::s7200::{Insn, OperandClass};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::numbers;

/// The messages about the statements of `blocks`.
pub fn review(blocks: &[CodeBlock]) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for block in blocks {
        if let Body::S7200(body) = &block.body {
            outputs(&body.statements, &mut found);
            set_and_reset(&body.statements, &mut found);
            never_reached(&body.statements, &mut found);
            local_memory(body, blocks, &mut found);
            divisions(&body.statements, &mut found);
            presets(&body.statements, &mut found);
            loops(&body.statements, &mut found);
            numbers::review(&body.statements, &mut found);
        }
    }
    found
}

/// Divisions by the constant 0, which never succeed.
fn divisions(statements: &[Statement], found: &mut Vec<Diagnostic>) {
    for statement in statements {
        let StatementKind::Instruction { insn, operands } = &statement.kind else { continue };
        let is_zero = match (insn, operands.first()) {
            (Insn::DivI | Insn::DivD | Insn::Div, Some(Operand::Const(value))) => *value == 0,
            // 0.0 and -0.0.
            (Insn::DivR, Some(Operand::Const(bits))) => *bits << 1 == 0,
            _ => false,
        };
        if is_zero {
            found.push(
                Diagnostic::new(Code::AlwaysSame, statement.span, "a division by the constant 0")
                    .label("it sets SM1.3 and leaves its second operand as it is")
                    .help("the first operand is the divisor: write another number, or an address"),
            );
        }
    }
}

/// Loops whose first constant is above the last one, which the CPU skips.
/// Source: S7-200 system manual, program control instructions.
fn loops(statements: &[Statement], found: &mut Vec<Diagnostic>) {
    for statement in statements {
        let StatementKind::Instruction { insn: Insn::For, operands } = &statement.kind else { continue };
        let [_, Operand::Const(first), Operand::Const(last)] = operands.as_slice() else { continue };
        let (first, last) = (*first as u16 as i16, *last as u16 as i16);
        if first > last {
            found.push(
                Diagnostic::new(Code::UnreachableCode, statement.span, "this loop is never executed")
                    .label(format!("it counts up from {first}, which is above {last}"))
                    .help("write the lower number first; for a loop that counts down calculate with the index in it"),
            );
        }
    }
}

/// Constant presets of timers and counters with which they do not wait.
fn presets(statements: &[Statement], found: &mut Vec<Diagnostic>) {
    for statement in statements {
        let StatementKind::Instruction { insn, operands } = &statement.kind else { continue };
        let [_, Operand::Const(bits)] = operands.as_slice() else { continue };
        let preset = *bits as u16 as i16;
        let (what, label) = match insn {
            Insn::Ton | Insn::Tonr if preset <= 0 => ("timer", "its bit is on as soon as the timer is enabled"),
            Insn::Tof if preset <= 0 => ("timer", "its bit goes off together with the input"),
            // A CTUD counts down to negative numbers, too.
            Insn::Ctu if preset < 0 => ("counter", "its bit is on before anything is counted"),
            _ => continue,
        };
        let title = format!("the preset of this {what} is {preset}");
        found.push(
            Diagnostic::new(Code::TimerWithoutTime, statement.span, title)
                .label(label)
                .help("write a preset from 1 to 32767, or the address of one"),
        );
    }
}

/// Outputs that are assigned twice, with nothing between that reads them or may skip one of the two.
fn outputs(statements: &[Statement], found: &mut Vec<Diagnostic>) {
    let mut assigned: FxHashMap<(u32, u8), Span> = FxHashMap::default();
    for statement in statements {
        let StatementKind::Instruction { insn, operands } = &statement.kind else {
            assigned.clear();
            continue;
        };
        if may_leave(*insn) {
            assigned.clear();
            continue;
        }
        if let (Insn::Assign, [Operand::Memory { area: Area::Q, byte, bit, .. }]) = (insn, operands.as_slice()) {
            if let Some(first) = assigned.insert((*byte, *bit), statement.span) {
                let text = format!("Q{byte}.{bit} is assigned twice; the second assignment wins");
                found.push(
                    Diagnostic::new(Code::DoubleCoil, statement.span, text)
                        .label("assigned again")
                        .also(first, "this assignment has no effect")
                        .help("combine both conditions with O or OLD, or assign different outputs"),
                );
            }
            continue;
        }
        for operand in operands {
            match operand {
                Operand::Memory { area: Area::Q, byte, bit, width: Width::Bit } if is_contact(*insn) => {
                    assigned.remove(&(*byte, *bit));
                }
                Operand::Memory { area: Area::Q, .. } | Operand::Indirect { .. } => assigned.clear(),
                Operand::Memory { .. }
                | Operand::Const(_)
                | Operand::Text(_)
                | Operand::Timer { .. }
                | Operand::Counter { .. }
                | Operand::HighSpeedCounter(_)
                | Operand::Accumulator { .. }
                | Operand::AnalogInput { .. }
                | Operand::AnalogOutput { .. } => {}
            }
        }
    }
}

/// Bits that one statement sets and the next one resets, or the other way round: the top of the logic stack is the same for both.
fn set_and_reset(statements: &[Statement], found: &mut Vec<Diagnostic>) {
    let written = |statement: &Statement| {
        let StatementKind::Instruction { insn: insn @ (Insn::Set | Insn::Reset), operands } = &statement.kind else {
            return None;
        };
        // What special memory does, it may do between them.
        let [bits @ Operand::Memory { area, .. }, count @ Operand::Const(_)] = operands.as_slice() else { return None };
        (*area != Area::Sm).then(|| (*insn, bits.clone(), count.clone()))
    };
    for pair in statements.windows(2) {
        let [first, second] = pair else { continue };
        let (Some((one, bits, count)), Some((other, same, as_many))) = (written(first), written(second)) else {
            continue;
        };
        if one == other || bits != same || count != as_many {
            continue;
        }
        let (verb, done) = if other == Insn::Set { ("sets", "reset") } else { ("resets", "set") };
        found.push(
            Diagnostic::new(
                Code::DoubleCoil,
                second.span,
                "the same bits are set and reset; the second statement wins",
            )
            .label(format!("{verb} what was just {done}"))
            .also(first.span, "this has no effect")
            .help("write its own contacts before each of them"),
        );
    }
}

fn is_contact(insn: Insn) -> bool {
    insn.operands() == [OperandClass::Bit]
}

/// What comes after it may be skipped, or come from elsewhere.
pub(crate) fn may_leave(insn: Insn) -> bool {
    matches!(
        insn,
        Insn::Jmp
            | Insn::Lbl
            | Insn::For
            | Insn::Next
            | Insn::Lscr
            | Insn::Scrt
            | Insn::Scre
            | Insn::Cscre
            | Insn::Cret
            | Insn::Creti
            | Insn::Ret
            | Insn::Reti
            | Insn::End
            | Insn::Mend
            | Insn::Call
    )
}

/// Statements after a jump or an end whose contact is always closed (`LD SM0.0`), up to the next label, loop or sequence step.
fn never_reached(statements: &[Statement], found: &mut Vec<Diagnostic>) {
    // The statement before is `LD SM0.0`.
    let mut is_closed = false;
    let mut left: Option<Span> = None;
    for statement in statements {
        let StatementKind::Instruction { insn, operands } = &statement.kind else {
            // An assertion is checked where it is reached; it is not part of the program.
            if let (Some(by), StatementKind::Call { .. }) = (left, &statement.kind) {
                found.push(unreachable(statement.span, by));
                left = None;
            }
            is_closed = false;
            continue;
        };
        match left {
            Some(_) if is_entered(*insn) || *insn == Insn::Nop => {}
            Some(by) => {
                found.push(unreachable(statement.span, by));
                left = None;
            }
            None => {}
        }
        if is_entered(*insn) {
            left = None;
        }
        let leaves = matches!(insn, Insn::Jmp | Insn::Cret | Insn::Creti | Insn::End);
        if leaves && is_closed {
            left = Some(statement.span);
        }
        let always = [Operand::Memory { area: Area::Sm, byte: 0, bit: 0, width: Width::Bit }];
        is_closed = *insn == Insn::Load && operands.as_slice() == always.as_slice();
    }
}

/// Control comes to it from elsewhere, or it frames a part of the block.
fn is_entered(insn: Insn) -> bool {
    matches!(insn, Insn::Lbl | Insn::For | Insn::Next | Insn::Lscr | Insn::Scre | Insn::Ret | Insn::Reti | Insn::Mend)
}

fn unreachable(span: Span, by: Span) -> Diagnostic {
    Diagnostic::new(Code::UnreachableCode, span, "this statement is never reached")
        .label("no label leads here")
        .also(by, "SM0.0 is always 1, so this always leaves")
        .help("remove it, or give the instruction before it a condition")
}

/// Local memory that is read before anything writes it. A block that may go back is not looked at.
fn local_memory(body: &S7200Body, blocks: &[CodeBlock], found: &mut Vec<Diagnostic>) {
    if goes_back(&body.statements) {
        return;
    }
    let mut written = Written::default();
    for parameter in &body.parameters {
        written.add(parameter.byte, parameter.bit, parameter.width);
    }
    let mut told = FxHashSet::default();
    let mut reads = Vec::new();
    let mut writes = Vec::new();
    for statement in &body.statements {
        match &statement.kind {
            StatementKind::Instruction { insn, operands } => {
                for (operand, class) in operands.iter().zip(insn.operands()) {
                    match class {
                        // The address of local memory is known elsewhere from here on.
                        OperandClass::DwordInAddress if matches!(operand, Operand::Const(_)) => written.all = true,
                        class if is_read(*class) => reads.push(operand),
                        _ => writes.push((operand, is_single(*class))),
                    }
                }
            }
            StatementKind::Call { number, arguments } => {
                let callee = blocks.iter().find(|block| block.kind == BlockKind::Sbr && block.number == *number);
                let Some(Body::S7200(callee)) = callee.map(|block| &block.body) else { return };
                for (argument, parameter) in arguments.iter().zip(&callee.parameters) {
                    match parameter.direction {
                        Direction::In => reads.push(argument),
                        Direction::InOut | Direction::Out => writes.push((argument, true)),
                    }
                }
            }
            StatementKind::Assert(_) | StatementKind::Sleep(_) => {}
        }
        for operand in reads.drain(..) {
            let operand = if let Operand::Indirect { pointer, .. } = operand { pointer } else { operand };
            if let Operand::Memory { area: Area::L, byte, bit, width } = operand
                && !written.has(*byte, *bit, *width)
                && told.insert((*byte, *bit, *width))
            {
                let name = match width {
                    Width::Bit => format!("L{byte}.{bit}"),
                    Width::Byte => format!("LB{byte}"),
                    Width::Word => format!("LW{byte}"),
                    Width::Dword | Width::Lword => format!("LD{byte}"),
                };
                found.push(
                    Diagnostic::new(
                        Code::NeverWritten,
                        statement.span,
                        format!("`{name}` is read before it is written"),
                    )
                    .label("the CPU does not clear local memory: it holds what other subroutines left there")
                    .help("write it first; use V or M memory for what must be kept from one scan to the next"),
                );
            }
        }
        for (operand, single) in writes.drain(..) {
            match operand {
                Operand::Memory { area: Area::L, byte, bit, width } if single => written.add(*byte, *bit, *width),
                Operand::Memory { area: Area::L, .. } => written.all = true,
                Operand::Indirect { .. } => written.all = true,
                _ => {}
            }
        }
    }
}

/// A loop, or a jump to a label before it.
fn goes_back(statements: &[Statement]) -> bool {
    let mut labels = FxHashSet::default();
    statements.iter().any(|statement| match &statement.kind {
        StatementKind::Instruction { insn: Insn::For, .. } => true,
        StatementKind::Instruction { insn, operands } => match (insn, operands.as_slice()) {
            (Insn::Lbl, [Operand::Const(label)]) => {
                labels.insert(*label);
                false
            }
            (Insn::Jmp, [Operand::Const(label)]) => labels.contains(label),
            _ => false,
        },
        StatementKind::Call { .. } | StatementKind::Assert(_) | StatementKind::Sleep(_) => false,
    })
}

pub(crate) fn is_read(class: OperandClass) -> bool {
    matches!(
        class,
        OperandClass::Bit
            | OperandClass::ByteIn
            | OperandClass::WordIn
            | OperandClass::IntIn
            | OperandClass::DwordIn
            | OperandClass::DintIn
            | OperandClass::DwordInAddress
            | OperandClass::RealIn
            | OperandClass::Count
            | OperandClass::SignedCount
    )
}

/// It writes no more than its operand.
pub(crate) fn is_single(class: OperandClass) -> bool {
    matches!(
        class,
        OperandClass::ByteOut
            | OperandClass::WordOut
            | OperandClass::WordOutAnalog
            | OperandClass::DwordOut
            | OperandClass::RealOut
    )
}

/// Bytes and bits of local memory that something has written.
#[derive(Default)]
struct Written {
    all: bool,
    bits: FxHashSet<u32>,
}

impl Written {
    fn range(byte: u32, bit: u8, width: Width) -> std::ops::Range<u32> {
        let first = byte.saturating_mul(8).saturating_add(bit.into());
        first..first.saturating_add(width.bits())
    }

    fn add(&mut self, byte: u32, bit: u8, width: Width) {
        self.bits.extend(Written::range(byte, bit, width));
    }

    fn has(&self, byte: u32, bit: u8, width: Width) -> bool {
        self.all || Written::range(byte, bit, width).any(|bit| self.bits.contains(&bit))
    }
}
