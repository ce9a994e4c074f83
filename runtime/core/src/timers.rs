//! S5 timers. Source: Statement List (STL), chapter 12 (timers).
//!
//! A running timer is a deadline on the clock. Nothing counts down in the background: a cell is brought up to date
//! (`Cell::settle`) at each access, and the status bit is the one of that moment. A stopped timer keeps the
//! remaining value, which stays readable until `R`.

use plcc_abi::functions::TimerMode;
use plcc_abi::layout::{self, TIMER_CELL_BYTES, TIMERS_MAX};

use crate::bcd;
use crate::clock::Clock;
use crate::memory::Memory;

/// Bit of the result of [`start`]: the BCD value is invalid, a synchronous error.
pub const START_BAD_BCD: u32 = 1;
/// Bits of the result of [`start`]: the instruction writes OV, with this value.
pub const START_WRITES_OV: u32 = 2;
pub const START_OV: u32 = 4;

const RUNNING: u8 = 1;
const STATUS: u8 = 2;
const START_EDGE: u8 = 4;
const ENABLE_EDGE: u8 = 8;

/// A timer cell, decoded.
struct Cell {
    /// While running: when the time is over.
    deadline: u64,
    /// While not running: remaining value in units of the base, 0..=999.
    value: u16,
    base: u8,
    mode: u8,
    flags: u8,
}

impl Cell {
    fn load(memory: &Memory, number: u32) -> Cell {
        let at = address(number);
        let [low, high, base, mode, flags, _, _, _] = memory.bytes::<8>(at + 8);
        Cell { deadline: memory.host64(at), value: u16::from_ne_bytes([low, high]), base, mode, flags }
    }

    fn store(&self, memory: &Memory, number: u32) {
        let at = address(number);
        let [low, high] = self.value.to_ne_bytes();
        memory.set_host64(at, self.deadline);
        memory.set_bytes(at + 8, [low, high, self.base, self.mode, self.flags, 0, 0, 0]);
    }

    fn is(&self, flag: u8) -> bool {
        self.flags & flag != 0
    }

    fn set(&mut self, flag: u8, on: bool) {
        self.flags = if on { self.flags | flag } else { self.flags & !flag };
    }

    /// Stops a timer whose deadline has passed, and sets its status to the value that it then has.
    fn settle(&mut self, clock: &Clock) {
        if self.is(RUNNING) && clock.now() >= self.deadline {
            self.set(RUNNING, false);
            self.value = 0;
            self.set(STATUS, on_expiry(self.mode));
        }
    }

    /// Remaining value in units of the base, rounded up.
    fn remaining(&self, clock: &Clock) -> u16 {
        if !self.is(RUNNING) {
            return self.value;
        }
        let left = self.deadline.saturating_sub(clock.now());
        left.div_ceil(bcd::s5_base_ns(self.base)).min(999) as u16
    }

    /// Stops and keeps the remaining value.
    fn freeze(&mut self, clock: &Clock) {
        self.value = self.remaining(clock);
        self.set(RUNNING, false);
    }

    /// Loads the time and runs; a time of 0 is over at once.
    fn run(&mut self, clock: &Clock, mode: TimerMode, units: u16, base: u8) {
        self.mode = mode as u8;
        self.base = base;
        self.value = units;
        self.deadline = clock.now().saturating_add(u64::from(units) * bcd::s5_base_ns(base));
        self.set(RUNNING, units != 0);
        if units == 0 {
            self.set(STATUS, on_expiry(self.mode));
        }
    }
}

fn address(number: u32) -> u32 {
    layout::T + TIMER_CELL_BYTES * number
}

/// Status after the time is over.
fn on_expiry(mode: u8) -> bool {
    mode == TimerMode::OnDelay as u8 || mode == TimerMode::RetentiveOnDelay as u8
}

