//! Networks of LAD and FBD, first half: the parts, accesses and wires of a `FlgNet`, with directions of pins settled.

mod element;
mod wire;

use std::collections::HashMap;

use plcc_diag::Span;
use roxmltree::Node;

use super::reader::{Reader, Refused};
use super::step_time;
use crate::xml::{attribute_range, child, children, elements};
pub use element::OTHER_TEMPLATES;
use plcc_syntax::network::ast::{Comparison, Eno, Target, Template};
use plcc_syntax::network::elements::{Gate, Kind, PinDirection, Row};
use plcc_syntax::scl::ast::{Expr, Name};

/// Number of a part, access or wire in its network.
pub type UId = u64;

/// A part or call.
pub struct Part {
    pub uid: UId,
    pub target: Target,
    pub templates: Vec<Template>,
    pub eno: Eno,
    pub equation: Option<Expr>,
    pub cases: Vec<Comparison>,
    /// Inverted pins, by their names in the syntax tree.
    pub negated: Vec<String>,
    /// Number of pins that repeat.
    pub card: Option<u32>,
    /// For a call: its parameters in order, and whether the block writes them.
    parameters: Vec<(String, bool)>,
    /// The file does not list the parameters: the wires show them.
    open_parameters: bool,
    /// It compares the time of a step.
    step_time: bool,
    pub span: Span,
}

impl Part {
    pub fn row(&self) -> Option<&'static Row> {
        match &self.target {
            Target::Element { row, .. } => Some(row),
            Target::Block { .. } => None,
        }
    }

    /// Pins that the flow enters and leaves.
    pub fn flow(&self) -> (&'static str, &'static str) {
        self.row().map_or(("en", "eno"), |row| row.flow)
    }

    /// The name in the syntax tree of a pin, and whether the part writes it.
    fn pin(&self, given: &str) -> Option<(String, bool)> {
        match self.row() {
            Some(row) => row.pin(given).map(|(pin, name)| (name, pin.direction == PinDirection::Output)),
            None if given.eq_ignore_ascii_case("en") => Some(("en".to_string(), false)),
            None if given.eq_ignore_ascii_case("eno") => Some(("eno".to_string(), true)),
            None => self.parameters.iter().find(|(name, _)| name.eq_ignore_ascii_case(given)).cloned(),
        }
    }

    /// A parameter of a block whose file does not list them.
    fn parameter(&mut self, name: &str, output: bool) -> Option<(String, bool)> {
        if !self.open_parameters {
            return None;
        }
        self.parameters.push((name.to_string(), output));
        self.parameters.last().cloned()
    }

    /// The position of a pin among the others: flow in, the pins of the table or the parameters, flow out.
    pub fn place(&self, name: &str) -> (usize, u32) {
        let (flow_in, flow_out) = self.flow();
        if name == flow_in {
            return (0, 0);
        }
        if name == flow_out {
            return (usize::MAX, 0);
        }
        let number = name.trim_start_matches(|c: char| !c.is_ascii_digit()).parse().unwrap_or(0);
        let place = match self.row() {
            Some(row) => row.pins().position(|pin| pin.matches(name).is_some()),
            None => self.parameters.iter().position(|(known, _)| known == name),
        };
        (place.unwrap_or(usize::MAX - 2) + 1, number)
    }

    /// Whether it is the gate that joins branches of LAD.
    pub fn is_or(&self) -> bool {
        self.row().is_some_and(|row| row.kind == Kind::Gate(Gate::Or))
    }
}

/// An end of a wire.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    Rail,
    /// A pin of the part at an index; `output`: the part writes it.
    Pin {
        part: usize,
        name: String,
        output: bool,
        span: Span,
    },
    Operand(UId),
    Open,
}

/// A wire, with its ends in the order of the file.
pub struct Wire {
    pub ends: Vec<End>,
    pub span: Span,
}

