//! Which drawings are legal: neighbours of branches, numbers of arms, and circles.

use plcc_diag::{Code, Diagnostic};

use super::lines::Lines;
use super::{Branch, BranchKind, Drawing, Line, Node};

/// What a line comes after: something between a step and its transitions, or between a transition and its steps.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Side {
    AfterStep,
    AfterTransition,
}

/// Reports what is wrong with a drawing.
pub fn check(drawing: &Drawing, diagnostics: &mut Vec<Diagnostic>) {
    for line in drawing.lines.iter().filter(|line| !is_legal(drawing, line)) {
        diagnostics.push(neighbour(drawing, line));
    }
    let lines = Lines::of(drawing);
    transitions(drawing, &lines, diagnostics);
    for (at, branch) in drawing.branches.iter().enumerate() {
        arms(drawing, &lines, at, branch, diagnostics);
    }
    circles(drawing, &lines, diagnostics);
}

/// Whether the ends of a line may be neighbours.
pub fn is_legal(drawing: &Drawing, line: &Line) -> bool {
    let side = match line.from {
        Node::Step(_) => Side::AfterStep,
        Node::Transition(_) => Side::AfterTransition,
        Node::Branch(branch, _) => drawing.branches[branch].kind.side(),
        Node::End => return false,
    };
    match line.to {
        Node::Step(_) | Node::End => side == Side::AfterTransition,
        Node::Transition(_) => side == Side::AfterStep,
        Node::Branch(branch, _) => side == drawing.branches[branch].kind.side(),
    }
}

/// The name of a node in messages.
fn name(drawing: &Drawing, node: Node) -> &'static str {
    match node {
        Node::Step(_) => "a step",
        Node::Transition(_) => "a transition",
        Node::Branch(branch, _) => kind_name(drawing.branches[branch].kind),
        Node::End => "the end of the sequence",
    }
}

fn kind_name(kind: BranchKind) -> &'static str {
    match kind {
        BranchKind::AlternativeBegin => "the start of an alternative branch",
        BranchKind::AlternativeEnd => "the end of an alternative branch",
        BranchKind::SimultaneousBegin => "the start of a simultaneous branch",
        BranchKind::SimultaneousEnd => "the end of a simultaneous branch",
    }
}

fn neighbour(drawing: &Drawing, line: &Line) -> Diagnostic {
    let title = format!("{} cannot follow {}", name(drawing, line.to), name(drawing, line.from));
    let help = match (line.from, line.to) {
        (Node::Step(_), Node::Step(_)) => "insert a transition between the two steps",
        (Node::Transition(_), Node::Transition(_)) => "insert a step between the two transitions",
        (_, Node::End) => "end the sequence after a transition",
        (Node::End, _) => "begin the line at a step, a transition or a branch",
        _ => {
            "steps and transitions alternate: an alternative branch begins after a step and ends after transitions, a simultaneous branch begins after a transition and ends after steps"
        }
    };
    Diagnostic::new(Code::BranchNeighbour, line.span, title).label("this line").help(help)
}

/// A transition has one line before it and one after it; only branches join and split.
fn transitions(drawing: &Drawing, lines: &Lines, diagnostics: &mut Vec<Diagnostic>) {
    for (at, span) in drawing.transitions.iter().enumerate() {
        if let [_, second, ..] = lines.before_transition(at) {
            let title = "several lines end at one transition";
            let message = Diagnostic::new(Code::BranchNeighbour, drawing.lines[*second].span, title);
            let help =
                "join the paths with the end of a simultaneous branch, or give each of them a separate transition";
            diagnostics.push(message.label("one more line").also(*span, "the transition").help(help));
        }
        if let [_, second, ..] = lines.after_transition(at) {
            let title = "several lines leave one transition";
            let message = Diagnostic::new(Code::BranchNeighbour, drawing.lines[*second].span, title);
            let help = "connect the transition to the start of a simultaneous branch";
            diagnostics.push(message.label("one more line").also(*span, "the transition").help(help));
        }
    }
}

