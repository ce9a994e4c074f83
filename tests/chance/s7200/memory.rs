//! Memory of the model and how operands reach it.

use super::program::{Area, Operand, Width};

/// Why an instruction did not run to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A run-time programming error: SM4.3 is set.
    Run(u16),
    /// Only ENO is 0.
    Eno,
}

pub const INDIRECT: Fault = Fault::Run(0x0006);
pub const ILLEGAL_REAL: u16 = 0x000F;
pub const RANGE: Fault = Fault::Run(0x0091);
pub const COUNT: Fault = Fault::Run(0x0092);
pub const INDEX: Fault = Fault::Run(0x009B);

/// Areas that a pointer can address, and local data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Store {
    Bytes(Area),
    TimerValues,
    CounterValues,
}

/// The position of an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    In(Store, u32),
    Accumulator(u8),
}

/// All that a program can reach.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    pub inputs: Vec<u8>,
    pub outputs: Vec<u8>,
    pub v: Vec<u8>,
    pub m: Vec<u8>,
    pub sm: Vec<u8>,
    pub s: Vec<u8>,
    /// Local data of the running block.
    pub l: Vec<u8>,
    pub accumulators: [u32; 4],
    /// Words, big-endian.
    pub timer_values: Vec<u8>,
    pub timer_bits: Vec<bool>,
    pub counter_values: Vec<u8>,
    pub counter_bits: Vec<bool>,
    /// The values at the modules.
    pub physical_inputs: Vec<u8>,
}

impl Memory {
    pub fn new() -> Memory {
        let zeros = |area: Area| vec![0; area.bytes() as usize];
        Memory {
            inputs: zeros(Area::I),
            outputs: zeros(Area::Q),
            v: zeros(Area::V),
            m: zeros(Area::M),
            sm: zeros(Area::Sm),
            s: zeros(Area::S),
            l: zeros(Area::L),
            accumulators: [0; 4],
            timer_values: vec![0; 512],
            timer_bits: vec![false; 256],
            counter_values: vec![0; 512],
            counter_bits: vec![false; 256],
            physical_inputs: zeros(Area::I),
        }
    }

    pub fn store(&self, store: Store) -> &[u8] {
        match store {
            Store::Bytes(Area::I) => &self.inputs,
            Store::Bytes(Area::Q) => &self.outputs,
            Store::Bytes(Area::V) => &self.v,
            Store::Bytes(Area::M) => &self.m,
            Store::Bytes(Area::Sm) => &self.sm,
            Store::Bytes(Area::S) => &self.s,
            Store::Bytes(Area::L) => &self.l,
            Store::TimerValues => &self.timer_values,
            Store::CounterValues => &self.counter_values,
        }
    }

    pub fn store_mut(&mut self, store: Store) -> &mut Vec<u8> {
        match store {
            Store::Bytes(Area::I) => &mut self.inputs,
            Store::Bytes(Area::Q) => &mut self.outputs,
            Store::Bytes(Area::V) => &mut self.v,
            Store::Bytes(Area::M) => &mut self.m,
            Store::Bytes(Area::Sm) => &mut self.sm,
            Store::Bytes(Area::S) => &mut self.s,
            Store::Bytes(Area::L) => &mut self.l,
            Store::TimerValues => &mut self.timer_values,
            Store::CounterValues => &mut self.counter_values,
        }
    }

    /// The place of an operand that is not a constant; bytes there must be in the area for a pointer.
    pub fn place(&self, operand: &Operand, bytes: u32) -> Result<Place, Fault> {
        Ok(match operand {
            Operand::Cell(area, _, byte) => Place::In(Store::Bytes(*area), *byte),
            Operand::Timer(number) => Place::In(Store::TimerValues, u32::from(*number) * 2),
            Operand::Counter(number) => Place::In(Store::CounterValues, u32::from(*number) * 2),
            Operand::Accumulator(number) => Place::Accumulator(*number),
            Operand::Named(_, place) => return self.place(place, bytes),
            Operand::Pointed(pointer) => {
                let pointer = self.read(pointer, Width::Dword)?;
                let (store, byte) = pointed(pointer).ok_or(INDIRECT)?;
                let end = byte.checked_add(bytes).ok_or(INDIRECT)?;
                // Of timers and counters there are words only.
                let torn = !matches!(store, Store::Bytes(_)) && (bytes != 2 || byte % 2 != 0);
                if torn || end as usize > self.store(store).len() {
                    return Err(INDIRECT);
                }
                Place::In(store, byte)
            }
            Operand::Bit(..)
            | Operand::AddressOf(_)
            | Operand::Number(_)
            | Operand::Real(_)
            | Operand::Text(_)
            | Operand::Block(_) => unreachable!("{operand} has no place"),
        })
    }

    /// The value of an operand, zero-extended.
    pub fn read(&self, operand: &Operand, width: Width) -> Result<u32, Fault> {
        match operand {
            Operand::Number(value) => Ok(mask(*value as u32, width)),
            Operand::Real(value) => Ok(value.to_bits()),
            Operand::AddressOf(place) => Ok(address_of(place)),
            _ => Ok(self.get(self.place(operand, width.bytes())?, width)),
        }
    }

