//! Symbols, data types, block interfaces and checks; gives the bound program.

pub mod model;
pub mod types;

pub use model::Program;
