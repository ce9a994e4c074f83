//! Integers as decimal text, and back. Source: STL reference, IEC function library; S7-1200 reference, string conversion.

use plcc_abi::text::{PLUS, UNSIGNED};

use super::{Text, give_whole};
use crate::memory::Bytes;

/// Digits of a u64, and a sign.
const DIGITS_MAX: usize = 21;

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
    let mut magnitude = if negative { bits.wrapping_neg() } else { bits };
    let mut characters = [0; DIGITS_MAX];
    let mut start = DIGITS_MAX;
    while magnitude > u64::from(u32::MAX) {
        start -= 1;
        characters[start] = b'0' + (magnitude % 10) as u8;
        magnitude /= 10;
    }
    finish(memory, magnitude as u32, negative, form, &mut characters, start, out)
}

/// Writes a DINT, as [`write_long`].
#[inline(always)]
pub fn write(memory: Bytes, value: i32, form: u16, out: Option<Text>) -> bool {
    let mut characters = [0; DIGITS_MAX];
    finish(memory, value.unsigned_abs(), value < 0, form, &mut characters, DIGITS_MAX, out)
}

/// Puts the digits of `rest` and the sign before the `characters` from `start` on, and writes all.
#[inline(always)]
fn finish(
    memory: Bytes,
    mut rest: u32,
    negative: bool,
    form: u16,
    characters: &mut [u8; DIGITS_MAX],
    start: usize,
    out: Option<Text>,
) -> bool {
    // No number has more digits; the limits spare checks.
    let mut start = start.min(DIGITS_MAX);
    while rest >= 100 && start >= 3 {
        start -= 2;
        characters[start..start + 2].copy_from_slice(&PAIRS[(rest % 100) as usize]);
        rest /= 100;
    }
    let pair = PAIRS[(rest % 100) as usize];
    start = start.max(3) - 1;
    characters[start] = pair[1];
    if rest >= 10 {
        start -= 1;
        characters[start] = pair[0];
    }
    if negative || form & PLUS != 0 {
        start -= 1;
        characters[start] = if negative { b'-' } else { b'+' };
    }
    give_whole(memory, out, &characters[start..])
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
