//! Hardware interrupts ATTACH, DETACH; cyclic interrupts SET_CINT, QRY_CINT; the runtime part of CTRL_HSC,
//! CTRL_HSC_EXT and CTRL_PWM; RUNTIME.
//!
//! Source: LAD/FBD reference for S7-1200, interrupts, pulses, fast counters.

use plcc_abi::ob::ObClass;
use plcc_abi::technology::{CountMode, EVENT_ID, HSC_ID, PULSE_ID};

use super::any::{self, Access};
use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::technology::Counter;

const NS_PER_S: f64 = 1e9;
/// Longest period and phase of a cyclic interrupt, in microseconds.
const PERIOD_US_MAX: u32 = 60_000_000;

/// The OB of a call, checked. `Err`: 8090 it is not loaded, 8091 it is of another class.
fn hardware_ob(call: &Call) -> Result<u16, u16> {
    let ob = call.word(0);
    match call.cpu.has_ob(ob) {
        false => Err(0x8090),
        true if call.cpu.image.config.class_of(ob) != Some(ObClass::Hardware) => Err(0x8091),
        true => Ok(ob),
    }
}

/// Place of an event in the list of hardware interrupts. `Err`: 8093.
fn event(call: &Call) -> Result<usize, u16> {
    let index = call.dword(1).checked_sub(EVENT_ID + 1).map(|index| index as usize);
    index.filter(|&index| index < call.cpu.image.config.hardware_events.len()).ok_or(0x8093)
}

/// OB_NR, EVENT, ADD.
pub(super) fn attach(call: &Call) -> Outcome {
    let (ob, event) = match (hardware_ob(call), event(call)) {
        (Ok(ob), Ok(event)) => (ob, event),
        (Err(code), _) | (_, Err(code)) => return error(code),
    };
    if call.byte(2) & 1 == 0 {
        call.cpu.release_interrupts(ob);
    }
    call.cpu.assign_interrupt(event, ob);
    call.cpu.rearm();
    OK
}

/// OB_NR, EVENT; 0 all events of the OB. 1: there was no assignment.
pub(super) fn detach(call: &Call) -> Outcome {
    let ob = match hardware_ob(call) {
        Ok(ob) => ob,
        Err(code) => return error(code),
    };
    let any = match (call.dword(1), event(call)) {
        (0, _) => call.cpu.release_interrupts(ob),
        (_, Err(code)) => return error(code),
        (_, Ok(event)) => match call.cpu.assign_interrupt(event, 0) {
            Some(before) if before == ob => true,
            // It was another OB's, and stays so.
            Some(before) => {
                call.cpu.assign_interrupt(event, before);
                false
            }
            None => false,
        },
    };
    Outcome::RetVal(u16::from(!any))
}

/// OB_NR, CYCLE, PHASE in microseconds; CYCLE 0 stops the interrupt. 8090 OB, 8091 CYCLE, 8092 PHASE.
pub(super) fn set_cint(call: &Call) -> Outcome {
    let (period, phase) = (call.dword(1), call.dword(2));
    let Some(cyclic) = call.cpu.schedule.cyclic_of(call.word(0)) else { return error(0x8090) };
    if period > PERIOD_US_MAX {
        return error(0x8091);
    }
    if phase > PERIOD_US_MAX {
        return error(0x8092);
    }
    cyclic.set(call.cpu.clock.now(), period, phase, call.cpu.schedule.in_run.get());
    call.cpu.rearm();
    OK
}

/// OB_NR -> RET_VAL, CYCLE, PHASE, STATUS. 8090 OB. STATUS as for SFC 34.
pub(super) fn qry_cint(call: &Call) -> Outcome {
    let cyclic = call.cpu.schedule.cyclic_of(call.word(0));
    let (period, phase) = cyclic.map_or((0, 0), |cyclic| cyclic.times_us());
    call.set_dword(2, period);
    call.set_dword(3, phase);
    if cyclic.is_none() {
        call.set_word(4, 0);
        return error(0x8090);
    }
    call.set_word(4, super::time_of_day::status(call, period != 0));
    OK
}

/// -> RET_VAL, MEM: seconds since the call that left its moment in MEM.
pub(super) fn runtime(call: &Call) -> Outcome {
    let now = call.cpu.clock.now() as f64 / NS_PER_S;
    let before = f64::from_bits(call.lword(1));
    call.set_lword(1, now.to_bits());
    call.set_lword(0, (now - before).to_bits());
    Outcome::Plain
}

/// Bits of REQUEST.
const DIR: u8 = 1;
const CV: u8 = 2;
const RV: u8 = 4;
const PERIOD: u8 = 8;

