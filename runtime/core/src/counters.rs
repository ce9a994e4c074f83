//! Counters. Source: Statement List (STL), chapter 4 (counters).

use plcc_abi::layout::{self, COUNTER_CELL_BYTES, TIMERS_MAX};

use crate::bcd;
use crate::memory::Memory;

/// Largest count.
const COUNT_MAX: u16 = 999;

const UP_EDGE: u8 = 1;
const DOWN_EDGE: u8 = 2;
const SET_EDGE: u8 = 4;
const ENABLE_EDGE: u8 = 8;

fn address(number: u32) -> u32 {
    layout::C + COUNTER_CELL_BYTES * number
}

fn count(memory: &Memory, number: u32) -> u16 {
    u16::from_ne_bytes(memory.bytes(address(number)))
}

fn set_count(memory: &Memory, number: u32, count: u16) {
    memory.set_bytes(address(number), count.to_ne_bytes());
}

/// Takes `rlo` into edge memory `edge`; true on a rising edge.
fn rising(memory: &Memory, number: u32, edge: u8, rlo: bool) -> bool {
    let at = address(number) + 2;
    let edges = memory.byte(at);
    memory.set_byte(at, if rlo { edges | edge } else { edges & !edge });
    rlo && edges & edge == 0
}

/// `CU C n`.
pub fn up(memory: &Memory, number: u32, rlo: bool) {
    if number < TIMERS_MAX && rising(memory, number, UP_EDGE, rlo) {
        set_count(memory, number, (count(memory, number) + 1).min(COUNT_MAX));
    }
}

/// `CD C n`.
pub fn down(memory: &Memory, number: u32, rlo: bool) {
    if number < TIMERS_MAX && rising(memory, number, DOWN_EDGE, rlo) {
        set_count(memory, number, count(memory, number).saturating_sub(1));
    }
}

/// `S C n`: presets to the BCD value in bits 0-11 on a rising edge. True: a digit above 9, nothing done (the edge, too,
/// is not taken over, so that the next execution with RLO 1 reports again).
pub fn set(memory: &Memory, number: u32, value: u32, rlo: bool) -> bool {
    if number >= TIMERS_MAX {
        return false;
    }
    let preset = bcd::to_int(value, 3);
    let edge = rlo && memory.byte(address(number) + 2) & SET_EDGE == 0;
    if edge && preset & bcd::BAD_DIGIT != 0 {
        return true;
    }
    if rising(memory, number, SET_EDGE, rlo) {
        set_count(memory, number, preset as u16);
    }
    false
}

/// `R C n` with RLO 1; the edge memories stay.
pub fn reset(memory: &Memory, number: u32) {
    if number < TIMERS_MAX {
        set_count(memory, number, 0);
    }
}

/// `FR C n`: a rising edge of `rlo` clears the edge memories of CU, CD and S.
pub fn enable(memory: &Memory, number: u32, rlo: bool) {
    if number < TIMERS_MAX && rising(memory, number, ENABLE_EDGE, rlo) {
        memory.set_byte(address(number) + 2, ENABLE_EDGE);
    }
}

/// Count, 0..=999.
pub fn value(memory: &Memory, number: u32) -> u32 {
    if number < TIMERS_MAX { u32::from(count(memory, number)) } else { 0 }
}
