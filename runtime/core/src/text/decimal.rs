//! Integers as decimal text, and back. Source: STL reference, IEC function library; S7-1200 reference, string conversion.

use plcc_abi::text::{PLUS, UNSIGNED};

use super::Text;
use crate::memory::Bytes;

/// The numbers 0 to 99 with two digits.
static PAIRS: [[u8; 2]; 100] = {
    let mut pairs = [[0; 2]; 100];
    let mut number = 0;
    while number < 100 {
        pairs[number] = [b'0' + (number / 10) as u8, b'0' + (number % 10) as u8];
        number += 1;
    }
    pairs
};

/// Writes an integer of 64 bits. `form`: [`PLUS`] and [`UNSIGNED`]. False if it does not fit; then nothing is written.
pub fn write_long(memory: Bytes, bits: u64, form: u16, out: Option<Text>) -> bool {
    let negative = form & UNSIGNED == 0 && (bits as i64) < 0;
    let magnitude = if negative { bits.wrapping_neg() } else { bits };
    let digits = magnitude.checked_ilog10().map_or(1, |power| power + 1);
    place(memory, magnitude, digits, negative, form, out)
}

/// Writes a DINT, as [`write_long`].
#[inline(always)]
pub fn write(memory: Bytes, value: i32, form: u16, out: Option<Text>) -> bool {
    let magnitude = value.unsigned_abs();
    // The logarithm of 0 is not there, and it has as many digits as 1.
    place(memory, magnitude.into(), (magnitude | 1).ilog10() + 1, value < 0, form, out)
}

/// Writes the `digits` of a number where they belong, from the last one on, and the sign before them.
#[inline(always)]
fn place(memory: Bytes, magnitude: u64, digits: u32, negative: bool, form: u16, out: Option<Text>) -> bool {
    let Some(out) = out else { return false };
    let has_sign = negative || form & PLUS != 0;
    let count = digits + u32::from(has_sign);
    if count > out.maximum() {
        return false;
    }
    let start = out.start();
    let mut end = start + count;
    let mut rest = magnitude;
    // SAFETY: there is room for all characters, and `digits` is how many there are.
    unsafe {
        while rest > u64::from(u32::MAX) {
            end -= 1;
            memory.set_byte(end, b'0' + (rest % 10) as u8);
            rest /= 10;
        }
        let mut rest = rest as u32;
        while rest >= 100 {
            end -= 2;
            memory.set_word(end, u16::from_le_bytes(PAIRS[(rest % 100) as usize]));
            rest /= 100;
        }
        let pair = PAIRS[(rest % 100) as usize];
        memory.set_byte(end - 1, pair[1]);
        if rest >= 10 {
            memory.set_byte(end - 2, pair[0]);
        }
        if has_sign {
            memory.set_byte(start, if negative { b'-' } else { b'+' });
        }
    }
    out.set_length(memory, count);
    true
}

/// A sign or none, then digits only, `longest` characters at most. `None`: another form. The value is limited to `low..=high`; the second
/// result says whether it was in that range.
#[inline(always)]
pub fn read(memory: Bytes, text: Option<Text>, longest: u16, low: i32, high: i32) -> Option<(i32, bool)> {
    let value = text?.view(memory, |characters| match characters.len() <= usize::from(longest) {
        true => parse(characters),
        false => None,
    })?;
    let limited = value.clamp(i64::from(low), i64::from(high));
    Some((limited as i32, limited == value))
}

/// An optional sign, then digits only. `None`: another form, or it does not fit.
fn parse(characters: &[u8]) -> Option<i64> {
    let (negative, digits) = match characters {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] | digits => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    // Eighteen digits always fit.
    if digits.len() <= 18 {
        let mut value = 0i64;
        for digit in digits {
            let digit = digit.wrapping_sub(b'0');
            if digit > 9 {
                return None;
            }
            value = value * 10 + i64::from(digit);
        }
        return Some(if negative { -value } else { value });
    }
    digits.iter().try_fold(0i64, |value, digit| {
        let digit = i64::from(digit.checked_sub(b'0').filter(|&digit| digit < 10)?);
        value.checked_mul(10)?.checked_add(if negative { -digit } else { digit })
    })
}

/// Blanks, a sign, digits of a number without fraction and exponent, as far as a u64 holds them: what most texts are. The value, and how many
/// characters belong to it. `None`: the rules for all texts decide.
#[inline(always)]
pub fn scan(text: &[u8]) -> Option<(bool, u64, usize)> {
    let blanks = text.iter().take_while(|&&character| character == b' ').count();
    let sign = usize::from(matches!(text.get(blanks), Some(b'+' | b'-')));
    let digits = &text[blanks + sign..];
    let mut magnitude = 0u64;
    let mut count = 0;
    for digit in digits.iter().map(|character| character.wrapping_sub(b'0')).take_while(|&digit| digit < 10) {
        // Eighteen digits always fit.
        if count == 18 {
            return None;
        }
        magnitude = magnitude * 10 + u64::from(digit);
        count += 1;
    }
    // Perhaps the number goes on.
    if count == 0 || matches!(digits.get(count), Some(b'.' | b',' | b'e' | b'E')) {
        return None;
    }
    Some((text[blanks] == b'-', magnitude, blanks + sign + count))
}
