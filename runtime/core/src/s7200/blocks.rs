//! Block moves, FILL, SHRB.

use super::{Operands, done};
use crate::cpu::Cpu;

pub(super) fn copy(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn fill(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn shift_register(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
