//! Integers, bit strings, BOOL and REAL.

use plcc_literal::number::{self, Fault};

use crate::elementary::{Class, Elementary};
use crate::literal::LiteralError;
use crate::scl::ast::Literal;
use crate::scl::literal::Read;

/// `930`, `1.5`, `1e3`.
pub fn plain(text: &str) -> Result<Literal, LiteralError> {
    if text.contains(['.', 'e', 'E']) {
        return real(text, text).map(Literal::Real);
    }
    let value = decimal(text, text)?;
    u64::try_from(value).map(|value| Literal::Integer { value, based: false }).map_err(|_| too_large(text))
}

/// Value and base of `16#FF`, `2#1010`, `8#17`.
pub fn based(text: &str, base: &str, digits: &str) -> Result<(u64, u32), LiteralError> {
    let number = number::based(base, digits).map_err(|fault| match fault {
        Fault::Base => {
            let help = "write `16#` before hexadecimal, `8#` before octal and `2#` before binary digits";
            LiteralError::malformed(text, format!("base `{base}`"), help)
        }
        Fault::Digit(digit) => {
            // `16#00FFH`
            if let ("16", Some(without)) = (base, digits.strip_suffix(['H', 'h']))
                && number::based(base, without).is_ok()
            {
                let written = text.strip_suffix(['H', 'h']).unwrap_or(text);
                let label = format!("`{digit}` is not a digit of base 16");
                return LiteralError::malformed(text, label, format!("write `{written}`"));
            }
            let help = match base {
                "2" => "binary digits are 0 and 1",
                "8" => "octal digits are 0 to 7",
                _ => "hexadecimal digits are 0 to 9 and A to F",
            };
            LiteralError::malformed(text, format!("`{digit}` is not a digit of base {base}"), help)
        }
        Fault::Empty => LiteralError::malformed(text, "no digit", "write the digits after `#`"),
        Fault::Large => LiteralError::range(text, "more than 64 bits", "a constant has 64 bits at most"),
    })?;
    Ok((number.value, number.radix))
}

/// The constant of type `ty` after `INT#`, `BYTE#` and similar prefixes.
pub fn typed(text: &str, ty: Elementary, value: &str) -> Result<Read, LiteralError> {
    match ty.class() {
        Class::Float => float(text, ty, value).map(Read::from),
        _ if ty == Elementary::Bool => boolean(text, value).map(Read::from),
        _ => integer(text, ty, value),
    }
}

fn integer(text: &str, ty: Elementary, value: &str) -> Result<Read, LiteralError> {
    let name = ty.name();
    let (low, high) = range(ty);
    let out_of_range = || {
        LiteralError::range(
            text,
            format!("outside the range of {name}"),
            format!("{name} is from {} to {}", shown(low), shown(high)),
        )
    };
    let (negative, unsigned) = match value.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, value.strip_prefix('+').unwrap_or(value)),
    };
    let bits_mask = if ty.bits() == 64 { u64::MAX } else { (1 << ty.bits()) - 1 };
    let (number, hexadecimal) = match unsigned.split_once('#') {
        Some((base, digits)) => (i128::from(based(text, base, digits)?.0), true),
        None => (decimal(text, unsigned)?, false),
    };
    let number = if negative { -number } else { number };
    let pattern = hexadecimal && !negative && number <= i128::from(bits_mask);
    if !pattern && !(low..=high).contains(&number) {
        return Err(out_of_range());
    }
    let bits = number as u64 & bits_mask;
    // Bits of a signed type that were written with a base may mean a negative number.
    let wrapped = (number > high).then(|| (number - (1 << ty.bits())) as i64);
    Ok(Read { value: Literal::Typed { ty, bits }, wrapped })
}

fn shown(number: i128) -> String {
    number.to_string()
}

/// The numbers of an integer or bit string.
fn range(ty: Elementary) -> (i128, i128) {
    if ty.is_signed() { (-(1 << (ty.bits() - 1)), (1 << (ty.bits() - 1)) - 1) } else { (0, (1 << ty.bits()) - 1) }
}

fn boolean(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let bits = match value.to_ascii_uppercase().as_str() {
        "TRUE" | "1" | "2#1" | "8#1" | "16#1" => 1,
        "FALSE" | "0" | "2#0" | "8#0" | "16#0" => 0,
        _ => return Err(LiteralError::malformed(text, "not a BOOL", "write `TRUE` or `FALSE`")),
    };
    Ok(Literal::Typed { ty: Elementary::Bool, bits })
}

fn float(text: &str, ty: Elementary, value: &str) -> Result<Literal, LiteralError> {
    let bits = if ty == Elementary::Real {
        let number = real(text, value)? as f32;
        if !number.is_finite() {
            return Err(LiteralError::range(
                text,
                "not a REAL",
                "a REAL is a number from -3.402823e+38 to 3.402823e+38",
            ));
        }
        // Parsed from the digits, not from the nearest LREAL.
        digits_of(value).parse::<f32>().unwrap_or(number).to_bits().into()
    } else {
        real(text, value)?.to_bits()
    };
    Ok(Literal::Typed { ty, bits })
}

fn digits_of(value: &str) -> String {
    value.chars().filter(|c| *c != '_').collect()
}

fn real(text: &str, value: &str) -> Result<f64, LiteralError> {
    let digits = digits_of(value);
    let bytes = digits.as_bytes();
    let well_formed =
        bytes.iter().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'e' | b'E' | b'+' | b'-'));
    let number: f64 = Some(&digits)
        .filter(|digits| well_formed && digits.contains(|c: char| c.is_ascii_digit()))
        .and_then(|digits| digits.parse().ok())
        .ok_or_else(|| LiteralError::malformed(text, "not a REAL", "write a REAL as `1.5` or `1.5e+3`"))?;
    if !number.is_finite() {
        return Err(LiteralError::range(
            text,
            "not a REAL",
            "an LREAL is a number from -1.797693e+308 to 1.797693e+308",
        ));
    }
    Ok(number)
}

/// A decimal number without sign.
fn decimal(text: &str, digits: &str) -> Result<i128, LiteralError> {
    let help = "write decimal digits, e.g. `10`, or a base, e.g. `16#FF`";
    number::decimal(digits).ok_or_else(|| LiteralError::malformed(text, "not a whole number", help))
}

fn too_large(text: &str) -> LiteralError {
    LiteralError::range(text, "too large for every type", "the largest whole number is 18446744073709551615")
}
