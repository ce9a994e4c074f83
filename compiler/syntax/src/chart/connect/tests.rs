//! Drawings and what transitions they connect.

use plcc_diag::{Code, FileId, Span};

use super::BranchKind::{AlternativeBegin, AlternativeEnd, SimultaneousBegin, SimultaneousEnd};
use super::Node::{Branch as B, End, Step as S, Transition as T};
use super::*;

fn span(at: usize) -> Span {
    Span::new(FileId::default(), at..at + 1)
}

fn drawing(steps: usize, transitions: usize, branches: &[(BranchKind, u32)], lines: &[(Node, Node)]) -> Drawing {
    let branch = |(kind, cardinality): &(BranchKind, u32)| Branch {
        kind: *kind,
        cardinality: Some(*cardinality),
        span: span(0),
    };
    let line = |(at, (from, to)): (usize, &(Node, Node))| Line { from: *from, to: *to, jump: false, span: span(at) };
    Drawing {
        steps: (0..steps).map(span).collect(),
        transitions: (0..transitions).map(span).collect(),
        branches: branches.iter().map(branch).collect(),
        lines: lines.iter().enumerate().map(line).collect(),
    }
}

/// FROM, TO and path of each transition; the codes of the messages.
type Outcome = (Vec<(Vec<usize>, Vec<usize>, Vec<u32>)>, Vec<Code>);

fn connection(drawing: &Drawing) -> Outcome {
    let mut messages = Vec::new();
    let found = connect(drawing, &mut messages).into_iter().map(|own| (own.from, own.to, own.path)).collect();
    (found, messages.into_iter().map(|message| message.code).collect())
}

#[test]
fn a_line_of_steps_ends() {
    let chart = drawing(2, 2, &[], &[(S(0), T(0)), (T(0), S(1)), (S(1), T(1)), (T(1), End)]);
    assert_eq!(connection(&chart), (vec![(vec![0], vec![1], vec![]), (vec![1], vec![], vec![])], vec![]));
}

#[test]
fn a_jump_is_marked() {
    let mut chart = drawing(1, 1, &[], &[(S(0), T(0)), (T(0), S(0))]);
    chart.lines[1].jump = true;
    assert!(connect(&chart, &mut Vec::new())[0].jump);
}

#[test]
fn alternative_paths_stand_in_one_another() {
    let branches = [(AlternativeBegin, 2), (AlternativeBegin, 2), (AlternativeEnd, 2)];
    let lines = [
        (S(0), B(0, 0)),
        (B(0, 1), B(1, 0)),
        (B(0, 0), T(0)),
        (B(1, 0), T(1)),
        (B(1, 1), T(2)),
        (T(0), B(2, 0)),
        (T(1), B(2, 1)),
        (B(2, 0), S(1)),
        (T(2), S(0)),
    ];
    let expected = vec![(vec![0], vec![1], vec![0]), (vec![0], vec![1], vec![1, 0]), (vec![0], vec![0], vec![1, 1])];
    assert_eq!(connection(&drawing(2, 3, &branches, &lines)), (expected, vec![]));
}

#[test]
fn paths_open_and_join_together() {
    let branches = [(SimultaneousBegin, 2), (SimultaneousEnd, 2)];
    // Arms are written in the other order.
    let lines = [
        (S(0), T(0)),
        (T(0), B(0, 0)),
        (B(0, 1), S(2)),
        (B(0, 0), S(1)),
        (S(2), B(1, 1)),
        (S(1), B(1, 0)),
        (B(1, 0), T(1)),
        (T(1), S(0)),
    ];
    let expected = vec![(vec![0], vec![1, 2], vec![]), (vec![1, 2], vec![0], vec![])];
    assert_eq!(connection(&drawing(3, 2, &branches, &lines)), (expected, vec![]));
}

