//! Timers of an S7-200: TON, TONR, TOF with the update rules of 1, 10 and 100 ms. Source: S7-200 system manual, timer instructions.

use crate::cpu::Cpu;

/// What the runtime keeps of timers beside the system area.
#[derive(Default)]
pub struct Timers {}

impl Cpu {
    /// See [`RuntimeFn::S7200Timer`](plcc_abi::RuntimeFn::S7200Timer).
    pub(crate) fn s7200_timer(&self, _number: u32, _kind: u32, _preset: i16, _enable: bool) {}

    /// See [`RuntimeFn::S7200TimerSync`](plcc_abi::RuntimeFn::S7200TimerSync).
    pub(crate) fn s7200_timer_sync(&self, _number: u32) {}
}
