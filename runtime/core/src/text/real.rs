//! REAL as text, and back, for the numbers that programs have: exact results by integers of 128 bits, or none at all. Then the library of the
//! language does it, which is slower and right for all numbers.

/// Digits of a REAL in its scientific form.
const DIGITS: i32 = 8;
/// The least integer with so many digits.
const LEAST: u128 = 10u128.pow(DIGITS as u32 - 1);

/// The powers of ten that fit beside 24 bits of a REAL.
static POWERS: [u128; 32] = {
    let mut powers = [1; 32];
    let mut exponent = 1;
    while exponent < 32 {
        powers[exponent] = powers[exponent - 1] * 10;
        exponent += 1;
    }
    powers
};

/// The powers of ten that an LREAL holds exactly.
static EXACT: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// `+1.2345678E+01`, rounded to the nearest, a tie to the even digit; a negative zero has `+`. `None`: the number is not finite, or
/// below 1E-23 or so.
pub fn scientific(value: f32) -> Option<[u8; 14]> {
    let (mut digits, exponent) = if value == 0.0 { (0, 0) } else { rounded(value)? };
    let mut text = *b"+0.0000000E+00";
    if value < 0.0 {
        text[0] = b'-';
    }
    for place in text[3..10].iter_mut().rev() {
        *place += (digits % 10) as u8;
        digits /= 10;
    }
    text[1] += digits as u8;
    if exponent < 0 {
        text[11] = b'-';
    }
    let exponent = exponent.unsigned_abs() as u8;
    text[12] += exponent / 10;
    text[13] += exponent % 10;
    Some(text)
}

/// The first digits of a number that is not 0 as an integer, and its decimal exponent.
fn rounded(value: f32) -> Option<(u32, i32)> {
    let bits = value.to_bits();
    let (fraction, biased) = (bits & 0x7F_FFFF, (bits >> 23 & 0xFF) as i32);
    let (mantissa, shift) = match biased {
        255 => return None,
        0 => (fraction, -149),
        _ => (fraction | 0x80_0000, biased - 150),
    };
    // The exponent to base 2 times log10(2), rounded down: the decimal exponent, or one less.
    let mut exponent = ((mantissa.ilog2() as i32 + shift) * 78_913) >> 18;
    let mut scaled = Scaled::of(mantissa.into(), shift, DIGITS - 1 - exponent)?;
    if scaled.whole >= 10 * LEAST {
        exponent += 1;
        scaled = Scaled::of(mantissa.into(), shift, DIGITS - 1 - exponent)?;
    }
    let digits = scaled.rounded();
    if digits == 10 * LEAST {
        return Some((LEAST as u32, exponent + 1));
    }
    Some((digits as u32, exponent))
}

/// A number as its whole part and how the rest compares with a half.
struct Scaled {
    whole: u128,
    rest: std::cmp::Ordering,
}

impl Scaled {
    /// `mantissa`, which has 24 bits, times two to the power `shift`, times ten to the power `decimal`.
    fn of(mantissa: u128, shift: i32, decimal: i32) -> Option<Scaled> {
        let power = *POWERS.get(decimal.unsigned_abs() as usize)?;
        // A REAL of 24 bits from the bit 2^127 down; with a fraction it is small enough for every power.
        let (dividend, divisor) = match (shift >= 0, decimal >= 0) {
            (true, true) => return Some(Scaled { whole: (mantissa << shift) * power, rest: std::cmp::Ordering::Less }),
            (true, false) => (mantissa << shift, power),
            (false, true) => {
                let product = mantissa * power;
                let places = shift.unsigned_abs();
                // All of a product below a half is rest.
                if places > 127 {
                    return None;
                }
                let rest = product & ((1 << places) - 1);
                return Some(Scaled { whole: product >> places, rest: rest.cmp(&(1 << (places - 1))) });
            }
            (false, false) => return None,
        };
        let (whole, rest) = match (u64::try_from(dividend), u64::try_from(divisor)) {
            (Ok(dividend), Ok(divisor)) => (u128::from(dividend / divisor), u128::from(dividend % divisor)),
            _ => (dividend / divisor, dividend % divisor),
        };
        Some(Scaled { whole, rest: rest.cmp(&(divisor - rest)) })
    }

