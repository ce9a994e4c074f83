//! TODR, TODW, TODRX, TODWX.

use super::{Operands, done};
use crate::cpu::Cpu;

pub(super) fn read(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn set(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn read_extended(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn set_extended(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
