//! Lines of a drawing by the nodes that they join.

use super::{Drawing, Line, Node};

/// Indices of lines. Those at arms of a branch are in the order of the arms, the others in the order of the list.
pub struct Lines {
    before_transitions: Vec<Vec<usize>>,
    after_transitions: Vec<Vec<usize>>,
    before_branches: Vec<Vec<usize>>,
    after_branches: Vec<Vec<usize>>,
}

impl Lines {
    pub fn of(drawing: &Drawing) -> Lines {
        let mut lines = Lines {
            before_transitions: vec![Vec::new(); drawing.transitions.len()],
            after_transitions: vec![Vec::new(); drawing.transitions.len()],
            before_branches: vec![Vec::new(); drawing.branches.len()],
            after_branches: vec![Vec::new(); drawing.branches.len()],
        };
        for (at, line) in drawing.lines.iter().enumerate() {
            match line.to {
                Node::Transition(transition) => lines.before_transitions[transition].push(at),
                Node::Branch(branch, _) => lines.before_branches[branch].push(at),
                Node::Step(_) | Node::End => {}
            }
            match line.from {
                Node::Transition(transition) => lines.after_transitions[transition].push(at),
                Node::Branch(branch, _) => lines.after_branches[branch].push(at),
                Node::Step(_) | Node::End => {}
            }
        }
        let arm = |end: fn(&Line) -> Node| {
            move |at: &usize| match end(&drawing.lines[*at]) {
                Node::Branch(_, arm) => arm,
                Node::Step(_) | Node::Transition(_) | Node::End => 0,
            }
        };
        lines.before_branches.iter_mut().for_each(|own| own.sort_by_key(arm(|line| line.to)));
        lines.after_branches.iter_mut().for_each(|own| own.sort_by_key(arm(|line| line.from)));
        lines
    }

    pub fn before_transition(&self, transition: usize) -> &[usize] {
        &self.before_transitions[transition]
    }

    pub fn after_transition(&self, transition: usize) -> &[usize] {
        &self.after_transitions[transition]
    }

    pub fn before_branch(&self, branch: usize) -> &[usize] {
        &self.before_branches[branch]
    }

    pub fn after_branch(&self, branch: usize) -> &[usize] {
        &self.after_branches[branch]
    }
}
