//! SFC 82 CREA_DBL, 83 READ_DBL, 84 WRIT_DBL, 85 CREA_DB; CREATE_DB, DELETE_DB, ATTR_DB of the TIA Portal: DBs with their load memory.
//!
//! Source: System and standard functions, SFC 82 to 85; TIA Portal help, data block functions. The jobs take no time.

use plcc_abi::any::Any;
use plcc_abi::layout::area;

use super::any::{self, Access};
use super::data_blocks::{create, delete, in_load_memory, program_db};
use super::parameters::Call;
use super::{OK, Outcome, error};

const NO_JOB: Outcome = Outcome::RetVal(0x7000);
/// The source is shorter: the rest keeps its values.
const TARGET_LONGER: u16 = 0x0081;
const SOURCE_LONGER: u16 = 0x8081;
const NO_BLOCK: u16 = 0x8093;
const ATTRIBUTES: u16 = 0x80A4;
/// Bits of ATTRIB.
const UNLINKED: u8 = 1;
const READ_ONLY: u8 = 2;

/// Number of the DB in load memory that parameter `index` points into, and the part of it.
fn stored(call: &Call, index: usize, access: Access) -> Result<(u16, std::ops::Range<usize>), u16> {
    let Any { area, db, byte, bytes, .. } = plcc_abi::any::decode(call.any(index), index, access)?.ok_or(NO_BLOCK)?;
    if !matches!(area, area::DB | area::DI) {
        return Err(NO_BLOCK);
    }
    let length = call.cpu.stored(db).ok_or(NO_BLOCK)?.len();
    let range = byte as usize..(byte + bytes) as usize;
    if range.end > length { Err(NO_BLOCK) } else { Ok((db, range)) }
}

/// The bytes that the program works with at parameter `index`; none if it points at nothing.
fn bytes(call: &Call, index: usize) -> Result<Vec<u8>, u16> {
    match any::decode(call, index, Access::Read)? {
        None => Ok(Vec::new()),
        Some(range) if range.existing < range.bytes => Err(NO_BLOCK),
        Some(range) => Ok(call.cpu.memory.view(range.offset, range.bytes, <[u8]>::to_vec)),
    }
}

fn outcome(result: Result<u16, u16>) -> Outcome {
    match result {
        Ok(value) => Outcome::RetVal(value),
        Err(code) => error(code),
    }
}

/// Parameter `index` becomes the number of a new DB with the values of parameter `source`.
fn created(call: &Call, count: u32, attributes: u8, source: usize, index: usize) -> Result<u16, u16> {
    call.set_word(index, 0);
    if attributes & READ_ONLY != 0 {
        return Err(ATTRIBUTES);
    }
    let mut data = bytes(call, source)?;
    if data.len() > count as usize {
        return Err(SOURCE_LONGER);
    }
    let short = !data.is_empty() && data.len() < count as usize;
    data.resize(count as usize, 0);
    let linked = attributes & UNLINKED == 0;
    let number = create(call.cpu, call.word(1), call.word(2), count, linked)?;
    if linked {
        call.cpu.memory.load(call.cpu.memory.db(number).0, &data);
    }
    call.cpu.store(number, data);
    call.set_word(index, number);
    Ok(if short { TARGET_LONGER } else { 0 })
}

/// REQ, LOW_LIMIT, UP_LIMIT, COUNT, ATTRIB, SRCBLK -> RET_VAL, BUSY, DB_NUM.
pub(super) fn crea_dbl(call: &Call) -> Outcome {
    call.set_bool(7, false);
    if call.byte(0) & 1 == 0 {
        return NO_JOB;
    }
    outcome(created(call, call.word(3).into(), call.byte(4), 5, 8))
}

/// As [`crea_dbl`], with a COUNT of 32 bits.
pub(super) fn create_db(call: &Call) -> Outcome {
    call.set_bool(7, false);
    if call.byte(0) & 1 == 0 {
        return NO_JOB;
    }
    outcome(created(call, call.dword(3), call.byte(4), 5, 8))
}

/// LOW_LIMIT, UP_LIMIT, COUNT, ATTRIB -> RET_VAL, DB_NUMBER.
pub(super) fn crea_db(call: &Call) -> Outcome {
    call.set_word(5, 0);
    outcome(create(call.cpu, call.word(0), call.word(1), call.word(2).into(), true).map(|number| {
        call.set_word(5, number);
        0
    }))
}

/// REQ, DB_NUMBER -> RET_VAL, BUSY.
pub(super) fn delete_db(call: &Call) -> Outcome {
    call.set_bool(3, false);
    if call.byte(0) & 1 == 0 {
        return NO_JOB;
    }
    outcome(delete(call.cpu, call.word(1)).map(|()| 0))
}

/// REQ, DB_NUMBER -> RET_VAL, DB_LENGTH, ATTRIB. 80A1 number, 80B1 missing, 80B2 in load memory only.
pub(super) fn attr_db(call: &Call) -> Outcome {
    let number = call.word(1);
    call.set_dword(3, 0);
    call.set_byte(4, 0);
    if call.byte(0) & 1 == 0 {
        return NO_JOB;
    }
    let (_, length) = call.cpu.memory.db(number);
    let stored = in_load_memory(call.cpu, number);
    if number == 0 {
        return error(0x80A1);
    }
    let length = if length == 0 { call.cpu.stored(number).map_or(0, |data| data.len() as u32) } else { length };
    if length == 0 {
        return error(0x80B1);
    }
    let read_only = program_db(call.cpu, number).is_some_and(|entry| entry.read_only);
    call.set_dword(3, length);
    call.set_byte(4, if read_only { READ_ONLY } else { 0 } | if stored { UNLINKED } else { 0 });
    if stored { error(0x80B2) } else { OK }
}

/// REQ, SRCBLK -> RET_VAL, BUSY, DSTBLK: from load memory.
pub(super) fn read_dbl(call: &Call) -> Outcome {
    call.set_bool(3, false);
    if call.byte(0) & 1 == 0 {
        return NO_JOB;
    }
    let read = || {
        let (db, part) = stored(call, 1, Access::Read)?;
        let target = any::decode(call, 4, Access::Write)?.filter(|range| range.existing == range.bytes);
        let target = target.ok_or(NO_BLOCK)?;
        let data = call.cpu.stored(db).ok_or(NO_BLOCK)?;
        let data = data.get(part).ok_or(NO_BLOCK)?;
        if data.len() > target.bytes as usize {
            return Err(SOURCE_LONGER);
        }
        call.cpu.memory.load(target.offset, data);
        Ok(if data.len() < target.bytes as usize { TARGET_LONGER } else { 0 })
    };
    outcome(read())
}

/// REQ, SRCBLK -> RET_VAL, BUSY, DSTBLK: to load memory.
pub(super) fn writ_dbl(call: &Call) -> Outcome {
    call.set_bool(3, false);
    if call.byte(0) & 1 == 0 {
        return NO_JOB;
    }
    let write = || {
        let source = bytes(call, 1)?;
        let (db, part) = stored(call, 4, Access::Write)?;
        if call.cpu.is_read_only(db) {
            return Err(any::code(4, 0x30));
        }
        if source.len() > part.len() {
            return Err(SOURCE_LONGER);
        }
        let longer = source.len() < part.len();
        let mut data = call.cpu.stored(db).ok_or(NO_BLOCK)?;
        data[part.start..part.start + source.len()].copy_from_slice(&source);
        call.cpu.store(db, data);
        Ok(if longer { TARGET_LONGER } else { 0 })
    };
    outcome(write())
}
