//! The contract between generated code and the runtime, written once.
//!
//! - [`layout`]: where every memory area of the virtual CPU lies.
//! - [`functions`]: the table of runtime functions that generated code may call.
//! - [`image`]: what the compiler tells the runtime about a program.
//! - [`codes`]: error numbers of S7 CPUs that both sides use.
//! - [`technology`]: fast counters, pulse generators, hardware interrupts.
//! - [`ob`]: organization blocks by what starts them.
//! - [`s7200`]: what an S7-200 has of its own.
//!
//! **Invariant**: nothing here executes; it is data and constants only.

pub mod codes;
pub mod functions;
pub mod image;
pub mod layout;
pub mod ob;
pub mod s7200;
pub mod technology;

pub use functions::{RuntimeFn, Type};
pub use image::ProgramImage;
