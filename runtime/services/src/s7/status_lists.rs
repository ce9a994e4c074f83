//! System status lists (SZL): what a CPU says of itself.

use super::plc::{Event, Plc};
use super::watch_list;
use crate::limits::{CONNECTIONS_MAX, EVENTS_LISTED_MAX, SUBSCRIPTIONS_MAX};
use crate::wire::put16;

/// Error words.
pub const WRONG_REQUEST: u16 = 0xD405;
const UNKNOWN_LIST: u16 = 0xD401;
const UNKNOWN_INDEX: u16 = 0xD402;

/// The lists that are answered: list 0000 names them.
const LISTS: [u16; 32] = [
    0x0000, 0x0011, 0x0111, 0x0F11, 0x0012, 0x0013, 0x0113, 0x0F13, 0x0014, 0x0114, 0x0015, 0x0115, 0x0019, 0x0119,
    0x001C, 0x011C, 0x0F1C, 0x0074, 0x0174, 0x0091, 0x0C91, 0x0D91, 0x0F91, 0x00A0, 0x01A0, 0x0FA0, 0x0124, 0x0424,
    0x0131, 0x0132, 0x0232, 0x0222,
];

/// Lists that say what CPU it is and whether it runs, which everyone may know.
pub fn identifies(id: u16) -> bool {
    !matches!(id & 0x00FF, 0x00A0 | 0x0013..=0x0015 | 0x0022 | 0x0091)
}

/// Events that change the mode.
const RUN: u16 = 0x4302;
const STOP: u16 = 0x4303;

/// Bits of the number of a list: only its head.
const HEAD_ONLY: u16 = 0x0F00;

/// What an answer to a read has besides the bytes of its only item.
const READ_AROUND: u16 = 18;

/// Records of equal length.
struct List {
    length: u16,
    records: Vec<Vec<u8>>,
}

/// The list with its head for a client with these protection levels: number, index, length and number of records.
pub fn read(plc: &dyn Plc, levels: (u16, u16), id: u16, index: u16) -> Result<Vec<u8>, u16> {
    if !LISTS.contains(&id) {
        return Err(UNKNOWN_LIST);
    }
    let mut list = list(plc, levels, id, index).ok_or(UNKNOWN_INDEX)?;
    for record in &mut list.records {
        record.resize(list.length.into(), 0);
    }
    let mut out = Vec::new();
    put16(&mut out, id);
    put16(&mut out, index);
    put16(&mut out, list.length);
    put16(&mut out, list.records.len() as u16);
    if id & HEAD_ONLY != HEAD_ONLY {
        list.records.iter().for_each(|record| out.extend(record));
    }
    Ok(out)
}

/// A record: words, then bytes.
fn record(words: &[u16], bytes: &[u8]) -> Vec<u8> {
    let mut record = Vec::new();
    words.iter().for_each(|word| put16(&mut record, *word));
    record.extend(bytes);
    record
}

fn list(plc: &dyn Plc, levels: (u16, u16), id: u16, index: u16) -> Option<List> {
    let all = |length, records: Vec<Vec<u8>>| Some(List { length, records });
    // The record with this index, which is its first word.
    let one = |length, records: Vec<Vec<u8>>, index: u16| {
        let found = records.into_iter().find(|record| record.starts_with(&index.to_be_bytes()))?;
        Some(List { length, records: vec![found] })
    };
    match id {
        0x0000 => all(2, LISTS.iter().map(|id| record(&[*id], &[])).collect()),
        0x0011 | 0x0F11 => all(28, identification(plc)),
        0x0111 => one(28, identification(plc), index),
        // Families of instructions that every CPU has.
        0x0012 => all(2, vec![record(&[0x0100], &[])]),
        0x0013 | 0x0F13 => all(36, memories(plc)),
        0x0113 => one(36, memories(plc), index),
        0x0014 => all(8, areas(plc)),
        0x0114 => one(8, areas(plc), index),
        0x0015 => all(10, block_kinds(plc)),
        0x0115 => one(10, block_kinds(plc), index),
        0x0019 | 0x0074 => all(4, leds(plc)),
        // The rack is in the high byte; there is one.
        0x0119 | 0x0174 => one(4, leds(plc), index),
        0x001C | 0x0F1C => all(34, components(plc)),
        0x011C => one(34, components(plc), index),
        0x0091 | 0x0F91 => all(16, modules(plc, |_| true)),
        // One module by its address, those of one rack.
        0x0C91 | 0x0D91 => {
            let word = if id == 0x0C91 { 2 } else { 0 };
            let records = modules(plc, |module| module[word] == index);
            (!records.is_empty()).then_some(List { length: 16, records })
        }
        0x0131 => one(40, communication(plc), index.max(1)),
        0x0132 | 0x0232 => one(40, vec![protection(levels)], if index == 0 { 4 } else { index }),
        0x0424 => all(20, vec![mode(plc)]),
        0x0124 => all(20, vec![plc.last_mode_change().map_or_else(|| mode(plc), |event| entry(&event))]),
        0x0222 => all(28, vec![plc.ob_status(index)?]),
        0x00A0 | 0x0FA0 => all(20, events(plc, EVENTS_LISTED_MAX)),
        0x01A0 => all(20, events(plc, usize::from(index).min(EVENTS_LISTED_MAX))),
        _ => None,
    }
}

/// Text of so many bytes, filled up with `filler`.
fn text(text: &str, length: usize, filler: u8) -> Vec<u8> {
    let mut bytes: Vec<u8> = text.chars().map(|c| u8::try_from(c).unwrap_or(b'?')).take(length).collect();
    bytes.resize(length, filler);
    bytes
}

