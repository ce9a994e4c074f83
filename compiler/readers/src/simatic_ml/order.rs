//! The order of elements in a network: the file lists parts and wires in no particular order. Source: LAD/FBD reference A2.2, A.11.

use super::graph::Wiring;
use super::parts::{End, Parts};
use plcc_syntax::network::ast::Language;

/// The parts that are elements, in the order of evaluation.
pub fn order(parts: &Parts, wiring: &Wiring, language: Language) -> Vec<usize> {
    let mut walk = Walk { parts, wiring, seen: vec![false; parts.parts.len()], order: Vec::new() };
    let mut by_uid: Vec<usize> = (0..parts.parts.len()).collect();
    by_uid.sort_by_key(|part| parts.parts[*part].uid);
    if language == Language::Lad {
        for wire in parts.wires.iter().filter(|wire| wire.ends.contains(&End::Rail)) {
            let sinks = wire.ends.iter().filter_map(sink);
            sinks.for_each(|part| walk.forward(part));
        }
        by_uid.into_iter().for_each(|part| walk.forward(part));
    } else {
        let ends: Vec<usize> = by_uid.iter().copied().filter(|part| walk.is_end(*part)).collect();
        ends.into_iter().for_each(|part| walk.backward(part));
        by_uid.into_iter().for_each(|part| walk.backward(part));
    }
    walk.order
}

/// The part that a wire feeds at this end.
fn sink(end: &End) -> Option<usize> {
    match end {
        End::Pin { part, output: false, .. } => Some(*part),
        _ => None,
    }
}

struct Walk<'a> {
    parts: &'a Parts,
    wiring: &'a Wiring,
    seen: Vec<bool>,
    order: Vec<usize>,
}

impl Walk<'_> {
    /// A part, then what its outputs feed: the flow first.
    fn forward(&mut self, start: usize) {
        let mut stack = vec![start];
        while let Some(part) = stack.pop() {
            if std::mem::replace(&mut self.seen[part], true) {
                continue;
            }
            if !self.wiring.joins[part] {
                self.order.push(part);
            }
            let flow = self.parts.parts[part].flow().1;
            let mut outputs: Vec<(&str, usize)> = self.wiring.pins[part]
                .iter()
                .filter(|(_, _, output)| *output)
                .map(|(name, wire, _)| (name.as_str(), *wire))
                .collect();
            outputs.sort_by_key(|(name, _)| (*name != flow, self.parts.parts[part].place(name)));
            let sinks: Vec<usize> =
                outputs.iter().flat_map(|(_, wire)| self.parts.wires[*wire].ends.iter().filter_map(sink)).collect();
            stack.extend(sinks.into_iter().rev());
        }
    }

    /// What feeds a part, in the order of its pins, then the part.
    fn backward(&mut self, start: usize) {
        let mut stack = vec![(start, false)];
        while let Some((part, is_fed)) = stack.pop() {
            if is_fed {
                self.order.push(part);
                continue;
            }
            if std::mem::replace(&mut self.seen[part], true) {
                continue;
            }
            stack.push((part, true));
            let mut inputs: Vec<(&str, usize)> = self.wiring.pins[part]
                .iter()
                .filter(|(_, _, output)| !output)
                .map(|(name, wire, _)| (name.as_str(), *wire))
                .collect();
            inputs.sort_by_key(|(name, _)| self.parts.parts[part].place(name));
            let sources = inputs.iter().flat_map(|(_, wire)| {
                self.parts.wires[*wire].ends.iter().filter_map(|end| match end {
                    End::Pin { part, output: true, .. } => Some(*part),
                    _ => None,
                })
            });
            let sources: Vec<usize> = sources.filter(|source| !self.seen[*source]).collect();
            stack.extend(sources.into_iter().rev().map(|part| (part, false)));
        }
    }

    /// Whether a part feeds nothing else.
    fn is_end(&self, part: usize) -> bool {
        let outputs = self.wiring.pins[part].iter().filter(|(_, _, output)| *output);
        !outputs.flat_map(|(_, wire, _)| &self.parts.wires[*wire].ends).any(|end| sink(end).is_some())
    }
}
