//! Events, their queues, and interrupt routines.

use super::{Operands, done};
use crate::cpu::Cpu;

/// What an event tells its routine beside its number: a character received in Freeport, and whether its parity was wrong.
pub type EventData = Option<(u8, bool)>;

/// Attached routines and waiting events.
#[derive(Default)]
pub struct Interrupts {}

impl Cpu {
    /// An event happened. It waits in the queue of its group until its routine can run, if one is attached.
    pub(crate) fn s7200_event(&self, _event: u8, _data: EventData) {}

    /// True while an interrupt routine runs: some instructions are not allowed there (error 0004).
    pub(crate) fn s7200_in_interrupt(&self) -> bool {
        false
    }

    /// Whether an interrupt routine is attached to an event.
    pub(crate) fn s7200_is_attached(&self, _event: u8) -> bool {
        false
    }
}

pub(super) fn attach(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn detach(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn clear(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn enable(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn disable(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
