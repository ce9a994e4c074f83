//! Freeport: XMT, RCV, character interrupts.

use super::{Operands, done};
use crate::cpu::Cpu;

/// Ports in Freeport mode.
#[derive(Default)]
pub struct Freeport {}

impl Cpu {
    /// RUN begins: opens what plc.toml connects the ports to.
    pub(crate) fn s7200_start_ports(&self) {}

    /// When a port next does something: end of a transmission, idle time, message timer.
    pub(crate) fn s7200_ports_due(&self) -> u64 {
        crate::schedule::NEVER
    }

    /// Moves bytes, raises events.
    pub(crate) fn s7200_poll_ports(&self) {}

    /// The program wrote SMB30 or SMB130.
    pub(crate) fn s7200_port_control_written(&self, _port: u8) {}
}

pub(super) fn transmit(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn receive(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
