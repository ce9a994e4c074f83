//! Whole numbers where a statement takes a REAL, and the reverse: `ITD AIW0, AC1`, `/R 32000.0, AC1`. The CPU takes the bits of one as the other,
//! so the result is wrong without an error. A warning is given only where the statements before it in the network show what is in a double word.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::s7200::{Area, Operand, Statement, StatementKind, Width};
use plcc_syntax::s7200::{CompareKind, Insn, OperandClass, Relation};
use rustc_hash::FxHashMap;

use crate::review::{is_read, is_single, may_leave};

/// A double word.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Place {
    Memory(Area, u32),
    Accumulator(u8),
}

/// A number in a double word, and the statement that has put it there.
#[derive(Clone, Copy)]
struct Number {
    real: bool,
    span: Span,
}

type Known = FxHashMap<Place, Number>;

/// From here on the bits of a whole number may be those of a REAL that somebody means.
const WHOLE_END: u32 = 0x0080_0000;

/// Reports numbers of one kind where the other one is taken.
pub fn review(statements: &[Statement], found: &mut Vec<Diagnostic>) {
    let (mut known, mut network) = (Known::default(), 0);
    for statement in statements {
        if statement.network != network {
            known.clear();
            network = statement.network;
        }
        let StatementKind::Instruction { insn, operands } = &statement.kind else {
            if matches!(statement.kind, StatementKind::Call { .. }) {
                known.clear();
            }
            continue;
        };
        if may_leave(*insn) {
            known.clear();
            continue;
        }
        if compares_bits(*insn, operands) {
            continue;
        }
        for (operand, class) in operands.iter().zip(insn.operands()) {
            let Some((real, place)) = taken(*insn, *class).zip(place(operand)) else { continue };
            if let Some(number) = known.get(&place)
                && number.real != real
            {
                found.push(mixed(place, *number, statement.span));
            }
        }
        let result = result(*insn, operands, &known);
        for (operand, class) in operands.iter().zip(insn.operands()).filter(|(_, class)| !is_read(**class)) {
            forget(operand, is_single(*class), &mut known);
        }
        if let Some((real, place)) = result.zip(operands.last().and_then(place)) {
            known.insert(place, Number { real, span: statement.span });
        }
    }
}

/// `LDD<> VD0, VD4` finds whether a REAL has changed: two equal REALs have the same bits.
fn compares_bits(insn: Insn, operands: &[Operand]) -> bool {
    let Insn::Compare(compare) = insn else { return false };
    compare.kind == CompareKind::Dword
        && matches!(compare.relation, Relation::Eq | Relation::Ne)
        && !operands.iter().any(|operand| matches!(operand, Operand::Const(_)))
}

/// Whether an operand is taken as a REAL or as a whole number; `None`: as bits, or not at all.
fn taken(insn: Insn, class: OperandClass) -> Option<bool> {
    match class {
        OperandClass::RealIn => (insn != Insn::MovR).then_some(true),
        OperandClass::DintIn => Some(false),
        OperandClass::RealOut => matches!(insn, Insn::AddR | Insn::SubR | Insn::MulR | Insn::DivR).then_some(true),
        OperandClass::DwordOut => {
            let counts = matches!(insn, Insn::IncD | Insn::DecD);
            (counts || matches!(insn, Insn::AddD | Insn::SubD | Insn::MulD | Insn::DivD)).then_some(false)
        }
        _ => None,
    }
}

/// Whether the last operand gets a REAL or a whole number; `None`: it is not known.
fn result(insn: Insn, operands: &[Operand], known: &Known) -> Option<bool> {
    match insn {
        Insn::AddR | Insn::SubR | Insn::MulR | Insn::DivR | Insn::Dtr | Insn::Str => Some(true),
        Insn::Sqrt | Insn::Sin | Insn::Cos | Insn::Tan | Insn::Ln | Insn::Exp => Some(true),
        Insn::AddD | Insn::SubD | Insn::MulD | Insn::DivD | Insn::IncD | Insn::DecD => Some(false),
        Insn::Mul | Insn::Itd | Insn::Round | Insn::Trunc | Insn::Std => Some(false),
        Insn::MovD | Insn::MovR => match operands.first()? {
            // 0 and 0.0 have the same bits.
            Operand::Const(0) => None,
            Operand::Const(_) if insn == Insn::MovR => Some(true),
            Operand::Const(bits) => ((*bits as i32).unsigned_abs() < WHOLE_END).then_some(false),
            operand => known.get(&place(operand)?).map(|number| number.real),
        },
        _ => None,
    }
}

fn place(operand: &Operand) -> Option<Place> {
    match operand {
        Operand::Memory { area, byte, width: Width::Dword, .. } => Some(Place::Memory(*area, *byte)),
        Operand::Accumulator { number, width: Width::Dword } => Some(Place::Accumulator(*number)),
        _ => None,
    }
}

/// An operand is written; unless `single`, so is what comes after it.
fn forget(operand: &Operand, single: bool, known: &mut Known) {
    match operand {
        Operand::Memory { area, byte, width, .. } if single => {
            let (first, end) = (*byte, *byte + width.bits().div_ceil(8));
            known.retain(|place, _| match place {
                Place::Memory(other, at) => other != area || *at >= end || first >= *at + 4,
                Place::Accumulator(_) => true,
            });
        }
        Operand::Accumulator { number, .. } => {
            known.remove(&Place::Accumulator(*number));
        }
        Operand::Memory { .. } | Operand::Indirect { .. } => known.clear(),
        Operand::Const(_)
        | Operand::Text(_)
        | Operand::Timer { .. }
        | Operand::Counter { .. }
        | Operand::HighSpeedCounter(_)
        | Operand::AnalogInput { .. }
        | Operand::AnalogOutput { .. } => {}
    }
}

fn mixed(place: Place, number: Number, span: Span) -> Diagnostic {
    let name = match place {
        Place::Memory(area, byte) => format!("{}D{byte}", area.letters()),
        Place::Accumulator(number) => format!("AC{number}"),
    };
    let (is, wants, help) = match number.real {
        true => ("a REAL", "a whole number", format!("convert it before, `ROUND {name}, {name}`")),
        false => ("a whole number", "a REAL", format!("convert it before, `DTR {name}, {name}`")),
    };
    Diagnostic::new(Code::MixedNumbers, span, format!("{name} has {is}, but this takes {wants}"))
        .label(format!("takes the bits of {name} as {wants}"))
        .also(number.span, format!("{is} since here"))
        .help(help)
}
