//! The objects of an SFC body with their places and lines, and how they are written.

use crate::node::Node;
use crate::plcopen::objects::text_width;

use super::plan::{Entry, Plan};

/// What the file has of a step besides its lines.
pub struct StepParts {
    pub name: String,
    pub initial: bool,
    /// `action` elements.
    pub actions: Vec<Node>,
    /// The longest text of an action.
    pub widest: i32,
    pub comment: Option<Node>,
}

/// What the file has of a transition besides its lines.
pub struct TransitionParts {
    pub condition: Node,
    pub comment: Option<Node>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Step,
    Transition,
    Jump,
    SelectionDivergence,
    SelectionConvergence,
    SimultaneousDivergence,
    SimultaneousConvergence,
    ActionBlock,
}

/// An object. Places are those of its upper left corner; lines end at the middle of its upper side and begin at its lower one.
struct Item {
    kind: Kind,
    x: i32,
    y: i32,
    width: i32,
    height: i32,
    /// The objects before it, each with the number of its output.
    inputs: Vec<Origin>,
    /// Where its outputs are, from its left side; a step has only one.
    outputs: Vec<i32>,
    attributes: Vec<(&'static str, String)>,
    /// After its lines.
    parts: Vec<Node>,
}

#[derive(Clone, Copy)]
struct Origin {
    item: usize,
    output: usize,
}

/// Height of steps; of a row of an action block.
const STEP: i32 = 40;
const ROW: i32 = 30;
/// From the lower side of a step or its actions to the objects after it.
const DIVERGENCE: i32 = 25;
const TRANSITION: i32 = 45;
const SIMULTANEOUS: i32 = 85;
const CONVERGENCE: i32 = 110;
const NEXT: i32 = 140;
/// Width of a transition, and of a branch beyond its lines.
const BAR: i32 = 20;
const GAP: i32 = 20;
const MARGIN: i32 = 40;
/// No place is beyond it.
const PLACE_MAX: i32 = 1_000_000_000;

/// The body of a chart.
pub fn body(plan: &Plan, steps: Vec<StepParts>, transitions: Vec<TransitionParts>) -> Node {
    let names = steps.iter().map(|step| text_width(&step.name)).max().unwrap_or(0);
    let step_width = names.saturating_add(20).clamp(80, 600);
    let action_width = steps.iter().map(|step| step.widest).max().unwrap_or(0).min(1200);
    let tallest = steps.iter().map(|step| i32::try_from(step.actions.len()).unwrap_or(0)).max().unwrap_or(0);
    let actions = if action_width > 0 { GAP + action_width } else { 0 };
    let grid = Grid {
        step_width,
        action_width,
        column: step_width + actions + 80,
        below: STEP.max(tallest.min(10_000) * ROW),
    };
    let mut drawer = Drawer { plan, grid, items: Vec::new(), starts: vec![None; transitions.len()] };
    drawer.steps(steps);
    drawer.leave();
    drawer.transitions(transitions);
    drawer.enter();
    drawer.write()
}

struct Grid {
    step_width: i32,
    action_width: i32,
    /// From column to column.
    column: i32,
    /// Height of a step with its actions.
    below: i32,
}

impl Grid {
    /// The middle of the steps in a column.
    fn x(&self, column: usize) -> i32 {
        let column = i32::try_from(column).unwrap_or(i32::MAX);
        column.saturating_mul(self.column).saturating_add(MARGIN + self.step_width / 2).min(PLACE_MAX)
    }

    /// The upper side of the steps in a row.
    fn y(&self, row: usize) -> i32 {
        let row = i32::try_from(row).unwrap_or(i32::MAX);
        row.saturating_mul(self.below + NEXT).saturating_add(MARGIN).min(PLACE_MAX)
    }

    /// Something at a distance below the steps of a row.
    fn after(&self, row: usize, distance: i32) -> i32 {
        self.y(row).saturating_add(self.below + distance)
    }
}

struct Drawer<'p> {
    plan: &'p Plan,
    grid: Grid,
    items: Vec<Item>,
    /// By transition: what is before it.
    starts: Vec<Option<Origin>>,
}

