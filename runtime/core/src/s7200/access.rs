//! Checks and side effects when operations read and write: ends of areas, analog words, timers of 1 ms, special memory.

use std::ops::Range;

use plcc_abi::layout;
use plcc_abi::s7200::{ANALOG_ADDRESS, system};

use super::timers::OF_1_MS;
use crate::cpu::Cpu;

/// Whether `bytes` bytes from `address` on are in the area in which they begin.
pub(super) fn inside(cpu: &Cpu, address: u32, bytes: u32) -> bool {
    bytes <= room(cpu, address)
}

/// Bytes from `address` to the end of the area in which it is; 0: it is in none.
pub(super) fn room(cpu: &Cpu, address: u32) -> u32 {
    cpu.s7200_area(address).map_or(0, |(_, end)| end.saturating_sub(address))
}

/// Before bytes are read: updates the analog inputs and timers among them. Timers also before they are written: what has
/// passed until then does not count for the new value.
pub(super) fn before(cpu: &Cpu, address: u32, bytes: u32) {
    if let Some(part) = part(address, bytes, system::AI, system::ANALOG_BYTES) {
        for byte in words(part) {
            let word = cpu.driver.read(ANALOG_ADDRESS + byte, 2).unwrap_or(0);
            let word = cpu.forced_input(ANALOG_ADDRESS + byte, 2, word);
            cpu.memory.set_word(layout::SYSTEM + system::AI + byte, word as u16);
        }
    }
    if let Some(part) = part(address, bytes, system::TIMER_VALUES, 2 * plcc_abi::s7200::TIMERS) {
        sync_timers(cpu, part.start / 2..part.end.div_ceil(2));
    }
}

/// After bytes were written: analog outputs among them go to their modules, special memory has its effects.
pub(super) fn after_write(cpu: &Cpu, address: u32, bytes: u32) {
    if let Some(part) = part(address, bytes, system::AQ, system::ANALOG_BYTES) {
        cpu.s7200_analog_out(part.start, part.end - part.start);
    }
    if let Some(part) = part(address, bytes, system::SM, system::SM_BYTES) {
        cpu.s7200_look_always();
        part.for_each(|byte| cpu.s7200_special_written(byte));
    }
}

/// Brings the timers of 1 ms among these up to date.
pub(super) fn sync_timers(cpu: &Cpu, numbers: Range<u32>) {
    OF_1_MS.into_iter().filter(|number| numbers.contains(number)).for_each(|number| cpu.s7200_timer_sync(number));
}

/// Which of the bytes are in the part of the system area that has `length` bytes from `start` on, as offsets in it.
fn part(address: u32, bytes: u32, start: u32, length: u32) -> Option<Range<u32>> {
    let base = layout::SYSTEM + start;
    let first = address.max(base);
    let end = address.saturating_add(bytes).min(base + length);
    (first < end).then(|| first - base..end - base)
}

/// Offsets of the words that bytes belong to.
fn words(bytes: Range<u32>) -> impl Iterator<Item = u32> {
    (bytes.start & !1..bytes.end).step_by(2)
}

impl Cpu {
    /// Before a client reads or writes bytes of memory: brings the analog inputs and timers among them up to date.
    pub fn s7200_before_client(&self, address: u32, bytes: u32) {
        if self.s7200().is_some() {
            before(self, address, bytes);
        }
    }

    /// After a client has written bytes of memory: analog outputs among them go to their modules, and special memory has its effects when the
    /// scan ends.
    pub fn s7200_after_client(&self, address: u32, bytes: u32) {
        if self.s7200().is_none() {
            return;
        }
        if let Some(part) = part(address, bytes, system::AQ, system::ANALOG_BYTES) {
            self.s7200_analog_out(part.start, part.end - part.start);
        }
        if part(address, bytes, system::SM, system::SM_BYTES).is_some() {
            self.s7200_look_always();
        }
    }

    /// Writes the words of the copy of analog outputs to which `bytes` bytes from `first_byte` on belong to their modules.
    pub(crate) fn s7200_analog_out(&self, first_byte: u32, bytes: u32) {
        let end = first_byte.saturating_add(bytes).min(system::ANALOG_BYTES);
        for byte in words(first_byte..end) {
            // A module that is missing takes nothing; that is not an error.
            let word = u32::from(self.memory.word(layout::SYSTEM + system::AQ + byte));
            self.driver.write(ANALOG_ADDRESS + byte, 2, self.forced_output(ANALOG_ADDRESS + byte, 2, word));
        }
    }
}
