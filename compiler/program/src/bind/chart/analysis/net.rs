//! A chart as a net of steps and transitions, identified by their positions in the chart. Branches are not distinguished here.

use plcc_syntax::chart::ast::Body as Chart;

use crate::bind::chart::index::Index;

/// Steps that a [`StepSet`] can hold. GRAPH allows 250.
pub const SET_MAX: usize = 256;

/// The transitions of a chart, and those next to each step.
#[derive(Clone, Debug, Default)]
pub struct Net {
    pub transitions: Vec<Arcs>,
    /// By step: transitions that leave it.
    pub leaving: Vec<Vec<usize>>,
    /// By step: transitions that enter it.
    pub entering: Vec<Vec<usize>>,
    pub initial: Vec<usize>,
}

/// Steps before or after a transition, in ascending order, each once.
#[derive(Clone, Debug, Default)]
pub struct Arcs {
    pub from: Vec<usize>,
    pub to: Vec<usize>,
    pub jump: bool,
}

impl Net {
    /// The net of a chart. Names of missing steps are skipped.
    pub fn new(chart: &Chart, index: &Index) -> Net {
        let transitions = chart.transitions.iter().map(|transition| Arcs {
            from: steps(transition.from.iter().filter_map(|name| index.step(&name.text))),
            to: steps(transition.to.iter().filter_map(|name| index.step(&name.text))),
            jump: transition.jump,
        });
        let initial = (0..chart.steps.len()).filter(|&step| chart.steps[step].initial).collect();
        Net::of(chart.steps.len(), initial, transitions.collect())
    }

    pub fn of(steps: usize, initial: Vec<usize>, transitions: Vec<Arcs>) -> Net {
        let mut leaving = vec![Vec::new(); steps];
        let mut entering = vec![Vec::new(); steps];
        for (at, transition) in transitions.iter().enumerate() {
            transition.from.iter().for_each(|&step| leaving[step].push(at));
            transition.to.iter().for_each(|&step| entering[step].push(at));
        }
        Net { transitions, leaving, entering, initial }
    }

    pub fn steps(&self) -> usize {
        self.leaving.len()
    }

    /// No transition is next to the step.
    pub fn is_alone(&self, step: usize) -> bool {
        self.leaving[step].is_empty() && self.entering[step].is_empty()
    }

    /// The sequencer of each step, identified by its first step: steps that transitions connect.
    pub fn sequencers(&self) -> Vec<usize> {
        let mut sequencer = vec![usize::MAX; self.steps()];
        let mut passed = vec![false; self.transitions.len()];
        for first in 0..self.steps() {
            let mut open = vec![first];
            while let Some(step) = open.pop() {
                if sequencer[step] != usize::MAX {
                    continue;
                }
                sequencer[step] = first;
                for &transition in self.leaving[step].iter().chain(&self.entering[step]) {
                    if !std::mem::replace(&mut passed[transition], true) {
                        let arcs = &self.transitions[transition];
                        open.extend(arcs.from.iter().chain(&arcs.to));
                    }
                }
            }
        }
        sequencer
    }
}

/// Steps that are reached, and the transitions after them.
pub struct Reach {
    pub steps: Vec<bool>,
    passed: Vec<bool>,
}

impl Reach {
    /// Everything that is reached from `start`.
    pub fn new(net: &Net, start: impl IntoIterator<Item = usize>) -> Reach {
        let mut reach = Reach { steps: vec![false; net.steps()], passed: vec![false; net.transitions.len()] };
        reach.extend(net, start);
        reach
    }

    /// Adds everything that is reached from `start`.
    pub fn extend(&mut self, net: &Net, start: impl IntoIterator<Item = usize>) {
        let mut open: Vec<usize> = start.into_iter().collect();
        while let Some(step) = open.pop() {
            if std::mem::replace(&mut self.steps[step], true) {
                continue;
            }
            for &transition in &net.leaving[step] {
                if !std::mem::replace(&mut self.passed[transition], true) {
                    open.extend(&net.transitions[transition].to);
                }
            }
        }
    }
}

fn steps(list: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut list: Vec<usize> = list.collect();
    list.sort_unstable();
    list.dedup();
    list
}

/// A set of up to [`SET_MAX`] steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StepSet([u64; SET_MAX / 64]);

impl StepSet {
    pub fn of(steps: &[usize]) -> StepSet {
        let mut set = StepSet::default();
        steps.iter().for_each(|&step| set.insert(step));
        set
    }

    pub fn has(&self, step: usize) -> bool {
        self.0[step / 64] >> (step % 64) & 1 == 1
    }

    pub fn insert(&mut self, step: usize) {
        self.0[step / 64] |= 1 << (step % 64);
    }

    fn zip(self, other: StepSet, with: impl Fn(u64, u64) -> u64) -> StepSet {
        StepSet(std::array::from_fn(|word| with(self.0[word], other.0[word])))
    }

    pub fn with(self, other: StepSet) -> StepSet {
        self.zip(other, |a, b| a | b)
    }

    pub fn without(self, other: StepSet) -> StepSet {
        self.zip(other, |a, b| a & !b)
    }

    pub fn common(self, other: StepSet) -> StepSet {
        self.zip(other, |a, b| a & b)
    }

    pub fn is_empty(self) -> bool {
        self == StepSet::default()
    }

    pub fn meets(self, other: StepSet) -> bool {
        !self.common(other).is_empty()
    }

    /// All of `self` are in `other`.
    pub fn within(self, other: StepSet) -> bool {
        self.without(other).is_empty()
    }

    pub fn len(self) -> u32 {
        self.0.iter().map(|word| word.count_ones()).sum()
    }

    /// In ascending order.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        (0..SET_MAX / 64).flat_map(move |word| {
            let mut bits = self.0[word];
            std::iter::from_fn(move || {
                let bit = (bits != 0).then(|| bits.trailing_zeros() as usize)?;
                bits &= bits - 1;
                Some(word * 64 + bit)
            })
        })
    }
}
