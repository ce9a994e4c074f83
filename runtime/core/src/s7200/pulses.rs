//! Pulse outputs: PTO and PWM.

use super::{Operands, done};
use crate::cpu::Cpu;

/// Q0.0 and Q0.1 as pulse outputs.
#[derive(Default)]
pub struct PulseOutputs {}

impl Cpu {
    /// RUN begins: both are idle.
    pub(crate) fn s7200_start_pulses(&self) {}

    /// When an output next changes something that the program can see.
    pub(crate) fn s7200_pulses_due(&self) -> u64 {
        crate::schedule::NEVER
    }

    /// Goes on up to now and raises events.
    pub(crate) fn s7200_poll_pulses(&self) {}

    /// The level that pulse output `number` drives now, if it owns its output.
    pub(crate) fn s7200_pulse_level(&self, _number: u8) -> Option<bool> {
        None
    }
}

pub(super) fn control(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
