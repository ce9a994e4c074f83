//! Constants as values, the same for every language.
//!
//! [`parse`] reads a constant as STEP 7 writes it; the text comes from a lexer, without sign unless the constant has one inside.
//! Source: Programming with STEP 7, data types.

pub(crate) mod meant;
mod number;
mod pointer;
mod text;
mod time;

use plcc_diag::{Code, Diagnostic, Span};

pub use pointer::ANY_TYPES;
pub use text::{parse_text, windows_1252};
pub(crate) use time::nanoseconds;

/// A constant with its type. Values are already range-checked.
#[derive(Clone, Debug, PartialEq)]
pub enum Literal {
    Bool(bool),
    /// `930`, `-5`: a decimal integer without a type; its width follows from where it is used.
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
    /// `P#10.3`: area-internal pointer, as the 32 bits that `L` loads.
    Pointer(u32),
    /// `P#M 10.0`, `P#DBX 0.0`, `P#DB10.DBX 20.0`: area-crossing pointer as 32 bits; `db` 0 if no DB is named.
    AreaPointer {
        db: u16,
        pointer: u32,
    },
    /// `P#DB11.DBX 20.0 INT 10`: the ten bytes of an ANY.
    Any([u8; 10]),
}

/// Why a text is not a constant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LiteralError {
    pub code: Code,
    /// What is wrong.
    pub title: String,
    /// What the text is, for the label.
    pub label: String,
    pub help: Option<String>,
}

impl LiteralError {
    /// The message about the constant at `span`.
    pub fn at(self, span: Span) -> Diagnostic {
        let message = Diagnostic::new(self.code, span, self.title).label(self.label);
        match self.help {
            Some(help) => message.help(help),
            None => message,
        }
    }

    pub(crate) fn malformed(text: &str, label: impl Into<String>, help: impl Into<String>) -> LiteralError {
        LiteralError {
            code: Code::BadLiteral,
            title: format!("`{text}` is not a constant as STEP 7 writes it"),
            label: label.into(),
            help: Some(help.into()),
        }
    }

    pub(crate) fn range(text: &str, label: impl Into<String>, help: impl Into<String>) -> LiteralError {
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
/// Blanks are skipped where listings have them (`D#1999 - 12 - 8`); a caller that does not accept them checks the text.
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
        "SINT" => number::whole(text, value, -0x80, 0x7F),
        "USINT" => number::whole(text, value, 0, 0xFF),
        "UINT" => number::whole(text, value, 0, 0xFFFF),
        "UDINT" => number::whole(text, value, 0, 0xFFFF_FFFF),
        "LINT" => number::whole(text, value, i64::MIN, i64::MAX),
        "ULINT" => number::whole(text, value, 0, i64::MAX),
        "REAL" | "LREAL" => number::typed_real(text, value),
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

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, value: Literal) {
        assert_eq!(parse(text), Ok(value), "{text}");
    }

    fn refuse(text: &str, code: Code) {
        assert_eq!(parse(text).map_err(|error| error.code), Err(code), "{text}");
    }

    /// Source: Programming with STEP 7, format of S5TIME.
    #[test]
    fn s5time_takes_the_finest_base_and_cuts_off() {
        check("S5T#2M_3S_400MS", Literal::S5Time(0x2123));
        check("S5T#1H2M3S400MS", Literal::S5Time(0x3372));
        check("S5T#2h_1m_0s_5ms", Literal::S5Time(0x3726));
        check("S5T#1M_2S_100MS", Literal::S5Time(0x1621));
        check("S5TIME#400MS", Literal::S5Time(0x0040));
        check("S5T#10s", Literal::S5Time(0x1100));
        check("S5T#9S_990MS", Literal::S5Time(0x0999));
        check("S5T#5MS", Literal::S5Time(0));
        check("S5T#2H_46M_30S", Literal::S5Time(0x3999));
        refuse("S5T#2H_46M_30S_1MS", Code::LiteralRange);
        refuse("S5T#-1S", Code::LiteralRange);
    }

