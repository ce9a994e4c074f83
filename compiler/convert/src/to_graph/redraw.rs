//! Networks of LAD in FBD, and of FBD in LAD.
//!
//! Contacts and gates become signals where they have no effect on what is between them and their use; all other elements stay, and get
//! the signals at their pins in the other form. In LAD, each element gets its flow from the power rail.

use std::collections::HashMap;

use plcc_diag::{Code, Diagnostic};
use plcc_syntax::ast::{self, CodeBlock};
use plcc_syntax::network::ast::{Body, Content, Graph, Language, NetId, Network, PinValue, Source, Target};
use plcc_syntax::network::elements::{Gate, Kind};

use super::drawing::{Drawing, Reason, Signal, pin};
use crate::to_stl::plan::{Plan, is_pure};

/// A block whose networks of LAD and FBD are in `language`; those of SCL and STL stay.
pub fn block(block: &CodeBlock, language: Language) -> Result<CodeBlock, Vec<Diagnostic>> {
    let ast::Code::Graphic(body) = &block.code else { return Ok(block.clone()) };
    let mut messages = Vec::new();
    let mut networks = Vec::new();
    for network in &body.networks {
        match redrawn(network, language) {
            Ok(network) => networks.push(network),
            Err(reason) => {
                let name = if language == Language::Fbd { "FBD" } else { "LAD" };
                let title = format!("{name} has no form for {reason}");
                messages.push(
                    Diagnostic::new(Code::NotConverted, network.span, title)
                        .label("in this network")
                        .help("leave the network in its language, or store a part of it in a bit"),
                );
            }
        }
    }
    match messages.is_empty() {
        true => Ok(CodeBlock { code: ast::Code::Graphic(Body { networks }), ..block.clone() }),
        false => Err(messages),
    }
}

fn redrawn(network: &Network, language: Language) -> Result<Network, Reason> {
    let Content::Graphic(graph) = &network.content else { return Ok(network.clone()) };
    if network.language == language {
        return Ok(network.clone());
    }
    if graph.broken {
        return Err("a network that was not understood".to_string());
    }
    let graph = Redrawer::new(graph, language, network).all()?;
    Ok(Network { language, content: Content::Graphic(graph), ..network.clone() })
}

struct Redrawer<'g> {
    graph: &'g Graph,
    is_ladder: bool,
    plan: Plan,
    drawing: Drawing,
    /// Signals of outputs, by element and pin.
    outputs: HashMap<(usize, usize), Signal>,
    /// Nets with several users, which are drawn once.
    kept: HashMap<NetId, Signal>,
}

