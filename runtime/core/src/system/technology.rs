//! Hardware interrupts ATTACH, DETACH; cyclic interrupts SET_CINT, QRY_CINT; the runtime part of CTRL_HSC and CTRL_PWM; RUNTIME.
//!
//! Source: LAD/FBD reference for S7-1200, interrupts, pulses, fast counters.

use plcc_abi::ob::ObClass;
use plcc_abi::technology::{CountMode, EVENT_ID, HSC_ID, PULSE_ID};

use super::parameters::Call;
use super::{OK, Outcome, error};

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

/// HSC, REQUEST, NEW_DIR, NEW_CV, NEW_RV, NEW_PERIOD: the requests of CTRL_HSC to a counter.
pub(super) fn hsc_control(call: &Call) -> Outcome {
    let number = call.word(0).wrapping_sub(HSC_ID);
    if !(1..=6).contains(&number) {
        return error(0x80A1);
    }
    let counters = &call.cpu.technology.counters;
    let Some(counter) = counters.iter().find(|counter| u16::from(counter.config.number) == number) else {
        return error(0x80D0);
    };
    let (request, direction, period) = (call.byte(1), call.word(2) as i16, call.word(5));
    let now = call.cpu.clock.now();
    if request & DIR != 0 && (!matches!(direction, 1 | -1) || counter.config.mode != CountMode::Single) {
        return error(0x80B1);
    }
    if request & CV != 0 && counter.config.mode == CountMode::Frequency {
        return error(0x80B2);
    }
    if request & RV != 0 && counter.config.mode == CountMode::Frequency {
        return error(0x80B3);
    }
    if request & PERIOD != 0 && (!matches!(period, 10 | 100 | 1000) || counter.config.mode != CountMode::Frequency) {
        return error(0x80B4);
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
