//! Values of the types of PLC languages as a user writes and sees them: `T#1s500ms`, `'abc'`, `D#2026-01-31`, `-5`.

use plcc_abi::image::{AssertKind, AssertType};
use plcc_literal::calendar::{Clock, Date};
use plcc_literal::duration::{self, Fraction, Smallest};
use plcc_literal::number;

use crate::address::Width;
use crate::assertion::{Value, compare, signed, windows_1252};
use crate::{bcd, datetime};

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
        let words: Vec<&str> = types.iter().map(|(word, _)| *word).collect();
        format!("`{}` is not a type; the types are {}", word.trim(), words.join(", "))
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

/// Reads a value of a type. `Err`: the error as a sentence.
pub fn parse(text: &str, wanted: ValueType) -> Result<Value, String> {
    let text = text.trim();
    let ty = wanted.ty;
    // What is proposed must be a value itself.
    let proposed = || meant(text, ty).filter(|meant| meant != text && parse(meant, wanted).is_ok());
    let wrong = || match proposed() {
        Some(meant) => format!("`{text}` is not a value of type {}; write {meant}", name(ty)),
        None => format!("`{text}` is not a value of type {}, such as {}", name(ty), example(ty)),
    };
    if matches!(ty, AssertType::Text | AssertType::WideText) {
        return characters(text, wanted);
    }
    // A bit pattern is the value with these bits.
    if let (Some(pattern), Some(width)) = (pattern(text), bits(ty)) {
        let fits = u128::from(pattern) < 1u128 << width;
        return if fits { Ok(Value::Bits(pattern)) } else { Err(format!("`{text}` does not fit into {}", name(ty))) };
    }
    let (prefix, body) = match text.split_once('#') {
        Some((prefix, body)) if !text.starts_with('\'') => {
            let prefix = WORDS.iter().find(|(word, _)| word.eq_ignore_ascii_case(prefix.trim())).map(|(_, ty)| *ty);
            let prefix = prefix.or(if text.starts_with(['L', 'l']) { long_prefix(text) } else { None });
            (Some(prefix.ok_or_else(wrong)?), body.trim())
        }
        _ => (None, text),
    };
    let range = |value: i128, low: i128, high: i128| match (low..=high).contains(&value) {
        true => Ok(Value::Bits(value as u64 & (u64::MAX >> (64 - bits(ty).unwrap_or(64).min(64))))),
        false => Err(format!("`{text}` does not fit into {}, which goes from {low} to {high}", name(ty))),
    };
    let is_own = prefix.is_none_or(|prefix| prefix == ty);
    match ty {
        AssertType::Bool => match body.to_ascii_uppercase().as_str() {
            "TRUE" | "1" if is_own => Ok(Value::Bits(1)),
            "FALSE" | "0" if is_own => Ok(Value::Bits(0)),
            _ => Err(wrong()),
        },
        AssertType::Bits(width) => {
            let value = number::integer(body).filter(|_| is_own).ok_or_else(wrong)?;
            range(value, 0, (1 << width) - 1)
        }
        AssertType::Signed(width) => {
            let is_number =
                prefix.is_none_or(|prefix| matches!(prefix, AssertType::Signed(_) | AssertType::Unsigned(_)));
            let value = number::integer(body).filter(|_| is_number).ok_or_else(wrong)?;
            range(value, -(1 << (width - 1)), (1 << (width - 1)) - 1)
        }
        AssertType::Unsigned(width) => {
            let is_number =
                prefix.is_none_or(|prefix| matches!(prefix, AssertType::Signed(_) | AssertType::Unsigned(_)));
            let value = number::integer(body).filter(|_| is_number).ok_or_else(wrong)?;
            range(value, 0, (1 << width) - 1)
        }
        AssertType::Real | AssertType::Lreal => {
            let plain = body.replace('_', "");
            let starts = plain.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit());
            let is_float = prefix.is_none_or(|prefix| matches!(prefix, AssertType::Real | AssertType::Lreal));
            let value: f64 = plain.parse().ok().filter(|_| starts && is_float).ok_or_else(wrong)?;
            let pattern = match ty {
                AssertType::Real => u64::from((value as f32).to_bits()),
                _ => value.to_bits(),
            };
            let is_finite = if ty == AssertType::Real { (value as f32).is_finite() } else { value.is_finite() };
            if is_finite { Ok(Value::Bits(pattern)) } else { Err(format!("`{text}` does not fit into {}", name(ty))) }
        }
        AssertType::Char | AssertType::Wchar => {
            let inner = quoted(body).ok_or_else(wrong)?;
            let expanded = expanded(inner, ty).map_err(|why| format!("`{text}` is not a character: {why}"))?;
            match (&expanded[..], ty) {
                ([unit], AssertType::Char) => match crate::assertion::byte_of(*unit) {
                    Some(byte) => Ok(Value::Bits(byte.into())),
                    None => Err(format!("`{text}` is not a character of the code page Windows-1252")),
                },
                ([unit], _) => Ok(Value::Bits((*unit).into())),
                _ => Err(wrong()),
            }
        }
        AssertType::S5Time | AssertType::Time | AssertType::Ltime => {
            let is_span =
                prefix.is_none_or(|prefix| matches!(prefix, AssertType::S5Time | AssertType::Time | AssertType::Ltime));
            // Without a prefix a number is in the unit of the type.
            if let Some(count) = number::integer(body).filter(|_| prefix.is_none() && ty != AssertType::S5Time) {
                return match ty {
                    AssertType::Time => range(count, i32::MIN.into(), i32::MAX.into()),
                    _ => range(count, i64::MIN.into(), i64::MAX.into()),
                };
            }
            let smallest = if ty == AssertType::Ltime { Smallest::Nanosecond } else { Smallest::Millisecond };
            let ns =
                duration::nanoseconds(body, smallest, Fraction::Anywhere).ok().filter(|_| is_span).ok_or_else(wrong)?;
            let out = || format!("`{text}` does not fit into {}", name(ty));
            match ty {
                AssertType::S5Time => {
                    let ms = u64::try_from(ns / 1_000_000).ok();
                    ms.and_then(bcd::s5_from_ms).map(|value| Value::Bits(value.into())).ok_or_else(out)
                }
                AssertType::Time => {
                    i32::try_from(ns / 1_000_000).map(|ms| Value::Bits(u64::from(ms as u32))).map_err(|_| out())
                }
                _ => i64::try_from(ns).map(|ns| Value::Bits(ns as u64)).map_err(|_| out()),
            }
        }
        AssertType::Date => {
            let days = Date::parse(body).filter(|_| is_own).and_then(|date| date.days_since(1990)).ok_or_else(wrong)?;
            range(days.into(), 0, 0xFFFF)
        }
        AssertType::TimeOfDay | AssertType::Ltod => {
            let is_clock = prefix.is_none_or(|prefix| matches!(prefix, AssertType::TimeOfDay | AssertType::Ltod));
            let clock = Clock::parse(body).filter(|clock| is_clock && clock.exists()).ok_or_else(wrong)?;
            Ok(Value::Bits(if ty == AssertType::Ltod { clock.nanoseconds() } else { clock.milliseconds().into() }))
        }
        AssertType::DateAndTime | AssertType::Ldt | AssertType::Dtl => {
            let is_moment = prefix.is_none_or(|prefix| {
                matches!(prefix, AssertType::DateAndTime | AssertType::Ldt | AssertType::Dtl | AssertType::Date)
            });
            moment(body, ty).filter(|_| is_moment).ok_or_else(wrong)
        }
        AssertType::Text | AssertType::WideText => Err(wrong()),
    }
}

