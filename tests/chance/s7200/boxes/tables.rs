//! Tables: entries are added, taken and found.

use super::{EMPTY, FULL};
use crate::s7200::memory::{Fault, Memory, Place, RANGE, Store};
use crate::s7200::program::{Operand, Width};

/// Most entries of a table.
const ENTRIES: u32 = 100;

/// Place of a table with its TL and EC.
fn table(memory: &Memory, operand: &Operand) -> Result<(Store, u32, u32, u32), Fault> {
    let (store, byte) = memory.buffer(operand, 2, 4)?;
    let word = |byte| memory.get(Place::In(store, byte), Width::Word);
    Ok((store, byte, word(byte), word(byte + 2)))
}

pub(super) fn table_add(memory: &mut Memory, operands: &[Operand]) -> Result<(), Fault> {
    let value = memory.read(&operands[0], Width::Word)?;
    let (store, byte, most, count) = table(memory, &operands[1])?;
    if count >= most {
        memory.set_flag(FULL, true);
        return Err(Fault::Eno);
    }
    let at = byte + 4 + count * 2;
    if count >= ENTRIES || (at + 2) as usize > memory.store(store).len() {
        return Err(RANGE);
    }
    memory.set(Place::In(store, at), Width::Word, value);
    memory.set(Place::In(store, byte + 2), Width::Word, count + 1);
    memory.set_flag(FULL, false);
    Ok(())
}

pub(super) fn table_take(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let (store, byte, _, count) = table(memory, &operands[0])?;
    let out = memory.place(&operands[1], 2)?;
    if count == 0 {
        memory.set_flag(EMPTY, true);
        return Err(Fault::Eno);
    }
    if count > ENTRIES || (byte + 4 + count * 2) as usize > memory.store(store).len() {
        return Err(RANGE);
    }
    let entry = |index: u32| Place::In(store, byte + 4 + index * 2);
    let value = memory.get(entry(if op == "FIFO" { 0 } else { count - 1 }), Width::Word);
    if op == "FIFO" {
        for index in 1..count {
            let next = memory.get(entry(index), Width::Word);
            memory.set(entry(index - 1), Width::Word, next);
        }
    }
    memory.set(Place::In(store, byte + 2), Width::Word, count - 1);
    memory.set(out, Width::Word, value);
    memory.set_flag(EMPTY, false);
    Ok(())
}

pub(super) fn table_find(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let (store, byte) = memory.buffer(&operands[0], 2, 2)?;
    let pattern = memory.read(&operands[1], Width::Word)? as i16;
    let index = memory.place(&operands[2], 2)?;
    let count = memory.get(Place::In(store, byte), Width::Word);
    if count > ENTRIES || (byte + 2 + count * 2) as usize > memory.store(store).len() {
        return Err(RANGE);
    }
    let matches = |at: &u32| {
        let entry = memory.get(Place::In(store, byte + 2 + at * 2), Width::Word) as i16;
        match op {
            "FND=" => entry == pattern,
            "FND<>" => entry != pattern,
            "FND<" => entry < pattern,
            _ => entry > pattern,
        }
    };
    let found = (memory.get(index, Width::Word)..count).find(matches).unwrap_or(count);
    memory.set(index, Width::Word, found);
    Ok(())
}
