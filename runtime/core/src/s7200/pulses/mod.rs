//! Pulse outputs: PTO and PWM at Q0.0 and Q0.1 as simulated hardware.
//!
//! An output is a function of time; the part that the program sees changes at a few computed moments.
//!
//! - `train`: segments of a PTO in closed form; `width`: PWM.
//! - `output`: one output, and the effect of PLS on it.
//!
//! While a train or PWM runs the generator owns the output. When a train is over the image register has it again.
//! Source: S7-200 system manual, pulse output instruction.

mod output;
#[cfg(test)]
mod tests;
mod train;
mod width;

use std::cell::{Cell, RefCell};

use plcc_abi::layout;
use plcc_abi::s7200::{V_DB, error};

use super::{Operands, S7200, done, failed, special};
use crate::cpu::Cpu;
pub use output::Edge;
use output::{Output, Registers};
use train::{CYCLE_MIN, SEGMENT_BYTES, Segment};

/// Pulse outputs of a CPU, if it has any.
pub const PULSE_OUTPUTS: u8 = 2;

/// Special memory of an output: status, control, cycle time, pulse width, pulse count; running segment, profile table.
mod registers {
    pub const STATUS: u32 = 66;
    pub const CONTROL: u32 = 67;
    pub const CYCLE: u32 = 68;
    pub const WIDTH: u32 = 70;
    pub const COUNT: u32 = 72;
    pub const SEGMENT: u32 = 166;
    pub const TABLE: u32 = 168;
    /// From one output to the next.
    pub const STEP: u32 = 10;
}

/// Bits of the control byte that a 21x does not have: synchronous updates, profiles.
const NEW_CONTROL: u8 = 0x30;
/// Events of the end of a train.
const EVENTS: [u8; PULSE_OUTPUTS as usize] = [19, 20];

/// Q0.0 and Q0.1 as pulse outputs.
#[derive(Default)]
pub struct PulseOutputs {
    /// PLS was executed, or a trace needs edges: until then both are idle.
    used: Cell<bool>,
    outputs: RefCell<[Output; PULSE_OUTPUTS as usize]>,
}

impl PulseOutputs {
    /// Pulses that output `number` has begun up to `now`.
    pub(super) fn count(&self, number: u8, now: u64) -> u64 {
        self.outputs.borrow().get(usize::from(number)).map_or(0, |output| output.count(now))
    }

    /// When pulse `pulse` of output `number` begins, counted from 1; or an earlier time at which more is known.
    pub(super) fn time_of_pulse(&self, number: u8, pulse: u64) -> Option<u64> {
        self.outputs.borrow().get(usize::from(number))?.time_of_pulse(pulse)
    }
}

impl Cpu {
    /// RUN begins: both are idle.
    pub(crate) fn s7200_start_pulses(&self) {
        let Some(own) = self.s7200() else { return };
        for number in 0..PULSE_OUTPUTS {
            self.with_output(own, number, |output| output.start(self.clock.now()));
            if !own.image.cpu.old {
                // Bits of the last RUN go.
                self.memory.set_byte(special(register(number, registers::STATUS)), 0);
            }
            self.show_pulse_status(own, number);
        }
    }

    /// When an output next changes something that the program can see.
    pub(crate) fn s7200_pulses_due(&self) -> u64 {
        let due = |own: &S7200| own.pulses.outputs.borrow().iter().filter_map(Output::due).min();
        self.s7200().filter(|own| own.pulses.used.get()).and_then(due).unwrap_or(crate::schedule::NEVER)
    }

    /// Advances to now and raises events.
    pub(crate) fn s7200_poll_pulses(&self) {
        let Some(own) = self.s7200().filter(|own| own.pulses.used.get()) else { return };
        let now = self.clock.now();
        for number in 0..PULSE_OUTPUTS {
            let image = self.pulse_image(number);
            let stopped = self.is_stopped();
            let ended = self.with_output(own, number, |output| {
                let ended = output.advance(now, image);
                if stopped {
                    output.switch_off(now, image);
                }
                ended
            });
            self.show_pulse_status(own, number);
            self.raise_train_ends(number, ended.unwrap_or(0));
        }
    }

    fn raise_train_ends(&self, number: u8, ended: u32) {
        if let Some(&event) = EVENTS.get(usize::from(number)) {
            (0..ended).for_each(|_| self.s7200_event(event, None));
        }
    }

    /// The level that pulse output `number` drives now, if it owns its output.
    pub(crate) fn s7200_pulse_level(&self, number: u8) -> Option<bool> {
        let own = self.s7200()?;
        self.s7200_poll_pulses();
        self.with_output(own, number, |output| output.level(self.clock.now()))?
    }

    /// Pulses that output `number` has begun since RUN began.
    pub(crate) fn s7200_pulse_count(&self, number: u8) -> u64 {
        self.s7200_poll_pulses();
        self.s7200().map_or(0, |own| own.pulses.count(number, self.clock.now()))
    }

