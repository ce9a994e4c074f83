//! Jump labels of STL, SCL, LAD and FBD.

use std::ops::Range;

use plcc_diag::Span;
use plcc_syntax::ast::{Block, Code, OperandKind, StatementKind as StlKind};
use plcc_syntax::network::ast::{Content, Element, Network, PinValue, Target};
use plcc_syntax::network::elements::Kind;
use plcc_syntax::scl::ast::{Body, Statement, StatementKind};

use crate::facts::same;
use crate::index::Entry;
use crate::words::Words;

/// A label before a statement; of SCL also one that is only declared.
#[derive(Clone, Copy)]
pub struct Label<'c> {
    pub name: &'c str,
    pub span: Span,
}

/// The labels of a block.
pub fn of(entry: Entry<'_>) -> Vec<Label<'_>> {
    if let Some(networks) = graphic(entry) {
        let mut found = Vec::new();
        for network in networks {
            found.extend(network.labels.iter().map(|label| Label { name: &label.text, span: label.span }));
            if let Content::Scl(statements) = &network.content {
                collect(statements, &mut found);
            }
        }
        return found;
    }
    let Some(body) = scl(entry) else {
        let labels = entry.statements().filter_map(|statement| statement.label.as_deref());
        return labels.map(|label| Label { name: &label.name, span: label.span }).collect();
    };
    let mut found = Vec::new();
    collect(&body.statements, &mut found);
    for declared in &body.labels {
        if !found.iter().any(|label: &Label| same(label.name, &declared.text)) {
            found.push(Label { name: &declared.text, span: declared.span });
        }
    }
    found
}

/// The label that a piece inside a block is, or that it jumps to.
pub fn at<'c>(entry: Entry<'c>, words: &Words, at: usize) -> Option<Label<'c>> {
    let (word, range) = (words.word(at), words.range(at));
    let stands = |label: &Label| label.span.range() == range;
    let is_goto = || at > 0 && words.word(at - 1).eq_ignore_ascii_case("GOTO");
    if let Some(networks) = graphic(entry) {
        let may_be = at > 0 && words.word(at - 1) == "(" || is_goto() || words.word(at + 1) == ":";
        if !may_be {
            return None;
        }
        let label = of(entry).into_iter().find(|label| label.name == word)?;
        return (stands(&label) || is_goto() || is_coil_target(networks, &range)).then_some(label);
    }
    let Some(body) = scl(entry) else {
        let label = of(entry).into_iter().find(|label| label.name == word)?;
        return (stands(&label) || is_jump_target(entry, &range)).then_some(label);
    };
    // All statements are looked through only for a word that can be a label.
    let is_use = is_goto() || is_declared(body, &range);
    if !is_use && words.word(at + 1) != ":" {
        return None;
    }
    let label = of(entry).into_iter().find(|label| same(label.name, word))?;
    (is_use || stands(&label)).then_some(label)
}

/// Whether label names of a block differ by letter case alone.
pub fn are_cased(entry: Entry) -> bool {
    scl(entry).is_none()
}

fn scl(entry: Entry<'_>) -> Option<&Body> {
    match entry.block {
        Block::Code(block) => match &block.code {
            Code::Scl(body) => Some(body),
            Code::Stl(_) | Code::Graphic(_) | Code::Chart(_) => None,
        },
        Block::Data(_) | Block::Type(_) => None,
    }
}

/// The networks of a block in LAD and FBD.
fn graphic(entry: Entry<'_>) -> Option<&[Network]> {
    match entry.block {
        Block::Code(block) => match &block.code {
            Code::Graphic(body) => Some(&body.networks[..]),
            Code::Stl(_) | Code::Scl(_) | Code::Chart(_) => None,
        },
        Block::Data(_) | Block::Type(_) => None,
    }
}

/// Whether a piece is the label of a jump in a rung.
fn is_coil_target(networks: &[Network], range: &Range<usize>) -> bool {
    let graphs = networks.iter().filter_map(|network| match &network.content {
        Content::Graphic(graph) => Some(graph),
        Content::Scl(_) | Content::Stl(_) => None,
    });
    let is_jump = |element: &&Element| matches!(&element.target, Target::Element { row, .. } if matches!(row.kind, Kind::Jump { .. }));
    let mut pins = graphs.flat_map(|graph| &graph.elements).filter(is_jump).flat_map(|element| &element.pins);
    pins.any(|pin| {
        let is_it = matches!(&pin.value, PinValue::Operand(value) if value.span.range() == *range);
        pin.name == "label" && is_it
    })
}

fn is_declared(body: &Body, range: &Range<usize>) -> bool {
    body.labels.iter().any(|name| name.span.range() == *range)
}

/// The labels before statements, also before those inside others.
fn collect<'c>(statements: &'c [Statement], found: &mut Vec<Label<'c>>) {
    for statement in statements {
        if let StatementKind::Label(name) = &statement.kind {
            found.push(Label { name: &name.text, span: name.span });
        }
        statement.kind.bodies().into_iter().for_each(|body| collect(body, found));
    }
}

/// Whether a piece of STL is the operand of a jump: other operands and parameters may have the name of a label.
fn is_jump_target(entry: Entry, range: &Range<usize>) -> bool {
    entry.statements().any(|statement| match &statement.kind {
        StlKind::Instruction { operand: Some(operand), .. } => {
            matches!(operand.kind, OperandKind::Label(_)) && operand.span.range() == *range
        }
        StlKind::Instruction { operand: None, .. }
        | StlKind::Empty
        | StlKind::Call(_)
        | StlKind::Pragma(_)
        | StlKind::Error => false,
    })
}
