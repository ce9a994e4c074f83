//! Counters, expected values by hand from the S7-200 system manual, high-speed counter instructions.

mod hardware;
mod modes;
mod trains;

use plcc_abi::s7200::image::CpuRow;

use super::bank::{Bank, Look};
use super::modes::bit;

/// A bank with the time, the levels and the pulses of outputs that it sees.
pub struct Bench {
    pub bank: Bank,
    pub time: u64,
    pub levels: u16,
    pub pulses: [u64; 2],
}

pub fn cpu_226() -> CpuRow {
    CpuRow { high_speed_counters: 0x3F, pulse_outputs: 2, ..CpuRow::default() }
}

impl Bench {
    pub fn new() -> Bench {
        Bench { bank: Bank::default(), time: 0, levels: 0, pulses: [0; 2] }
    }

    pub fn look(&self) -> Look {
        Look { time: self.time, levels: self.levels, pulses: self.pulses, wanted: [7; 6] }
    }

    /// HDEF.
    pub fn define(&mut self, number: u32, mode: u32, control: u8) -> Result<(), u16> {
        let look = self.look();
        self.bank.define((number, mode), control, 0, &cpu_226(), &look)
    }

    /// HSC.
    pub fn control(&mut self, number: u32, control: u8, current: i32, preset: i32) {
        self.bank.counter_mut(number).unwrap().control(control, current, preset);
    }

    /// HDEF and HSC.
    pub fn counter(number: u32, mode: u32, control: u8, current: i32, preset: i32) -> Bench {
        let mut bench = Bench::new();
        bench.define(number, mode, control).unwrap();
        bench.control(number, control, current, preset);
        bench
    }

    /// Events up to now.
    pub fn events(&mut self) -> Vec<u8> {
        let look = self.look();
        self.bank.look(&look).0
    }

    /// Inputs change, a millisecond later; returns the events.
    pub fn set(&mut self, pins: &[(u8, bool)]) -> Vec<u8> {
        self.time += 1_000_000;
        for &(pin, on) in pins {
            self.levels = if on { self.levels | bit(pin) } else { self.levels & !bit(pin) };
        }
        self.events()
    }

    /// An input turns on and off; returns the events.
    pub fn pulse(&mut self, pin: u8) -> Vec<u8> {
        let mut events = self.set(&[(pin, true)]);
        events.extend(self.set(&[(pin, false)]));
        events
    }

    pub fn current(&self, number: u32) -> i32 {
        self.bank.counter(number).unwrap().current
    }

    pub fn status(&self, number: u32) -> u8 {
        self.bank.counter(number).unwrap().status()
    }
}