    /// To the nearest, a tie to the even number.
    fn rounded(self) -> u128 {
        match self.rest {
            std::cmp::Ordering::Less => self.whole,
            std::cmp::Ordering::Equal => self.whole + (self.whole & 1),
            std::cmp::Ordering::Greater => self.whole + 1,
        }
    }
}

/// The REAL nearest to a number of the form `-12.5E-3`, where sign, point and exponent may be missing. `None`: another form, more than 15
/// digits, an exponent that an LREAL has no exact power of ten for, or a number so near to the middle of two REALs that it takes more digits to decide.
pub fn parse(text: &[u8]) -> Option<f32> {
    let (negative, text) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] | rest => (false, rest),
    };
    let (mut mantissa, mut digits, mut places, mut point) = (0u64, 0, 0i32, false);
    let mut at = 0;
    while let Some(&character) = text.get(at) {
        match character {
            b'0'..=b'9' => {
                mantissa = mantissa * 10 + u64::from(character - b'0');
                digits += 1;
                places += i32::from(point);
                if digits > 15 {
                    return None;
                }
            }
            b'.' if !point => point = true,
            _ => break,
        }
        at += 1;
    }
    let exponent = match &text[at..] {
        [] => 0,
        [b'e' | b'E', rest @ ..] => small_integer(rest)?,
        _ => return None,
    };
    if digits == 0 {
        return None;
    }
    let exponent = exponent - places;
    let power = *EXACT.get(exponent.unsigned_abs() as usize)?;
    // Both are exact, so this is rounded once.
    let value = if exponent < 0 { mantissa as f64 / power } else { mantissa as f64 * power };
    // Bits that a REAL does not have. Near their middle the first rounding may have decided the second.
    let beyond = value.to_bits() & 0x1FFF_FFFF;
    if beyond.abs_diff(0x1000_0000) <= 1 {
        return None;
    }
    Some(if negative { -(value as f32) } else { value as f32 })
}

/// An exponent of at most two digits.
fn small_integer(text: &[u8]) -> Option<i32> {
    let (negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] | rest => (false, rest),
    };
    let digit = |character: &u8| character.is_ascii_digit().then(|| i32::from(character - b'0'));
    let value = match digits {
        [one] => digit(one)?,
        [ten, one] => digit(ten)? * 10 + digit(one)?,
        _ => return None,
    };
    Some(if negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of all sizes, and those whose digits end in a tie.
    fn numbers() -> impl Iterator<Item = f32> {
        let spread = (0..=u32::MAX).step_by(9973).map(f32::from_bits);
        let ties = (0..4_000_000u32).step_by(7).flat_map(|n| [n as f32 / 8.0, n as f32 / 1024.0, n as f32 * 1024.0]);
        spread.chain(ties).chain([0.0, -0.0, f32::MIN_POSITIVE, f32::MAX, 9.999_999, 99_999_995.0])
    }

    #[test]
    fn digits_are_those_of_the_language() {
        let mut done = 0;
        for value in numbers() {
            let Some(found) = scientific(value) else { continue };
            done += 1;
            let text = format!("{:+.7e}", if value == 0.0 { 0.0 } else { value });
            let (mantissa, exponent) = text.split_once('e').unwrap();
            let exponent: i32 = exponent.parse().unwrap();
            let sign = if exponent < 0 { '-' } else { '+' };
            assert_eq!(std::str::from_utf8(&found).unwrap(), format!("{mantissa}E{sign}{:02}", exponent.abs()));
        }
        assert!(done > 1_500_000);
    }

    #[test]
    fn numbers_are_those_of_the_language() {
        let mut done = 0;
        for value in numbers().filter(|value| value.is_finite()) {
            for text in [format!("{value:.7e}"), format!("{value:.3}"), format!("{value}")] {
                let Some(found) = parse(text.as_bytes()) else { continue };
                done += 1;
                assert_eq!(found.to_bits(), text.parse::<f32>().unwrap().to_bits(), "{text}");
            }
        }
        assert!(done > 1_500_000);
        for text in ["", "-", ".", "1e", "1e+", "1x", "1.2.3", "1e123", "+-1", "1234567890123456"] {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
        assert_eq!(parse(b"+1.5E+01"), Some(15.0));
        assert_eq!(parse(b"5."), Some(5.0));
    }
}