/// `LT#` and the like are prefixes of types that have longer names.
fn long_prefix(text: &str) -> Option<AssertType> {
    let prefix = text.split_once('#')?.0.trim().to_ascii_uppercase();
    match prefix.as_str() {
        "L" => Some(AssertType::Signed(32)),
        "LT" => Some(AssertType::Ltime),
        _ => None,
    }
}

/// `16#FF`, `W#16#FF`, `2#1010`, `B#(1,2)`: bits whatever the type.
fn pattern(text: &str) -> Option<u64> {
    let (first, rest) = text.split_once('#')?;
    let first = first.trim().to_ascii_uppercase();
    match first.as_str() {
        "2" | "8" | "16" => number::based(&first, rest).ok().map(|based| based.value),
        "B" | "W" | "DW" | "LW" | "BYTE" | "WORD" | "DWORD" | "LWORD" => {
            let (base, digits) = rest.split_once('#')?;
            number::based(base.trim(), digits).ok().map(|based| based.value)
        }
        _ => None,
    }
}

/// Text between quotes, after a prefix such as `STRING#` or without one; a text without quotes is itself.
fn characters(text: &str, wanted: ValueType) -> Result<Value, String> {
    let upper = text.to_ascii_uppercase();
    let bare = ["STRING#", "WSTRING#"]
        .iter()
        .find(|prefix| upper.starts_with(**prefix))
        .map_or(text, |prefix| &text[prefix.len()..]);
    let mut characters = match quoted(bare) {
        Some(inner) => expanded(inner, wanted.ty).map_err(|why| format!("`{text}` is not a text: {why}"))?,
        None => bare.encode_utf16().collect(),
    };
    if characters.len() > usize::from(wanted.length) {
        return Err(format!("`{text}` has {} characters; there is room for {}", characters.len(), wanted.length));
    }
    if wanted.ty == AssertType::Text {
        for unit in &mut characters {
            let byte = crate::assertion::byte_of(*unit);
            *unit = byte
                .ok_or_else(|| format!("`{text}` has a character that is not in the code page Windows-1252"))?
                .into();
        }
    }
    Ok(Value::Text(characters))
}

