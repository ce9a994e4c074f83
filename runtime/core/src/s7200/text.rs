//! Numbers to text and back.

use super::{Operands, done};
use crate::cpu::Cpu;

pub(super) fn int_to_ascii(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn dint_to_ascii(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn real_to_ascii(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn int_to_string(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn dint_to_string(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn real_to_string(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn ascii_to_hex(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn hex_to_ascii(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn string_to_int(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn string_to_dint(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}

pub(super) fn string_to_real(_cpu: &Cpu, _operands: &Operands) -> u64 {
    done()
}
