//! Lexers, parsers, syntax trees and instruction tables; knows no symbols.
//!
//! - [`ast`]: the syntax tree, [`ast_text`](fn@ast_text) prints it.
//! - [`chart`]: charts of GRAPH.
//! - [`gr7`]: GRAPH as source text.
//! - [`literal`]: constants, the same for every language.
//! - [`network`]: networks of LAD and FBD.
//! - [`plcopen`]: projects in PLCopen XML.
//! - [`s7200`]: STL of the S7-200.
//! - [`scl`]: lexer and grammar of SCL.
//! - [`sd`]: SIMATIC SD, the text form of LAD and FBD.
//! - [`simatic_ml`]: exports of the TIA Portal in XML.
//! - [`stl`]: lexer, grammar and instruction table of STL for S7-300/400.
//!
//! **Invariant**: never fails; gives a tree and diagnostics.

mod assertion;
pub mod ast;
mod ast_text;
pub mod chart;
mod comment;
mod distance;
mod elementary;
mod encoding;
mod frame;
pub mod gr7;
mod language;
pub mod literal;
pub mod network;
pub mod plcopen;
pub mod s7200;
pub mod scl;
pub mod sd;
pub mod simatic_ml;
pub mod stl;
pub mod xml;

pub use ast_text::ast_text;
pub use elementary::{Class, Elementary};
pub use encoding::{CodePage, decode, decode_as};
pub use language::Language;

use plcc_diag::{Diagnostic, FileId};

use language::Reading;

/// How a source is read.
#[derive(Clone, Copy, Debug, Default)]
pub struct ParseOptions<'a> {
    /// The mnemonic set; `None`: found in the file.
    pub mnemonics: Option<stl::Mnemonics>,
    /// Assertion pragmas (`//@ …`) are read; else they are comments.
    pub pragmas: bool,
    /// The language, if the name of the file tells; `None`: found in the file.
    pub language: Option<Language>,
    /// Texts of titles and comments that the file names by id.
    pub texts: Option<&'a sd::Texts>,
}

/// Parses a source. Never fails: what is wrong is in the messages, in the order of the text.
pub fn parse(file: FileId, text: &str, options: &ParseOptions) -> (ast::SourceUnit, Vec<Diagnostic>) {
    match xml::kind(text) {
        Some(xml::XmlKind::PlcOpen) => return plcopen::parse(file, text),
        Some(kind) => return simatic_ml::parse(file, text, &kind, options),
        None => {}
    }
    read(file, text, options, language::detect(text, options.language))
}

fn read(file: FileId, text: &str, options: &ParseOptions, reading: Reading) -> (ast::SourceUnit, Vec<Diagnostic>) {
    match reading {
        Reading::Whole(Language::Stl) => stl::parse(file, text, options),
        Reading::Whole(Language::Scl) => scl::parse(file, text, options),
        Reading::Whole(Language::Sd) => sd::parse(file, text, options),
        Reading::Whole(Language::Graph) => gr7::parse(file, text, options),
        Reading::Whole(Language::S7200) => s7200::parse(file, text, options),
        Reading::Mixed(scl) => joined(
            stl::parse(file, &language::masked(text, &scl, false), options),
            scl::parse(file, &language::masked(text, &scl, true), options),
        ),
        Reading::WithCharts(charts) => {
            let others = language::masked(text, &charts, false);
            let reading = language::detect_statements(&others, None);
            joined(
                read(file, &others, options, reading),
                gr7::parse(file, &language::masked(text, &charts, true), options),
            )
        }
    }
}

/// Parts of one file, which were read apart.
fn joined(
    (mut unit, mut diagnostics): (ast::SourceUnit, Vec<Diagnostic>),
    (other, messages): (ast::SourceUnit, Vec<Diagnostic>),
) -> (ast::SourceUnit, Vec<Diagnostic>) {
    unit.blocks.extend(other.blocks);
    unit.blocks.sort_by_key(|block| block.span().start);
    unit.pragmas.extend(other.pragmas);
    unit.pragmas.sort_by_key(|pragma| pragma.span.start);
    diagnostics.extend(messages);
    diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    (unit, diagnostics)
}

/// The tokens of a source as its grammar sees them, one per line, for `--emit tokens`.
pub fn tokens_text(text: &str, options: &ParseOptions) -> String {
    if xml::kind(text).is_some() {
        return simatic_ml::tokens_text(text, options);
    }
    tokens_of(text, options, language::detect(text, options.language))
}

fn tokens_of(text: &str, options: &ParseOptions, reading: Reading) -> String {
    match reading {
        Reading::Whole(Language::Stl) => stl::tokens_text(text, options),
        Reading::Whole(Language::Scl) => scl::tokens_text(text, options),
        Reading::Whole(Language::Sd) => sd::tokens_text(text),
        Reading::Whole(Language::Graph) => gr7::tokens_text(text),
        Reading::Whole(Language::S7200) => s7200::tokens_text(text, options),
        Reading::Mixed(scl) => {
            let stl = stl::tokens_text(&language::masked(text, &scl, false), options);
            stl + &scl::tokens_text(&language::masked(text, &scl, true), options)
        }
        Reading::WithCharts(charts) => {
            let others = language::masked(text, &charts, false);
            let reading = language::detect_statements(&others, None);
            tokens_of(&others, options, reading) + &gr7::tokens_text(&language::masked(text, &charts, true))
        }
    }
}
