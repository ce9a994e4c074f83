//! Special memory that the CPU writes or obeys.

use crate::cpu::Cpu;

impl Cpu {
    /// See [`RuntimeFn::S7200SpecialWritten`](plcc_abi::RuntimeFn::S7200SpecialWritten).
    pub(crate) fn s7200_special_written(&self, _byte: u32) {}
}
