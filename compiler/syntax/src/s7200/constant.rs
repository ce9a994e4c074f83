//! Constants: `100`, `16#7FFF`, `W#16#10`, `1.5`, texts with their escapes.
//!
//! Source: S7-200 system manual, specifying a constant value.

use plcc_abi::s7200::timer_resolution;
use plcc_literal::duration::{self, Fraction, Smallest};
use plcc_literal::number::{self, Fault};

use crate::ast::Width;
use crate::literal::windows_1252;

/// The longest time of a timer. Source: S7-200 system manual, timer instructions.
const STEPS_MAX: i128 = 32767;

/// Why a constant cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConstantError {
    /// Its value is too large; otherwise its form is wrong.
    pub range: bool,
    pub label: String,
    pub help: String,
}

fn malformed(label: impl Into<String>, help: impl Into<String>) -> ConstantError {
    ConstantError { range: false, label: label.into(), help: help.into() }
}

fn too_large(label: impl Into<String>, help: impl Into<String>) -> ConstantError {
    ConstantError { range: true, label: label.into(), help: help.into() }
}

/// `100`, with `_` between digits.
pub fn integer(text: &str) -> Result<i64, ConstantError> {
    let value = number::decimal(text).filter(|value| *value <= i128::from(u32::MAX));
    value
        .map(|value| value as i64)
        .ok_or_else(|| too_large("needs more than 32 bits", "constants go from -2147483648 to 4294967295"))
}

/// `1.5`, `2.5E-3`.
pub fn real(text: &str) -> Result<f32, ConstantError> {
    let digits: String = text.chars().filter(|c| *c != '_').collect();
    match digits.parse::<f32>() {
        Ok(value) if value == 0.0 && number::is_not_zero(&digits) => {
            Err(malformed("is closer to 0 than any REAL", "write `0.0`, or a number of 1.175495E-38 or more"))
        }
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => {
            Err(too_large("is outside the range of REAL", "a REAL is a number from -3.402823E+38 to +3.402823E+38"))
        }
        Err(_) => Err(malformed("is not a REAL", "write it as `1.5` or `2.5E-3`")),
    }
}

/// `16#7FFF`, `2#1010`, `W#16#10`, `BYTE#3`. `timer`: the number of the timer whose time it may be.
pub fn based(text: &str, timer: Option<u8>) -> Result<(u32, Option<Width>), ConstantError> {
    let Some((prefix, rest)) = text.split_once('#') else {
        return Err(malformed("is not a constant", "write it as `16#7FFF`"));
    };
    if prefix.bytes().all(|byte| byte.is_ascii_digit()) {
        return Ok((digits(prefix, rest)?, None));
    }
    let width = match prefix.to_ascii_uppercase().as_str() {
        "B" | "BYTE" => Width::Byte,
        "W" | "WORD" | "INT" => Width::Word,
        "D" | "DW" | "DWORD" | "DINT" => Width::Dword,
        "T" | "TIME" | "S5T" | "S5TIME" => {
            let help = steps(rest, timer)
                .unwrap_or_else(|| "a timer counts steps of 1, 10 or 100 ms, as its number says".to_string());
            return Err(malformed("the S7-200 has no constants of time", help));
        }
        _ => {
            let help = "types of constants are `B#`, `W#`, `DW#`, `BYTE#`, `WORD#` and `DWORD#`";
            return Err(malformed(format!("`{prefix}#` is not a type of a constant"), help));
        }
    };
    let (negative, rest) = match rest.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, rest.strip_prefix('+').unwrap_or(rest)),
    };
    let value = match rest.split_once('#') {
        Some((base, rest)) => digits(base, rest)?,
        None => digits("10", rest)?,
    };
    let limit = if negative { 1u64 << (width.bits() - 1) } else { (1u64 << width.bits()) - 1 };
    if u64::from(value) > limit {
        return Err(too_large(
            format!("does not fit into {} bits", width.bits()),
            "use a smaller value or a wider type: `B#` 8, `W#` 16, `DW#` 32 bits",
        ));
    }
    let mask = u32::MAX >> (32 - width.bits());
    Ok((if negative { value.wrapping_neg() & mask } else { value }, Some(width)))
}

fn digits(base: &str, text: &str) -> Result<u32, ConstantError> {
    let help = "write `16#7FFF` or `2#0101`";
    let read = match base {
        "10" => {
            number::decimal(text).map(|value| u32::try_from(value).map_err(|_| Fault::Large)).unwrap_or_else(|| {
                Err(text.chars().find(|c| !c.is_ascii_digit() && *c != '_').map_or(Fault::Empty, Fault::Digit))
            })
        }
        _ => number::based(base, text).and_then(|number| u32::try_from(number.value).map_err(|_| Fault::Large)),
    };
    read.map_err(|fault| match fault {
        Fault::Base => malformed(format!("{base} is not a base of a constant"), help),
        Fault::Digit(digit) => malformed(format!("`{digit}` is not a digit of base {base}"), help),
        Fault::Empty => malformed(format!("no digit follows `{base}#`"), "write e.g. `16#7FFF`"),
        Fault::Large => too_large("needs more than 32 bits", "a double word goes up to `16#FFFFFFFF`"),
    })
}

