//! Display formats of watch tables. Source: Programming with STEP 7, display formats of the variable table.

use plcc_abi::image::AssertType;
use plcc_literal::article::with_article;
use plcc_literal::duration::s5time_milliseconds;
use plcc_literal::number;
use serde::{Deserialize, Serialize};

use crate::address::{Address, Bits, Width};
use crate::signal::{Source, Value};
use crate::{bcd, typed, value};

/// How a value is shown, and how one without a prefix is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    Bool,
    Bin,
    Hex,
    /// With a sign.
    Dec,
    Unsigned,
    Real,
    S5time,
    Time,
    TimeOfDay,
    Date,
    Counter,
    Char,
    Pointer,
    Bcd,
}

impl Format {
    /// Whether values of this width have the format.
    pub fn fits(self, width: Width) -> bool {
        let bits = width.bits();
        match self {
            Format::Bool => bits == 1,
            Format::Bin | Format::Hex | Format::Dec | Format::Unsigned => bits > 1,
            Format::Char => matches!(bits, 8 | 16 | 32),
            Format::Bcd => matches!(bits, 8 | 16 | 32),
            Format::S5time | Format::Date | Format::Counter => bits == 16,
            Format::Real => matches!(bits, 32 | 64),
            Format::Time | Format::TimeOfDay | Format::Pointer => bits == 32,
        }
    }

    /// The format of an address without a declared type.
    pub fn usual(width: Width) -> Format {
        if width.bits() == 1 { Format::Bool } else { Format::Hex }
    }

    /// The value as the format writes it. What is not one of its values is hexadecimal.
    pub fn show(self, bits: Bits, width: Width) -> String {
        let typed = |ty| Value::of_type(ty, bits).text();
        match self {
            Format::Bool => (bits != 0).to_string(),
            Format::Bin => format!("2#{}", grouped(&format!("{bits:00$b}", width.bits() as usize))),
            Format::Hex => hex(bits, width),
            Format::Dec => {
                let number = signed(bits, width);
                if width == Width::Dword { format!("L#{number}") } else { number.to_string() }
            }
            Format::Unsigned => bits.to_string(),
            Format::Real if width == Width::Lword => real(f64::from_bits(bits)),
            Format::Real => real(f32::from_bits(bits as u32).into()),
            Format::S5time if s5time_milliseconds(bits as u16).is_none() => hex(bits, width),
            Format::S5time => typed(AssertType::S5Time),
            Format::Time => typed(AssertType::Time),
            Format::TimeOfDay => typed(AssertType::TimeOfDay),
            Format::Date => typed(AssertType::Date),
            Format::Counter => match digits(bits & 0xFFFF).filter(|count| *count <= 999) {
                Some(count) => format!("C#{count}"),
                None => hex(bits, width),
            },
            Format::Char => {
                let bytes = (0..width.bytes()).rev().map(|byte| (bits >> (8 * byte)) as u8);
                let shown = bytes.map(|byte| if byte.is_ascii_graphic() || byte == b' ' { byte as char } else { '.' });
                format!("'{}'", shown.collect::<String>())
            }
            Format::Pointer => pointer(bits as u32),
            Format::Bcd => digits(bits).map_or_else(|| hex(bits, width), |number| number.to_string()),
        }
    }

    /// As [`show`](Format::show), of the value at an address: a counter has its count as a number, which `C#` writes in BCD.
    pub fn show_at(self, bits: Bits, address: &Address) -> String {
        let is_bcd = self == Format::Counter && address.is_count();
        self.show(if is_bcd { bcd::from_int(bits as u32, 3).into() } else { bits }, address.width)
    }

    /// As [`parse`](Format::parse), for an address. `Err`: the error as a sentence.
    pub fn parse_at(self, text: &str, address: &Address) -> Result<Bits, String> {
        let bits = self.parse(text, address.width)?;
        let is_bcd = self == Format::Counter || text.trim().starts_with(['C', 'c']);
        Ok(if is_bcd && address.is_count() { bcd::to_int(bits as u32, 3).into() } else { bits })
    }