/// SP, SE, SD, SS, SF: starts timer `number` by the edge of `rlo`, with the S5TIME `value`. Result: `START_*` bits.
pub fn start(memory: &Memory, clock: &Clock, number: u32, mode: TimerMode, value: u32, rlo: bool) -> u32 {
    if number >= TIMERS_MAX {
        return 0;
    }
    let units = bcd::to_int(value, 3);
    let bad = units & bcd::BAD_DIGIT != 0;
    let mut result = 0;
    if mode == TimerMode::OnDelay && !rlo {
        // SD with RLO 0 stops, whatever the value: an invalid one shows in OV only.
        result = START_WRITES_OV | if bad { START_OV } else { 0 };
    } else if bad {
        return START_BAD_BCD;
    }
    let mut cell = Cell::load(memory, number);
    cell.settle(clock);
    let (rising, falling) = (rlo && !cell.is(START_EDGE), !rlo && cell.is(START_EDGE));
    let (units, base) = (units as u16, (value >> 12 & 3) as u8);
    cell.set(START_EDGE, rlo);
    match mode {
        TimerMode::Pulse | TimerMode::ExtendedPulse if rising => {
            cell.set(STATUS, true);
            cell.run(clock, mode, units, base);
        }
        TimerMode::OnDelay if rising => {
            cell.set(STATUS, false);
            cell.run(clock, mode, units, base);
        }
        TimerMode::RetentiveOnDelay if rising => cell.run(clock, mode, units, base),
        TimerMode::OffDelay if rising => {
            cell.freeze(clock);
            cell.set(STATUS, true);
        }
        TimerMode::Pulse | TimerMode::OnDelay if falling => {
            cell.freeze(clock);
            cell.set(STATUS, false);
        }
        TimerMode::OffDelay if falling => {
            cell.set(STATUS, true);
            cell.run(clock, mode, units, base);
        }
        TimerMode::Pulse
        | TimerMode::ExtendedPulse
        | TimerMode::OnDelay
        | TimerMode::RetentiveOnDelay
        | TimerMode::OffDelay => {}
    }
    cell.store(memory, number);
    result
}

/// `R T n` with RLO 1: stops, clears value, base and status; the edge memories stay.
pub fn reset(memory: &Memory, number: u32) {
    if number < TIMERS_MAX {
        let mut cell = Cell::load(memory, number);
        cell.value = 0;
        cell.base = 0;
        cell.flags &= START_EDGE | ENABLE_EDGE;
        cell.store(memory, number);
    }
}

/// `FR T n`: a rising edge of `rlo` clears the edge memory of the start instruction.
pub fn enable(memory: &Memory, number: u32, rlo: bool) {
    if number < TIMERS_MAX {
        let mut cell = Cell::load(memory, number);
        if rlo && !cell.is(ENABLE_EDGE) {
            cell.set(START_EDGE, false);
        }
        cell.set(ENABLE_EDGE, rlo);
        cell.store(memory, number);
    }
}

fn settled(memory: &Memory, clock: &Clock, number: u32) -> Option<Cell> {
    (number < TIMERS_MAX).then(|| {
        let mut cell = Cell::load(memory, number);
        if cell.is(RUNNING) {
            cell.settle(clock);
            cell.store(memory, number);
        }
        cell
    })
}

/// Status of the timer at this moment (`A T n`).
pub fn scan(memory: &Memory, clock: &Clock, number: u32) -> bool {
    settled(memory, clock, number).is_some_and(|cell| cell.is(STATUS))
}

/// Remaining time in units of the base, 0..=999 (`L T n`).
pub fn value(memory: &Memory, clock: &Clock, number: u32) -> u32 {
    settled(memory, clock, number).map_or(0, |cell| u32::from(cell.remaining(clock)))
}

/// Remaining time as S5TIME (`LC T n`). The base stays after the time is over; only `R` clears it.
pub fn value_bcd(memory: &Memory, clock: &Clock, number: u32) -> u32 {
    settled(memory, clock, number)
        .map_or(0, |cell| u32::from(cell.base) << 12 | bcd::from_int(u32::from(cell.remaining(clock)), 3))
}
