//! The program's code as the runtime sees it: a table of entry functions.

/// Native code or an interpreter. `entry` is the number of an entry function, `mem` the memory base, `lbase` and `vbase`
/// the offsets of the callee's and the caller's local data. CPU registers travel in the CPU state.
pub trait Code {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32);
}

/// Signature of a native entry function.
pub type EntryFunction = unsafe extern "C" fn(mem: *mut u8, lbase: u32, vbase: u32);
