//! SFC 22 CREAT_DB, SFC 23 DEL_DB, SFC 24 TEST_DB.
//!
//! DBs made at run time are in the pool after the DBs of the program. The list of them is sorted by address; a new one
//! goes into the first gap that is large enough.

use plcc_abi::layout::{self, DB_ALIGN};

use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::cpu::{CREATED_DBS_MAX, Cpu};

/// The DB of the program with this number.
pub(super) fn program_db(cpu: &Cpu, number: u16) -> Option<&plcc_abi::image::DbEntry> {
    cpu.image.dbs.iter().find(|db| db.number == number)
}

/// True of a DB that is in load memory only.
pub(super) fn in_load_memory(cpu: &Cpu, number: u16) -> bool {
    cpu.memory.db(number).1 == 0 && cpu.stored(number).is_some()
}

/// A new DB with the lowest free number, contents 0, in load memory only unless `linked`. 80A1 number, 80A2 length, 80B1 none free,
/// 80B2 no memory.
pub(super) fn create(cpu: &Cpu, low: u16, high: u16, count: u32, linked: bool) -> Result<u16, u16> {
    if low == 0 || high == 0 || low > high {
        return Err(0x80A1);
    }
    if count == 0 || !count.is_multiple_of(2) || count > cpu.image.profile.db_bytes_max {
        return Err(0x80A2);
    }
    let is_free = |number| cpu.memory.db(number).1 == 0 && cpu.stored(number).is_none();
    let number = (low..=high).find(|&number| is_free(number)).ok_or(0x80B1u16)?;
    if linked && !allocate(cpu, number, count) {
        return Err(0x80B2);
    }
    Ok(number)
}

/// LOW_LIMIT, UP_LIMIT, COUNT -> RET_VAL, DB_NUMBER.
pub(super) fn creat_db(call: &Call) -> Outcome {
    let created = create(call.cpu, call.word(0), call.word(1), call.word(2).into(), true);
    call.set_word(4, created.unwrap_or(0));
    created.map_or_else(error, |_| OK)
}

/// The memory of data blocks, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DataMemory {
    pub all: u32,
    pub used: u32,
    /// The longest data block that still has room.
    pub largest_free: u32,
}

impl Cpu {
    /// How much of the memory of data blocks is in use.
    pub fn data_memory(&self) -> DataMemory {
        let align = |offset: u32| offset.next_multiple_of(DB_ALIGN);
        let end = self.memory.size();
        let mut free_from = align(self.image.db_end.max(layout::DB_DATA));
        let (mut used, mut largest_free) = (free_from - layout::DB_DATA, 0);
        for &(_, start, length) in self.created_dbs.borrow().iter() {
            largest_free = largest_free.max(start.saturating_sub(free_from));
            free_from = align(start + length);
            used += free_from - start;
        }
        largest_free = largest_free.max(end.saturating_sub(free_from));
        DataMemory { all: end.saturating_sub(layout::DB_DATA), used, largest_free }
    }
}

fn allocate(cpu: &Cpu, number: u16, bytes: u32) -> bool {
    let mut created = cpu.created_dbs.borrow_mut();
    let align = |offset: u32| offset.next_multiple_of(DB_ALIGN);
    let mut address = align(cpu.image.db_end.max(layout::DB_DATA));
    let mut place = created.len();
    for (index, &(_, start, length)) in created.iter().enumerate() {
        if start - address >= bytes {
            place = index;
            break;
        }
        address = align(start + length);
    }
    let fits = address.checked_add(bytes).is_some_and(|end| end <= cpu.memory.size());
    if !fits || created.len() >= CREATED_DBS_MAX {
        return false;
    }
    created.insert(place, (number, address, bytes));
    cpu.memory.clear(address, bytes);
    cpu.memory.set_db(number, address, bytes);
    true
}

/// DB_NUMBER -> RET_VAL.
pub(super) fn del_db(call: &Call) -> Outcome {
    delete(call.cpu, call.word(0)).map_or_else(error, |()| OK)
}

/// Deletes a DB that was made at run time. 80A1 number, 80B1 missing, 80B2 of the program (its address is known to the code).
pub(super) fn delete(cpu: &Cpu, number: u16) -> Result<(), u16> {
    if number == 0 {
        return Err(0x80A1);
    }
    if program_db(cpu, number).is_some() {
        return Err(0x80B2);
    }
    let was_stored = cpu.forget(number);
    let mut created = cpu.created_dbs.borrow_mut();
    match created.iter().position(|&(created, _, _)| created == number) {
        Some(index) => {
            created.remove(index);
            cpu.memory.set_db(number, 0, 0);
            Ok(())
        }
        None if was_stored => Ok(()),
        None => Err(0x80B1),
    }
}

/// DB_NUMBER -> RET_VAL, DB_LENGTH, WRITE_PROT. 80A1 number, 80B1 missing, 80B2 in load memory only.
pub(super) fn test_db(call: &Call) -> Outcome {
    let number = call.word(0);
    let entry = program_db(call.cpu, number);
    let (_, length) = call.cpu.memory.db(number);
    let stored = call.cpu.stored(number).map_or(0, |data| data.len() as u32);
    call.set_word(2, length.max(stored) as u16);
    call.set_bool(3, entry.is_some_and(|entry| entry.read_only));
    match (number, length, stored) {
        (0, _, _) => error(0x80A1),
        (_, 0, 0) => error(0x80B1),
        (_, 0, _) => error(0x80B2),
        (_, _, _) => OK,
    }
}