    /// The format for a row, if it shows its values. `Err`: why not.
    pub fn check(self, name: &str, source: &Source, width: Width) -> Result<Format, String> {
        match source {
            // A text has the address of its first byte.
            Source::Typed(_, ty) if typed::bits(ty.ty).is_none() => {
                let ty = with_article(typed::name(ty.ty));
                Err(format!("{name} is {ty}, which no format shows: leave the format out"))
            }
            _ if !self.fits(width) => {
                let (bits, formats) = possible(width);
                Err(format!("{name} has {bits}, which this format does not show: write {formats}"))
            }
            _ => Ok(self),
        }
    }

    /// Reads a value: a literal with a prefix that fits, or one without a prefix in this format. `Err`: the error as a sentence.
    pub fn parse(self, text: &str, width: Width) -> Result<Bits, String> {
        let text = text.trim();
        if text.contains('#') || text.starts_with('\'') {
            return value::parse(text, width);
        }
        let wrong = |example: &str| Err(format!("`{text}` is not a value in the format of the row: write {example}"));
        let digits = text.replace('_', "");
        let is = |allowed: fn(&u8) -> bool| !digits.is_empty() && digits.bytes().all(|byte| allowed(&byte));
        let is_number = is(u8::is_ascii_digit);
        let is_signed =
            is_number || digits.strip_prefix(['+', '-']).is_some_and(|rest| number::decimal(rest).is_some());
        let with = |prefix: &str, kind: &str| {
            value::parse(&format!("{prefix}#{digits}"), width)
                .map_err(|_| format!("`{text}` has more {kind} than {} bits hold", width.bits()))
        };
        match self {
            Format::Bool => value::parse(text, width),
            Format::Hex if is_number => {
                with("16", "hexadecimal digits").map_err(|why| format!("{why}; a decimal number has the format dec"))
            }
            Format::Hex if is(u8::is_ascii_hexdigit) => with("16", "hexadecimal digits"),
            Format::Hex => wrong("hexadecimal digits, such as 1F"),
            Format::Bin if is(|byte| matches!(byte, b'0' | b'1')) => with("2", "binary digits"),
            Format::Bin => wrong("binary digits, such as 1010"),
            Format::Dec if is_signed => value::parse(text, width),
            Format::Dec => wrong("a whole number, such as -5"),
            Format::Unsigned if is_number => value::parse(text, width),
            Format::Unsigned if is_signed => Err(format!("`{text}` has a sign; the row is unsigned")),
            Format::Unsigned => wrong("a whole number, such as 5"),
            Format::Bcd if is_number => with("16", "digits"),
            Format::Bcd => wrong("decimal digits, such as 129"),
            Format::Counter if is_number && digits.len() <= 3 => with("16", "digits"),
            Format::Counter => wrong("a count from 0 to 999"),
            Format::Real if is_signed => value::parse(&format!("{digits}.0"), width),
            Format::Real => match value::parse(text, width) {
                Ok(bits) if !matches!(text.to_ascii_uppercase().as_str(), "TRUE" | "FALSE") => Ok(bits),
                _ => wrong("a number that is not too large, such as 1.5 or 2.5e-3"),
            },
            // Without a unit in milliseconds, as a number has them.
            Format::S5time if is_number => value::parse(&format!("S5T#{digits}ms"), width),
            Format::S5time => {
                value::parse(&format!("S5T#{text}"), width).or_else(|_| wrong("a time up to 2h46m30s, such as 1s500ms"))
            }
            Format::Time if is_signed => value::parse(text, width),
            Format::Time => value::parse(&format!("T#{text}"), width).or_else(|_| wrong("a time, such as 1s500ms")),
            Format::TimeOfDay => {
                value::parse(&format!("TOD#{text}"), width).or_else(|_| wrong("a time of day, such as 13:05:02"))
            }
            Format::Date => value::parse(&format!("D#{text}"), width).or_else(|_| wrong("a date, such as 2024-03-15")),
            Format::Char => wrong("the characters in quotes, such as 'a'"),
            Format::Pointer => {
                value::parse(&format!("P#{text}"), width).or_else(|_| wrong("a pointer, such as M10.0 or 10.0"))
            }
        }
    }
}

