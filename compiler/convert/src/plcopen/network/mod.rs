//! Networks as objects of LD and FBD.
//!
//! `elements`: contacts, coils, edges and gates; `blocks`: boxes and calls.
//!
//! Each element is one object or a few, in the order in which it runs; their numbers of execution say so in the file.
//!
//! | Element | Objects |
//! | --- | --- |
//! | contact, coil, gate, comparison | the same; a comparison after a contact is joined with it by AND |
//! | P, N with an edge bit | contacts of the signal and of the bit, and a coil that writes the bit |
//! | SR, RS | two coils in the order that decides who wins, then a contact |
//! | TON, CTU, box, call | a block; EN and ENO only where they are connected |

mod blocks;
mod elements;

use std::collections::{HashMap, HashSet};

use plcc_diag::{Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{
    Content, Element, Graph, Language, NetId, Network, Pin, PinValue, Source, Storage as PinStorage, Target,
};
use plcc_syntax::network::elements::Kind as RowKind;
use plcc_syntax::scl::ast::{Expr, StatementKind};

use super::body::Body;
use super::identifier::identifier;
use super::layout;
use super::objects::{self, Input, Kind, Object, Origin, Output, Storage};
use crate::frames::bare;
use crate::node::Node;

const HELP: &str = "write the network with other elements, or in SCL";

/// The body of a block that consists of networks.
pub fn write(body: &mut Body, networks: &[Network], language: Language) -> Node {
    let mut all: Vec<Object> = Vec::new();
    let mut order = 0;
    let mut top = 20;
    for (at, network) in networks.iter().enumerate() {
        let end = networks.get(at + 1).map_or(body.block.span.end, |next| next.span.start);
        let first = all.len();
        heading(body, network, end, &mut all);
        for label in &network.labels {
            order += 1;
            all.push(Object { order, ..Object::new(Kind::Label, identifier(&label.text)) });
        }
        match &network.content {
            Content::Graphic(graph) => {
                let mut build = Build {
                    body,
                    graph,
                    is_ladder: language == Language::Lad,
                    first,
                    objects: all,
                    order,
                    outputs: HashMap::new(),
                    started: HashSet::new(),
                    rail: None,
                };
                for element in 0..graph.elements.len() {
                    build.element(element);
                }
                build.close();
                (all, order) = (build.objects, build.order);
            }
            // Assertions alone are a comment.
            Content::Scl(list) if list.iter().all(|one| matches!(one.kind, StatementKind::Pragma(_))) => {
                let lines: Vec<String> = list
                    .iter()
                    .filter_map(|one| match &one.kind {
                        StatementKind::Pragma(pragma) => Some(format!("//@ {}", pragma.text)),
                        _ => None,
                    })
                    .collect();
                if !lines.is_empty() {
                    all.push(Object::new(Kind::Comment, format!("\n{}", lines.join("\n"))));
                }
            }
            Content::Scl(_) | Content::Stl(_) => {
                let title = "LD and FBD of PLCopen XML have no networks in SCL or STL between theirs";
                body.refuse(network.span, title, "put the statements into a block of their own, and call it");
            }
        }
        if all.len() > first {
            top = layout::network(&mut all, first, top);
        }
    }
    objects::body(if language == Language::Lad { "LD" } else { "FBD" }, &all)
}

/// Title and comment of a network: the first line is the title.
fn heading(body: &mut Body, network: &Network, end: u32, objects: &mut Vec<Object>) {
    let mut comment = network.comment.clone();
    for remark in body.writer.trivia.before(end) {
        comment.extend(remark.text.lines().map(bare));
    }
    let title = network.title.clone().unwrap_or_default();
    if title.is_empty() && comment.iter().all(|line| line.trim().is_empty()) {
        return;
    }
    let text: Vec<String> = std::iter::once(title).chain(comment).collect();
    objects.push(Object::new(Kind::Comment, text.join("\n").trim_end()));
}

struct Build<'b, 'p, 'a, 'w, 't> {
    body: &'b mut Body<'p, 'a, 'w, 't>,
    graph: &'b Graph,
    is_ladder: bool,
    /// The first object of the network.
    first: usize,
    objects: Vec<Object>,
    order: u32,
    /// Signals of output pins, by element and name in lower case.
    outputs: HashMap<(usize, String), Vec<Origin>>,
    started: HashSet<usize>,
    rail: Option<usize>,
}

impl<'a> Build<'_, '_, 'a, '_, '_> {
    fn refuse(&mut self, span: Span, title: impl Into<String>) {
        self.body.refuse(span, title, HELP);
    }

    // Objects.

