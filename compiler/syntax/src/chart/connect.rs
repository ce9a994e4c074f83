//! Drawn charts: steps, transitions and branches with lines between them become transitions with FROM and TO.
//!
//! A line comes either after steps or after transitions. Alternative branches open and simultaneous ones close after steps; the two other
//! kinds come after transitions. So a transition finds its steps by following branches of one kind back, and of the other kind forward.
//! Source: GRAPH reference B.3.

mod legality;
mod lines;

use std::collections::HashSet;

use plcc_diag::{Diagnostic, Span};

use legality::Side;
use lines::Lines;

/// A chart as it is drawn. Steps, transitions and branches are identified by their index in these lists.
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
    /// Number of its arms, if the file gives it.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    Step(usize),
    Transition(usize),
    /// With the number of the arm: of an output if the line begins there, else of an input. 0 is the leftmost.
    Branch(usize, u32),
    /// End of the sequence.
    End,
}

/// What a transition leaves and enters, as indices into the list of steps.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Connection {
    pub from: Vec<usize>,
    pub to: Vec<usize>,
    pub jump: bool,
    /// Arms of the alternative branches on the way back to its step.
    pub path: Vec<u32>,
}

/// FROM and TO of each transition. Malformed branches and lines are reported, and such lines are not followed.
///
/// A transition that leaves no step has an empty FROM and no message here.
pub fn connect(drawing: &Drawing, diagnostics: &mut Vec<Diagnostic>) -> Vec<Connection> {
    legality::check(drawing, diagnostics);
    let lines = Lines::of(drawing);
    (0..drawing.transitions.len())
        .map(|transition| {
            let mut connection = Connection::default();
            backwards(drawing, &lines, transition, &mut connection);
            forwards(drawing, &lines, transition, &mut connection);
            connection
        })
        .collect()
}

/// The steps that a transition leaves, the leftmost first, and its path.
fn backwards(drawing: &Drawing, lines: &Lines, transition: usize, connection: &mut Connection) {
    let mut seen = HashSet::new();
    let mut pending: Vec<usize> = lines.before_transition(transition).iter().rev().copied().collect();
    while let Some(line) = pending.pop() {
        let line = &drawing.lines[line];
        if !legality::is_legal(drawing, line) {
            continue;
        }
        match line.from {
            Node::Step(step) => {
                if seen.insert(Node::Step(step)) {
                    connection.from.push(step);
                }
            }
            Node::Branch(branch, arm) => {
                if drawing.branches[branch].kind == BranchKind::AlternativeBegin {
                    connection.path.push(arm);
                }
                if seen.insert(Node::Branch(branch, 0)) {
                    pending.extend(lines.before_branch(branch).iter().rev());
                }
            }
            Node::Transition(_) | Node::End => {}
        }
    }
    // The branch next to the step comes first.
    connection.path.reverse();
}

/// The steps that a transition enters, the leftmost first.
fn forwards(drawing: &Drawing, lines: &Lines, transition: usize, connection: &mut Connection) {
    let mut seen = HashSet::new();
    let mut pending: Vec<usize> = lines.after_transition(transition).iter().rev().copied().collect();
    while let Some(line) = pending.pop() {
        let line = &drawing.lines[line];
        if !legality::is_legal(drawing, line) {
            continue;
        }
        connection.jump |= line.jump;
        match line.to {
            Node::Step(step) => {
                if seen.insert(Node::Step(step)) {
                    connection.to.push(step);
                }
            }
            Node::Branch(branch, _) => {
                if seen.insert(Node::Branch(branch, 0)) {
                    pending.extend(lines.after_branch(branch).iter().rev());
                }
            }
            Node::Transition(_) | Node::End => {}
        }
    }
}

impl BranchKind {
    /// What its lines come after.
    fn side(self) -> Side {
        match self {
            BranchKind::AlternativeBegin | BranchKind::SimultaneousEnd => Side::AfterStep,
            BranchKind::AlternativeEnd | BranchKind::SimultaneousBegin => Side::AfterTransition,
        }
    }

    /// Whether its arms are outputs.
    fn opens(self) -> bool {
        matches!(self, BranchKind::AlternativeBegin | BranchKind::SimultaneousBegin)
    }
}

#[cfg(test)]
mod tests;
