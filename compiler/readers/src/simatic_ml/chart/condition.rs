//! Conditions: networks that end in the coil of a transition, an interlock or a supervision.
//!
//! The editor shows a coil that is wired directly to the power rail as an empty network: the transition and the interlock are always
//! satisfied, and there is no supervision. Source: GRAPH reference B.2.

use plcc_diag::Diagnostic;
use roxmltree::Node;

use super::super::network;
use super::super::reader::{Reader, texts};
use crate::xml::{elements, head};
use plcc_syntax::chart::ast::Condition;
use plcc_syntax::network::ast::{Content, Element, Graph, Language, Network, PinValue, Source, Target};
use plcc_syntax::network::elements::Kind;

/// The result of reading a condition.
pub enum Found {
    Network(Condition),
    /// Nothing comes before its coil.
    Rail,
    /// There is no network.
    Nothing,
    /// It cannot be read, which was reported.
    Refused,
}

/// Reads the condition in a node. `language`: that of networks which do not name their own.
pub fn read(reader: &mut Reader, node: Node, language: &str, whose: &str) -> Found {
    let told = reader.diagnostics.len();
    let Some(network) = network(reader, node, language, whose) else { return Found::Nothing };
    let refused = reader.diagnostics[told..].iter().any(Diagnostic::is_error);
    match &network.content {
        _ if refused => Found::Refused,
        Content::Graphic(graph) if graph.elements.is_empty() => Found::Nothing,
        Content::Graphic(graph) => match coils(graph) {
            1 if is_empty(graph) => Found::Rail,
            1 => Found::Network(Condition::Network(network)),
            0 => {
                reader.refuse(node, whose, "a network without the coil of a condition");
                Found::Refused
            }
            _ => {
                reader.refuse(node, whose, "a network with several coils of a condition");
                Found::Refused
            }
        },
        Content::Scl(_) | Content::Stl(_) => {
            reader.refuse(node, whose, "a condition in SCL or STL");
            Found::Refused
        }
    }
}

/// The network in a node; `None` if there is none.
pub fn network(reader: &mut Reader, node: Node, language: &str, whose: &str) -> Option<Network> {
    let source = elements(node).find(|part| is_source(*part))?;
    let named = node.attribute("ProgrammingLanguage").unwrap_or(language);
    let language = network::language_of(named, Some(source.tag_name().name()));
    let (labels, content) = network::content(reader, node, Some(source), (language, named), whose);
    Some(Network {
        language: language.unwrap_or(Language::Lad),
        title: texts(node, &["Title"]).into_iter().next(),
        comment: texts(node, &["Comment"]),
        labels,
        content,
        span: reader.span(head(node)),
    })
}

/// Whether an element is the code of a network.
pub fn is_source(node: Node) -> bool {
    matches!(node.tag_name().name(), "FlgNet" | "StructuredText" | "StatementList")
}

fn coils(graph: &Graph) -> usize {
    let is_coil = |element: &&Element| match &element.target {
        Target::Element { row, .. } => row.kind == Kind::Condition,
        Target::Block { .. } => false,
    };
    graph.elements.iter().filter(is_coil).count()
}

/// Whether there is only a coil, at the power rail or not connected.
fn is_empty(graph: &Graph) -> bool {
    let [coil] = graph.elements.as_slice() else { return false };
    coil.pins.iter().all(|pin| match &pin.value {
        PinValue::Net(net) => graph.net(*net).sources.iter().all(|source| matches!(source, Source::Rail)),
        PinValue::Open => true,
        PinValue::Operand(_) => false,
    })
}
