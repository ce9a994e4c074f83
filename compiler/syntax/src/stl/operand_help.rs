//! What to write for an operand that an instruction does not take, where the instruction and the operand together say what is meant.

use crate::ast::{Area, BlockName, BlockPrefix, CellKind, Operand, OperandKind, Width};
use crate::literal::Literal;
use crate::stl::{Mnemonics, OperandClass, StlInsn, suggest};

/// The help about the operand `shown` of `written`, in the mnemonics `set`; none: all that is known is what the instruction takes.
pub fn of(set: Mnemonics, insn: StlInsn, written: &str, shown: &str, operand: &Operand) -> Option<String> {
    let (load, transfer) = (StlInsn::Load.mnemonic(set), StlInsn::Transfer.mnemonic(set));
    match (insn.operand(), &operand.kind) {
        (OperandClass::Byte, kind) if matches!(insn, StlInsn::Increment | StlInsn::Decrement) => {
            let step = if insn == StlInsn::Increment { "1" } else { "-1" };
            let change = match kind {
                OperandKind::Path(_) => format!("`+ {step}` (of a DINT `+ L#{step}`)"),
                kind => match width(kind)? {
                    Width::Byte => format!("`{written} 1`"),
                    Width::Word => format!("`+ {step}`"),
                    Width::Dword => format!("`+ L#{step}`"),
                    Width::Bit | Width::Lword => return None,
                },
            };
            Some(format!("it changes ACCU1: write `{load} {shown}`, {change} and `{transfer} {shown}`"))
        }
        (
            OperandClass::LoadSource | OperandClass::TransferTarget,
            OperandKind::Block(BlockName::Numbered { prefix, .. }),
        ) if *prefix == BlockPrefix::Db => {
            let open = StlInsn::OpenDb.mnemonic(set);
            Some(format!("write `{written} {shown}.DBW 0` for a word of it, `{open} {shown}` to open it"))
        }
        (
            OperandClass::LoadSource | OperandClass::TransferTarget,
            OperandKind::Block(BlockName::Numbered { prefix: BlockPrefix::Fc | BlockPrefix::Sfc, .. }),
        ) => Some(value_of_function(insn.operand()).to_owned()),
        (OperandClass::TransferTarget, OperandKind::Cell { kind: CellKind::Counter, .. }) => {
            Some(format!("write `S {shown}`, which sets the counter to the value in ACCU1"))
        }
        (OperandClass::TransferTarget, OperandKind::Cell { kind: CellKind::Timer, .. }) => {
            let start = StlInsn::TimerOnDelay.mnemonic(set);
            Some(format!("write e.g. `{start} {shown}`, which starts the timer with the time in ACCU1"))
        }
        (_, OperandKind::Cell { kind: CellKind::Counter, .. }) if insn == StlInsn::Assign => {
            let (up, down) = (StlInsn::CountUp.mnemonic(set), StlInsn::CountDown.mnemonic(set));
            Some(format!(
                "write `{up} {shown}` to count up, `{down} {shown}` to count down, `S {shown}` to set the counter"
            ))
        }
        (OperandClass::DwordConstOrNone, OperandKind::Literal(Literal::Word(value))) => {
            let word = written.strip_suffix(['D', 'd'])?;
            Some(format!("write `{word}W {shown}` for a word, `{written} DW#16#{value:X}` for a double word"))
        }
        (OperandClass::WordConstOrNone, OperandKind::Literal(Literal::Dword(_) | Literal::Dint(_))) => {
            let word = written.strip_suffix(['W', 'w'])?;
            Some(format!("write `{word}D {shown}`, which works on double words"))
        }
        (OperandClass::LoadAr1 | OperandClass::LoadAr2, OperandKind::Literal(Literal::Int(number @ 0..=4095))) => {
            Some(format!("write `{written} P#{number}.0`, which is the first bit of byte {number}"))
        }
        (_, OperandKind::Status(_))
            if insn == StlInsn::Assign && ["BR", "BIE"].iter().any(|bit| bit.eq_ignore_ascii_case(shown)) =>
        {
            Some("write `SAVE`, which copies the RLO to BR".to_owned())
        }
        (
            OperandClass::LoadAr1 | OperandClass::LoadAr2 | OperandClass::TransferAr1 | OperandClass::TransferAr2,
            kind,
        ) => {
            let OperandKind::Absolute { area, width: Width::Byte | Width::Word, .. } = kind else { return None };
            if !matches!(area, Area::M | Area::L | Area::Db | Area::Di) {
                return None;
            }
            let letters = shown.trim_end_matches(|c: char| !c.is_ascii_alphabetic());
            let double = format!("{}D{}", &letters[..letters.len().checked_sub(1)?], &shown[letters.len()..]);
            Some(format!("an address register has 32 bits: write `{written} {double}`"))
        }
        (OperandClass::Label, OperandKind::Path(path)) => {
            let label = suggest::label(path.name()?);
            Some(format!("write `{written} {label}`: a label has no `#` and no quotes"))
        }
        (OperandClass::LoadSource, OperandKind::Literal(Literal::DateAndTime(_))) => Some(
            "a DATE_AND_TIME has 64 bits: pass it to a block as a parameter, or copy it with SFC 20 BLKMOV".to_owned(),
        ),
        (OperandClass::PointerOrNone, OperandKind::Literal(Literal::Int(number @ 0..=4095))) => {
            let bits = format!("{}.{}", number / 8, number % 8);
            Some(format!("write `{written} P#{number}.0` for bytes, `{written} P#{bits}` for bits"))
        }
        (OperandClass::PointerOrNone, OperandKind::Literal(Literal::AreaPointer { db: 0, .. })) => {
            let offset = shown.trim_start_matches(|c: char| !c.is_ascii_digit());
            Some(format!("write `{written} P#{offset}`, without the letters of the area"))
        }
        (OperandClass::AddConstant, OperandKind::Literal(Literal::Real(_))) => {
            Some(format!("write `{load} {shown}` on the line before, and here `{written}R`"))
        }
        _ => None,
    }
}

/// How STL has the value of a function, for an instruction that names the function.
pub fn value_of_function(class: OperandClass) -> &'static str {
    match class {
        OperandClass::TransferTarget => "inside of a function its value is `#RET_VAL`",
        _ => "call the function with `RET_VAL := …`, and load the variable that is named there",
    }
}

/// The width of an address.
fn width(kind: &OperandKind) -> Option<Width> {
    match kind {
        OperandKind::Absolute { width, .. } | OperandKind::DbAbsolute { width, .. } => Some(*width),
        _ => None,
    }
}