/// A network as it is in the file.
pub struct Parts {
    pub parts: Vec<Part>,
    /// The operands, by number.
    pub operands: HashMap<UId, Expr>,
    pub wires: Vec<Wire>,
    pub labels: Vec<Name>,
}

fn uid(node: Node) -> Option<UId> {
    node.attribute("UId")?.trim().parse().ok()
}

/// Reads a `FlgNet`; `whose` names the network in messages.
pub fn read(reader: &mut Reader, net: Node, whose: &str) -> Result<Parts, Refused> {
    let mut found = Parts { parts: Vec::new(), operands: HashMap::new(), wires: Vec::new(), labels: Vec::new() };
    let mut wires = Vec::new();
    for node in elements(net) {
        match node.tag_name().name() {
            "Labels" => {
                for declaration in children(node, "LabelDeclaration") {
                    let text =
                        child(declaration, "Label").and_then(|label| label.attribute("Name")).unwrap_or_default();
                    if text.trim().is_empty() {
                        return Err(reader.refuse(declaration, whose, "a label without a name"));
                    }
                    let label = reader.label(declaration, text.trim().to_string());
                    found.labels.push(label);
                }
            }
            "Parts" => parts(reader, node, whose, &mut found)?,
            "Wires" => wires.extend(elements(node)),
            "Comment" | "LineComment" => {}
            other => return Err(reader.refuse(node, whose, &format!("`{other}`"))),
        }
    }
    let index: HashMap<UId, usize> = found.parts.iter().enumerate().map(|(at, part)| (part.uid, at)).collect();
    for node in wires {
        let wire = wire::wire(reader, node, whose, &mut found, &index)?;
        found.wires.push(wire);
    }
    Ok(found)
}

fn parts(reader: &mut Reader, list: Node, whose: &str, found: &mut Parts) -> Result<(), Refused> {
    numbers(reader, list, whose)?;
    for node in elements(list) {
        match (node.tag_name().name(), uid(node)) {
            ("Access", Some(uid)) => {
                let operand = reader.operand(node, whose)?;
                found.operands.insert(uid, operand);
            }
            ("Part", Some(uid)) => {
                let part = element::part(reader, node, uid, whose)?;
                found.parts.push(part);
                if let Some(compared) = step_time::of(node.attribute("Name").unwrap_or_default()) {
                    step_time::wire(reader, node, compared, whose, found)?;
                }
            }
            ("Call", Some(uid)) => {
                let part = element::call(reader, node, uid, whose)?;
                found.parts.push(part);
            }
            ("Comment" | "LineComment", _) => {}
            (other, _) => return Err(reader.refuse(node, whose, &format!("`{other}`"))),
        }
    }
    Ok(())
}

/// Wires name parts by their numbers, so each part has its own.
fn numbers(reader: &mut Reader, list: Node, whose: &str) -> Result<(), Refused> {
    let mut known: HashMap<UId, Node> = HashMap::new();
    for node in elements(list).filter(|node| matches!(node.tag_name().name(), "Access" | "Part" | "Call")) {
        let range = attribute_range(node, "UId");
        let Some(uid) = uid(node) else {
            let label = match node.attribute("UId") {
                Some(written) => format!("`{written}` is not a number"),
                None => "`UId` is missing".to_string(),
            };
            let title = format!("{whose} has a part without a number, which no wire can name");
            return Err(reader.fault(range, title, label, "give it a `UId` that no other part of the network has"));
        };
        if let Some(first) = known.insert(uid, node) {
            let free = elements(list).filter_map(self::uid).max().unwrap_or(0).saturating_add(1);
            let title = format!("{whose} has the UId {uid} twice");
            let help = format!("give one of them another number, such as {free}, and correct the wires that name it");
            let refused = reader.fault(range, title, "the second part with this number", help);
            let first = reader.span(attribute_range(first, "UId"));
            if let Some(message) = reader.diagnostics.pop() {
                reader.diagnostics.push(message.also(first, "the first one"));
            }
            return Err(refused);
        }
    }
    Ok(())
}
