//! Direct addresses: `I0.0`, `VW100`, `T37`, `DB1.DBW100`.
//!
//! Area letters of both mnemonic sets are accepted. Source: S7-200 system manual, accessing the data of the S7-200.

use super::ast::{Area, Direct};
use crate::ast::Width;
use crate::stl::Mnemonics;

/// Area letters, and the mnemonic set that they belong to.
const AREAS: &[(&str, Area, Option<Mnemonics>)] = &[
    ("I", Area::I, Some(Mnemonics::En)),
    ("E", Area::I, Some(Mnemonics::De)),
    ("Q", Area::Q, Some(Mnemonics::En)),
    ("A", Area::Q, Some(Mnemonics::De)),
    ("V", Area::V, None),
    ("M", Area::M, None),
    ("SM", Area::Sm, None),
    ("S", Area::S, None),
    ("L", Area::L, None),
];

/// Areas of numbered elements, with the letters that may follow.
const ELEMENTS: &[(&str, Area, Option<Width>)] = &[
    ("T", Area::T, None),
    ("TX", Area::T, None),
    ("TW", Area::T, Some(Width::Word)),
    ("C", Area::C, None),
    ("CX", Area::C, None),
    ("CW", Area::C, Some(Width::Word)),
    ("Z", Area::C, None),
    ("ZX", Area::C, None),
    ("ZW", Area::C, Some(Width::Word)),
    ("HC", Area::Hc, None),
    ("HZ", Area::Hc, None),
    ("AC", Area::Ac, None),
    ("ACB", Area::Ac, Some(Width::Byte)),
    ("ACW", Area::Ac, Some(Width::Word)),
    ("ACD", Area::Ac, Some(Width::Dword)),
    ("AI", Area::Ai, Some(Width::Word)),
    ("AIW", Area::Ai, Some(Width::Word)),
    ("AE", Area::Ai, Some(Width::Word)),
    ("AEW", Area::Ai, Some(Width::Word)),
    ("AQ", Area::Aq, Some(Width::Word)),
    ("AQW", Area::Aq, Some(Width::Word)),
    ("AA", Area::Aq, Some(Width::Word)),
    ("AAW", Area::Aq, Some(Width::Word)),
];

/// Why a word that looks like an address is not one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AddressError {
    /// The bit is not 0 to 7.
    Bit,
    /// The number is too large for every area.
    Number,
    /// `VW10.3`: a byte, word or double word has no bit.
    BitOfWord,
    /// A data block other than DB1.
    DataBlock,
}

/// Reads `word` (upper case). None: it does not have the form of an address. `V40`, without size and bit, is an address with width None.
pub fn parse(word: &str) -> Option<Result<Direct, AddressError>> {
    let (word, db) = match word.split_once('.') {
        Some((db, rest)) if db.starts_with("DB") && rest.starts_with("DB") => {
            let number = db.get(2..)?;
            if number.is_empty() || !digits(number) {
                return None;
            }
            if number.parse() != Ok(1u32) {
                return Some(Err(AddressError::DataBlock));
            }
            (rest, true)
        }
        _ => (word, false),
    };
    let at = word.find(|c: char| c.is_ascii_digit())?;
    let (letters, number) = word.split_at_checked(at)?;
    let (number, bit) = match number.split_once('.') {
        Some((number, bit)) => (number, Some(bit)),
        None => (number, None),
    };
    if !digits(number) || bit.is_some_and(|bit| !digits(bit)) {
        return None;
    }
    let (area, width) = letters_of(letters, bit.is_some())?;
    if db && !letters.starts_with("DB") {
        return None;
    }
    Some(direct(area, width, number, bit))
}

fn direct(area: Area, width: Option<Width>, number: &str, bit: Option<&str>) -> Result<Direct, AddressError> {
    let number: u32 = number.parse().map_err(|_| AddressError::Number)?;
    // No area of any CPU is that large; sums of addresses stay within 32 bits.
    if number > 0xFF_FFFF {
        return Err(AddressError::Number);
    }
    let bit = match (width, bit) {
        (Some(Width::Bit), Some(bit)) => bit.parse().ok().filter(|bit: &u8| *bit < 8).ok_or(AddressError::Bit)?,
        (_, Some(_)) => return Err(AddressError::BitOfWord),
        (_, None) => 0,
    };
    Ok(Direct { area, width, number, bit })
}

/// Area and width of letters; `bit`: a bit number follows.
fn letters_of(letters: &str, bit: bool) -> Option<(Area, Option<Width>)> {
    if let Some((_, area, width)) = ELEMENTS.iter().find(|(known, ..)| *known == letters) {
        return Some((*area, *width));
    }
    if let Some(size) = letters.strip_prefix("DB") {
        return Some((Area::V, Some(size_of(size, bit)?)));
    }
    let exact = |name: &str| AREAS.iter().find(|(known, ..)| *known == name).map(|(_, area, _)| *area);
    if let Some(area) = exact(letters) {
        return match (bit, area) {
            (true, _) => Some((area, Some(Width::Bit))),
            (false, Area::V) => Some((area, None)),
            // `M1` may be a symbol.
            (false, _) => None,
        };
    }
    let (name, size) = letters.split_at_checked(letters.len().checked_sub(1)?)?;
    Some((exact(name)?, Some(size_of(size, bit)?)))
}

