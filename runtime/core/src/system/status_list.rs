//! SFC 51 RDSYSST: the system status list (SZL), as far as the runtime has its content.
//!
//! Source: System and standard functions, SFC 51 and system status lists.

use super::any::{self, Access};
use super::parameters::Call;
use super::{OK, Outcome, error, station};
use crate::cpu::{Area, Cpu};
use crate::datetime;
use crate::diagnostics::{Entry, site};

/// A partial list: record length and records.
struct List {
    record: usize,
    records: Vec<Vec<u8>>,
}

/// The readable lists: SZL-ID, and the function that returns its records for an index. `Err`: 8083.
type Reader = fn(&Cpu, u16) -> Result<List, u16>;

const WRONG_INDEX: u16 = 0x8083;

/// Words of a record of list 91.
const MODULE_WORDS: usize = 8;

const LISTS: [(u16, Reader); 12] = [
    (0x0000, |_, _| Ok(words(LISTS_READABLE.iter().map(|&id| vec![id]).collect(), 1))),
    (0x0011, |cpu, _| Ok(List { record: 28, records: vec![identification(cpu)] })),
    (0x0111, |cpu, index| match index {
        1 => Ok(List { record: 28, records: vec![identification(cpu)] }),
        _ => Err(WRONG_INDEX),
    }),
    (0x0F11, |_, _| Ok(List { record: 28, records: Vec::new() })),
    (0x0014, |cpu, _| Ok(words(system_areas(cpu), 4))),
    (0x0114, |cpu, index| {
        let areas: Vec<Vec<u16>> = system_areas(cpu).into_iter().filter(|area| area[0] == index).collect();
        if areas.is_empty() { Err(WRONG_INDEX) } else { Ok(words(areas, 4)) }
    }),
    (0x0232, |_, index| if index == 4 { Ok(words(vec![protection()], 20)) } else { Err(WRONG_INDEX) }),
    (0x0091, |cpu, _| Ok(words(module_status(cpu, |_, _| true), 8))),
    (0x0C91, |cpu, address| {
        let found = module_status(cpu, |_, record| record[2] == address);
        if found.is_empty() { Err(WRONG_INDEX) } else { Ok(words(found, 8)) }
    }),
    (0x0D91, |cpu, rack| {
        let found = module_status(cpu, |module_rack, _| module_rack == rack);
        if found.is_empty() { Err(WRONG_INDEX) } else { Ok(words(found, 8)) }
    }),
    (0x00A0, |cpu, _| Ok(buffer(cpu, usize::MAX))),
    (0x01A0, |cpu, count| Ok(buffer(cpu, count.into()))),
];

/// The IDs of `LISTS`, for the list of lists.
const LISTS_READABLE: [u16; 12] =
    [0x0000, 0x0011, 0x0111, 0x0F11, 0x0014, 0x0114, 0x0232, 0x0091, 0x0C91, 0x0D91, 0x00A0, 0x01A0];

fn words(records: Vec<Vec<u16>>, length: usize) -> List {
    let bytes = |record: Vec<u16>| record.iter().flat_map(|word| word.to_be_bytes()).collect();
    List { record: 2 * length, records: records.into_iter().map(bytes).collect() }
}

/// Index 1: order number in 20 characters, three words that do not matter.
fn identification(cpu: &Cpu) -> Vec<u8> {
    let order = match cpu.image.config.cpu_order.as_str() {
        "" => cpu.image.profile.name.as_str(),
        order => order,
    };
    let mut record = vec![0, 1];
    record.extend(order.bytes().chain(std::iter::repeat(b' ')).take(20));
    record.extend([0; 6]);
    record
}

