//! NETR, NETW, station addresses.

use super::{Operands, done};
use crate::cpu::Cpu;

/// Requests of this station, and what other stations ask of it.
#[derive(Default)]
pub struct Network {}

impl Cpu {
    /// RUN begins: listens for other stations if plc.toml says where.
    pub(crate) fn s7200_start_network(&self) {}

    /// When a request next times out.
    pub(crate) fn s7200_network_due(&self) -> u64 {
        crate::schedule::NEVER
    }

    /// Between scans: answers other stations, and puts answers to own requests into their tables.
    pub(crate) fn s7200_poll_network(&self) {}
}

pub(super) fn read(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn write(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn get_address(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn set_address(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
