//! The order in which the elements of a network run. Source: LAD/FBD reference A.11.

use super::ast::{Graph, NetId, PinValue, Source};

/// All elements of a graph in their order, but each after those that it needs. In a loop, the first one goes first.
pub fn order(graph: &Graph) -> Vec<usize> {
    let mut order = Vec::with_capacity(graph.elements.len());
    let mut seen = vec![false; graph.elements.len()];
    for first in 0..graph.elements.len() {
        // Elements, with those that each of them still waits for; not recursive, because files can have chains of any length.
        let mut open: Vec<(usize, std::vec::IntoIter<usize>)> = Vec::new();
        enter(graph, first, &mut seen, &mut open);
        while let Some((element, needs)) = open.last_mut() {
            match needs.next() {
                Some(needed) => enter(graph, needed, &mut seen, &mut open),
                None => {
                    order.push(*element);
                    open.pop();
                }
            }
        }
    }
    order
}

fn enter(graph: &Graph, element: usize, seen: &mut [bool], open: &mut Vec<(usize, std::vec::IntoIter<usize>)>) {
    if let Some(known) = seen.get_mut(element)
        && !std::mem::replace(known, true)
    {
        open.push((element, needs(graph, element).into_iter()));
    }
}

/// The elements that feed the inputs of an element, in order of its pins and their sources.
fn needs(graph: &Graph, element: usize) -> Vec<usize> {
    let mut found = Vec::new();
    for pin in graph.elements[element].pins.iter().filter(|pin| !pin.output) {
        if let PinValue::Net(net) = pin.value {
            feeders(graph, net, &mut found);
        }
    }
    found
}

/// The elements that feed a net, also through other nets.
fn feeders(graph: &Graph, net: NetId, found: &mut Vec<usize>) {
    let mut seen = vec![net];
    let mut open: Vec<&Source> = graph.net(net).sources.iter().rev().collect();
    while let Some(source) = open.pop() {
        match source {
            Source::Pin { element, .. } => found.push(*element),
            Source::Net(other) if !seen.contains(other) => {
                seen.push(*other);
                open.extend(graph.net(*other).sources.iter().rev());
            }
            Source::Net(_) | Source::Rail | Source::Operand { .. } => {}
        }
    }
}
