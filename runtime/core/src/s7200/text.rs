//! Numbers to text and back. Source: S7-200 system manual, ASCII and string conversion instructions.

use plcc_abi::s7200::error;

use super::{Operands, access, done, failed, failed_quietly, set_special, sm1, strings, value};
use crate::cpu::Cpu;

/// Most digits after the separator.
const DECIMALS_MAX: u32 = 5;
/// Characters of an INT and of a DINT.
const INT_LENGTH: u32 = 8;
const DINT_LENGTH: u32 = 12;
/// Digits of a REAL that are shown; the later ones are 0.
const SIGNIFICANT_DIGITS: u32 = 7;

/// How a number is written.
#[derive(Clone, Copy)]
struct Format {
    decimals: u32,
    separator: u8,
}

impl Format {
    /// Bits 0 to 2: digits after the separator; bit 3: comma. `None`: too many digits.
    fn of(bits: u32) -> Option<Format> {
        let (decimals, separator) = (bits & 7, if bits & 8 != 0 { b',' } else { b'.' });
        (decimals <= DECIMALS_MAX).then_some(Format { decimals, separator })
    }
}

/// A number in the text: `magnitude` / 10^decimals.
struct Scaled {
    negative: bool,
    magnitude: u128,
}

pub(super) fn int_to_ascii(cpu: &Cpu, operands: &Operands) -> u64 {
    write_integer(cpu, operands, i64::from(operands.a as u16 as i16), INT_LENGTH, false)
}

pub(super) fn dint_to_ascii(cpu: &Cpu, operands: &Operands) -> u64 {
    write_integer(cpu, operands, i64::from(operands.a as i32), DINT_LENGTH, false)
}

pub(super) fn real_to_ascii(cpu: &Cpu, operands: &Operands) -> u64 {
    write_real(cpu, operands, false)
}

pub(super) fn int_to_string(cpu: &Cpu, operands: &Operands) -> u64 {
    write_integer(cpu, operands, i64::from(operands.a as u16 as i16), INT_LENGTH, true)
}

pub(super) fn dint_to_string(cpu: &Cpu, operands: &Operands) -> u64 {
    write_integer(cpu, operands, i64::from(operands.a as i32), DINT_LENGTH, true)
}

pub(super) fn real_to_string(cpu: &Cpu, operands: &Operands) -> u64 {
    write_real(cpu, operands, true)
}

fn write_integer(cpu: &Cpu, operands: &Operands, number: i64, length: u32, string: bool) -> u64 {
    let format = Format::of(operands.c).filter(|_| operands.c & 0xF0 == 0);
    let scaled = Scaled { negative: number < 0, magnitude: u128::from(number.unsigned_abs()) };
    write_text(cpu, operands, length, string, format.map(|format| (scaled, format)))
}

/// Bits 4 to 7 of the format are the length of the text, with room for sign, digit and separator.
fn write_real(cpu: &Cpu, operands: &Operands, string: bool) -> u64 {
    let length = operands.c >> 4 & 0xF;
    let format = Format::of(operands.c).filter(|format| length >= format.decimals + 3);
    let number = format.and_then(|format| Some((scaled(f32::from_bits(operands.a), format.decimals)?, format)));
    write_text(cpu, operands, length, string, number)
}

/// Writes the text to the address `b`, for a string with its length before it. Blanks if there is no number or no room for it.
fn write_text(cpu: &Cpu, operands: &Operands, length: u32, string: bool, number: Option<(Scaled, Format)>) -> u64 {
    let (address, head) = (operands.b, u32::from(string));
    if !access::inside(cpu, address, head + length) {
        return failed(cpu, operands, error::RANGE);
    }
    let mut text = [0u8; 15];
    let text = text.get_mut(..length as usize).unwrap_or_default();
    let written = number.is_some_and(|(scaled, format)| put_number(text, &scaled, format));
    if !written {
        text.fill(b' ');
    }
    if string {
        cpu.memory.set_byte(address, length as u8);
    }
    cpu.memory.load(address + head, text);
    access::after_write(cpu, address, head + length);
    if written { done() } else { failed_quietly() }
}

