//! What to write for a statement that cannot be read, where its text has only one meaning: `I 0-0`, `MW[AR1+2]`, `CALL FB 1.DB 1`.

use plcc_literal::duration;

use crate::ast::{BlockPrefix, Width};
use crate::literal::{self, Literal};
use crate::stl::messages::State;
use crate::stl::token::{Spanned, Tok};
use crate::stl::{Mnemonics, OperandClass, StlInsn, forms};

const REGISTERS: [&str; 2] = ["AR1", "AR2"];

/// The help for the token at `index`, which cannot stand there; `first` is the first token of its statement.
pub fn of(state: &State, index: usize, first: &Spanned) -> Option<String> {
    let (at_start, at, at_end) = state.tokens.get(index)?;
    let (_, first, first_end) = first;
    let rest = state.text.get(*first_end..)?;
    let rest = &rest[..rest.find(['\n', ';']).unwrap_or(rest.len())];
    let rest = rest.split("//").next().unwrap_or_default().trim();
    let insn = match first {
        Tok::Call => return of_call(rest),
        Tok::Insn(insn) => *insn,
        _ => return None,
    };
    if let Some(help) = of_brackets(rest) {
        return Some(help);
    }
    let before = state.text.get(*first_end..*at_start)?.trim();
    let after = rest.strip_prefix(before)?.trim_start();
    let tokens = state.tokens.get(..index)?;
    let is_byte = matches!(tokens, [.., (_, Tok::Area(_, Width::Bit), _), (_, Tok::Address(_), _)]);
    if is_byte && let Some(help) = of_bit(before, after) {
        return Some(help);
    }
    if let (
        Tok::Literal(_),
        [.., (block, Tok::Block(BlockPrefix::Db, _), block_end), (_, Tok::Dot, _), (_, Tok::Name(name), _)],
    ) = (at, tokens)
    {
        let letters = match name.to_ascii_uppercase().as_str() {
            "X" | "DX" | "BX" => "DBX",
            "B" | "BYTE" => "DBB",
            "W" | "DW" | "WORD" => "DBW",
            "D" | "DD" | "DWORD" => "DBD",
            _ => return None,
        };
        let (block, number) = (&state.text[*block..*block_end], &state.text[*at_start..*at_end]);
        return Some(format!("write `{block}.{letters} {number}`, where the number counts bytes"));
    }
    if let Some(help) = of_operand(state, insn, tokens, (*at_start, at, *at_end), before) {
        return Some(help);
    }
    // `A [MD 20]`
    if matches!(tokens, [.., (_, Tok::Insn(_), _), (_, Tok::LeftBracket, _)]) {
        let area = if matches!(insn, StlInsn::Load | StlInsn::Transfer) { "MW" } else { "M" };
        let mnemonic = insn.mnemonic(state.rules);
        return Some(format!("the area is missing before the pointer: write e.g. `{mnemonic} {area} {rest}`"));
    }
    let is_cell = matches!(tokens, [.., (_, Tok::Cell(_), _), (_, Tok::Address(_), _)]);
    let set = state.rules;
    match at {
        // `A T 1.Q`
        Tok::Dot if is_cell => {
            let name = after.strip_prefix('.')?.trim();
            let mnemonic = match name.to_ascii_uppercase().as_str() {
                "Q" | "DN" => insn.mnemonic(set),
                "ET" | "CV" | "ACC" => StlInsn::Load.mnemonic(set),
                _ => return None,
            };
            Some(format!("it has no components: write `{mnemonic} {before}`"))
        }
        Tok::Assign => {
            let value = after.strip_prefix(":=")?.trim();
            let (load, store) = match insn {
                StlInsn::Load | StlInsn::Transfer => (StlInsn::Load, StlInsn::Transfer),
                StlInsn::Assign => (StlInsn::And, StlInsn::Assign),
                _ => return None,
            };
            (!value.is_empty())
                .then(|| format!("write `{} {value}`, then `{} {before}`", load.mnemonic(set), store.mnemonic(set)))
        }
        Tok::Literal(_) if insn == StlInsn::Load && forms::is_operand_end(&tokens.last()?.1) => {
            let load = insn.mnemonic(set);
            let (sign, number) = after.split_at_checked(1)?;
            let number = number.trim();
            // `+ 5` adds to the low word alone, so that it would lose the carry.
            let is_double = matches!(tokens, [.., (_, Tok::Area(_, Width::Dword), _), (_, Tok::Address(_), _)]);
            let long = if is_double || number.parse::<i16>().is_err() { "L#" } else { "" };
            match sign {
                "+" | "-" if number.contains('.') => Some(format!("write `{load} {number}`, then `{sign}R`")),
                _ if number.bytes().any(|digit| !digit.is_ascii_digit()) => None,
                "+" => Some(format!("write `+ {long}{number}` on the next line")),
                "-" => Some(format!("write `+ {long}-{number}` on the next line")),
                _ => None,
            }
        }
        _ => None,
    }
}

