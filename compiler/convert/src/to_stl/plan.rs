//! Which values of a network stay in the RLO until they are used, and which need a bit of their own.
//!
//! A contact, gate or comparison has no effect, so it can be evaluated where its value is used, as long as nothing between its own place
//! and that one has an effect. Coils leave the RLO as it is: one after the other they share it.

use std::collections::HashMap;

use plcc_syntax::network::ast::{Element, Graph, NetId, PinValue, Source, Target};
use plcc_syntax::network::elements::Kind;
use plcc_syntax::network::order::order;

/// The plan for a network.
pub struct Plan {
    /// Elements in the order in which they run.
    pub order: Vec<usize>,
    /// Place of each element in the order.
    pub place: Vec<usize>,
    /// Evaluated where its value is used.
    pub inline: Vec<bool>,
    /// Nets after coils, with the net before them.
    same: HashMap<NetId, NetId>,
    uses: HashMap<NetId, Uses>,
}

#[derive(Default)]
struct Uses {
    /// Elements that read the net.
    by: Vec<usize>,
    /// Another net reads it.
    by_net: bool,
}

impl Plan {
    pub fn new(graph: &Graph) -> Plan {
        let order = order(graph);
        let mut place = vec![0; graph.elements.len()];
        order.iter().enumerate().for_each(|(at, element)| place[*element] = at);
        let inline = vec![false; graph.elements.len()];
        let mut plan = Plan { order, place, inline, same: HashMap::new(), uses: HashMap::new() };
        plan.find_same(graph);
        plan.find_uses(graph);
        for at in (0..plan.order.len()).rev() {
            let element = plan.order[at];
            if is_pure(&graph.elements[element]) {
                let root = plan.root(graph, element);
                plan.inline[element] = root.is_some_and(|root| {
                    plan.order[at + 1..root.max(at + 1)].iter().all(|between| is_pure(&graph.elements[*between]))
                });
            }
        }
        plan
    }

    /// The net whose value this one has, before coils.
    pub fn canonical(&self, net: NetId) -> NetId {
        let mut net = net;
        while let Some(before) = self.same.get(&net) {
            net = *before;
        }
        net
    }

    /// A coil passes its flow on.
    fn find_same(&mut self, graph: &Graph) {
        for &element in &self.order {
            if !is_coil(&graph.elements[element]) {
                continue;
            }
            let (Some(before), Some(after)) = (flow_net(graph, element), out_net(graph, element)) else { continue };
            if graph.net(after).sources.len() == 1 && self.canonical(before) != after {
                self.same.insert(after, self.canonical(before));
            }
        }
    }

    fn find_uses(&mut self, graph: &Graph) {
        for &element in &self.order {
            for pin in graph.elements[element].pins.iter().filter(|pin| !pin.output) {
                if let PinValue::Net(net) = pin.value {
                    let net = self.canonical(net);
                    self.uses.entry(net).or_default().by.push(element);
                }
            }
        }
        for net in &graph.nets {
            for source in &net.sources {
                if let Source::Net(other) = source {
                    let other = self.canonical(*other);
                    self.uses.entry(other).or_default().by_net = true;
                }
            }
        }
    }

    /// Coils one after the other, and nothing else, read the net: the first of them.
    fn run_of_coils(&self, graph: &Graph, net: NetId) -> Option<usize> {
        let uses = self.uses.get(&net)?;
        let first = *uses.by.first()?;
        let coils = uses.by.iter().all(|element| is_coil(&graph.elements[*element]));
        let places = uses.by.iter().map(|element| self.place[*element]);
        let together = places.enumerate().all(|(at, place)| place == self.place[first] + at);
        (!uses.by_net && coils && together).then_some(first)
    }

    /// Nothing but one element, or coils one after the other, reads the net: the first of them.
    pub fn only_user(&self, graph: &Graph, net: NetId) -> Option<usize> {
        let net = self.canonical(net);
        match self.uses.get(&net) {
            Some(Uses { by, by_net: false }) if by.len() == 1 => by.first().copied(),
            _ => self.run_of_coils(graph, net),
        }
    }

    /// Something reads the net.
    pub fn is_used(&self, net: NetId) -> bool {
        self.uses.get(&self.canonical(net)).is_some_and(|uses| !uses.by.is_empty() || uses.by_net)
    }

    /// Whatever reads the net runs only if the box `element` does.
    pub fn is_guarded(&self, graph: &Graph, net: NetId, element: usize) -> bool {
        let Some(uses) = self.uses.get(&self.canonical(net)) else { return true };
        !uses.by_net && uses.by.iter().all(|user| follows(graph, *user, element))
    }

    /// The net must be in a variable of its own after its last source.
    pub fn is_kept(&self, graph: &Graph, net: NetId) -> bool {
        self.is_used(net) && self.only_user(graph, net).is_none()
    }

    /// The place where an element without effect would be evaluated if its value stayed in the RLO.
    fn root(&self, graph: &Graph, element: usize) -> Option<usize> {
        let net = out_net(graph, element)?;
        match self.only_user(graph, net) {
            Some(user) if self.inline[user] => self.root(graph, user),
            Some(user) => Some(self.place[user]),
            None if self.is_used(net) => self.last_source(graph, net),
            None => None,
        }
    }

