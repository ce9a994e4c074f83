//! Simultaneous branches as drawn: which steps a path has, and where it is left or entered other than by the branch and its join.
//!
//! A path has the steps after its first one, up to the join. A chart in which each branch has a join with one step of every
//! path, and no other way out or in, cannot go wrong: its paths show which steps are active together, without a
//! search. Source: GRAPH reference, chapter I, "Detection".

use super::net::{Net, StepSet};

/// Limit of transitions times paths for the search for paths. A chart of 250 steps has some thousands.
const WORK_MAX: usize = 20_000_000;

/// A transition that leaves or enters a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stray {
    pub transition: usize,
    /// Where it goes.
    pub step: usize,
    /// A transition that opens the paths.
    pub opener: usize,
    /// It goes into the path.
    pub inward: bool,
}

/// The branches of a net.
#[derive(Debug, Default)]
pub struct Branches {
    pub strays: Vec<Stray>,
    /// Openers whose paths do not end in one join.
    pub loose: Vec<usize>,
    /// By step: steps of other paths, and of other sequencers.
    pub together: Vec<StepSet>,
    /// Each sequencer has at most one initial step, outside of all paths.
    pub one_start: bool,
}

impl Branches {
    /// The paths alone show all markings.
    pub fn proven(&self) -> bool {
        self.one_start && self.loose.is_empty()
    }
}

/// Finds the paths of all branches. The net has at most `SET_MAX` steps.
pub fn branches(net: &Net) -> Branches {
    let mut found = Branches { together: vec![StepSet::default(); net.steps()], ..Branches::default() };
    let mut inside = StepSet::default();
    let ways: usize = net.transitions.iter().map(|arcs| arcs.from.len() + arcs.to.len()).sum();
    let paths: usize = net.transitions.iter().map(|arcs| arcs.to.len()).filter(|&paths| paths > 1).sum();
    if ways.saturating_mul(paths) > WORK_MAX {
        return found;
    }
    for opener in 0..net.transitions.len() {
        let opens_as = |at: &usize| net.transitions[*at].to == net.transitions[opener].to;
        if net.transitions[opener].to.len() > 1 && !(0..opener).any(|at| opens_as(&at)) {
            let branch = Branch::new(net, (opener..net.transitions.len()).filter(opens_as).collect());
            inside = branch.paths.iter().fold(inside, |all, &path| all.with(path));
            branch.judge(&mut found);
        }
    }
    sequencers(net, inside, &mut found);
    found
}

/// Steps of different sequencers are active together.
fn sequencers(net: &Net, inside: StepSet, found: &mut Branches) {
    let sequencer = net.sequencers();
    let mut starts = vec![0; net.steps()];
    net.initial.iter().for_each(|&step| starts[sequencer[step]] += 1);
    found.one_start = starts.iter().all(|&count| count < 2) && !StepSet::of(&net.initial).meets(inside);
    let members = |first: usize| StepSet::of(&(0..net.steps()).filter(|&s| sequencer[s] == first).collect::<Vec<_>>());
    let started: Vec<StepSet> = (0..net.steps()).filter(|&first| starts[first] > 0).map(members).collect();
    let all = started.iter().fold(StepSet::default(), |all, &one| all.with(one));
    for one in &started {
        let others = all.without(*one);
        one.iter().for_each(|step| found.together[step] = found.together[step].with(others));
    }
}

/// A simultaneous branch.
struct Branch<'n> {
    net: &'n Net,
    /// The transitions that open its paths.
    openers: Vec<usize>,
    /// By path: what comes after its first step, ignoring joins and ways out.
    following: Vec<StepSet>,
    /// By path: those of `following` on the way to the join.
    toward: Vec<StepSet>,
    /// Steps that are active without the branch, or after it.
    outside: StepSet,
    /// By path: its steps.
    paths: Vec<StepSet>,
    joins: Vec<usize>,
}

