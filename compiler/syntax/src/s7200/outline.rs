//! Whether a source is one of the S7-200. A guess: it does not parse, and does not check correctness.
//!
//! Micro/WIN and STEP 7 give their exports the same extension. Block headers decide; without them, statements that only one of the
//! two families has decide.

use super::ast::Area;
use super::raw::{RawKind, RawToken};
use super::{address, classify, mnemonics, raw};
use crate::stl::{self, Mnemonics};

/// Whether `text` is a source of the S7-200 rather than one of S7-300/400.
pub fn is_s7200(text: &str) -> bool {
    let (mut own, mut foreign) = (0usize, 0usize);
    let mut data = false;
    for line in raw::each_line(text) {
        match of_line(text, &line, &mut data) {
            Sign::S7200 => return true,
            Sign::Other => return false,
            Sign::Own(count) => own += count,
            Sign::Foreign => foreign += 1,
            Sign::None => {}
        }
    }
    own > foreign || own == 0 && foreign == 0 && is_named_data(text, raw::each_line(text))
}

/// Whether `text` holds only lines of a data block.
pub fn is_data(text: &str, lines: &[Vec<RawToken>]) -> bool {
    let mut found = false;
    for line in lines {
        let Some(first) = line.first().filter(|first| first.kind != RawKind::Comment) else { continue };
        let word = first.text(text).to_ascii_uppercase();
        let is_head =
            || mnemonics::head(text, line).is_some_and(|head| mnemonics::any(&head.mnemonic, Mnemonics::En).is_some());
        match first.kind {
            RawKind::Word if is_v(&word) => found = true,
            RawKind::Word if matches!(word.as_str(), "TITLE" | "BEGIN") => {}
            RawKind::Word if is_frame(&word) || is_head() => return false,
            _ => {}
        }
    }
    found || is_named_data(text, lines.iter().cloned())
}

/// Whether `text` has nothing but lines of a data block whose addresses are symbols: `Setpoint 50`. A single line may be anything.
fn is_named_data(text: &str, lines: impl Iterator<Item = Vec<RawToken>>) -> bool {
    let mut named = 0usize;
    for line in lines {
        let code = match line.as_slice() {
            [code @ .., last] if last.kind == RawKind::Comment => code,
            line => line,
        };
        let values = match code {
            [] => continue,
            [first, values @ ..] if first.kind == RawKind::Word => {
                let word = first.text(text).to_ascii_uppercase();
                let is_known = mnemonics::any(&word, Mnemonics::En).is_some();
                if is_known || stl::is_mnemonic(&word) || is_frame(&word) || values.is_empty() {
                    return false;
                }
                named += 1;
                values
            }
            values => values,
        };
        let fits = |token: &RawToken| is_value(token) || matches!(token.kind, RawKind::Comma | RawKind::Semicolon);
        if !values.first().is_some_and(is_value) || !values.iter().all(fits) {
            return false;
        }
    }
    named > 1
}

/// A constant, or the sign of one.
fn is_value(token: &RawToken) -> bool {
    matches!(
        token.kind,
        RawKind::Integer
            | RawKind::Real
            | RawKind::Based
            | RawKind::Plus
            | RawKind::Minus
            | RawKind::Characters
            | RawKind::Quoted
    )
}

/// What a line indicates.
enum Sign {
    S7200,
    Other,
    /// This many features of the S7-200.
    Own(usize),
    /// A feature of S7-300/400.
    Foreign,
    None,
}