fn quoted(text: &str) -> Option<&str> {
    text.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\''))
}

/// What is between the quotes of a literal, with its escapes expanded: `$$ $' $L $N $P $R $T`, and `$` with a code of two hexadecimal digits, of
/// four in WSTRING and WCHAR. `Err`: the wrong escape.
fn expanded(inner: &str, ty: AssertType) -> Result<Vec<u16>, String> {
    let is_wide = matches!(ty, AssertType::WideText | AssertType::Wchar);
    let digits = if is_wide { 4 } else { 2 };
    let mut expanded = Vec::with_capacity(inner.len());
    let mut rest = inner;
    while let Some((plain, escape)) = rest.split_once('$') {
        expanded.extend(plain.encode_utf16());
        let sign = escape.chars().next();
        let (unit, length) = match sign {
            Some(sign @ ('$' | '\'' | '"')) => (sign as u16, 1),
            Some('L' | 'l' | 'N' | 'n') => (10, 1),
            Some('P' | 'p') => (12, 1),
            Some('R' | 'r') => (13, 1),
            Some('T' | 't') => (9, 1),
            _ => {
                let code = escape.get(..digits).filter(|code| code.bytes().all(|digit| digit.is_ascii_hexdigit()));
                let code = code.and_then(|code| u16::from_str_radix(code, 16).ok());
                let sign = sign.map_or_else(String::new, String::from);
                let code = code.ok_or_else(|| format!("`${sign}` is not an escape; `$$` is a dollar sign"))?;
                (if is_wide { code } else { windows_1252(code) }, digits)
            }
        };
        expanded.push(unit);
        rest = &escape[length..];
    }
    expanded.extend(rest.encode_utf16());
    Ok(expanded)
}

