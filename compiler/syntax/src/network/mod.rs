//! Networks of LAD and FBD: one syntax tree for all files that carry them, and the table of their elements.
//!
//! ```text
//! .s7dcl (SIMATIC SD) ──┐
//! SimaticML  (XML)    ──┼──► network::ast ──► binder
//! PLCopen TC6 (XML)   ──┘
//! ```
//!
//! Readers give elements and pins their names of the table [`elements`](crate::network::elements::ELEMENTS), settle what feeds what, and
//! put the elements into the order of evaluation (LAD/FBD reference A.11); which types and blocks the operands name is the binder's.

pub mod absent;
pub mod ast;
pub mod draw;
pub mod elements;
pub mod text;
