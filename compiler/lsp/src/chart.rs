//! Steps and transitions of GRAPH.

use plcc_diag::Span;
use plcc_syntax::ast::{Block, Code};
use plcc_syntax::chart::ast::{Body, Step, Transition};

use crate::facts::same;
use crate::index::Entry;

/// A step or a transition.
#[derive(Clone, Copy)]
pub enum Part<'c> {
    Step(&'c Step),
    Transition(&'c Transition),
}

impl<'c> Part<'c> {
    pub fn name(&self) -> &'c str {
        match self {
            Part::Step(step) => &step.name.text,
            Part::Transition(transition) => &transition.name.text,
        }
    }

    /// The place of its name.
    pub fn span(&self) -> Span {
        match self {
            Part::Step(step) => step.name.span,
            Part::Transition(transition) => transition.name.span,
        }
    }

    pub fn whole(&self) -> Span {
        match self {
            Part::Step(step) => step.span,
            Part::Transition(transition) => transition.span,
        }
    }

    /// `step S2`
    pub fn kind(&self) -> String {
        match self {
            Part::Step(step) => format!("step S{}", step.number),
            Part::Transition(transition) => format!("transition T{}", transition.number),
        }
    }

    pub fn comment(&self) -> String {
        match self {
            Part::Step(step) => step.comment.join("\n"),
            Part::Transition(transition) => transition.comment.join("\n"),
        }
    }
}

/// The steps and transitions of a block.
pub fn of(entry: Entry<'_>) -> Vec<Part<'_>> {
    let Some(body) = body(entry) else { return Vec::new() };
    body.steps.iter().map(Part::Step).chain(body.transitions.iter().map(Part::Transition)).collect()
}

/// The one with a name; `S002` is also the name of step 2, and `T002` that of transition 2.
pub fn named<'c>(entry: Entry<'c>, name: &str) -> Option<Part<'c>> {
    let numbered = |part: &Part| {
        let own = match part {
            Part::Step(step) => format!("S{:03}", step.number),
            Part::Transition(transition) => format!("T{:03}", transition.number),
        };
        own.eq_ignore_ascii_case(name)
    };
    let all = of(entry);
    all.iter().find(|part| same(part.name(), name)).or_else(|| all.iter().find(|&part| numbered(part))).copied()
}

fn body(entry: Entry<'_>) -> Option<&Body> {
    match entry.block {
        Block::Code(block) => match &block.code {
            Code::Chart(body) => Some(body),
            Code::Stl(_) | Code::Scl(_) | Code::Graphic(_) => None,
        },
        Block::Data(_) | Block::Type(_) => None,
    }
}
