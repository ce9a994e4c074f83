//! SSA IR to machine code, in an object file or in memory; the only crate that names Cranelift.
//!
//! - `isa`: the target and its settings.
//! - `abi`: how functions of a module call each other and the runtime.
//! - `keeping`: calls of the runtime that keep all registers.
//! - `lower`: one function of the IR to CLIF, with `memory` for accesses to PLC memory, `bits` for i1 values,
//!   `rounding` for floats and `joins` for blocks to which many jumps lead.
//! - `compile`: all functions of a module to bytes, on several threads; `work` finds those that are too large for the better ways.
//! - `facts`: what functions tell about themselves; `finish`: object files of functions some of which were compiled before (`kept`).
//! - `object`, `jit`, `text`: the outputs made from the bytes.
//! - `lines`: DWARF line tables of an object file; `variables`: its variables.
//! - `machine`: code read back, for `text` and for `statistics`, which says what each network costs, with the depths of `loops`.
//!
//! **Invariant**: one lowering serves all outputs, and it is independent of the source language.

#![allow(unsafe_code, reason = "machine code is called")]

mod abi;
mod bits;
mod byte_order;
mod compile;
mod facts;
mod finish;
mod floats;
mod isa;
mod jit;
mod joins;
mod keeping;
mod kept;
mod lines;
mod loops;
mod lower;
mod machine;
mod memory;
mod object;
mod rounding;
mod statistics;
mod text;
mod variables;
mod work;

use std::fmt;

pub use finish::{Finished, Finishing, finish};
pub use jit::{EntryFn, JitProgram};
pub use kept::KeptFunction;
pub use object::{compile_object, compile_object_as, directory_object};
pub use statistics::{Cost, LOOP_PASSES, PlaceKey, function_sizes, statistics};
pub use text::{asm_text, clif_text};
pub use variables::{Form, Variable, Variables};

/// How code is generated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodegenOptions {
    /// Spend time on good machine code. Off: compile fast.
    pub optimize: bool,
    /// Use features of this computer's processor beyond the baseline of its architecture. Results are the same.
    pub native: bool,
    /// Check the CLIF before and after each of Cranelift's passes; for tests.
    pub verify: bool,
}

impl Default for CodegenOptions {
    fn default() -> Self {
        CodegenOptions { optimize: true, native: false, verify: false }
    }
}

/// Why no machine code was made. None of these is the fault of a PLC program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CodegenError {
    /// There is no code generator for this computer.
    Host(String),
    /// The module breaks a rule of the IR: a bug in the code that built it.
    Module { function: String, message: String },
    /// A function was refused by the code generator: our bug, or a function beyond its limits.
    Function { function: String, message: String },
    /// The output could not be put together: our bug, or no memory for code.
    Output(String),
}

impl fmt::Display for CodegenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CodegenError::Host(message) => write!(f, "no code generator for this computer: {message}"),
            CodegenError::Module { function, message } => write!(f, "invalid IR in {function}: {message}"),
            CodegenError::Function { function, message } => write!(f, "no machine code for {function}: {message}"),
            CodegenError::Output(message) => write!(f, "no output: {message}"),
        }
    }
}

impl std::error::Error for CodegenError {}
