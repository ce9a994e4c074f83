//! Networks as objects of LD and FBD.
//!
//! Each element is one object or a few, in the order in which it runs; their numbers of execution say so in the file.
//!
//! | Element | Objects |
//! | --- | --- |
//! | contact, coil, gate, comparison | the same; a comparison after a contact is joined with it by AND |
//! | P, N with an edge bit | contacts of the signal and of the bit, and a coil that writes the bit |
//! | SR, RS | two coils in the order that decides who wins, then a contact |
//! | TON, CTU, box, call | a block; EN and ENO only where they are connected |

use std::collections::{HashMap, HashSet};

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{CodeBlock, SectionKind};
use plcc_syntax::network::ast::{
    Content, Element, Eno, Graph, Language, NetId, Network, Pin, PinValue, Source, Storage as PinStorage, Target,
    TemplateKey,
};
use plcc_syntax::network::elements::{Gate, Kind as Row, ReturnValue};
use plcc_syntax::scl::ast::{Expr, ExprKind, StatementKind};

use super::body::{Body, Called};
use super::identifier::identifier;
use super::layout;
use super::objects::{self, Input, Kind, Object, Origin, Output, Storage};
use super::system;
use crate::frames::bare;
use crate::node::Node;
use crate::to_stl::types::elementary;

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
                        None => Vec::new(),
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
                    Row::Contact
                        | Row::Not
                        | Row::Gate(_)
                        | Row::EdgeContact { .. }
                        | Row::EdgeTrigger { .. }
                        | Row::Compare(_)
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

    fn of_row(
        &mut self,
        at: usize,
        element: &Element,
        row: &'static plcc_syntax::network::elements::Row,
        instance: Option<&Expr>,
    ) {
        let span = element.span;
        let (enter, leave) = row.flow;
        match row.kind {
            Row::Contact => {
                let from = self.flow(element.pin(enter));
                let Some((text, negated, _)) = self.operand(element, "operand") else { return };
                let out = match self.is_ladder {
                    true => self.contact(text, negated, from),
                    false => {
                        let value = self.in_variable(text, false);
                        self.gate("AND", vec![(from, false), (value, negated)])
                    }
                };
                self.set(at, leave, out);
            }
            Row::Not => {
                let from = self.flow(element.pin(enter));
                let out = self.inverted(from);
                self.set(at, leave, out);
            }
            Row::Gate(gate) => {
                let name = match gate {
                    Gate::And => "AND",
                    Gate::Or => "OR",
                    Gate::Xor => "XOR",
                };
                let pins: Vec<&Pin> = element.pins.iter().filter(|pin| !pin.output).collect();
                let mut inputs = Vec::new();
                for pin in pins {
                    let from = self.value(Some(pin));
                    if from.is_empty() {
                        return self.refuse(span, "a gate with an input that nothing is connected to");
                    }
                    inputs.push((from, pin.negated));
                }
                let out = match inputs.len() {
                    1 => {
                        let (from, negated) = inputs.remove(0);
                        if negated { self.inverted(from) } else { from }
                    }
                    _ => self.gate(name, inputs),
                };
                self.set(at, "out", out);
            }
            Row::Coil | Row::SetCoil | Row::ResetCoil => {
                let storage = match row.kind {
                    Row::SetCoil => Storage::Set,
                    Row::ResetCoil => Storage::Reset,
                    _ => Storage::None,
                };
                let from = self.flow(element.pin(enter));
                let Some((text, negated, _)) = self.operand(element, "operand") else { return };
                let out = self.coil(text, negated, storage, from);
                self.set(at, leave, out);
            }
            Row::EdgeContact { rising } => self.edge_contact(at, element, rising),
            Row::EdgeTrigger { rising } => {
                let from = self.flow(element.pin(enter));
                let Some((bit, _, value)) = self.operand(element, "bit") else { return };
                if self.body.is_private(&value) {
                    let name = if rising { "R_TRIG" } else { "F_TRIG" };
                    self.body.retyped.insert(bit.to_lowercase(), Some(name));
                    let inputs = vec![Input { formal: "CLK".to_string(), from, ..Input::default() }];
                    let outputs = vec![Output { formal: "Q".to_string(), negated: false }];
                    let block = Object { instance: Some(bit), inputs, outputs, ..Object::new(Kind::Block, name) };
                    let block = self.add(block);
                    return self.set(at, leave, vec![origin(block, "Q")]);
                }
                let out = self.edge(rising, from, bit);
                self.set(at, leave, out);
            }
            Row::EdgeCoil { rising } => {
                let from = self.flow(element.pin(enter));
                let (Some((text, ..)), Some((bit, ..))) =
                    (self.operand(element, "operand"), self.operand(element, "bit"))
                else {
                    return;
                };
                let pulse = self.edge(rising, from.clone(), bit);
                self.coil(text, false, Storage::None, pulse);
                self.set(at, leave, from);
            }
            Row::FlipFlop { set_wins } => self.flip_flop(at, element, set_wins),
            Row::Compare(sign) => {
                let name = match sign {
                    "=" => "EQ",
                    "<>" => "NE",
                    ">=" => "GE",
                    "<=" => "LE",
                    ">" => "GT",
                    _ => "LT",
                };
                self.check_types(element, &["in1", "in2"]);
                let before = element.pin(enter).map(|pin| self.flow(Some(pin)));
                let (left, right) = (self.value(element.pin("in1")), self.value(element.pin("in2")));
                let out = self.gate(name, vec![(left, false), (right, false)]);
                let out = match before.filter(|from| !self.is_rail(from)) {
                    Some(from) => self.gate("AND", vec![(from, false), (out, false)]),
                    None => out,
                };
                self.set(at, "out", out);
            }
            Row::Instance(_) | Row::TimerCoil(_) => self.instance(at, element, row, instance),
            Row::Operator(_)
            | Row::Function(_)
            | Row::Move
            | Row::Convert
            | Row::Round(_)
            | Row::Negate
            | Row::Invert
            | Row::Step { .. }
            | Row::Mux => self.function(at, element, row),
            Row::Jump { negated } => {
                let label = match element.pin("label").map(|pin| &pin.value) {
                    Some(PinValue::Operand(Expr { kind: ExprKind::Name(name), .. })) => identifier(&name.text),
                    _ => return self.refuse(span, "a jump without a label"),
                };
                let mut from = self.flow(element.pin("in"));
                if negated {
                    from = self.inverted(from);
                }
                self.add(Object { inputs: vec![Input { from, ..Input::default() }], ..Object::new(Kind::Jump, label) });
            }
            Row::Return(ReturnValue::Operand | ReturnValue::True) if element.pin("operand").is_none() => {
                let from = self.flow(element.pin("in"));
                self.add(Object { inputs: vec![Input { from, ..Input::default() }], ..Object::new(Kind::Return, "") });
            }
            _ => {
                let title = format!("LD and FBD of PLCopen XML have no element for `{}`", row.name);
                self.refuse(span, title);
            }
        }
    }

    /// A value of FBD as the output of a gate, which is computed in its turn.
    fn held(&mut self, from: Vec<Origin>, negated: bool) -> Vec<Origin> {
        let always = self.in_variable("TRUE".to_string(), false);
        self.gate("AND", vec![(from, negated), (always, false)])
    }

    /// A contact with an edge: with a bit that nothing else uses, the edge of the notation.
    fn edge_contact(&mut self, at: usize, element: &Element, rising: bool) {
        let before = self.flow(element.pin("pre"));
        let (Some((text, negated, _)), Some((bit, _, value))) =
            (self.operand(element, "operand"), self.operand(element, "bit"))
        else {
            return;
        };
        if !self.is_ladder {
            let value = self.in_variable(text, false);
            let signal = self.held(value, negated);
            let old = self.in_variable(bit.clone(), false);
            let mut inputs = vec![(signal.clone(), !rising), (old, rising)];
            if !self.is_rail(&before) {
                inputs.push((before, false));
            }
            let out = self.gate("AND", inputs);
            self.coil(bit, false, Storage::None, signal);
            return self.set(at, "out", out);
        }
        if !negated && self.body.is_private(&value) {
            self.body.retyped.insert(bit.to_lowercase(), None);
            let out = self.contact(text, false, before);
            if let [Origin { object, .. }] = out.as_slice() {
                self.objects[*object].edge = if rising { "rising" } else { "falling" };
            }
            return self.set(at, "out", out);
        }
        let now = self.contact(text.clone(), negated ^ !rising, before);
        let out = self.contact(bit.clone(), rising, now);
        let rail = self.rail();
        let signal = self.contact(text, negated, rail);
        self.coil(bit, false, Storage::None, signal);
        self.set(at, "out", out);
    }

    /// 1 if the signal has changed since the bit was written, which then gets the signal.
    fn edge(&mut self, rising: bool, signal: Vec<Origin>, bit: String) -> Vec<Origin> {
        let out = match self.is_ladder {
            true => {
                let now = if rising { signal.clone() } else { self.inverted(signal.clone()) };
                self.contact(bit.clone(), rising, now)
            }
            false => {
                let old = self.in_variable(bit.clone(), false);
                self.gate("AND", vec![(signal.clone(), !rising), (old, rising)])
            }
        };
        self.coil(bit, false, Storage::None, signal);
        out
    }

    /// The one that wins comes last.
    fn flip_flop(&mut self, at: usize, element: &Element, set_wins: bool) {
        let Some((text, ..)) = self.operand(element, "operand") else { return };
        let names = if set_wins {
            [("r", Storage::Reset), ("s1", Storage::Set)]
        } else {
            [("s", Storage::Set), ("r1", Storage::Reset)]
        };
        let mut inputs = Vec::new();
        for (name, storage) in names {
            if let Some(pin) = element.pin(name).filter(|pin| !matches!(pin.value, PinValue::Open)) {
                let mut from = self.flow(Some(pin));
                // Both are read before one of them is written.
                if !self.is_ladder {
                    from = self.held(from, false);
                }
                inputs.push((from, storage));
            }
        }
        for (from, storage) in inputs {
            self.coil(text.clone(), false, storage, from);
        }
        let is_read = element.pins.iter().any(|pin| pin.output && matches!(pin.value, PinValue::Net(_)));
        for pin in element.pins.iter().filter(|pin| pin.output && pin.name != "operand") {
            if let PinValue::Operand(target) = &pin.value {
                let target = self.body.text(target);
                let value = match self.is_ladder {
                    true => {
                        let rail = self.rail();
                        self.contact(text.clone(), pin.negated, rail)
                    }
                    false => {
                        let value = self.in_variable(text.clone(), false);
                        self.held(value, pin.negated)
                    }
                };
                self.coil(target, false, Storage::None, value);
            }
        }
        if is_read {
            let out = match self.is_ladder {
                true => {
                    let rail = self.rail();
                    self.contact(text, false, rail)
                }
                false => {
                    let value = self.in_variable(text, false);
                    self.held(value, false)
                }
            };
            self.set(at, "q", out);
        }
    }

    // Blocks.

    /// Adds a block with these inputs and outputs, and the variables that its outputs write. `outputs`: pins with their names in the file.
    fn block(&mut self, at: usize, element: &Element, mut object: Object, outputs: &[(&Pin, String)], has_flow: bool) {
        let enable = element.pin("en").map(|pin| self.flow(Some(pin)));
        let enable = enable.filter(|from| !from.is_empty());
        let conditional = enable.clone().filter(|from| !self.is_rail(from));
        if let Some(from) = &enable
            && (self.is_ladder || conditional.is_some())
        {
            let input = Input { formal: "EN".to_string(), from: from.clone(), ..Input::default() };
            object.inputs.insert(0, input);
        }
        let eno = element.pin("eno").filter(|pin| !matches!(pin.value, PinValue::Open));
        let follows = element.eno == Eno::Disabled;
        if eno.is_some() && !follows {
            object.outputs.insert(0, Output { formal: "ENO".to_string(), negated: false });
        } else if enable.is_some() && self.is_ladder && !has_flow {
            // The line of a rung goes through the block.
            object.outputs.insert(0, Output { formal: "ENO".to_string(), negated: false });
        }
        for (pin, formal) in outputs {
            if !object.outputs.iter().any(|known| known.formal == *formal) {
                let negated = pin.negated && matches!(pin.value, PinValue::Net(_));
                object.outputs.push(Output { formal: formal.clone(), negated });
            }
        }
        let block = self.add(object);
        for (pin, formal) in outputs {
            match &pin.value {
                PinValue::Operand(value) => {
                    let text = self.body.text(value);
                    let storage = storage(pin);
                    let inputs = vec![Input { from: vec![origin(block, formal)], ..Input::default() }];
                    self.add(Object { inputs, storage, negated: pin.negated, ..Object::new(Kind::OutVariable, text) });
                }
                PinValue::Net(_) => self.set(at, &pin.name, vec![origin(block, formal)]),
                PinValue::Open => {}
            }
        }
        if let Some(pin) = eno {
            let from = match follows {
                true => match enable {
                    Some(from) => from,
                    None => self.rail(),
                },
                false => vec![origin(block, "ENO")],
            };
            match &pin.value {
                PinValue::Operand(value) => {
                    let text = self.body.text(value);
                    self.coil(text, pin.negated, Storage::None, from);
                }
                PinValue::Net(_) => self.set(at, "eno", from),
                PinValue::Open => {}
            }
        }
    }

    /// The inputs of a block in this order: pin of the element, name in the file.
    fn inputs(&mut self, pins: &[(&Pin, String)]) -> Vec<Input> {
        let mut inputs = Vec::new();
        for (pin, formal) in pins {
            let from = self.value(Some(pin));
            if from.is_empty() {
                continue;
            }
            let from = self.joined(from);
            inputs.push(Input { formal: formal.clone(), from, negated: pin.negated, in_out: false });
        }
        inputs
    }

    fn instance(
        &mut self,
        at: usize,
        element: &Element,
        row: &'static plcc_syntax::network::elements::Row,
        instance: Option<&Expr>,
    ) {
        let span = element.span;
        let (call, is_coil) = match row.kind {
            Row::Instance(name) => (name, false),
            Row::TimerCoil(name) => (name, true),
            _ => return,
        };
        let known = system::call_on_data(call).is_some() || matches!(call, "R_TRIG" | "F_TRIG");
        if !known {
            return self.refuse(span, format!("IEC 61131-3 has no function block `{call}`"));
        }
        let instance = match (instance, element.pin("timer").map(|pin| &pin.value)) {
            (Some(instance), _) | (None, Some(PinValue::Operand(instance))) => instance,
            _ => return self.refuse(span, format!("`{call}` without an instance")),
        };
        let Some((text, ty)) = self.instance_of(instance, call, span) else { return };
        if ty != call && ty.split('_').next() != Some(call) {
            return self.refuse(span, format!("an instance of {ty} is called as {call}"));
        }
        let mut inputs: Vec<(&Pin, String)> = Vec::new();
        let mut outputs: Vec<(&Pin, String)> = Vec::new();
        for pin in &element.pins {
            let name = pin.name.to_uppercase();
            match name.as_str() {
                "EN" | "ENO" | "TIMER" => {}
                "OUT" if is_coil => {}
                _ if pin.output => outputs.push((pin, name)),
                _ => inputs.push((pin, name)),
            }
        }
        // The flow is the first line of the block.
        inputs.sort_by_key(|(pin, _)| pin.name != row.flow.0);
        outputs.sort_by_key(|(pin, _)| pin.name != row.flow.1);
        let mut object = Object { instance: Some(text), ..Object::new(Kind::Block, ty) };
        object.inputs = self.inputs(&inputs);
        if is_coil && let Some(first) = object.inputs.first() {
            let from = first.from.clone();
            self.set(at, "out", from);
        }
        self.block(at, element, object, &outputs, true);
    }

    /// The text of an instance, and its type in the file.
    fn instance_of(&mut self, instance: &Expr, call: &str, span: Span) -> Option<(String, String)> {
        // Data of any timer are called by its name.
        let member =
            plcc_syntax::scl::ast::Name { text: call.to_string(), form: plcc_syntax::scl::ast::NameForm::Bare, span };
        let named = Expr { kind: ExprKind::Member { base: Box::new(instance.clone()), name: member }, span };
        let is_data = system::call_on_data(call).is_some();
        match self.body.called(if is_data { &named } else { instance }) {
            Called::Instance { instance, ty, .. } => {
                Some((crate::scl::expression::text(&instance, self.body.writer), ty))
            }
            Called::Function(..) | Called::System(_) => {
                self.refuse(span, format!("`{call}` needs an instance"));
                None
            }
            Called::Refused => None,
        }
    }

    /// The inputs that an element converts must already have its type.
    fn check_types(&mut self, element: &Element, pins: &[&str]) {
        let Some(template) = element.template(TemplateKey::Source).or(element.template(TemplateKey::Value)) else {
            return;
        };
        let Some(wanted) = elementary(&template.value) else { return };
        let mut is_there = false;
        let mut others: Option<String> = None;
        for name in pins {
            let Some(pin) = element.pin(name) else { continue };
            let ty = match &pin.value {
                PinValue::Operand(value) if is_constant(value) => continue,
                PinValue::Operand(value) => self.body.elementary(value),
                PinValue::Net(id) => self.net_type(*id),
                PinValue::Open => continue,
            };
            match ty {
                Some(ty) if ty == wanted => is_there = true,
                Some(ty) => others = Some(ty.name().to_string()),
                None => others = Some("a type that the sources do not show".to_string()),
            }
        }
        if let (false, Some(other)) = (is_there, others) {
            let title = format!("this element converts its operands from {other} to {}", wanted.name());
            self.body.refuse(element.span, title, "convert them with a box of their own before it");
        }
    }

    /// The type of a value that a box has computed.
    fn net_type(&self, id: NetId) -> Option<Elementary> {
        let source = self.graph.net(id).sources.first()?;
        match source {
            Source::Rail => Some(Elementary::Bool),
            Source::Operand { value, .. } => self.body.elementary(value),
            Source::Net(_) => None,
            Source::Pin { element, .. } => {
                let element = &self.graph.elements[*element];
                let template = [TemplateKey::Destination, TemplateKey::Value, TemplateKey::Source]
                    .into_iter()
                    .find_map(|key| element.template(key));
                elementary(&template?.value)
            }
        }
    }

    /// A box with a function of the standard.
    fn function(&mut self, at: usize, element: &Element, row: &'static plcc_syntax::network::elements::Row) {
        let span = element.span;
        let template = |key: TemplateKey| element.template(key).and_then(|template| elementary(&template.value));
        let operand_type = |build: &Self, pin: &str| match element.pin(pin).map(|pin| &pin.value) {
            Some(PinValue::Operand(value)) => build.body.elementary(value),
            Some(PinValue::Net(id)) => build.net_type(*id),
            _ => None,
        };
        let outputs: Vec<&Pin> =
            element.pins.iter().filter(|pin| pin.output && pin.name != "eno" && pin.name != "operand").collect();
        let converted = |build: &Self, infix: &str| -> Result<String, String> {
            let from = template(TemplateKey::Source).or_else(|| operand_type(build, "in"));
            let to = template(TemplateKey::Destination).or_else(|| operand_type(build, "out"));
            match (from, to) {
                (Some(from), Some(to)) if from == to => Ok("MOVE".to_string()),
                (Some(from), Some(to)) => {
                    system::conversion(from, to).map(|()| format!("{}{infix}{}", from.name(), to.name()))
                }
                _ => Err("a conversion whose types the sources do not show".to_string()),
            }
        };
        let name = match row.kind {
            Row::Convert => converted(self, "_TO_"),
            Row::Round("ROUND") => converted(self, "_TO_"),
            Row::Round("TRUNC") => converted(self, "_TRUNC_"),
            Row::Operator(sign) if row.name.eq_ignore_ascii_case(sign) && row.open.is_empty() => Ok(sign.to_string()),
            Row::Invert => Ok("NOT".to_string()),
            Row::Negate => Ok("MUL".to_string()),
            Row::Step { up } => Ok(if up { "ADD" } else { "SUB" }.to_string()),
            Row::Mux if element.pin("else").is_some_and(|pin| !matches!(pin.value, PinValue::Open)) => {
                Err("MUX of IEC 61131-3 has no ELSE".to_string())
            }
            _ => match row.open.first() {
                Some(name) => Ok((*name).to_string()),
                None => Err(format!("IEC 61131-3 has no function for `{}`", row.name)),
            },
        };
        let name = match name {
            Ok(name) => name,
            Err(reason) => return self.refuse(span, reason),
        };
        let pins: Vec<&Pin> =
            element.pins.iter().filter(|pin| !pin.output && pin.name != "en" && pin.name != "operand").collect();
        if matches!(row.kind, Row::Operator(_) | Row::Function(_)) {
            let names: Vec<&str> =
                pins.iter().map(|pin| pin.name.as_str()).filter(|name| row.typing.converts(name)).collect();
            self.check_types(element, &names);
        }
        let mut inputs: Vec<(&Pin, String)> = pins.iter().map(|pin| (*pin, pin.name.to_uppercase())).collect();
        if let [(_, formal)] = inputs.as_mut_slice() {
            *formal = "IN".to_string();
        }
        let mut object = Object::new(Kind::Block, name);
        object.inputs = self.inputs(&inputs);
        let constant = |build: &mut Self, text: &str, formal: &str| {
            let from = build.in_variable(text.to_string(), false);
            Input { formal: formal.to_string(), from, negated: false, in_out: false }
        };
        let mut outputs: Vec<(&Pin, String)> = outputs.into_iter().map(|pin| (pin, "OUT".to_string())).collect();
        match row.kind {
            Row::Negate => {
                let is_float = match template(TemplateKey::Source).or_else(|| operand_type(self, "in")) {
                    Some(Elementary::Real | Elementary::Lreal) => true,
                    Some(ty) if ty.is_integer() => false,
                    _ => return self.refuse(span, "a negation whose type the sources do not show"),
                };
                object.inputs.iter_mut().for_each(|input| input.formal = "IN1".to_string());
                let factor = constant(self, if is_float { "-1.0" } else { "-1" }, "IN2");
                object.inputs.push(factor);
            }
            Row::Step { .. } => {
                let Some(pin) = element.pin("operand") else { return };
                let from = self.value(Some(pin));
                object.inputs.push(Input { formal: "IN1".to_string(), from, negated: false, in_out: false });
                let one = constant(self, "1", "IN2");
                object.inputs.push(one);
                outputs.push((pin, "OUT".to_string()));
            }
            _ => {}
        }
        self.block(at, element, object, &outputs, false);
    }

    /// A call of a block of the program.
    fn call(&mut self, at: usize, element: &Element, callee: &Expr, instance: Option<&Expr>) {
        let span = element.span;
        let called = match instance {
            Some(instance) => self.body.called(instance),
            None => self.body.called(callee),
        };
        let (mut object, block): (Object, Option<&'a CodeBlock>) = match called {
            Called::Function(block, name) => (Object::new(Kind::Block, name), Some(block)),
            Called::Instance { instance, ty, block } => {
                let text = crate::scl::expression::text(&instance, self.body.writer);
                (Object { instance: Some(text), ..Object::new(Kind::Block, ty) }, block)
            }
            Called::System(name) => {
                return self.refuse(span, format!("IEC 61131-3 has no block `{}`", name.text));
            }
            Called::Refused => return,
        };
        let section = |name: &str| {
            let has = |section: &&plcc_syntax::ast::Section| {
                section.variables.iter().any(|variable| variable.name.eq_ignore_ascii_case(name))
            };
            block.and_then(|block| block.sections.iter().find(has)).map(|section| section.kind)
        };
        let mut inputs: Vec<(&Pin, String)> = Vec::new();
        let mut outputs: Vec<(&Pin, String)> = Vec::new();
        let mut in_outs: Vec<String> = Vec::new();
        for pin in element.pins.iter().filter(|pin| !matches!(pin.name.as_str(), "en" | "eno")) {
            let formal = if block.is_some() { identifier(&pin.name) } else { pin.name.to_uppercase() };
            match section(&pin.name) {
                Some(SectionKind::InOut) => {
                    in_outs.push(formal.clone());
                    inputs.push((pin, formal));
                }
                Some(SectionKind::Output) => outputs.push((pin, formal)),
                Some(_) => inputs.push((pin, formal)),
                // The result of a function.
                None if pin.output && block.is_some() => outputs.push((pin, "OUT".to_string())),
                None if pin.output => outputs.push((pin, formal)),
                None => inputs.push((pin, formal)),
            }
        }
        object.inputs = self.inputs(&inputs);
        for input in &mut object.inputs {
            input.in_out = in_outs.contains(&input.formal);
        }
        self.block(at, element, object, &outputs, false);
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

fn is_constant(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Literal(_) => true,
        ExprKind::Unary { operand, .. } => is_constant(operand),
        _ => false,
    }
}