#[test]
fn alternatives_may_lead_to_a_simultaneous_branch_and_follow_one() {
    let branches = [
        (AlternativeBegin, 2),
        (AlternativeEnd, 2),
        (SimultaneousBegin, 2),
        (SimultaneousEnd, 2),
        (AlternativeBegin, 2),
    ];
    let lines = [
        (S(0), B(0, 0)),
        (B(0, 0), T(0)),
        (B(0, 1), T(1)),
        (T(0), B(1, 0)),
        (T(1), B(1, 1)),
        (B(1, 0), B(2, 0)),
        (B(2, 0), S(1)),
        (B(2, 1), S(2)),
        (S(1), B(3, 0)),
        (S(2), B(3, 1)),
        (B(3, 0), B(4, 0)),
        (B(4, 0), T(2)),
        (B(4, 1), T(3)),
        (T(2), S(0)),
        (T(3), End),
    ];
    let expected = vec![
        (vec![0], vec![1, 2], vec![0]),
        (vec![0], vec![1, 2], vec![1]),
        (vec![1, 2], vec![0], vec![0]),
        (vec![1, 2], vec![], vec![1]),
    ];
    assert_eq!(connection(&drawing(3, 4, &branches, &lines)), (expected, vec![]));
}

#[test]
fn a_transition_without_a_step_before_it_is_told_elsewhere() {
    assert_eq!(connection(&drawing(1, 1, &[], &[(T(0), S(0))])), (vec![(vec![], vec![0], vec![])], vec![]));
}

#[test]
fn branches_stand_between_the_right_neighbours() {
    let kinds = [
        (AlternativeEnd, S(0), S(0)),
        (AlternativeBegin, T(0), T(0)),
        (SimultaneousEnd, T(0), T(0)),
        (SimultaneousBegin, S(0), S(0)),
    ];
    for (kind, before, after) in kinds {
        let chart = drawing(1, 1, &[(kind, 1)], &[(before, B(0, 0)), (B(0, 0), after)]);
        assert_eq!(connection(&chart).1, [Code::BranchNeighbour], "{kind:?}");
    }
    for line in [(S(0), S(0)), (T(0), T(0)), (S(0), End), (End, S(0))] {
        assert_eq!(connection(&drawing(1, 1, &[], &[line])).1, [Code::BranchNeighbour], "{line:?}");
    }
}

#[test]
fn a_transition_joins_nothing() {
    let chart = drawing(2, 1, &[], &[(S(0), T(0)), (S(1), T(0)), (T(0), S(0)), (T(0), S(1))]);
    assert_eq!(connection(&chart).1, [Code::BranchNeighbour, Code::BranchNeighbour]);
}

#[test]
fn arms_are_counted() {
    let arms = |cardinality: u32, arms: &[u32]| {
        let mut lines = vec![(S(0), B(0, 0))];
        lines.extend(arms.iter().enumerate().map(|(at, arm)| (B(0, *arm), T(at))));
        connection(&drawing(1, arms.len(), &[(AlternativeBegin, cardinality)], &lines)).1
    };
    assert_eq!(arms(2, &[0, 1]), []);
    assert_eq!(arms(3, &[0, 1]), [Code::BranchArms]);
    assert_eq!(arms(2, &[0, 2]), [Code::BranchArms]);
    assert_eq!(arms(2, &[1, 1]), [Code::BranchArms]);
    assert_eq!(arms(2, &[0, u32::MAX]), [Code::BranchArms]);
    assert_eq!(arms(0, &[]), [Code::BranchArms]);
}

#[test]
fn a_circle_of_branches_is_told_once() {
    let lines = [(B(0, 0), B(1, 0)), (B(1, 0), B(0, 0)), (B(0, 1), T(0)), (B(1, 1), T(1))];
    let (found, codes) = connection(&drawing(0, 2, &[(AlternativeBegin, 2), (AlternativeBegin, 2)], &lines));
    assert_eq!(codes, [Code::BranchNeighbour]);
    assert!(found.iter().all(|(from, ..)| from.is_empty()));
}

#[test]
fn a_long_chain_of_branches_is_followed() {
    let count = 100_000;
    let mut lines = vec![(S(0), B(0, 0)), (B(count - 1, 0), T(0))];
    lines.extend((1..count).map(|at| (B(at - 1, 0), B(at, 0))));
    let (found, codes) = connection(&drawing(1, 1, &vec![(AlternativeBegin, 1); count], &lines));
    assert!(codes.is_empty());
    assert_eq!(found[0].0, [0]);
}
