//! The memory that random modules work on, and what runtime functions do with it.

use std::cell::{Cell, RefCell};

use plcc_abi::functions::Effect;
use plcc_abi::layout;
use plcc_ir::interpreter::Host;
use plcc_ir::{RuntimeFn, StaticDb};

/// A few bytes of each area, and a log of the memory that runtime functions saw.
pub(super) struct Memory {
    bytes: RefCell<Vec<u8>>,
    pub log: RefCell<Vec<u64>>,
    count: Cell<u64>,
    /// Nothing runs at safepoints.
    alone: bool,
}

const WINDOWS: [(u32, u32); 8] = [
    (layout::STATE, 0x200),
    (layout::I, 64),
    (layout::Q, 64),
    (layout::M, 64),
    (layout::T, 16),
    (layout::L, 256),
    (layout::DB_TABLE, 64),
    (layout::DB_DATA, 128),
];
const L_WINDOW: usize = 5;

impl Memory {
    pub fn new(seed: u8, alone: bool) -> Memory {
        let total: u32 = WINDOWS.iter().map(|window| window.1).sum();
        let bytes = (0..total).map(|index| (index as u8).wrapping_mul(37) ^ seed).collect();
        let memory = Memory { bytes: RefCell::new(bytes), log: RefCell::default(), count: Cell::new(0), alone };
        for db in dbs() {
            memory.write(layout::db_table_entry(db.number), &db.address.to_ne_bytes());
            memory.write(layout::db_table_entry(db.number) + 4, &db.length.to_ne_bytes());
        }
        memory
    }

    fn index(offset: u32) -> usize {
        let mut start = 0;
        for (address, len) in WINDOWS {
            if (address..address + len).contains(&offset) {
                return (start + offset - address) as usize;
            }
            start += len;
        }
        panic!("{offset:#x} is outside of the memory of the test");
    }

    /// The memory that an observer may see: everything except local data.
    pub fn observed(&self) -> Vec<u8> {
        let l_start: u32 = WINDOWS[..L_WINDOW].iter().map(|window| window.1).sum();
        let mut bytes = self.bytes.borrow().clone();
        bytes.drain(l_start as usize..(l_start + WINDOWS[L_WINDOW].1) as usize);
        bytes
    }

    fn note(&self, value: u64) {
        self.log.borrow_mut().push(value);
    }
}

impl Host for Memory {
    fn read(&self, offset: u32, buf: &mut [u8]) {
        if !buf.is_empty() {
            let index = Memory::index(offset);
            buf.copy_from_slice(&self.bytes.borrow()[index..index + buf.len()]);
        }
    }

    fn write(&self, offset: u32, bytes: &[u8]) {
        // Only optimised code tells the runtime which outputs it writes.
        let is_note = offset == layout::STATE + layout::state::OUTPUTS_WRITTEN;
        if !bytes.is_empty() && !is_note {
            let index = Memory::index(offset);
            self.bytes.borrow_mut()[index..index + bytes.len()].copy_from_slice(bytes);
        }
    }

    fn call_runtime(&self, function: RuntimeFn, args: &[u64]) -> u64 {
        if function.effect() == Effect::Pure {
            return args.iter().fold(17, |hash: u64, arg| hash.wrapping_mul(31) ^ arg);
        }
        self.note(args.iter().fold(function as u64, |hash, arg| hash.wrapping_mul(0x1_0001) ^ arg));
        self.count.set(self.count.get() + 1);
        let count = self.count.get();
        match function.effect() {
            Effect::Pure => {}
            Effect::Cells => {
                let mut cells = [0; 16];
                self.read(layout::T, &mut cells);
                self.note(cells.iter().fold(0, |hash, &byte| hash << 3 ^ u64::from(byte)));
                self.write(layout::T + (count % 12) as u32, &[count as u8]);
            }
            Effect::System => self.write(layout::SYSTEM + (count % 12) as u32, &[(count * 57) as u8]),
            Effect::Io => {
                let mut outputs = [0; 16];
                self.read(layout::Q, &mut outputs);
                self.note(outputs.iter().fold(0, |hash, &byte| hash << 3 ^ u64::from(byte)));
                self.write(layout::Q + (count % 8) as u32, &[count as u8]);
            }
            Effect::Reads => {
                let hash = self.observed().iter().fold(0u64, |hash, &byte| hash.wrapping_mul(31) ^ u64::from(byte));
                self.note(hash);
            }
            Effect::All => {
                let hash = self.observed().iter().fold(0u64, |hash, &byte| hash.wrapping_mul(31) ^ u64::from(byte));
                self.note(hash);
                let data = if self.alone && function == RuntimeFn::Safepoint { 0 } else { 5 };
                for area in
                    [layout::I, layout::Q, layout::M, layout::DB_DATA, layout::DB_DATA + 32].into_iter().take(data)
                {
                    self.write(area + (count % 12) as u32, &[(count * 91) as u8]);
                }
            }
        }
        count.wrapping_mul(0x9E37_79B9) & 0xFFFF_FFFF
    }
}

pub(super) fn dbs() -> Vec<StaticDb> {
    let db = |number, address| StaticDb { number, address, length: 32, read_only: false };
    vec![db(1, layout::DB_DATA), db(2, layout::DB_DATA + 32)]
}
