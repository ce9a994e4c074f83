//! The drawings of a program for the page that its services show.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;
use plcc_abi::services::ServicesConfig;
use plcc_diag::FileId;
use plcc_syntax::ast::SourceUnit;
use plcc_view::names::Names;
use plcc_view::{book, page};

use crate::pipeline::{self, Bound, Parsed, Settings};

/// What is drawn, kept from before binding.
struct Undrawn {
    name: String,
    units: Vec<(FileId, SourceUnit)>,
}

/// Binds a program, and draws it for its page if that is `wanted`, which the services of its project may decide.
pub fn bind(parsed: Parsed, settings: &Settings, wanted: impl FnOnce(&ServicesConfig) -> bool) -> Bound {
    let services = parsed.project.as_ref().map(|project| &project.config.services);
    let is_wanted = wanted(services.unwrap_or(&ServicesConfig::default()));
    let undrawn = is_wanted.then(|| Undrawn { name: parsed.name.clone(), units: parsed.units.clone() });
    let mut bound = pipeline::bind(parsed, settings);
    if let Some(undrawn) = undrawn.filter(|_| !bound.has_errors()) {
        bound.program.config.services.drawings = document(&undrawn, &bound);
    }
    bound
}

/// The reference data of a program without errors.
pub fn reference(bound: &Bound) -> serde_json::Value {
    serde_json::json!(plcc_xref::reference(&bound.program, &bound.sources))
}

/// The document, compressed.
fn document(undrawn: &Undrawn, bound: &Bound) -> Vec<u8> {
    let names = Names::of(&bound.program);
    let texts: Vec<_> =
        undrawn.units.iter().map(|(file, unit)| (bound.sources.file(*file).text.as_str(), unit)).collect();
    let book =
        book::book(&undrawn.name, &texts, &bound.program, book::Options { is_live: true, ..book::Options::default() });
    let html = page::document(&book, &names, None, Some(&reference(bound)));
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(html.as_bytes()).and_then(|()| encoder.finish()).expect("memory can be written")
}