impl<'n> Branch<'n> {
    fn new(net: &'n Net, openers: Vec<usize>) -> Branch<'n> {
        let firsts = &net.transitions[openers[0]].to;
        let forward = |start: StepSet, stop: StepSet, skip: &[usize]| forward(net, start, stop, skip);
        let none = StepSet::default();
        let following: Vec<StepSet> =
            firsts.iter().map(|&step| forward(StepSet::of(&[step]), none, &openers)).collect();
        let joins: Vec<usize> = (0..net.transitions.len())
            .filter(|&at| {
                let from = StepSet::of(&net.transitions[at].from);
                from.len() > 1 && following.iter().filter(|path| path.meets(from)).count() > 1
            })
            .collect();
        let ends = joins.iter().fold(none, |all, &join| all.with(StepSet::of(&net.transitions[join].from)));
        let toward: Vec<StepSet> =
            following.iter().map(|&path| backward(net, ends.common(path), &openers).common(path)).collect();
        let inner = toward.iter().fold(none, |all, &path| all.with(path));
        let main = forward(StepSet::of(&net.initial).without(inner), none, &openers);
        let after = joins
            .iter()
            .filter(|join| !openers.contains(join))
            .fold(none, |all, &join| all.with(forward(StepSet::of(&net.transitions[join].to), main, &openers)));
        let outside = main.with(after);
        let skip: Vec<usize> = joins.iter().chain(&openers).copied().collect();
        let paths = firsts.iter().map(|&step| forward(StepSet::of(&[step]), outside, &skip).without(outside)).collect();
        Branch { net, openers, following, toward, outside, paths, joins }
    }

    /// The first step of each path.
    fn firsts(&self) -> &[usize] {
        &self.net.transitions[self.openers[0]].to
    }

    /// Notes the mistakes of the branch, and which of its steps are active together.
    fn judge(&self, found: &mut Branches) {
        let strays = self.strays();
        let good = strays.is_empty() && self.paths_are_apart() && self.joins_are_whole() && self.entries_are_own();
        found.strays.extend(strays);
        // Two openers may switch one after the other.
        if !good || self.openers.len() > 1 {
            found.loose.push(self.openers[0]);
        }
        for (at, path) in self.paths.iter().enumerate() {
            let others = self.paths.iter().enumerate().filter(|&(other, _)| other != at);
            let others = others.fold(StepSet::default(), |all, (_, &path)| all.with(path)).without(*path);
            path.iter().for_each(|step| found.together[step] = found.together[step].with(others));
        }
    }

    fn paths_are_apart(&self) -> bool {
        let mut seen = StepSet::default();
        self.paths.iter().all(|&path| {
            let apart = !path.is_empty() && !path.meets(seen);
            seen = seen.with(path);
            apart
        })
    }

    fn joins_are_whole(&self) -> bool {
        self.joins.iter().all(|&join| {
            let from = StepSet::of(&self.net.transitions[join].from);
            from.len() as usize == self.paths.len() && self.paths.iter().all(|path| path.common(from).len() == 1)
        })
    }

    /// No transition but the openers goes into a path from elsewhere.
    fn entries_are_own(&self) -> bool {
        self.paths.iter().all(|&path| {
            let mut entering = path.iter().flat_map(|step| &self.net.entering[step]);
            entering.all(|at| self.openers.contains(at) || StepSet::of(&self.net.transitions[*at].from).within(path))
        })
    }

    /// Transitions that leave a path other than through the join, or enter it other than through the opener.
    fn strays(&self) -> Vec<Stray> {
        let mut strays = self.jumps_to_first();
        // Their paths are outside, too: what is found in them follows from the jump.
        let firsts = self.firsts().iter();
        let jumped: Vec<bool> = firsts.map(|&first| strays.iter().any(|stray| stray.step == first)).collect();
        for (at, arcs) in self.net.transitions.iter().enumerate() {
            let from = StepSet::of(&arcs.from);
            let beside = !self.openers.contains(&at) && !self.joins.contains(&at);
            // Once paths have met, all that comes after follows from that.
            let mut of = (0..self.paths.len()).filter(|&path| from.within(self.path_of(path)));
            let (Some(path), None) = (of.next(), of.next()) else { continue };
            let follows = |step: usize| jumped[path] && self.toward[path].has(step);
            for &step in arcs.to.iter().filter(|&&step| beside && !follows(step)) {
                if self.outside.has(step) {
                    strays.push(self.stray(at, step, path));
                } else if arcs.jump && self.is_of_another(step, path) {
                    strays.push(Stray { transition: at, step, opener: self.openers[0], inward: false });
                }
            }
        }
        strays.sort_by_key(|stray| (stray.transition, stray.step));
        strays.dedup_by_key(|stray| stray.transition);
        strays
    }

    /// Jumps from elsewhere to the first step of a path that leads to the join alone, which then waits for the other paths.
    fn jumps_to_first(&self) -> Vec<Stray> {
        let inner = self.following.iter().fold(StepSet::default(), |all, &path| all.with(path));
        let mut strays = Vec::new();
        for (path, &first) in self.firsts().iter().enumerate() {
            if self.net.initial.contains(&first) || !self.following[path].within(self.toward[path]) {
                continue;
            }
            let jumps = self.net.entering[first].iter().copied().filter(|&at| {
                let arcs = &self.net.transitions[at];
                arcs.jump && arcs.to.len() == 1 && !StepSet::of(&arcs.from).meets(inner)
            });
            let opener = self.openers[0];
            strays.extend(jumps.map(|transition| Stray { transition, step: first, opener, inward: true }));
        }
        strays
    }

    /// Steps of a path; its first step even if it is entered from elsewhere.
    fn path_of(&self, path: usize) -> StepSet {
        let first = self.firsts()[path];
        self.paths[path].with(StepSet::of(&[first]))
    }

    /// A jump from one path goes into another.
    fn is_of_another(&self, step: usize, path: usize) -> bool {
        (0..self.paths.len()).any(|other| other != path && self.toward[other].has(step))
    }

    /// A way between a path and the outside. If a step inside the path is entered from outside, that is the mistake.
    fn stray(&self, transition: usize, step: usize, path: usize) -> Stray {
        let is_outer = |&&at: &&usize| {
            let from = StepSet::of(&self.net.transitions[at].from);
            !self.openers.contains(&at) && at != transition && !from.within(self.paths[path])
        };
        let inner = self.toward[path].has(step) && self.following[path].has(step);
        let outer = self.net.entering[step].iter().filter(|_| inner && !self.net.transitions[transition].jump);
        match outer.filter(is_outer).copied().next() {
            Some(outer) => Stray { transition: outer, step, opener: self.openers[0], inward: true },
            None => Stray { transition, step, opener: self.openers[0], inward: false },
        }
    }
}

/// Steps that may come after `start`, up to those of `stop`, which are included. A transition passes when all steps before it are there.
fn forward(net: &Net, start: StepSet, stop: StepSet, skip: &[usize]) -> StepSet {
    let mut found = start;
    let mut open: Vec<usize> = start.iter().collect();
    while let Some(step) = open.pop() {
        for &at in &net.leaving[step] {
            let arcs = &net.transitions[at];
            if skip.contains(&at) || !arcs.from.iter().all(|&step| found.has(step)) {
                continue;
            }
            for &next in &arcs.to {
                if !found.has(next) {
                    found.insert(next);
                    if !stop.has(next) {
                        open.push(next);
                    }
                }
            }
        }
    }
    found
}

/// Steps on the way to those of `ends`, not through the transitions `skip`.
fn backward(net: &Net, ends: StepSet, skip: &[usize]) -> StepSet {
    let mut found = ends;
    let mut open: Vec<usize> = ends.iter().collect();
    while let Some(step) = open.pop() {
        for &at in net.entering[step].iter().filter(|at| !skip.contains(at)) {
            for &before in &net.transitions[at].from {
                if !found.has(before) {
                    found.insert(before);
                    open.push(before);
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::net::Arcs;
    use super::*;

    type Way<'a> = (&'a [usize], &'a [usize]);

    fn net(steps: usize, initial: &[usize], transitions: &[Way]) -> Net {
        let arcs = |&(from, to): &Way| Arcs { from: from.to_vec(), to: to.to_vec(), jump: false };
        Net::of(steps, initial.to_vec(), transitions.iter().map(arcs).collect())
    }

    fn strays(steps: usize, initial: &[usize], transitions: &[Way]) -> Vec<(usize, usize, bool)> {
        let strays = branches(&net(steps, initial, transitions)).strays;
        strays.iter().map(|stray| (stray.transition, stray.step, stray.inward)).collect()
    }

    /// Two doses, then mixing. Source: GRAPH reference H.2.
    const DOSES: &[Way] = &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[4]), (&[3, 4], &[5]), (&[5], &[0])];

    #[test]
    fn a_branch_with_its_join_is_proven() {
        let found = branches(&net(6, &[0], DOSES));
        assert!(found.proven() && found.strays.is_empty());
        assert!(found.together[1].has(2) && found.together[3].has(2) && !found.together[1].has(3));
        assert!(found.together[0].is_empty() && found.together[5].is_empty());
    }

    #[test]
    fn branches_inside_of_paths_are_proven() {
        let nested: &[Way] =
            &[(&[0], &[1, 2]), (&[1], &[3, 4]), (&[3, 4], &[5]), (&[5], &[6]), (&[5], &[1]), (&[6, 2], &[0])];
        let found = branches(&net(7, &[0], nested));
        assert!(found.proven(), "{found:?}");
        assert!(found.together[3].has(4) && found.together[3].has(2) && !found.together[3].has(5));
    }

    #[test]
    fn many_long_paths_are_proven_without_a_search() {
        let (paths, length) = (8, 30);
        let begin = |path: usize| 1 + path * length;
        let mut transitions = vec![Arcs { from: vec![0], to: (0..paths).map(begin).collect(), jump: false }];
        for step in (0..paths).flat_map(|path| begin(path)..begin(path) + length - 1) {
            transitions.push(Arcs { from: vec![step], to: vec![step + 1], jump: false });
        }
        let ends = (0..paths).map(|path| begin(path) + length - 1).collect();
        transitions.push(Arcs { from: ends, to: vec![0], jump: true });
        assert!(branches(&Net::of(1 + paths * length, vec![0], transitions)).proven());
    }

    #[test]
    fn initial_steps_in_all_paths_of_a_branch_are_searched() {
        let both: &[Way] = &[(&[0], &[1]), (&[2], &[3]), (&[1, 3], &[0, 2])];
        let found = branches(&net(4, &[0, 2], both));
        assert!(found.strays.is_empty() && !found.proven());
    }

    #[test]
    fn ways_out_of_a_path() {
        let out: &[Way] = &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[4]), (&[3, 4], &[5]), (&[5], &[0]), (&[1], &[0])];
        assert_eq!(strays(6, &[0], out), [(5, 0, false)]);
        let beyond: &[Way] =
            &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[4]), (&[3, 4], &[5]), (&[5], &[0]), (&[1], &[5])];
        assert_eq!(strays(6, &[0], beyond), [(5, 5, false)]);
    }

    #[test]
    fn ways_into_a_path() {
        let before: &[Way] =
            &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[4]), (&[3, 4], &[5]), (&[5], &[0]), (&[0], &[3])];
        assert_eq!(strays(6, &[0], before), [(5, 3, true)]);
        let after: &[Way] = &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[4]), (&[3, 4], &[5]), (&[5], &[0]), (&[5], &[3])];
        assert_eq!(strays(6, &[0], after), [(5, 3, true)]);
    }

    #[test]
    fn jumps_to_the_first_step_of_a_path() {
        let jumps = |ways: &[Way]| {
            let mut net = net(6, &[0], ways);
            net.transitions[4].jump = true;
            let strays = branches(&net).strays;
            strays.iter().map(|stray| (stray.transition, stray.step, stray.inward)).collect::<Vec<_>>()
        };
        let after: &[Way] = &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[4]), (&[3, 4], &[5]), (&[5], &[1])];
        assert_eq!(jumps(after), [(4, 1, true)]);
        let all: &[Way] = &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[4]), (&[3, 4], &[5]), (&[5], &[1, 2])];
        assert!(jumps(all).is_empty());
        let inside: &[Way] =
            &[(&[0], &[1, 2]), (&[1], &[3]), (&[2], &[4]), (&[3, 4], &[5]), (&[3], &[1]), (&[5], &[0])];
        assert!(jumps(inside).is_empty());
    }

    #[test]
    fn paths_that_end_by_themselves_are_no_mistake() {
        let ends: &[Way] = &[(&[0], &[1, 2]), (&[1], &[]), (&[2], &[])];
        let found = branches(&net(3, &[0], ends));
        assert!(found.proven(), "{found:?}");
    }
}
