//! Names of the nets of a network, and where it can be divided.

use std::collections::{HashMap, HashSet};

use plcc_syntax::network::ast::{Graph, Net, NetId, PinValue, Source};

/// Names of nets.
pub struct Wires {
    names: HashMap<u32, String>,
    uses: HashMap<u32, usize>,
}

impl Wires {
    pub fn new(graph: &Graph) -> Wires {
        let mut names = HashMap::new();
        let mut taken: HashSet<String> = HashSet::new();
        for (at, net) in graph.nets.iter().enumerate() {
            let is_rail = matches!(net.sources[..], [Source::Rail]);
            if is_rail {
                names.insert(at as u32, "powerrail".to_string());
            } else if !net.name.is_empty()
                && !net.name.eq_ignore_ascii_case("powerrail")
                && taken.insert(net.name.to_lowercase())
            {
                names.insert(at as u32, net.name.clone());
            }
        }
        let mut number = 0;
        for at in 0..graph.nets.len() as u32 {
            names.entry(at).or_insert_with(|| {
                loop {
                    number += 1;
                    let name = format!("w{number}");
                    if taken.insert(name.clone()) {
                        return name;
                    }
                }
            });
        }
        let mut uses: HashMap<u32, usize> = HashMap::new();
        for pin in graph.elements.iter().flat_map(|element| &element.pins).filter(|pin| !pin.output) {
            if let PinValue::Net(net) = pin.value {
                *uses.entry(net.0).or_default() += 1;
            }
        }
        for source in graph.nets.iter().flat_map(|net| &net.sources) {
            if let Source::Net(net) = source {
                *uses.entry(net.0).or_default() += 2;
            }
        }
        Wires { names, uses }
    }

    pub fn name(&self, net: NetId) -> &str {
        self.names.get(&net.0).map_or("", String::as_str)
    }

    /// Whether the element is the first that feeds the net: others end their rungs in it.
    pub fn is_first(&self, graph: &Graph, net: NetId, element: usize) -> bool {
        matches!(graph.net(net).sources.first(), Some(Source::Pin { element: first, .. }) if *first == element)
    }

    /// One element feeds the net, and one reads it: the rung needs no name for it.
    pub fn is_only(&self, graph: &Graph, net: NetId) -> bool {
        graph.net(net).sources.len() == 1 && self.uses.get(&net.0) == Some(&1)
    }
}

/// For each element, whether a wire of an element before it goes on to it or past it: the network cannot be divided there.
pub fn crossed(graph: &Graph) -> Vec<bool> {
    let is_rail = |net: &Net| matches!(net.sources[..], [Source::Rail]);
    let is_of_pins = |net: &Net| net.sources.iter().all(|source| matches!(source, Source::Pin { .. }));
    if !graph.nets.iter().all(|net| is_rail(net) || is_of_pins(net)) {
        return vec![true; graph.elements.len()];
    }
    // The first and the last element at each net.
    let mut reach: Vec<Option<(usize, usize)>> = vec![None; graph.nets.len()];
    for (at, element) in graph.elements.iter().enumerate() {
        for pin in &element.pins {
            if let PinValue::Net(net) = pin.value
                && !is_rail(graph.net(net))
                && let Some(slot) = reach.get_mut(net.0 as usize)
            {
                *slot = Some((slot.map_or(at, |(first, _)| first), at));
            }
        }
    }
    let mut ends = vec![0_usize; graph.elements.len()];
    for (first, last) in reach.into_iter().flatten() {
        ends[first] = ends[first].max(last);
    }
    let mut furthest = 0;
    let is_crossed = ends.iter().enumerate().map(|(at, end)| {
        let crossed = at > 0 && furthest >= at;
        furthest = furthest.max(*end);
        crossed
    });
    is_crossed.collect()
}
