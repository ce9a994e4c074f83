//! STL for S7-300/400: instruction table, lexer, grammar.

pub mod instructions;

pub use instructions::{Mnemonics, OperandClass, StlInsn};
