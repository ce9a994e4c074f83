//! Whole numbers where STL calculates with REAL, and the reverse: `L 2`, `*R`; numbers of 16 bits where it calculates with 32, and the
//! reverse: `L -5`, `+D`. The CPU takes the bits of one as the other, so the result is wrong without an error. A warning is given only where
//! the statements directly before show what is in an accumulator.

use plcc_diag::{Code, Diagnostic, SourceMap, Span};
use plcc_model::{Operand, Place, StlStatement, StlStatementKind};
use plcc_syntax::ast::Width;
use plcc_syntax::stl::{Mnemonics, OperandClass, StlInsn};
use plcc_syntax::{Class, Elementary};

use crate::bind::declarations::NumberTypes;

/// A number in an accumulator: where it was loaded or calculated.
#[derive(Clone, Copy)]
struct Number {
    real: bool,
    /// INT or DINT, where that is known; WORD for 16 bits or less that have no such type.
    whole: Option<Elementary>,
    span: Span,
    /// The statement loads it.
    loaded: bool,
    /// What instructions of another width take it for.
    other_width: Option<OtherWidth>,
    /// Its value, if it is a decimal constant.
    constant: Option<i32>,
}

/// A constant that is another number to instructions of another width.
#[derive(Clone, Copy)]
enum OtherWidth {
    /// A negative INT: `L` puts zeros before its 16 bits. The number of these 32 bits.
    Long(i32),
    /// A DINT that an INT cannot hold. The number of its low 16 bits.
    Short(i16),
}

/// How many statements after a calculation are looked at for an address.
const ADDRESS_MAX: usize = 24;
/// How many statements after the transfer of a number are looked at for its use as an address.
const POINTER_MAX: usize = 200;
/// How many statements before and after a transfer are looked at for a shift.
const SHIFT_MAX: usize = 6;

/// Reports numbers of two kinds in one calculation.
pub fn review(statements: &[StlStatement], declared: &NumberTypes, sources: &SourceMap, found: &mut Vec<Diagnostic>) {
    let (mut accu1, mut accu2): (Option<Number>, Option<Number>) = (None, None);
    for pair in statements.windows(2) {
        found.extend(divided_by_zero(&pair[0], &pair[1]));
    }
    for (at, statement) in statements.iter().enumerate() {
        let StlStatementKind::Instruction { insn, operand } = &statement.kind else {
            (accu1, accu2) = (None, None);
            continue;
        };
        let span = statement.span;
        let calculated =
            |real, whole| Some(Number { real, whole, span, loaded: false, other_width: None, constant: None });
        if let Some((real, compares)) = calculation(*insn) {
            let has_int = [accu1, accu2].into_iter().flatten().any(|number| number.whole == Some(Elementary::Int));
            let is_address = has_int && !compares && becomes_address(&statements[at + 1..]);
            // REALs that are the same have the same bits.
            let are_bits = matches!(insn, StlInsn::CompareEqD | StlInsn::CompareNeD)
                && [accu1, accu2].into_iter().flatten().all(|number| number.real && !is_constant(number, sources));
            if are_bits {
                continue;
            }
            for number in [accu2, accu1].into_iter().flatten() {
                found.extend(match number.real == real {
                    true if is_address && number.whole == Some(Elementary::Int) => None,
                    true => of_other_width(number, is_long(*insn), span, sources),
                    false => Some(mixed(number, span, real, sources)),
                });
            }
            if !compares {
                let whole = is_long(*insn).then_some(Elementary::Dint);
                (accu1, accu2) = (calculated(real, whole), None);
            }
            continue;
        }
        match insn {
            StlInsn::Load => {
                accu2 = accu1;
                accu1 = loaded(statement, operand, declared, sources);
            }
            StlInsn::Transfer => {
                let ty = declared.get(&(span.file, span.end)).copied();
                if let (Some(number), Some(ty)) = (accu1, ty) {
                    found.extend(match number.real == (ty.class() == Class::Float) {
                        true => stored_in_other_width(number, ty, span, sources),
                        false => Some(transferred(number, ty, span, sources)),
                    });
                } else if let (Some(number), Operand::Memory { width, .. }) = (accu1, operand)
                    && width.bits() < 32
                    && !is_cut_in_halves(statements, at)
                {
                    found.extend(match (number.real, number.constant) {
                        (true, _) => Some(cut_off(number, *width, span, sources)),
                        (false, Some(value)) => too_large(value, number, *width, span, sources),
                        (false, None) => None,
                    });
                }
            }
            StlInsn::SwapAccu => std::mem::swap(&mut accu1, &mut accu2),
            StlInsn::Push => accu2 = accu1,
            StlInsn::Pop => accu1 = accu2.take(),
            StlInsn::DToR => {
                found.extend(accu1.and_then(|number| of_other_width(number, true, span, sources)));
                accu1 = calculated(true, None);
            }
            StlInsn::BcdToI => accu1 = calculated(false, None),
            StlInsn::IToD | StlInsn::BcdToD => accu1 = calculated(false, Some(Elementary::Dint)),
            StlInsn::Round | StlInsn::RoundUp | StlInsn::RoundDown | StlInsn::Truncate => {
                if let Some(number) = accu1.filter(|number| !number.real) {
                    found.push(mixed(number, span, true, sources));
                }
                accu1 = calculated(false, Some(Elementary::Dint));
            }
            StlInsn::NegI | StlInsn::NegD => {
                if let Some(number) = accu1 {
                    found.extend(match number.real {
                        true => Some(mixed(number, span, false, sources)),
                        false => of_other_width(number, is_long(*insn), span, sources),
                    });
                }
                accu1 = calculated(false, is_long(*insn).then_some(Elementary::Dint));
            }
            StlInsn::AddConst => {
                // Another number of the same kind.
                accu1 = accu1.map(|number| Number { other_width: None, constant: None, ..number });
            }
            insn if is_function_of_real(*insn) => {
                if let Some(number) = accu1.filter(|number| !number.real) {
                    found.push(mixed(number, span, true, sources));
                }
                accu1 = calculated(true, None);
            }
            insn if keeps_accus(*insn) => {}
            _ => (accu1, accu2) = (None, None),
        }
    }
}

