//! Which networks of LAD and FBD are valid: the rules of their editors, on the graph.
//!
//! Everything that the vendor's editors export is valid: a coil directly on the rail, empty networks, unused outputs. Types and
//! names are not checked here. Source: LAD/FBD reference, chapter E.3.

mod block;
mod flow;
mod pins;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::network::ast::{Content, Element, Graph, Network, PinValue, Source, Target};
use plcc_syntax::network::draw::{draw, operand};
use plcc_syntax::network::elements::{Kind, Row};

pub use block::block_warnings;

/// Limit of messages about one network; the first ones show what causes the others.
const MESSAGES_MAX: usize = 8;

/// Reports mistakes in a graphic network, each with a drawing. Networks in SCL and STL have no such mistakes.
pub fn legality(network: &Network, report: &mut Vec<Diagnostic>) {
    let Content::Graphic(graph) = &network.content else { return };
    let mut check = Check { network, graph, feeds: feeds(graph), messages: Vec::new() };
    pins::check(&mut check);
    flow::check(&mut check);
    check.messages.truncate(MESSAGES_MAX);
    report.append(&mut check.messages);
}

/// A network, and the messages about it.
struct Check<'a> {
    network: &'a Network,
    graph: &'a Graph,
    /// Elements that read a net, by net; without other nets.
    feeds: Vec<Feeds>,
    messages: Vec<Diagnostic>,
}

/// The elements that a net feeds.
#[derive(Clone, Default)]
struct Feeds {
    /// In the order of evaluation.
    elements: Vec<usize>,
    /// Another net uses its value.
    net: bool,
}

impl Feeds {
    fn nothing(&self) -> bool {
        self.elements.is_empty() && !self.net
    }
}

fn feeds(graph: &Graph) -> Vec<Feeds> {
    let mut feeds = vec![Feeds::default(); graph.nets.len()];
    for (at, element) in graph.elements.iter().enumerate() {
        for pin in element.pins.iter().filter(|pin| !pin.output) {
            if let PinValue::Net(id) = pin.value
                && let Some(known) = feeds.get_mut(id.0 as usize)
            {
                known.elements.push(at);
            }
        }
    }
    for source in graph.nets.iter().flat_map(|net| &net.sources) {
        if let Source::Net(id) = source
            && let Some(known) = feeds.get_mut(id.0 as usize)
        {
            known.net = true;
        }
    }
    feeds
}

impl Check<'_> {
    /// Reports something about the element `at`, or about a net next to it.
    fn report(&mut self, code: Code, span: Span, at: Option<usize>, title: String, label: &str, help: &str) {
        if self.messages.len() >= MESSAGES_MAX {
            return;
        }
        let message = Diagnostic::new(code, span, title).label(label).help(help);
        self.messages.push(message.note(draw(self.network, at)));
    }
}

fn row(element: &Element) -> Option<&'static Row> {
    match &element.target {
        Target::Element { row, .. } => Some(row),
        Target::Block { .. } => None,
    }
}

/// The element only passes on its flow; it writes nothing that lasts except an edge memory bit.
fn only_logic(element: &Element) -> bool {
    row(element).is_some_and(|row| match row.kind {
        Kind::Contact
        | Kind::Not
        | Kind::Gate(_)
        | Kind::EdgeContact { .. }
        | Kind::EdgeTrigger { .. }
        | Kind::Compare(_)
        | Kind::Range { .. }
        | Kind::Valid { .. }
        | Kind::Variant(_)
        | Kind::Flag(_) => true,
        Kind::Coil
        | Kind::SetCoil
        | Kind::ResetCoil
        | Kind::EdgeCoil { .. }
        | Kind::BitField { .. }
        | Kind::FlipFlop { .. }
        | Kind::Instance(_)
        | Kind::TimerCoil(_)
        | Kind::ResetTimer
        | Kind::PresetTimer
        | Kind::Calculate
        | Kind::Formula
        | Kind::Operator(_)
        | Kind::Step { .. }
        | Kind::Function(_)
        | Kind::Procedure(_)
        | Kind::Move
        | Kind::Convert
        | Kind::Round(_)
        | Kind::Negate
        | Kind::Invert
        | Kind::Mux
        | Kind::Demux
        | Kind::Jump { .. }
        | Kind::JumpList
        | Kind::Switch
        | Kind::Return(_)
        | Kind::S5Timer(_)
        | Kind::S5Counter(_)
        | Kind::CounterCoil(_)
        | Kind::OpenDb { .. }
        | Kind::Mcr(_)
        | Kind::CallCoil
        | Kind::Save
        | Kind::Condition => false,
    })
}

/// An element as messages name it: the name in the editor and its operand, `contact #a`.
fn title(element: &Element) -> String {
    let (what, instance) = match &element.target {
        Target::Element { row, instance } => {
            let what = match row.kind {
                Kind::Contact | Kind::EdgeContact { .. } | Kind::Flag(_) => "contact",
                Kind::Coil | Kind::SetCoil | Kind::ResetCoil | Kind::EdgeCoil { .. } => "coil",
                Kind::Jump { .. } => "jump",
                Kind::Return(_) => "return",
                _ => row.name,
            };
            (what.to_string(), instance.as_ref())
        }
        Target::Block { callee, instance } => (operand(callee), instance.as_ref()),
    };
    let value = instance.or_else(|| {
        element.pin("operand").or_else(|| element.pin("label")).and_then(|pin| match &pin.value {
            PinValue::Operand(value) => Some(value),
            PinValue::Net(_) | PinValue::Open => None,
        })
    });
    match value {
        Some(value) => format!("`{what} {}`", operand(value)),
        None => format!("`{what}`"),
    }
}

#[cfg(test)]
mod tests;
