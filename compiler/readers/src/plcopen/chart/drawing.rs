//! The drawing: steps, transitions, branches and jumps, and the lines between them.

use std::collections::{HashMap, HashSet};

use plcc_diag::{Code, Span};
use roxmltree::Node;

use super::Sfc;
use crate::plcopen::interface::elements;
use crate::plcopen::objects::{lines, position};
use plcc_syntax::chart::connect::{Branch, BranchKind, Drawing, Line, Node as End};
use plcc_syntax::distance;

/// The elements of a chart.
pub struct Plan<'a> {
    pub steps: Vec<Node<'a, 'a>>,
    pub transitions: Vec<Node<'a, 'a>>,
    /// Steps by their identifiers in the file.
    pub ids: HashMap<&'a str, usize>,
    pub drawing: Drawing,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Index in the list of its kind.
    Step(usize),
    Transition(usize),
    Branch(usize),
    Jump,
}

struct Item<'a> {
    kind: Kind,
    node: Node<'a, 'a>,
}

/// A line between two items.
struct Arm {
    from: usize,
    to: usize,
    /// Indices of the output of `from` and the input of `to`.
    output: u32,
    input: u32,
    /// The lesser comes first: priority, column, and index of the output in the file.
    rank: (u64, i64, usize),
    span: Span,
}

