//! Constants as values, the same for every language.
//!
//! [`parse`] reads a constant as STEP 7 writes it; the text comes from a lexer, without sign unless the constant has one inside.
//! Source: spec sections B.1 to B.4.

mod number;
mod pointer;
mod text;
mod time;

use plcc_diag::Code;

pub use pointer::ANY_TYPES;
pub use text::{parse_text, windows_1252};

/// A constant with its type. Values are already range-checked.
#[derive(Clone, Debug, PartialEq)]
pub enum Literal {
    Bool(bool),
    /// `930`, `-5`: a decimal integer without a type; its width comes from the place.
    Int(i64),
    /// `L#930`.
    Dint(i32),
    /// `B#16#1E`.
    Byte(u8),
    /// `W#16#3A2F`.
    Word(u16),
    /// `DW#16#2C1E_A2EB`.
    Dword(u32),
    /// `16#1E`, `2#1010`: bits without a type; `digits` is the number of bits written (4 for each hex digit).
    Bits {
        value: u32,
        digits: u8,
    },
    /// `B#(1,8)`.
    Bytes2([u8; 2]),
    /// `B#(1,14,100,120)`.
    Bytes4([u8; 4]),
    Real(f32),
    /// `S5T#2s`: time base and BCD value.
    S5Time(u16),
    /// `T#1s`: milliseconds.
    Time(i32),
    /// `D#2000-6-20`: days since 1990-01-01.
    Date(u16),
    /// `TOD#5:45:00`: milliseconds since midnight.
    TimeOfDay(u32),
    /// `DT#...`: eight BCD bytes.
    DateAndTime([u8; 8]),
    /// `C#20`: BCD value.
    Counter(u16),
    /// `'ABCD'`: bytes of the text with escapes expanded, in Windows-1252.
    Text(Vec<u8>),
    /// `P#10.3`: area-internal pointer, as the 32 bits that `L` gives.
    Pointer(u32),
    /// `P#M 10.0`, `P#DBX 0.0`, `P#DB10.DBX 20.0`: area-crossing pointer as 32 bits; `db` 0 if no DB is named.
    AreaPointer {
        db: u16,
        pointer: u32,
    },
    /// `P#DB11.DBX 20.0 INT 10`: the ten bytes of an ANY.
    Any([u8; 10]),
}

/// Why a text is no constant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LiteralError {
    pub code: Code,
    /// What is wrong.
    pub title: String,
    /// What stands at the place.
    pub label: String,
    pub help: Option<String>,
}

impl LiteralError {
    fn malformed(text: &str, label: impl Into<String>, help: impl Into<String>) -> LiteralError {
        LiteralError {
            code: Code::BadLiteral,
            title: format!("`{text}` is not a constant as STEP 7 writes it"),
            label: label.into(),
            help: Some(help.into()),
        }
    }

    fn range(text: &str, label: impl Into<String>, help: impl Into<String>) -> LiteralError {
        LiteralError {
            code: Code::LiteralRange,
            title: format!("`{text}` is outside the range of its type"),
            label: label.into(),
            help: Some(help.into()),
        }
    }
}

/// Reads a constant: a number (`-5`, `1.5e3`), one with `#`, `TRUE`, `FALSE`, or a text in `'`.
///
/// Blanks are skipped where listings have them (`D#1999 - 12 - 8`); whoever minds looks for them in the text.
pub fn parse(text: &str) -> Result<Literal, LiteralError> {
    if text.starts_with('\'') {
        return parse_text(text).map(Literal::Text);
    }
    let Some((prefix, value)) = text.split_once('#') else {
        return if text.eq_ignore_ascii_case("true") {
            Ok(Literal::Bool(true))
        } else if text.eq_ignore_ascii_case("false") {
            Ok(Literal::Bool(false))
        } else {
            number::plain(text)
        };
    };
    match prefix.to_ascii_uppercase().as_str() {
        "B" | "BYTE" => number::byte(text, value),
        "W" | "WORD" => number::word(text, value),
        "DW" | "DWORD" => number::dword(text, value),
        "L" | "DINT" => number::dint(text, value),
        "INT" => number::int(text, value),
        "REAL" => number::typed_real(text, value),
        "BOOL" => number::typed_bool(text, value),
        "C" | "Z" => number::counter(text, value),
        "S5T" | "S5TIME" => time::s5time(text, value),
        "T" | "TIME" => time::duration(text, value),
        "D" | "DATE" => time::date(text, value),
        "TOD" | "TIME_OF_DAY" => time::time_of_day(text, value),
        "DT" | "DATE_AND_TIME" => time::date_and_time(text, value),
        "P" => pointer::pointer(text, value),
        "CHAR" | "STRING" => parse_text(value).map(Literal::Text),
        base => number::based(text, base, value),
    }
}

/// The bits that `P#byte.bit` has without an area.
pub const fn pointer_bits(byte: u32, bit: u8) -> u32 {
    byte << 3 | bit as u32
}