/// How wide a value is, and the formats that show it.
fn possible(width: Width) -> (&'static str, &'static str) {
    match width {
        Width::Bit(_) => ("1 bit", "bool"),
        Width::Byte => ("8 bits", "bin, hex, dec, unsigned, char or bcd"),
        Width::Word => ("16 bits", "bin, hex, dec, unsigned, s5time, date, counter, char or bcd"),
        Width::Dword => ("32 bits", "bin, hex, dec, unsigned, real, time, time-of-day, char, pointer or bcd"),
        Width::Lword => ("64 bits", "bin, hex, dec, unsigned or real"),
    }
}

/// `W#16#012C`.
fn hex(bits: Bits, width: Width) -> String {
    let prefix = match width {
        Width::Bit(_) => return bits.to_string(),
        Width::Byte => "B",
        Width::Word => "W",
        Width::Dword => "DW",
        Width::Lword => "LW",
    };
    format!("{prefix}#16#{bits:00$X}", 2 * width.bytes() as usize)
}

/// Digits in groups of four.
fn grouped(digits: &str) -> String {
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(4) {
            text.push('_');
        }
        text.push(digit);
    }
    text
}

fn signed(bits: Bits, width: Width) -> i64 {
    let unused = 64 - width.bits();
    (bits << unused).cast_signed() >> unused
}

/// The number in BCD; `None` if a digit is none.
fn digits(bits: Bits) -> Option<u64> {
    let mut number = 0;
    for place in (0..16).rev() {
        let digit = bits >> (4 * place) & 0xF;
        if digit > 9 {
            return None;
        }
        number = number * 10 + digit;
    }
    Some(number)
}

