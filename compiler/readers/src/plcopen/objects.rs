//! The objects of an LD or FBD body as they are in the file.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};
use roxmltree::Node;

use super::Reader;
use super::interface::{child, elements};
use plcc_syntax::network::ast::Storage;

/// Elements of an SFC body that are not objects of its networks.
pub const CHART: &[&str] = &[
    "step",
    "macroStep",
    "transition",
    "jumpStep",
    "actionBlock",
    "selectionDivergence",
    "selectionConvergence",
    "simultaneousDivergence",
    "simultaneousConvergence",
];

/// The kind of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    LeftRail,
    Contact,
    Coil,
    Block,
    /// A value that others read.
    InVariable,
    /// A variable that is written.
    OutVariable,
    InOutVariable,
    Label,
    Jump,
    Return,
    Connector,
    Continuation,
    /// The point where a network is the condition of a transition.
    Condition,
}

impl Kind {
    /// Whether an object of this kind means nothing, or something else, without its line.
    fn needs_line(self) -> bool {
        matches!(self, Kind::Contact | Kind::Coil | Kind::Jump | Kind::Return | Kind::Condition)
    }

    /// Whether each object of this kind does something when its turn comes.
    fn runs(self) -> bool {
        matches!(
            self,
            Kind::Contact | Kind::Coil | Kind::Block | Kind::OutVariable | Kind::Jump | Kind::Return | Kind::Condition
        )
    }
}

/// Edge modifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    None,
    Rising,
    Falling,
}

/// An object of a body.
pub struct Object {
    pub kind: Kind,
    /// Type of a block, name of a connector, label.
    pub name: String,
    pub instance: Option<Range<usize>>,
    /// Expression of a variable, operand of a contact or coil.
    pub text: Option<Range<usize>>,
    pub inputs: Vec<Connection>,
    pub outputs: Vec<Connection>,
    pub modifiers: Modifiers,
    /// From the top, then from the left.
    pub position: (i64, i64),
    /// Order of execution; 0: not set.
    pub order: u64,
    /// Its position in messages.
    pub span: Span,
}

/// What a pin or object does to its signal.
#[derive(Clone, Copy, Debug)]
pub struct Modifiers {
    pub negated: bool,
    pub edge: Edge,
    pub storage: Storage,
}

impl Modifiers {
    const NONE: Modifiers = Modifiers { negated: false, edge: Edge::None, storage: Storage::None };
}

/// A pin of a block, or the only one of another object.
pub struct Connection {
    /// Its name in the file; empty if it has none.
    pub formal: String,
    pub modifiers: Modifiers,
    /// Where the signal comes from: objects, and the pins of blocks. Empty for outputs.
    pub from: Vec<(usize, String)>,
    /// Its lines come from no object of the network, which was reported as an error.
    pub lost: bool,
    /// An expression instead of lines.
    pub text: Option<Range<usize>>,
    pub in_out: bool,
    pub span: Span,
}

impl Connection {
    /// Whether nothing is connected to it.
    pub fn is_open(&self) -> bool {
        self.from.is_empty() && self.text.is_none() && !self.lost
    }
}

impl Object {
    /// Whether it does something when its turn comes.
    pub fn runs(&self) -> bool {
        match self.kind {
            Kind::InOutVariable => self.inputs.iter().any(|input| !input.is_open()),
            kind => kind.runs(),
        }
    }
}

fn modifiers(node: Node) -> Modifiers {
    let attribute = |name: &str| node.attribute(name).unwrap_or("").trim();
    Modifiers {
        negated: matches!(attribute("negated"), "true" | "1"),
        edge: match attribute("edge") {
            "rising" => Edge::Rising,
            "falling" => Edge::Falling,
            _ => Edge::None,
        },
        storage: match attribute("storage") {
            "set" => Storage::Set,
            "reset" => Storage::Reset,
            _ => Storage::None,
        },
    }
}

/// A condition of a transition that a line leads to. Version 1 of the format has the line without a connection point around it.
pub fn connected_condition<'a, 'i>(transition: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    child(transition, "condition").filter(|condition| lines(*condition).next().is_some())
}

/// The lines that lead to a node.
pub fn lines<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    let points = elements(node).filter(|point| point.tag_name().name() == "connectionPointIn");
    let free = elements(node).filter(|line| line.tag_name().name() == "connection");
    points.flat_map(elements).filter(|line| line.tag_name().name() == "connection").chain(free)
}

