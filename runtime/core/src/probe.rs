//! Watchers of a program with probes while it runs: the status of blocks, a debugger.
//!
//! The compiler puts probes into a program only when it is asked to; each has a place, an index into the list of places that the
//! compiler returns with the code. Probes change nothing that the program can see.

use std::rc::Rc;

use crate::cpu::Cpu;
use crate::diagnostics::Entry;

/// The registers of an S7-300/400 after a statement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Registers {
    /// As `L STW` loads it: BR CC1 CC0 OV OS OR STA RLO /FC, the last is bit 0.
    pub status: u32,
    /// ACCU1 and ACCU2.
    pub accu: [u32; 2],
    /// AR1 and AR2.
    pub ar: [u32; 2],
    /// Number of the open DB, 0 if none is.
    pub db: u16,
    /// Number of the open instance DB, 0 if none is.
    pub di: u16,
}

/// Gets what the probes see. All happens inside the running program: nothing here may wait longer than the cycle may
/// last, unless the clock is virtual.
pub trait Watcher {
    /// A block begins; `instance` is the offset of its instance in memory, 0 if it has none.
    fn enter(&self, cpu: &Cpu, place: u32, instance: u32);
    /// The block that began last ends. A block that is left because the CPU goes to STOP does not say so.
    fn leave(&self, cpu: &Cpu, place: u32);
    /// A statement has run.
    fn registers(&self, _cpu: &Cpu, _place: u32, _registers: Registers) {}
    /// A value, zero-extended.
    fn value(&self, cpu: &Cpu, place: u32, value: u64);
    /// A statement is about to run, in the frame of local data at this offset in memory. Its registers are in the CPU state, see
    /// [`PROBED`](plcc_abi::layout::state::PROBED).
    fn statement(&self, _cpu: &Cpu, _place: u32, _local: u32) {}
    /// The cycle is at this point.
    fn phase(&self, _cpu: &Cpu, _phase: Phase) {}
    /// A fault was entered in the diagnostic buffer; its OB runs after this, or the CPU goes to STOP.
    fn fault(&self, _cpu: &Cpu, _entry: &Entry) {}
}

/// A point of the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Nothing of the cycle has happened. Cycle 0 is startup.
    Before,
    /// Scenario and modules have set the inputs; the program has not begun.
    Begin,
    /// All of the cycle is over.
    After,
    /// The run is over.
    Over,
}

impl Cpu {
    /// Names who looks at the probes, before the CPU starts. The first call counts.
    pub fn set_watcher(&self, watcher: Rc<dyn Watcher>) {
        let _ = self.watcher.set(watcher);
    }

    pub(crate) fn tell(&self, tell: impl FnOnce(&dyn Watcher)) {
        if let Some(watcher) = self.watcher.get() {
            tell(watcher.as_ref());
        }
    }
}
