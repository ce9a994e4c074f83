//! Strings: a length byte, then characters. Source: S7-200 system manual, string instructions.

use plcc_abi::s7200::{error, fatal, result};

use super::{Operands, access, done, failed, value};
use crate::cpu::Cpu;

/// Event of the diagnostic buffer: fatal error 0014.
const COMPARE_RANGE: u16 = fatal::EVENT | fatal::COMPARE_RANGE;
/// Longest string.
const LENGTH_MAX: u32 = 254;

/// Length of the string at `address`; `None`: more than a string may have, or it is not in its area.
pub(super) fn length_at(cpu: &Cpu, address: u32) -> Option<u32> {
    if !access::inside(cpu, address, 1) {
        return None;
    }
    let length = u32::from(cpu.memory.byte(address));
    (length <= LENGTH_MAX && access::inside(cpu, address, 1 + length)).then_some(length)
}

/// Whether a position is one of a string: 1 and up. An empty string has position 1, where nothing is.
pub(super) fn is_position(position: u32, length: u32) -> bool {
    (1..=length.max(1)).contains(&position)
}

pub(super) fn length(cpu: &Cpu, operands: &Operands) -> u64 {
    length_at(cpu, operands.a).map_or_else(|| failed(cpu, operands, error::RANGE), value)
}

pub(super) fn copy(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: from, b: to, .. } = operands;
    match length_at(cpu, from) {
        Some(length) if access::inside(cpu, to, 1 + length) => {
            cpu.memory.copy(from, to, 1 + length);
            access::after_write(cpu, to, 1 + length);
            done()
        }
        Some(_) | None => failed(cpu, operands, error::RANGE),
    }
}

pub(super) fn append(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: from, b: to, .. } = operands;
    let (Some(added), Some(old)) = (length_at(cpu, from), length_at(cpu, to)) else {
        return failed(cpu, operands, error::RANGE);
    };
    let length = old + added;
    if length > LENGTH_MAX || !access::inside(cpu, to, 1 + length) {
        return failed(cpu, operands, error::RANGE);
    }
    cpu.memory.copy(from + 1, to + 1 + old, added);
    cpu.memory.set_byte(to, length as u8);
    access::after_write(cpu, to, 1 + length);
    done()
}

/// After the end of the string nothing is copied: the result is empty.
pub(super) fn part(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: from, b: index, c: count, d: to, .. } = operands;
    let Some(length) = length_at(cpu, from) else { return failed(cpu, operands, error::RANGE) };
    if index == 0 {
        return failed(cpu, operands, error::INDEX);
    }
    let count = count.min((length + 1).saturating_sub(index));
    if !access::inside(cpu, to, 1 + count) {
        return failed(cpu, operands, error::RANGE);
    }
    cpu.memory.copy(from.saturating_add(index), to + 1, count);
    cpu.memory.set_byte(to, count as u8);
    access::after_write(cpu, to, 1 + count);
    done()
}

/// An empty string is found nowhere.
pub(super) fn find(cpu: &Cpu, operands: &Operands) -> u64 {
    search(cpu, operands, |text, pattern| {
        (!pattern.is_empty()).then(|| text.windows(pattern.len()).position(|part| part == pattern)).flatten()
    })
}

pub(super) fn find_character(cpu: &Cpu, operands: &Operands) -> u64 {
    search(cpu, operands, |text, set| text.iter().position(|character| set.contains(character)))
}

/// Searches what `found` finds in the string at `a` from position `c` on; returns its position, or 0.
fn search(cpu: &Cpu, operands: &Operands, found: impl Fn(&[u8], &[u8]) -> Option<usize>) -> u64 {
    let &Operands { a: text, b: pattern, c: start, .. } = operands;
    let (Some(length), Some(pattern_length)) = (length_at(cpu, text), length_at(cpu, pattern)) else {
        return failed(cpu, operands, error::RANGE);
    };
    if !is_position(start, length) {
        return failed(cpu, operands, error::INDEX);
    }
    let mut position = 0;
    cpu.memory.view(text + start, (length + 1).saturating_sub(start), |text| {
        cpu.memory.view(pattern + 1, pattern_length, |pattern| {
            position = found(text, pattern).map_or(0, |index| start + index as u32);
        });
    });
    value(position)
}

pub(super) fn equal(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: first, b: second, .. } = operands;
    let (Some(first_length), Some(second_length)) = (length_at(cpu, first), length_at(cpu, second)) else {
        cpu.stop_by(COMPARE_RANGE, operands.site, 0);
        return result::STOP;
    };
    let mut equal = false;
    cpu.memory.view(first, 1 + first_length, |first| {
        cpu.memory.view(second, 1 + second_length, |second| equal = first == second);
    });
    value(u32::from(equal))
}