    /// A fraction is decimal, not binary: 1.001 s is 1001 ms.
    #[test]
    fn fractions_of_durations_are_exact() {
        check("T#1.001S", Literal::Time(1001));
        check("T#-2.007S", Literal::Time(-2007));
        check("T#0.29S", Literal::Time(290));
        check("T#1.5H_30M", Literal::Time(7_200_000));
        check("T#.5S", Literal::Time(500));
        check("T#1.0019S", Literal::Time(1001));
        check("T#0.1D", Literal::Time(8_640_000));
        check("S5T#2.01s", Literal::S5Time(0x0201));
        check("S5T#0.57S", Literal::S5Time(0x0057));
        check("S5T#10.05S", Literal::S5Time(0x1100));
        check("S5T#1.1M", Literal::S5Time(0x1660));
        // Each number of milliseconds of a second.
        for ms in 0..1000 {
            check(&format!("T#7.{ms:03}S"), Literal::Time(7000 + ms));
        }
        refuse("T#1.2.3S", Code::BadLiteral);
        refuse("T#.S", Code::BadLiteral);
        refuse("T#--1S", Code::BadLiteral);
        refuse("T#99999999999999999999D", Code::LiteralRange);
    }

    /// Source: Programming with STEP 7, data types.
    #[test]
    fn dates_and_times() {
        check("D#1990-1-1", Literal::Date(0));
        check("DATE#2168-12-31", Literal::Date(65_378));
        check("T#-24D_20H_31M_23S_648MS", Literal::Time(i32::MIN));
        check("TIME_OF_DAY#1:10:3.3", Literal::TimeOfDay(4_203_300));
        check("DT#1991-2-3-4:5:6.789", Literal::DateAndTime([0x91, 0x02, 0x03, 0x04, 0x05, 0x06, 0x78, 0x91]));
        refuse("DT#2090-1-1-0:0:0", Code::LiteralRange);
        refuse("T#1S_1H", Code::BadLiteral);
    }

    /// Source: Programming with STEP 7, data types.
    #[test]
    fn pointers() {
        check("P#10.3", Literal::Pointer(0x53));
        check("P#M10.0", Literal::AreaPointer { db: 0, pointer: 0x8300_0050 });
        check("P#A 0.0", Literal::AreaPointer { db: 0, pointer: 0x8200_0000 });
        check("P#DB 10 . DBX 20.0", Literal::AreaPointer { db: 10, pointer: 0x8400_00A0 });
        check("P#DB11.DBX 20.0 INT 10", Literal::Any([0x10, 5, 0, 10, 0, 11, 0x84, 0, 0, 0xA0]));
        check("P#P 0.0 VOID 0", Literal::Any([0x10, 0, 0, 0, 0, 0, 0x80, 0, 0, 0]));
        refuse("P#M 10.8", Code::LiteralRange);
        refuse("P#M 10", Code::BadLiteral);
    }

    #[test]
    fn texts_and_numbers() {
        check("'$R\"#$$$'$41ä'", Literal::Text(vec![13, b'"', b'#', b'$', b'\'', b'A', 0xE4]));
        check("1.250000e+003", Literal::Real(1250.0));
        check("2#1010_0001", Literal::Bits { value: 0xA1, digits: 8 });
        check("B#(1,14,100,120)", Literal::Bytes4([1, 14, 100, 120]));
        check("L#-7", Literal::Dint(-7));
        check("c#20", Literal::Counter(0x20));
        check("UINT#40_000", Literal::Int(40_000));
        check("usint#16#FF", Literal::Int(255));
        check("LINT#-5", Literal::Int(-5));
        check("LREAL#0.5", Literal::Real(0.5));
        check("0e-50", Literal::Real(0.0));
        refuse("1.0e-50", Code::LiteralRange);
        refuse("SINT#128", Code::LiteralRange);
        refuse("UDINT#-1", Code::LiteralRange);
        refuse("W#A2EB", Code::BadLiteral);
        refuse("W#16#1_0000", Code::LiteralRange);
    }
}
