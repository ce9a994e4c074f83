//! Steps, transitions and branches of all sequencers by their numbers, and the drawing that the lines form.

use std::collections::HashMap;

use plcc_diag::{Code, Diagnostic};
use roxmltree::Node as Xml;

use super::super::reader::Reader;
use super::{attribute_span, is_text, name};
use crate::xml::{child, children, elements, head, text_of};
use plcc_syntax::chart::connect::{Branch, BranchKind, Drawing, Line, Node};
use plcc_syntax::scl::ast::Name;

/// Nodes of a chart, in the order of the file. Those without a name or number are left out, which is reported.
pub struct Nodes<'a, 'i> {
    pub steps: Vec<Xml<'a, 'i>>,
    pub step_names: Vec<Name>,
    pub transitions: Vec<Xml<'a, 'i>>,
    pub transition_names: Vec<Name>,
    pub drawing: Drawing,
    /// Indices by number; if a number appears twice, the first.
    step_places: HashMap<u32, usize>,
    transition_places: HashMap<u32, usize>,
}

/// A number in an attribute.
pub fn number(node: Xml, attribute: &str) -> Option<u32> {
    node.attribute(attribute)?.trim().parse().ok()
}

impl<'a, 'i> Nodes<'a, 'i> {
    pub fn read(reader: &mut Reader, sequences: &[Xml<'a, 'i>], block: &str) -> Nodes<'a, 'i> {
        let mut nodes = Nodes {
            steps: Vec::new(),
            step_names: Vec::new(),
            transitions: Vec::new(),
            transition_names: Vec::new(),
            drawing: Drawing::default(),
            step_places: HashMap::new(),
            transition_places: HashMap::new(),
        };
        for sequence in sequences {
            nodes.list(reader, *sequence, block);
        }
        // A line may lead to a step of another sequencer; branches are numbered separately in each sequencer.
        for sequence in sequences {
            let branches = nodes.branches(reader, *sequence, block);
            for lines in children(*sequence, "Connections") {
                for connection in children(lines, "Connection") {
                    if let Some(line) = nodes.line(reader, connection, &branches) {
                        nodes.drawing.lines.push(line);
                    }
                }
            }
        }
        nodes
    }

    /// Steps and transitions of a sequencer.
    fn list(&mut self, reader: &mut Reader, sequence: Xml<'a, 'i>, block: &str) {
        for list in elements(sequence) {
            match list.tag_name().name() {
                "Steps" => {
                    for node in children(list, "Step") {
                        let Some(number) = named(reader, node, "step", block) else { continue };
                        self.step_places.entry(number).or_insert(self.steps.len());
                        self.step_names.push(name(reader, node));
                        self.drawing.steps.push(reader.span(head(node)));
                        self.steps.push(node);
                    }
                }
                "Transitions" => {
                    for node in children(list, "Transition") {
                        let Some(number) = named(reader, node, "transition", block) else { continue };
                        self.transition_places.entry(number).or_insert(self.transitions.len());
                        self.transition_names.push(name(reader, node));
                        self.drawing.transitions.push(reader.span(head(node)));
                        self.transitions.push(node);
                    }
                }
                "Branches" | "Connections" => {}
                other if is_text(other) => {}
                other => {
                    reader.refuse(list, &format!("`{block}`"), &format!("a sequencer with `{other}`"));
                }
            }
        }
    }

    /// The branches of a sequencer by number.
    fn branches(&mut self, reader: &mut Reader, sequence: Xml, block: &str) -> HashMap<u32, usize> {
        let mut places = HashMap::new();
        for node in children(sequence, "Branches").flat_map(|list| children(list, "Branch")) {
            let kind = match node.attribute("Type").unwrap_or_default() {
                "AltBegin" => BranchKind::AlternativeBegin,
                "AltEnd" => BranchKind::AlternativeEnd,
                "SimBegin" => BranchKind::SimultaneousBegin,
                "SimEnd" => BranchKind::SimultaneousEnd,
                other => {
                    reader.refuse(node, &format!("`{block}`"), &format!("a branch of the kind `{other}`"));
                    continue;
                }
            };
            let Some(number) = number(node, "Number") else {
                reader.refuse(node, &format!("`{block}`"), "a branch without a number");
                continue;
            };
            places.entry(number).or_insert(self.drawing.branches.len());
            let cardinality = self::number(node, "Cardinality");
            self.drawing.branches.push(Branch { kind, cardinality, span: reader.span(head(node)) });
        }
        places
    }

    fn line(&self, reader: &mut Reader, connection: Xml, branches: &HashMap<u32, usize>) -> Option<Line> {
        let mut end = |side: &str, arm: &str| {
            let end = child(connection, side).and_then(|side| elements(side).next());
            match end {
                Some(end) => self.node(reader, end, arm, branches),
                None => {
                    reader.refuse(connection, "a sequencer", &format!("a connection without `{side}`"));
                    None
                }
            }
        };
        let (from, to) = (end("NodeFrom", "Out"), end("NodeTo", "In"));
        let jump = child(connection, "LinkType").is_some_and(|link| text_of(link).eq_ignore_ascii_case("Jump"));
        Some(Line { from: from?, to: to?, jump, span: reader.span(head(connection)) })
    }

    /// An end of a line; `None` if the chart does not have it, which is reported.
    fn node(&self, reader: &mut Reader, end: Xml, arm: &str, branches: &HashMap<u32, usize>) -> Option<Node> {
        let wanted = number(end, "Number");
        let at = |places: &HashMap<u32, usize>| wanted.and_then(|wanted| places.get(&wanted).copied());
        let (what, found) = match end.tag_name().name() {
            "StepRef" => ("step", at(&self.step_places).map(Node::Step)),
            "TransitionRef" => ("transition", at(&self.transition_places).map(Node::Transition)),
            "BranchRef" => {
                let arm = number(end, arm).unwrap_or(0);
                ("branch", at(branches).map(|branch| Node::Branch(branch, arm)))
            }
            "EndConnection" => return Some(Node::End),
            other => {
                reader.refuse(end, "a connection", &format!("`{other}`"));
                return None;
            }
        };
        if found.is_none() {
            let title = format!("a line leads to {what} {}, which is not in the chart", shown(end));
            let message = Diagnostic::new(Code::UnknownStep, attribute_span(reader, end, "Number"), title);
            reader
                .diagnostics
                .push(message.label(format!("there is no {what} with this number")).help("export the block again"));
        }
        found
    }
}

/// The number of a reference as it is written.
fn shown(node: Xml) -> String {
    node.attribute("Number").unwrap_or("without a number").to_string()
}

/// The number of a step or transition that has a name, too; `None` if one is missing, which is reported.
fn named(reader: &mut Reader, node: Xml, what: &str, block: &str) -> Option<u32> {
    let named = node.attribute("Name").is_some_and(|name| !name.trim().is_empty());
    let number = number(node, "Number");
    if !named || number.is_none() {
        let lacks = if named { "number" } else { "name" };
        reader.refuse(node, &format!("`{block}`"), &format!("a {what} without a {lacks}"));
        return None;
    }
    number
}
