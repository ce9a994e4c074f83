//! Integers, bit strings, counters and REAL.

use plcc_literal::number::{self, Fault};

use super::{Literal, LiteralError};

/// What to write for a number that is too close to 0.
const SMALLEST: &str = "write `0.0`, or a number of 1.175495e-38 or more";

/// `930`, `-5`, `1.5`, `1e3`.
pub fn plain(text: &str) -> Result<Literal, LiteralError> {
    if text.contains(['.', 'e', 'E']) {
        real(text, text).map(Literal::Real)
    } else {
        integer(text, text).map(Literal::Int)
    }
}

/// `16#FF`, `2#1010`, `8#17`.
pub fn based(text: &str, base: &str, value: &str) -> Result<Literal, LiteralError> {
    let (value, digits) = base_digits(text, base, value)?;
    Ok(Literal::Bits { value, digits })
}

/// `B#16#1E`, `B#(1,8)`, `B#(1,14,100,120)`.
pub fn byte(text: &str, value: &str) -> Result<Literal, LiteralError> {
    if let Some(list) = value.trim_start().strip_prefix('(') {
        let Some(list) = list.trim_end().strip_suffix(')') else {
            return Err(LiteralError::malformed(text, "`)` is missing", "write the bytes as `B#(1,8)`"));
        };
        let mut bytes = Vec::new();
        for item in list.split(',') {
            let number = integer(text, item.trim())?;
            bytes.push(u8::try_from(number).map_err(|_| {
                LiteralError::range(text, format!("{number} is not a byte"), "each byte is a decimal number 0 to 255")
            })?);
        }
        return match *bytes {
            [a, b] => Ok(Literal::Bytes2([a, b])),
            [a, b, c, d] => Ok(Literal::Bytes4([a, b, c, d])),
            _ => Err(LiteralError::malformed(
                text,
                format!("{} bytes", bytes.len()),
                "`B#(a,b)` makes a WORD of two bytes, `B#(a,b,c,d)` a DWORD of four",
            )),
        };
    }
    let bits = typed_bits(text, "B", value, 8)?;
    Ok(Literal::Byte(bits as u8))
}

pub fn word(text: &str, value: &str) -> Result<Literal, LiteralError> {
    typed_bits(text, "W", value, 16).map(|bits| Literal::Word(bits as u16))
}

pub fn dword(text: &str, value: &str) -> Result<Literal, LiteralError> {
    typed_bits(text, "DW", value, 32).map(Literal::Dword)
}

/// `L#-7`; `L#16#FF` is read as its bits.
pub fn dint(text: &str, value: &str) -> Result<Literal, LiteralError> {
    if let Some((base, digits)) = value.split_once('#') {
        return base_digits(text, base, digits).map(|(bits, _)| Literal::Dint(bits as i32));
    }
    let number = integer(text, value)?;
    i32::try_from(number)
        .map(Literal::Dint)
        .map_err(|_| LiteralError::range(text, "not a DINT", "a DINT is a number from L#-2147483648 to L#2147483647"))
}

pub fn int(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let number = integer(text, value)?;
    i16::try_from(number)
        .map(|number| Literal::Int(number.into()))
        .map_err(|_| LiteralError::range(text, "not an INT", "an INT is a number from -32768 to 32767"))
}

/// `UINT#40000`, `USINT#16#FF`: a number of a type whose values go from `low` to `high`.
pub fn whole(text: &str, value: &str, low: i64, high: i64) -> Result<Literal, LiteralError> {
    let number = match value.split_once('#') {
        Some((base, digits)) => i64::from(base_digits(text, base, digits)?.0),
        None => integer(text, value)?,
    };
    match (low..=high).contains(&number) {
        true => Ok(Literal::Int(number)),
        false => {
            Err(LiteralError::range(text, "not a number of this type", format!("its numbers go from {low} to {high}")))
        }
    }
}

pub fn typed_real(text: &str, value: &str) -> Result<Literal, LiteralError> {
    real(text, value).map(Literal::Real)
}