    fn add(&mut self, mut object: Object) -> usize {
        if matches!(
            object.kind,
            Kind::Contact | Kind::Coil | Kind::Block | Kind::OutVariable | Kind::Jump | Kind::Return
        ) {
            self.order += 1;
            object.order = self.order;
        }
        self.objects.push(object);
        self.objects.len() - 1
    }

    fn rail(&mut self) -> Vec<Origin> {
        if !self.is_ladder {
            let value = self.add(Object::new(Kind::InVariable, "TRUE"));
            return vec![origin(value, "")];
        }
        let rail = match self.rail {
            Some(rail) => rail,
            None => {
                let mut object = Object::new(Kind::LeftRail, "");
                object.outputs.push(Output { formal: String::new(), negated: false });
                let rail = self.add(object);
                self.rail = Some(rail);
                rail
            }
        };
        vec![origin(rail, "")]
    }

    fn is_rail(&self, from: &[Origin]) -> bool {
        let is = |origin: &Origin| {
            Some(origin.object) == self.rail
                || self.objects[origin.object].kind == Kind::InVariable && self.objects[origin.object].text == "TRUE"
        };
        from.iter().any(is)
    }

    fn in_variable(&mut self, text: String, negated: bool) -> Vec<Origin> {
        let at = self.add(Object { negated, ..Object::new(Kind::InVariable, text) });
        vec![origin(at, "")]
    }

    fn contact(&mut self, text: String, negated: bool, from: Vec<Origin>) -> Vec<Origin> {
        let inputs = vec![Input { from, ..Input::default() }];
        let at = self.add(Object { negated, inputs, ..Object::new(Kind::Contact, text) });
        vec![origin(at, "")]
    }

    /// A coil, in FBD a variable. Returns the signal after it.
    fn coil(&mut self, text: String, negated: bool, storage: Storage, from: Vec<Origin>) -> Vec<Origin> {
        let kind = if self.is_ladder { Kind::Coil } else { Kind::OutVariable };
        let inputs = vec![Input { from: from.clone(), ..Input::default() }];
        let at = self.add(Object { negated, storage, inputs, ..Object::new(kind, text) });
        if self.is_ladder { vec![origin(at, "")] } else { from }
    }

    /// A block without EN and ENO; returns its only output.
    fn gate(&mut self, name: &str, inputs: Vec<(Vec<Origin>, bool)>) -> Vec<Origin> {
        let single = inputs.len() == 1;
        let inputs: Vec<Input> = inputs
            .into_iter()
            .enumerate()
            .map(|(at, (from, negated))| {
                let formal = if single { "IN".to_string() } else { format!("IN{}", at + 1) };
                let from = self.joined(from);
                Input { formal, from, negated, in_out: false }
            })
            .collect();
        let outputs = vec![Output { formal: "OUT".to_string(), negated: false }];
        let at = self.add(Object { inputs, outputs, ..Object::new(Kind::Block, name) });
        vec![origin(at, "OUT")]
    }

    /// FBD has no lines that meet.
    fn joined(&mut self, from: Vec<Origin>) -> Vec<Origin> {
        if self.is_ladder || from.len() < 2 {
            return from;
        }
        let inputs = from.into_iter().map(|one| (vec![one], false)).collect();
        self.gate("OR", inputs)
    }

    fn inverted(&mut self, from: Vec<Origin>) -> Vec<Origin> {
        self.gate("NOT", vec![(from, false)])
    }

    // Signals.

    fn net(&mut self, id: NetId, depth: usize) -> Vec<Origin> {
        let mut found: Vec<Origin> = Vec::new();
        let net = self.graph.net(id).clone();
        for source in &net.sources {
            let origins = match source {
                Source::Rail => self.rail(),
                Source::Pin { element, pin } => {
                    self.element(*element);
                    let pin = &self.graph.elements[*element].pins[*pin];
                    let name = pin.name.to_lowercase();
                    match self.outputs.get(&(*element, name)).cloned() {
                        Some(origins) => {
                            let plain = !pin.negated || self.carries_negation(&origins);
                            if plain { origins } else { self.inverted(origins) }
                        }
                        None => {
                            self.lost(*element);
                            Vec::new()
                        }
                    }
                }
                Source::Operand { value, negated } => {
                    let text = self.body.text(value);
                    match self.is_ladder && self.is_bool(value) {
                        true => {
                            let rail = self.rail();
                            self.contact(text, *negated, rail)
                        }
                        false => self.in_variable(text, *negated),
                    }
                }
                Source::Net(other) if depth < 64 => self.net(*other, depth + 1),
                Source::Net(_) => Vec::new(),
            };
            for one in origins {
                if !found.contains(&one) {
                    found.push(one);
                }
            }
        }
        self.joined(found)
    }