impl<'g> Redrawer<'g> {
    fn new(graph: &'g Graph, language: Language, network: &Network) -> Redrawer<'g> {
        let drawing = Drawing::new(language, network.span);
        Redrawer {
            is_ladder: language == Language::Lad,
            graph,
            plan: Plan::new(graph),
            drawing,
            outputs: HashMap::new(),
            kept: HashMap::new(),
        }
    }

    fn all(mut self) -> Result<Graph, Reason> {
        for at in self.plan.order.clone() {
            self.drawing.at(self.graph.elements[at].span);
            if is_pure(&self.graph.elements[at]) {
                self.pure(at)?;
            } else {
                self.effect(at)?;
            }
        }
        Ok(self.drawing.graph)
    }

    fn pure(&mut self, at: usize) -> Result<(), Reason> {
        let element = &self.graph.elements[at];
        let used = element
            .pins
            .iter()
            .any(|pin| matches!(pin.value, PinValue::Net(net) if pin.output && self.plan.is_used(net)));
        if !used {
            return Ok(());
        }
        let mut signal = self.meaning(at)?;
        if !self.plan.inline[at] {
            signal = self.drawn(signal)?;
        }
        for (index, pin) in element.pins.iter().enumerate().filter(|(_, pin)| pin.output) {
            self.outputs.insert((at, index), if pin.negated { signal.clone().inverted() } else { signal.clone() });
        }
        Ok(())
    }

    /// A signal that is evaluated here.
    fn drawn(&mut self, signal: Signal) -> Result<Signal, Reason> {
        if matches!(signal, Signal::Constant(_) | Signal::Net(_)) {
            return Ok(signal);
        }
        Ok(match self.drawing.input("in", &signal)? {
            Some(found) => match (found.value, found.negated) {
                (PinValue::Net(net), false) => Signal::Net(net),
                (PinValue::Net(net), true) => Signal::Net(net).inverted(),
                // FBD reads an operand where it is used: a gate holds what it was.
                (value, negated) => Signal::Net(self.drawing.held(value, negated)),
            },
            None => signal,
        })
    }

    fn meaning(&mut self, at: usize) -> Result<Signal, Reason> {
        let element = &self.graph.elements[at];
        let Target::Element { row, .. } = &element.target else { return Err("this element".to_string()) };
        Ok(match row.kind {
            Kind::Contact => {
                let flow = self.input(at, "in")?;
                Signal::and(vec![flow, self.input(at, "operand")?])
            }
            Kind::Not => self.input(at, "in")?.inverted(),
            Kind::Gate(gate) => {
                let mut list = Vec::new();
                for pin in element.pins.iter().filter(|pin| !pin.output && pin.value != PinValue::Open) {
                    list.push(self.input(at, &pin.name)?);
                }
                match gate {
                    Gate::And => Signal::and(list),
                    Gate::Or => Signal::or(list),
                    Gate::Xor => Signal::Xor(list),
                }
            }
            // A comparison or a status bit: an element of both languages, after what leads to it.
            _ => {
                let flow = self.input(at, "pre")?;
                let own = if self.is_ladder { self.in_branch(at)? } else { self.copy(at, Some("pre"))? };
                Signal::and(vec![own, flow])
            }
        })
    }

    /// A comparison or a status bit of operands, which stands in a branch.
    fn in_branch(&mut self, at: usize) -> Result<Signal, Reason> {
        let element = &self.graph.elements[at];
        let mut own = element.clone();
        own.pins.retain(|pin| !pin.output && pin.name != "pre");
        if own.pins.iter().any(|pin| matches!(pin.value, PinValue::Net(_)) || pin.negated) {
            return Err("a comparison of the result of a box".to_string());
        }
        Ok(Signal::Element(Box::new(own)))
    }

    /// The value of an input; TRUE if it is open.
    fn input(&mut self, at: usize, name: &str) -> Result<Signal, Reason> {
        let Some(pin) = self.graph.elements[at].pin(name) else { return Ok(Signal::Constant(true)) };
        let signal = match &pin.value {
            PinValue::Net(net) => self.net(*net)?,
            PinValue::Operand(value) => Signal::Operand(value.clone()),
            PinValue::Open => Signal::Constant(true),
        };
        Ok(if pin.negated { signal.inverted() } else { signal })
    }

    fn net(&mut self, net: NetId) -> Result<Signal, Reason> {
        if let Some(known) = self.kept.get(&net) {
            return Ok(known.clone());
        }
        let mut list = Vec::new();
        for source in &self.graph.net(net).sources {
            list.push(match source {
                Source::Rail => Signal::Constant(true),
                Source::Pin { element, pin } => match self.outputs.get(&(*element, *pin)) {
                    Some(signal) => signal.clone(),
                    None => return Err("a loop of wires".to_string()),
                },
                Source::Operand { value, negated } => {
                    let signal = Signal::Operand(value.clone());
                    if *negated { signal.inverted() } else { signal }
                }
                Source::Net(other) => self.net(*other)?,
            });
        }
        let signal = Signal::or(list);
        if self.readers(net) > 1 {
            let signal = self.drawn(signal)?;
            self.kept.insert(net, signal.clone());
            return Ok(signal);
        }
        Ok(signal)
    }

    /// An element that stays, with new connections of its pins.
    fn effect(&mut self, at: usize) -> Result<(), Reason> {
        self.copy(at, None).map(drop)
    }

    /// Copies an element, without the input `leave`; the signal of its first output.
    fn copy(&mut self, at: usize, leave: Option<&str>) -> Result<Signal, Reason> {
        let element = &self.graph.elements[at];
        let flow = crate::to_stl::plan::flow_pin(element).map(|pin| pin.name.clone());
        let mut pins = Vec::new();
        if self.is_ladder
            && let Some(flow) = flow.as_deref().filter(|flow| element.pin(flow).is_none())
        {
            // Without EN, a box always runs.
            pins.extend(self.drawing.input(flow, &Signal::Constant(true))?);
        }
        for old in element.pins.iter().filter(|pin| !pin.output && Some(pin.name.as_str()) != leave) {
            let is_flow = flow.as_deref() == Some(old.name.as_str());
            let signal = match old.value {
                PinValue::Net(net) => {
                    let signal = self.net(net)?;
                    if old.negated { signal.inverted() } else { signal }
                }
                // LAD has contacts for them.
                PinValue::Operand(_) | PinValue::Open if self.is_ladder && (is_flow || old.negated) => {
                    self.input(at, &old.name)?
                }
                PinValue::Operand(_) | PinValue::Open => {
                    pins.push(old.clone());
                    continue;
                }
            };
            let new = match &signal {
                Signal::Net(net) => Some(pin(&old.name, PinValue::Net(*net), false, false, old.span)),
                signal if is_flow => self.drawing.input(&old.name, signal)?,
                signal => Some(self.drawing.side_input(&old.name, signal)?),
            };
            // An element of FBD without a flow needs none, except those that have nothing else.
            match (new, &element.target) {
                (Some(new), _) => pins.push(new),
                (None, Target::Element { row, .. }) if !row.is_box() => {
                    pins.push(self.drawing.side_input(&old.name, &signal)?)
                }
                (None, _) => {}
            }
        }
        self.drawing.graph.elements.push(plcc_syntax::network::ast::Element { pins, ..element.clone() });
        let new = self.drawing.graph.elements.len() - 1;
        let mut first = None;
        for (index, old) in element.pins.iter().enumerate().filter(|(_, pin)| pin.output) {
            let PinValue::Net(net) = old.value else {
                self.drawing.graph.elements[new].pins.push(old.clone());
                continue;
            };
            if leave.is_none() && self.readers(net) == 0 {
                continue;
            }
            if old.negated {
                return Err("an inverted output".to_string());
            }
            let signal = Signal::Net(self.drawing.output(new, &old.name, None));
            first.get_or_insert(signal.clone());
            self.outputs.insert((at, index), signal);
        }
        Ok(first.unwrap_or(Signal::Constant(true)))
    }

    /// Inputs that read the net itself, and nets that it feeds.
    fn readers(&self, net: NetId) -> usize {
        let pins = self.graph.elements.iter().flat_map(|element| &element.pins);
        let pins = pins.filter(|pin| !pin.output && pin.value == PinValue::Net(net)).count();
        let sources = self.graph.nets.iter().flat_map(|net| &net.sources);
        pins + sources.filter(|source| **source == Source::Net(net)).count()
    }
}
