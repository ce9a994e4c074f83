//! The drawings of a program for the page that its services show.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;
use plcc_diag::FileId;
use plcc_syntax::ast::SourceUnit;
use plcc_view::names::Names;
use plcc_view::{book, page};

use crate::pipeline::{self, Bound, Parsed, Settings};

/// What is drawn, kept from before binding.
pub struct Undrawn {
    name: String,
    units: Vec<(FileId, SourceUnit)>,
}

/// Keeps what the drawings need, if the program is to have them: its project asks for services, or `wanted`.
pub fn keep(parsed: &Parsed, wanted: bool) -> Option<Undrawn> {
    let has_services = parsed.project.as_ref().is_some_and(|project| project.config.services.linked);
    (wanted || has_services).then(|| Undrawn { name: parsed.name.clone(), units: parsed.units.clone() })
}

/// Binds a program, and draws it for its page if it has one.
pub fn bind(parsed: Parsed, settings: &Settings, wanted: bool) -> Bound {
    let undrawn = keep(&parsed, wanted);
    let mut bound = pipeline::bind(parsed, settings);
    if let Some(undrawn) = undrawn.filter(|_| !bound.has_errors()) {
        bound.program.config.services.drawings = document(&undrawn, &bound);
    }
    bound
}

/// The document, compressed.
fn document(undrawn: &Undrawn, bound: &Bound) -> Vec<u8> {
    let names = Names::of(&bound.program);
    let texts: Vec<_> =
        undrawn.units.iter().map(|(file, unit)| (bound.sources.file(*file).text.as_str(), unit)).collect();
    let book = book::book(&undrawn.name, &texts, &bound.program, book::Options::default());
    let html = page::document(&book, &names, None);
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(html.as_bytes()).and_then(|()| encoder.finish()).expect("memory can be written")
}
