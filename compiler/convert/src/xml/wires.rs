//! Networks of LAD and FBD: wires between the pins of parts, and joins of branches.

use std::collections::HashMap;

use plcc_syntax::network::ast::{Element, Graph, NetId, Network, PinValue, Source, Target};
use plcc_syntax::network::elements::{Kind, PinDirection};
use plcc_syntax::scl::ast::{Expr, ExprKind, NameForm};

use super::access::{self, Whose};
use super::flgnet::Maker;
use crate::node::Node;
use crate::writer::Writer;

/// A pin that a wire ends at.
#[derive(Clone)]
struct End {
    part: usize,
    name: String,
}

impl Maker<'_> {
    pub(super) fn wire(&mut self, network: &Network, writer: &mut Writer) -> Option<()> {
        let graph = self.graph;
        let mut readers: HashMap<NetId, Vec<End>> = HashMap::new();
        for (part, element) in graph.elements.iter().enumerate() {
            for pin in element.pins.iter().filter(|pin| !pin.output) {
                if let PinValue::Net(net) = pin.value {
                    let end = End { part, name: pin.name.clone() };
                    readers.entry(self.source_net(net)).or_default().push(end);
                }
            }
        }
        // Joins of branches are parts of their own, and read the wires that they join.
        let mut joins: HashMap<NetId, usize> = HashMap::new();
        let mut fed: Vec<(NetId, Source)> = Vec::new();
        for at in 0..graph.nets.len() {
            let net = NetId(at as u32);
            let sources = &graph.net(net).sources;
            let is_read = readers.contains_key(&net)
                || graph.nets.iter().any(|other| other.sources.len() > 1 && other.sources.contains(&Source::Net(net)));
            if sources.len() < 2 || !is_read {
                continue;
            }
            let part = self.part_uids.len();
            let uid = self.uids.next();
            self.part_uids.push(uid);
            self.drawing.parts.push(None);
            self.drawing.pins.push(Vec::new());
            let card = Node::of("TemplateValue", sources.len().to_string()).with("Name", "Card");
            self.parts
                .push(Node::new("Part").with("Name", "O").with("UId", uid).child(card.with("Type", "Cardinality")));
            joins.insert(net, part);
            for (number, source) in sources.iter().enumerate() {
                let name = format!("in{}", number + 1);
                let end = End { part, name };
                match source {
                    Source::Net(other) => readers.entry(self.source_net(*other)).or_default().push(end),
                    Source::Rail | Source::Pin { .. } | Source::Operand { .. } => {
                        let own = graph.nets.len() + fed.len();
                        let own = NetId(own as u32);
                        fed.push((own, source.clone()));
                        readers.entry(own).or_default().push(end);
                    }
                }
            }
        }
        let joined = |net: NetId| fed.iter().find(|(own, _)| *own == net).map(|(_, source)| source.clone());
        let mut nets: Vec<NetId> = readers.keys().copied().collect();
        nets.sort();
        // The power rail is one wire.
        let mut rail = Vec::new();
        let mut outputs: HashMap<(usize, String), Vec<End>> = HashMap::new();
        let mut operands: Vec<(Expr, bool, End)> = Vec::new();
        for net in nets {
            let ends = readers.remove(&net).unwrap_or_default();
            let source = match (joins.get(&net), joined(net)) {
                (Some(part), _) => {
                    outputs.entry((*part, "out".to_string())).or_default().extend(ends);
                    continue;
                }
                (None, Some(source)) => source,
                (None, None) => match graph.net(net).sources.first() {
                    Some(source) => source.clone(),
                    None => {
                        writer.refuse(network.span, "a wire that nothing feeds", "connect it, or remove it");
                        return None;
                    }
                },
            };
            match source {
                Source::Rail => rail.extend(ends),
                Source::Pin { element, pin } => {
                    let name = graph.elements[element].pins[pin].name.clone();
                    outputs.entry((element, name)).or_default().extend(ends);
                }
                Source::Operand { value, negated } => {
                    operands.extend(ends.into_iter().map(|end| (value.clone(), negated, end)));
                }
                Source::Net(_) => {
                    writer.refuse(network.span, "wires that feed each other", "remove one of them");
                    return None;
                }
            }
        }
        if !rail.is_empty() {
            rail.sort_by_key(|end| end.part);
            let ends = vec![Node::new("Powerrail")];
            let wire = self.add_wire(None, &rail, ends);
            self.drawing.rail = Some(wire);
        }
        for (value, negated, end) in operands {
            let uid = self.operand(&value, writer)?;
            if negated {
                self.invert(&end);
            }
            self.add_wire(None, &[end], vec![Node::new("IdentCon").with("UId", uid)]);
        }
        for (part, element) in graph.elements.iter().enumerate() {
            self.element_wires(part, element, &mut outputs, writer)?;
        }
        let mut rest: Vec<((usize, String), Vec<End>)> = outputs.into_iter().collect();
        rest.sort_by_key(|((part, name), _)| (*part, name.clone()));
        for ((part, name), ends) in rest {
            self.output_wire(part, &name, &ends, Vec::new());
        }
        Some(())
    }

    /// The net that feeds a net which is only another name for it.
    fn source_net(&self, net: NetId) -> NetId {
        let mut net = net;
        for _ in 0..self.graph.nets.len() {
            match self.graph.net(net).sources[..] {
                [Source::Net(other)] => net = other,
                _ => break,
            }
        }
        net
    }

    /// The operands at the pins of an element, and what its outputs feed.
    fn element_wires(
        &mut self,
        part: usize,
        element: &Element,
        outputs: &mut HashMap<(usize, String), Vec<End>>,
        writer: &mut Writer,
    ) -> Option<()> {
        let mut done: Vec<&str> = Vec::new();
        for pin in &element.pins {
            let end = End { part, name: pin.name.clone() };
            match &pin.value {
                PinValue::Operand(value) if !pin.output => {
                    let uid = self.operand(value, writer)?;
                    self.add_wire(None, &[end], vec![Node::new("IdentCon").with("UId", uid)]);
                }
                PinValue::Open if !pin.output => {
                    let uid = self.uids.next();
                    self.add_wire(None, &[end], vec![Node::new("OpenCon").with("UId", uid)]);
                }
                _ if !pin.output || done.contains(&pin.name.as_str()) => {}
                _ => {
                    done.push(&pin.name);
                    let mut ends = Vec::new();
                    for other in element.pins.iter().filter(|other| other.output && other.name == pin.name) {
                        if let PinValue::Operand(value) = &other.value {
                            let uid = self.operand(value, writer)?;
                            ends.push(Node::new("IdentCon").with("UId", uid));
                        }
                    }
                    let readers = outputs.remove(&(part, pin.name.clone())).unwrap_or_default();
                    let is_open = ends.is_empty() && readers.is_empty();
                    if is_open && pin.value == PinValue::Open {
                        let uid = self.uids.next();
                        ends.push(Node::new("OpenCon").with("UId", uid));
                    }
                    if !is_open || pin.value == PinValue::Open {
                        self.output_wire(part, &pin.name, &readers, ends);
                    }
                }
            }
        }
        Some(())
    }

    /// A wire that the part feeds.
    fn output_wire(&mut self, part: usize, name: &str, readers: &[End], operands: Vec<Node>) {
        let mut readers = readers.to_vec();
        readers.sort_by_key(|end| end.part);
        let direction = match self.drawing.parts[part].map(|element| &element.target) {
            Some(Target::Element { row, .. }) => row.pin(name).map(|(pin, _)| pin.direction),
            Some(Target::Block { .. }) | None => Some(PinDirection::Output),
        };
        let own = Node::new("NameCon").with("UId", self.part_uids[part]).with("Name", name);
        let uid = self.uids.next();
        let mut wire = Node::new("Wire").with("UId", uid);
        // The operand of a coil comes first, as the editor writes it.
        let is_coil = name == "operand" && readers.is_empty() && operands.len() == 1;
        if is_coil {
            wire.children.extend(operands);
            wire.push(own);
        } else {
            wire.push(own);
            for end in &readers {
                wire.push(Node::new("NameCon").with("UId", self.part_uids[end.part]).with("Name", &end.name));
            }
            wire.children.extend(operands);
        }
        self.wires.push(wire);
        let is_output = direction == Some(PinDirection::Output);
        self.note(is_output.then_some((part, name)), &readers);
    }

    /// A wire that begins with `first`.
    fn add_wire(&mut self, source: Option<(usize, &str)>, readers: &[End], first: Vec<Node>) -> usize {
        let uid = self.uids.next();
        let mut wire = Node::new("Wire").with("UId", uid);
        // An open connection comes after its pin.
        let (open, first): (Vec<Node>, Vec<Node>) = first.into_iter().partition(|node| node.name == "OpenCon");
        wire.children.extend(first);
        for end in readers {
            wire.push(Node::new("NameCon").with("UId", self.part_uids[end.part]).with("Name", &end.name));
        }
        wire.children.extend(open);
        self.wires.push(wire);
        self.note(source, readers)
    }

    /// Notes a wire for the order of evaluation.
    fn note(&mut self, source: Option<(usize, &str)>, readers: &[End]) -> usize {
        let wire = self.drawing.sinks.len();
        self.drawing.sinks.push(readers.iter().map(|end| end.part).collect());
        self.drawing.sources.push(source.map(|(part, _)| part));
        if let Some((part, name)) = source {
            self.drawing.pins[part].push((name.to_string(), wire, true));
        }
        for end in readers {
            self.drawing.pins[end.part].push((end.name.clone(), wire, false));
        }
        wire
    }

    /// Inverts a pin once more.
    fn invert(&mut self, end: &End) {
        let part = &mut self.parts[end.part];
        let is = |node: &Node| node.name == "Negated" && node.attributes.iter().any(|(_, name)| *name == end.name);
        match part.children.iter().position(is) {
            Some(at) => drop(part.children.remove(at)),
            None => part.push(Node::new("Negated").with("Name", &end.name)),
        }
    }

    /// The number of an operand.
    fn operand(&mut self, value: &Expr, writer: &mut Writer) -> Option<u32> {
        // A label is named by a jump.
        let is_label = matches!(&value.kind, ExprKind::Name(name) if name.form == NameForm::Bare
            && access::whose(&name.text, name.form, self.block) == Whose::Global
            && is_label(self.graph, value));
        if let ExprKind::Name(name) = &value.kind
            && is_label
        {
            let uid = self.uids.next();
            let label = Node::new("Label").with("Name", &name.text);
            self.operands.push(Node::new("Access").with("Scope", "Label").with("UId", uid).child(label));
            return Some(uid);
        }
        let Some(node) = access::access(value, self.block, &mut self.uids, writer) else {
            let help = "put the value into a variable before";
            writer.refuse(value.span, "SimaticML has no form for this operand of a network", help);
            return None;
        };
        let uid = node.attributes.iter().find(|(key, _)| *key == "UId").and_then(|(_, uid)| uid.parse().ok());
        self.operands.push(node);
        uid
    }
}

/// Whether a value is where jumps have their labels.
fn is_label(graph: &Graph, value: &Expr) -> bool {
    graph.elements.iter().any(|element| {
        let Target::Element { row, .. } = &element.target else { return false };
        let jumps = matches!(row.kind, Kind::Jump { .. } | Kind::JumpList | Kind::Switch);
        jumps
            && element.pins.iter().any(|pin| {
                let is_place = pin.name == "label" || pin.name.starts_with("dest") || pin.name == "else";
                is_place && matches!(&pin.value, PinValue::Operand(own) if std::ptr::eq(own, value) || own == value)
            })
    })
}
