//! ATT, FIFO, LIFO, FND. Source: S7-200 system manual, table instructions.
//!
//! A table is its length in entries, the count of entries, then the entries, one word each.

use plcc_abi::s7200::{TABLE_ENTRIES_MAX, error};

use super::{Operands, access, done, failed, failed_quietly, set_special, sm1, value};
use crate::cpu::Cpu;

/// The count of entries of the table whose count word is at `count_word`; `None`: the table is not in the `room` bytes from there.
fn entries(cpu: &Cpu, count_word: u32, room: u32) -> Option<u32> {
    if room < 2 {
        return None;
    }
    let count = u32::from(cpu.memory.word(count_word));
    (count <= TABLE_ENTRIES_MAX && 2 + 2 * count <= room).then_some(count)
}

/// A full table sets SM1.4 and does not change.
pub(super) fn add(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: entry, b: table, .. } = operands;
    let room = access::room(cpu, table);
    if room < 4 {
        return failed(cpu, operands, error::RANGE);
    }
    let (length, count) = (u32::from(cpu.memory.word(table)), u32::from(cpu.memory.word(table + 2)));
    let full = count >= length.min(TABLE_ENTRIES_MAX);
    if !full && room < 4 + 2 * (count + 1) {
        return failed(cpu, operands, error::RANGE);
    }
    set_special(&cpu.memory, 1, sm1::TABLE_FULL, full);
    if full {
        return failed_quietly();
    }
    cpu.memory.set_word(table + 4 + 2 * count, entry as u16);
    cpu.memory.set_word(table + 2, count as u16 + 1);
    access::after_write(cpu, table + 4 + 2 * count, 2);
    access::after_write(cpu, table + 2, 2);
    done()
}

pub(super) fn first(cpu: &Cpu, operands: &Operands) -> u64 {
    take(cpu, operands, true)
}

pub(super) fn last(cpu: &Cpu, operands: &Operands) -> u64 {
    take(cpu, operands, false)
}

/// Takes out the first or last entry. An empty table sets SM1.5. The place that becomes free keeps its word.
fn take(cpu: &Cpu, operands: &Operands, first: bool) -> u64 {
    let (table, memory) = (operands.a, &cpu.memory);
    let room = access::room(cpu, table);
    let Some(count) = (room >= 4).then(|| entries(cpu, table + 2, room - 2)).flatten() else {
        return failed(cpu, operands, error::RANGE);
    };
    set_special(memory, 1, sm1::TABLE_EMPTY, count == 0);
    let Some(left) = count.checked_sub(1) else { return failed_quietly() };
    let data = table + 4;
    let entry = memory.word(if first { data } else { data + 2 * left });
    if first {
        memory.copy(data + 2, data, 2 * left);
    }
    memory.set_word(table + 2, left as u16);
    access::after_write(cpu, table + 2, if first { 2 + 2 * left } else { 2 });
    value(u32::from(entry))
}

/// Without a match the new index is the count of entries.
pub(super) fn find(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: count_word, b: pattern, c: index, d: relation, .. } = operands;
    let Some(count) = entries(cpu, count_word, access::room(cpu, count_word)) else {
        return failed(cpu, operands, error::RANGE);
    };
    let pattern = pattern as u16 as i16;
    let matches = |&index: &u32| {
        let entry = cpu.memory.word(count_word + 2 + 2 * index) as i16;
        match relation {
            0 => entry == pattern,
            1 => entry != pattern,
            2 => entry < pattern,
            3 => entry > pattern,
            _ => false,
        }
    };
    value((index & 0xFFFF..count).find(matches).unwrap_or(count))
}
