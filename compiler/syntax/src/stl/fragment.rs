//! Statements in files of other notations: networks in STL.
//!
//! Spans are those of `text`, of which only `range` is read. Mnemonics are international.

use std::ops::Range;

use plcc_diag::{Diagnostic, FileId};

use super::mnemonics::Detected;
use super::{Mnemonics, raw};
use crate::ast::{Block, Statement, StatementKind};
use crate::front::{self, pragma::is_for_file};

/// The statements in a part of a text. `pragmas`: assertions are read.
pub fn statements(file: FileId, text: &str, range: Range<usize>, pragmas: bool) -> (Vec<Statement>, Vec<Diagnostic>) {
    let mut raw = raw::scan(text.get(range.clone()).unwrap_or_default());
    front::shift(&mut raw.tokens, &mut raw.comments, range.start as u32);
    let detected = Detected { set: Mnemonics::En, is_shown: false, first: [None, None] };
    let parsed = super::parse_raw(file, text, &raw, &detected, pragmas, Vec::new());
    let mut found = Vec::new();
    for block in parsed.blocks {
        if let Block::Code(block) = block {
            let networks = block.networks().to_vec();
            found.extend(networks.into_iter().flat_map(|network| network.statements));
        }
    }
    // Assertions and pauses where there is no statement.
    for pragma in parsed.pragmas.into_iter().filter(|pragma| !is_for_file(pragma)) {
        found.push(Statement { label: None, span: pragma.span, kind: StatementKind::Pragma(pragma) });
    }
    (found, parsed.diagnostics)
}
