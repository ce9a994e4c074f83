//! Values of the types of PLC languages as a user writes and sees them: `T#1s500ms`, `'abc'`, `D#2026-01-31`, `-5`.
//!
//! - [`read`]: from what a user writes to a value.
//! - [`characters`]: characters and texts.
//! - [`meant`]: what a message about a wrong value proposes.

mod characters;
mod meant;
mod read;

pub use read::parse;

use plcc_abi::image::{AssertKind, AssertType};
use plcc_literal::distance::nearest;

use crate::address::Width;
use crate::assertion::{Value, compare, signed};
use crate::datetime;

/// A type, with the characters that a text holds at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValueType {
    pub ty: AssertType,
    pub length: u16,
}

/// Characters of a STRING whose declaration is unknown.
const TEXT_MAX: u16 = 254;
/// Characters of a WSTRING whose declaration is unknown.
const WIDE_TEXT_MAX: u16 = 16_382;

/// Words of the types; the first of a type is its name.
const WORDS: [(&str, AssertType); 35] = [
    ("BOOL", AssertType::Bool),
    ("BYTE", AssertType::Bits(8)),
    ("WORD", AssertType::Bits(16)),
    ("DWORD", AssertType::Bits(32)),
    ("LWORD", AssertType::Bits(64)),
    ("CHAR", AssertType::Char),
    ("WCHAR", AssertType::Wchar),
    ("SINT", AssertType::Signed(8)),
    ("INT", AssertType::Signed(16)),
    ("DINT", AssertType::Signed(32)),
    ("LINT", AssertType::Signed(64)),
    ("USINT", AssertType::Unsigned(8)),
    ("UINT", AssertType::Unsigned(16)),
    ("UDINT", AssertType::Unsigned(32)),
    ("ULINT", AssertType::Unsigned(64)),
    ("REAL", AssertType::Real),
    ("LREAL", AssertType::Lreal),
    ("S5TIME", AssertType::S5Time),
    ("TIME", AssertType::Time),
    ("LTIME", AssertType::Ltime),
    ("DATE", AssertType::Date),
    ("TIME_OF_DAY", AssertType::TimeOfDay),
    ("TOD", AssertType::TimeOfDay),
    ("LTOD", AssertType::Ltod),
    ("LTIME_OF_DAY", AssertType::Ltod),
    ("LDT", AssertType::Ldt),
    ("DATE_AND_LTIME", AssertType::Ldt),
    ("DATE_AND_TIME", AssertType::DateAndTime),
    ("DT", AssertType::DateAndTime),
    ("DTL", AssertType::Dtl),
    ("STRING", AssertType::Text),
    ("WSTRING", AssertType::WideText),
    ("S5T", AssertType::S5Time),
    ("T", AssertType::Time),
    ("D", AssertType::Date),
];

impl ValueType {
    /// A type with the largest length of its texts.
    pub const fn of(ty: AssertType) -> ValueType {
        let length = match ty {
            AssertType::Text => TEXT_MAX,
            AssertType::WideText => WIDE_TEXT_MAX,
            _ => 0,
        };
        ValueType { ty, length }
    }

    /// Bytes that it has in memory; a BOOL is in one.
    pub fn bytes(self) -> u32 {
        match (bits(self.ty), self.ty) {
            (Some(bits), _) => bits.div_ceil(8),
            // The head has the largest length and the one of the value.
            (None, AssertType::WideText) => 2 * (u32::from(self.length) + 2),
            (None, AssertType::Text) => u32::from(self.length) + 2,
            (None, _) => 12,
        }
    }

    /// The width of its address: of a text or a DTL that of a byte, where it begins.
    pub fn width(self, bit: u8) -> Width {
        match bits(self.ty) {
            Some(1) => Width::Bit(bit),
            Some(16) => Width::Word,
            Some(32) => Width::Dword,
            Some(64) => Width::Lword,
            Some(_) | None => Width::Byte,
        }
    }
}

