//! Symbols, data types, block interfaces and checks; gives the bound program.

mod bind;
pub mod layout;
pub mod model;
pub mod profile;
pub mod symbols;
pub mod types;

pub use bind::{BindInput, bind};
pub use model::Program;
