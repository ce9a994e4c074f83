//! Syntax trees of all languages, the instruction tables, and the parsers of STL and SCL; it does not look up symbols.
//!
//! - [`ast`]: the syntax tree, [`ast_text`](fn@ast_text) prints it.
//! - [`chart`]: charts of GRAPH.
//! - [`front`]: what the front ends of all notations share.
//! - [`literal`]: constants, the same for every language.
//! - [`network`]: networks of LAD and FBD.
//! - [`s7200`]: STL of the S7-200.
//! - [`scl`]: lexer and grammar of SCL.
//! - [`symbols`]: the contents of symbol tables.
//! - [`stl`]: lexer, grammar and instruction table of STL for S7-300/400.
//!
//! **Invariant**: parsing never fails; it returns a tree and diagnostics.

mod assertion;
pub mod ast;
mod ast_text;
pub mod chart;
pub use plcc_literal::{article, count, distance};
mod elementary;
mod encoding;
pub mod front;
mod language;
pub mod literal;
pub mod network;
pub mod s7200;
pub mod scl;
pub mod stl;
pub mod symbols;

pub use ast_text::ast_text;
pub use elementary::{Class, Elementary};
pub use encoding::{CodePage, Form, decode, decode_as};
pub use language::Language;

/// How a source is read.
#[derive(Clone, Copy, Debug, Default)]
pub struct ParseOptions {
    /// The mnemonic set; `None`: found in the file.
    pub mnemonics: Option<stl::Mnemonics>,
    /// Assertion pragmas (`//@ …`) are read; otherwise they are comments.
    pub pragmas: bool,
}
