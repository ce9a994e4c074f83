//! GRAPH source text, `.gr7`. Source: GRAPH reference, chapter A.

use plcc_diag::{Diagnostic, FileId};

use crate::ParseOptions;
use crate::ast::SourceUnit;

/// Parses a source. Never fails: what is wrong is in the messages, in the order of the text.
pub fn parse(_file: FileId, _text: &str, _options: &ParseOptions) -> (SourceUnit, Vec<Diagnostic>) {
    (SourceUnit::default(), Vec::new())
}

/// The tokens of a source as its grammar sees them, one per line.
pub fn tokens_text(_text: &str) -> String {
    String::new()
}
