//! Strings: a length byte, then characters.

use super::{Operands, done};
use crate::cpu::Cpu;

pub(super) fn length(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn copy(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn append(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn part(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn find(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn find_character(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn equal(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