impl<'a> Sfc<'_, 'a, '_> {
    /// Finds the elements and lines of a chart.
    pub fn plan(&mut self, content: Node<'a, 'a>) -> Plan<'a> {
        let mut plan =
            Plan { steps: Vec::new(), transitions: Vec::new(), ids: HashMap::new(), drawing: Drawing::default() };
        let items = self.items(content, &mut plan);
        let arms = self.arms(&items);
        let heads = self.hidden_branches(&items, &arms, &mut plan);
        let steps: HashMap<String, usize> = plan.steps.iter().enumerate().rev().filter_map(named).collect();
        for arm in &arms {
            let from = match (heads.get(&arm.from), items[arm.from].kind) {
                (Some(branch), _) => End::Branch(*branch, arm.output),
                (None, Kind::Branch(branch)) => End::Branch(branch, arm.output),
                (None, Kind::Step(step)) => End::Step(step),
                (None, Kind::Transition(transition)) => End::Transition(transition),
                (None, Kind::Jump) => continue,
            };
            let (to, jump) = match items[arm.to].kind {
                Kind::Step(step) => (End::Step(step), false),
                Kind::Transition(transition) => (End::Transition(transition), false),
                Kind::Branch(branch) => (End::Branch(branch, arm.input), false),
                Kind::Jump => (self.target(items[arm.to].node, &steps, &plan.steps), true),
            };
            plan.drawing.lines.push(Line { from, to, jump, span: arm.span });
        }
        self.ends(&mut plan);
        plan
    }

    /// Several lines from a step, or from the end of a simultaneous branch, begin an alternative branch that is not drawn. The key of the branches is
    /// the node that they come after.
    fn hidden_branches(&self, items: &[Item<'a>], arms: &[Arm], plan: &mut Plan<'a>) -> HashMap<usize, usize> {
        let drawing = &mut plan.drawing;
        let mut counts = vec![0; items.len()];
        arms.iter().for_each(|arm| counts[arm.from] += 1);
        let mut heads = HashMap::new();
        for (at, item) in items.iter().enumerate().filter(|(at, _)| counts[*at] > 1) {
            let from = match item.kind {
                Kind::Step(step) => End::Step(step),
                Kind::Branch(branch) if drawing.branches[branch].kind == BranchKind::SimultaneousEnd => {
                    End::Branch(branch, 0)
                }
                Kind::Branch(_) | Kind::Transition(_) | Kind::Jump => continue,
            };
            let span = self.reader.place(item.node, "name");
            let to = End::Branch(drawing.branches.len(), 0);
            heads.insert(at, drawing.branches.len());
            drawing.branches.push(Branch { kind: BranchKind::AlternativeBegin, cardinality: None, span });
            drawing.lines.push(Line { from, to, jump: false, span });
        }
        heads
    }

    fn items(&mut self, content: Node<'a, 'a>, plan: &mut Plan<'a>) -> Vec<Item<'a>> {
        let mut items = Vec::new();
        for node in elements(content) {
            let span = self.reader.place(node, "name");
            let branch = match node.tag_name().name() {
                "selectionDivergence" => Some(BranchKind::AlternativeBegin),
                "selectionConvergence" => Some(BranchKind::AlternativeEnd),
                "simultaneousDivergence" => Some(BranchKind::SimultaneousBegin),
                "simultaneousConvergence" => Some(BranchKind::SimultaneousEnd),
                _ => None,
            };
            let kind = match (node.tag_name().name(), branch) {
                (_, Some(kind)) => {
                    plan.drawing.branches.push(Branch { kind, cardinality: None, span });
                    Kind::Branch(plan.drawing.branches.len() - 1)
                }
                (name @ ("step" | "macroStep"), None) => {
                    if name == "macroStep" {
                        let text = match node.attribute("name").map(str::trim).filter(|name| !name.is_empty()) {
                            Some(name) => format!("plcc does not read macro steps, such as `{name}`"),
                            None => "plcc does not read macro steps".to_string(),
                        };
                        let help = "draw the steps of the macro step in the chart itself";
                        self.report(Code::ForeignContent, span, text, "its steps are not executed", help);
                        self.broken = true;
                    }
                    if let Some(id) = node.attribute("localId") {
                        plan.ids.entry(id.trim()).or_insert(plan.steps.len());
                    }
                    plan.steps.push(node);
                    plan.drawing.steps.push(span);
                    Kind::Step(plan.steps.len() - 1)
                }
                ("transition", None) => {
                    plan.transitions.push(node);
                    plan.drawing.transitions.push(span);
                    Kind::Transition(plan.transitions.len() - 1)
                }
                ("jumpStep", None) => Kind::Jump,
                _ => continue,
            };
            items.push(Item { kind, node });
        }
        items
    }

    /// The lines between items, with the indices of their ends.
    fn arms(&mut self, items: &[Item<'a>]) -> Vec<Arm> {
        let mut ids: HashMap<&str, usize> = HashMap::new();
        for (at, item) in items.iter().enumerate() {
            if let Some(id) = item.node.attribute("localId") {
                ids.entry(id.trim()).or_insert(at);
            }
        }
        let mut arms: Vec<Arm> = Vec::new();
        for (to, item) in items.iter().enumerate() {
            for (input, line) in lines(item.node).enumerate() {
                let id = line.attribute("refLocalId").unwrap_or("").trim();
                let span = self.reader.place(line, "refLocalId");
                match ids.get(id).copied().filter(|from| items[*from].kind != Kind::Jump) {
                    Some(from) => {
                        let rank = (priority(item), position(item.node).1, output(items[from].node, line));
                        arms.push(Arm { from, to, output: 0, input: input as u32, rank, span });
                    }
                    // Editors drop these lines when they open the project; parts that become unreachable are reported.
                    None => {
                        let text = format!("a line comes from object {id}, which is not a step, transition or branch");
                        let help = "connect the element again in the editor if something is missing";
                        self.report(Code::Tolerated, span, text, "the line is left out", help);
                    }
                }
            }
        }
        // Ties keep the order of the file.
        let mut order: Vec<usize> = (0..arms.len()).collect();
        order.sort_by_key(|at| arms[*at].rank);
        let mut outputs: HashMap<usize, u32> = HashMap::new();
        for at in order {
            let next = outputs.entry(arms[at].from).or_insert(0);
            arms[at].output = *next;
            *next += 1;
        }
        arms
    }

    /// The step that a jump leads to.
    fn target(&mut self, node: Node<'a, 'a>, known: &HashMap<String, usize>, steps: &[Node<'a, 'a>]) -> End {
        let name = node.attribute("targetName").unwrap_or("").trim();
        if let Some(step) = known.get(&name.to_lowercase()) {
            return End::Step(*step);
        }
        let names = steps.iter().filter_map(|step| step.attribute("name"));
        let nearest = names.map(|known| (distance::between(&name.to_lowercase(), &known.to_lowercase()), known)).min();
        let help = match nearest {
            Some((distance, nearest)) if distance <= 2 => format!("did you mean `{nearest}`?"),
            _ => "give the jump the name of a step of this chart".to_string(),
        };
        let span = self.reader.place(node, "targetName");
        self.report(
            Code::UnknownStep,
            span,
            format!("no step of the chart is called `{name}`"),
            "the target of a jump",
            help,
        );
        self.broken = true;
        End::End
    }

    /// A transition that nothing follows ends its sequence.
    fn ends(&mut self, plan: &mut Plan<'a>) {
        let followed: HashSet<End> = plan.drawing.lines.iter().map(|line| line.from).collect();
        for at in (0..plan.transitions.len()).filter(|at| !followed.contains(&End::Transition(*at))) {
            let span = plan.drawing.transitions[at];
            if !self.broken {
                let text = "nothing follows this transition";
                let help = "draw the step that follows, or a jump to it, if the sequence is to go on";
                self.report(Code::Tolerated, span, text, "the sequence ends here", help);
            }
            plan.drawing.lines.push(Line { from: End::Transition(at), to: End::End, jump: false, span });
        }
    }
}

/// The number of a transition; those without a number come last.
fn priority(item: &Item) -> u64 {
    let priority = item.node.attribute("priority").filter(|_| matches!(item.kind, Kind::Transition(_)));
    priority.and_then(|text| text.trim().parse().ok()).unwrap_or(u64::MAX)
}

/// The index of the output that a line names.
fn output(from: Node, line: Node) -> usize {
    let name = line.attribute("formalParameter").unwrap_or("");
    let points = elements(from).filter(|point| point.tag_name().name() == "connectionPointOut");
    let mut names = points.map(|point| point.attribute("formalParameter").unwrap_or(""));
    names.position(|known| known == name).unwrap_or(0)
}

fn named((at, step): (usize, &Node)) -> Option<(String, usize)> {
    Some((step.attribute("name")?.trim().to_lowercase(), at))
}
