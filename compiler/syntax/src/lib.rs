//! Lexers, parsers, syntax trees and instruction tables; knows no symbols.
//!
//! - [`ast`]: the syntax tree, [`ast_text`](fn@ast_text) prints it.
//! - [`literal`]: constants, the same for every language.
//! - [`scl`]: lexer and grammar of SCL.
//! - [`stl`]: lexer, grammar and instruction table of STL for S7-300/400.
//!
//! **Invariant**: never fails; gives a tree and diagnostics.

pub mod ast;
mod ast_text;
mod elementary;
mod encoding;
pub mod literal;
pub mod scl;
pub mod stl;

pub use ast_text::ast_text;
pub use elementary::{Class, Elementary};
pub use encoding::decode;

use plcc_diag::{Diagnostic, FileId};

/// How a source is read.
#[derive(Clone, Copy, Debug, Default)]
pub struct ParseOptions {
    /// The mnemonic set; `None`: found in the file.
    pub mnemonics: Option<stl::Mnemonics>,
    /// Assertion pragmas (`//@ …`) are read; else they are comments.
    pub pragmas: bool,
}

/// Parses a source. Never fails: what is wrong is in the messages, in the order of the text.
pub fn parse(file: FileId, text: &str, options: &ParseOptions) -> (ast::SourceUnit, Vec<Diagnostic>) {
    stl::parse(file, text, options)
}