/// Writes a number to the right of `text`, blanks before it. False: no room.
fn put_number(text: &mut [u8], number: &Scaled, format: Format) -> bool {
    let mut places = text.iter_mut().rev();
    let mut put = |character: u8| places.next().map(|place| *place = character).is_some();
    let (mut rest, mut digits) = (number.magnitude, 0);
    while rest != 0 || digits <= format.decimals {
        if digits == format.decimals && digits != 0 && !put(format.separator) {
            return false;
        }
        if !put(b'0' + (rest % 10) as u8) {
            return false;
        }
        rest /= 10;
        digits += 1;
    }
    if number.negative && number.magnitude != 0 && !put(b'-') {
        return false;
    }
    places.for_each(|place| *place = b' ');
    true
}

/// `number` times 10^decimals, rounded half away from zero to an integer, and to seven digits that may differ from 0.
/// `None`: no number, or longer than any text. The value counts, not its shortest decimal form: 0.35 is 0.3499999940395355.
fn scaled(number: f32, decimals: u32) -> Option<Scaled> {
    let magnitude = number.abs();
    if !magnitude.is_finite() || magnitude >= 1e15 {
        return None;
    }
    // |number| = mantissa × 2^exponent, below 2^50.
    let (fraction, biased) = (magnitude.to_bits() & 0x7F_FFFF, magnitude.to_bits() >> 23);
    let (mantissa, exponent) = if biased == 0 { (fraction, -149) } else { (fraction | 0x80_0000, biased as i32 - 150) };
    let left = exponent.max(0) as u32;
    // Below 2^-66 all is 0.
    let right = (-exponent).clamp(0, 90) as u32;
    let whole = u128::from(mantissa) << left >> right;
    let digits = whole.checked_ilog10().map_or(0, |power| power + 1) + decimals;
    let unit = 10u128.pow(digits.saturating_sub(SIGNIFICANT_DIGITS));
    let numerator = (u128::from(mantissa) << left) * 10u128.pow(decimals);
    let denominator = unit << right;
    let rounded = (2 * numerator + denominator) / (2 * denominator);
    Some(Scaled { negative: number < 0.0, magnitude: rounded * unit })
}

/// Stops at the first character that is not a digit 0-9, A-F: SM1.7. The characters before it are converted.
pub(super) fn ascii_to_hex(cpu: &Cpu, operands: &Operands) -> u64 {
    let (from, to, count) = (operands.a, operands.b, operands.c & 0xFF);
    if !access::inside(cpu, from, count) || !access::inside(cpu, to, count.div_ceil(2)) {
        return failed(cpu, operands, error::RANGE);
    }
    // The two may overlap.
    let mut characters = [0u8; 255];
    let characters = characters.get_mut(..count as usize).unwrap_or_default();
    cpu.memory.view(from, count, |source| characters.copy_from_slice(source));
    let digit = |character: &u8| match character {
        b'0'..=b'9' => Some(character - b'0'),
        b'A'..=b'F' => Some(character - b'A' + 10),
        _ => None,
    };
    let mut good = 0;
    for (index, digit) in (0u32..).zip(characters.iter().map_while(digit)) {
        let address = to + index / 2;
        let old = cpu.memory.byte(address);
        cpu.memory.set_byte(address, if index % 2 == 0 { digit << 4 | old & 0x0F } else { old & 0xF0 | digit });
        good = index + 1;
    }
    access::after_write(cpu, to, good.div_ceil(2));
    set_special(&cpu.memory, 1, sm1::NOT_HEX, good != count);
    if good == count { done() } else { failed_quietly() }
}

