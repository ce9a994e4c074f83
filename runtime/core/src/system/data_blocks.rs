//! SFC 22 CREAT_DB, SFC 23 DEL_DB, SFC 24 TEST_DB.
//!
//! DBs made at run time are in the pool after the DBs of the program. The list of them is sorted by address; a new one
//! goes into the first gap that is large enough.

use plcc_abi::layout::{self, DB_ALIGN};

use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::cpu::{CREATED_DBS_MAX, Cpu};

/// The DB of the program with this number.
fn program_db(cpu: &Cpu, number: u16) -> Option<&plcc_abi::image::DbEntry> {
    cpu.image.dbs.iter().find(|db| db.number == number)
}

/// LOW_LIMIT, UP_LIMIT, COUNT -> RET_VAL, DB_NUMBER: the lowest free number; contents 0. 80A1 number, 80A2 length,
/// 80B1 none free, 80B2 no memory.
pub(super) fn creat_db(call: &Call) -> Outcome {
    let (low, high, count) = (call.word(0), call.word(1), call.word(2));
    let cpu = call.cpu;
    call.set_word(4, 0);
    if low == 0 || high == 0 || low > high {
        return error(0x80A1);
    }
    if count == 0 || count % 2 != 0 || u32::from(count) > cpu.image.profile.db_bytes_max {
        return error(0x80A2);
    }
    let free = (low..=high).find(|&number| cpu.memory.db(number).1 == 0 && program_db(cpu, number).is_none());
    let Some(number) = free else { return error(0x80B1) };
    match allocate(cpu, number, u32::from(count)) {
        true => {
            call.set_word(4, number);
            OK
        }
        false => error(0x80B2),
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

/// DB_NUMBER -> RET_VAL. 80A1 number, 80B1 missing, 80B2 of the program (its address is known to the code).
pub(super) fn del_db(call: &Call) -> Outcome {
    let number = call.word(0);
    if number == 0 {
        return error(0x80A1);
    }
    let mut created = call.cpu.created_dbs.borrow_mut();
    match created.iter().position(|&(created, _, _)| created == number) {
        Some(index) => {
            created.remove(index);
            call.cpu.memory.set_db(number, 0, 0);
            OK
        }
        None if program_db(call.cpu, number).is_some() => error(0x80B2),
        None => error(0x80B1),
    }
}

/// DB_NUMBER -> RET_VAL, DB_LENGTH, WRITE_PROT. 80A1 number, 80B1 missing, 80B2 in load memory only.
pub(super) fn test_db(call: &Call) -> Outcome {
    let number = call.word(0);
    let entry = program_db(call.cpu, number);
    let (_, length) = call.cpu.memory.db(number);
    let stored = entry.map_or(0, |entry| entry.data.len() as u32);
    call.set_word(2, length.max(stored) as u16);
    call.set_bool(3, entry.is_some_and(|entry| entry.read_only));
    match (number, length, entry) {
        (0, _, _) => error(0x80A1),
        (_, 0, Some(_)) => error(0x80B2),
        (_, 0, None) => error(0x80B1),
        (_, _, _) => OK,
    }
}