    pub fn get(&self, place: Place, width: Width) -> u32 {
        match place {
            Place::Accumulator(number) => mask(self.accumulators[usize::from(number)], width),
            Place::In(store, byte) => {
                let at = byte as usize;
                let bytes = &self.store(store)[at..at + width.bytes() as usize];
                bytes.iter().fold(0, |value, &byte| value << 8 | u32::from(byte))
            }
        }
    }

    pub fn set(&mut self, place: Place, width: Width, value: u32) {
        match place {
            Place::Accumulator(number) => {
                let old = self.accumulators[usize::from(number)];
                let kept = old & !mask(u32::MAX, width);
                self.accumulators[usize::from(number)] = kept | mask(value, width);
            }
            Place::In(store, byte) => {
                let count = width.bytes() as usize;
                let at = byte as usize;
                self.store_mut(store)[at..at + count].copy_from_slice(&value.to_be_bytes()[4 - count..]);
            }
        }
    }

    pub fn bit(&self, operand: &Operand) -> bool {
        match operand {
            Operand::Bit(area, byte, bit) => self.store(Store::Bytes(*area))[*byte as usize] >> bit & 1 == 1,
            Operand::Timer(number) => self.timer_bits[usize::from(*number)],
            Operand::Counter(number) => self.counter_bits[usize::from(*number)],
            Operand::Named(_, place) => self.bit(place),
            _ => unreachable!("{operand} is not a bit"),
        }
    }

    pub fn set_bit(&mut self, operand: &Operand, value: bool) {
        match operand {
            Operand::Bit(area, byte, bit) => {
                let byte = &mut self.store_mut(Store::Bytes(*area))[*byte as usize];
                *byte = *byte & !(1 << bit) | u8::from(value) << bit;
            }
            Operand::Timer(number) => self.timer_bits[usize::from(*number)] = value,
            Operand::Counter(number) => self.counter_bits[usize::from(*number)] = value,
            Operand::Named(_, place) => self.set_bit(place, value),
            _ => unreachable!("{operand} is not a bit"),
        }
    }

    /// Where a buffer of elements begins: 0006 for a bad pointer, 0091 if `bytes` leave the area.
    pub fn buffer(&self, operand: &Operand, element: u32, bytes: u32) -> Result<(Store, u32), Fault> {
        match self.place(operand, element)? {
            Place::In(store, byte) if (byte + bytes) as usize <= self.store(store).len() => Ok((store, byte)),
            Place::In(..) | Place::Accumulator(_) => Err(RANGE),
        }
    }

    pub fn bytes(&self, (store, byte): (Store, u32), count: u32) -> Vec<u8> {
        self.store(store)[byte as usize..(byte + count) as usize].to_vec()
    }

    pub fn set_bytes(&mut self, (store, byte): (Store, u32), bytes: &[u8]) {
        let at = byte as usize;
        self.store_mut(store)[at..at + bytes.len()].copy_from_slice(bytes);
    }

    /// SM1.n.
    pub fn set_flag(&mut self, bit: u8, value: bool) {
        self.set_bit(&Operand::Bit(Area::Sm, 1, bit), value);
    }
}

fn mask(value: u32, width: Width) -> u32 {
    match width {
        Width::Byte => value & 0xFF,
        Width::Word => value & 0xFFFF,
        Width::Dword => value,
    }
}

/// Area tag in the high byte, byte offset below.
fn pointed(pointer: u32) -> Option<(Store, u32)> {
    let store = match pointer >> 24 {
        0x01 => Store::Bytes(Area::I),
        0x02 => Store::Bytes(Area::Q),
        0x03 => Store::Bytes(Area::M),
        0x04 => Store::Bytes(Area::Sm),
        0x08 => Store::Bytes(Area::V),
        0x09 => Store::Bytes(Area::S),
        0x0A => Store::TimerValues,
        0x0B => Store::CounterValues,
        _ => return None,
    };
    Some((store, pointer & 0xFF_FFFF))
}

fn address_of(place: &Operand) -> u32 {
    let (tag, byte) = match place {
        Operand::Cell(Area::I, _, byte) => (0x01, *byte),
        Operand::Cell(Area::Q, _, byte) => (0x02, *byte),
        Operand::Cell(Area::M, _, byte) => (0x03, *byte),
        Operand::Cell(Area::Sm, _, byte) => (0x04, *byte),
        Operand::Cell(Area::V, _, byte) => (0x08, *byte),
        Operand::Cell(Area::S, _, byte) => (0x09, *byte),
        Operand::Timer(number) => (0x0A, u32::from(*number) * 2),
        Operand::Counter(number) => (0x0B, u32::from(*number) * 2),
        _ => unreachable!("no pointer goes to {place}"),
    };
    tag << 24 | byte
}
