//! Symbols, data types, block interfaces and checks; gives the bound program.

pub mod layout;
pub mod model;
pub mod profile;
pub mod symbols;
pub mod types;

pub use model::Program;
