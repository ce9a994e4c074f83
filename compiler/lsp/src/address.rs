//! Absolute addresses and the bits that they cover, for references that overlap.

use crate::words::Words;

/// Bits of an area, or a timer or counter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// `I`, `Q`, `M`, `PI`, `PQ`, `T`, `C`, `V`, `DB3` …
    pub area: String,
    pub bit: u64,
    pub bits: u64,
    /// Number of pieces that it consists of.
    pub pieces: usize,
}

impl Address {
    pub fn overlaps(&self, other: &Address) -> bool {
        self.area == other.area && self.bit < other.bit + other.bits && other.bit < self.bit + self.bits
    }
}

/// Letters of areas in both sets, and what they are. The letter of the width follows.
const AREAS: [(&str, &str); 14] = [
    ("PE", "PI"),
    ("PA", "PQ"),
    ("PI", "PI"),
    ("PQ", "PQ"),
    ("SM", "SM"),
    ("DB", "DB"),
    ("E", "I"),
    ("A", "Q"),
    ("I", "I"),
    ("Q", "Q"),
    ("M", "M"),
    ("V", "V"),
    ("L", "L"),
    ("S", "S"),
];

/// The address that begins with a piece: `M`, `10.0`; `MW10`; `DB1`, `.`, `DBW`, `4`.
pub fn at(words: &Words, at: usize) -> Option<Address> {
    let word = words.word(at);
    if at > 0 && (matches!(words.word(at - 1), "." | "#") && words.glued(at) || word.starts_with(['#', '"'])) {
        return None;
    }
    let text = joined(words, at, 1);
    if let Some(found) = plain(&text) {
        return Some(Address { pieces: 1, ..found });
    }
    // `DB1.DBW4` is several pieces in STL.
    for count in (2..=5).rev() {
        let text = joined(words, at, count);
        let one_line = (at + 1..at + count).all(|piece| !words.first_on_line(piece));
        if one_line && let Some(found) = plain(&text) {
            return Some(Address { pieces: count, ..found });
        }
    }
    None
}

fn joined(words: &Words, at: usize, count: usize) -> String {
    (at..at + count).map(|at| words.word(at)).collect::<String>().to_ascii_uppercase()
}

/// The address that a text without blanks in upper case is.
pub fn plain(text: &str) -> Option<Address> {
    let text = text.strip_prefix('%').unwrap_or(text).trim_end_matches(":P");
    if let Some((db, inner)) = text.strip_prefix("DB").and_then(|rest| rest.split_once('.'))
        && let Ok(db) = db.parse::<u32>()
        && let Some(inner) = inner.strip_prefix("DB").or(Some(inner)).filter(|inner| !inner.is_empty())
    {
        return place(&format!("DB{db}"), inner);
    }
    let digits = text.find(|c: char| c.is_ascii_digit())?;
    if let (letter @ ("T" | "C" | "Z"), number) = text.split_at(digits) {
        let area = if letter == "T" { "T" } else { "C" };
        return Some(Address { area: area.to_owned(), bit: number.parse().ok()?, bits: 1, pieces: 1 });
    }
    let (letters, area) = AREAS.iter().find(|(letters, _)| {
        text.strip_prefix(letters).is_some_and(|rest| {
            rest.starts_with(['B', 'W', 'D', 'X']) || rest.starts_with(|c: char| c.is_ascii_digit())
        })
    })?;
    if *letters == "DB" {
        return None;
    }
    place(area, &text[letters.len()..])
}

/// `W10`, `X0.3`, `0.3` of an area.
fn place(area: &str, text: &str) -> Option<Address> {
    let (bits, rest) = match text.as_bytes().first()? {
        b'B' => (8, &text[1..]),
        b'W' => (16, &text[1..]),
        b'D' => (32, &text[1..]),
        b'X' => (1, &text[1..]),
        _ => (1, text),
    };
    let bit = match (bits, rest.split_once('.')) {
        (1, Some((byte, bit))) => {
            byte.parse::<u64>().ok().filter(|byte| *byte < 1 << 32)? * 8
                + bit.parse::<u64>().ok().filter(|bit| *bit < 8)?
        }
        (1, None) | (_, Some(_)) => return None,
        (_, None) => rest.parse::<u64>().ok().filter(|byte| *byte < 1 << 32)? * 8,
    };
    Some(Address { area: area.to_owned(), bit, bits, pieces: 1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_bytes_and_words_overlap() {
        let address = |text| plain(text).unwrap_or_else(|| panic!("{text} is an address"));
        assert!(address("MW10").overlaps(&address("M11.7")));
        assert!(!address("MW10").overlaps(&address("M12.0")));
        assert!(address("EB4").overlaps(&address("%I4.2")));
        assert!(address("DB1.DBD4").overlaps(&address("DB1.DBX7.0")));
        assert!(!address("DB1.DBD4").overlaps(&address("DB2.DBX7.0")));
        assert!(address("T5").overlaps(&address("T5")) && !address("T5").overlaps(&address("C5")));
        for text in ["DB1", "FC1", "MW", "M10", "M1.9", "MW10.1", "X", "", "M99999999999999999999.0"] {
            assert_eq!(plain(text), None, "{text}");
        }
    }
}
