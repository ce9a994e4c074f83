//! Values as a user writes them: in the form of `--print`, or as an STL literal.

use plcc_literal::calendar::{Clock, Date};
use plcc_literal::duration::{self, Fraction, Smallest};
use plcc_literal::number;

use crate::address::{Bits, Width};
use crate::bcd;

/// Parses a value for an address of this width. `Err`: the error as a sentence.
pub fn parse(text: &str, width: Width) -> Result<Bits, String> {
    let text = text.trim();
    let (value, signed) = read(text, width).ok_or_else(|| {
        let example = match width {
            Width::Bit(_) => "true, false, 0 or 1",
            Width::Dword | Width::Lword => "a number such as 5, -5, 16#1F or 1.5",
            Width::Byte | Width::Word => without_fraction(text).unwrap_or("a number such as 5, -5 or 16#1F"),
        };
        format!("`{text}` is not a value; write {example}")
    })?;
    let bits = width.bits();
    let fits = if signed && value < 0 {
        bits >= 128 || bits > 1 && value >= -(1i128 << (bits - 1))
    } else {
        value >= 0 && value < 1i128 << bits
    };
    if !fits {
        let name = match width {
            Width::Bit(_) => "a bit (0 or 1)",
            Width::Byte => "a byte",
            Width::Word => "a word",
            Width::Dword => "a double word",
            Width::Lword => "eight bytes",
        };
        return Err(format!("`{text}` does not fit into {name}"));
    }
    Ok(value as u64 & if bits == 64 { u64::MAX } else { (1 << bits) - 1 })
}

/// `100` of `100.0`.
fn without_fraction(text: &str) -> Option<&str> {
    let (whole, fraction) = text.split_once('.')?;
    let is_zero = !fraction.is_empty() && fraction.bytes().all(|digit| digit == b'0');
    (is_zero && number::integer(whole).is_some()).then_some(whole)
}

/// The number and whether a sign is allowed.
fn read(text: &str, width: Width) -> Option<(i128, bool)> {
    let upper = text.to_ascii_uppercase();
    let unsigned = |value: u64| Some((i128::from(value), false));
    match upper.as_str() {
        "TRUE" => return unsigned(1),
        "FALSE" => return unsigned(0),
        _ => {}
    }
    if let Some(body) = text.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
        let in_range = !body.is_empty() && body.chars().count() <= 4 && body.chars().all(|c| u32::from(c) < 256);
        return in_range
            .then(|| unsigned(body.chars().fold(0, |value, c| value << 8 | u64::from(u32::from(c)))))
            .flatten();
    }
    let Some((prefix, rest)) = upper.split_once('#') else { return plain(&upper, width) };
    match prefix {
        "16" | "2" | "8" => number::based(prefix, rest).ok().and_then(|number| unsigned(number.value)),
        "B" | "W" | "DW" | "LW" | "BYTE" | "WORD" | "DWORD" | "LWORD" => {
            if let Some(list) = rest.strip_prefix('(').and_then(|list| list.strip_suffix(')')) {
                return byte_list(list).and_then(unsigned);
            }
            let (base, digits) = rest.split_once('#')?;
            number::based(base, digits).ok().and_then(|number| unsigned(number.value))
        }
        "L" | "DINT" | "INT" | "LINT" => number::integer(rest).map(|value| (value, true)),
        "C" => number::decimal(rest)
            .filter(|&count| count <= 999)
            .and_then(|count| unsigned(bcd::from_int(count as u32, 3).into())),
        "S5T" | "S5TIME" => duration_ms(rest)
            .and_then(|ms| u64::try_from(ms).ok())
            .and_then(bcd::s5_from_ms)
            .and_then(|value| unsigned(value.into())),
        "T" | "TIME" => duration_ms(rest).map(|ms| (ms, true)),
        "D" | "DATE" => date(rest).and_then(unsigned),
        "TOD" | "TIME_OF_DAY" => time_of_day(rest).and_then(unsigned),
        "P" => pointer(rest).and_then(unsigned),
        _ => None,
    }
}

/// A number without prefix: an integer, or a REAL by its point or exponent.
fn plain(text: &str, width: Width) -> Option<(i128, bool)> {
    if let Some(value) = number::integer(text) {
        return Some((value, true));
    }
    let real = text.contains('.') || text.contains('E');
    let clean = text.replace('_', "");
    let starts = clean.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit());
    if !real || !starts {
        return None;
    }
    // A number that is too large would become infinite.
    match width {
        Width::Dword => {
            let value = clean.parse::<f32>().ok().filter(|value| value.is_finite())?;
            Some((i128::from(value.to_bits()), false))
        }
        Width::Lword => {
            let value = clean.parse::<f64>().ok().filter(|value| value.is_finite())?;
            Some((i128::from(value.to_bits()), false))
        }
        Width::Bit(_) | Width::Byte | Width::Word => None,
    }
}

/// `1,8` or `1,14,100,120`.
fn byte_list(list: &str) -> Option<u64> {
    let bytes: Vec<u8> = list.split(',').map(|byte| byte.trim().parse().ok()).collect::<Option<_>>()?;
    matches!(bytes.len(), 2 | 4).then(|| bytes.iter().fold(0, |value, &byte| value << 8 | u64::from(byte)))
}

