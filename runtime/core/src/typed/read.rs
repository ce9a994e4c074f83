//! Reads values as a user writes them.

use plcc_abi::image::AssertType;
use plcc_literal::calendar::{Clock, Date};
use plcc_literal::duration::{self, Fraction, Smallest};
use plcc_literal::number;

use super::characters::{characters, expanded, quoted};
use super::meant::{example, meant};
use super::{ValueType, WORDS, bits, name};
use crate::assertion::Value;
use crate::{bcd, datetime};

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
            match ty {
                AssertType::S5Time => {
                    let ms = u64::try_from(ns / 1_000_000).ok();
                    let found = ms.and_then(bcd::s5_from_ms).map(|value| Value::Bits(value.into()));
                    found.ok_or_else(|| outside(text, ty, [0, 0x3999]))
                }
                AssertType::Time => {
                    let ends = [i32::MIN, i32::MAX].map(|end| u64::from(end as u32));
                    let ms = i32::try_from(ns / 1_000_000);
                    ms.map(|ms| Value::Bits(u64::from(ms as u32))).map_err(|_| outside(text, ty, ends))
                }
                _ => {
                    let ends = [i64::MIN, i64::MAX].map(|end| end as u64);
                    i64::try_from(ns).map(|ns| Value::Bits(ns as u64)).map_err(|_| outside(text, ty, ends))
                }
            }
        }
        AssertType::Date => {
            let days = Date::parse(body).filter(|_| is_own).and_then(|date| date.days_since(1990)).ok_or_else(wrong)?;
            match days > u32::from(datetime::DATE_MAX) {
                true => Err(outside(text, ty, [0, datetime::DATE_MAX.into()])),
                false => Ok(Value::Bits(days.into())),
            }
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

/// That a value is not between the ends of its type.
fn outside(text: &str, ty: AssertType, ends: [u64; 2]) -> String {
    let [low, high] = ends.map(|bits| Value::Bits(bits).typed_text(ty));
    format!("`{text}` does not fit into {}, which goes from {low} to {high}", name(ty))
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
        for (text, ty, ends) in [
            ("D#2169-01-01", AssertType::Date, "DATE, which goes from D#1990-01-01 to D#2168-12-31"),
            ("S5T#3h", AssertType::S5Time, "S5TIME, which goes from S5T#0ms to S5T#2h46m30s"),
            ("T#30d", AssertType::Time, "TIME, which goes from T#-24d20h31m23s648ms to T#24d20h31m23s647ms"),
        ] {
            assert_eq!(parse(text, ValueType::of(ty)), Err(format!("`{text}` does not fit into {ends}")));
        }
        assert_eq!(parse("D#2168-12-31", ValueType::of(AssertType::Date)), Ok(Value::Bits(65_378)));
        let large = parse("70000", ValueType::of(AssertType::Signed(16)));
        assert_eq!(large, Err("`70000` does not fit into INT, which goes from -32768 to 32767".to_string()));
    }
}
