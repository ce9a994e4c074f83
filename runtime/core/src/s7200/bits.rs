//! S, R, SI, RI.

use super::{Operands, done};
use crate::cpu::Cpu;

pub(super) fn write(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn write_outputs_now(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn reset_timers(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn reset_counters(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn set_timers(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn set_counters(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
