//! High-speed counters.

use super::{Operands, done};
use crate::cpu::Cpu;

/// The six counters.
#[derive(Default)]
pub struct Counters {}

impl Cpu {
    /// Current value of counter `number`, as HCn reads it.
    pub(crate) fn s7200_counter(&self, _number: u32) -> u32 {
        0
    }

    /// RUN begins: no counter is defined.
    pub(crate) fn s7200_start_counters(&self) {}

    /// When a counter next makes an event or reaches its preset.
    pub(crate) fn s7200_counters_due(&self) -> u64 {
        crate::schedule::NEVER
    }

    /// Counts up to now and raises events.
    pub(crate) fn s7200_poll_counters(&self) {}

    /// Whether a counter in use owns input I0.`bit` (0 to 3): it cannot raise events 0 to 7 then.
    pub(crate) fn s7200_counter_owns_input(&self, _bit: u8) -> bool {
        false
    }
}

pub(super) fn define(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn control(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
