//! The contract between generated code and the runtime, written once.
//!
//! - [`any`]: ANY pointers, and the errors of those that are wrong.
//! - [`layout`]: the offsets of all memory areas of the virtual CPU.
//! - [`functions`]: the table of runtime functions that generated code may call.
//! - [`image`]: the description of a program for the runtime.
//! - [`names`]: types of the values that flags and scenarios name.
//! - [`monitor`]: what code with probes tells.
//! - [`linked`]: how the runtime of an executable finds its program.
//! - [`codes`]: error numbers of S7 CPUs that both sides use.
//! - [`technology`]: fast counters, pulse generators, hardware interrupts.
//! - [`ob`]: organization blocks, grouped by the events that start them.
//! - [`remote`]: devices on a field bus; [`services`]: which parts of a program clients can reach.
//! - [`shape`]: what data blocks look like, for blocks that write them to files.
//! - [`s7200`]: definitions of the S7-200 only.
//!
//! **Invariant**: nothing here executes; it is data, constants and their encodings only.

pub mod any;
pub mod codes;
pub mod connections;
pub mod functions;
pub mod image;
pub mod layout;
pub mod linked;
pub mod loadable;
pub mod monitor;
pub mod names;
pub mod ob;
pub mod remote;
pub mod s7200;
pub mod services;
pub mod shape;
pub mod technology;
pub mod text;

pub use functions::{RuntimeFn, Type};
pub use image::ProgramImage;