/// A branch has one line at its single side, and at the other one line for each arm.
fn arms(drawing: &Drawing, lines: &Lines, at: usize, branch: &Branch, diagnostics: &mut Vec<Diagnostic>) {
    let what = kind_name(branch.kind);
    let opens = branch.kind.opens();
    let (incoming, outgoing) = (lines.before_branch(at), lines.after_branch(at));
    let (single, many) = if opens { (incoming, outgoing) } else { (outgoing, incoming) };
    let mut tell = |title: String, label: String| {
        let message = Diagnostic::new(Code::BranchArms, branch.span, title).label(label);
        diagnostics.push(message.help("draw the branch again, with all its arms"));
    };
    if single.len() != 1 {
        let count = if single.is_empty() { "no line".to_string() } else { format!("{} lines", single.len()) };
        let place = if opens { "lead to" } else { "leave" };
        tell(format!("{count} {place} {what}"), "one line is needed".to_string());
    }
    let numbers: Vec<u32> = many
        .iter()
        .filter_map(|line| match if opens { drawing.lines[*line].from } else { drawing.lines[*line].to } {
            Node::Branch(_, arm) => Some(arm),
            Node::Step(_) | Node::Transition(_) | Node::End => None,
        })
        .collect();
    match branch.cardinality {
        Some(wanted) if wanted as usize != numbers.len() => {
            tell(format!("{what} has {} of its {wanted} arms", numbers.len()), format!("{wanted} arms"));
        }
        _ if numbers.is_empty() => tell(format!("{what} has no arms"), "no arms".to_string()),
        _ => {
            // The lines are ordered by number.
            let gap = numbers.iter().zip(0..).find(|(number, wanted)| *number != wanted);
            if let Some((number, wanted)) = gap {
                let title = if *number < wanted {
                    format!("{what} has arm {number} twice")
                } else {
                    format!("{what} has arm {number}, but no arm {wanted}")
                };
                tell(title, format!("arms count from 0 to {}", numbers.len() - 1));
            }
        }
    }
}

/// Branches that form a circle lead to no step.
fn circles(drawing: &Drawing, lines: &Lines, diagnostics: &mut Vec<Diagnostic>) {
    let is_open = |line: &usize| is_legal(drawing, &drawing.lines[*line]);
    let next = |at: usize| {
        let lines = lines.after_branch(at).iter().filter(move |line| is_open(line));
        lines.filter_map(|line| branch_of(drawing.lines[*line].to))
    };
    let previous = |at: usize| {
        let lines = lines.before_branch(at).iter().filter(move |line| is_open(line));
        lines.filter_map(|line| branch_of(drawing.lines[*line].from))
    };
    let mut is_left = vec![true; drawing.branches.len()];
    take_out(&mut is_left, |at| next(at).collect(), |at| previous(at).collect());
    take_out(&mut is_left, |at| previous(at).collect(), |at| next(at).collect());
    let mut circle = (0..drawing.branches.len()).filter(|at| is_left[*at]).map(|at| &drawing.branches[at]);
    let Some(first) = circle.next() else { return };
    let title = "these branches form a circle";
    let mut message = Diagnostic::new(Code::BranchNeighbour, first.span, title).label(kind_name(first.kind));
    for other in circle.take(3) {
        message = message.also(other.span, kind_name(other.kind));
    }
    diagnostics.push(message.help("connect at least one of the branches to steps or transitions"));
}

/// Removes branches that no branch before them leads to, until none are left.
fn take_out(is_left: &mut [bool], next: impl Fn(usize) -> Vec<usize>, previous: impl Fn(usize) -> Vec<usize>) {
    let count = |at: usize| previous(at).into_iter().filter(|other| is_left[*other]).count();
    let mut before: Vec<usize> = (0..is_left.len()).map(count).collect();
    let mut free: Vec<usize> = (0..is_left.len()).filter(|at| is_left[*at] && before[*at] == 0).collect();
    while let Some(at) = free.pop() {
        is_left[at] = false;
        for other in next(at) {
            before[other] = before[other].saturating_sub(1);
            if before[other] == 0 && is_left[other] {
                free.push(other);
            }
        }
    }
}

fn branch_of(node: Node) -> Option<usize> {
    match node {
        Node::Branch(branch, _) => Some(branch),
        Node::Step(_) | Node::Transition(_) | Node::End => None,
    }
}
