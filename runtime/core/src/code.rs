//! The program's code as the runtime sees it: a table of entry functions.

use std::cell::Cell;

/// Native code or an interpreter. `entry` is the number of an entry function, `mem` the memory base, `lbase` and `vbase`
/// the offsets of the callee's and the caller's local data. CPU registers travel in the CPU state.
pub trait Code {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32);

    /// From the next call on the code with probes runs, or that without. Only between two cycles: blocks that run would go on in the
    /// code that they began in. Nothing happens if there is one code only.
    fn watch(&self, _is_watched: bool) {}
}

/// Signature of a native entry function.
pub type EntryFunction = unsafe extern "C" fn(mem: *mut u8, lbase: u32, vbase: u32);

/// The entry functions of a program, and those of the same program with probes if there are any. To change from one to the other costs
/// nothing in each call.
pub struct Entries {
    plain: Vec<EntryFunction>,
    /// Empty, or as long as `plain`.
    probed: Vec<EntryFunction>,
    /// The functions of one of both.
    now: Cell<*const EntryFunction>,
}

impl Entries {
    /// Without probes.
    pub fn new(plain: Vec<EntryFunction>) -> Entries {
        Entries::watched(plain, Vec::new())
    }

    /// With probes, if `probed` has as many functions.
    pub fn watched(plain: Vec<EntryFunction>, mut probed: Vec<EntryFunction>) -> Entries {
        if probed.len() != plain.len() {
            probed.clear();
        }
        let now = Cell::new(plain.as_ptr());
        Entries { plain, probed, now }
    }

    /// The entry function with this number.
    #[inline]
    pub fn get(&self, entry: u32) -> Option<EntryFunction> {
        if entry as usize >= self.plain.len() {
            return None;
        }
        // SAFETY: `now` points to the elements of `plain` or to those of `probed`, which are as many; neither vector changes.
        Some(unsafe { *self.now.get().add(entry as usize) })
    }

    /// See [`Code::watch`].
    pub fn watch(&self, is_watched: bool) {
        let functions = if is_watched && !self.probed.is_empty() { &self.probed } else { &self.plain };
        self.now.set(functions.as_ptr());
    }
}
