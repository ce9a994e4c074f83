//! What calls of a chart work on: the memory of the CPU with its timers, and the inputs of the block.

use super::chart::{Area, Bit, Input};

/// Memory that charts work on.
#[derive(Clone, Debug)]
pub struct Memory {
    pub inputs: [u8; 8],
    pub outputs: [u8; 8],
    pub bit_memory: [u8; 256],
    /// Static variables of the block.
    pub statics: [u8; 1],
    pub counters: [u16; 16],
    timers: [Timer; 16],
    /// Time of the cycle in milliseconds.
    pub now: i64,
}

/// A timer. Source: Statement List (STL), chapter 12.
#[derive(Clone, Copy, Debug, Default)]
struct Timer {
    /// Status until `deadline`, and from then on.
    during: bool,
    after: bool,
    deadline: i64,
    /// The last value of an off-delay.
    rlo: bool,
}

impl Memory {
    pub fn new() -> Memory {
        Memory {
            inputs: [0; 8],
            outputs: [0; 8],
            bit_memory: [0; 256],
            statics: [0; 1],
            counters: [0; 16],
            timers: [Timer::default(); 16],
            now: 0,
        }
    }

    /// Status of a timer.
    pub fn timer(&self, number: u8) -> bool {
        let timer = &self.timers[usize::from(number)];
        if self.now < timer.deadline { timer.during } else { timer.after }
    }

    /// The status is `during` for so long, then `after`.
    pub fn start(&mut self, number: u8, during: bool, ms: i64, after: bool) {
        let timer = &mut self.timers[usize::from(number)];
        (timer.during, timer.after, timer.deadline) = (during, after, self.now + ms);
    }

    /// An off-delay sees whether its row is on.
    pub fn off_delay(&mut self, number: u8, rlo: bool, ms: i64) {
        let was = std::mem::replace(&mut self.timers[usize::from(number)].rlo, rlo);
        match (was, rlo) {
            (false, true) => self.start(number, true, 0, true),
            (true, false) => self.start(number, true, ms, false),
            (true, true) | (false, false) => {}
        }
    }

    fn byte(&mut self, area: Area, byte: u8) -> &mut u8 {
        let byte = usize::from(byte);
        match area {
            Area::I => &mut self.inputs[byte],
            Area::Q => &mut self.outputs[byte],
            Area::M => &mut self.bit_memory[byte],
            Area::Static => &mut self.statics[byte],
        }
    }

    pub fn bit(&self, bit: Bit) -> bool {
        let bytes: &[u8] = match bit.area {
            Area::I => &self.inputs,
            Area::Q => &self.outputs,
            Area::M => &self.bit_memory,
            Area::Static => &self.statics,
        };
        bytes[usize::from(bit.byte)] >> bit.bit & 1 != 0
    }

    pub fn set(&mut self, bit: Bit, value: bool) {
        let mask = 1 << bit.bit;
        let byte = self.byte(bit.area, bit.byte);
        *byte = if value { *byte | mask } else { *byte & !mask };
    }

    pub fn word(&self, byte: u8) -> i16 {
        let at = usize::from(byte);
        i16::from_be_bytes([self.bit_memory[at], self.bit_memory[at + 1]])
    }

    pub fn set_word(&mut self, byte: u8, value: i16) {
        let at = usize::from(byte);
        self.bit_memory[at..at + 2].copy_from_slice(&value.to_be_bytes());
    }

    pub fn dword(&self, byte: u8) -> i64 {
        let at = usize::from(byte);
        let bytes = self.bit_memory[at..at + 4].try_into().expect("four bytes");
        i64::from(i32::from_be_bytes(bytes))
    }
}

/// The inputs from the caller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inputs {
    /// By the order of [`Input::ALL`].
    pub bits: [bool; Input::ALL.len()],
    pub s_sel: i16,
}

impl Inputs {
    pub fn new() -> Inputs {
        Inputs { bits: [false; Input::ALL.len()], s_sel: 0 }
    }
}
