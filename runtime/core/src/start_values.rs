//! Input parameters that an S7-1200/1500 hands to an organization block.
//!
//! They come from the start information, whose bytes mean the same on all families as far as both have them:
//! byte 0 event class, 1 cause or fault, 4 MultiError, 6 module, SIGN or OB of a time error, 8 USI, IO_State or lost events, 10 IChannel
//! or Channel, 11 EventType.
//! Source: LAD/FBD reference for S7-1200, organization blocks.

use plcc_abi::codes::sync;
use plcc_abi::image::BlockEntry;
use plcc_abi::ob::StartValue;

use crate::cpu::Cpu;
use crate::restart::retained;

/// IO_State when a fault comes, and when it has gone.
const IO_STATE_FAULT: u16 = 0x0010;
const IO_STATE_GOOD: u16 = 0x0001;
/// First byte of start information: an event that comes.
const CLASS_COMING: u8 = 0x39;

impl Cpu {
    /// Writes the input parameters of `block`, whose local data begin at `base`.
    pub(crate) fn set_start_inputs(&self, block: &BlockEntry, base: u32, info: &[u8; 12], first: bool) {
        for input in &block.start_inputs {
            let value = start_value(input.value, info, first);
            let at = base + input.byte;
            match input.bits {
                1 => {
                    let byte = self.memory.byte(at);
                    let mask = 1 << (input.bit & 7);
                    self.memory.set_byte(at, if value != 0 { byte | mask } else { byte & !mask });
                }
                8 => self.memory.set_byte(at, value as u8),
                _ => self.memory.set_bytes(at, value.to_be_bytes()),
            }
        }
    }
}

/// `first`: the OB has not run since the change to RUN.
fn start_value(value: StartValue, info: &[u8; 12], first: bool) -> u16 {
    let word = |at: usize| u16::from_be_bytes([info[at], info[at + 1]]);
    match value {
        StartValue::InitialCall => u16::from(first),
        StartValue::Remanence => u16::from(info[4] & retained::REMANENCE != 0),
        StartValue::LostRetentive => u16::from(info[4] & retained::LOST != 0),
        // The clock of the host is always right.
        StartValue::LostRtc => 0,
        // The clock that is set is a time error, OB 80.
        StartValue::CaughtUp | StartValue::SecondTime => 0,
        StartValue::Sign | StartValue::Laddr | StartValue::CsgObNr => word(6),
        StartValue::Usi | StartValue::EventCount => word(8),
        StartValue::IoState => match (word(8), info[0]) {
            (0, CLASS_COMING) => IO_STATE_FAULT,
            (0, _) => IO_STATE_GOOD,
            (state, _) => state,
        },
        StartValue::IChannel | StartValue::CsgPrio => u16::from(info[10]),
        StartValue::Channel => word(10),
        StartValue::EventType => u16::from(info[11]),
        StartValue::MultiError => u16::from(info[4] != 0),
        StartValue::FaultId => u16::from(info[1]),
        StartValue::EventClass => u16::from(info[0]),
        StartValue::BlockNr => word(8),
        StartValue::BlockType => match info[4] {
            0x88 => 1,
            0x8C => 2,
            0x8E => 3,
            _ => 0,
        },
        StartValue::Reaction => match info[1] {
            // A read is replaced, a write is skipped.
            sync::IO_READ | sync::LENGTH_READ | sync::AREA_READ | sync::ALIGN_READ => 1,
            sync::IO_WRITE | sync::LENGTH_WRITE | sync::AREA_WRITE | sync::ALIGN_WRITE => 2,
            _ => 0,
        },
        StartValue::Area => u16::from(info[5] & 0x0F),
        StartValue::Width => u16::from(info[5] >> 4),
        StartValue::DbNr => match info[1] {
            sync::DB_MISSING => word(6),
            _ => 0,
        },
        StartValue::FailedOb => word(10),
        StartValue::FailedPrio => u16::from(info[2]),
    }
}