/// The type after `as`; `Err`: the error.
pub fn from_word(word: &str) -> Result<AssertType, String> {
    // The last rows are prefixes of literals.
    let types = &WORDS[..WORDS.len() - 3];
    let found = types.iter().find(|(name, _)| name.eq_ignore_ascii_case(word.trim()));
    found.map(|(_, ty)| *ty).ok_or_else(|| {
        let words = || types.iter().map(|(word, _)| *word);
        let word = word.trim();
        match nearest(word, words()) {
            Some(meant) => format!("`{word}` is not a type; did you mean `{meant}`?"),
            None => format!("`{word}` is not a type; the types are {}", words().collect::<Vec<_>>().join(", ")),
        }
    })
}

/// Its name in PLC languages.
pub fn name(ty: AssertType) -> &'static str {
    WORDS.iter().find(|(_, own)| *own == ty).map_or("bits", |(name, _)| name)
}

/// Bits of a value; `None`: it has an address instead, as a text does.
pub fn bits(ty: AssertType) -> Option<u32> {
    match ty {
        AssertType::Bool => Some(1),
        AssertType::Bits(width) | AssertType::Signed(width) | AssertType::Unsigned(width) => Some(width.into()),
        AssertType::Char => Some(8),
        AssertType::Wchar | AssertType::S5Time | AssertType::Date => Some(16),
        AssertType::Real | AssertType::Time | AssertType::TimeOfDay => Some(32),
        AssertType::Lreal | AssertType::Ltime | AssertType::Ltod | AssertType::Ldt | AssertType::DateAndTime => {
            Some(64)
        }
        AssertType::Dtl | AssertType::Text | AssertType::WideText => None,
    }
}

/// Whether two values of a type are equal.
pub fn equal(ty: AssertType, a: &Value, b: &Value) -> bool {
    let kind = match ty {
        AssertType::Bool | AssertType::Bits(_) => AssertKind::Bits,
        AssertType::Signed(_) | AssertType::Unsigned(_) => AssertKind::Whole,
        AssertType::Real | AssertType::Lreal => AssertKind::Float,
        AssertType::S5Time | AssertType::Time | AssertType::Ltime => AssertKind::Duration,
        AssertType::TimeOfDay | AssertType::Ltod => AssertKind::TimeOfDay,
        AssertType::Date | AssertType::Ldt | AssertType::DateAndTime | AssertType::Dtl => AssertKind::Moment,
        AssertType::Char | AssertType::Wchar | AssertType::Text | AssertType::WideText => AssertKind::Text,
    };
    compare(kind, (a, ty), (b, ty)) == Some(std::cmp::Ordering::Equal)
}

pub const fn is_duration(ty: AssertType) -> bool {
    matches!(ty, AssertType::S5Time | AssertType::Time | AssertType::Ltime)
}

/// `T#100ms`, for a number of seconds.
pub fn duration_text(seconds: f64) -> String {
    let ns = (seconds * datetime::NS_PER_S as f64).round() as i64;
    match ns % 1_000_000 {
        0 => Value::Bits(((ns / 1_000_000) as u64) & u64::from(u32::MAX)).typed_text(AssertType::Time),
        _ => Value::Bits(ns as u64).typed_text(AssertType::Ltime),
    }
}

/// A whole number that a value is.
pub fn whole(ty: AssertType, bits: u64) -> Option<i128> {
    match ty {
        AssertType::Signed(width) => Some(signed(bits, width)),
        AssertType::Unsigned(_) => Some(bits.into()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_have_names() {
        assert_eq!(from_word("tod"), Ok(AssertType::TimeOfDay));
        assert_eq!(name(AssertType::TimeOfDay), "TIME_OF_DAY");
        assert!(from_word("T").is_err());
        assert_eq!(from_word("REEL"), Err("`REEL` is not a type; did you mean `REAL`?".to_string()));
    }
}
