//! Lines between steps, transitions and branches.

use std::collections::{BTreeMap, HashMap};

use plcc_syntax::chart::ast::Body;
use plcc_syntax::scl::ast::Name;

use crate::writer::Writer;
use crate::xml::node::Node;

/// Steps and transitions that lines connect, with these lines.
#[derive(Default)]
pub struct Sequence {
    /// Indices into the lists of the chart.
    pub steps: Vec<usize>,
    pub transitions: Vec<usize>,
    pub branches: Vec<Node>,
    pub connections: Vec<Node>,
}

/// An end of a line: its name, number, and arm of a branch.
#[derive(Clone, Copy)]
enum End {
    Step(u32),
    Transition(u32),
    /// With the number of the arm.
    Branch(u32, usize),
    Nothing,
}

/// The sequencers of a chart; `None`: a transition has no step, or leads to a step that is not there, which was reported.
pub fn sequences(chart: &Body, writer: &mut Writer) -> Option<Vec<Sequence>> {
    let places: HashMap<String, usize> =
        chart.steps.iter().enumerate().rev().map(|(at, step)| (step.name.text.to_lowercase(), at)).collect();
    let mut ends = Vec::new();
    for transition in &chart.transitions {
        let place = |name: &Name| places.get(&name.text.to_lowercase()).copied();
        let from: Option<Vec<usize>> = transition.from.iter().map(place).collect();
        let to: Option<Vec<usize>> = transition.to.iter().map(place).collect();
        match (from, to) {
            (Some(from), Some(to)) if !from.is_empty() => ends.push((from, to)),
            _ => {
                let title =
                    format!("transition `{}` has no step, or one that is not in the chart", transition.name.text);
                writer.refuse(transition.span, title, "repair the source first");
                return None;
            }
        }
    }
    let groups = groups(chart.steps.len(), &ends);
    let mut sequences: Vec<Sequence> = Vec::new();
    let mut place_of = HashMap::new();
    for (step, group) in groups.iter().enumerate() {
        let at = *place_of.entry(group).or_insert_with(|| {
            sequences.push(Sequence::default());
            sequences.len() - 1
        });
        sequences[at].steps.push(step);
    }
    for (transition, (from, _)) in ends.iter().enumerate() {
        sequences[place_of[&groups[from[0]]]].transitions.push(transition);
    }
    for sequence in &mut sequences {
        Drawer { chart, ends: &ends, sequence }.draw();
    }
    Some(sequences)
}

/// A number for each step; steps that transitions connect have the same.
fn groups(count: usize, ends: &[(Vec<usize>, Vec<usize>)]) -> Vec<usize> {
    fn root(groups: &mut [usize], mut step: usize) -> usize {
        while groups[step] != step {
            groups[step] = groups[groups[step]];
            step = groups[step];
        }
        step
    }
    let mut groups: Vec<usize> = (0..count).collect();
    for (from, to) in ends {
        for &step in from.iter().chain(to) {
            let (one, other) = (root(&mut groups, from[0]), root(&mut groups, step));
            groups[one.max(other)] = one.min(other);
        }
    }
    (0..count).map(|step| root(&mut groups, step)).collect()
}

struct Drawer<'a> {
    chart: &'a Body,
    ends: &'a [(Vec<usize>, Vec<usize>)],
    sequence: &'a mut Sequence,
}

/// Steps that transitions leave or enter together, with these transitions.
struct Bundle {
    steps: Vec<usize>,
    transitions: Vec<usize>,
}

/// Adds a transition to the bundle of its steps.
fn add(bundles: &mut Vec<Bundle>, places: &mut HashMap<Vec<usize>, usize>, steps: &[usize], transition: usize) {
    let at = *places.entry(steps.to_vec()).or_insert_with(|| {
        bundles.push(Bundle { steps: steps.to_vec(), transitions: Vec::new() });
        bundles.len() - 1
    });
    bundles[at].transitions.push(transition);
}

/// The bundles that each step is in.
fn by_step(bundles: &[Bundle]) -> BTreeMap<usize, Vec<usize>> {
    let mut found: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (at, bundle) in bundles.iter().enumerate() {
        bundle.steps.iter().for_each(|&step| found.entry(step).or_default().push(at));
    }
    found
}

