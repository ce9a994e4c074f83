//! Binding: syntax trees and symbol tables in, the bound program out.
//!
//! 1. [`names`] reads the tables and numbers the blocks of all sources, so that order does not matter.
//! 2. [`declare`] lays out types, [`interface`] the interfaces of blocks, each when first needed; [`data`] makes the data blocks.
//! 3. [`body`] binds statements: [`path`] turns names into places, [`operand`] checks operands against the instruction table,
//!    [`call`] and [`actual`] check calls, [`pragma`] binds assertions, [`assertion`] compares by type. That is STL; [`scl`] does the same for SCL.
//! 4. Blocks of the [`library`] are added when something uses them.
//!
//! [`constant`] computes constants of all languages; [`library_reference`] prints the reference of the library.
//!
//! With errors the program is incomplete and must not be lowered; the same applies to `partial` runs with warnings about
//! undefined names.

mod chart;
mod declarations;
mod library_reference;
mod network;
mod partial;
mod program;
mod scl;
mod stl;
mod trees;

#[cfg(test)]
mod declaration_tests;
#[cfg(test)]
#[path = "../../../readers/tests/notation/mod.rs"]
mod notation;
#[cfg(test)]
mod partial_tests;
#[cfg(test)]
mod tests;

pub use chart::reference as graph_reference;
pub use declarations::names::has_free_obs;
pub use library_reference::standard_library;
pub use network::{is_about_drafts, reference as lad_fbd_reference};
pub use partial::complete;
pub use program::bind;
pub use scl::{functions as scl_functions, reference as scl_reference};
pub use trees::family::implied_family;
