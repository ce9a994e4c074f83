//! Start of RUN, scan, STOP.

use super::{Operands, done};
use crate::cpu::Cpu;

impl Cpu {
    /// RUN begins: first-scan state of special memory, timers, counters, edges, interrupts and hardware; retentive memory.
    pub(crate) fn s7200_start(&self) {}

    /// When anything of an S7-200 next happens by itself.
    pub(crate) fn s7200_due(&self) -> u64 {
        [self.s7200_counters_due(), self.s7200_pulses_due(), self.s7200_ports_due(), self.s7200_network_due()]
            .into_iter()
            .min()
            .unwrap_or(crate::schedule::NEVER)
    }

    /// Lets happen what is due.
    pub(crate) fn s7200_poll(&self) {
        self.s7200_poll_counters();
        self.s7200_poll_pulses();
        self.s7200_poll_ports();
    }
}

pub(super) fn restart_watchdog(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn diagnostic_led(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn stop_mode(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
