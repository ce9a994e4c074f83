//! Display formats of watch tables. Source: Programming with STEP 7, display formats of the variable table.

use plcc_abi::image::AssertType;
use serde::{Deserialize, Serialize};

use crate::address::{Bits, Width};
use crate::signal::Value;
use crate::{bcd, value};

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

    /// The value as the format writes it. What is none of its values is hexadecimal.
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
            Format::S5time if bcd::s5_to_ms(bits as u16).is_none() => hex(bits, width),
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

    /// Reads a value: any literal that fits, or a plain number in this format. `Err`: the error as a sentence.
    pub fn parse(self, text: &str, width: Width) -> Result<Bits, String> {
        let text = text.trim();
        let is_plain = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'_');
        let plain = || text.replace('_', "");
        match self {
            Format::Hex if is_plain => value::parse(&format!("16#{}", plain()), width),
            Format::Bin if is_plain => value::parse(&format!("2#{}", plain()), width),
            Format::Bcd | Format::Counter if is_plain => value::parse(&format!("16#{}", plain()), width),
            Format::Real if is_plain => value::parse(&format!("{}.0", plain()), width),
            Format::Unsigned if text.starts_with('-') => Err(format!("`{text}` has a sign; the row is unsigned")),
            _ => value::parse(text, width),
        }
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
    let area = match bits >> 24 {
        0 => "",
        0x80 => "P",
        0x81 => "I",
        0x82 => "Q",
        0x83 => "M",
        0x84 => "DBX",
        0x85 => "DIX",
        0x86 => "L",
        0x87 => "V",
        _ => return hex(bits.into(), Width::Dword),
    };
    format!("P#{area}{}.{}", (bits & 0x7_FFFF) >> 3, bits & 7)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        ] {
            assert_eq!(format.parse(text, width), Ok(bits), "{text}");
        }
        assert!(Format::Unsigned.parse("-1", Width::Word).is_err());
        assert!(Format::Dec.parse("99999", Width::Word).is_err());
    }
}
