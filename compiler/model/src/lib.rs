//! The bound program: what binding gives and lowering takes.
//!
//! - [`Program`]: blocks, data blocks and symbols, every name, type and address settled. Bodies differ by language: STL keeps its
//!   statements, all others are the typed tree [`scl`], and the S7-200 has its own ([`s7200`]).
//! - [`types`], [`layout`]: data types, and where their components lie.
//! - [`profile`]: the CPUs and their limits.
//!
//! **Invariant**: data only; knows neither how a program is bound nor how it is lowered.

pub mod layout;
pub mod profile;
mod program;
pub mod s7200;
pub mod scl;
pub mod types;

pub use program::*;
