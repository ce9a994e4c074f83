//! Networks of LAD and FBD, second half: wires to nets, and the elements in the order of evaluation.
//!
//! Branches of LAD join in a part `O`; in the syntax tree they are a net with several sources, as in the other file formats.

use super::order;
use super::parts::{End, Part, Parts};
use plcc_syntax::network::ast::{Element, Graph, Language, NetId, Pin, PinValue, Source, Storage, Target};
use plcc_syntax::network::elements::{Kind, PinDirection};
use plcc_syntax::scl::ast::Expr;

/// The ends of wires, for code that follows the flow.
pub struct Wiring {
    /// For each part: the wires at its pins, as (pin, wire, is output).
    pub pins: Vec<Vec<(String, usize, bool)>>,
    /// For each part: whether it is a join of branches rather than an element.
    pub joins: Vec<bool>,
}

impl Wiring {
    fn of(parts: &Parts, language: Language) -> Wiring {
        let mut pins: Vec<Vec<(String, usize, bool)>> = parts.parts.iter().map(|_| Vec::new()).collect();
        for (at, wire) in parts.wires.iter().enumerate() {
            for end in &wire.ends {
                if let End::Pin { part, name, output, .. } = end {
                    pins[*part].push((name.clone(), at, *output));
                }
            }
        }
        let joins = parts
            .parts
            .iter()
            .zip(&pins)
            .map(|(part, pins)| language == Language::Lad && is_join(part, pins, parts))
            .collect();
        Wiring { pins, joins }
    }

    /// The wire that leaves a join.
    fn output(&self, part: usize) -> Option<usize> {
        self.pins[part].iter().find(|(_, _, output)| *output).map(|(_, wire, _)| *wire)
    }
}

/// Whether an `O` of LAD joins branches: only flow enters and leaves it.
fn is_join(part: &Part, pins: &[(String, usize, bool)], parts: &Parts) -> bool {
    part.is_or()
        && part.negated.is_empty()
        && pins.iter().filter(|(_, _, output)| *output).count() == 1
        && pins.iter().all(|(_, wire, _)| !parts.wires[*wire].ends.iter().any(|end| matches!(end, End::Operand(_))))
}

/// Builds the graph of a network.
pub fn build(parts: Parts, language: Language) -> Graph {
    let wiring = Wiring::of(&parts, language);
    let order = order::order(&parts, &wiring, language);
    let mut builder = Builder {
        places: vec![None; parts.parts.len()],
        nets: vec![None; parts.wires.len()],
        graph: Graph::default(),
        parts,
        wiring,
        rail: None,
        pending: Vec::new(),
    };
    for (at, part) in order.iter().enumerate() {
        builder.places[*part] = Some(at);
    }
    for part in &order {
        let element = builder.element(*part);
        builder.graph.elements.push(element);
    }
    builder.sources();
    builder.graph
}

struct Builder {
    parts: Parts,
    wiring: Wiring,
    /// For each part: the index of its element.
    places: Vec<Option<usize>>,
    /// For each wire: its net, once a pin has needed it.
    nets: Vec<Option<NetId>>,
    rail: Option<NetId>,
    /// Wires whose nets have no sources yet.
    pending: Vec<usize>,
    graph: Graph,
}

impl Builder {
    /// The net of a wire. All wires of the power rail are one net. A wire that only enters a join has the net of the join.
    fn net(&mut self, wire: usize) -> NetId {
        let wire = self.through_joins(wire);
        if let Some(net) = self.nets[wire] {
            return net;
        }
        let span = self.parts.wires[wire].span;
        let is_rail = self.parts.wires[wire].ends.contains(&End::Rail);
        let net = match self.rail {
            Some(rail) if is_rail => rail,
            _ => {
                self.pending.push(wire);
                self.graph.add_net("", span)
            }
        };
        if is_rail {
            self.rail = Some(net);
        }
        self.nets[wire] = Some(net);
        net
    }

    /// Follows a wire whose only consumer is a join to the wire that leaves the join.
    fn through_joins(&self, wire: usize) -> usize {
        let mut wire = wire;
        for _ in 0..self.parts.wires.len() {
            match self.only_join(wire).and_then(|join| self.wiring.output(join)) {
                Some(next) => wire = next,
                None => break,
            }
        }
        wire
    }

    /// The join that is the only consumer of a wire. The rail is a separate net.
    fn only_join(&self, wire: usize) -> Option<usize> {
        let ends = &self.parts.wires[wire].ends;
        if ends.contains(&End::Rail) {
            return None;
        }
        let mut consumers = ends.iter().filter(|end| matches!(end, End::Pin { output: false, .. } | End::Operand(_)));
        match (consumers.next(), consumers.next()) {
            (Some(End::Pin { part, .. }), None) if self.wiring.joins[*part] => Some(*part),
            _ => None,
        }
    }

    fn element(&mut self, at: usize) -> Element {
        let mut pins = self.pins(at);
        self.open_pins(at, &mut pins);
        let part = &self.parts.parts[at];
        pins.sort_by_key(|pin| part.place(&pin.name));
        Element {
            target: part.target.clone(),
            templates: part.templates.clone(),
            eno: part.eno,
            pins,
            equation: part.equation.clone(),
            cases: part.cases.clone(),
            span: part.span,
        }
    }