    /// A signal that was not written: of an element that was refused, or nothing may be written without it.
    fn lost(&mut self, element: usize) {
        if !self.body.writer.messages.iter().any(Diagnostic::is_error) {
            let span = self.graph.elements[element].span;
            self.refuse(span, "PLCopen XML has no form for a signal of this element");
        }
    }

    /// The output pin of a block has the negation itself.
    fn carries_negation(&self, origins: &[Origin]) -> bool {
        origins
            .iter()
            .all(|one| self.objects[one.object].outputs.iter().any(|output| output.formal == one.pin && output.negated))
    }

    fn is_bool(&self, value: &Expr) -> bool {
        self.body.elementary(value) == Some(Elementary::Bool)
    }

    /// The value of a pin; empty: nothing is connected.
    fn value(&mut self, pin: Option<&Pin>) -> Vec<Origin> {
        match pin.map(|pin| &pin.value) {
            None | Some(PinValue::Open) => Vec::new(),
            Some(PinValue::Net(id)) => self.net(*id, 0),
            Some(PinValue::Operand(value)) => {
                let text = self.body.text(value);
                self.in_variable(text, false)
            }
        }
    }

    /// The flow into a pin, with its negation; without a connection the rail. In LD an operand is a contact, which is read in its turn.
    fn flow(&mut self, pin: Option<&Pin>) -> Vec<Origin> {
        let from = match pin.map(|pin| &pin.value) {
            None | Some(PinValue::Open) => self.rail(),
            Some(PinValue::Operand(value)) if self.is_ladder => {
                let text = self.body.text(value);
                let rail = self.rail();
                return self.contact(text, pin.is_some_and(|pin| pin.negated), rail);
            }
            _ => self.value(pin),
        };
        if pin.is_some_and(|pin| pin.negated) { self.inverted(from) } else { from }
    }

    /// The text of an operand that is a variable.
    fn operand(&mut self, element: &Element, name: &str) -> Option<(String, bool, Expr)> {
        match element.pin(name).map(|pin| (&pin.value, pin.negated)) {
            Some((PinValue::Operand(value), negated)) => Some((self.body.text(value), negated, value.clone())),
            _ => {
                self.refuse(element.span, "PLCopen XML needs a variable at this element");
                None
            }
        }
    }

    fn set(&mut self, element: usize, pin: &str, from: Vec<Origin>) {
        self.outputs.insert((element, pin.to_lowercase()), from);
    }

    // Elements.

    fn element(&mut self, at: usize) {
        if !self.started.insert(at) {
            return;
        }
        let graph = self.graph;
        let element = &graph.elements[at];
        match &element.target {
            Target::Element { row, instance } => {
                self.of_row(at, element, row, instance.as_ref());
                if matches!(
                    row.kind,
                    RowKind::Contact
                        | RowKind::Not
                        | RowKind::Gate(_)
                        | RowKind::EdgeContact { .. }
                        | RowKind::EdgeTrigger { .. }
                        | RowKind::Compare(_)
                ) {
                    self.results(at, element);
                }
            }
            Target::Block { callee, instance } => self.call(at, element, callee, instance.as_ref()),
        }
    }

    /// Variables that the output of a gate or a comparison writes.
    fn results(&mut self, at: usize, element: &Element) {
        for pin in element.pins.iter().filter(|pin| pin.output) {
            let PinValue::Operand(value) = &pin.value else { continue };
            let from = match self.outputs.get(&(at, pin.name.to_lowercase())) {
                Some(from) => from.clone(),
                // Refused before.
                None => continue,
            };
            let text = self.body.text(value);
            self.coil(text, pin.negated, storage(pin), from);
        }
    }

    /// Coils that end a rung reach the right rail.
    fn close(&mut self) {
        if !self.is_ladder || self.rail.is_none() {
            return;
        }
        let read: HashSet<usize> = self.objects[self.first..]
            .iter()
            .flat_map(|object| &object.inputs)
            .flat_map(|input| &input.from)
            .map(|origin| origin.object)
            .collect();
        let ends: Vec<usize> = (self.first..self.objects.len())
            .filter(|at| self.objects[*at].kind == Kind::Coil && !read.contains(at))
            .collect();
        if ends.is_empty() {
            return;
        }
        let mut rail = Object::new(Kind::RightRail, "");
        rail.inputs = ends.into_iter().map(|at| Input { from: vec![origin(at, "")], ..Input::default() }).collect();
        self.add(rail);
    }
}

fn storage(pin: &Pin) -> Storage {
    match pin.storage {
        PinStorage::None => Storage::None,
        PinStorage::Set => Storage::Set,
        PinStorage::Reset => Storage::Reset,
    }
}

fn origin(object: usize, pin: &str) -> Origin {
    Origin { object, pin: pin.to_string() }
}
