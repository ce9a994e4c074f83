//! Readers of the files that tools export, and of sources in any language: text in, syntax tree and messages out.
//!
//! - [`parse`] finds out what a source is and reads it.
//! - [`gr7`]: GRAPH as source text.
//! - [`plcopen`]: projects in PLCopen XML.
//! - [`sd`]: SIMATIC SD, the text form of LAD and FBD.
//! - [`simatic_ml`]: exports of the TIA Portal in XML.
//! - [`symbols`]: symbol tables.
//!
//! **Invariant**: reading never fails; it returns a tree and diagnostics. Trees are those of [`plcc_syntax`]; no reader looks up symbols.

pub mod gr7;
mod language;
mod networks;
pub mod plcopen;
pub mod sd;
pub mod simatic_ml;
mod spelling;
pub mod symbols;
pub mod xml;

use std::ops::Range;

use plcc_diag::{Diagnostic, FileId};
use plcc_syntax::{Language, ParseOptions, ast, s7200, scl, stl};

use language::Reading;

/// How a source is read.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions<'a> {
    /// The mnemonic set; `None`: found in the file.
    pub mnemonics: Option<stl::Mnemonics>,
    /// Assertion pragmas (`//@ …`) are read; otherwise they are comments.
    pub pragmas: bool,
    /// The language, if the name of the file decides it; `None`: found in the file.
    pub language: Option<Language>,
    /// Texts of titles and comments that the file names by id.
    pub texts: Option<&'a sd::Texts>,
}

impl ReadOptions<'_> {
    /// The options for the parsers of STL and SCL.
    fn parsing(&self) -> ParseOptions {
        ParseOptions { mnemonics: self.mnemonics, pragmas: self.pragmas }
    }
}

/// Parses a source. Never fails: the messages say what is wrong, in the order of the text.
pub fn parse(file: FileId, text: &str, options: &ReadOptions) -> (ast::SourceUnit, Vec<Diagnostic>) {
    match xml::kind(text) {
        Some(xml::XmlKind::PlcOpen) => {
            let (mut unit, messages) = plcopen::parse(file, text);
            if options.pragmas
                && let Ok(document) = xml::parse(text)
            {
                unit.pragmas = xml::pragmas(file, &document);
            }
            return (unit, messages);
        }
        Some(kind) => return simatic_ml::parse(file, text, &kind, options),
        None => {}
    }
    read(file, text, options, language::detect(text, options.language))
}

fn read(file: FileId, text: &str, options: &ReadOptions, reading: Reading) -> (ast::SourceUnit, Vec<Diagnostic>) {
    match reading {
        Reading::Whole(Language::Stl) => stl::parse(file, text, &options.parsing()),
        Reading::Whole(Language::Scl) => scl::parse(file, text, &options.parsing()),
        Reading::Whole(Language::Sd) => sd::parse(file, text, options),
        Reading::Whole(Language::Graph) => gr7::parse(file, text, options),
        Reading::Whole(Language::S7200) => s7200::parse(file, text, &options.parsing()),
        Reading::Mixed(scl) => joined(
            stl::parse(file, &language::masked(text, &scl, false), &options.parsing()),
            scl::parse(file, &language::masked(text, &scl, true), &options.parsing()),
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

/// The parts of a source in the order of its text, each with its language. None for XML.
pub fn parts(text: &str, hint: Option<Language>) -> Vec<(Range<usize>, Language)> {
    if xml::kind(text).is_some() {
        return Vec::new();
    }
    let mut parts = vec![(0..text.len(), Language::Stl)];
    add_parts(text, language::detect(text, hint), &mut parts);
    parts.retain(|(range, _)| !range.is_empty());
    parts
}

/// Bytes of the words, signs, constants and comments of a part in one language, in the order of its text.
pub fn pieces(part: &str, language: Language) -> Vec<Range<usize>> {
    match language {
        Language::Stl => stl::pieces(part),
        Language::Scl | Language::Sd => scl::pieces(part),
        Language::Graph => gr7::pieces(part),
        Language::S7200 => s7200::pieces(part).into_iter().flatten().collect(),
    }
}

/// Gives the last part its language, and cuts out what is in another one.
fn add_parts(text: &str, reading: Reading, parts: &mut Vec<(Range<usize>, Language)>) {
    let (ranges, language) = match reading {
        Reading::Whole(language) => return parts.iter_mut().for_each(|part| part.1 = language),
        Reading::Mixed(ranges) => (ranges, Language::Scl),
        Reading::WithCharts(ranges) => {
            let others = language::masked(text, &ranges, false);
            add_parts(&others, language::detect_statements(&others, None), parts);
            (ranges, Language::Graph)
        }
    };
    for cut in ranges {
        let before = std::mem::take(parts);
        for (range, own) in before {
            let (first, last) = (range.start..range.end.min(cut.start), range.start.max(cut.end)..range.end);
            let inside = range.start <= cut.start && cut.start < range.end;
            parts.extend((first.start < first.end).then_some((first, own)));
            parts.extend(inside.then(|| (cut.clone(), language)));
            parts.extend((last.start < last.end).then_some((last, own)));
        }
    }
}

/// Joins parts of one file that were read separately.
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
pub fn tokens_text(text: &str, options: &ReadOptions) -> String {
    if xml::kind(text).is_some() {
        return simatic_ml::tokens_text(text, options);
    }
    tokens_of(text, options, language::detect(text, options.language))
}

fn tokens_of(text: &str, options: &ReadOptions, reading: Reading) -> String {
    match reading {
        Reading::Whole(Language::Stl) => stl::tokens_text(text, &options.parsing()),
        Reading::Whole(Language::Scl) => scl::tokens_text(text, &options.parsing()),
        Reading::Whole(Language::Sd) => sd::tokens_text(text),
        Reading::Whole(Language::Graph) => gr7::tokens_text(text),
        Reading::Whole(Language::S7200) => s7200::tokens_text(text, &options.parsing()),
        Reading::Mixed(scl) => {
            let stl = stl::tokens_text(&language::masked(text, &scl, false), &options.parsing());
            stl + &scl::tokens_text(&language::masked(text, &scl, true), &options.parsing())
        }
        Reading::WithCharts(charts) => {
            let others = language::masked(text, &charts, false);
            let reading = language::detect_statements(&others, None);
            tokens_of(&others, options, reading) + &gr7::tokens_text(&language::masked(text, &charts, true))
        }
    }
}
