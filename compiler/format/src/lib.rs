//! Lays out sources in one style: STL, SCL, SIMATIC SD, GRAPH and the STL of the S7-200.
//!
//! ```text
//! text ──► pieces, by lines ──► lines with indentation ──► text
//!       piece.rs        stl.rs, words.rs, s7200.rs     lines.rs
//! ```
//!
//! Only blanks and line ends change: words, signs, texts and comments stay as they are and in their order, which
//! [`format`] checks before it returns anything. So does the syntax tree.
//!
//! **Invariant**: laying out the result again changes nothing.

mod check;
mod keywords;
mod lines;
mod piece;
mod s7200;
mod spacing;
mod stl;
mod words;

use plcc_diag::{Diagnostic, FileId};
use plcc_readers::ReadOptions;
use plcc_syntax::Language;

/// Why a source is left as it is.
#[derive(Clone, Debug)]
pub enum Left {
    /// It has errors.
    Errors(Vec<Diagnostic>),
    /// It is a notation without a layout: XML.
    NotText,
    /// The layout would have changed more than blanks: a fault of this crate.
    Fault(String),
}

/// The text in the common layout. `file` is the source in messages; `hint`: the language, if the name of the file decides it.
///
/// Lines end with `\n`. A text whose pragmas mark columns of the line above is returned as it is.
pub fn format(file: FileId, text: &str, hint: Option<Language>) -> Result<String, Left> {
    let parts = plcc_readers::parts(text, hint);
    if parts.is_empty() && !text.is_empty() {
        return Err(Left::NotText);
    }
    let options = ReadOptions { language: hint, ..ReadOptions::default() };
    let (unit, diagnostics) = plcc_readers::parse(file, text, &options);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(Left::Errors(diagnostics));
    }
    let plain = text.replace("\r\n", "\n");
    if marks_columns(&plain) {
        return Ok(plain);
    }
    // Positions of statements are those of the text that is laid out.
    let unit = if plain.len() == text.len() { unit } else { plcc_readers::parse(file, &plain, &options).0 };
    let mut pieces = piece::read(&plain, plcc_readers::parts(&plain, hint));
    if let Some(statements) = stl::statements(&unit) {
        stl::mark(&mut pieces, &statements);
    }
    let mut out = Vec::new();
    for part in pieces {
        out.extend(match part.language {
            Language::S7200 => s7200::lay_out(&plain, &part.pieces),
            Language::Stl | Language::Scl | Language::Sd | Language::Graph => words::lay_out(&part),
        });
    }
    let made = lines::text(out);
    match check::difference(&plain, &made, hint) {
        None => Ok(made),
        Some(what) => Err(Left::Fault(what)),
    }
}

/// Whether a pragma marks columns of the line above it: `//@  ^^^^ P0203`.
fn marks_columns(text: &str) -> bool {
    text.lines()
        .any(|line| line.trim_start().strip_prefix("//@").is_some_and(|rest| rest.trim_start().starts_with('^')))
}