fn size_of(letter: &str, bit: bool) -> Option<Width> {
    match letter {
        "X" if bit => Some(Width::Bit),
        "B" => Some(Width::Byte),
        "W" => Some(Width::Word),
        "D" => Some(Width::Dword),
        _ => None,
    }
}

fn digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Whether `word` (upper case) becomes an address with a number after it.
pub fn are_letters(word: &str) -> bool {
    letters_of(word, true).is_some() || letters_of(word, false).is_some()
}

/// The set that the letters of the address `word` (upper case) belong to; none if both have them, or if it is not an address.
pub fn set_of(word: &str) -> Option<Mnemonics> {
    let direct = parse(word)?.ok()?;
    let letters = word.split(|c: char| c.is_ascii_digit()).next()?;
    match direct.area {
        Area::I | Area::Q => AREAS
            .iter()
            .filter(|(name, area, _)| *area == direct.area && letters.starts_with(name))
            .find_map(|(_, _, set)| *set),
        Area::C | Area::Hc => Some(if letters.contains('Z') { Mnemonics::De } else { Mnemonics::En }),
        Area::Ai => Some(if letters.starts_with("AE") { Mnemonics::De } else { Mnemonics::En }),
        Area::Aq => Some(if letters.starts_with("AA") { Mnemonics::De } else { Mnemonics::En }),
        Area::V | Area::M | Area::Sm | Area::S | Area::L | Area::T | Area::Ac => None,
    }
}

/// The same, with the width left to the instruction.
pub fn without_width(direct: Direct) -> Direct {
    Direct { width: None, ..direct }
}

/// As written in the international set: `VW100`, `T37`, `I0.0`.
pub fn text(direct: &Direct) -> String {
    let letters = direct.area.letters();
    match direct.width {
        Some(Width::Bit) => format!("{letters}{}.{}", direct.number, direct.bit),
        Some(Width::Byte) => format!("{letters}B{}", direct.number),
        Some(Width::Word) => format!("{letters}W{}", direct.number),
        Some(Width::Dword) => format!("{letters}D{}", direct.number),
        Some(Width::Lword) | None => format!("{letters}{}", direct.number),
    }
}

/// `I0.0` for `IO.0`: the address with the digit 0 where `text` has the letter O. A timer or counter is not one: `CO2` may be a name.
pub fn with_zeros(text: &str) -> Option<String> {
    let upper = text.to_ascii_uppercase();
    (1..=2).find_map(|letters| {
        let (area, number) = upper.split_at_checked(letters)?;
        let fixed = format!("{area}{}", number.replace('O', "0"));
        let is_address = matches!(parse(&fixed), Some(Ok(direct)) if direct.width.is_some());
        (number.contains('O') && is_address).then_some(fixed)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(word: &str) -> String {
        match parse(word) {
            Some(Ok(direct)) => text(&direct),
            Some(Err(error)) => format!("{error:?}"),
            None => "-".to_owned(),
        }
    }

    #[test]
    fn forms() {
        for (word, expected) in [
            ("I0.0", "I0.0"),
            ("E15.7", "I15.7"),
            ("A1.2", "Q1.2"),
            ("AB1", "QB1"),
            ("AW4", "QW4"),
            ("AD4", "QD4"),
            ("AC1", "AC1"),
            ("ACB0", "ACB0"),
            ("VX100.5", "V100.5"),
            ("V100.5", "V100.5"),
            ("V40", "V40"),
            ("VW100", "VW100"),
            ("SM0.1", "SM0.1"),
            ("SMB34", "SMB34"),
            ("SB1", "SB1"),
            ("SD38", "SD38"),
            ("S0.3", "S0.3"),
            ("L60.0", "L60.0"),
            ("T37", "T37"),
            ("TX37", "T37"),
            ("Z5", "C5"),
            ("HZ1", "HC1"),
            ("AI0", "AIW0"),
            ("AEW4", "AIW4"),
            ("AAW2", "AQW2"),
            ("DB1.DBW100", "VW100"),
            ("DBX5.0", "V5.0"),
            ("DB1.DBX5.1", "V5.1"),
            ("I0.8", "Bit"),
            ("VW10.3", "BitOfWord"),
            ("T37.0", "BitOfWord"),
            ("DB2.DBW0", "DataBlock"),
            ("VW99999999999", "Number"),
            ("M1", "-"),
            ("S0", "-"),
            ("MOTOR1", "-"),
            ("V", "-"),
            ("DB1", "-"),
            ("VX5", "-"),
            ("I0.A", "-"),
        ] {
            assert_eq!(read(word), expected, "{word}");
        }
    }
}
