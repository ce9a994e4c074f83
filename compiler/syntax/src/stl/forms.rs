//! Operands in the form of other languages: a negation, an operator or a second operand in a statement.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic};

use crate::stl::messages::State;
use crate::stl::token::{Spanned, Tok};
use crate::stl::{Mnemonics, OperandClass, StlInsn, form_help, mnemonics};

/// Whether an operand ends with the token, whatever follows.
pub fn is_operand_end(token: &Tok) -> bool {
    matches!(
        token,
        Tok::Local(_)
            | Tok::Quoted(_)
            | Tok::Literal(_)
            | Tok::BitAddress(..)
            | Tok::Address(_)
            | Tok::Block(..)
            | Tok::RightBracket
    )
}

/// `A NOT #a`, `= NOT #a`
pub fn negated_operand(state: &State, index: usize, before: Option<&Spanned>) -> Option<Diagnostic> {
    let (start, _, end) = before?;
    let word = &state.text[*start..*end];
    let insn = match state.tokens.get(index.checked_sub(2)?)? {
        (_, Tok::Insn(insn), _) => insn.mnemonic(state.rules),
        _ => return None,
    };
    let operand = state.tokens.get(index).filter(|(start, _, end)| start < end)?;
    let writes = matches!(insn, "=" | "S" | "R");
    if !word.eq_ignore_ascii_case("NOT")
        || !writes && !matches!(insn, "A" | "AN" | "O" | "ON" | "X" | "XN" | "U" | "UN")
    {
        return None;
    }
    let meant = insn.strip_suffix('N').map_or_else(|| format!("{insn}N"), str::to_owned);
    let line = state.text[operand.0..].find(['\n', ';', '/']).map_or(state.text.len(), |length| operand.0 + length);
    let operand = state.text[operand.0..line].trim();
    if writes {
        return Some(
            Diagnostic::new(Code::ForeignForm, state.span(*start..*end), "`NOT` is not allowed before an operand")
                .label("an instruction without operand")
                .help(format!("write `NOT` on a line of its own before `{insn} {operand}`")),
        );
    }
    Some(
        Diagnostic::new(Code::ForeignForm, state.span(*start..*end), "a negation is a part of the instruction")
            .label("a form of other languages")
            .help(format!("write `{meant} {operand}`")),
    )
}

/// `A I 0.0 AND I 0.1`: the rest is a statement of its own.
pub fn operator(state: &State, word: &str, range: Range<usize>, class: OperandClass) -> Option<Diagnostic> {
    let insn = match word.to_ascii_uppercase().as_str() {
        "AND" | "UND" => StlInsn::And,
        "OR" | "ODER" => StlInsn::Or,
        "XOR" | "EXOR" => StlInsn::Xor,
        _ => return None,
    };
    if !matches!(class, OperandClass::Bit | OperandClass::BitOrNone) {
        return None;
    }
    let line = state.text[range.end..].find(['\n', ';', '/']).map_or(state.text.len(), |length| range.end + length);
    let rest = state.text[range.end..line].trim();
    let mnemonic = insn.mnemonic(state.rules);
    Some(
        Diagnostic::new(Code::Syntax, state.span(range), format!("a statement has no `{word}` between operands"))
            .label("a form of other languages")
            .help(format!("write `{mnemonic} {rest}` on a line of its own")),
    )
}

/// `A I 0.0, I 0.1`, `T #a #b`: an instruction of STL has one operand. `insn_end`: the byte after its mnemonic, `start`: the one after the
/// comma, or of the second operand.
pub fn surplus_operand(state: &State, insn: StlInsn, insn_end: usize, start: usize) -> Diagnostic {
    let mnemonic = insn.mnemonic(state.rules);
    let line = state.text[start..].find(['\n', ';', '/']).map_or(state.text.len(), |length| start + length);
    let rest = state.text[start..line].trim_end();
    if let Some(told) = offset_of_memory(state, start, rest) {
        return told;
    }
    let operand = state.text.get(insn_end..start).unwrap_or_default().trim().trim_end_matches(',').trim_end();
    let written: Vec<&str> = rest.split(',').map(str::trim).filter(|operand| !operand.is_empty()).collect();
    let lines: Vec<String> = written.iter().map(|operand| format!("`{mnemonic} {operand}`")).collect();
    // A time or a count, which an instruction of bits takes from ACCU1.
    let constant = |text: &str| {
        text.contains('#') && !text.starts_with('#') || text.starts_with(|c: char| c.is_ascii_digit() || c == '-')
    };
    // `5s`
    let unit = |text: &str| text.trim_start_matches(|c: char| c.is_ascii_digit()).to_ascii_uppercase();
    let is_time = |text: &str| matches!(unit(text).as_str(), "S" | "MS" | "M" | "H");
    let help = match lines.as_slice() {
        [] => "remove the comma".to_owned(),
        [_] if is_statement(written[0], state.rules) => format!("write `{}` on a line of its own", written[0]),
        [_] if let Some(help) = form_help::of_second_operand(state.rules, insn, operand, written[0]) => help,
        [_] if constant(written[0]) && is_time(written[0]) => {
            format!("write `L S5T#{}` on the line before", written[0])
        }
        [_] if constant(written[0]) => format!("write `L {}` on the line before", written[0]),
        [one] => format!("write {one} on a line of its own"),
        several => format!("write {} in lines of their own", several.join(", ")),
    };
    let first = start + (rest.len() - rest.trim_start().len());
    Diagnostic::new(
        Code::SurplusOperand,
        state.span(first..start + rest.len()),
        format!("`{mnemonic}` has one operand"),
    )
    .label("not read")
    .help(help)
}

/// Whether the text is a mnemonic and its operand; `T 2` may also be a timer, `A 4.0` an output.
fn is_statement(text: &str, set: Mnemonics) -> bool {
    let Some((word, operand)) = text.split_once([' ', '\t']) else { return false };
    let is_number = operand.trim_start().starts_with(|c: char| c.is_ascii_digit());
    !is_number && mnemonics::instruction(&word.to_ascii_uppercase(), set).is_some()
}

/// `L MW [MD 10,P#0.0]`: an offset, `rest`, after an address that is not a register.
fn offset_of_memory(state: &State, start: usize, rest: &str) -> Option<Diagnostic> {
    const LENGTH_MAX: usize = 200;
    let offset = rest.trim().strip_suffix(']').filter(|offset| !offset.contains(['[', ',']))?.trim();
    let mut before = state.text[..start].char_indices().rev().take(LENGTH_MAX);
    let (open, _) = before.find(|(_, character)| *character == '[')?;
    let pointer = state.text[open + 1..start].trim_end_matches(',').trim();
    if pointer.is_empty() || pointer.contains([']', ';', '\n']) {
        return None;
    }
    let first = start + (rest.len() - rest.trim_start().len());
    let message = Diagnostic::new(
        Code::SurplusOperand,
        state.span(first..first + offset.len()),
        "only an address register has an offset",
    );
    let help = format!("write `[{pointer}]`, or `LAR1 {pointer}` on the line before, and `[AR1,{offset}]`");
    Some(message.label("an offset").help(help))
}
