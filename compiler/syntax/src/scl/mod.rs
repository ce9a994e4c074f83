//! SCL, in the classic form of STEP 7 V5 and in that of the TIA Portal: lexer, grammar, syntax tree.

pub mod ast;
pub mod text;

use plcc_diag::{Diagnostic, FileId};

use crate::ParseOptions;
use crate::ast::{OperandKind, SourceUnit, Width};

/// Parses a source. Errors are recovered; what could not be parsed is left out or is an error node.
pub fn parse(_file: FileId, _text: &str, _options: &ParseOptions) -> (SourceUnit, Vec<Diagnostic>) {
    (SourceUnit::default(), Vec::new())
}

/// The operand that a bare word names, in both spellings: `MW10`, `EB4`, `PIW256`, `T5`, `Z3`; `DB10` and `FB2` are blocks. `area_word`
/// tells of `MW` alone.
pub fn absolute(_word: &str) -> Option<OperandKind> {
    None
}

/// Area and width that a word without number names, as in `MW[i]`, `M[b, i]`, `PIW[i]`, `EB[i]`.
pub fn area_word(_word: &str) -> Option<(crate::ast::Area, Width)> {
    None
}

/// Width and byte of a word behind `DB10.`: `DW4`, `DBW4`, `DB7` (a byte), `DD0`; no bits, which are one token with their point.
pub fn db_address(_word: &str) -> Option<(Width, u32)> {
    None
}

/// Width that a word without number behind `DB10.` names, as in `DB10.DW[i]`, `DB10.DX[b, i]`, `DB10.D[b, i]`, `DB10.DB[i]`.
pub fn db_area_word(_word: &str) -> Option<Width> {
    None
}