    /// A trace needs the edges of output `number`, from now on.
    pub(crate) fn s7200_record_pulses(&self, number: u8) {
        if let Some(own) = self.s7200() {
            own.pulses.used.set(true);
            self.with_output(own, number, |output| output.record_edges(self.clock.now()));
        }
    }

    /// Takes the edges of output `number` up to `time` that are not yet taken; whether some were lost; and the
    /// level at `time`, if the generator gave it.
    pub(crate) fn s7200_pulse_edges(&self, number: u8, time: u64) -> (Vec<Edge>, bool, Option<bool>) {
        self.s7200_poll_pulses();
        let taken = self.s7200().and_then(|own| {
            self.with_output(own, number, |output| {
                let (edges, cut) = output.take_edges(time);
                // An edge after `time` shows the level before it.
                let before = output.noted_edge().map(|edge| !edge.level);
                (edges, cut, before.or_else(|| output.level(self.clock.now())))
            })
        });
        taken.unwrap_or_default()
    }

    fn with_output<T>(&self, own: &S7200, number: u8, act: impl FnOnce(&mut Output) -> T) -> Option<T> {
        own.pulses.outputs.borrow_mut().get_mut(usize::from(number)).map(act)
    }

    /// The bit of the image register.
    fn pulse_image(&self, number: u8) -> bool {
        self.memory.bit(layout::Q, number)
    }

    /// Keeps status byte and segment number. A 21x has none.
    fn show_pulse_status(&self, own: &S7200, number: u8) {
        if own.image.cpu.old {
            return;
        }
        let address = special(register(number, registers::STATUS));
        let old = self.memory.byte(address);
        let shown = self.with_output(own, number, |output| (output.status(old), output.segment()));
        if let Some((status, segment)) = shown {
            self.memory.set_byte(address, status);
            self.memory.set_byte(special(register(number, registers::SEGMENT)), segment);
        }
    }

    /// Segments of the profile table of an output. `Err`: the non-fatal error.
    fn pulse_profile(&self, number: u8) -> Result<Vec<Segment>, u16> {
        let (memory, (v, length)) = (&self.memory, self.memory.db(V_DB));
        let table = u32::from(memory.word(special(register(number, registers::TABLE))));
        if table >= length {
            return Err(error::PTO_PROFILE);
        }
        let count = u32::from(memory.byte(v + table));
        match count {
            0 => return Err(error::NO_SEGMENTS),
            _ if table + 1 + SEGMENT_BYTES * count > length => return Err(error::PTO_PROFILE),
            _ => {}
        }
        let segment = |index: u32| {
            let at = v + table + 1 + SEGMENT_BYTES * index;
            let (first, delta) = (memory.word(at), memory.word(at + 2) as i16);
            Segment { first, delta, count: memory.dword(at + 4).max(1) }
        };
        let segments: Vec<Segment> = (0..count).map(segment).collect();
        let possible = segments.iter().all(|segment| segment.first >= CYCLE_MIN);
        possible.then_some(segments).ok_or(error::PTO_PROFILE)
    }
}

/// A byte of special memory of an output.
fn register(number: u8, first: u32) -> u32 {
    first + registers::STEP * u32::from(number)
}

/// PLS: output `a`.
pub(super) fn control(cpu: &Cpu, operands: &Operands) -> u64 {
    let Some(own) = cpu.s7200() else { return 0 };
    let exists = |number: &u8| *number < PULSE_OUTPUTS.min(own.image.cpu.pulse_outputs);
    let Some(number) = u8::try_from(operands.a).ok().filter(exists) else {
        return failed(cpu, operands, error::RANGE);
    };
    own.pulses.used.set(true);
    // Counters of mode 12 count the pulses until now.
    cpu.s7200_poll_counters();
    let at = |first: u32| special(register(number, first));
    let control = cpu.memory.byte(at(registers::CONTROL));
    let registers = Registers {
        control: if own.image.cpu.old { control & !NEW_CONTROL } else { control },
        cycle: cpu.memory.word(at(registers::CYCLE)),
        width: cpu.memory.word(at(registers::WIDTH)),
        count: cpu.memory.dword(at(registers::COUNT)),
    };
    let (now, image) = (cpu.clock.now(), cpu.pulse_image(number));
    let result = cpu.with_output(own, number, |output| {
        let ended = output.advance(now, image);
        (ended, output.control(now, image, &registers, || cpu.pulse_profile(number)))
    });
    cpu.show_pulse_status(own, number);
    let (ended, result) = result.unwrap_or((0, Ok(())));
    cpu.raise_train_ends(number, ended);
    cpu.rearm();
    match result {
        Ok(()) => done(),
        Err(code) => failed(cpu, operands, code),
    }
}