/// `L 0`, `/I`
fn divided_by_zero(load: &StlStatement, division: &StlStatement) -> Option<Diagnostic> {
    let (
        StlStatementKind::Instruction { insn: StlInsn::Load, operand: Operand::Const { value: 0, .. } },
        StlStatementKind::Instruction { insn: StlInsn::DivI | StlInsn::DivD | StlInsn::ModD, .. },
    ) = (&load.kind, &division.kind)
    else {
        return None;
    };
    Some(
        Diagnostic::new(Code::AlwaysSame, division.span, "this always divides by 0")
            .label("sets OV and OS")
            .also(load.span, "loaded here")
            .help("load the divisor on the line before: a number that is not 0, or an address"),
    )
}

/// Whether an instruction calculates with two numbers or compares them: with REAL, and whether it compares.
pub(super) fn calculation(insn: StlInsn) -> Option<(bool, bool)> {
    let mnemonic = insn.mnemonic(Mnemonics::En);
    let sign = mnemonic.strip_suffix(['I', 'D', 'R'])?;
    let compares = matches!(sign, "==" | "<>" | ">" | "<" | ">=" | "<=");
    (compares || matches!(sign, "+" | "-" | "*" | "/")).then_some((mnemonic.ends_with('R'), compares))
}

/// Whether an instruction for whole numbers takes 32 bits.
fn is_long(insn: StlInsn) -> bool {
    insn.mnemonic(Mnemonics::En).ends_with('D')
}

/// Whether the result of a calculation becomes an address, as that of `L #i`, `L P#2.0`, `*D`, `LAR1`: an index is not negative. `rest`: what
/// follows the calculation.
fn becomes_address(rest: &[StlStatement]) -> bool {
    for (at, statement) in rest.iter().enumerate().take(ADDRESS_MAX) {
        let StlStatementKind::Instruction { insn, operand } = &statement.kind else { return false };
        match (insn, operand) {
            (StlInsn::LoadAr1 | StlInsn::LoadAr2 | StlInsn::AddAr1 | StlInsn::AddAr2, Operand::None) => return true,
            (StlInsn::Transfer, Operand::Memory { place, .. }) => {
                let later = &rest[at + 1..rest.len().min(at + 1 + POINTER_MAX)];
                return later.iter().enumerate().any(|(at, statement)| points(statement, later.get(at + 1), place));
            }
            (StlInsn::Load | StlInsn::AddConst | StlInsn::ShiftLeftD, _) => {}
            _ if is_long(*insn) && calculation(*insn) == Some((false, false)) => {}
            _ => return false,
        }
    }
    false
}

