//! Writes syntax trees as sources, and turns one notation into another.
//!
//! - [`stl`]: sources in STL; [`awl`]: those of the S7-200.
//! - [`scl`]: sources in SCL.
//! - [`gr7`]: sources of GRAPH.
//! - [`symbols`]: symbol tables.
//! - [`sd`]: documents of SIMATIC SD.
//! - [`xml`]: SimaticML of the TIA Portal.
//! - [`plcopen`]: projects in PLCopen XML.
//! - [`from_scl`]: statements of SCL and charts of GRAPH as statement lists.
//! - [`to_stl`]: networks of LAD and FBD as statements.
//! - [`to_graph`]: statements as networks of LAD and FBD.
//! - [`addresses`]: symbols as addresses and back.
//! - [`migration`]: which parts of a program another CPU has.
//! - [`literal`]: constants as text.
//! - [`own_types`]: types that a program declares itself; [`element_values`]: start values of elements in them.
//! - [`trivia`]: comments, which trees do not hold.
//!
//! If a notation cannot express something, a message names it; nothing is left out silently.
//!
//! **Invariant**: no files: a tree becomes a tree or a text. Only [`from_scl`],
//! [`addresses`] and [`migration`] know symbols and types, from the bound program.

pub mod addresses;
pub mod awl;
pub mod element_values;
mod frames;
pub mod from_scl;
pub mod gr7;
pub mod literal;
pub mod migration;
mod names;
mod node;
mod operand;
mod out;
pub mod own_types;
pub mod plcopen;
pub mod scl;
pub mod sd;
pub mod stl;
pub mod symbols;
pub mod to_graph;
pub mod to_stl;
pub mod trivia;
mod writer;
pub mod xml;

pub use node::with_pragmas;
pub use writer::Notation;