/// Errors of CTRL_HSC and CTRL_HSC_EXT: no such counter; a new value that is wrong or not possible in the mode; the counter is not enabled.
const NO_COUNTER: u16 = 0x80A1;
const DIRECTION: u16 = 0x80B1;
const COUNT: u16 = 0x80B2;
const REFERENCE: u16 = 0x80B3;
const MEASURING: u16 = 0x80B4;
const NOT_ENABLED: u16 = 0x80D0;
/// Of CTRL_HSC_EXT alone: at an end of the count; at the limits; at a reset.
const AT_END: u16 = 0x80B5;
const LIMITS: u16 = 0x80B6;
const AT_RESET: u16 = 0x80B7;
/// CTRL is not of the type that the mode needs. Assumption: the code of a real CPU is not in our sources.
const CTRL_TYPE: u16 = 0x80A2;

/// The counter that the first parameter means.
fn fast_counter<'a>(call: &Call<'a>) -> Result<&'a Counter, u16> {
    let number = call.word(0).wrapping_sub(HSC_ID);
    if !(1..=6).contains(&number) {
        return Err(NO_COUNTER);
    }
    let counters = &call.cpu.technology.counters;
    counters.iter().find(|counter| u16::from(counter.config.number) == number).ok_or(NOT_ENABLED)
}

/// True of a period in which a counter can measure, in milliseconds.
fn is_period(ms: u16) -> bool {
    matches!(ms, 10 | 100 | 1000)
}

/// HSC, REQUEST, NEW_DIR, NEW_CV, NEW_RV, NEW_PERIOD: the requests of CTRL_HSC to a counter.
pub(super) fn hsc_control(call: &Call) -> Outcome {
    let counter = match fast_counter(call) {
        Ok(counter) => counter,
        Err(code) => return error(code),
    };
    let (request, direction, period) = (call.byte(1), call.word(2) as i16, call.word(5));
    let now = call.cpu.clock.now();
    if request & DIR != 0 && (!matches!(direction, 1 | -1) || counter.config.mode != CountMode::Single) {
        return error(DIRECTION);
    }
    if request & CV != 0 && counter.config.mode.is_measuring() {
        return error(COUNT);
    }
    if request & RV != 0 && counter.config.mode.is_measuring() {
        return error(REFERENCE);
    }
    if request & PERIOD != 0 && !(is_period(period) && counter.config.mode.is_measuring()) {
        return error(MEASURING);
    }
    // Earlier events count with the old reference.
    call.cpu.poll_counters();
    if request & DIR != 0 {
        counter.set_down(now, direction == -1);
    }
    if request & CV != 0 {
        counter.set_count(now, call.dword(3) as i32);
    }
    if request & RV != 0 {
        counter.set_reference(call.dword(4) as i32);
    }
    if request & PERIOD != 0 {
        counter.set_period(period);
    }
    call.cpu.rearm();
    OK
}

/// Bytes of HSC_Count, HSC_Period and HSC_Frequency.
const COUNT_BYTES: u32 = 44;
const PERIOD_BYTES: u32 = 12;
const FREQUENCY_BYTES: u32 = 8;

/// HSC -> STATUS, CTRL: the requests of CTRL_HSC_EXT to a counter, then its values.
pub(super) fn hsc_extended(call: &Call) -> Outcome {
    const CTRL: usize = 2;
    let counter = match fast_counter(call) {
        Ok(counter) => counter,
        Err(code) => return error(code),
    };
    let range = any::decode(call, CTRL, Access::Write).ok().flatten();
    let Some(range) = range.filter(|range| range.existing == range.bytes) else { return error(CTRL_TYPE) };
    let result = match (counter.config.mode, range.bytes) {
        (CountMode::Frequency, FREQUENCY_BYTES) => measure_frequency(call, counter, range.offset),
        (CountMode::Period, PERIOD_BYTES) => measure_period(call, counter, range.offset),
        (
            CountMode::Single | CountMode::SingleExternal | CountMode::TwoPhase | CountMode::Quadrature(_),
            COUNT_BYTES,
        ) => count(call, counter, range.offset),
        (
            CountMode::Frequency
            | CountMode::Period
            | CountMode::Single
            | CountMode::SingleExternal
            | CountMode::TwoPhase
            | CountMode::Quadrature(_),
            _,
        ) => Err(CTRL_TYPE),
    };
    match result {
        Ok(()) => OK,
        Err(code) => error(code),
    }
}

/// EnHSC, EnPeriod at `flags` and NewPeriod in the word after them.
fn set_measuring(call: &Call, counter: &Counter, flags: u32) -> Result<(), u16> {
    let memory = &call.cpu.memory;
    let (requests, period) = (memory.byte(flags), memory.word(flags + 2));
    if requests & 2 != 0 {
        if !is_period(period) {
            return Err(MEASURING);
        }
        counter.set_period(period);
    }
    counter.set_enabled(call.cpu.clock.now(), requests & 1 != 0);
    Ok(())
}

