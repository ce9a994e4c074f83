//! Networks of LAD and FBD: one syntax tree for all file formats, and the table of their elements.
//!
//! ```text
//! .s7dcl (SIMATIC SD) ──┐
//! SimaticML  (XML)    ──┼──► network::ast ──► binder
//! PLCopen TC6 (XML)   ──┘
//! ```
//!
//! Readers name elements and pins as in the table [`elements`](crate::network::elements::CHAPTERS), find out what feeds what, and
//! put the elements into the order of evaluation (LAD/FBD reference A.11); the binder finds the types and blocks that the operands name.

pub mod absent;
pub mod ast;
pub mod draw;
pub mod elements;
pub mod order;
pub mod text;