/// `MW [10]`, `MW #i`, `IX 0.0`, `5 ms`, `M 0.0:`; `before`: what is written between the mnemonic and the token.
fn of_operand(
    state: &State,
    insn: StlInsn,
    tokens: &[Spanned],
    (start, at, end): (usize, &Tok, usize),
    before: &str,
) -> Option<String> {
    let here = state.text.get(start..end)?;
    let mnemonic = insn.mnemonic(state.rules);
    let is_number = !here.is_empty() && here.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    match (tokens, at) {
        ([.., (_, Tok::Insn(_), _), (area, Tok::Area(_, width), area_end), (_, Tok::LeftBracket, _)], _)
            if is_number =>
        {
            let area = &state.text[*area..*area_end];
            match (width, here.split_once('.')) {
                (Width::Bit, None) => Some(format!("write `{mnemonic} {area} {here}.0`, with the number of the bit")),
                (Width::Bit, Some(_)) | (_, None) => Some(format!("write `{mnemonic} {area} {here}`")),
                (_, Some((byte, "0"))) => Some(format!("write `{mnemonic} {area} {byte}`")),
                (_, Some(_)) => None,
            }
        }
        ([.., (_, Tok::Insn(_), _), (area, Tok::Area(..), area_end)], Tok::Local(_) | Tok::Name(_)) => {
            let (area, name) = (&state.text[*area..*area_end], here.trim_start_matches('#'));
            Some(format!("write `{mnemonic} {area} [#{name}]`: the variable is a DWORD with a pointer such as P#10.0"))
        }
        ([.., (_, Tok::Insn(_), _), (_, Tok::Name(word), _)], _)
            if is_number && here.contains('.') && !matches!(insn, StlInsn::Load | StlInsn::Transfer) =>
        {
            let letter = word
                .strip_suffix(['X', 'x'])
                .filter(|letter| ["I", "Q", "M", "E", "A"].iter().any(|known| known.eq_ignore_ascii_case(letter)))?;
            Some(format!("write `{mnemonic} {letter} {here}`"))
        }
        ([.., (_, Tok::Insn(StlInsn::Load), _), (number, Tok::Literal(_), number_end)], Tok::Name(unit)) => {
            let unit = unit.to_ascii_uppercase();
            let number = &state.text[*number..*number_end];
            let is_time = matches!(unit.as_str(), "MS" | "S" | "M" | "H") && number.parse::<u32>().is_ok();
            let value = format!("{number}{unit}");
            let constant = |prefix: &str| literal::parse(&format!("{prefix}#{value}"));
            if !is_time || constant("T").is_err() {
                return None;
            }
            let time = format!("`{mnemonic} T#{value}` for a TIME");
            // An S5TIME counts up to 999 units of 10 ms or more.
            Some(match constant("S5T") {
                Ok(Literal::S5Time(word)) if duration::s5time_cut(&value, word).is_none() => {
                    format!("write `{mnemonic} S5T#{value}` for a timer of the CPU, {time}")
                }
                _ => format!("write {time}"),
            })
        }
        // The number of the bit is missing.
        ([.., (_, Tok::Area(_, Width::Bit), _), (_, Tok::Address(_), _)], Tok::Colon) => None,
        ([.., (_, last, _)], Tok::Colon) if forms::is_operand_end(last) => {
            Some(format!("a statement ends with `;`: write `{mnemonic} {before};`"))
        }
        _ => None,
    }
}

