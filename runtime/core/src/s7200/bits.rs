//! S, R, SI, RI. Source: S7-200 system manual, bit logic instructions.

use plcc_abi::layout;
use plcc_abi::s7200::{COUNTERS, TIMERS, error, system};

use super::{Operands, access, done, failed};
use crate::cpu::{Area, Cpu};
use crate::memory::Memory;

/// Largest count of S and R.
const COUNT_MAX: u32 = 255;
/// Largest count of SI and RI.
const COUNT_NOW_MAX: u32 = 128;

/// The bits of a byte that a run of `count` bits from bit `first` on has, byte by byte: index of the byte, mask.
fn masks(first: u32, count: u32) -> impl Iterator<Item = (u32, u8)> {
    let end = first.saturating_add(count);
    let bytes = if count == 0 { 0..0 } else { first / 8..end.div_ceil(8) };
    bytes.map(move |byte| {
        let (start, after) = (byte * 8, end - byte * 8);
        let head = 0xFFu8.wrapping_shl(first.saturating_sub(start));
        let tail = if after >= 8 { 0xFF } else { (1u8 << after) - 1 };
        (byte, head & tail)
    })
}

fn with_bits(old: u8, mask: u8, on: bool) -> u8 {
    if on { old | mask } else { old & !mask }
}

/// Whether a run of at most `most` bits or numbers from `first` on ends before `end`. None at all is an error too.
fn is_run(first: u32, count: u32, most: u32, end: u32) -> bool {
    (1..=most).contains(&count) && first.checked_add(count).is_some_and(|after| after <= end)
}

pub(super) fn write(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: first, b: count, c: value, .. } = operands;
    let end = cpu.s7200_area(first / 8).map_or(0, |(_, end)| end.saturating_mul(8));
    if !is_run(first, count, COUNT_MAX, end) {
        return failed(cpu, operands, error::RANGE);
    }
    for (byte, mask) in masks(first, count) {
        let new =
            if mask == 0xFF { u8::from(value != 0) * 0xFF } else { with_bits(cpu.memory.byte(byte), mask, value != 0) };
        cpu.memory.set_byte(byte, new);
    }
    access::after_write(cpu, first / 8, (first % 8 + count).div_ceil(8));
    done()
}

/// An output that a pulse output owns keeps the level of that at the module.
pub(super) fn write_outputs_now(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: first, b: count, c: value, .. } = operands;
    let (base, length) = cpu.area(Area::Outputs);
    if !is_run(first, count, COUNT_NOW_MAX, length.saturating_mul(8)) {
        return failed(cpu, operands, error::RANGE);
    }
    for (byte, mask) in masks(first, count) {
        cpu.memory.set_byte(base + byte, with_bits(cpu.memory.byte(base + byte), mask, value != 0));
        let shown = with_bits(cpu.driver.output(byte, 1) as u8, mask, value != 0);
        let mut shown = cpu.forced_output(byte, 1, shown.into()) as u8;
        for number in (0..2u8).filter(|_| byte == 0) {
            if let Some(level) = cpu.s7200_pulse_level(number) {
                shown = with_bits(shown, 1 << number, level);
            }
        }
        // A module that is missing takes nothing; that is not an error.
        cpu.driver.write(byte, 1, u32::from(shown));
    }
    done()
}

/// Sets the bits of timers or counters, one byte each.
fn set_all(memory: &Memory, bits: u32, first: u32, count: u32) {
    let ones = [1u8; COUNT_MAX as usize];
    memory.load(layout::SYSTEM + bits + first, ones.get(..count as usize).unwrap_or_default());
}

fn is_run_of_timers(cpu: &Cpu, operands: &Operands) -> bool {
    is_run(operands.a, operands.b, COUNT_MAX, cpu.image.profile.timers.min(TIMERS))
}

fn is_run_of_counters(cpu: &Cpu, operands: &Operands) -> bool {
    is_run(operands.a, operands.b, COUNT_MAX, cpu.image.profile.counters.min(COUNTERS))
}

pub(super) fn reset_timers(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: first, b: count, .. } = operands;
    if !is_run_of_timers(cpu, operands) {
        return failed(cpu, operands, error::RANGE);
    }
    access::sync_timers(cpu, first..first + count);
    cpu.memory.clear(layout::SYSTEM + system::TIMER_VALUES + 2 * first, 2 * count);
    cpu.memory.clear(layout::SYSTEM + system::TIMER_BITS + first, count);
    cpu.memory.clear(layout::SYSTEM + system::TIMER_INPUTS + first, count);
    done()
}

pub(super) fn reset_counters(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: first, b: count, .. } = operands;
    if !is_run_of_counters(cpu, operands) {
        return failed(cpu, operands, error::RANGE);
    }
    cpu.memory.clear(layout::SYSTEM + system::COUNTER_VALUES + 2 * first, 2 * count);
    cpu.memory.clear(layout::SYSTEM + system::COUNTER_BITS + first, count);
    done()
}

pub(super) fn set_timers(cpu: &Cpu, operands: &Operands) -> u64 {
    if !is_run_of_timers(cpu, operands) {
        return failed(cpu, operands, error::RANGE);
    }
    access::sync_timers(cpu, operands.a..operands.a + operands.b);
    set_all(&cpu.memory, system::TIMER_BITS, operands.a, operands.b);
    done()
}

pub(super) fn set_counters(cpu: &Cpu, operands: &Operands) -> u64 {
    if !is_run_of_counters(cpu, operands) {
        return failed(cpu, operands, error::RANGE);
    }
    set_all(&cpu.memory, system::COUNTER_BITS, operands.a, operands.b);
    done()
}