/// Whether the transfer at `at` stores one half of a value, and a shift beside it moves the other half to where a transfer takes it.
fn is_cut_in_halves(statements: &[StlStatement], at: usize) -> bool {
    let end = statements.len().min(at + 1 + SHIFT_MAX);
    statements[at.saturating_sub(SHIFT_MAX)..end].iter().any(|statement| {
        matches!(
            statement.kind,
            StlStatementKind::Instruction {
                insn: StlInsn::ShiftRightD
                    | StlInsn::ShiftLeftD
                    | StlInsn::RotateRightD
                    | StlInsn::RotateLeftD
                    | StlInsn::SwapBytesDword
                    | StlInsn::ShiftRightW
                    | StlInsn::ShiftLeftW
                    | StlInsn::SwapBytesWord,
                ..
            }
        )
    })
}

/// Whether a statement takes the value of `pointer` as an address: `L DBW [#p]`, `LAR1 #p`, `L #p` before `LAR1`.
fn points(statement: &StlStatement, next: Option<&StlStatement>, pointer: &Place) -> bool {
    let StlStatementKind::Instruction { insn, operand: Operand::Memory { place, .. } } = &statement.kind else {
        return false;
    };
    let before_register = || {
        next.is_some_and(|next| {
            matches!(
                next.kind,
                StlStatementKind::Instruction { insn: StlInsn::LoadAr1 | StlInsn::LoadAr2, operand: Operand::None }
            )
        })
    };
    match (insn, place) {
        (_, Place::Indirect { pointer: own, .. }) => **own == *pointer,
        (StlInsn::LoadAr1 | StlInsn::LoadAr2, own) => own == pointer,
        (StlInsn::Load, own) => own == pointer && before_register(),
        _ => false,
    }
}

fn is_function_of_real(insn: StlInsn) -> bool {
    matches!(
        insn,
        StlInsn::AbsR
            | StlInsn::NegR
            | StlInsn::SqrR
            | StlInsn::SqrtR
            | StlInsn::ExpR
            | StlInsn::LnR
            | StlInsn::SinR
            | StlInsn::CosR
            | StlInsn::TanR
            | StlInsn::AsinR
            | StlInsn::AcosR
            | StlInsn::AtanR
    )
}

/// Instructions of bits, and those that do nothing.
fn keeps_accus(insn: StlInsn) -> bool {
    insn.opens_nesting()
        || matches!(insn, StlInsn::CloseNest | StlInsn::Not | StlInsn::SetRlo | StlInsn::ClearRlo | StlInsn::Nop)
        || matches!(insn, StlInsn::Display)
        || matches!(insn.operand(), OperandClass::Bit | OperandClass::BitWrite | OperandClass::BitOrNone)
}

/// What a statement loads, if its constant or declared type says so. The bits of 0 are those of 0.0.
fn loaded(load: &StlStatement, operand: &Operand, declared: &NumberTypes, sources: &SourceMap) -> Option<Number> {
    let (mut whole, mut other_width, mut constant) = (None, None, None);
    let real = match operand {
        Operand::Const { value: 0, .. } => return None,
        Operand::Const { value, .. } => {
            let text = operand_text(load.span, sources).to_ascii_uppercase();
            let number = text.trim_start_matches(['+', '-']);
            let digits = number.strip_prefix("L#").unwrap_or(number).trim_start_matches(['+', '-']);
            match () {
                () if digits.is_empty() => return None,
                () if digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'_') => {
                    let number = *value as i32;
                    other_width = match text.starts_with("L#") {
                        true => i16::try_from(number).is_err().then_some(OtherWidth::Short(number as i16)),
                        false => text.starts_with('-').then_some(OtherWidth::Long(number)),
                    };
                    constant = Some(if text.starts_with('-') { i32::from(number as i16) } else { number });
                    false
                }
                () if number.starts_with(|c: char| c.is_ascii_digit()) && number.contains('.') => true,
                () => return None,
            }
        }
        Operand::Memory { width, .. } => match declared.get(&(load.span.file, load.span.end)) {
            Some(&ty) => {
                whole = match ty {
                    Elementary::Int => Some(Elementary::Int),
                    // Milliseconds are counted in 32 bits.
                    Elementary::Dint | Elementary::Time => Some(Elementary::Dint),
                    _ => None,
                };
                ty.class() == Class::Float
            }
            None if matches!(width, Width::Byte | Width::Word) => {
                whole = Some(Elementary::Word);
                false
            }
            None => return None,
        },
        Operand::Cell { .. } => {
            whole = Some(Elementary::Word);
            false
        }
        _ => return None,
    };
    Some(Number { real, whole, span: load.span, loaded: true, other_width, constant })
}