/// The help for a second operand, `second`, of an instruction.
pub fn of_second_operand(set: Mnemonics, insn: StlInsn, operand: &str, second: &str) -> Option<String> {
    let mnemonic = insn.mnemonic(set);
    // Letters, then a number.
    let is_one_of = |text: &str, known: &[&str]| {
        let number = text.trim_start_matches(|c: char| c.is_ascii_alphabetic());
        let letters = &text[..text.len() - number.len()];
        let is_number = |number: &str| number.bytes().all(|digit| digit.is_ascii_digit() || digit == b'.');
        known.iter().any(|known| known.eq_ignore_ascii_case(letters)) && is_number(number.trim())
    };
    let calls = matches!(insn, StlInsn::CallUnconditional | StlInsn::CallConditional);
    let is_data = is_one_of(second, &["DB"]) || second.starts_with(['"', '#']);
    if calls && is_data && is_one_of(operand, &["FC", "SFC"]) {
        return Some(format!("remove it: `{operand}` has no data block"));
    }
    if calls && is_data {
        let condition = if insn == StlInsn::CallConditional { ", and jump past it for the condition" } else { "" };
        return Some(format!("only `CALL` has a data block: write `CALL {operand}, {second}`{condition}"));
    }
    let is_block = is_one_of(operand, &["DB", "DI"]) && !operand.contains('.');
    if is_block && is_one_of(second, &["DBX", "DBB", "DBW", "DBD"]) {
        return Some(format!("write `{mnemonic} {operand}.{second}`"));
    }
    let is_bit = operand.contains('.') && !operand.starts_with(['"', '#']);
    let is_count = second.bytes().all(|digit| digit.is_ascii_digit());
    match insn {
        StlInsn::Set | StlInsn::Reset if is_count && is_bit => {
            Some(format!("remove it: `{mnemonic} {operand}` writes one bit"))
        }
        StlInsn::Reset if is_count => Some(format!("remove it: `{mnemonic}` has no number")),
        StlInsn::Set if is_count => {
            let load = StlInsn::Load.mnemonic(set);
            let counter = format!("write `{load} C#{second}` on the line before");
            Some(match is_one_of(operand, &["C", "Z"]) {
                true => counter,
                false => format!("remove it for a bit; for a counter {counter}"),
            })
        }
        // `SLW MW 0, 3`, as in other languages.
        _ if matches!(insn.operand(), OperandClass::ShiftCount16 | OperandClass::ShiftCount32)
            && is_count
            && operand.starts_with(|c: char| c.is_alphabetic() || matches!(c, '"' | '#')) =>
        {
            let (load, transfer) = (StlInsn::Load.mnemonic(set), StlInsn::Transfer.mnemonic(set));
            Some(format!("write `{load} {operand}`, `{mnemonic} {second}` and `{transfer} {operand}`"))
        }
        StlInsn::CountUp | StlInsn::CountDown if is_count || second.to_ascii_uppercase().starts_with("C#") => Some(
            format!("remove it: `{mnemonic}` counts by 1; `{}` sets a counter to a value", StlInsn::Set.mnemonic(set)),
        ),
        _ => None,
    }
}

/// `FB 1.DB 1`, `FB1:DB1`, `FB1 WITH DB1` after CALL.
fn of_call(rest: &str) -> Option<String> {
    let target = rest.split('(').next()?.trim();
    let upper = target.to_ascii_uppercase();
    let (block_end, instance_start) = match (upper.find(['.', ':']), upper.find(" WITH ")) {
        (Some(sign), _) => (sign, sign + 1),
        (None, Some(word)) => (word, word + " WITH ".len()),
        (None, None) => return None,
    };
    let (block, instance) = (target[..block_end].trim(), target[instance_start..].trim());
    let digits = instance.get(..2).filter(|letters| letters.eq_ignore_ascii_case("DB")).map(|_| instance[2..].trim());
    let is_block =
        digits.is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit()));
    (is_block && !block.is_empty()).then(|| format!("write `CALL {block}, {instance}`"))
}

/// `MW[AR1+2]`, `MW[P#2.0,AR1]`, `DBW[MD 10`, `MW[MD 10]]`.
fn of_brackets(rest: &str) -> Option<String> {
    let (letters, inner) = rest.split_once('[')?;
    let (inner, after) = inner.split_once(']').map_or((inner, None), |(inner, after)| (inner, Some(after)));
    let letters = letters.trim_end();
    if !names_register(inner) {
        return match after {
            None => Some(format!("write `{letters}[{}]`", inner.trim())),
            Some(after) if after.trim() == "]" => Some("remove the second `]`".to_owned()),
            Some(_) => None,
        };
    }
    let meant = format!("{letters}{}", register_and_offset(inner)?);
    // `Q [AR1,P#0.1]` in a file with German mnemonics: not the brackets are wrong.
    let bare = |text: &str| text.split_whitespace().collect::<String>().to_ascii_uppercase();
    (bare(&meant) != bare(rest)).then(|| format!("write `{meant}`"))
}

fn names_register(inner: &str) -> bool {
    let upper = inner.to_ascii_uppercase();
    REGISTERS.iter().any(|register| upper.contains(register))
}

/// `[AR1,P#2.0]` for `AR1+2` and `P#2.0,AR1`.
pub fn register_and_offset(inner: &str) -> Option<String> {
    let upper = inner.to_ascii_uppercase();
    let register = REGISTERS.into_iter().find(|register| upper.contains(register))?;
    let offset = upper.replacen(register, "", 1);
    let offset = offset.trim_matches(|c: char| matches!(c, ',' | '+' | '.' | ' ' | '\t'));
    let offset = offset.strip_prefix("P#").unwrap_or(offset);
    let (byte, bit) = offset.split_once('.').unwrap_or((offset, "0"));
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit());
    (digits(byte) && digits(bit)).then(|| format!("[{register},P#{byte}.{bit}]"))
}

/// `I 0-0`, `I 0:0`, `I 0 0`, `I 0.`: `byte` is what is before the sign.
fn of_bit(byte: &str, after: &str) -> Option<String> {
    let bit = after.trim_start_matches(['-', ':', '.']).trim();
    match bit.as_bytes() {
        [] if after.starts_with('.') => Some(format!("write `{byte}.0`, with the number of the bit")),
        [b'0'..=b'7'] => Some(format!("write `{byte}.{bit}`")),
        _ => None,
    }
}