    /// Place of the last element that feeds the net.
    pub fn last_source(&self, graph: &Graph, net: NetId) -> Option<usize> {
        let feeders = graph.net(net).sources.iter().filter_map(|source| match source {
            Source::Pin { element, .. } => Some(self.place[*element]),
            Source::Rail | Source::Operand { .. } | Source::Net(_) => None,
        });
        feeders.max()
    }

    /// The output of `element` is the first thing that the code after it reads, so that it can stay in the RLO.
    pub fn continues(&self, graph: &Graph, element: usize) -> bool {
        let (mut element, mut at) = (element, self.place[element]);
        loop {
            let Some(net) = out_net(graph, element) else { return false };
            let user = match (graph.net(net).sources.len(), self.only_user(graph, net)) {
                (1, Some(user)) => user,
                _ => return false,
            };
            let next = &graph.elements[user];
            let leads =
                flow_pin(next).is_some_and(|pin| matches!(pin.value, PinValue::Net(own) if own == net) && !pin.negated);
            if !leads || self.place[user] != at + 1 {
                return false;
            }
            if !self.inline[user] {
                return begins_with_flow(next);
            }
            let Target::Element { row, .. } = &next.target else { return false };
            if row.kind != Kind::Contact {
                return false;
            }
            (element, at) = (user, at + 1);
        }
    }
}

/// The flow of `user` is ENO of the box `element`, also by way of contacts, coils and other boxes.
fn follows(graph: &Graph, user: usize, element: usize) -> bool {
    let mut user = user;
    // A loop of wires ends as well.
    for _ in 0..graph.elements.len() {
        let Some(pin) = flow_pin(&graph.elements[user]).filter(|pin| !pin.negated) else { return false };
        let PinValue::Net(net) = pin.value else { return false };
        let [Source::Pin { element: before, pin }] = graph.net(net).sources[..] else { return false };
        let passes = &graph.elements[before];
        if !lets_pass(passes) || passes.pins[pin].negated || out_net(graph, before) != Some(net) {
            return false;
        }
        if before == element {
            return true;
        }
        user = before;
    }
    false
}

/// No flow leaves the element without entering it.
fn lets_pass(element: &Element) -> bool {
    match &element.target {
        Target::Block { .. } => true,
        Target::Element { row, .. } => {
            row.is_box()
                || matches!(
                    row.kind,
                    Kind::Contact
                        | Kind::Compare(_)
                        | Kind::Range { .. }
                        | Kind::Valid { .. }
                        | Kind::Coil
                        | Kind::SetCoil
                        | Kind::ResetCoil
                        | Kind::Save
                )
        }
    }
}

/// The code of the element begins with its flow.
fn begins_with_flow(element: &Element) -> bool {
    let nets = element.pins.iter().filter(|pin| !pin.output && matches!(pin.value, PinValue::Net(_))).count();
    match &element.target {
        Target::Block { .. } => false,
        Target::Element { row, .. } => {
            nets == 1
                && (row.is_box()
                    || matches!(
                        row.kind,
                        Kind::Coil | Kind::SetCoil | Kind::ResetCoil | Kind::Save | Kind::EdgeTrigger { .. }
                    ))
        }
    }
}

/// It has a value and does nothing else.
pub fn is_pure(element: &Element) -> bool {
    let Target::Element { row, instance: None } = &element.target else { return false };
    let pure = matches!(row.kind, Kind::Contact | Kind::Not | Kind::Gate(_) | Kind::Compare(_) | Kind::Flag(_));
    pure && element.pins.iter().filter(|pin| pin.output).all(|pin| !matches!(pin.value, PinValue::Operand(_)))
}

/// It leaves the RLO as it was.
pub fn is_coil(element: &Element) -> bool {
    let Target::Element { row, .. } = &element.target else { return false };
    matches!(row.kind, Kind::Coil | Kind::SetCoil | Kind::ResetCoil | Kind::Save)
        && flow_pin(element).is_some_and(|pin| !pin.negated)
}

pub fn flow_pin(element: &Element) -> Option<&plcc_syntax::network::ast::Pin> {
    match &element.target {
        Target::Element { row, .. } => element.pin(row.pin(row.flow.0)?.0.name()),
        Target::Block { .. } => element.pin("en"),
    }
}

fn flow_net(graph: &Graph, element: usize) -> Option<NetId> {
    match flow_pin(&graph.elements[element])?.value {
        PinValue::Net(net) => Some(net),
        PinValue::Operand(_) | PinValue::Open => None,
    }
}

/// The net that the flow of an element goes into; none if there are several, or none.
pub fn out_net(graph: &Graph, element: usize) -> Option<NetId> {
    let element = &graph.elements[element];
    let name = match &element.target {
        Target::Element { row, .. } => row.pin(row.flow.1)?.1,
        Target::Block { .. } => "eno".to_string(),
    };
    let mut nets = element.pins.iter().filter(|pin| pin.output && pin.name.eq_ignore_ascii_case(&name));
    match (nets.next().map(|pin| &pin.value), nets.next()) {
        (Some(PinValue::Net(net)), None) => Some(*net),
        _ => None,
    }
}
