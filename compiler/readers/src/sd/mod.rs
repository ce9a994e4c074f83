//! SIMATIC SD (`.s7dcl`): blocks of LAD, FBD and SCL networks, data blocks and types as the TIA Portal V20 and later export them.
//!
//! ```text
//! text ──► raw tokens ──┬─► heads and declarations ──► grammar of SCL ──────────────┐
//!      scl/raw.rs    frame.rs                                                       ├──► syntax tree
//!                       └─► networks ──► tokens ──► rungs ──► elements and nets ────┘
//!                                   classify.rs  sd.lalrpop     graph/
//! ```
//!
//! The words, names and constants are those of SCL, so its lexer reads them. Texts of titles and comments are in a file
//! next to the source: [`Texts`]. Source: LAD/FBD reference, chapter A.

mod blocks;
mod classify;
mod frame;
mod graph;
mod messages;
mod network;
mod pragma;
mod settings;
mod texts;
mod token;
mod tree;

#[allow(clippy::all, clippy::pedantic, dead_code, unused_imports, unused_parens, missing_docs)] // Generated.
mod grammar {
    include!(concat!(env!("OUT_DIR"), "/sd/sd.rs"));
}

use plcc_diag::{Diagnostic, FileId, Span};

use crate::ReadOptions;
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::front;
use plcc_syntax::scl::raw;

pub use texts::Texts;

/// Parses a document. Recovers from errors; what it cannot parse is left out or becomes an error node.
pub fn parse(file: FileId, text: &str, options: &ReadOptions) -> (SourceUnit, Vec<Diagnostic>) {
    let mut diagnostics = Vec::new();
    let raw = raw::scan(text);
    for (index, token) in raw.tokens.iter().enumerate() {
        if let Some(word) = classify::misspelt(text, &raw.tokens, index) {
            let span = Span { file, start: token.start, end: token.end };
            diagnostics.push(front::frame_words::misspelt(span, &text[token.range()], word));
        }
    }
    let document = frame::read(file, text, raw, &mut diagnostics);
    settings::check(&document, &mut diagnostics);
    let unit = blocks::build(file, text, document, options, &mut diagnostics);
    diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    (unit, diagnostics)
}

/// The tokens of the networks as the grammar sees them, one per line, for `--emit tokens`.
pub fn tokens_text(text: &str) -> String {
    let file = FileId::default();
    let document = frame::read(file, text, raw::scan(text), &mut Vec::new());
    let networks = document.blocks.iter().flat_map(|block| &block.networks);
    let tokens =
        networks.flat_map(|network| classify::classify(file, text, &document.tokens[network.tokens.clone()]).tokens);
    front::tokens_text(text, &tokens.collect::<Vec<_>>())
}