pub fn typed_bool(text: &str, value: &str) -> Result<Literal, LiteralError> {
    match value.to_ascii_uppercase().as_str() {
        "TRUE" | "1" => Ok(Literal::Bool(true)),
        "FALSE" | "0" => Ok(Literal::Bool(false)),
        _ => Err(LiteralError::malformed(text, "not a BOOL", "write `TRUE` or `FALSE`")),
    }
}

/// `C#20`: three BCD digits.
pub fn counter(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let number = integer(text, value)?;
    if !(0..=999).contains(&number) {
        return Err(LiteralError::range(text, "not a counter value", "a counter counts from C#0 to C#999"));
    }
    let number = number as u16;
    Ok(Literal::Counter((number / 100) << 8 | (number / 10 % 10) << 4 | (number % 10)))
}

/// The bits after `B#`, `W#`, `DW#`, which have their own base: `W#16#FF`, `W#2#1`.
fn typed_bits(text: &str, prefix: &str, value: &str, width: u32) -> Result<u32, LiteralError> {
    let Some((base, digits)) = value.split_once('#') else {
        let help = if value.is_empty() {
            format!("write the value after it, e.g. `{prefix}#16#{}`", "0".repeat(width as usize / 4))
        } else {
            format!("write `{prefix}#16#{value}`")
        };
        return Err(LiteralError::malformed(text, "the base is missing", help));
    };
    let (bits, _) = base_digits(text, base, digits)?;
    if width < 32 && bits >> width != 0 {
        return Err(LiteralError::range(
            text,
            format!("more than {width} bits"),
            format!("the largest value is {prefix}#16#{}", "F".repeat(width as usize / 4)),
        ));
    }
    Ok(bits)
}

/// Value and number of bits written: each digit counts, leading zeros too.
fn base_digits(text: &str, base: &str, digits: &str) -> Result<(u32, u8), LiteralError> {
    let large = || LiteralError::range(text, "more than 32 bits", "a constant has 32 bits at most: `DW#16#FFFF_FFFF`");
    let number = number::based(base, digits).map_err(|fault| match fault {
        Fault::Base => LiteralError::malformed(
            text,
            format!("base `{base}`"),
            "write `16#` before hexadecimal and `2#` before binary digits",
        ),
        Fault::Digit(digit) => LiteralError::malformed(
            text,
            format!("`{digit}` is not a digit of base {base}"),
            if base == "2" { "binary digits are 0 and 1" } else { "hexadecimal digits are 0 to 9 and A to F" },
        ),
        Fault::Empty => LiteralError::malformed(text, "no digit", "write the digits after `#`"),
        Fault::Large => large(),
    })?;
    let value = u32::try_from(number.value).map_err(|_| large())?;
    Ok((value, number.digits.saturating_mul(number.radix.ilog2()).min(32) as u8))
}

/// A decimal number with sign and `_` between digits.
fn integer(text: &str, value: &str) -> Result<i64, LiteralError> {
    let Some(number) = number::integer(value) else {
        return Err(LiteralError::malformed(text, "not a decimal number", "write decimal digits, e.g. `10` or `-5`"));
    };
    i64::try_from(number).ok().filter(|number| number.abs() <= 1 << 40).ok_or_else(|| {
        LiteralError::range(text, "too large for every type", "an INT goes to 32767, a DINT (`L#`) to 2147483647")
    })
}

fn real(text: &str, value: &str) -> Result<f32, LiteralError> {
    let digits: String = value.chars().filter(|c| !matches!(c, '_' | ' ' | '\t')).collect();
    let number: f32 =
        digits.parse().map_err(|_| LiteralError::malformed(text, "not a REAL", "write a REAL as `1.5` or `1.5e+3`"))?;
    if !number.is_finite() || !digits.contains(|c: char| c.is_ascii_digit()) {
        return Err(LiteralError::range(text, "not a REAL", "a REAL is a number from -3.402823e+38 to 3.402823e+38"));
    }
    if number == 0.0 && number::is_not_zero(&digits) {
        return Err(LiteralError::range(text, "closer to 0 than any REAL", SMALLEST));
    }
    Ok(number)
}