/// `2026-01-31-6:00:00.5`, also with a blank or `T` before the time, or without a time.
fn moment(text: &str, ty: AssertType) -> Option<Value> {
    let text = text.trim().replace(['T', ' '], "-");
    let mut dashes = text.match_indices('-').map(|(at, _)| at);
    let (date, clock) = match dashes.nth(2) {
        Some(at) => (&text[..at], &text[at + 1..]),
        None => (text.as_str(), "0:0:0"),
    };
    let date = Date::parse(date)?;
    let clock = Clock::parse(clock).filter(|clock| clock.exists())?;
    let days = i64::from(date.days_since(1970)?);
    let ns = days.checked_mul(86_400 * datetime::NS_PER_S)?.checked_add(i64::try_from(clock.nanoseconds()).ok()?)?;
    match ty {
        AssertType::Ldt => Some(Value::Bits(ns as u64)),
        AssertType::DateAndTime => {
            let year = datetime::civil(ns).year();
            (1990..2090).contains(&year).then(|| Value::Bits(u64::from_be_bytes(datetime::encode(ns))))
        }
        _ => {
            let civil = datetime::civil(ns);
            let weekday = civil.weekday().to_sunday_one_offset();
            let mut bytes = [0u8; 12];
            bytes[..2].copy_from_slice(&civil.year().to_be_bytes());
            let parts = [civil.month(), civil.day(), weekday, civil.hour(), civil.minute(), civil.second()];
            for (byte, part) in bytes[2..8].iter_mut().zip(parts) {
                *byte = part.unsigned_abs();
            }
            bytes[8..].copy_from_slice(&((ns % datetime::NS_PER_S) as u32).to_be_bytes());
            Some(Value::Bytes(bytes))
        }
    }
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

/// How the author of a text writes the value that he means: `2 s` as T#2s, `1,5` as 1.5, `on` as TRUE. `None`: no idea.
fn meant(text: &str, ty: AssertType) -> Option<String> {
    let duration = |prefix: &str| plcc_literal::duration::meant_span(text).map(|span| format!("{prefix}#{span}"));
    match ty {
        AssertType::Time => duration("T"),
        AssertType::S5Time => duration("S5T"),
        AssertType::Ltime => duration("LT"),
        AssertType::Real | AssertType::Lreal => {
            let pointed = text.replace(',', ".");
            pointed.parse::<f64>().ok()?;
            let (sign, digits) = pointed.split_at(pointed.len() - pointed.trim_start_matches(['+', '-']).len());
            Some(if digits.starts_with('.') { format!("{sign}0{digits}") } else { pointed })
        }
        AssertType::Bool => ["on", "yes", "high", "off", "no", "low"]
            .iter()
            .position(|word| word.eq_ignore_ascii_case(text))
            .map(|at| if at < 3 { "TRUE" } else { "FALSE" }.to_owned()),
        AssertType::Bits(_) => {
            let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"))?;
            u64::from_str_radix(digits, 16).ok().map(|_| format!("16#{digits}"))
        }
        AssertType::Signed(_)
        | AssertType::Unsigned(_)
        | AssertType::Char
        | AssertType::Wchar
        | AssertType::Date
        | AssertType::TimeOfDay
        | AssertType::Ltod
        | AssertType::Ldt
        | AssertType::DateAndTime
        | AssertType::Dtl
        | AssertType::Text
        | AssertType::WideText => None,
    }
}

const fn example(ty: AssertType) -> &'static str {
    match ty {
        AssertType::Bool => "TRUE or FALSE",
        AssertType::Bits(_) => "16#FF",
        AssertType::Signed(_) => "-5",
        AssertType::Unsigned(_) => "5",
        AssertType::Real | AssertType::Lreal => "12.5",
        AssertType::Char | AssertType::Wchar => "'a'",
        AssertType::S5Time => "S5T#1s500ms",
        AssertType::Time => "T#1s500ms",
        AssertType::Ltime => "LT#1s500us",
        AssertType::Date => "D#2026-01-31",
        AssertType::TimeOfDay => "TOD#6:00:00",
        AssertType::Ltod => "LTOD#6:00:00",
        AssertType::Ldt => "LDT#2026-01-31-6:00:00",
        AssertType::DateAndTime => "DT#2026-01-31-6:00:00",
        AssertType::Dtl => "DTL#2026-01-31-6:00:00",
        AssertType::Text | AssertType::WideText => "'abc'",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits_of(text: &str, ty: AssertType) -> Result<u64, String> {
        parse(text, ValueType::of(ty)).map(|value| match value {
            Value::Bits(bits) => bits,
            other => panic!("{other:?}"),
        })
    }

    #[test]
    fn literals_of_each_type() {
        for (text, ty, expected) in [
            ("TRUE", AssertType::Bool, 1),
            ("-5", AssertType::Signed(16), 0xFFFB),
            ("INT#-5", AssertType::Signed(32), 0xFFFF_FFFB),
            ("L#7", AssertType::Signed(32), 7),
            ("16#FFFB", AssertType::Signed(16), 0xFFFB),
            ("18446744073709551615", AssertType::Unsigned(64), u64::MAX),
            ("12.5", AssertType::Real, 0x4148_0000),
            ("3", AssertType::Real, 0x4040_0000),
            ("DW#16#7FC00000", AssertType::Real, 0x7FC0_0000),
            ("T#1s500ms", AssertType::Time, 1500),
            ("1.5s", AssertType::Time, 1500),
            ("250", AssertType::Time, 250),
            ("T#-1s", AssertType::Time, 0xFFFF_FC18),
            ("S5T#1s", AssertType::S5Time, 0x0100),
            ("LT#5us", AssertType::Ltime, 5000),
            ("D#1990-01-02", AssertType::Date, 1),
            ("1990-01-02", AssertType::Date, 1),
            ("TOD#0:0:1.5", AssertType::TimeOfDay, 1500),
            ("LTOD#0:0:0.000001", AssertType::Ltod, 1000),
            ("LDT#1970-01-01-0:0:1", AssertType::Ldt, 1_000_000_000),
            ("DT#1990-01-02-3:04:05", AssertType::DateAndTime, 0x9001_0203_0405_0003),
            ("'a'", AssertType::Char, 0x61),
            ("'€'", AssertType::Char, 0x80),
            ("'€'", AssertType::Wchar, 0x20AC),
            ("'#'", AssertType::Char, 0x23),
            ("'$R'", AssertType::Char, 13),
            ("'$''", AssertType::Char, 0x27),
            ("'$20AC'", AssertType::Wchar, 0x20AC),
        ] {
            assert_eq!(bits_of(text, ty), Ok(expected), "{text} {ty:?}");
        }
        let text = |text: &str, ty| parse(text, ValueType { ty, length: 5 });
        assert_eq!(text("'abc'", AssertType::Text), Ok(Value::Text(vec![0x61, 0x62, 0x63])));
        assert_eq!(text("abc", AssertType::Text), text("'abc'", AssertType::Text));
        assert_eq!(text("€", AssertType::Text), Ok(Value::Text(vec![0x80])));
        assert_eq!(text("€", AssertType::WideText), Ok(Value::Text(vec![0x20AC])));
        assert_eq!(text("'a$R$l$$$80'", AssertType::Text), Ok(Value::Text(vec![0x61, 13, 10, 0x24, 0x80])));
        assert_eq!(text("a$R", AssertType::Text), Ok(Value::Text(vec![0x61, 0x24, 0x52])), "without quotes no escapes");
        // What is printed is read as the same.
        let printed = "'it$'s$R$L$$$01'";
        let read = parse(printed, ValueType::of(AssertType::Text)).unwrap();
        assert_eq!(read.typed_text(AssertType::Text), printed);
        let dtl = parse("DTL#2026-01-31-6:07:08.5", ValueType::of(AssertType::Dtl)).unwrap();
        assert_eq!(dtl, Value::Bytes([0x07, 0xEA, 1, 31, 7, 6, 7, 8, 0x1D, 0xCD, 0x65, 0]));
    }

    #[test]
    fn what_is_no_value_of_the_type() {
        for (text, ty) in [
            ("2", AssertType::Bool),
            ("32768", AssertType::Signed(16)),
            ("-1", AssertType::Unsigned(8)),
            ("1.5", AssertType::Signed(16)),
            ("T#1s", AssertType::Signed(16)),
            ("16#1_0000", AssertType::Signed(16)),
            ("1e39", AssertType::Real),
            ("nan", AssertType::Real),
            ("soon", AssertType::Time),
            ("T#30d", AssertType::Time),
            ("S5T#3h", AssertType::S5Time),
            ("D#2026-02-30", AssertType::Date),
            ("TOD#25:0:0", AssertType::TimeOfDay),
            ("DT#2026-01-31-25:0:0", AssertType::DateAndTime),
            ("'ab'", AssertType::Char),
            ("'5 $'", AssertType::Text),
            ("'$X1'", AssertType::Text),
            ("", AssertType::Real),
        ] {
            assert!(parse(text, ValueType::of(ty)).is_err(), "{text} {ty:?}");
        }
        let long = parse("'abcdef'", ValueType { ty: AssertType::Text, length: 5 });
        assert_eq!(long, Err("`'abcdef'` has 6 characters; there is room for 5".to_string()));
        let large = parse("70000", ValueType::of(AssertType::Signed(16)));
        assert_eq!(large, Err("`70000` does not fit into INT, which goes from -32768 to 32767".to_string()));
    }

    #[test]
    fn types_have_names() {
        assert_eq!(from_word("tod"), Ok(AssertType::TimeOfDay));
        assert_eq!(name(AssertType::TimeOfDay), "TIME_OF_DAY");
        assert!(from_word("T").is_err());
    }
}