impl Drawer<'_> {
    fn draw(&mut self) {
        let (mut left, mut entered) = (Vec::new(), Vec::new());
        let (mut left_places, mut entered_places) = (HashMap::new(), HashMap::new());
        let mut transitions = self.sequence.transitions.clone();
        // In the order in which they count.
        transitions.sort_by_key(|&at| (self.chart.transitions[at].path.clone(), self.chart.transitions[at].number));
        for at in transitions {
            let (from, to) = &self.ends[at];
            add(&mut left, &mut left_places, from, at);
            if to.is_empty() {
                self.line(self.transition(at), End::Nothing, false);
            } else if self.chart.transitions[at].jump {
                let ends: Vec<End> = to.iter().map(|&step| self.step(step)).collect();
                self.enter(self.transition(at), &ends, true);
            } else {
                add(&mut entered, &mut entered_places, to, at);
            }
        }
        self.leave_all(&left);
        self.enter_all(&entered);
    }

    fn step(&self, at: usize) -> End {
        End::Step(self.chart.steps[at].number)
    }

    fn transition(&self, at: usize) -> End {
        End::Transition(self.chart.transitions[at].number)
    }

    /// The lines from steps to transitions.
    fn leave_all(&mut self, bundles: &[Bundle]) {
        let mut starts = HashMap::new();
        for (step, of_step) in by_step(bundles) {
            let branch = (of_step.len() > 1).then(|| {
                let branch = self.branch("AltBegin", of_step.len());
                self.line(self.step(step), End::Branch(branch, 0), false);
                branch
            });
            for (arm, &bundle) in of_step.iter().enumerate() {
                starts.insert((step, bundle), branch.map_or(self.step(step), |branch| End::Branch(branch, arm)));
            }
        }
        for (at, bundle) in bundles.iter().enumerate() {
            let start = match bundle.steps.as_slice() {
                [step] => starts[&(*step, at)],
                several => {
                    let branch = self.branch("SimEnd", several.len());
                    for (arm, &step) in several.iter().enumerate() {
                        self.line(starts[&(step, at)], End::Branch(branch, arm), false);
                    }
                    End::Branch(branch, 0)
                }
            };
            self.divide(start, &bundle.transitions, 0);
        }
    }

    /// Alternative branches to transitions, those of the first `depth` being drawn: arms are numbered by the paths.
    fn divide(&mut self, start: End, transitions: &[usize], depth: usize) {
        if let [one] = transitions {
            return self.line(start, self.transition(*one), false);
        }
        let arm = |at: usize, depth: usize| self.chart.transitions[at].path.get(depth);
        let is_one = |a: usize, b: usize, depth: usize| arm(a, depth).is_some() && arm(a, depth) == arm(b, depth);
        // Branches with one arm are not drawn.
        let mut depth = depth;
        while transitions.windows(2).all(|pair| is_one(pair[0], pair[1], depth)) {
            depth += 1;
        }
        let arms: Vec<&[usize]> = transitions.chunk_by(|a, b| is_one(*a, *b, depth)).collect();
        let branch = self.branch("AltBegin", arms.len());
        self.line(start, End::Branch(branch, 0), false);
        for (number, arm) in arms.into_iter().enumerate() {
            self.divide(End::Branch(branch, number), arm, depth + 1);
        }
    }

    /// The lines from transitions to steps without jumps.
    fn enter_all(&mut self, bundles: &[Bundle]) {
        let mut arrivals = HashMap::new();
        for (step, of_step) in by_step(bundles) {
            let branch = (of_step.len() > 1).then(|| {
                let branch = self.branch("AltEnd", of_step.len());
                self.line(End::Branch(branch, 0), self.step(step), false);
                branch
            });
            for (arm, &bundle) in of_step.iter().enumerate() {
                arrivals.insert((step, bundle), branch.map_or(self.step(step), |branch| End::Branch(branch, arm)));
            }
        }
        for (at, bundle) in bundles.iter().enumerate() {
            let start = match bundle.transitions.as_slice() {
                [one] => self.transition(*one),
                several => {
                    let branch = self.branch("AltEnd", several.len());
                    for (arm, &one) in several.iter().enumerate() {
                        self.line(self.transition(one), End::Branch(branch, arm), false);
                    }
                    End::Branch(branch, 0)
                }
            };
            let ends: Vec<End> = bundle.steps.iter().map(|&step| arrivals[&(step, at)]).collect();
            self.enter(start, &ends, false);
        }
    }

    /// A line to a step, or a simultaneous branch to several.
    fn enter(&mut self, start: End, ends: &[End], jump: bool) {
        if let [one] = ends {
            return self.line(start, *one, jump);
        }
        let branch = self.branch("SimBegin", ends.len());
        self.line(start, End::Branch(branch, 0), false);
        for (arm, &end) in ends.iter().enumerate() {
            self.line(End::Branch(branch, arm), end, jump);
        }
    }

    /// The number of a new branch.
    fn branch(&mut self, kind: &str, arms: usize) -> u32 {
        let number = self.sequence.branches.len() as u32 + 1;
        let node = Node::new("Branch").with("Number", number).with("Type", kind).with("Cardinality", arms);
        self.sequence.branches.push(node);
        number
    }

    fn line(&mut self, from: End, to: End, jump: bool) {
        let connection = Node::new("Connection")
            .child(Node::new("NodeFrom").child(reference(from, "Out")))
            .child(Node::new("NodeTo").child(reference(to, "In")))
            .child(Node::of("LinkType", if jump { "Jump" } else { "Direct" }));
        self.sequence.connections.push(connection);
    }
}

fn reference(end: End, arm: &'static str) -> Node {
    match end {
        End::Step(number) => Node::new("StepRef").with("Number", number),
        End::Transition(number) => Node::new("TransitionRef").with("Number", number),
        End::Branch(number, place) => Node::new("BranchRef").with("Number", number).with(arm, place),
        End::Nothing => Node::new("EndConnection"),
    }
}
