//! Pointers at run time.

use crate::cpu::Cpu;

impl Cpu {
    /// See [`RuntimeFn::S7200Pointer`](plcc_abi::RuntimeFn::S7200Pointer).
    pub(crate) fn s7200_pointer(&self, _pointer: u32, _bytes: u32, _write: bool) -> u32 {
        0
    }
}
