//! Which transitions leave a step, what they lead to, and where it all is: rows and columns of a drawing.
//!
//! A chart becomes trees: the first transition that reaches a step draws it below itself. A transition that reaches a step in another
//! place joins its path with the others, or is a jump if the step is above it, or if the step begins a simultaneous path.

use std::collections::{HashMap, VecDeque};

use plcc_syntax::chart::ast::Body as Chart;
use plcc_syntax::scl::ast::Name;

use crate::writer::Writer;

/// A place after a step: a transition, or transitions that leave several steps together.
pub struct Arm {
    /// Those with the same steps, in the order in which they count.
    pub transitions: Vec<usize>,
    /// The first arm that has these transitions draws them, if they leave several steps.
    pub join: Option<usize>,
    pub is_owner: bool,
    pub column: usize,
}

/// Transitions that leave several steps together.
pub struct Join {
    /// Steps, in the order of the source.
    pub from: Vec<usize>,
    pub transitions: Vec<usize>,
    /// The step whose arm draws it.
    pub owner: usize,
    /// That step has other arms.
    pub is_in_branch: bool,
}

/// How a transition enters a step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Entry {
    Line,
    Jump,
}

/// Steps and transitions are identified by their places in the chart.
pub struct Plan {
    /// The steps that each transition leaves and enters.
    pub from: Vec<Vec<usize>>,
    pub to: Vec<Vec<usize>>,
    /// Transitions in the order in which they count.
    pub order: Vec<usize>,
    /// By step.
    pub arms: Vec<Vec<Arm>>,
    pub joins: Vec<Join>,
    /// By transition, for each step that it enters.
    pub entries: Vec<Vec<Entry>>,
    /// Of steps.
    pub rows: Vec<usize>,
    pub columns: Vec<usize>,
    /// Of transitions.
    pub places: Vec<usize>,
    /// By transition: those of the steps, or of the jumps to them.
    pub targets: Vec<Vec<usize>>,
}

/// The plan of a chart; `None`: what SFC cannot draw was reported.
pub fn plan(chart: &Chart, writer: &mut Writer) -> Option<Plan> {
    let (from, to) = ends(chart, writer)?;
    let mut order: Vec<usize> = (0..chart.transitions.len()).collect();
    order.sort_by_key(|at| (&chart.transitions[*at].path, chart.transitions[*at].number));
    let (arms, joins) = leaving(chart, &from, &order, writer)?;
    let mut plan = Plan {
        from,
        to,
        order,
        arms,
        joins,
        entries: Vec::new(),
        rows: vec![0; chart.steps.len()],
        columns: vec![0; chart.steps.len()],
        places: vec![0; chart.transitions.len()],
        targets: vec![Vec::new(); chart.transitions.len()],
    };
    let tree = Tree::new(chart, &plan);
    plan.rows = tree.rows(chart, &plan);
    tree.columns(&mut plan);
    plan.entries = (0..chart.transitions.len()).map(|at| tree.entries(chart, &plan, at)).collect();
    Some(plan)
}

type Ends = Vec<Vec<usize>>;

/// The steps of each transition.
fn ends(chart: &Chart, writer: &mut Writer) -> Option<(Ends, Ends)> {
    let places: HashMap<String, usize> =
        chart.steps.iter().enumerate().rev().map(|(at, step)| (step.name.text.to_lowercase(), at)).collect();
    let (mut from, mut to) = (Vec::new(), Vec::new());
    for transition in &chart.transitions {
        let steps = |names: &[Name]| -> Option<Vec<usize>> {
            let mut found = Vec::new();
            for name in names {
                let at = *places.get(&name.text.to_lowercase())?;
                if !found.contains(&at) {
                    found.push(at);
                }
            }
            Some(found)
        };
        match (steps(&transition.from), steps(&transition.to)) {
            (Some(own), Some(next)) if !own.is_empty() => {
                from.push(own);
                to.push(next);
            }
            _ => {
                let title =
                    format!("transition `{}` has no step, or one that is not in the chart", transition.name.text);
                writer.refuse(transition.span, title, "repair the source first");
                return None;
            }
        }
    }
    Some((from, to))
}

