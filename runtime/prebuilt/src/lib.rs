//! The runtime in each form that plcc makes executables from. `build.rs` compiles and links them.
//!
//! A form with room for a program has two sections of a few bytes at the end: `.plcc.program`, read-only, which begins with the symbol
//! `plcc_program`, and `.plcc.text`, executable. Each has a segment of its own, and nothing that is loaded comes after them, so
//! they can grow.

/// Includes what `build.rs` has made.
macro_rules! built {
    ($name:literal) => {
        include_bytes!(concat!(env!("OUT_DIR"), "/", $name))
    };
}

/// One relocatable object, for a C compiler that links.
pub static OBJECT: &[u8] = built!("runtime.o");
/// As [`OBJECT`], with servers for clients, and their flags.
pub static OBJECT_WITH_SERVICES: &[u8] = built!("services.o");

/// An executable with room for a program.
pub static EXECUTABLE: &[u8] = built!("runtime-template");
/// As [`EXECUTABLE`], with servers for clients, and their flags.
pub static EXECUTABLE_WITH_SERVICES: &[u8] = built!("services-template");

/// An executable with room for a program that needs no dynamic library; empty if there was no static C library.
pub static STATIC: &[u8] = built!("runtime-static");
/// As [`STATIC`], with servers for clients, and their flags.
pub static STATIC_WITH_SERVICES: &[u8] = built!("services-static");

/// A shared library with room for a program: the unit of a co-simulation.
pub static UNIT: &[u8] = built!("unit");
