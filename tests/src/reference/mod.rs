//! The pages in `docs/reference/`, printed from the tables of the compiler.

mod stdlib;

pub use stdlib::standard_library;
