//! Whole numbers.

/// Why a text is not a number of its base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The base is not 2, 8 or 16.
    Base,
    /// A character that is not a digit of the base.
    Digit(char),
    /// No digit at all.
    Empty,
    /// More than 64 bits.
    Large,
}

/// A number that is written with its base: `16`, `FF`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Based {
    pub value: u64,
    /// 2, 8 or 16.
    pub radix: u32,
    /// Number of digits in the text, with leading zeros.
    pub digits: u32,
}

/// Reads `digits` in `base`, `_` between them allowed.
pub fn based(base: &str, digits: &str) -> Result<Based, Fault> {
    let radix = match base {
        "2" => 2,
        "8" => 8,
        "16" => 16,
        _ => return Err(Fault::Base),
    };
    let (mut value, mut count) = (0u64, 0u32);
    for digit in digits.chars().filter(|c| *c != '_') {
        let number = digit.to_digit(radix).ok_or(Fault::Digit(digit))?;
        let shifted = value.checked_mul(radix.into()).and_then(|value| value.checked_add(number.into()));
        value = shifted.ok_or(Fault::Large)?;
        count += 1;
    }
    if count == 0 { Err(Fault::Empty) } else { Ok(Based { value, radix, digits: count }) }
}

/// Reads decimal digits without a sign, `_` between them allowed. A value that exceeds every type saturates; `None`: not a number.
pub fn decimal(digits: &str) -> Option<i128> {
    if !digits.starts_with(|c: char| c.is_ascii_digit()) || digits.contains(|c: char| !c.is_ascii_digit() && c != '_') {
        return None;
    }
    let digits = digits.bytes().filter(u8::is_ascii_digit).map(|digit| i128::from(digit - b'0'));
    Some(digits.fold(0, |number: i128, digit| number.saturating_mul(10).saturating_add(digit)))
}

/// Whether a decimal number such as `0.5` or `1e-50` has a digit that is not 0 before its exponent.
pub fn is_not_zero(number: &str) -> bool {
    let digits = number.split(['e', 'E']).next().unwrap_or_default();
    digits.bytes().any(|digit| matches!(digit, b'1'..=b'9'))
}

/// As [`decimal`], with a sign or without.
pub fn integer(text: &str) -> Option<i128> {
    match text.strip_prefix('-') {
        Some(digits) => decimal(digits.trim_start()).map(|number| -number),
        None => decimal(text.strip_prefix('+').unwrap_or(text).trim_start()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases() {
        assert_eq!(based("16", "00_fF"), Ok(Based { value: 255, radix: 16, digits: 4 }));
        assert_eq!(based("2", "1010").map(|number| number.value), Ok(10));
        assert_eq!(based("8", "17").map(|number| number.value), Ok(15));
        assert_eq!(based("16", "FFFF_FFFF_FFFF_FFFF").map(|number| number.value), Ok(u64::MAX));
        assert_eq!(based("16", "1_0000_0000_0000_0000"), Err(Fault::Large));
        assert_eq!(based("2", "12"), Err(Fault::Digit('2')));
        assert_eq!(based("16", "_"), Err(Fault::Empty));
        assert_eq!(based("10", "1"), Err(Fault::Base));
    }

    #[test]
    fn integers() {
        for (text, number) in [("0", 0), ("-5", -5), ("+1_000", 1000), ("- 7", -7)] {
            assert_eq!(integer(text), Some(number), "{text}");
        }
        for text in ["", "-", "_1", "1.5", "--1", "0x1", "1e3"] {
            assert_eq!(integer(text), None, "{text}");
        }
        assert!(integer(&"9".repeat(60)).is_some_and(|number| number > i128::from(u64::MAX)));
    }
}
