//! Texts: numbers as characters and characters as numbers, and strings.

use super::{BAD_HEX, OVERFLOW};
use crate::s7200::memory::{Fault, INDEX, Memory, Place, RANGE};
use crate::s7200::program::{Operand, Width};

/// The number as text of `length` characters; `None` for a bad format.
fn formatted(value: i32, format: u32, length: usize) -> Option<Vec<u8>> {
    let places = (format & 7) as usize;
    if format & 0xF0 != 0 || places > 5 {
        return None;
    }
    let mut digits = value.unsigned_abs().to_string();
    while digits.len() < places + 1 {
        digits.insert(0, '0');
    }
    if places > 0 {
        digits.insert(digits.len() - places, if format & 8 != 0 { ',' } else { '.' });
    }
    if value < 0 {
        digits.insert(0, '-');
    }
    Some(format!("{digits:>length$}").into_bytes())
}

fn source_number(memory: &Memory, op: &str, operand: &Operand) -> Result<(i32, usize), Fault> {
    if op.starts_with('I') {
        Ok((i32::from(memory.read(operand, Width::Word)? as i16), 8))
    } else {
        Ok((memory.read(operand, Width::Dword)? as i32, 12))
    }
}

pub(super) fn to_ascii(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let (value, length) = source_number(memory, op, &operands[0])?;
    let format = memory.read(&operands[2], Width::Byte)?;
    let buffer = memory.buffer(&operands[1], 1, length as u32)?;
    let result = formatted(value, format, length);
    memory.set_bytes(buffer, result.as_deref().unwrap_or(&b" ".repeat(length)));
    result.map(|_| ()).ok_or(Fault::Eno)
}

pub(super) fn to_text(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let (value, length) = source_number(memory, op, &operands[0])?;
    let format = memory.read(&operands[2], Width::Byte)?;
    let Some(result) = formatted(value, format, length) else {
        set_text(memory, &operands[1], &b" ".repeat(length))?;
        return Err(Fault::Eno);
    };
    set_text(memory, &operands[1], &result)
}

pub(super) fn ascii_to_hex(memory: &mut Memory, operands: &[Operand]) -> Result<(), Fault> {
    let length = memory.read(&operands[2], Width::Byte)?;
    let from = memory.buffer(&operands[0], 1, length)?;
    let (store, to) = memory.buffer(&operands[1], 1, length.div_ceil(2))?;
    let mut bad = false;
    for (at, character) in memory.bytes(from, length).into_iter().enumerate() {
        let nibble = match character {
            b'0'..=b'9' => character - b'0',
            b'A'..=b'F' => character - b'A' + 10,
            _ => {
                bad = true;
                break;
            }
        };
        let byte = &mut memory.store_mut(store)[to as usize + at / 2];
        *byte = if at % 2 == 0 { *byte & 0x0F | nibble << 4 } else { *byte & 0xF0 | nibble };
    }
    memory.set_flag(BAD_HEX, bad);
    if bad { Err(Fault::Eno) } else { Ok(()) }
}

pub(super) fn hex_to_ascii(memory: &mut Memory, operands: &[Operand]) -> Result<(), Fault> {
    let length = memory.read(&operands[2], Width::Byte)?;
    let from = memory.buffer(&operands[0], 1, length.div_ceil(2))?;
    let to = memory.buffer(&operands[1], 1, length)?;
    let bytes = memory.bytes(from, length.div_ceil(2));
    let digits: Vec<u8> = (0..length as usize)
        .map(|at| if at % 2 == 0 { bytes[at / 2] >> 4 } else { bytes[at / 2] & 15 })
        .map(|nibble| b"0123456789ABCDEF"[usize::from(nibble)])
        .collect();
    memory.set_bytes(to, &digits);
    Ok(())
}

/// The characters of a string.
pub fn text(memory: &Memory, operand: &Operand) -> Result<Vec<u8>, Fault> {
    if let Operand::Text(text) = operand {
        return Ok(text.clone().into_bytes());
    }
    let (store, byte) = memory.buffer(operand, 1, 1)?;
    let length = memory.get(Place::In(store, byte), Width::Byte);
    let (store, byte) = memory.buffer(operand, 1, 1 + length).map(|_| (store, byte))?;
    if length > 254 {
        return Err(RANGE);
    }
    Ok(memory.bytes((store, byte + 1), length))
}

pub(super) fn set_text(memory: &mut Memory, operand: &Operand, value: &[u8]) -> Result<(), Fault> {
    let length = u8::try_from(value.len()).ok().filter(|&length| length < 255).ok_or(RANGE)?;
    let (store, byte) = memory.buffer(operand, 1, 1 + u32::from(length))?;
    memory.set_bytes((store, byte), &[length]);
    memory.set_bytes((store, byte + 1), value);
    Ok(())
}

pub(super) fn part(memory: &mut Memory, operands: &[Operand]) -> Result<(), Fault> {
    let value = text(memory, &operands[0])?;
    let first = memory.read(&operands[1], Width::Byte)? as usize;
    let count = memory.read(&operands[2], Width::Byte)? as usize;
    if first == 0 {
        return Err(INDEX);
    }
    let part: Vec<u8> = value.into_iter().skip(first - 1).take(count).collect();
    set_text(memory, &operands[3], &part)
}

pub(super) fn find(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let inside = text(memory, &operands[0])?;
    let sought = text(memory, &operands[1])?;
    let place = memory.place(&operands[2], 1)?;
    let first = memory.get(place, Width::Byte) as usize;
    // In an empty string the search may begin, too.
    if first == 0 || first > inside.len().max(1) {
        return Err(INDEX);
    }
    let found = (first..=inside.len()).find(|&at| {
        let rest = &inside[at - 1..];
        match op {
            "SFND" => !sought.is_empty() && rest.starts_with(&sought),
            _ => sought.contains(&rest[0]),
        }
    });
    memory.set(place, Width::Byte, found.unwrap_or(0) as u32);
    Ok(())
}

pub(super) fn from_text(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let value = text(memory, &operands[0])?;
    let first = memory.read(&operands[1], Width::Byte)? as usize;
    let width = if op == "STI" { Width::Word } else { Width::Dword };
    let place = memory.place(&operands[2], width.bytes())?;
    // An empty string has a value, 0.
    if first == 0 || first > value.len().max(1) {
        return Err(INDEX);
    }
    let mut rest = value[first - 1..].iter().copied().peekable();
    while rest.next_if_eq(&b' ').is_some() {}
    let negative = rest.next_if(|character| b"+-".contains(character)) == Some(b'-');
    let mut number = 0i64;
    while let Some(digit) = rest.next_if(u8::is_ascii_digit) {
        number = number.saturating_mul(10).saturating_add(i64::from(digit - b'0'));
    }
    let number = if negative { -number } else { number };
    let fits = match width {
        Width::Byte | Width::Word => i16::try_from(number).is_ok(),
        Width::Dword => i32::try_from(number).is_ok(),
    };
    memory.set_flag(OVERFLOW, !fits);
    if !fits {
        return Err(Fault::Eno);
    }
    memory.set(place, width, number as u32);
    Ok(())
}
