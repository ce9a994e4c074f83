//! Whatever a project in PLCopen XML contains, it is read without a panic, its graphs hold together, and they can be drawn.

mod mutate;

use std::collections::HashSet;

use plcc_diag::FileId;
use plcc_readers::plcopen;
use plcc_syntax::ast::{Block, Code};
use plcc_syntax::ast_text;
use plcc_syntax::chart::ast::{ActionBody, Body as Chart, Condition};
use plcc_syntax::network::ast::{Content, Graph, Network, PinValue, Source};
use plcc_syntax::network::draw::draw;
use proptest::prelude::*;
use proptest::sample::Index;

const PROJECTS: [&str; 5] = [
    include_str!("../../../tests/parse/plcopen/ladder.xml"),
    include_str!("../../../tests/parse/plcopen/blocks.xml"),
    include_str!("../../../tests/parse/plcopen/charts.xml"),
    include_str!("../../../tests/parse/plcopen/star_delta.xml"),
    include_str!("../../../tests/parse/plcopen/two_doses.xml"),
];

/// Pieces that mutations put into files; most leave them well-formed.
const PIECES: &[&str] = &[
    "",
    "1",
    "9",
    "30",
    "true",
    "-1",
    "99999999999999999999",
    "T#3s",
    "&lt;",
    "&#x2264;",
    "ä",
    "Q",
    "OUT",
    "ADD",
    "CTUD",
    "SD",
    "P1",
    "Off",
    "<position x=\"-5\" y=\"1e9\"/>",
    "<connection refLocalId=\"5\"/>",
    "<connection refLocalId=\"8\" formalParameter=\"Q\"/>",
    "<connection refLocalId=\"2\"/>",
    "<reference name=\"Drawn\"/>",
];

fn check(text: &str) -> Result<(), TestCaseError> {
    let (unit, messages) = plcopen::parse(FileId(0), text);
    for message in &messages {
        prop_assert!(message.primary.span.range().end <= text.len(), "{message:?}");
    }
    prop_assert!(!ast_text(&unit).is_empty());
    let _ = plcopen::tags(FileId(0), text);
    if let Some(overlay) = &unit.overlay {
        prop_assert_eq!(overlay.len(), text.len());
    }
    for block in &unit.blocks {
        let Block::Code(block) = block else { continue };
        for network in networks(&block.code) {
            let Content::Graphic(graph) = &network.content else { continue };
            holds_together(graph)?;
            let _ = draw(network, graph.elements.len().checked_sub(1));
        }
        if let Code::Chart(chart) = &block.code {
            numbers_differ(chart)?;
        }
    }
    Ok(())
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
fn numbers_differ(chart: &Chart) -> Result<(), TestCaseError> {
    let steps: HashSet<u32> = chart.steps.iter().map(|step| step.number).collect();
    prop_assert_eq!(steps.len(), chart.steps.len());
    let transitions: HashSet<&str> = chart.transitions.iter().map(|transition| transition.name.text.as_str()).collect();
    prop_assert_eq!(transitions.len(), chart.transitions.len());
    for name in chart.transitions.iter().flat_map(|transition| transition.from.iter().chain(&transition.to)) {
        prop_assert!(chart.steps.iter().any(|step| step.name == *name));
    }
    Ok(())
}

/// Nets know the output pins that feed them, and vice versa.
fn holds_together(graph: &Graph) -> Result<(), TestCaseError> {
    for (at, net) in graph.nets.iter().enumerate() {
        for source in &net.sources {
            if let Source::Pin { element, pin } = source {
                let value = &graph.elements[*element].pins[*pin];
                prop_assert!(value.output);
                prop_assert!(matches!(value.value, PinValue::Net(id) if id.0 as usize == at));
            }
        }
    }
    let pins = graph.elements.iter().flat_map(|element| &element.pins);
    let outputs = pins.filter(|pin| pin.output && matches!(pin.value, PinValue::Net(_))).count();
    let sources = graph.nets.iter().flat_map(|net| &net.sources);
    prop_assert_eq!(outputs, sources.filter(|source| matches!(source, Source::Pin { .. })).count());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn values_may_be_anything(project in 0..PROJECTS.len(), edits in prop::collection::vec((any::<Index>(), any::<Index>()), 1..6)) {
        let mut text = PROJECTS[project].to_string();
        for (place, piece) in edits {
            // The inside of a pair of quotes or of an element.
            let quotes: Vec<usize> = text.match_indices(['"', '>']).map(|(at, _)| at + 1).collect();
            let start = quotes[place.index(quotes.len())];
            let end = text[start..].find(['"', '<']).map_or(start, |length| start + length);
            text.replace_range(start..end, PIECES[piece.index(PIECES.len())]);
        }
        check(&text)?;
    }

    #[test]
    fn bytes_may_be_anything(
        project in 0..PROJECTS.len(),
        edits in prop::collection::vec((any::<Index>(), 0..40usize, 0..PIECES.len()), 1..4),
    ) {
        check(&mutate::mutated(PROJECTS[project], edits, PIECES))?;
    }

    #[test]
    fn a_file_may_end_anywhere(project in 0..PROJECTS.len(), place in any::<Index>()) {
        check(mutate::cut(PROJECTS[project], place).0)?;
    }
}

#[test]
fn the_projects_are_read() {
    for project in PROJECTS {
        assert!(plcopen::is_project(project));
        check(project).unwrap();
    }
}
