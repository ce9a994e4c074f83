//! The syntax tree as readable text, without spans.
use crate::ast::SourceUnit;
/// The tree as text.
pub fn ast_text(unit: &SourceUnit) -> String { format!("{unit:#?}") }
