//! Lines of a drawing by the nodes that they join.

use super::{Drawing, Line, Node};

/// Places of lines in the list of lines. Those at arms of a branch are in the order of the arms, else of the list.
pub struct Lines {
    into_transitions: Vec<Vec<usize>>,
    out_of_transitions: Vec<Vec<usize>>,
    into_branches: Vec<Vec<usize>>,
    out_of_branches: Vec<Vec<usize>>,
}

impl Lines {
    pub fn of(drawing: &Drawing) -> Lines {
        let mut lines = Lines {
            into_transitions: vec![Vec::new(); drawing.transitions.len()],
            out_of_transitions: vec![Vec::new(); drawing.transitions.len()],
            into_branches: vec![Vec::new(); drawing.branches.len()],
            out_of_branches: vec![Vec::new(); drawing.branches.len()],
        };
        for (at, line) in drawing.lines.iter().enumerate() {
            match line.to {
                Node::Transition(transition) => lines.into_transitions[transition].push(at),
                Node::Branch(branch, _) => lines.into_branches[branch].push(at),
                Node::Step(_) | Node::End => {}
            }
            match line.from {
                Node::Transition(transition) => lines.out_of_transitions[transition].push(at),
                Node::Branch(branch, _) => lines.out_of_branches[branch].push(at),
                Node::Step(_) | Node::End => {}
            }
        }
        let arm = |end: fn(&Line) -> Node| {
            move |at: &usize| match end(&drawing.lines[*at]) {
                Node::Branch(_, arm) => arm,
                Node::Step(_) | Node::Transition(_) | Node::End => 0,
            }
        };
        lines.into_branches.iter_mut().for_each(|own| own.sort_by_key(arm(|line| line.to)));
        lines.out_of_branches.iter_mut().for_each(|own| own.sort_by_key(arm(|line| line.from)));
        lines
    }

    pub fn into_transition(&self, transition: usize) -> &[usize] {
        &self.into_transitions[transition]
    }

    pub fn out_of_transition(&self, transition: usize) -> &[usize] {
        &self.out_of_transitions[transition]
    }

    pub fn into_branch(&self, branch: usize) -> &[usize] {
        &self.into_branches[branch]
    }

    pub fn out_of_branch(&self, branch: usize) -> &[usize] {
        &self.out_of_branches[branch]
    }
}