impl Drawer<'_> {
    fn add(&mut self, kind: Kind, (x, y): (i32, i32), (width, height): (i32, i32)) -> usize {
        self.items.push(Item {
            kind,
            x,
            y,
            width,
            height,
            inputs: Vec::new(),
            outputs: Vec::new(),
            attributes: Vec::new(),
            parts: Vec::new(),
        });
        self.items.len() - 1
    }

    /// A branch from column to column, with outputs at these columns.
    fn branch(&mut self, kind: Kind, columns: &[usize], outputs: &[usize], y: i32) -> usize {
        let first = columns.iter().min().map_or(MARGIN, |column| self.grid.x(*column));
        let last = columns.iter().max().map_or(MARGIN, |column| self.grid.x(*column));
        let x = first - BAR / 2;
        let item = self.add(kind, (x, y), (last - first + BAR, 4));
        self.items[item].outputs = outputs.iter().map(|column| self.grid.x(*column) - x).collect();
        item
    }

    fn line(&mut self, from: Origin, to: usize) {
        self.items[to].inputs.push(from);
    }

    /// The row below which a transition is.
    fn row(&self, transition: usize) -> usize {
        self.plan.from[transition].iter().map(|step| self.plan.rows[*step]).max().unwrap_or(0)
    }

    /// The steps; their objects have the numbers that they have in the chart.
    fn steps(&mut self, steps: Vec<StepParts>) {
        let width = self.grid.step_width;
        let mut blocks = Vec::new();
        for (at, step) in steps.into_iter().enumerate() {
            let x = self.grid.x(self.plan.columns[at]) - width / 2;
            let y = self.grid.y(self.plan.rows[at]);
            let item = self.add(Kind::Step, (x, y), (width, STEP));
            let item = &mut self.items[item];
            item.attributes.push(("name", step.name));
            if step.initial {
                item.attributes.push(("initialStep", "true".to_string()));
            }
            item.outputs.push(width / 2);
            item.parts.extend(step.comment);
            if !step.actions.is_empty() {
                blocks.push((at, (x + width + GAP, y), step.actions));
            }
        }
        for (at, place, actions) in blocks {
            let height = ROW.saturating_mul(i32::try_from(actions.len()).unwrap_or(1));
            let item = self.add(Kind::ActionBlock, place, (self.grid.action_width, height));
            self.items[item].parts = actions;
            self.line(Origin { item: at, output: 0 }, item);
        }
    }

    /// What is between steps and transitions.
    fn leave(&mut self) {
        let plan = self.plan;
        let joins: Vec<usize> = plan
            .joins
            .iter()
            .map(|join| {
                let row = join.transitions.first().map_or(0, |at| self.row(*at));
                let columns: Vec<usize> = match join.is_in_branch {
                    // The order of arms is that of their places.
                    true => join.transitions.first().map(|at| plan.places[*at]).into_iter().collect(),
                    false => join.from.iter().map(|step| plan.columns[*step]).collect(),
                };
                let y = self.grid.after(row, DIVERGENCE - 10);
                let output = join.transitions.first().map_or(0, |at| plan.places[*at]);
                self.branch(Kind::SimultaneousConvergence, &columns, &[output], y)
            })
            .collect();
        for (step, arms) in plan.arms.iter().enumerate() {
            let columns: Vec<usize> = arms.iter().map(|arm| arm.column).collect();
            let branch = (arms.len() > 1).then(|| {
                let y = self.grid.after(plan.rows[step], DIVERGENCE - 20);
                let branch = self.branch(Kind::SelectionDivergence, &columns, &columns, y);
                self.line(Origin { item: step, output: 0 }, branch);
                branch
            });
            for (output, arm) in arms.iter().enumerate() {
                let start = branch.map_or(Origin { item: step, output: 0 }, |item| Origin { item, output });
                match arm.join {
                    Some(join) => self.line(start, joins[join]),
                    None => arm.transitions.iter().for_each(|at| self.starts[*at] = Some(start)),
                }
            }
        }
        for (join, &item) in plan.joins.iter().zip(&joins) {
            let end = Origin { item, output: 0 };
            if let [at] = join.transitions.as_slice() {
                self.starts[*at] = Some(end);
                continue;
            }
            let columns: Vec<usize> = join.transitions.iter().map(|at| plan.places[*at]).collect();
            let row = join.transitions.first().map_or(0, |at| self.row(*at));
            let y = self.grid.after(row, DIVERGENCE + 5);
            let branch = self.branch(Kind::SelectionDivergence, &columns, &columns, y);
            self.line(end, branch);
            for (output, at) in join.transitions.iter().enumerate() {
                self.starts[*at] = Some(Origin { item: branch, output });
            }
        }
    }

    /// The transitions, in the order in which they count.
    fn transitions(&mut self, parts: Vec<TransitionParts>) {
        let plan = self.plan;
        let mut parts: Vec<Option<TransitionParts>> = parts.into_iter().map(Some).collect();
        for &at in &plan.order {
            let x = self.grid.x(plan.places[at]) - BAR / 2;
            let y = self.grid.after(self.row(at), TRANSITION);
            let item = self.add(Kind::Transition, (x, y), (BAR, 4));
            let start = self.starts[at].replace(Origin { item, output: 0 });
            let item = &mut self.items[item];
            item.inputs.extend(start);
            item.outputs.push(BAR / 2);
            if let Some(part) = parts[at].take() {
                item.parts.push(part.condition);
                item.parts.extend(part.comment);
            }
        }
    }

    /// What is between transitions and steps.
    fn enter(&mut self) {
        let plan = self.plan;
        let mut arrivals: Vec<Vec<Origin>> = plan.rows.iter().map(|_| Vec::new()).collect();
        for &at in &plan.order {
            let Some(end) = self.starts[at] else { continue };
            let row = self.row(at);
            let to = &plan.to[at];
            if let ([step], [entry]) = (to.as_slice(), plan.entries[at].as_slice()) {
                match entry {
                    Entry::Line => arrivals[*step].push(end),
                    Entry::Jump => self.jump(end, *step, plan.places[at], row),
                }
                continue;
            }
            if to.is_empty() {
                continue;
            }
            let columns = &plan.targets[at];
            let y = self.grid.after(row, SIMULTANEOUS);
            let branch = self.branch(Kind::SimultaneousDivergence, columns, columns, y);
            self.line(end, branch);
            for (output, (step, entry)) in to.iter().zip(&plan.entries[at]).enumerate() {
                let start = Origin { item: branch, output };
                match entry {
                    Entry::Line => arrivals[*step].push(start),
                    Entry::Jump => self.jump(start, *step, columns[output], row),
                }
            }
        }
        for (step, lines) in arrivals.into_iter().enumerate() {
            if let [_, _, ..] = lines.as_slice() {
                let column = plan.columns[step];
                let x = lines.iter().map(|line| self.output(*line).0);
                let (first, last) =
                    x.fold((self.grid.x(column), self.grid.x(column)), |(low, high), x| (low.min(x), high.max(x)));
                let y = self.grid.y(plan.rows[step]) - (NEXT - CONVERGENCE);
                let place = (first - BAR / 2, y);
                let item = self.add(Kind::SelectionConvergence, place, (last - first + BAR, 4));
                self.items[item].outputs.push(self.grid.x(column) - place.0);
                self.items[item].inputs = lines;
                self.line(Origin { item, output: 0 }, step);
            } else {
                self.items[step].inputs.extend(lines);
            }
        }
    }

    fn jump(&mut self, from: Origin, step: usize, column: usize, row: usize) {
        let name = self.items[step].attributes.first().map(|(_, name)| name.clone()).unwrap_or_default();
        let width = text_width(&name).saturating_add(10).min(self.grid.step_width);
        let x = self.grid.x(column) - width / 2;
        let y = self.grid.after(row, SIMULTANEOUS + 10);
        let item = self.add(Kind::Jump, (x, y), (width, 20));
        self.items[item].attributes.push(("targetName", name));
        self.line(from, item);
    }

    /// Where a line begins.
    fn output(&self, origin: Origin) -> (i32, i32) {
        let item = &self.items[origin.item];
        (item.x + item.outputs.get(origin.output).copied().unwrap_or(item.width / 2), item.y + item.height)
    }

    fn write(&self) -> Node {
        let mut number = self.items.len();
        let mut body = Node::new("SFC");
        let mut has_actions = vec![false; self.items.len()];
        for item in self.items.iter().filter(|item| item.kind == Kind::ActionBlock) {
            item.inputs.iter().for_each(|origin| has_actions[origin.item] = true);
        }
        let mut followed = vec![false; self.items.len()];
        for item in self.items.iter().filter(|item| item.kind != Kind::ActionBlock) {
            item.inputs.iter().for_each(|origin| followed[origin.item] = true);
        }
        for (at, item) in self.items.iter().enumerate() {
            let mut node = Node::new(item.kind.name())
                .with("localId", at + 1)
                .with("width", item.width)
                .with("height", item.height);
            node.attributes.extend(item.attributes.iter().cloned());
            node.push(place("position", (item.x, item.y)));
            match item.kind {
                // Each of its lines has a point of its own.
                Kind::SelectionConvergence | Kind::SimultaneousConvergence => {
                    for origin in &item.inputs {
                        let x = self.output(*origin).0 - item.x;
                        let x = if (0..=item.width).contains(&x) { x } else { item.width / 2 };
                        node.push(self.point(item, x, &[*origin]));
                    }
                }
                Kind::SelectionDivergence | Kind::SimultaneousDivergence => {
                    let x = item.inputs.first().map_or(0, |origin| self.output(*origin).0 - item.x);
                    let x = if (0..=item.width).contains(&x) { x } else { item.width / 2 };
                    node.push(self.point(item, x, &item.inputs));
                }
                Kind::Step | Kind::Transition | Kind::Jump | Kind::ActionBlock => {
                    if !item.inputs.is_empty() {
                        node.push(self.point(item, item.width / 2, &item.inputs));
                    }
                }
            }
            for (output, x) in item.outputs.iter().enumerate() {
                let point = Node::new("connectionPointOut");
                let point = match item.kind.output(output) {
                    Some(name) => point.with("formalParameter", name),
                    None => point,
                };
                if item.kind != Kind::Step || followed[at] {
                    node.push(point.child(place("relPosition", (*x, item.height))));
                }
            }
            if has_actions[at] {
                let point = Node::new("connectionPointOutAction").with("formalParameter", ACTION);
                node.push(point.child(place("relPosition", (item.width, item.height / 2))));
            }
            for (row, part) in item.parts.iter().enumerate() {
                let mut part = part.clone();
                if item.kind == Kind::ActionBlock {
                    number += 1;
                    part.attributes.insert(0, ("localId", number.to_string()));
                    let y = ROW.saturating_mul(i32::try_from(row).unwrap_or(0));
                    part.children.insert(0, place("relPosition", (0, y)));
                }
                node.push(part);
            }
            body.push(node);
        }
        body
    }

    /// The input of an object at a distance from its left side, with its lines: each from its end to its beginning.
    fn point(&self, item: &Item, x: i32, inputs: &[Origin]) -> Node {
        let is_action = item.kind == Kind::ActionBlock;
        let to = if is_action { (0, ROW / 2) } else { (x, 0) };
        let mut point = Node::new("connectionPointIn").child(place("relPosition", to));
        let (tx, ty) = (item.x + to.0, item.y + to.1);
        for origin in inputs {
            let source = &self.items[origin.item];
            let mut line = Node::new("connection").with("refLocalId", origin.item + 1);
            let name = if is_action { Some(ACTION.to_string()) } else { source.kind.output(origin.output) };
            if let Some(name) = name {
                line.attributes.push(("formalParameter", name));
            }
            let (sx, sy) = match is_action {
                true => (source.x + source.width, source.y + source.height / 2),
                false => self.output(*origin),
            };
            line.push(place("position", (tx, ty)));
            if sx != tx && !is_action {
                line.push(place("position", (tx, ty - 5)));
                line.push(place("position", (sx, ty - 5)));
            }
            line.push(place("position", (sx, sy)));
            point.push(line);
        }
        point
    }
}

const ACTION: &str = "action";

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Kind::Step => "step",
            Kind::Transition => "transition",
            Kind::Jump => "jumpStep",
            Kind::SelectionDivergence => "selectionDivergence",
            Kind::SelectionConvergence => "selectionConvergence",
            Kind::SimultaneousDivergence => "simultaneousDivergence",
            Kind::SimultaneousConvergence => "simultaneousConvergence",
            Kind::ActionBlock => "actionBlock",
        }
    }

    /// The name of an output, where the format has one.
    fn output(self, number: usize) -> Option<String> {
        match self {
            Kind::Step => Some("sfc".to_string()),
            Kind::SelectionDivergence | Kind::SimultaneousDivergence => Some(format!("out_{number}")),
            Kind::Transition
            | Kind::Jump
            | Kind::SelectionConvergence
            | Kind::SimultaneousConvergence
            | Kind::ActionBlock => None,
        }
    }
}

fn place(name: &'static str, (x, y): (i32, i32)) -> Node {
    Node::new(name).with("x", x).with("y", y)
}
