//! SimaticML: exports of the TIA Portal (Openness, Version Control Interface), of the versions V14 SP1 to V21.
//!
//! ```text
//! Document ─► objects ─► block.rs ─► interface.rs ─► data_type.rs, initial.rs
//!                           │
//!                           └► network.rs ─► parts.rs ─► graph.rs, order.rs   FlgNet: LAD, FBD
//!                                       ├──► tokens.rs                        StructuredText: SCL
//!                                       └──► statements.rs                    StatementList: STL
//! ```
//!
//! Names, operands and tokens are written to their positions in an [`overlay`], from which the parsers of SCL and STL read them. Tag tables are
//! read by `plcc_syntax::symbols`. Source: LAD/FBD reference A2.
//!
//! **Invariant**: if a network or block contains anything unknown, the reader refuses it; nothing is left out silently.

mod block;
mod chart;
mod data_type;
mod graph;
mod initial;
mod interface;
mod languages;
mod network;
mod operand;
mod order;
mod outline;
mod overlay;
pub mod parts;
mod reader;
mod remarks;
mod schema;
mod statements;
mod step_time;
mod tokens;
mod version;

use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};

use crate::ReadOptions;
use crate::spelling;
use crate::xml::{self, XmlKind, head, objects};
pub use languages::{comments_left_out, languages_left_out};
use overlay::Overlay;
use plcc_syntax::ast::SourceUnit;
use reader::Reader;
pub use remarks::{Remarks, remarks};

/// Parses an export. The reader skips what it cannot read, and reports it.
pub fn parse(file: FileId, text: &str, kind: &XmlKind, options: &ReadOptions) -> (SourceUnit, Vec<Diagnostic>) {
    let document = match xml::parse(text) {
        Ok(document) => document,
        Err(error) => return (SourceUnit::default(), vec![xml::broken(file, text, &error)]),
    };
    let root = document.root_element();
    if let XmlKind::PlcOpen | XmlKind::TagTable | XmlKind::Other(_) | XmlKind::Broken = kind {
        let span = Span::new(file, head(root));
        if xml::is_fragment(root.tag_name().name()) {
            let title = format!("the file is only a part of an export: `{}`", root.tag_name().name());
            let refused = Diagnostic::new(Code::NotASource, span, title)
                .label("the block that it belongs to is missing")
                .help("export the whole block: the file begins with `Document`, which contains `SW.Blocks.FC` or a similar element");
            return (SourceUnit::default(), vec![refused]);
        }
        let title = format!("XML of this kind is not a PLC source: `{}`", root.tag_name().name());
        let refused = Diagnostic::new(Code::NotASource, span, title)
            .label("not an export of the TIA Portal or of PLCopen")
            .help("export the blocks from the TIA Portal as XML (SimaticML)");
        return (SourceUnit::default(), vec![refused]);
    }
    let mut misspelt = objects(root).into_iter().filter_map(|object| misspelt_object(file, object)).collect::<Vec<_>>();
    misspelt.extend(spelling::faults(file, &document, &schema::GRAMMAR));
    if !misspelt.is_empty() {
        return (SourceUnit::default(), misspelt);
    }
    let mut reader =
        Reader { file, overlay: Overlay::new(text), pragmas: options.pragmas, own_step: None, diagnostics: Vec::new() };
    let mut blocks = Vec::new();
    for object in objects(root) {
        match object.tag_name().name() {
            // The reader of symbol tables has these.
            name if xml::is_exported_tags(name) => {}
            name if xml::is_block(name) => blocks.extend(block::read(&mut reader, object)),
            name if xml::is_fragment(name) => {
                let span = reader.span(head(object));
                let refused = Diagnostic::new(Code::NotASource, span, format!("`{name}` is here without its block"));
                let help = "export the whole block: `SW.Blocks.FC` or a similar element, with its networks in it";
                reader.diagnostics.push(refused.label("a part of an export").help(help));
            }
            name => {
                let span = reader.span(head(object));
                let mut note = Diagnostic::new(Code::ForeignContent, span, format!("plcc skips `{name}`"))
                    .label("not a block, data type or tag table")
                    .help("no action is needed, unless the program depends on it");
                note.severity = Severity::Warning;
                reader.diagnostics.push(note);
            }
        }
    }
    version::check(&mut reader, &document);
    let pragmas = if options.pragmas { xml::pragmas(file, &document) } else { Vec::new() };
    let outlines = outline::read(&mut reader, &document);
    let mut diagnostics = reader.diagnostics;
    diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    // The schema and the reader of an element find the same fault.
    diagnostics.dedup_by_key(|diagnostic| (diagnostic.code, diagnostic.primary.span));
    let overlay = Some(reader.overlay.into_text());
    (SourceUnit { blocks, pragmas, overlay, outlines, ..SourceUnit::default() }, diagnostics)
}

/// The message for an object whose name is a slip.
fn misspelt_object(file: FileId, object: roxmltree::Node) -> Option<Diagnostic> {
    let name = object.tag_name().name();
    let meant = xml::nearest_object(name)?;
    let title = format!("`{name}` is not an object of an export of the TIA Portal");
    Some(
        Diagnostic::new(Code::ForeignContent, Span::new(file, head(object)), title)
            .label("everything in it would be left out")
            .help(format!("is `{meant}` meant? plcc does not read the file before this is corrected")),
    )
}

/// The overlay of a file without blank lines, for `--emit tokens`.
pub fn tokens_text(text: &str, options: &ReadOptions) -> String {
    let kind = xml::kind(text).unwrap_or(XmlKind::Broken);
    let (unit, _) = parse(FileId::default(), text, &kind, options);
    let overlay = unit.overlay.unwrap_or_default();
    let mut out = String::new();
    for word in overlay.split("  ").map(str::trim).filter(|word| !word.is_empty()) {
        out.push_str(word);
        out.push('\n');
    }
    out
}
