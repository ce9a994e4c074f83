//! Which steps may be active together: a search through all markings of the net.
//!
//! A marking is the set of active steps. Conditions are ignored: each transition may switch whenever the steps before it are
//! active. A step is active or not, so entering an active step is a mistake; the search notes it and does not go on
//! from there. Source: GRAPH reference G.4.

use rustc_hash::FxHashSet;

use super::net::{Net, StepSet};

/// Limit of markings in a search. Source: GRAPH reference G.4.
pub const MARKINGS_MAX: usize = 100_000;

/// Limit of transitions in a search, for each marking.
const EFFORT: usize = 50;

/// The result of a search.
#[derive(Debug)]
pub struct Search {
    /// All markings were searched.
    pub complete: bool,
    /// Active steps that are entered, each once.
    pub entries: Vec<Entry>,
    /// By transition: it can switch.
    pub switched: Vec<bool>,
    /// By step: steps that may be active together with it, including itself.
    pub together: Vec<StepSet>,
}

/// A transition enters a step that is active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    pub transition: usize,
    pub step: usize,
    /// The last transition before it that opened paths.
    pub opener: Option<usize>,
}

/// A marking and how it came about: the marking before it and the transition between.
struct State {
    marking: StepSet,
    before: Option<(usize, usize)>,
}

/// Searches from the initial steps, up to `markings_max` markings. The net has at most `SET_MAX` steps.
pub fn search(net: &Net, markings_max: usize) -> Search {
    let sets: Vec<(StepSet, StepSet)> =
        net.transitions.iter().map(|arcs| (StepSet::of(&arcs.from), StepSet::of(&arcs.to))).collect();
    let mut found = Search {
        complete: true,
        entries: Vec::new(),
        switched: vec![false; net.transitions.len()],
        together: vec![StepSet::default(); net.steps()],
    };
    let first = StepSet::of(&net.initial);
    let mut known: FxHashSet<StepSet> = [first].into_iter().collect();
    let mut states = vec![State { marking: first, before: None }];
    let mut entered = StepSet::default();
    let mut next = 0;
    let mut looked = 0;
    while next < states.len() {
        if looked > markings_max.saturating_mul(EFFORT) {
            found.complete = false;
            return found;
        }
        let marking = states[next].marking;
        for step in marking.iter() {
            found.together[step] = found.together[step].with(marking);
            looked += net.leaving[step].len();
            for &transition in &net.leaving[step] {
                let (from, to) = sets[transition];
                // Each transition once: with the first of its steps.
                if net.transitions[transition].from[0] != step || !from.within(marking) {
                    continue;
                }
                found.switched[transition] = true;
                let rest = marking.without(from);
                let active = rest.common(to);
                for step in active.without(entered).iter() {
                    found.entries.push(Entry { transition, step, opener: opener(net, &states, next) });
                }
                entered = entered.with(active);
                let after = rest.with(to);
                if active.is_empty() && known.insert(after) {
                    if states.len() == markings_max {
                        found.complete = false;
                        return found;
                    }
                    states.push(State { marking: after, before: Some((next, transition)) });
                }
            }
        }
        next += 1;
    }
    found
}

/// The last transition on the way to a state with several steps after it.
fn opener(net: &Net, states: &[State], at: usize) -> Option<usize> {
    let mut before = states[at].before;
    while let Some((state, transition)) = before {
        if net.transitions[transition].to.len() > 1 {
            return Some(transition);
        }
        before = states[state].before;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::net::Arcs;
    use super::*;

    fn net(steps: usize, initial: &[usize], transitions: &[(&[usize], &[usize])]) -> Net {
        let arcs = |&(from, to): &(&[usize], &[usize])| Arcs { from: from.to_vec(), to: to.to_vec(), jump: false };
        Net::of(steps, initial.to_vec(), transitions.iter().map(arcs).collect())
    }

    #[test]
    fn a_sequence_has_one_active_step() {
        let found = search(&net(3, &[0], &[(&[0], &[1]), (&[1], &[2]), (&[2], &[0])]), 100);
        assert!(found.complete && found.entries.is_empty());
        assert!(found.together.iter().all(|steps| steps.len() == 1));
        assert_eq!(found.switched, [true; 3]);
    }

    #[test]
    fn paths_between_branch_and_join_are_active_together() {
        // Two doses, then mixing. Source: GRAPH reference H.2.
        let doses: &[(&[usize], &[usize])] =
            &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[4]), (&[3, 4], &[5]), (&[5], &[0])];
        let found = search(&net(6, &[0], doses), 100);
        assert!(found.complete && found.entries.is_empty());
        assert!(found.together[1].has(2) && found.together[1].has(4) && found.together[3].has(4));
        assert!(!found.together[1].has(3) && !found.together[0].has(1));
        assert_eq!(found.switched, [true; 5]);
    }

    #[test]
    fn alternative_joins_of_parallel_paths_enter_an_active_step() {
        let found = search(&net(4, &[0], &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[3]), (&[3], &[0])]), 100);
        assert_eq!(found.entries[0], Entry { transition: 2, step: 3, opener: Some(0) });
    }

    #[test]
    fn joins_of_alternative_paths_do_not_switch() {
        let found = search(&net(4, &[0], &[(&[0], &[1]), (&[0], &[2]), (&[1, 2], &[3]), (&[3], &[0])]), 100);
        assert_eq!(found.switched, [true, true, false, false]);
    }

    #[test]
    fn the_search_has_an_end() {
        // Eight paths of 30 steps have 30^8 markings.
        let (paths, length) = (8, 30);
        let mut transitions: Vec<Arcs> = Vec::new();
        let begin = |path: usize| 1 + path * length;
        transitions.push(Arcs { from: vec![0], to: (0..paths).map(begin).collect(), jump: false });
        for step in (0..paths).flat_map(|path| begin(path)..begin(path) + length - 1) {
            transitions.push(Arcs { from: vec![step], to: vec![step + 1], jump: false });
        }
        let net = Net::of(1 + paths * length, vec![0], transitions);
        assert!(!search(&net, MARKINGS_MAX).complete);
    }

    #[test]
    fn no_step_at_all() {
        let found = search(&net(0, &[], &[]), 100);
        assert!(found.complete && found.entries.is_empty());
    }
}