/// The operand of a statement, as written: also of `L-5`, where no blank is before it.
pub(super) fn operand_text(span: Span, sources: &SourceMap) -> &str {
    let text = sources.file(span.file).text.get(span.range()).unwrap_or_default();
    let text = text.trim_start_matches(|c: char| c.is_ascii_alphanumeric());
    text.trim().trim_end_matches(';').trim_end()
}

/// A statement as written, with single blanks.
pub(super) fn written(span: Span, sources: &SourceMap) -> String {
    let text = sources.file(span.file).text.get(span.range()).unwrap_or_default();
    text.trim_end_matches(';').split_whitespace().collect::<Vec<_>>().join(" ")
}

/// `real`: the instruction calculates with REAL.
fn mixed(number: Number, span: Span, real: bool, sources: &SourceMap) -> Diagnostic {
    let insn = written(span, sources);
    let (wants, is) = if real { ("REAL", "a whole number") } else { ("whole numbers", "a REAL") };
    let what = if number.loaded { format!("`{}`", operand_text(number.span, sources)) } else { "ACCU1".to_string() };
    let title = match number.loaded {
        true => format!("`{insn}` calculates with {wants}, but {what} is {is}"),
        false => format!("`{insn}` calculates with {wants}, but `{}` leaves {is}", written(number.span, sources)),
    };
    let message = Diagnostic::new(Code::MixedNumbers, span, title).label(format!("takes the bits as {wants}"));
    let note = if number.loaded { "loaded here" } else { "calculated here" };
    message.also(number.span, note).help(conversion(number, sources))
}

/// Whether the number is a constant that a statement loads.
fn is_constant(number: Number, sources: &SourceMap) -> bool {
    let operand = if number.loaded { operand_text(number.span, sources) } else { "" };
    let digits = operand.strip_prefix("L#").unwrap_or(operand).trim_start_matches(['+', '-']);
    digits.starts_with(|c: char| c.is_ascii_digit())
}

/// How the number becomes one of the other kind.
fn conversion(number: Number, sources: &SourceMap) -> String {
    let operand = if number.loaded { operand_text(number.span, sources) } else { "" };
    let digits = operand.strip_prefix("L#").unwrap_or(operand);
    match (number.real, is_constant(number, sources)) {
        (false, true) => format!("write `L {digits}.0`"),
        (true, true) => "write the number without a fraction, or calculate with the instruction for REAL".to_string(),
        (false, false) => {
            let statement = written(number.span, sources);
            match number.whole {
                Some(Elementary::Dint) => format!("write `DTR` after `{statement}`"),
                Some(_) => format!("write `ITD` and `DTR` after `{statement}`"),
                None => format!("write `ITD` and `DTR` after `{statement}`; for a DINT `DTR` alone"),
            }
        }
        (true, false) => format!("write `RND` after `{}`, which makes a DINT", written(number.span, sources)),
    }
}