/// From the top, then from the left.
pub fn position(node: Node) -> (i64, i64) {
    let position = child(node, "position");
    let number = |name: &str| -> i64 {
        position.and_then(|node| node.attribute(name)).and_then(|text| text.trim().parse::<f64>().ok()).unwrap_or(0.0)
            as i64
    };
    (number("y"), number("x"))
}

impl Reader<'_> {
    /// Reports a part that plcc does not read.
    pub fn unreadable(&mut self, span: Span, what: &str, help: &str) {
        let message = Diagnostic::new(Code::ForeignContent, span, format!("plcc does not read {what}"));
        self.messages.push(message.label("nothing is compiled in its place").help(help));
    }

    /// The objects of a body, with their connections as indices into the list. For an SFC body, the objects of its networks; a transition that one of
    /// them leads to is a `Condition`, in the order of the file.
    pub fn objects(&mut self, body: Node) -> Vec<Object> {
        let is_chart = body.tag_name().name() == "SFC";
        let mut ids: HashMap<&str, usize> = HashMap::new();
        let mut nodes = Vec::new();
        for node in elements(body) {
            let kind = match node.tag_name().name() {
                "leftPowerRail" => Kind::LeftRail,
                "contact" => Kind::Contact,
                "coil" => Kind::Coil,
                "block" => Kind::Block,
                "inVariable" => Kind::InVariable,
                "outVariable" => Kind::OutVariable,
                "inOutVariable" => Kind::InOutVariable,
                "label" => Kind::Label,
                "jump" => Kind::Jump,
                "return" => Kind::Return,
                "connector" => Kind::Connector,
                "continuation" => Kind::Continuation,
                "transition" if is_chart => {
                    nodes.extend(connected_condition(node).map(|condition| (Kind::Condition, condition)));
                    continue;
                }
                name if is_chart && CHART.contains(&name) => continue,
                "rightPowerRail" | "comment" | "documentation" | "addData" => continue,
                // CODESYS writes the titles of networks like this.
                "vendorElement" if node.descendants().any(|data| data.text() == Some("networktitle")) => continue,
                name => {
                    let span = self.place(node, "name");
                    let text = format!("plcc does not read the element `{name}` of PLCopen XML");
                    let help = "draw it with contacts, coils, blocks and variables, and export again";
                    let message = Diagnostic::new(Code::ForeignContent, span, text);
                    self.messages.push(message.label("nothing is compiled in its place").help(help));
                    continue;
                }
            };
            if let Some(id) = node.attribute("localId") {
                ids.insert(id.trim(), nodes.len());
            }
            nodes.push((kind, node));
        }
        let unread = unread(body, &nodes);
        nodes.into_iter().map(|(kind, node)| self.object(kind, node, &ids, unread)).collect()
    }

    fn object(&mut self, kind: Kind, node: Node, ids: &HashMap<&str, usize>, unread: Option<&str>) -> Object {
        let text = ["variable", "expression"]
            .iter()
            .find_map(|name| child(node, name).filter(|_| kind != Kind::Block))
            .and_then(|node| self.text_range(node));
        let attribute = |name: &str| node.attribute(name).map(str::trim).filter(|text| !text.is_empty());
        let name_attribute = match kind {
            Kind::Block => "typeName",
            Kind::Label | Kind::Jump => "label",
            _ => "name",
        };
        let span = text.clone().map_or_else(|| self.place(node, name_attribute), |range| self.span(range));
        let mut object = Object {
            kind,
            name: attribute(name_attribute).unwrap_or("").to_string(),
            instance: attribute("instanceName").and(node.attribute_node("instanceName")).map(|a| a.range_value()),
            text,
            inputs: Vec::new(),
            outputs: Vec::new(),
            modifiers: modifiers(node),
            position: position(node),
            order: attribute("executionOrderId").and_then(|text| text.parse().ok()).unwrap_or(0),
            span,
        };
        let stored = object.modifiers.storage != Storage::None;
        if stored && (object.modifiers.negated || object.modifiers.edge != Edge::None || kind == Kind::Contact) {
            self.unreadable(span, "an object that stores and also does something else", "draw two objects");
        }
        if kind == Kind::Coil && object.modifiers.negated && object.modifiers.edge != Edge::None {
            self.unreadable(span, "a coil with an edge and a negation", "draw a contact before the coil");
        }
        if kind == Kind::Block {
            for list in elements(node) {
                let (output, in_out) = match list.tag_name().name() {
                    "inputVariables" => (false, false),
                    "inOutVariables" => (false, true),
                    "outputVariables" => (true, false),
                    "position" | "documentation" | "addData" => continue,
                    _ => {
                        let span = self.place(list, "name");
                        self.unreadable(span, "a part of a block", "draw the block again, and export the project");
                        continue;
                    }
                };
                for pin in elements(list).filter(|pin| pin.tag_name().name() == "variable") {
                    let connection = self.connection(pin, ids, in_out, None);
                    if output { &mut object.outputs } else { &mut object.inputs }.push(connection);
                }
            }
        } else if child(node, "connectionPointIn").is_some() || kind == Kind::Condition {
            let connection = self.connection(node, ids, false, kind.needs_line().then_some(unread));
            // The error is in the object, not in its line.
            object.inputs.push(Connection { formal: String::new(), modifiers: Modifiers::NONE, ..connection });
        }
        object
    }

    /// `needed`: without a line the object is wrong; the object from which the line may come.
    fn connection(
        &mut self,
        node: Node,
        ids: &HashMap<&str, usize>,
        in_out: bool,
        needed: Option<Option<&str>>,
    ) -> Connection {
        let span = self.place(node, "formalParameter");
        let (mut from, mut missing) = (Vec::new(), Vec::new());
        for line in lines(node) {
            let Some(id) = line.attribute("refLocalId") else { continue };
            match ids.get(id.trim()) {
                Some(at) => from.push((*at, line.attribute("formalParameter").unwrap_or("").trim().to_string())),
                None => missing.push((line, id)),
            }
        }
        let meant = needed.filter(|_| from.is_empty() && !missing.is_empty());
        let own = node.attribute("localId").map(str::trim);
        let other = meant.flatten().filter(|id| Some(*id) != own);
        for (line, id) in missing {
            let place = self.place(line, "refLocalId");
            let text = format!("a line comes from object {id}, which is not in the network");
            self.messages.push(match meant {
                Some(_) => {
                    Diagnostic::new(Code::NoSource, place, text).label("nothing else leads here").help(match other {
                        Some(other) => format!("is `{other}` meant, from which no line comes?"),
                        None => format!("write the `localId` of the object before it: the network has {}", listed(ids)),
                    })
                }
                // Editors drop these lines when they open the project.
                None => Diagnostic::new(Code::Tolerated, place, text)
                    .label("the line is left out")
                    .help("connect the pin again in the editor if something is missing"),
            });
        }
        from.extend(other.and_then(|id| ids.get(id)).map(|at| (*at, String::new())));
        let lost = meant.is_some() && from.is_empty();
        let formal = node.attribute("formalParameter").unwrap_or("").trim().to_string();
        let points = elements(node).filter(|point| point.tag_name().name() == "connectionPointIn");
        let text = points.filter_map(|point| child(point, "expression")).find_map(|text| self.text_range(text));
        Connection { formal, modifiers: modifiers(node), from, lost, text, in_out, span }
    }
}

