//! Where the registers and bits of Modbus are in the CPU.

use plcc_abi::ProgramImage;
use plcc_abi::image::Family;
use plcc_abi::services::Registers;
use plcc_runtime::address::{self, Width};
use plcc_runtime::s7200::Part;
use plcc_runtime::signal;

use crate::s7::{Area, ItemError, Place, Plc};

/// The first of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Map {
    pub coils: Start,
    pub discrete_inputs: Start,
    pub input_registers: Start,
    pub holding_registers: Start,
}

/// A place in memory from which registers or bits are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    pub area: Area,
    pub byte: u32,
    pub bit: u8,
}

impl Map {
    /// `Err`: which address is wrong, and why.
    pub fn new(registers: &Registers, image: &ProgramImage) -> Result<Map, String> {
        let start = |key: &str, text: &str, bits: bool| {
            Start::of(text, bits, image).map_err(|error| format!("{key} in [services.registers]: {error}"))
        };
        Ok(Map {
            coils: start("coils", &registers.coils, true)?,
            discrete_inputs: start("discrete_inputs", &registers.discrete_inputs, true)?,
            input_registers: start("input_registers", &registers.input_registers, false)?,
            holding_registers: start("holding_registers", &registers.holding_registers, false)?,
        })
    }
}

/// Whether a table can begin there. `Err`: why not.
pub fn check(text: &str, has_bits: bool, image: &ProgramImage) -> Result<(), String> {
    Start::of(text, has_bits, image).map(|_| ())
}

impl Start {
    /// Of a table of bits, or of registers. `Err`: why it cannot begin there.
    fn of(text: &str, has_bits: bool, image: &ProgramImage) -> Result<Start, String> {
        match Start::find(text, image)? {
            (start, true) if has_bits => Ok(start),
            (start, false) if has_bits => {
                let near = start.first_bit(image).map_or(String::new(), |bit| format!("; did you mean `{bit}`?"));
                Err(format!("`{text}` is not a bit, and a table of bits begins here{near}"))
            }
            (start, _) if start.bit == 0 => Ok(start),
            _ => Err(format!("`{text}` is a bit; registers begin at a byte")),
        }
    }

    /// The address of the first bit.
    fn first_bit(self, image: &ProgramImage) -> Option<String> {
        let Start { area, byte, .. } = self;
        Some(match area {
            Area::Inputs => format!("I{byte}.0"),
            Area::Outputs => format!("Q{byte}.0"),
            Area::BitMemory => format!("M{byte}.0"),
            Area::Db(_) if image.profile.family == Family::S7200 => format!("V{byte}.0"),
            Area::Db(number) => format!("DB{number}.DBX{byte}.0"),
            Area::SpecialMemory => format!("SM{byte}.0"),
            Area::Peripheral
            | Area::Timers
            | Area::Counters
            | Area::AnalogInputs
            | Area::AnalogOutputs
            | Area::SystemInfo => return None,
        })
    }

    /// The place, and whether it is a bit.
    fn find(text: &str, image: &ProgramImage) -> Result<(Start, bool), String> {
        let signals = signal::all(text, image, None)?;
        let found = signals.first().and_then(|signal| signal.source.address());
        let address = found.ok_or_else(|| format!("`{text}` has no address"))?;
        let bit = if let Width::Bit(bit) = address.width { bit } else { 0 };
        let (area, byte) = match address.place {
            address::Place::Input(byte) => (Area::Inputs, byte),
            address::Place::Output(byte) => (Area::Outputs, byte),
            address::Place::BitMemory(byte) => (Area::BitMemory, byte),
            address::Place::PeripheralInput(byte) | address::Place::PeripheralOutput(byte) => (Area::Peripheral, byte),
            address::Place::Db(number, byte) => (Area::Db(number), byte),
            address::Place::S7200(Part::AnalogInput, byte) => (Area::AnalogInputs, byte),
            address::Place::S7200(Part::AnalogOutput, byte) => (Area::AnalogOutputs, byte),
            address::Place::S7200(Part::SpecialMemory, byte) => (Area::SpecialMemory, byte),
            address::Place::S7200(
                Part::Relays
                | Part::TimerBit
                | Part::TimerValue
                | Part::CounterBit
                | Part::CounterValue
                | Part::HighSpeedCounter
                | Part::Accumulator,
                _,
            ) => return Err(format!("`{text}` is not in I, Q, M, SM, V, AI or AQ")),
            address::Place::Timer(_)
            | address::Place::Counter(_)
            | address::Place::TimerValue(_)
            | address::Place::CounterValue(_) => {
                return Err(format!("`{text}` is not in I, Q, M, a data block or the I/O"));
            }
        };
        if let Area::Db(number) = area
            && let Some(db) = image.dbs.iter().find(|db| db.number == number && db.optimized)
        {
            let block = if db.name.is_empty() { format!("DB {number}") } else { format!("`{}`", db.name) };
            return Err(format!(
                "`{text}` is in a data block with optimised access, whose values have no addresses; switch off the optimised \
                 access of {block}"
            ));
        }
        Ok((Start { area, byte, bit }, matches!(address.width, Width::Bit(_))))
    }

    /// The bytes of registers.
    fn registers(self, first: u16, count: u16) -> Place {
        let start = self.byte + 2 * u32::from(first);
        Place { area: self.area, start, bit: None, count: 2 * u32::from(count) }
    }

    /// The byte and the bit in it of one bit.
    fn bit(self, number: u32) -> (u32, u8) {
        let bit = u32::from(self.bit) + number;
        (self.byte + bit / 8, (bit % 8) as u8)
    }

    pub fn read_registers(self, plc: &dyn Plc, first: u16, count: u16) -> Result<Vec<u8>, ItemError> {
        plc.read(self.registers(first, count))
    }

    pub fn write_registers(self, plc: &dyn Plc, first: u16, values: &[u8]) -> Result<(), ItemError> {
        plc.write(self.registers(first, (values.len() / 2) as u16), values)
    }

    /// Bits, the first one lowest in the first byte.
    pub fn read_bits(self, plc: &dyn Plc, first: u16, count: u16) -> Result<Vec<u8>, ItemError> {
        let (start, shift) = self.bit(first.into());
        let (end, _) = self.bit(u32::from(first) + u32::from(count) - 1);
        let bytes = plc.read(Place { area: self.area, start, bit: None, count: end - start + 1 })?;
        let mut bits = vec![0; usize::from(count).div_ceil(8)];
        for number in 0..usize::from(count) {
            let from = usize::from(shift) + number;
            bits[number / 8] |= (bytes[from / 8] >> (from % 8) & 1) << (number % 8);
        }
        Ok(bits)
    }

    /// All of them are written, or none because one does not exist.
    pub fn write_bits(self, plc: &dyn Plc, first: u16, count: u16, bits: &[u8]) -> Result<(), ItemError> {
        self.read_bits(plc, first, count)?;
        for number in 0..count {
            let (start, bit) = self.bit(u32::from(first) + u32::from(number));
            let value = bits[usize::from(number) / 8] >> (number % 8) & 1;
            plc.write(Place { area: self.area, start, bit: Some(bit), count: 1 }, &[value])?;
        }
        Ok(())
    }
}
