//! PLCopen XML: what is read must also hold together, so that it can be drawn.

use std::collections::HashSet;

use plcc_diag::FileId;
use plcc_readers::plcopen;
use plcc_syntax::ast::{Block, Code};
use plcc_syntax::chart::ast::{ActionBody, Body as Chart, Condition};
use plcc_syntax::network::ast::{Content, Graph, Network, PinValue, Source};
use plcc_syntax::network::draw::draw;
use proptest::prelude::*;

use super::input::{Notation, exchanged};
use super::reading::{of, read_with};

const NOTATION: Notation = Notation {
    sources: &[
        include_str!("../../../../../tests/parse/plcopen/ladder.xml"),
        include_str!("../../../../../tests/parse/plcopen/blocks.xml"),
        include_str!("../../../../../tests/parse/plcopen/charts.xml"),
        include_str!("../../../../../tests/parse/plcopen/star_delta.xml"),
        include_str!("../../../../../tests/parse/plcopen/two_doses.xml"),
    ],
    pieces: PIECES,
    frames: &[],
};

/// Pieces that changes put into files; most leave them well-formed.
#[rustfmt::skip]
const PIECES: &[&str] = &[
    "", "1", "9", "30", "true", "-1", "99999999999999999999", "T#3s", "&lt;", "&#x2264;", "ä", "Q", "OUT", "ADD", "CTUD", "SD",
    "P1", "Off", "<position x=\"-5\" y=\"1e9\"/>", "<connection refLocalId=\"5\"/>",
    "<connection refLocalId=\"8\" formalParameter=\"Q\"/>", "<connection refLocalId=\"2\"/>", "<reference name=\"Drawn\"/>",
];

#[test]
fn any_text_is_read() {
    NOTATION.test(check);
}

#[test]
fn the_projects_are_read() {
    for project in NOTATION.sources {
        assert!(plcopen::is_project(project));
        check(project);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn values_may_be_anything(text in exchanged(NOTATION.sources, PIECES)) {
        check(&text);
    }
}

/// Reads a project; its networks can be drawn.
fn check(text: &str) {
    let (unit, _) = read_with(text, &of(None));
    let _ = plcopen::tags(FileId(0), text);
    for block in &unit.blocks {
        let Block::Code(block) = block else { continue };
        for network in networks(&block.code) {
            let Content::Graphic(graph) = &network.content else { continue };
            holds_together(graph);
            let _ = draw(network, graph.elements.len().checked_sub(1));
        }
        if let Code::Chart(chart) = &block.code {
            numbers_differ(chart);
        }
    }
}

/// All networks of a block.
fn networks(code: &Code) -> Vec<&Network> {
    match code {
        Code::Stl(_) | Code::Scl(_) => Vec::new(),
        Code::Graphic(body) => body.networks.iter().collect(),
        Code::Chart(chart) => {
            let actions = chart.steps.iter().flat_map(|step| &step.actions).filter_map(|action| match &action.body {
                ActionBody::Network(network) => Some(network),
                ActionBody::Operand(_)
                | ActionBody::Value { .. }
                | ActionBody::All { .. }
                | ActionBody::Call(_)
                | ActionBody::Statements(_)
                | ActionBody::Error => None,
            });
            let conditions = chart.transitions.iter().filter_map(|transition| match &transition.condition {
                Some(Condition::Network(network)) => Some(network),
                Some(Condition::Expression(_) | Condition::Statements(_)) | None => None,
            });
            actions.chain(conditions).collect()
        }
    }
}

/// Numbers and names that the file does not give are unique, and lines lead to steps of the chart.
fn numbers_differ(chart: &Chart) {
    let steps: HashSet<u32> = chart.steps.iter().map(|step| step.number).collect();
    assert_eq!(steps.len(), chart.steps.len());
    let transitions: HashSet<&str> = chart.transitions.iter().map(|transition| transition.name.text.as_str()).collect();
    assert_eq!(transitions.len(), chart.transitions.len());
    for name in chart.transitions.iter().flat_map(|transition| transition.from.iter().chain(&transition.to)) {
        assert!(chart.steps.iter().any(|step| step.name == *name));
    }
}

/// Nets know the output pins that feed them, and vice versa.
fn holds_together(graph: &Graph) {
    for (at, net) in graph.nets.iter().enumerate() {
        for source in &net.sources {
            if let Source::Pin { element, pin } = source {
                let value = &graph.elements[*element].pins[*pin];
                assert!(value.output);
                assert!(matches!(value.value, PinValue::Net(id) if id.0 as usize == at));
            }
        }
    }
    let pins = graph.elements.iter().flat_map(|element| &element.pins);
    let outputs = pins.filter(|pin| pin.output && matches!(pin.value, PinValue::Net(_))).count();
    let sources = graph.nets.iter().flat_map(|net| &net.sources);
    assert_eq!(outputs, sources.filter(|source| matches!(source, Source::Pin { .. })).count());
}