    /// The pins that something is wired to.
    fn pins(&mut self, at: usize) -> Vec<Pin> {
        let mut pins = Vec::new();
        let wires: Vec<usize> = self.wiring.pins[at].iter().map(|(_, wire, _)| *wire).collect();
        let mut seen = Vec::new();
        for wire in wires {
            if seen.contains(&wire) {
                continue;
            }
            seen.push(wire);
            let ends = self.parts.wires[wire].ends.clone();
            for end in &ends {
                let End::Pin { part, name, output, span } = end else { continue };
                if *part != at {
                    continue;
                }
                let negated = self.parts.parts[at].negated.contains(name);
                let pin = |value| Pin {
                    name: name.clone(),
                    value,
                    negated,
                    output: *output,
                    storage: Storage::None,
                    span: *span,
                };
                let operands = ends.iter().filter_map(|end| match end {
                    End::Operand(uid) => self.parts.operands.get(uid).cloned(),
                    _ => None,
                });
                let mut operands: Vec<Expr> = operands.collect();
                if *output {
                    let before = pins.len();
                    pins.extend(operands.drain(..).map(|operand| pin(PinValue::Operand(operand))));
                    if ends.iter().any(|end| matches!(end, End::Pin { output: false, .. })) {
                        pins.push(pin(PinValue::Net(self.net(wire))));
                    }
                    if pins.len() == before && self.may_stay_open(at, name) {
                        pins.push(pin(PinValue::Open));
                    }
                } else if ends.iter().any(|end| matches!(end, End::Rail | End::Pin { output: true, .. })) {
                    pins.push(pin(PinValue::Net(self.net(wire))));
                } else if let Some(operand) = operands.pop() {
                    pins.push(pin(PinValue::Operand(operand)));
                } else {
                    pins.push(pin(PinValue::Open));
                }
            }
        }
        pins
    }

    /// Whether the pin is an output of a function, which the editor shows without an operand: its value is not needed.
    fn may_stay_open(&self, at: usize, name: &str) -> bool {
        let part = &self.parts.parts[at];
        let is_function = matches!(part.target, Target::Block { instance: None, .. });
        is_function && name != part.flow().1 && !name.eq_ignore_ascii_case("RET_VAL")
    }

    /// Open pins that may be open are left out; the others are shown.
    fn open_pins(&self, at: usize, pins: &mut Vec<Pin>) {
        let part = &self.parts.parts[at];
        let Some(row) = part.row() else {
            return pins.retain(|pin| pin.value != PinValue::Open || pin.output);
        };
        pins.retain(|pin| pin.value != PinValue::Open || row.pin(&pin.name).is_some_and(|(known, _)| !known.optional));
        for known in row.pins().filter(|known| !known.optional) {
            let output = known.direction == PinDirection::Output;
            let count = match row.kind {
                Kind::Gate(_) if known.numbered => part.card.unwrap_or(2).clamp(1, 256),
                _ if known.numbered => continue,
                _ => 1,
            };
            // The flow output is there only if something consumes it.
            if known.name() == row.flow.1 {
                continue;
            }
            for number in 0..count {
                let name = match known.numbered {
                    true => format!("{}{}", known.name().trim_end_matches(|c: char| c.is_ascii_digit()), number + 1),
                    false => known.name().to_string(),
                };
                if !pins.iter().any(|pin| pin.name == name) {
                    let negated = part.negated.contains(&name);
                    let value = PinValue::Open;
                    pins.push(Pin { name, value, negated, output, storage: Storage::None, span: part.span });
                }
            }
        }
    }

    /// Gives each net its sources.
    fn sources(&mut self) {
        while let Some(wire) = self.pending.pop() {
            if let Some(net) = self.nets[wire] {
                self.graph.nets[net.0 as usize].sources = self.sources_of(wire, 0);
            }
        }
    }

    /// What feeds a wire.
    fn sources_of(&mut self, wire: usize, depth: usize) -> Vec<Source> {
        let mut sources = Vec::new();
        for end in self.parts.wires[wire].ends.clone() {
            match end {
                End::Rail => sources.push(Source::Rail),
                End::Pin { part, output: true, .. } if self.wiring.joins[part] => {
                    self.join_sources(part, depth, &mut sources);
                }
                End::Pin { part, name, output: true, .. } => {
                    let Some(element) = self.places[part] else { continue };
                    let pins = &self.graph.elements[element].pins;
                    let net = |pin: &Pin| pin.name == name && matches!(pin.value, PinValue::Net(_));
                    if let Some(pin) = pins.iter().position(net) {
                        sources.push(Source::Pin { element, pin });
                    }
                }
                _ => {}
            }
        }
        sources
    }

    /// What enters a join, in the order of its pins.
    fn join_sources(&mut self, join: usize, depth: usize, sources: &mut Vec<Source>) {
        let mut inputs: Vec<(String, usize)> = self.wiring.pins[join]
            .iter()
            .filter(|(_, _, output)| !output)
            .map(|(name, wire, _)| (name.clone(), *wire))
            .collect();
        inputs.sort_by_key(|(name, _)| self.parts.parts[join].place(name));
        for (_, wire) in inputs {
            if self.parts.wires[wire].ends.contains(&End::Rail) {
                sources.push(Source::Rail);
            } else if self.only_join(wire).is_some() && depth < self.parts.wires.len().min(DEPTH_MAX) {
                sources.extend(self.sources_of(wire, depth + 1));
            } else {
                sources.push(Source::Net(self.net(wire)));
            }
        }
    }
}

/// How deep joins may be nested.
const DEPTH_MAX: usize = 128;
