//! The PID instruction.

use super::{Operands, done};
use crate::cpu::Cpu;

pub(super) fn pid(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