/// What leaves each step.
fn leaving(
    chart: &Chart,
    from: &[Vec<usize>],
    order: &[usize],
    writer: &mut Writer,
) -> Option<(Vec<Vec<Arm>>, Vec<Join>)> {
    let mut arms: Vec<Vec<Arm>> = chart.steps.iter().map(|_| Vec::new()).collect();
    let mut joins: Vec<Join> = Vec::new();
    let mut known: HashMap<Vec<usize>, usize> = HashMap::new();
    for &at in order {
        let steps = &from[at];
        if let [step] = steps.as_slice() {
            arms[*step].push(Arm { transitions: vec![at], join: None, is_owner: true, column: 0 });
            continue;
        }
        let mut key = steps.clone();
        key.sort_unstable();
        let next = joins.len();
        let join = *known.entry(key).or_insert(next);
        if join == next {
            joins.push(Join { from: steps.clone(), transitions: Vec::new(), owner: steps[0], is_in_branch: false });
        }
        joins[join].transitions.push(at);
        for step in steps {
            let list = &mut arms[*step];
            match list.last_mut() {
                Some(last) if last.join == Some(join) => last.transitions.push(at),
                // Another transition counts between two of them.
                _ if joins[join].transitions.len() > 1 => return order_is_lost(chart, at, writer),
                _ => list.push(Arm { transitions: vec![at], join: Some(join), is_owner: false, column: 0 }),
            }
        }
    }
    for (at, join) in joins.iter_mut().enumerate() {
        let mut branched = join.from.iter().copied().filter(|step| arms[*step].len() > 1);
        if let Some(owner) = branched.next() {
            (join.owner, join.is_in_branch) = (owner, true);
        }
        if branched.next().is_some() {
            return order_is_lost(chart, join.transitions[0], writer);
        }
        for arm in arms[join.owner].iter_mut().filter(|arm| arm.join == Some(at)) {
            arm.is_owner = true;
        }
    }
    Some((arms, joins))
}

fn order_is_lost<T>(chart: &Chart, at: usize, writer: &mut Writer) -> Option<T> {
    let transition = &chart.transitions[at];
    let title = format!(
        "transition `{}` leaves several steps that other transitions leave too, and SFC has no order for these",
        transition.name.text
    );
    writer.refuse(transition.span, title, "let each of its steps have a step of its own that waits for the others");
    None
}

/// The steps as trees.
struct Tree {
    /// Steps, each after the one that it is below.
    order: Vec<usize>,
    /// By step: the transition that draws it; `None`: nothing is above it.
    above: Vec<Option<usize>>,
    /// By step: its place in `order`, and the first place after the steps below it.
    spans: Vec<(usize, usize)>,
    /// By transition: the step that draws it.
    owners: Vec<usize>,
}

impl Tree {
    fn new(chart: &Chart, plan: &Plan) -> Tree {
        let count = chart.steps.len();
        let next: Vec<Vec<(usize, usize)>> = plan
            .arms
            .iter()
            .map(|arms| {
                let transitions =
                    arms.iter().filter(|arm| arm.is_owner).flat_map(|arm| arm.transitions.iter().copied());
                let drawn = transitions.filter(|at| !chart.transitions[*at].jump);
                drawn.flat_map(|at| plan.to[at].iter().map(move |step| (at, *step))).collect()
            })
            .collect();
        let mut owners = vec![0; plan.to.len()];
        for (step, arms) in plan.arms.iter().enumerate() {
            let own = arms.iter().filter(|arm| arm.is_owner);
            own.flat_map(|arm| &arm.transitions).for_each(|at| owners[*at] = step);
        }
        let mut tree = Tree { order: Vec::new(), above: vec![None; count], spans: vec![(0, 0); count], owners };
        let mut seen = vec![false; count];
        let initial = (0..count).filter(|at| chart.steps[*at].initial);
        for first in initial.chain(0..count) {
            if std::mem::replace(&mut seen[first], true) {
                continue;
            }
            tree.begin(first);
            let mut open = vec![(first, 0_usize)];
            while let Some(&(step, at)) = open.last() {
                let Some(&(transition, target)) = next[step].get(at) else {
                    tree.spans[step].1 = tree.order.len();
                    open.pop();
                    continue;
                };
                if let Some(last) = open.last_mut() {
                    last.1 += 1;
                }
                if !std::mem::replace(&mut seen[target], true) {
                    tree.above[target] = Some(transition);
                    tree.begin(target);
                    open.push((target, 0));
                }
            }
        }
        tree
    }