/// Bytes of a text without its quotes, escapes expanded: `$$ $' $" $L $N $P $R $T $hh`.
pub fn text(inner: &str) -> Result<Vec<u8>, ConstantError> {
    let mut bytes = Vec::with_capacity(inner.len());
    let mut chars = inner.chars();
    while let Some(c) = chars.next() {
        if c != '$' {
            push(&mut bytes, c);
            continue;
        }
        let escape = chars.next();
        let byte = match escape {
            Some(c @ ('$' | '\'' | '"')) => c as u8,
            Some('L' | 'l' | 'N' | 'n') => 10,
            Some('P' | 'p') => 12,
            Some('R' | 'r') => 13,
            Some('T' | 't') => 9,
            _ => {
                let high = escape.and_then(|high| high.to_digit(16));
                let low = chars.next().and_then(|low| low.to_digit(16));
                match (high, low) {
                    (Some(high), Some(low)) => (high * 16 + low) as u8,
                    _ => {
                        let shown = escape.map(String::from).unwrap_or_default();
                        let help = "escapes are `$$ $' $\" $L $N $P $R $T` and `$hh` with two hexadecimal digits";
                        return Err(malformed(format!("`${shown}` is not an escape"), help));
                    }
                }
            }
        };
        bytes.push(byte);
    }
    Ok(bytes)
}

/// A character in the code page of the text: Western, else Cyrillic, Chinese; the last resort is UTF-8.
fn push(bytes: &mut Vec<u8>, c: char) {
    if let Some(byte) = windows_1252(c) {
        return bytes.push(byte);
    }
    let mut buffer = [0; 4];
    let text: &str = c.encode_utf8(&mut buffer);
    for page in [encoding_rs::WINDOWS_1251, encoding_rs::GBK] {
        let (encoded, _, unmappable) = page.encode(text);
        if !unmappable {
            return bytes.extend_from_slice(&encoded);
        }
    }
    bytes.extend_from_slice(text.as_bytes());
}

/// Whether a text between double quotes can be a symbol: letters, digits, `_`, no digit first, 1 to 23 characters.
pub fn is_symbol(inner: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '_' || !c.is_ascii() && c != '\u{A0}';
    inner.chars().all(letter)
        && (1..=23).contains(&inner.chars().count())
        && !inner.starts_with(|c: char| c.is_ascii_digit())
}

/// How many steps of a timer a time such as `5s` is, as help.
pub fn steps(text: &str, timer: Option<u8>) -> Option<String> {
    let time = duration::nanoseconds(text, Smallest::Nanosecond, Fraction::Anywhere).ok()?;
    if let Some(number) = timer {
        let step_ms = timer_resolution(number).milliseconds();
        let step = i128::from(step_ms) * 1_000_000;
        let (steps, rest) = (time / step, time % step);
        let what = match (steps, rest) {
            (0..=STEPS_MAX, 0) => format!("write `{steps}`"),
            (0..STEPS_MAX, _) => format!("{text} are between {steps} and {} steps", steps + 1),
            _ => format!("{text} are more than the {STEPS_MAX} steps that it has"),
        };
        return Some(format!("T{number} counts steps of {step_ms} ms: {what}"));
    }
    let [one, ten, hundred] = [1, 10, 100].map(|ms| (time / (ms * 1_000_000)).to_string());
    Some(format!(
        "a timer counts steps of 1, 10 or 100 ms, as its number says: {text} are {one}, {ten} or {hundred} steps"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        assert_eq!(integer("1_000"), Ok(1000));
        assert_eq!(integer("4294967295"), Ok(4_294_967_295));
        assert!(integer("4294967296").unwrap_err().range);
        assert_eq!(based("16#DEAD_BEEF", None), Ok((0xDEAD_BEEF, None)));
        assert_eq!(based("2#1010_0101", None), Ok((0xA5, None)));
        assert_eq!(based("B#16#FF", None), Ok((0xFF, Some(Width::Byte))));
        assert_eq!(based("byte#-1", None), Ok((0xFF, Some(Width::Byte))));
        assert_eq!(based("DW#-2147483648", None), Ok((0x8000_0000, Some(Width::Dword))));
        assert!(based("B#256", None).unwrap_err().range);
        assert!(based("W#-32769", None).unwrap_err().range);
        assert!(!based("2#2", None).unwrap_err().range);
        assert!(!based("16#", None).unwrap_err().range);
        assert!(!based("T#5s", None).unwrap_err().range);
        assert_eq!(real("2.5E-3"), Ok(0.0025));
        assert!(real("1.0E39").unwrap_err().range);
        assert_eq!(real("0.0E-50"), Ok(0.0));
        assert!(real("1.0E-50").is_err());
    }

    #[test]
    fn times_are_steps_of_their_timer() {
        let help = |text, timer| steps(text, timer).unwrap();
        assert_eq!(help("5s", Some(37)), "T37 counts steps of 100 ms: write `50`");
        assert_eq!(help("5s", Some(32)), "T32 counts steps of 1 ms: write `5000`");
        assert_eq!(help("250ms", Some(37)), "T37 counts steps of 100 ms: 250ms are between 2 and 3 steps");
        assert_eq!(help("1h", Some(33)), "T33 counts steps of 10 ms: 1h are more than the 32767 steps that it has");
        assert!(help("5s", None).ends_with("5s are 5000, 500 or 50 steps"));
        assert_eq!(steps("5x", Some(37)), None);
    }

    #[test]
    fn texts() {
        assert_eq!(text("a$$$41$n$'$\""), Ok(b"a$A\n'\"".to_vec()));
        assert_eq!(text("é"), Ok(vec![0xE9]));
        // GBK of U+6CF5.
        assert_eq!(text("泵"), Ok(vec![0xB1, 0xC3]));
        assert!(text("$x").is_err());
        assert!(text("$").is_err());
        assert!(is_symbol("Motor_1") && is_symbol("水泵") && !is_symbol("12 kg") && !is_symbol("1a") && !is_symbol(""));
        assert!(!is_symbol("a23456789012345678901234"));
    }
}
