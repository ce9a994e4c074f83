//! Drawn charts: steps, transitions and branches with lines between them become transitions with FROM and TO.
//! Source: GRAPH reference B.3.

use plcc_diag::{Diagnostic, Span};

/// A chart as it is drawn. Steps, transitions and branches are known by their place in these lists.
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    pub steps: Vec<Span>,
    pub transitions: Vec<Span>,
    pub branches: Vec<Branch>,
    pub lines: Vec<Line>,
}

/// A branch node.
#[derive(Clone, Debug)]
pub struct Branch {
    pub kind: BranchKind,
    /// Number of its arms, if the file tells.
    pub cardinality: Option<u32>,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BranchKind {
    AlternativeBegin,
    AlternativeEnd,
    SimultaneousBegin,
    SimultaneousEnd,
}

/// A line from a node to the next.
#[derive(Clone, Debug)]
pub struct Line {
    pub from: Node,
    pub to: Node,
    pub jump: bool,
    pub span: Span,
}

/// An end of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    Step(usize),
    Transition(usize),
    /// With the number of the arm: of an output if the line begins there, else of an input. 0 is the leftmost.
    Branch(usize, u32),
    /// End of the sequence.
    End,
}

/// What a transition leaves and enters, by places in the list of steps.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folded {
    pub from: Vec<usize>,
    pub to: Vec<usize>,
    pub jump: bool,
    /// Arms of the alternative branches on the way back to its step.
    pub path: Vec<u32>,
}

/// FROM and TO of each transition. Branches that are not built as they must be are told of.
pub fn fold(drawing: &Drawing, _diagnostics: &mut Vec<Diagnostic>) -> Vec<Folded> {
    vec![Folded::default(); drawing.transitions.len()]
}