pub(super) fn hex_to_ascii(cpu: &Cpu, operands: &Operands) -> u64 {
    let (from, to, count) = (operands.a, operands.b, operands.c & 0xFF);
    if !access::inside(cpu, from, count.div_ceil(2)) || !access::inside(cpu, to, count) {
        return failed(cpu, operands, error::RANGE);
    }
    let mut text = [0u8; 255];
    let text = text.get_mut(..count as usize).unwrap_or_default();
    for (index, place) in (0u32..).zip(text.iter_mut()) {
        let byte = cpu.memory.byte(from + index / 2);
        let digit = if index % 2 == 0 { byte >> 4 } else { byte & 0x0F };
        *place = if digit < 10 { b'0' + digit } else { b'A' + digit - 10 };
    }
    cpu.memory.load(to, text);
    access::after_write(cpu, to, count);
    done()
}

pub(super) fn string_to_int(cpu: &Cpu, operands: &Operands) -> u64 {
    read_text(cpu, operands, |text| i16::try_from(integer(text)).ok().map(|number| u32::from(number as u16)))
}

pub(super) fn string_to_dint(cpu: &Cpu, operands: &Operands) -> u64 {
    read_text(cpu, operands, |text| i32::try_from(integer(text)).ok().map(|number| number as u32))
}

pub(super) fn string_to_real(cpu: &Cpu, operands: &Operands) -> u64 {
    read_text(cpu, operands, |text| Some(real(text)).filter(|number| number.is_finite()).map(f32::to_bits))
}

/// Returns what `read` makes of the string at `a` from position `b` on; `None` is out of range: SM1.1.
fn read_text(cpu: &Cpu, operands: &Operands, read: impl FnOnce(&[u8]) -> Option<u32>) -> u64 {
    let &Operands { a: string, b: index, .. } = operands;
    let Some(length) = strings::length_at(cpu, string) else { return failed(cpu, operands, error::RANGE) };
    if !strings::is_position(index, length) {
        return failed(cpu, operands, error::INDEX);
    }
    let mut number = None;
    cpu.memory.view(string + index, (length + 1).saturating_sub(index), |text| number = read(text));
    set_special(&cpu.memory, 1, sm1::OVERFLOW, number.is_none());
    number.map_or_else(failed_quietly, value)
}

/// Without leading blanks and sign, and whether the sign is `-`.
fn unsigned(text: &[u8]) -> (bool, &[u8]) {
    let blanks = text.iter().take_while(|&&character| character == b' ').count();
    match text.get(blanks..).unwrap_or_default() {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        rest => (false, rest),
    }
}

/// Splits off leading digits.
fn digits(text: &[u8]) -> (&[u8], &[u8]) {
    text.split_at(text.iter().take_while(|character| character.is_ascii_digit()).count())
}

/// `[blanks][+|-]digits`, then whatever; 0 without digits.
fn integer(text: &[u8]) -> i64 {
    let (negative, rest) = unsigned(text);
    let add = |number: i64, digit: &u8| number.saturating_mul(10).saturating_add(i64::from(digit - b'0'));
    let magnitude = digits(rest).0.iter().fold(0, add);
    if negative { -magnitude } else { magnitude }
}

/// `[blanks][+|-][digits][.|,][digits]`, then whatever; 0 without digits.
fn real(text: &[u8]) -> f32 {
    let (negative, rest) = unsigned(text);
    let (whole, rest) = digits(rest);
    let fraction = match rest {
        [b'.' | b',', rest @ ..] => digits(rest).0,
        _ => &[],
    };
    // A string has 254 characters at most.
    let mut number = [b'0'; 256];
    let parts = whole.iter().copied().chain([b'.']).chain(fraction.iter().copied());
    number.iter_mut().skip(1).zip(parts).for_each(|(place, character)| *place = character);
    let length = (2 + whole.len() + fraction.len()).min(number.len());
    let text = number.get(..length).and_then(|number| std::str::from_utf8(number).ok());
    let magnitude: f32 = text.and_then(|text| text.parse().ok()).unwrap_or(0.0);
    if negative { -magnitude } else { magnitude }
}