fn identification(plc: &dyn Plc) -> Vec<Vec<u8>> {
    let order = plc.names().order;
    // Module, hardware, firmware 1.0.0.
    let versions: [(u16, [u16; 3]); 3] = [(1, [0, 1, 0]), (6, [0, 1, 0]), (7, [0, 0x5601, 0x0000])];
    versions
        .map(|(index, words)| {
            let mut one = record(&[index], &text(&order, 20, b' '));
            words.iter().for_each(|word| put16(&mut one, *word));
            one
        })
        .to_vec()
}

fn components(plc: &dyn Plc) -> Vec<Vec<u8>> {
    let names = plc.names();
    let texts: [(u16, &str); 6] =
        [(1, &names.program), (2, &names.module), (3, ""), (4, "plcc"), (5, "S plcc"), (7, &names.module)];
    texts.map(|(index, value)| record(&[index], &text(value, 32, 0))).to_vec()
}

/// Work memory, which holds data only: code is of this computer. Source: System and standard functions, list 13.
fn memories(plc: &dyn Plc) -> Vec<Vec<u8>> {
    /// Volatile; code and data are apart.
    const RAM: u16 = 1;
    const APART: u16 = 1 << 3;
    let [all, used, largest_free] = plc.data_memory();
    let mut work = record(&[1, RAM], &all.to_be_bytes());
    put16(&mut work, 1 | APART);
    put16(&mut work, 0);
    for bytes in [all, used, largest_free] {
        work.extend(bytes.to_be_bytes());
    }
    vec![work]
}

fn modules(plc: &dyn Plc, wanted: impl Fn(&[u16; 8]) -> bool) -> Vec<Vec<u8>> {
    plc.modules().iter().filter(|module| wanted(module)).map(|module| record(module, &[])).collect()
}

/// Process images, bit memory, timers, counters, local data: how much there is, and how much of it is retentive. Record 6 would be the bytes of
/// peripheral addresses, which are one more than a word can say.
///
/// Source: System and standard functions, list 14.
fn areas(plc: &dyn Plc) -> Vec<Vec<u8>> {
    let [inputs, outputs, bit_memory, timers, counters, local_data] = plc.sizes();
    let [bit_memory_kept, timers_kept, counters_kept] = plc.retentive();
    let areas = [
        (1, inputs, 0),
        (2, outputs, 0),
        (3, bit_memory, bit_memory_kept),
        (4, timers, timers_kept),
        (5, counters, counters_kept),
        (7, local_data, 0),
    ];
    areas.map(|(index, size, retentive)| record(&[index, 1, size, retentive], &[])).to_vec()
}

/// How many blocks there may be of each kind, largest block in KB, and how many bytes may be loaded. Source: System and standard functions,
/// list 15. Only data blocks have a limit here.
fn block_kinds(plc: &dyn Plc) -> Vec<Vec<u8>> {
    let kilobytes = plc.block_bytes_max().div_ceil(1024).min(0xFFFF) as u16;
    let kinds: [u16; 5] = [0x0800, 0x0A00, 0x0B00, 0x0C00, 0x0E00];
    kinds.map(|kind| record(&[kind, u16::MAX, kilobytes], &u32::MAX.to_be_bytes())).to_vec()
}

fn leds(plc: &dyn Plc) -> Vec<Vec<u8>> {
    let running = plc.is_running();
    // SF, RUN, STOP, and FRCE; a CPU of the TIA Portal shows forcing by MAINT.
    let force = if plc.family().is_portal() { 0x15 } else { 6 };
    let lit = [(1, plc.has_faults()), (4, running), (5, !running), (force, plc.is_forcing())];
    lit.map(|(led, on)| record(&[led], &[u8::from(on), 0])).to_vec()
}

/// PDU length, connections, rates; then which test functions there are, a bit each; then which functions of reading and writing.
fn communication(plc: &dyn Plc) -> Vec<Vec<u8>> {
    let pdu = plc.family().pdu_max();
    let mut general = record(&[1, pdu, CONNECTIONS_MAX as u16], &[]);
    general.extend(187_500u32.to_be_bytes());
    general.extend(100_000_000u32.to_be_bytes());
    // The status of variables, jobs and LEDs.
    let status = if watch_list::is_served(plc.family()) { 1 << 2 } else { 0 };
    let test = record(&[2], &[status, 0, 0x41]);
    // Read and write once, begin and end cyclic reading; bytes of one cycle; cyclic jobs, their shortest and longest period in 100 ms.
    let mut data = record(&[3], &[0x47, 0, 0, 0]);
    for word in [pdu - READ_AROUND, SUBSCRIPTIONS_MAX as u16, 1, 25_500] {
        put16(&mut data, word);
    }
    vec![general, test, data]
}

fn protection((set, valid): (u16, u16)) -> Vec<u8> {
    // Key switch: level 1; parameters; valid level; selector RUN-P; no start switch.
    record(&[4, 1, set, valid, 2, 0], &[])
}

/// The present mode, by the event that led to it. What was before is left out: clients compare the whole byte.
fn mode(plc: &dyn Plc) -> Vec<u8> {
    let running = plc.is_running();
    let event = plc.last_mode_change().map(|event| event.event).filter(|event| running == (*event == RUN));
    let event = event.unwrap_or(if running { RUN } else { STOP });
    let mut one = record(&[event], &[0xFF, if running { 0x08 } else { 0x04 }]);
    one.extend([0; 8]);
    one.extend(plc.clock());
    one
}

fn events(plc: &dyn Plc, count: usize) -> Vec<Vec<u8>> {
    plc.events(count).iter().map(entry).collect()
}

fn entry(event: &Event) -> Vec<u8> {
    let mut one = record(&[event.event], &[event.priority, event.ob]);
    one.extend([0, 0, 0, 0]);
    one.extend(event.info.to_be_bytes());
    one.extend(event.time);
    one
}