/// Index, code 1 (RAM), number, retentive number: inputs, outputs and bit memory in bytes, timers, counters.
fn system_areas(cpu: &Cpu) -> Vec<Vec<u16>> {
    let profile = &cpu.image.profile;
    let [bit_memory, timers, counters] = cpu.retentive_amounts();
    let areas = [
        (cpu.area(Area::Inputs).1, 0),
        (cpu.area(Area::Outputs).1, 0),
        (cpu.area(Area::BitMemory).1, bit_memory),
        (profile.timers, timers),
        (profile.counters, counters),
    ];
    (1..).zip(areas).map(|(index, (size, retentive))| vec![index, 1, size as u16, retentive as u16]).collect()
}

/// Index 4: mode selector RUN-P (2), no protection.
fn protection() -> Vec<u16> {
    let mut record = vec![4, 1, 0, 1, 2, 1];
    record.resize(20, 0);
    record
}

impl Cpu {
    /// Modules with addresses: rack, and the record of list 91.
    pub fn module_status(&self) -> Vec<(u16, [u16; MODULE_WORDS])> {
        let mut records = Vec::new();
        for (module, place) in station::modules(self) {
            let side = match (module.input_bytes, module.output_bytes) {
                (1.., _) => Some((module.input_start, 0xB402)),
                (0, 1..) => Some((module.output_start, 0xB502)),
                (0, 0) => None,
            };
            let Some((start, state)) = side else { continue };
            let rack = u16::from(place.rack);
            records.push((rack, [rack, u16::from(place.slot) << 8, start as u16, 0, 0, 0, state, 1]));
        }
        records
    }
}

/// Rack, slot, first address, two type codes (unknown: 0), reserved, state (bit 1: there; high byte B4 inputs, B5 outputs), area.
fn module_status(cpu: &Cpu, wanted: impl Fn(u16, &[u16]) -> bool) -> Vec<Vec<u16>> {
    let modules = cpu.module_status().into_iter().filter(|(rack, record)| wanted(*rack, record));
    modules.map(|(_, record)| record.to_vec()).collect()
}

/// Newest entry first: event, priority class (unknown: 0), OB, reserved, information, time.
fn buffer(cpu: &Cpu, count: usize) -> List {
    let record = |entry: &Entry| {
        let mut record = entry.event.to_be_bytes().to_vec();
        record.extend([0, entry.ob as u8, 0, 0]);
        let block = site(&cpu.image, entry.site).map_or(0, |site| site.block_number);
        record.extend(block.to_be_bytes());
        record.extend(entry.info.to_be_bytes());
        record.extend(datetime::encode(entry.wall));
        record
    };
    List { record: 20, records: cpu.diagnostics.newest_first().iter().take(count).map(record).collect() }
}

/// RDSYSST (REQ, SZL_ID, INDEX; RET_VAL, BUSY, SZL_HEADER, DR). 8081 DR is too short, 8082 ID, 8083 index, 7000 without REQ.
pub(super) fn rdsysst(call: &Call) -> Outcome {
    const HEADER: usize = 5;
    const DATA: usize = 6;
    call.set_bool(4, false);
    call.set_dword(HEADER, 0);
    if call.byte(0) & 1 == 0 {
        return Outcome::RetVal(0x7000);
    }
    let (id, index) = (call.word(1), call.word(2));
    let Some((_, reader)) = LISTS.iter().find(|(other, _)| *other == id) else { return error(0x8082) };
    let list = match reader(call.cpu, index) {
        Ok(list) => list,
        Err(code) => return error(code),
    };
    let range = match any::decode(call, DATA, Access::Write) {
        Ok(range) => range,
        Err(code) => return error(code),
    };
    let room = range.map_or(0, |range| range.existing as usize) / list.record;
    let copied = list.records.len().min(room);
    if let Some(range) = range {
        for (offset, byte) in (range.offset..).zip(list.records[..copied].concat()) {
            call.cpu.memory.set_byte(offset, byte);
        }
    }
    call.set_dword(HEADER, (list.record as u32) << 16 | copied as u32);
    if copied < list.records.len() { error(0x8081) } else { OK }
}
