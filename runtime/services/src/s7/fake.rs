//! A CPU for tests of frames.

use std::cell::{Cell, RefCell};

use super::plc::{Area, BlockInfo, DateAndTime, Event, Family, ItemError, Names, Place, Plc, Restart};

/// A CPU with 16 bytes of each area, and DB 10 of 100 bytes.
pub(crate) struct Fake {
    pub family: Family,
    pub memory: RefCell<[u8; 16]>,
    pub db: RefCell<[u8; 100]>,
    pub running: Cell<bool>,
}

impl Fake {
    pub fn new() -> Fake {
        let mut db = [0; 100];
        db[4..7].copy_from_slice(&[0x11, 0x22, 0x33]);
        let mut memory = [0; 16];
        memory[5] = 8;
        Fake { family: Family::S7300, memory: RefCell::new(memory), db: RefCell::new(db), running: Cell::new(true) }
    }
}

impl Plc for Fake {
    fn family(&self) -> Family {
        self.family
    }

    fn names(&self) -> Names {
        Names {
            program: "test".to_string(),
            order: "6ES7 315-2AG10-0AB0".to_string(),
            module: "CPU 315-2 DP".to_string(),
        }
    }

    fn read(&self, place: Place) -> Result<Vec<u8>, ItemError> {
        let (start, count) = (place.start as usize, place.count as usize);
        let all = match place.area {
            Area::Db(10) => self.db.borrow().to_vec(),
            Area::Db(_) => return Err(ItemError::Missing),
            Area::Timers | Area::Counters => vec![0; 2 * (start + count).min(64)],
            _ => self.memory.borrow().to_vec(),
        };
        if matches!(place.area, Area::Timers | Area::Counters) {
            return all.get(2 * start..2 * (start + count)).map(<[u8]>::to_vec).ok_or(ItemError::OutOfRange);
        }
        let bytes = all.get(start..start + count).ok_or(ItemError::OutOfRange)?;
        Ok(place.bit.map_or(bytes.to_vec(), |bit| vec![bytes[0] >> bit & 1]))
    }

    fn write(&self, place: Place, data: &[u8]) -> Result<(), ItemError> {
        self.read(place)?;
        let start = place.start as usize;
        let put = |bytes: &mut [u8]| match place.bit {
            Some(bit) => bytes[start] = bytes[start] & !(1 << bit) | (data[0] & 1) << bit,
            None => bytes[start..start + data.len()].copy_from_slice(data),
        };
        match place.area {
            Area::Db(_) => put(&mut *self.db.borrow_mut()),
            Area::Timers | Area::Counters => {}
            _ => put(&mut *self.memory.borrow_mut()),
        }
        Ok(())
    }

    fn is_forcing(&self) -> bool {
        false
    }

    fn is_running(&self) -> bool {
        self.running.get()
    }

    fn stop(&self) {
        self.running.set(false);
    }

    fn start(&self, restart: Restart) -> bool {
        self.running.set(restart == Restart::Warm);
        self.running.get()
    }

    fn blocks(&self, kind: u8) -> Vec<u16> {
        if kind == 0x0A { (1..=100).collect() } else { vec![1] }
    }

    fn block(&self, _: u8, number: u16) -> Option<BlockInfo> {
        let name = "Motor".to_string();
        Some(BlockInfo { number, bytes: 100, local_data: 0, name, read_only: false }).filter(|_| number <= 100)
    }

    fn clock(&self) -> DateAndTime {
        [0x26, 0x11, 0x22, 0x19, 0x05, 0x30, 0x12, 0x31]
    }

    fn set_clock(&self, time: DateAndTime) -> bool {
        time.iter().all(|byte| byte >> 4 <= 9 && byte & 15 <= 9)
    }

    fn block_bytes_max(&self) -> u32 {
        65_534
    }

    fn events(&self, count: usize) -> Vec<Event> {
        vec![Event { event: 0x4302, ob: 0x68, priority: 0xFF, info: 0, time: self.clock() }; count.min(30)]
    }

    fn ob_status(&self, ob: u16) -> Option<Vec<u8>> {
        (ob == 1).then(|| vec![0x11; 28])
    }

    fn last_mode_change(&self) -> Option<Event> {
        self.events(1).pop()
    }

    fn has_faults(&self) -> bool {
        false
    }

    fn cell_bit(&self, area: Area, number: u32) -> bool {
        area == Area::Timers && number % 2 == 1
    }

    fn data_memory(&self) -> [u32; 3] {
        [65_536, 160, 65_376]
    }

    fn modules(&self) -> Vec<[u16; 8]> {
        let module = |rack, slot: u16, address, state| [rack, slot << 8, address, 0, 0, 0, state, 1];
        vec![module(0, 4, 0, 0xB402), module(1, 4, 36, 0xB502)]
    }

    fn retentive(&self) -> [u16; 3] {
        [16, 0, 8]
    }

    fn sizes(&self) -> [u16; 6] {
        [128; 6]
    }
}
