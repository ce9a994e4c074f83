//! Code that runs in the process of the compiler, and PLC memory as it reaches it: for `plcc run` and `plcc test`.
//!
//! Everything here takes the memory base that [`Code::call`] was given.

use crate::code::{Code, Entries};
use crate::cpu::Cpu;

/// Machine code made in memory.
pub struct NativeCode<O> {
    entries: Entries,
    /// Keeps the code where it is.
    _owner: O,
}

impl<O> NativeCode<O> {
    /// `entries` are the entry functions of code that lives as long as `owner`.
    pub fn new(entries: Entries, owner: O) -> NativeCode<O> {
        NativeCode { entries, _owner: owner }
    }
}

impl<O> Code for NativeCode<O> {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32) {
        if let Some(function) = self.entries.get(entry) {
            // SAFETY: the function was made for the layout of `plcc_abi` and lives as long as its owner; the arguments come
            // from the runtime.
            unsafe { function(mem, lbase, vbase) }
        }
    }

    fn watch(&self, is_watched: bool) {
        self.entries.watch(is_watched);
    }
}

/// Reads the bytes at `offset` from the memory base, for an interpreter; addresses outside the memory read as scratch.
#[allow(clippy::not_unsafe_ptr_arg_deref)] // An interpreter passes on what the runtime gave it.
pub fn read(mem: *mut u8, offset: u32, buf: &mut [u8]) {
    // SAFETY: the runtime passed `mem` to `Code::call`.
    let memory = unsafe { &Cpu::of(mem).memory };
    match buf.len() {
        1 => buf.copy_from_slice(&memory.bytes::<1>(offset)),
        2 => buf.copy_from_slice(&memory.bytes::<2>(offset)),
        4 => buf.copy_from_slice(&memory.bytes::<4>(offset)),
        _ => buf.iter_mut().zip(offset..).for_each(|(byte, at)| *byte = memory.byte(at)),
    }
}

/// Writes `bytes` at `offset` from the memory base, for an interpreter; nothing is written outside the memory.
#[allow(clippy::not_unsafe_ptr_arg_deref)] // An interpreter passes on what the runtime gave it.
pub fn write(mem: *mut u8, offset: u32, bytes: &[u8]) {
    // SAFETY: the runtime passed `mem` to `Code::call`.
    unsafe { &Cpu::of(mem).memory }.load(offset, bytes);
}