/// A number that an instruction takes as another one. `long`: it takes 32 bits.
fn of_other_width(number: Number, long: bool, span: Span, sources: &SourceMap) -> Option<Diagnostic> {
    if long && number.whole == Some(Elementary::Int) {
        return Some(without_sign(number, span, sources));
    }
    let (insn, constant) = (written(span, sources), operand_text(number.span, sources));
    let (title, label) = match number.other_width? {
        OtherWidth::Long(bits) if long => {
            (format!("`{insn}` takes 32 bits, but `{constant}` has 16"), format!("takes {constant} as {bits}"))
        }
        OtherWidth::Short(bits) if !long => {
            (format!("`{insn}` takes 16 bits, but `{constant}` needs 32"), format!("takes {constant} as {bits}"))
        }
        OtherWidth::Long(_) | OtherWidth::Short(_) => return None,
    };
    let message = Diagnostic::new(Code::MixedNumbers, span, title).label(label);
    Some(message.also(number.span, "loaded here").help(match long {
        true => format!("write `L L#{constant}`"),
        false => insn.strip_suffix(['I', 'i']).map_or_else(String::new, |sign| format!("write `{sign}D`")),
    }))
}

/// An INT where the statement takes a DINT.
fn without_sign(number: Number, span: Span, sources: &SourceMap) -> Diagnostic {
    let (statement, variable) = (written(span, sources), operand_text(number.span, sources));
    let title = format!("`{statement}` takes a DINT, but `{variable}` is an INT");
    Diagnostic::new(Code::MixedNumbers, span, title)
        .label("counts a negative INT as a number from 32768 to 65535")
        .also(number.span, "loads 16 bits and sets the others to 0")
        .help(format!("write `ITD` after `{}`", written(number.span, sources)))
}

/// A number that a variable of another width holds as another one.
fn stored_in_other_width(number: Number, ty: Elementary, span: Span, sources: &SourceMap) -> Option<Diagnostic> {
    if (number.whole, ty) == (Some(Elementary::Int), Elementary::Dint) {
        return Some(without_sign(number, span, sources));
    }
    let (variable, constant) = (operand_text(span, sources), operand_text(number.span, sources));
    let (bits, help) = match (number.other_width?, ty) {
        (OtherWidth::Long(bits), Elementary::Dint) => (bits, format!("write `L L#{constant}`")),
        (OtherWidth::Short(bits), Elementary::Int) => {
            (bits.into(), format!("declare `{variable}` as DINT, or load a number that it can hold"))
        }
        (OtherWidth::Long(_) | OtherWidth::Short(_), _) => return None,
    };
    let title = format!("`{variable}` is of type {}, and gets {bits} from `{constant}`", ty.name());
    let message = Diagnostic::new(Code::MixedNumbers, span, title).label(format!("stores {bits}"));
    Some(message.also(number.span, "loaded here").help(help))
}

/// A REAL that is stored in 16 bits or less.
fn cut_off(number: Number, width: Width, span: Span, sources: &SourceMap) -> Diagnostic {
    let bits = width.bits();
    let title = format!("`{}` has {bits} bits, but ACCU1 has a REAL", operand_text(span, sources));
    let message = Diagnostic::new(Code::MixedNumbers, span, title).label(format!("stores the lower {bits} bits of it"));
    let note = if number.loaded { "loaded here" } else { "calculated here" };
    message.also(number.span, note).help(conversion(number, sources))
}

/// A constant that is stored in fewer bits than it needs.
fn too_large(value: i32, number: Number, width: Width, span: Span, sources: &SourceMap) -> Option<Diagnostic> {
    let bits = width.bits();
    let (low, high) = (-(1 << (bits - 1)), (1 << bits) - 1);
    if (low..=high).contains(&value) {
        return None;
    }
    let (variable, constant) = (operand_text(span, sources), operand_text(number.span, sources));
    let title = format!("`{variable}` has {bits} bits, but `{constant}` needs more");
    let message = Diagnostic::new(Code::MixedNumbers, span, title).label(format!("stores {}", value & high));
    let help = format!("load a number from {low} to {high}, or transfer it to more bits");
    Some(message.also(number.span, "loaded here").help(help))
}

fn transferred(number: Number, ty: Elementary, span: Span, sources: &SourceMap) -> Diagnostic {
    let is = if number.real { "a REAL" } else { "a whole number" };
    let title = format!("`{}` is of type {}, but ACCU1 has {is}", operand_text(span, sources), ty.name());
    let message = Diagnostic::new(Code::MixedNumbers, span, title).label(format!("stores the bits of {is}"));
    let note = if number.loaded { "loaded here" } else { "calculated here" };
    message.also(number.span, note).help(conversion(number, sources))
}
