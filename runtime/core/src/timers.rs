//! S5 timers. Source: Statement List (STL), chapter 12 (timers).
//!
//! A running timer is a deadline on the clock. Nothing counts down in the background: a cell is brought up to date
//! (`Cell::settle`) at an access after something became due, and the status bit is the one of that moment. A stopped timer
//! keeps the remaining value, which stays readable until `R`.
//!
//! Generated code scans, starts, stops and resets timers itself as long as nothing is due and the clock is virtual;
//! see `cells` of the lowering. The rest is here, and does the same.

use plcc_abi::functions::TimerMode;
use plcc_abi::layout::{self, TIMER_CELL_BYTES, TIMERS_MAX, timer_cell};

use crate::bcd;
use crate::clock::Clock;
use crate::memory::Memory;

/// A timer cell, decoded, up to date.
struct Cell {
    /// While it runs: when the time is over.
    deadline: Option<u64>,
    /// Remaining value in units of the base, 0..=999.
    value: u16,
    base: u8,
    status: bool,
    /// Status when the time is over.
    status_after: bool,
    start_edge: bool,
}

impl Cell {
    /// The cell of a timer that exists.
    fn load(memory: &Memory, clock: &Clock, number: u32) -> Cell {
        let at = address(number);
        let end = memory.host64(at + timer_cell::END);
        let info = memory.host32(at + timer_cell::INFO);
        let mut cell = Cell {
            deadline: (end != 0).then_some(u64::MAX - end),
            value: info as u16,
            base: (info >> timer_cell::BASE_SHIFT & 3) as u8,
            status: info & timer_cell::STATUS != 0,
            status_after: info & timer_cell::STATUS_AFTER != 0,
            start_edge: memory.byte(at + timer_cell::START_EDGE) != 0,
        };
        cell.settle(clock);
        cell
    }

    fn store(&self, memory: &Memory, number: u32) {
        let at = address(number);
        // The value was last one more a unit before the time at which it changes next.
        let step = |deadline: u64| deadline - u64::from(self.value.saturating_sub(1)) * bcd::s5_base_ns(self.base);
        memory.set_host64(at + timer_cell::END, self.deadline.map_or(0, |deadline| u64::MAX - deadline));
        memory.set_host64(at + timer_cell::STEP, self.deadline.map_or(0, |deadline| u64::MAX - step(deadline)));
        let status = if self.status { timer_cell::STATUS } else { 0 };
        let after = if self.status_after { timer_cell::STATUS_AFTER } else { 0 };
        let base = u32::from(self.base) << timer_cell::BASE_SHIFT;
        memory.set_host32(at + timer_cell::INFO, u32::from(self.value) | base | status | after);
        memory.set_byte(at + timer_cell::START_EDGE, self.start_edge.into());
    }

    /// Renews the value of a running timer, in units of the base, rounded up. Stops it if its time is over, and sets its
    /// status to the value that it then has.
    fn settle(&mut self, clock: &Clock) {
        let Some(deadline) = self.deadline else { return };
        let left = deadline.saturating_sub(clock.now());
        self.value = left.div_ceil(bcd::s5_base_ns(self.base)).min(999) as u16;
        if left == 0 {
            self.deadline = None;
            self.status = self.status_after;
        }
    }

    /// Stops with `status` and keeps the remaining value. The cell becomes what generated code makes of it.
    fn freeze(&mut self, status: bool) {
        self.deadline = None;
        self.status = status;
        self.status_after = false;
    }

    /// Loads the time and runs with `status`; a time of 0 is over at once.
    fn run(&mut self, clock: &Clock, mode: TimerMode, units: u16, base: u8, status: bool) {
        self.base = base;
        self.value = units;
        self.status_after = matches!(mode, TimerMode::OnDelay | TimerMode::RetentiveOnDelay);
        self.status = if units == 0 { self.status_after } else { status };
        let deadline = clock.now().saturating_add(u64::from(units) * bcd::s5_base_ns(base));
        self.deadline = (units != 0).then_some(deadline);
    }
}

fn address(number: u32) -> u32 {
    layout::T + TIMER_CELL_BYTES * number
}