/// HSC_Frequency at `at`.
fn measure_frequency(call: &Call, counter: &Counter, at: u32) -> Result<(), u16> {
    set_measuring(call, counter, at + 4)?;
    call.cpu.memory.set_dword(at, counter.value(call.cpu.clock.now()) as u32);
    Ok(())
}

/// HSC_Period at `at`.
fn measure_period(call: &Call, counter: &Counter, at: u32) -> Result<(), u16> {
    set_measuring(call, counter, at + 8)?;
    let (time, edges) = counter.measured(call.cpu.clock.now());
    call.cpu.memory.set_dword(at, time);
    call.cpu.memory.set_dword(at + 4, edges);
    Ok(())
}

/// Bits of HSC_Count, from its byte 8 on, with that byte as the highest one.
mod request {
    pub const ENABLE: u32 = 1 << 22;
    pub const RESET_INPUT: u32 = 1 << 8;
    pub const DIRECTION: u32 = 1 << 9;
    pub const COUNT: u32 = 1 << 10;
    pub const START_VALUE: u32 = 1 << 11;
    pub const REFERENCE: u32 = 1 << 12;
    pub const SECOND_REFERENCE: u32 = 1 << 13;
    pub const UPPER_LIMIT: u32 = 1 << 14;
    pub const LOWER_LIMIT: u32 = 1 << 15;
    pub const AT_END: u32 = 1;
    pub const AT_LIMIT: u32 = 1 << 1;
    pub const AT_RESET: u32 = 1 << 2;
}

/// HSC_Count at `at`. The limits of a count are the ends of a DINT, where it goes on at the other one.
fn count(call: &Call, counter: &Counter, at: u32) -> Result<(), u16> {
    const GO_ON: u16 = 2;
    const OPPOSITE_LIMIT: u16 = 1;
    const SET: u16 = 1;
    const KEEP: u16 = 2;
    let memory = &call.cpu.memory;
    let requests =
        u32::from(memory.byte(at + 8)) << 16 | u32::from(memory.byte(at + 9)) << 8 | u32::from(memory.byte(at + 10));
    let has = |bit: u32| requests & bit != 0;
    let number = |offset: u32| memory.dword(at + offset) as i32;
    let direction = memory.word(at + 12) as i16;
    let at_reset = memory.word(at + 18);
    if has(request::DIRECTION) && (!matches!(direction, 1 | -1) || counter.config.mode != CountMode::Single) {
        return Err(DIRECTION);
    }
    if has(request::AT_END) && memory.word(at + 14) != GO_ON {
        return Err(AT_END);
    }
    let has_other_limit = has(request::UPPER_LIMIT) && number(36) != i32::MAX
        || has(request::LOWER_LIMIT) && number(40) != i32::MIN
        || has(request::AT_LIMIT) && memory.word(at + 16) != OPPOSITE_LIMIT;
    if has_other_limit {
        return Err(LIMITS);
    }
    if has(request::AT_RESET) && !matches!(at_reset, SET | KEEP) {
        return Err(AT_RESET);
    }
    // Earlier events count with the old reference.
    call.cpu.poll_counters();
    let now = call.cpu.clock.now();
    let passed = counter.take_passed();
    if has(request::DIRECTION) {
        counter.set_down(now, direction == -1);
    }
    if has(request::COUNT) {
        counter.set_count(now, number(20));
    }
    if has(request::START_VALUE) {
        counter.set_start_value(number(24));
    }
    if has(request::REFERENCE) {
        counter.set_reference(number(28));
    }
    if has(request::SECOND_REFERENCE) {
        counter.set_second_reference(number(32));
    }
    if has(request::AT_RESET) {
        counter.set_reset_sets(at_reset == SET);
    }
    counter.set_resets(has(request::RESET_INPUT));
    counter.set_enabled(now, has(request::ENABLE));
    call.cpu.rearm();
    let states =
        [counter.is_reset(), passed.turned, passed.reference, passed.second_reference, passed.below, passed.above];
    let states = states.iter().zip(0u8..).fold(0u8, |bits, (&state, bit)| bits | u8::from(state) << bit);
    memory.set_dword(at, counter.count(now) as u32);
    memory.set_dword(at + 4, 0);
    memory.set_byte(at + 8, memory.byte(at + 8) & 0xC0 | states);
    Ok(())
}

/// PWM, ENABLE.
pub(super) fn pwm_control(call: &Call) -> Outcome {
    let number = call.word(0).wrapping_sub(PULSE_ID);
    if !(1..=4).contains(&number) {
        return error(0x80A1);
    }
    let pulses = &call.cpu.technology.pulses;
    match pulses.iter().find(|pulse| u16::from(pulse.config.number) == number) {
        None => error(0x80D0),
        Some(pulse) => {
            pulse.enabled.set(call.byte(1) & 1 != 0);
            OK
        }
    }
}
