//! Source files, spans, diagnostic codes and their drawing; knows no language.

mod codes;
mod diagnostic;
mod source;

pub use codes::{Code, Severity};
pub use diagnostic::{Diagnostic, Label};
pub use source::{FileId, SourceFile, SourceMap, Span};