/// The `localId` of the only contact or variable from which no line comes: a line from nowhere comes from there.
fn unread<'a, 'i>(body: Node<'a, 'i>, nodes: &[(Kind, Node<'a, 'i>)]) -> Option<&'a str> {
    let read = body.descendants().filter_map(|node| node.attribute("refLocalId"));
    let read: HashSet<&str> = read.map(str::trim).collect();
    let feeds = |kind: Kind| matches!(kind, Kind::Contact | Kind::InVariable | Kind::Continuation);
    let ids = nodes.iter().filter(|(kind, _)| feeds(*kind)).filter_map(|(_, node)| node.attribute("localId"));
    let mut ids = ids.map(str::trim).filter(|id| !read.contains(id));
    ids.next().filter(|_| ids.next().is_none())
}

/// The numbers of the objects of a network, the first of many.
fn listed(ids: &HashMap<&str, usize>) -> String {
    const SHOWN_MAX: usize = 12;
    let mut ids: Vec<(Option<u64>, &str)> = ids.keys().map(|id| (id.parse().ok(), *id)).collect();
    ids.sort_unstable();
    let more = if ids.len() > SHOWN_MAX { " …" } else { "" };
    let shown: Vec<&str> = ids.iter().take(SHOWN_MAX).map(|(_, id)| *id).collect();
    format!("{}{more}", shown.join(", "))
}
