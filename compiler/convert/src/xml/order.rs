//! The order in which a reader of SimaticML finds the elements of a network: it follows the flow, since the file has none.

use plcc_syntax::network::ast::{Element, Language, Target};

/// Parts with their pins, and wires with what they feed.
pub struct Drawing<'a> {
    /// For each part: its element; `None` for a join of branches.
    pub parts: Vec<Option<&'a Element>>,
    /// For each part: pins, wires and whether the part writes them.
    pub pins: Vec<Vec<(String, usize, bool)>>,
    /// For each wire: the parts that read it, in the order of the file.
    pub sinks: Vec<Vec<usize>>,
    /// For each wire: the part that writes it.
    pub sources: Vec<Option<usize>>,
    /// The wire of the power rail.
    pub rail: Option<usize>,
}

impl Drawing<'_> {
    /// The elements in the order in which they are evaluated.
    pub fn order(&self, language: Language) -> Vec<usize> {
        let mut seen = vec![false; self.parts.len()];
        let mut order = Vec::new();
        if language == Language::Lad {
            let first = self.rail.map(|rail| self.sinks[rail].clone()).unwrap_or_default();
            first.into_iter().chain(0..self.parts.len()).for_each(|part| self.forward(part, &mut seen, &mut order));
        } else {
            let is_end =
                |part: &usize| self.pins[*part].iter().all(|(_, wire, output)| !output || self.sinks[*wire].is_empty());
            let ends = (0..self.parts.len()).filter(is_end);
            ends.chain(0..self.parts.len()).for_each(|part| self.backward(part, &mut seen, &mut order));
        }
        order.retain(|part| self.parts[*part].is_some());
        order
    }

    /// A part, then what its outputs feed: the flow first.
    fn forward(&self, start: usize, seen: &mut [bool], order: &mut Vec<usize>) {
        let mut stack = vec![start];
        while let Some(part) = stack.pop() {
            if std::mem::replace(&mut seen[part], true) {
                continue;
            }
            order.push(part);
            let flow = self.flow(part).1;
            let mut outputs: Vec<(&str, usize)> = self.of(part, true);
            outputs.sort_by_key(|(name, _)| (*name != flow, self.place(part, name)));
            let sinks: Vec<usize> = outputs.iter().flat_map(|(_, wire)| self.sinks[*wire].iter().copied()).collect();
            stack.extend(sinks.into_iter().rev());
        }
    }

    /// What feeds a part, in the order of its pins, then the part.
    fn backward(&self, start: usize, seen: &mut [bool], order: &mut Vec<usize>) {
        let mut stack = vec![(start, false)];
        while let Some((part, is_fed)) = stack.pop() {
            if is_fed {
                order.push(part);
                continue;
            }
            if std::mem::replace(&mut seen[part], true) {
                continue;
            }
            stack.push((part, true));
            let mut inputs = self.of(part, false);
            inputs.sort_by_key(|(name, _)| self.place(part, name));
            let sources: Vec<usize> =
                inputs.iter().filter_map(|(_, wire)| self.sources[*wire]).filter(|source| !seen[*source]).collect();
            stack.extend(sources.into_iter().rev().map(|part| (part, false)));
        }
    }

    fn of(&self, part: usize, wanted: bool) -> Vec<(&str, usize)> {
        let pins = self.pins[part].iter().filter(|(_, _, output)| *output == wanted);
        pins.map(|(name, wire, _)| (name.as_str(), *wire)).collect()
    }

    fn flow(&self, part: usize) -> (&'static str, &'static str) {
        match self.parts[part].map(|element| &element.target) {
            Some(Target::Element { row, .. }) => row.flow,
            Some(Target::Block { .. }) => ("en", "eno"),
            None => ("in1", "out"),
        }
    }

    /// The position of a pin among the others.
    fn place(&self, part: usize, name: &str) -> (usize, u32) {
        let (flow_in, flow_out) = self.flow(part);
        if name == flow_in {
            return (0, 0);
        }
        if name == flow_out {
            return (usize::MAX, 0);
        }
        let number = name.trim_start_matches(|c: char| !c.is_ascii_digit()).parse().unwrap_or(0);
        let place = match self.parts[part] {
            Some(element) => match &element.target {
                Target::Element { row, .. } => row.pins().position(|pin| pin.matches(name).is_some()),
                Target::Block { .. } => element.pins.iter().position(|pin| pin.name == name),
            },
            None => Some(0),
        };
        (place.unwrap_or(usize::MAX - 2).saturating_add(1), number)
    }
}
