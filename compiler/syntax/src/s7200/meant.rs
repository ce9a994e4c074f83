//! The statements that are meant by the signs of other languages: `LDW VW0 >= 5`, `+ I VW0, VW2`, `VW2 := VW0 + 5`, `MOV VW0, VW2`.

use super::address;
use super::ast::Area;
use crate::ast::Width;

/// What the line of a statement means whose first word is not a mnemonic, as code in a sentence.
pub fn statement(line: &str) -> Option<String> {
    let end = line.find(|c: char| !c.is_ascii_alphanumeric() && c != '.').unwrap_or(line.len());
    let (word, rest) = line.split_at(end);
    if word.is_empty() {
        return parted_mnemonic(line).map(|written| format!("`{written}`"));
    }
    let compared = || comparison(&word.to_ascii_uppercase(), rest).map(|written| format!("`{written}`"));
    assignment(word, rest).or_else(compared).or_else(|| sized(&word.to_ascii_uppercase(), rest.trim()))
}

/// `LDW>= VW0, 5` for the mnemonic `LDW` (upper case) before `VW0 >= 5` or `!= VW0, 5`, and for `LD` before `VW0 >= 5`, whose
/// address tells the width.
pub fn comparison(mnemonic: &str, operands: &str) -> Option<String> {
    const SIGNS: [char; 4] = ['=', '<', '>', '!'];
    let (left, rest) = operands.split_at(operands.find(SIGNS)?);
    let (sign, right) = rest.split_at(rest.find(|c| !SIGNS.contains(&c))?);
    let sign = match sign {
        "=" | "==" => "=",
        "<>" | "><" | "!=" => "<>",
        ">=" | "=>" => ">=",
        "<=" | "=<" => "<=",
        ">" | "<" => sign,
        _ => return None,
    };
    let (left, right) = if left.trim().is_empty() { right.split_once(',')? } else { (left, right) };
    let (left, right) = (left.trim(), right.trim());
    if !is_operand(left) || !is_operand(right) {
        return None;
    }
    let is_load = |word: &str| matches!(word, "LD" | "A" | "U" | "O");
    let (load, letter) = match mnemonic.strip_suffix(['B', 'W', 'D', 'R']) {
        Some(load) if is_load(load) => (load, mnemonic.chars().last()?),
        _ if is_load(mnemonic) => (mnemonic, letter_of(left, right)?),
        _ => return None,
    };
    Some(format!("{load}{letter}{sign} {left}, {right}"))
}

/// `MOVW VW0, VW2` and `+I 5, VW2` for the address `VW2` before `:= VW0 + 5`.
fn assignment(target: &str, rest: &str) -> Option<String> {
    let value = rest.trim_start();
    let value = value.strip_prefix(":=").or_else(|| value.strip_prefix('='))?.trim();
    let place = address::parse(&target.to_ascii_uppercase())?.ok()?;
    let (left, operation) = match value.char_indices().skip(1).find(|(_, c)| matches!(*c, '+' | '-' | '*' | '/')) {
        Some((at, sign)) => (value[..at].trim_end(), Some((sign, value[at + 1..].trim_start()))),
        None => (value, None),
    };
    if !is_operand(left) || operation.is_some_and(|(_, right)| !is_operand(right)) {
        return None;
    }
    if place.width == Some(Width::Bit) {
        let is_bit = address::parse(&left.to_ascii_uppercase())?.ok()?.width == Some(Width::Bit);
        return (is_bit && operation.is_none()).then(|| format!("`LD {left}` and `= {target}`"));
    }
    let letter = letter_of(target, operation.map_or(left, |(_, right)| right))?;
    let letter = if letter == 'D' && is_real(left) { 'R' } else { letter };
    let fits = |operand: &str| match letter_of(operand, "") {
        Some(own) => own == letter || (own, letter) == ('D', 'R'),
        None if is_real(operand) => letter == 'R',
        None => operand.parse::<i64>().is_ok(),
    };
    let same = |operand: &str| operand.eq_ignore_ascii_case(target);
    if !fits(left) || operation.is_some_and(|(_, right)| !fits(right) || same(right)) {
        return None;
    }
    let moved = format!("`MOV{letter} {left}, {target}`");
    let Some((sign, right)) = operation else { return Some(moved) };
    let kind = match letter {
        'W' => 'I',
        'D' | 'R' => letter,
        _ => return None,
    };
    let calculated = format!("`{sign}{kind} {right}, {target}`");
    Some(if same(left) { calculated } else { format!("{moved}, then {calculated}") })
}

/// `+I VW0, VW2` for `+ I VW0, VW2`.
fn parted_mnemonic(line: &str) -> Option<String> {
    let rest = line.strip_prefix(['+', '-', '*', '/'])?;
    let mut words = rest.trim_start().splitn(2, char::is_whitespace);
    let letter = words.next()?.to_ascii_uppercase();
    let operands = words.next()?.trim();
    matches!(letter.as_str(), "I" | "D" | "R").then(|| format!("{}{letter} {operands}", &line[..1]))
}