/// `1.5`, `1.234568e+010`.
fn real(number: f64) -> String {
    if !number.is_finite() {
        return number.to_string();
    }
    let size = number.abs();
    if number == 0.0 || (1e-4..1e7).contains(&size) {
        let rounded: f64 = format!("{number:.6e}").parse().unwrap_or(number);
        return if rounded.fract() == 0.0 { format!("{rounded:.1}") } else { rounded.to_string() };
    }
    let text = format!("{number:.6e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, exponent) = exponent.strip_prefix('-').map_or(('+', exponent), |exponent| ('-', exponent));
    format!("{digits}e{sign}{exponent:0>3}")
}

/// `P#M10.0`, without an area `P#10.0`.
fn pointer(bits: u32) -> String {
    let area = match (bits >> 24, value::POINTER_AREAS.iter().find(|(_, code)| *code == u64::from(bits >> 24))) {
        (0, _) => "",
        (_, Some((area, _))) => area,
        (_, None) => return hex(bits.into(), Width::Dword),
    };
    format!("P#{area}{}.{}", (bits & 0x7_FFFF) >> 3, bits & 7)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_of_a_width_are_listed() {
        for width in [Width::Bit(0), Width::Byte, Width::Word, Width::Dword, Width::Lword] {
            for word in possible(width).1.split([',', ' ']).filter(|word| !matches!(*word, "" | "or")) {
                let format: Format = toml::Value::String(word.to_string()).try_into().unwrap();
                assert!(format.fits(width), "{word} of {width:?}");
            }
        }
    }

    #[test]
    fn values_are_shown_by_their_formats() {
        for (format, bits, width, text) in [
            (Format::Bool, 1, Width::Bit(3), "true"),
            (Format::Bin, 0x2C, Width::Byte, "2#0010_1100"),
            (Format::Hex, 0x12C, Width::Word, "W#16#012C"),
            (Format::Hex, 0x12C, Width::Dword, "DW#16#0000012C"),
            (Format::Dec, 0xFFFD, Width::Word, "-3"),
            (Format::Dec, 0xFFFF_FFFD, Width::Dword, "L#-3"),
            (Format::Unsigned, 0xFFFD, Width::Word, "65533"),
            (Format::Real, 0x3FC0_0000, Width::Dword, "1.5"),
            (Format::Real, 0x5037_EAE3, Width::Dword, "1.234250e+010"),
            (Format::S5time, 0xABCD, Width::Word, "W#16#ABCD"),
            (Format::Counter, 0x127, Width::Word, "C#127"),
            (Format::Char, 0x6162, Width::Word, "'ab'"),
            (Format::Char, 0x6101, Width::Word, "'a.'"),
            (Format::Pointer, 0x8300_0050, Width::Dword, "P#M10.0"),
            (Format::Pointer, 0x50, Width::Dword, "P#10.0"),
            (Format::Bcd, 0x123, Width::Word, "123"),
            (Format::Bcd, 0x12A, Width::Word, "W#16#012A"),
        ] {
            assert!(format.fits(width));
            assert_eq!(format.show(bits, width), text);
        }
    }

    #[test]
    fn a_plain_number_is_in_the_format_of_the_row() {
        for (format, text, width, bits) in [
            (Format::Hex, "12", Width::Word, 0x12),
            (Format::Bin, "0010_1100", Width::Byte, 0x2C),
            (Format::Dec, "-3", Width::Word, 0xFFFD),
            (Format::Real, "2", Width::Dword, 0x4000_0000),
            (Format::Bcd, "123", Width::Word, 0x123),
            (Format::Dec, "16#1F", Width::Word, 0x1F),
            (Format::Bool, "true", Width::Bit(0), 1),
            // Digits, not an exponent.
            (Format::Hex, "1E5", Width::Dword, 0x1E5),
            (Format::Hex, "FFFF_FFFF_FFFF_FFFF", Width::Lword, u64::MAX),
            (Format::Dec, "-9223372036854775808", Width::Lword, 1 << 63),
            (Format::Unsigned, "18446744073709551615", Width::Lword, u64::MAX),
            (Format::Real, "-2", Width::Dword, 0xC000_0000),
            (Format::Real, "1e3", Width::Dword, 0x447A_0000),
            (Format::Real, "-2.5", Width::Lword, 0xC004_0000_0000_0000),
            (Format::S5time, "137", Width::Word, 0x0013),
            (Format::S5time, "10s", Width::Word, 0x1100),
            (Format::Time, "1s500ms", Width::Dword, 1500),
            (Format::Time, "-20", Width::Dword, 0xFFFF_FFEC),
            (Format::TimeOfDay, "00:00:01.5", Width::Dword, 1500),
            (Format::Date, "1990-01-03", Width::Word, 2),
            (Format::Counter, "127", Width::Word, 0x127),
            (Format::Char, "'ab'", Width::Word, 0x6162),
            (Format::Pointer, "M10.0", Width::Dword, 0x8300_0050),
            (Format::Pointer, "P#10.0", Width::Dword, 0x50),
        ] {
            assert_eq!(format.parse(text, width), Ok(bits), "{text}");
        }
    }

    #[test]
    fn digits_that_do_not_fit_are_named() {
        let told = |format: Format, text: &str| format.parse(text, Width::Byte).unwrap_err();
        let hint = "`255` has more hexadecimal digits than 8 bits hold; a decimal number has the format dec";
        assert_eq!(told(Format::Hex, "255"), hint);
        assert_eq!(told(Format::Hex, "1FF"), "`1FF` has more hexadecimal digits than 8 bits hold");
        assert_eq!(told(Format::Bin, "1_0000_0000"), "`1_0000_0000` has more binary digits than 8 bits hold");
        assert_eq!(told(Format::Bcd, "255"), "`255` has more digits than 8 bits hold");
    }

    #[test]
    fn what_is_not_in_the_format_is_refused() {
        for (format, text, width) in [
            (Format::Unsigned, "-1", Width::Word),
            (Format::Dec, "99999", Width::Word),
            (Format::Dec, "1.5", Width::Dword),
            (Format::Hex, "1.5", Width::Dword),
            (Format::Hex, "12345", Width::Word),
            (Format::Bin, "102", Width::Byte),
            (Format::Bcd, "12A", Width::Word),
            (Format::Bcd, "-5", Width::Word),
            (Format::Bcd, "1.5", Width::Dword),
            (Format::Bcd, "12345", Width::Word),
            (Format::Counter, "1000", Width::Word),
            (Format::Real, "1e39", Width::Dword),
            (Format::Real, "true", Width::Dword),
            (Format::Real, "", Width::Dword),
            (Format::S5time, "3h", Width::Word),
            (Format::S5time, "1.5", Width::Word),
            (Format::Date, "5", Width::Word),
            (Format::TimeOfDay, "25:00:00", Width::Dword),
            (Format::Char, "65", Width::Byte),
            (Format::Char, "'abc'", Width::Word),
            (Format::Pointer, "80", Width::Dword),
            (Format::Bool, "2", Width::Bit(0)),
        ] {
            assert!(format.parse(text, width).is_err(), "{text}");
        }
    }
}
