//! The runtime in each form that plcc makes executables from. `build.rs` compiles and links them.
//!
//! A form with room for a program has two sections of a few bytes at the end: `.plcc.program`, read-only, which begins with the symbol
//! `plcc_program`, and `.plcc.text`, executable. Each has a segment of its own, and nothing that is loaded comes after them, so
//! they can grow.

use plcc_abi::linked::Runtimes;

/// Includes what `build.rs` has made.
macro_rules! built {
    ($name:literal) => {
        include_bytes!(concat!(env!("OUT_DIR"), "/", $name))
    };
}

/// What `build.rs` has made.
pub const RUNTIMES: Runtimes = Runtimes {
    object: built!("runtime.o"),
    object_with_services: built!("services.o"),
    executable: built!("runtime-template"),
    executable_with_services: built!("services-template"),
    without_libraries: built!("runtime-static"),
    without_libraries_with_services: built!("services-static"),
    unit: built!("unit"),
};
