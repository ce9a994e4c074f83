//! Memory between the stages of a large program.

use plcc_ir::Module;

/// Smaller programs end before it would pay.
const LARGE_INSTS_MIN: usize = 500_000;

/// The size of a program, in instructions.
pub fn size(module: &Module) -> usize {
    module.functions.values().map(|function| function.insts.len()).sum()
}

/// Gives what earlier stages have freed back to the system, for a program of this [`size`]. The next stage would not use it: its threads have memory
/// of their own.
pub fn give_back(size: usize) {
    if size < LARGE_INSTS_MIN {
        return;
    }
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    #[allow(unsafe_code, reason = "a function of the C library")]
    // SAFETY: it has no preconditions, and changes nothing that is in use.
    unsafe {
        libc::malloc_trim(0);
    }
}
