//! Whatever a project in PLCopen XML holds, it is read without a panic, its graphs hold together, and they can be drawn.

mod mutate;

use plcc_diag::FileId;
use plcc_syntax::ast::{Block, Code};
use plcc_syntax::network::ast::{Content, Graph, PinValue, Source};
use plcc_syntax::network::draw::draw;
use plcc_syntax::{ast_text, plcopen};
use proptest::prelude::*;
use proptest::sample::Index;

const PROJECTS: [&str; 2] =
    [include_str!("../../../tests/parse/plcopen/ladder.xml"), include_str!("../../../tests/parse/plcopen/blocks.xml")];

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
    "<position x=\"-5\" y=\"1e9\"/>",
    "<connection refLocalId=\"5\"/>",
    "<connection refLocalId=\"8\" formalParameter=\"Q\"/>",
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
        let Code::Graphic(body) = &block.code else { continue };
        for network in &body.networks {
            let Content::Graphic(graph) = &network.content else { continue };
            holds_together(graph)?;
            let _ = draw(network, graph.elements.len().checked_sub(1));
        }
    }
    Ok(())
}

/// Nets know the output pins that feed them, and the other way round.
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
    fn values_may_be_anything(project in 0..2usize, edits in prop::collection::vec((any::<Index>(), any::<Index>()), 1..6)) {
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
        project in 0..2usize,
        edits in prop::collection::vec((any::<Index>(), 0..40usize, 0..PIECES.len()), 1..4),
    ) {
        check(&mutate::mutated(PROJECTS[project], edits, PIECES))?;
    }

    #[test]
    fn a_file_may_end_anywhere(project in 0..2usize, place in any::<Index>()) {
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
