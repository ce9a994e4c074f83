//! Source files, spans, diagnostic codes and their drawing; knows no language.
//!
//! [`drawing`] shows messages to people, [`json`] and [`sarif`] to tools, [`reference`](mod@reference) is the page of all codes.

mod codes;
mod diagnostic;
pub mod drawing;
pub mod json;
pub mod reference;
pub mod sarif;
mod source;

pub use codes::{Code, Severity};
pub use diagnostic::{Diagnostic, Label};
pub use source::{FileId, SourceFile, SourceMap, Span};

/// Sorts messages by file and place; at the same place errors come before warnings.
pub fn sort(diagnostics: &mut [Diagnostic]) {
    diagnostics.sort_by_key(|d| (d.primary.span.file, d.primary.span.start, std::cmp::Reverse(d.severity), d.code));
}