/// SP, SE, SD, SS, SF: starts timer `number` by the edge of `rlo`, with the S5TIME `value`. Its digits matter only if they are used.
pub fn start(memory: &Memory, clock: &Clock, number: u32, mode: TimerMode, value: u32, rlo: bool) {
    if number >= TIMERS_MAX {
        return;
    }
    let (units, base) = (bcd::to_int(value, 3) as u16, (value >> 12 & 3) as u8);
    let mut cell = Cell::load(memory, clock, number);
    let (rising, falling) = (rlo && !cell.start_edge, !rlo && cell.start_edge);
    cell.start_edge = rlo;
    match mode {
        TimerMode::Pulse | TimerMode::ExtendedPulse if rising => cell.run(clock, mode, units, base, true),
        TimerMode::OnDelay if rising => cell.run(clock, mode, units, base, false),
        TimerMode::RetentiveOnDelay if rising => cell.run(clock, mode, units, base, cell.status),
        TimerMode::OffDelay if rising => cell.freeze(true),
        TimerMode::Pulse | TimerMode::OnDelay if falling => cell.freeze(false),
        TimerMode::OffDelay if falling => cell.run(clock, mode, units, base, true),
        TimerMode::Pulse
        | TimerMode::ExtendedPulse
        | TimerMode::OnDelay
        | TimerMode::RetentiveOnDelay
        | TimerMode::OffDelay => {}
    }
    cell.store(memory, number);
}

/// Brings the cell of timer `number` up to date.
pub fn settle(memory: &Memory, clock: &Clock, number: u32) {
    if number < TIMERS_MAX {
        Cell::load(memory, clock, number).store(memory, number);
    }
}

/// Remaining time of the timer as an S5TIME (`LC T n`); 0 if there is no such timer.
pub fn remaining(memory: &Memory, clock: &Clock, number: u32) -> u16 {
    if number >= TIMERS_MAX {
        return 0;
    }
    let cell = Cell::load(memory, clock, number);
    u16::from(cell.base) << 12 | bcd::from_int(cell.value.into(), 3) as u16
}

/// Gives a timer another remaining time, an S5TIME with digits from 0 to 9; whether it runs and its status stay.
pub fn set_value(memory: &Memory, clock: &Clock, number: u32, value: u16) {
    if number >= TIMERS_MAX {
        return;
    }
    let mut cell = Cell::load(memory, clock, number);
    (cell.value, cell.base) = (bcd::to_int(value.into(), 3) as u16, (value >> 12 & 3) as u8);
    if cell.deadline.is_some() {
        cell.deadline = Some(clock.now().saturating_add(u64::from(cell.value) * bcd::s5_base_ns(cell.base)));
    }
    cell.settle(clock);
    cell.store(memory, number);
}

/// Bytes of a timer in retentive memory.
pub(crate) const KEPT_BYTES: usize = 8 + 4 + 1;

/// A timer as retentive memory has it: the nanoseconds that are left (`u64::MAX`: it does not run), value, base and status, edge of the
/// start. The inputs of a timer stand still while the CPU is off.
pub(crate) fn kept(memory: &Memory, clock: &Clock, number: u32) -> [u8; KEPT_BYTES] {
    let cell = Cell::load(memory, clock, number);
    let left = cell.deadline.map_or(u64::MAX, |deadline| deadline.saturating_sub(clock.now()));
    cell.store(memory, number);
    let at = address(number);
    let mut kept = [0; KEPT_BYTES];
    kept[..8].copy_from_slice(&left.to_le_bytes());
    kept[8..12].copy_from_slice(&memory.host32(at + timer_cell::INFO).to_le_bytes());
    kept[12] = memory.byte(at + timer_cell::START_EDGE);
    kept
}

/// Continues a timer where it was when it was [kept].
pub(crate) fn bring_back(memory: &Memory, clock: &Clock, number: u32, kept: &[u8]) {
    let (Some(left), Some(info), Some(&edge)) = (kept.first_chunk::<8>(), kept.get(8..12), kept.get(12)) else {
        return;
    };
    let left = u64::from_le_bytes(*left);
    let info = info.try_into().map_or(0, u32::from_le_bytes);
    let at = address(number);
    memory.set_host32(at + timer_cell::INFO, info);
    memory.set_byte(at + timer_cell::START_EDGE, edge & 1);
    let deadline = (left != u64::MAX).then(|| clock.now().saturating_add(left.min(LONGEST)));
    memory.set_host64(at + timer_cell::END, deadline.map_or(0, |deadline| u64::MAX - deadline));
    let mut cell = Cell::load(memory, clock, number);
    cell.value = cell.value.min(999);
    cell.store(memory, number);
}

/// The longest S5TIME in nanoseconds.
const LONGEST: u64 = 9990 * 1_000_000_000;

/// Status of the timer at this moment (`A T n`); false if there is no such timer.
pub fn scan(memory: &Memory, clock: &Clock, number: u32) -> bool {
    number < TIMERS_MAX && Cell::load(memory, clock, number).status
}
