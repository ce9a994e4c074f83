//! The bound program: the output of binding and the input of lowering.
//!
//! - [`Program`]: blocks, data blocks and symbols, with every name, type and address settled. Bodies differ by language: STL keeps its
//!   statements, all others are the typed tree [`scl`], which [`scl::walk`] walks over, and the S7-200 has its own ([`s7200`]).
//! - [`types`], [`layout`]: data types, and the addresses of their components.
//! - [`profile`]: the CPUs and their limits.
//! - [`InstructionPin`]: what statements pass to instructions of the TIA Portal.
//!
//! **Invariant**: data only; independent of how a program is bound and lowered.

mod instruction;
pub mod layout;
pub mod profile;
mod program;
pub mod s7200;
pub mod scl;
pub mod types;

pub use instruction::{InstructionPin, InstructionType};
pub use program::*;
