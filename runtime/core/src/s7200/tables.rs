//! ATT, FIFO, LIFO, FND.

use super::{Operands, done};
use crate::cpu::Cpu;

pub(super) fn add(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn first(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn last(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn find(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
