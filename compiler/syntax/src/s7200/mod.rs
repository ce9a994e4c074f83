//! STL of the S7-200 (Micro/WIN): lexer, grammar, instruction table, data blocks. Source: S7-200 system manual.

pub mod ast;
mod instructions;

pub use instructions::{Acts, Compare, CompareKind, Contact, Insn, OperandClass, Relation};