/// `MOVW VW0, VW2` for `MOV VW0, VW2`, whose addresses tell the width. `word`: in upper case.
fn sized(word: &str, operands: &str) -> Option<String> {
    let (left, right) = match operands.split_once(',') {
        Some((left, right)) => (left.trim(), Some(right.trim())),
        None => (operands, None),
    };
    if !is_operand(left) || right.is_some_and(|right| !is_operand(right)) {
        return None;
    }
    let is_constant = |text: &str| text.starts_with(|c: char| c.is_ascii_digit() || c == '-');
    let fits = |letter: char| left.parse::<i64>().is_ok() || is_real(left) && letter == 'R';
    let letter = match (letter_of(left, ""), right.and_then(|right| letter_of(right, left))) {
        (Some(own), Some(other)) if own != other => return None,
        (Some(own), _) => own,
        (None, Some(other)) if fits(other) => other,
        (None, _) => return None,
    };
    // Shifts write to their first operand, the others to the second one.
    let (shifts, writes) = (!is_constant(left), right.is_some_and(|right| !is_constant(right)));
    let mnemonic = match (word, letter, right) {
        ("MOV" | "MOVE", _, Some(_)) if writes => format!("MOV{letter}"),
        ("INC" | "DEC", 'B' | 'W' | 'D', None) => format!("{word}{letter}"),
        ("ADD", 'W', Some(_)) if writes => "+I".to_owned(),
        ("SUB", 'W', Some(_)) if writes => "-I".to_owned(),
        ("SHL", 'B' | 'W' | 'D', Some(_)) if shifts => format!("SL{letter}"),
        ("SHR", 'B' | 'W' | 'D', Some(_)) if shifts => format!("SR{letter}"),
        ("ROL", 'B' | 'W' | 'D', Some(_)) if shifts => format!("RL{letter}"),
        ("ROR", 'B' | 'W' | 'D', Some(_)) if shifts => format!("RR{letter}"),
        _ => return None,
    };
    Some(format!("`{mnemonic} {operands}`"))
}

/// Whether the text is one operand.
fn is_operand(text: &str) -> bool {
    let text = text.strip_prefix('-').unwrap_or(text);
    !text.is_empty() && !text.contains(|c: char| c.is_whitespace() || ",:=<>!+*/()".contains(c))
}

fn is_real(text: &str) -> bool {
    text.contains('.') && text.parse::<f64>().is_ok()
}

/// The letter of the width of the address `place`, in mnemonics; `other`: a value that is combined with it.
fn letter_of(place: &str, other: &str) -> Option<char> {
    let place = address::parse(&place.to_ascii_uppercase())?.ok()?;
    match place.width {
        Some(Width::Byte) => Some('B'),
        Some(Width::Word) => Some('W'),
        Some(Width::Dword) => Some(if is_real(other) { 'R' } else { 'D' }),
        Some(Width::Bit | Width::Lword) => None,
        None => matches!(place.area, Area::T | Area::C).then_some('W'),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comparisons() {
        let written = |line| statement(line).unwrap_or_default();
        assert_eq!(written("LDW VW0 >= 5"), "`LDW>= VW0, 5`");
        assert_eq!(written("LDW== VW0, 5"), "`LDW= VW0, 5`");
        assert_eq!(written("AW != VW0, VW2"), "`AW<> VW0, VW2`");
        assert_eq!(comparison("LD", "VD0 > 1.5").as_deref(), Some("LDR> VD0, 1.5"));
        assert_eq!(comparison("A", "T37 => 50").as_deref(), Some("AW>= T37, 50"));
        assert_eq!(comparison("LD", "I0.0 = Q0.0"), None);
        assert_eq!(comparison("LD", "VW0 >"), None);
        assert_eq!(written("IF VW0 > 5 THEN"), "");
    }

    #[test]
    fn widths() {
        let written = |line| statement(line).unwrap_or_default();
        assert_eq!(written("MOV VW0, VW2"), "`MOVW VW0, VW2`");
        assert_eq!(written("MOVE 1.5, VD0"), "`MOVR 1.5, VD0`");
        assert_eq!(written("MOV 5, VB0"), "`MOVB 5, VB0`");
        assert_eq!(written("INC VW0"), "`INCW VW0`");
        assert_eq!(written("ADD VW0, VW2"), "`+I VW0, VW2`");
        assert_eq!(written("SHL VB0, 2"), "`SLB VB0, 2`");
        assert_eq!(written("MOV VW0, VB2"), "");
        assert_eq!(written("MOV 1.5, VW0"), "", "not a whole number");
        assert_eq!(written("MOV VW0, 5"), "", "nothing is written to a constant");
        assert_eq!(written("SHL 2, VB0"), "");
        assert_eq!(written("ADD VD0, VD4"), "", "of DINT or REAL");
    }

    #[test]
    fn assignments() {
        let written = |line| statement(line).unwrap_or_default();
        assert_eq!(written("VW2 := VW0 + 5"), "`MOVW VW0, VW2`, then `+I 5, VW2`");
        assert_eq!(written("VW2 := VW2 - VW4"), "`-I VW4, VW2`");
        assert_eq!(written("VD4 = 1.5 * VD8"), "`MOVR 1.5, VD4`, then `*R VD8, VD4`");
        assert_eq!(written("VB4 := 3"), "`MOVB 3, VB4`");
        assert_eq!(written("Q0.4 := I0.0"), "`LD I0.0` and `= Q0.4`");
        assert_eq!(written("VW2 := 5 - VW2"), "");
        assert_eq!(written("VW2 := VD0"), "");
        assert_eq!(written("VW2 :="), "");
        assert_eq!(written("+ I VW0, VW2"), "`+I VW0, VW2`");
    }
}