    fn begin(&mut self, step: usize) {
        self.spans[step].0 = self.order.len();
        self.order.push(step);
    }

    /// Whether a step is another one, or below it.
    fn is_below(&self, step: usize, other: usize) -> bool {
        let (start, end) = self.spans[other];
        (start..end).contains(&self.spans[step].0)
    }

    /// Steps are below all steps that lead to them, except where a path leads back.
    fn rows(&self, chart: &Chart, plan: &Plan) -> Vec<usize> {
        let count = chart.steps.len();
        let mut next: Vec<Vec<usize>> = vec![Vec::new(); count];
        let mut waits = vec![0; count];
        for at in (0..chart.transitions.len()).filter(|at| !chart.transitions[*at].jump) {
            for &from in &plan.from[at] {
                for &to in plan.to[at].iter().filter(|to| !self.is_below(from, **to)) {
                    next[from].push(to);
                    waits[to] += 1;
                }
            }
        }
        let mut rows = vec![0; count];
        let mut is_done = vec![false; count];
        let mut free: VecDeque<usize> = (0..count).filter(|step| waits[*step] == 0).collect();
        while let Some(step) = free.pop_front() {
            is_done[step] = true;
            for &to in &next[step] {
                rows[to] = rows[to].max(rows[step] + 1);
                waits[to] -= 1;
                if waits[to] == 0 {
                    free.push_back(to);
                }
            }
        }
        // Steps of a circle that no tree shows.
        for &step in self.order.iter().filter(|step| !is_done[**step]) {
            if let Some(above) = self.above[step] {
                rows[step] = rows[step].max(rows[self.owners[above]] + 1);
            }
        }
        rows
    }

    /// Gives steps, arms and transitions their columns.
    fn columns(&self, plan: &mut Plan) {
        let mut wide: Vec<usize> = vec![1; plan.arms.len()];
        let mut wide_transitions: Vec<usize> = vec![1; plan.to.len()];
        for &step in self.order.iter().rev() {
            let mut width: usize = 0;
            for arm in &plan.arms[step] {
                if !arm.is_owner {
                    width += 1;
                    continue;
                }
                for &at in &arm.transitions {
                    let one = |to: &usize| if self.above[*to] == Some(at) { wide[*to] } else { 1 };
                    wide_transitions[at] = plan.to[at].iter().map(one).sum::<usize>().max(1);
                    width += wide_transitions[at];
                }
            }
            wide[step] = width.max(1);
        }
        let mut free: usize = 0;
        for &step in &self.order {
            if self.above[step].is_none() {
                plan.columns[step] = free;
                free += wide[step];
            }
            let mut column = plan.columns[step];
            for arm in &mut plan.arms[step] {
                arm.column = column;
                if !arm.is_owner {
                    column += 1;
                    continue;
                }
                for &at in &arm.transitions {
                    plan.places[at] = column;
                    let mut place = column;
                    for &to in &plan.to[at] {
                        plan.targets[at].push(place);
                        if self.above[to] == Some(at) {
                            plan.columns[to] = place;
                            place += wide[to];
                        } else {
                            place += 1;
                        }
                    }
                    column += wide_transitions[at];
                }
            }
        }
    }

    /// How a transition enters its steps.
    fn entries(&self, chart: &Chart, plan: &Plan, at: usize) -> Vec<Entry> {
        let row = plan.from[at].iter().map(|step| plan.rows[*step]).max().unwrap_or(0);
        let entry = |to: &usize| {
            let above = self.above[*to];
            // A path that begins with a simultaneous branch does not join others.
            let joins = || plan.to[at].len() == 1 && above.is_some_and(|above| plan.to[above].len() == 1);
            let is_line = !chart.transitions[at].jump && (above == Some(at) || plan.rows[*to] > row && joins());
            if is_line { Entry::Line } else { Entry::Jump }
        };
        plan.to[at].iter().map(entry).collect()
    }
}