fn of_line(text: &str, line: &[RawToken], data: &mut bool) -> Sign {
    let code = match line {
        [code @ .., last] if last.kind == RawKind::Comment => code,
        _ => line,
    };
    let code = raw::block_comment(text, code).map_or(code, |at| &code[..at]);
    let Some(first) = code.first() else { return Sign::None };
    let word = first.text(text).to_ascii_uppercase();
    let next = code.get(1);
    match word.as_str() {
        "SUBROUTINE_BLOCK" | "INTERRUPT_BLOCK" | "END_SUBROUTINE_BLOCK" | "END_INTERRUPT_BLOCK" => return Sign::S7200,
        "ORGANIZATION_BLOCK" => {
            let numbered = code.iter().rev().take(2).any(|token| token.kind == RawKind::Colon)
                && code.last().is_some_and(|last| classify::is_block(&last.text(text).to_ascii_uppercase()));
            // Only S7-300/400 write `OB 1` with a blank and without a name before it.
            let alone = next.is_some_and(|next| next.text(text).eq_ignore_ascii_case("OB"))
                && code.get(2).is_some_and(|number| number.kind == RawKind::Integer);
            return match (numbered, alone) {
                (true, _) => Sign::S7200,
                (false, true) => Sign::Other,
                (false, false) => Sign::None,
            };
        }
        "FUNCTION"
        | "FUNCTION_BLOCK"
        | "TYPE"
        | "STRUCT"
        | "SYSTEM_FUNCTION"
        | "SYSTEM_FUNCTION_BLOCK"
        | "KNOW_HOW_PROTECT"
        | "IF"
        | "REGION" => return Sign::Other,
        "VERSION" | "AUTHOR" | "FAMILY" | "NAME" if next.is_some_and(|next| next.kind == RawKind::Colon) => {
            return Sign::Other;
        }
        "DATA_BLOCK" => {
            *data = true;
            return Sign::None;
        }
        "END_DATA_BLOCK" => {
            *data = false;
            return Sign::None;
        }
        // What follows is a text.
        "TITLE" | "NETWORK" => return Sign::None,
        _ => {}
    }
    // Counted where it opens.
    if word == ")" && code.len() == 1 {
        return Sign::None;
    }
    if code.iter().any(|token| token.kind == RawKind::Assign || matches!(token.text(text), "(" | ")" | "{" | "[")) {
        // A slip in a statement of the S7-200 still has its addresses.
        return if has_only_own(text, code) { Sign::None } else { Sign::Foreign };
    }
    if next.is_some_and(|next| next.kind == RawKind::Colon) {
        // A declaration, or a label, which the S7-200 does not have before statements.
        let head = code.get(2..).and_then(|rest| mnemonics::head(text, rest));
        return if head.is_some_and(|head| stl::is_mnemonic(&head.mnemonic)) { Sign::Foreign } else { Sign::None };
    }
    if is_v(&word) && next.is_some_and(is_value) {
        return Sign::Own(if *data { 2 } else { 1 });
    }
    let Some(head) = mnemonics::head(text, code) else { return Sign::None };
    let own = mnemonics::any(&head.mnemonic, Mnemonics::En).is_some();
    let foreign = stl::is_mnemonic(&head.mnemonic);
    let operands = code.get(head.tokens..).unwrap_or_default();
    match (own, foreign) {
        // Labels of the S7-200 are numbers.
        (true, false)
            if head.mnemonic == "JMP" && operands.first().is_some_and(|label| label.kind == RawKind::Word) =>
        {
            Sign::None
        }
        (true, false) => Sign::Own(1),
        // `INC VW0`: an instruction of one family, an address of the other.
        (false, true) if has_only_own(text, operands) => Sign::None,
        (false, true) => Sign::Foreign,
        (true, true) if has_only_own(text, operands) => Sign::Own(1),
        (true, true) | (false, false) => Sign::None,
    }
}

/// Whether one of the words is an address that S7-300/400 do not have.
fn has_only_own(text: &str, tokens: &[RawToken]) -> bool {
    tokens.iter().any(|token| token.kind == RawKind::Word && is_only_own(&token.text(text).to_ascii_uppercase()))
}

/// An address of the V area, with or without size.
fn is_v(word: &str) -> bool {
    matches!(address::parse(word), Some(Ok(direct)) if direct.area == Area::V)
}

/// An address that S7-300/400 do not have.
fn is_only_own(word: &str) -> bool {
    let Some(Ok(direct)) = address::parse(word) else { return false };
    match direct.area {
        Area::V => !word.starts_with("DB") && direct.width.is_some(),
        Area::Sm | Area::Ai | Area::Aq | Area::Hc | Area::Ac => true,
        // `AB1` and others are outputs in German.
        Area::I | Area::Q | Area::M | Area::L | Area::S | Area::T | Area::C => false,
    }
}

fn is_frame(word: &str) -> bool {
    word.ends_with("_BLOCK")
        || matches!(word, "NETWORK" | "VAR" | "VAR_INPUT" | "VAR_OUTPUT" | "VAR_IN_OUT" | "END_VAR")
}
