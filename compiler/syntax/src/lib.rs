//! Lexers, parsers, syntax trees and instruction tables; knows no symbols.

pub mod ast;
pub mod literal;
pub mod stl;
