//! Permanent instructions: networks before and after the sequencers.

use plcc_diag::Diagnostic;
use roxmltree::Node;

use super::super::reader::Reader;
use super::{condition, is_text};
use crate::xml::{elements, is};
use plcc_syntax::chart::ast::{Permanent, PermanentKind};
use plcc_syntax::network::ast::{Content, Network};

/// Reads the instructions of a list; `place` says where they are. Empty ones are left out.
pub fn read(reader: &mut Reader, list: Node, place: &str, block: &str, language: &str) -> Vec<Permanent> {
    let mut found = Vec::new();
    let mut number = 0;
    for node in elements(list) {
        if !is(node, "PermanentOperation") {
            if !is_text(node.tag_name().name()) {
                reader.refuse(node, &format!("`{block}`"), &format!("`{}`", node.tag_name().name()));
            }
            continue;
        }
        number += 1;
        let whose = format!("permanent instruction {number} {place} of `{block}`");
        let told = reader.diagnostics.len();
        let Some(network) = condition::network(reader, node, language, &whose) else { continue };
        let refused = reader.diagnostics[told..].iter().any(Diagnostic::is_error);
        if !refused && !is_empty(&network) {
            found.push(Permanent { span: network.span, kind: PermanentKind::Network(network) });
        }
    }
    found
}

fn is_empty(network: &Network) -> bool {
    match &network.content {
        Content::Graphic(graph) => graph.elements.is_empty(),
        Content::Scl(statements) => statements.is_empty(),
        Content::Stl(statements) => statements.is_empty(),
    }
}