/// `2h_1m_0s_5ms`, `-1s100ms`, `1.001s`: milliseconds; smaller parts are cut off.
fn duration_ms(text: &str) -> Option<i128> {
    Some(duration::nanoseconds(text, Smallest::Millisecond, Fraction::Anywhere).ok()? / 1_000_000)
}

/// `2000-6-20`: days since 1990-01-01.
fn date(text: &str) -> Option<u64> {
    Date::parse(text)?.days_since(1990).map(u64::from)
}

/// `5:45:00`, `1:10:3.3`: milliseconds since midnight.
fn time_of_day(text: &str) -> Option<u64> {
    Clock::parse(text).filter(|clock| clock.exists()).map(|clock| clock.milliseconds().into())
}

/// Areas of pointers, and their bytes. Source: STL reference, format of pointers.
pub(crate) const POINTER_AREAS: [(&str, u64); 10] = [
    ("P", 0x80),
    ("I", 0x81),
    ("E", 0x81),
    ("Q", 0x82),
    ("A", 0x82),
    ("M", 0x83),
    ("DBX", 0x84),
    ("DIX", 0x85),
    ("L", 0x86),
    ("V", 0x87),
];

/// `10.3`: an area-internal pointer. `M10.3`: with its area.
fn pointer(text: &str) -> Option<u64> {
    let text = text.trim();
    let (area, rest) = text.split_at(text.find(|c: char| c.is_ascii_digit())?);
    let area = match area.trim() {
        "" => 0,
        area => POINTER_AREAS.iter().find(|(name, _)| *name == area)?.1,
    };
    let (byte, bit) = rest.split_once('.')?;
    let (byte, bit) = (number::decimal(byte)?, number::decimal(bit)?);
    (byte < 65_536 && bit < 8).then_some(area << 24 | (byte << 3 | bit) as u64)
}

/// A value as `--print` writes it.
pub fn text(bits: Bits, width: Width) -> String {
    match width {
        Width::Bit(_) => bits.to_string(),
        Width::Byte | Width::Word | Width::Dword | Width::Lword => {
            format!("16#{bits:0digits$X}", digits = 2 * width.bytes() as usize)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dword(text: &str) -> Option<u64> {
        parse(text, Width::Dword).ok()
    }

    #[test]
    fn what_is_no_value_of_a_word_is_told() {
        assert_eq!(parse("100.0", Width::Word), Err("`100.0` is not a value; write 100".to_string()));
        let other = "`1.5` is not a value; write a number such as 5, -5 or 16#1F";
        assert_eq!(parse("1.5", Width::Word), Err(other.to_string()));
    }

    #[test]
    fn literals() {
        for (text, value) in [
            ("16#0000_00FF", 0xFF),
            ("W#16#3A2F", 0x3A2F),
            ("2#1010", 10),
            ("B#(1,14,100,120)", 0x010E_6478),
            ("L#-1", 0xFFFF_FFFF),
            ("-1", 0xFFFF_FFFF),
            ("1.0", 0x3F80_0000),
            ("1.0e-3", 0x3A83_126F),
            ("C#20", 0x20),
            ("S5T#2M_3S_400MS", 0x2123),
            ("T#1s100ms", 1100),
            ("T#-1S", 0xFFFF_FC18),
            ("T#1.001s", 1001),
            ("T#-0.57S", (-570i32) as u32 as u64),
            ("S5T#2.01s", 0x0201),
            ("D#1990-01-02", 1),
            ("TOD#1:10:3.3", 4_203_300),
            ("'AB'", 0x4142),
            ("P#10.3", 0x53),
            ("P#M10.3", 0x8300_0053),
            ("p#dbx 0.1", 0x8400_0001),
            ("TRUE", 1),
        ] {
            assert_eq!(dword(text), Some(value), "{text}");
        }
    }

    #[test]
    fn what_does_not_fit_is_told() {
        assert_eq!(parse("2", Width::Bit(0)), Err("`2` does not fit into a bit (0 or 1)".to_string()));
        assert_eq!(parse("16#100", Width::Byte), Err("`16#100` does not fit into a byte".to_string()));
        assert_eq!(parse("-32769", Width::Word), Err("`-32769` does not fit into a word".to_string()));
        for bad in [
            "",
            "#",
            "abc",
            "16#",
            "16#-1",
            "1.0.0",
            "S5T#3h",
            "T#",
            "T#1s1m",
            "'ÄÖ€'",
            "B#(1)",
            "NAN",
            "1e",
            "1e39",
            "P#1.8",
            "P#X1.0",
            "TOD#1:2:\u{df}",
        ] {
            assert!(dword(bad).is_none(), "{bad}");
        }
    }

    #[test]
    fn printed_form() {
        assert_eq!(text(1, Width::Bit(3)), "1");
        assert_eq!(text(0xA, Width::Byte), "16#0A");
        assert_eq!(text(0xA, Width::Word), "16#000A");
        assert_eq!(text(0xDEAD_BEEF, Width::Dword), "16#DEADBEEF");
    }
}
