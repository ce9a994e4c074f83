//! A sheet as nested rungs: what follows each other, what is parallel, and what branches off.
//!
//! Inputs of a box besides its flow have rungs of their own, and so have further outputs, if those parts lead nowhere else; otherwise a
//! connector with the name of the net stands at the pin. What is left of a rung is a graph, which `graph` reduces.

use std::collections::{HashMap, HashSet};

use super::graph::{DEPTH_MAX, Edge, Reduction, Tail};
use crate::sheet::{Label, Link, Place, Sheet, Source};

/// A drawing's structure.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    Part(PartBlock),
    /// Blocks, each with the net after it.
    Series(Vec<(Block, Option<usize>)>),
    /// Branches with common ends.
    Parallel(Vec<Block>),
    /// Branches with a common beginning. The first `ends` of them: none goes on. With `main`, which goes on, the others are below it.
    Fork {
        main: Option<Box<Block>>,
        tails: Vec<Block>,
    },
    /// The end of a line that goes on elsewhere, or its beginning there.
    Connector {
        name: String,
        goes_on: bool,
        label: Option<(Label, bool)>,
    },
}

/// A part with what leads to its other inputs, and from its other outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct PartBlock {
    pub part: usize,
    /// Pin, net and the rung that leads to it.
    pub feeds: Vec<(usize, usize, Block)>,
    /// Pin, net and what it leads to.
    pub tails: Vec<(usize, usize, Vec<Block>)>,
    /// Pins whose wire ends at a connector with this name.
    pub connectors: Vec<(usize, String)>,
}

/// The rungs of a sheet, each from the power rail.
pub fn rungs(sheet: &Sheet) -> Vec<Block> {
    let all: HashSet<usize> = (0..sheet.parts.len()).collect();
    Reducer::new(sheet).rungs(&all, None, None)
}

/// The net that stands for the rail: one more than those of the sheet.
fn rail(sheet: &Sheet) -> usize {
    sheet.nets.len()
}

struct Reducer<'a> {
    sheet: &'a Sheet,
    /// Parts that read a net, with the pin.
    readers: Vec<Vec<(usize, usize)>>,
    /// Parts that write a net.
    writers: Vec<Vec<usize>>,
    /// Nets that another net feeds.
    fed: Vec<Vec<usize>>,
    /// Nets that have no source but the rail.
    rails: Vec<bool>,
    /// Levels of feeds and tails inside each other.
    level: usize,
}

impl<'a> Reducer<'a> {
    fn new(sheet: &'a Sheet) -> Reducer<'a> {
        let count = sheet.nets.len() + 1;
        let mut reducer = Reducer {
            sheet,
            readers: vec![Vec::new(); count],
            writers: vec![Vec::new(); count],
            fed: vec![Vec::new(); count],
            rails: vec![false; count],
            level: 0,
        };
        reducer.rails[count - 1] = true;
        for (at, net) in sheet.nets.iter().enumerate() {
            reducer.rails[at] = !net.sources.is_empty() && net.sources.iter().all(|source| *source == Source::Rail);
            for source in &net.sources {
                match source {
                    Source::Net(from) if *from < sheet.nets.len() => reducer.fed[*from].push(at),
                    Source::Pin { part, .. } if *part < sheet.parts.len() => reducer.writers[at].push(*part),
                    Source::Net(_) | Source::Pin { .. } | Source::Rail | Source::Operand { .. } => {}
                }
            }
        }
        for (at, part) in sheet.parts.iter().enumerate() {
            for (index, pin) in part.pins.iter().enumerate() {
                if let (Link::Net(net), false) = (&pin.link, pin.output) {
                    reducer.readers[*net].push((at, index));
                }
            }
        }
        reducer
    }

    /// The rungs made of `parts`. They begin at the rail, or at `root`; the net `goal` ends one of them.
    fn rungs(&mut self, parts: &HashSet<usize>, root: Option<usize>, goal: Option<usize>) -> Vec<Block> {
        let rail = rail(self.sheet);
        let root_net = root.unwrap_or(rail);
        let start = |reducer: &Reducer, net: usize| match () {
            () if Some(net) == root => root_net,
            () if root.is_none() && reducer.rails[net] => root_net,
            () => net,
        };
        // Parts of other rungs: those that lead to a further input, or come from a further output.
        let mut claimed: HashSet<usize> = HashSet::new();
        let mut blocks: HashMap<usize, PartBlock> = HashMap::new();
        let mut order: Vec<usize> = parts.iter().copied().collect();
        order.sort_unstable();
        let mut started: Vec<(usize, String)> = Vec::new();
        let mut named: HashSet<usize> = HashSet::new();
        for &at in &order {
            let block = self.part_block(at, parts, goal, &mut claimed, &mut started, &mut named);
            blocks.insert(at, block);
        }
        let mut graph = Reduction::new(rail + 1, root_net);
        for &at in order.iter().filter(|at| !claimed.contains(at)) {
            let part = &self.sheet.parts[at];
            let Some(block) = blocks.remove(&at) else { continue };
            let from = part.net(part.flow_in).map_or(root_net, |net| start(self, net));
            let has_entry = part.net(part.flow_in).is_some();
            let mut items = Vec::new();
            if !has_entry && part.flow_in.is_some_and(|pin| !matches!(part.pins[pin].link, Link::Net(_))) {
                // It stands at the rail without a line to it.
                items.push((Block::Connector { name: String::new(), goes_on: true, label: None }, None));
            }
            let to = part.net(part.flow_out);
            items.push((Block::Part(block), to));
            match to {
                Some(to) => graph.add(Edge { from, to, items, order: at, depth: 0 }),
                None => graph.tails[from].push(Tail { block: Block::Series(items), order: at, depth: 0 }),
            }
        }
        // A line begins again for those that follow it; pins that read a value show its name themselves.
        let goes_on = |net: usize| {
            let follows = |(part, pin): &(usize, usize)| {
                parts.contains(part) && !claimed.contains(part) && self.sheet.parts[*part].flow_in == Some(*pin)
            };
            self.readers[net].iter().any(follows) || !self.fed[net].is_empty() || goal == Some(net)
        };
        let begun: HashSet<usize> = started.iter().map(|(net, _)| *net).collect();
        for (net, name) in started.into_iter().filter(|(net, _)| goes_on(*net)) {
            let items = vec![(Block::Connector { name, goes_on: true, label: None }, Some(net))];
            graph.add(Edge { from: root_net, to: net, items, order: 0, depth: 0 });
        }
        for at in self.nets_of(parts, root, goal) {
            let net = &self.sheet.nets[at];
            let used = self.readers[at].iter().any(|(part, _)| parts.contains(part) && !claimed.contains(part))
                || goal == Some(at)
                || !self.fed[at].is_empty() && root.is_none();
            if !used || start(self, at) == root_net {
                continue;
            }
            for source in &net.sources {
                let order = self.readers[at].first().map_or(usize::MAX, |(part, _)| *part);
                match source {
                    Source::Operand { label, negated } => {
                        let label = Some((label.clone(), *negated));
                        let items = vec![(Block::Connector { name: String::new(), goes_on: true, label }, Some(at))];
                        graph.add(Edge { from: root_net, to: at, items, order, depth: 0 });
                    }
                    Source::Net(from) if *from < self.sheet.nets.len() => {
                        graph.add(Edge { from: start(self, *from), to: at, items: Vec::new(), order, depth: 0 });
                    }
                    Source::Rail => graph.add(Edge { from: root_net, to: at, items: Vec::new(), order, depth: 0 }),
                    Source::Net(_) | Source::Pin { .. } => {}
                }
            }
        }
        // The output of a box has the name already.
        let is_led = |net: usize| {
            let writes = |at: &usize| {
                let part = &self.sheet.parts[*at];
                parts.contains(at) && part.net(part.flow_out) == Some(net)
            };
            let is_other = |source: &Source| !matches!(source, Source::Pin { .. });
            self.writers[net].iter().any(writes) || self.sheet.nets[net].sources.iter().any(is_other)
        };
        for &net in named.iter().filter(|net| !begun.contains(*net) || is_led(**net)) {
            let order = self.readers[net].iter().map(|(part, _)| *part).min().unwrap_or(usize::MAX);
            let block = Block::Connector { name: self.sheet.nets[net].name.clone(), goes_on: false, label: None };
            let from = start(self, net);
            if from != root_net || Some(net) == root {
                graph.tails[from].push(Tail { block: Block::Series(vec![(block, None)]), order, depth: 0 });
            }
        }
        if let Some(goal) = goal {
            return graph.reduced_to(self.sheet, start(self, goal)).into_iter().collect();
        }
        graph.reduce(self.sheet);
        let mut tails = std::mem::take(&mut graph.tails[root_net]);
        tails.sort_by_key(|tail| tail.order);
        tails.into_iter().map(|tail| tail.block).collect()
    }

    /// The nets that parts read: all of them for the rungs of the whole sheet.
    fn nets_of(&self, parts: &HashSet<usize>, root: Option<usize>, goal: Option<usize>) -> Vec<usize> {
        if root.is_none() && goal.is_none() {
            return (0..self.sheet.nets.len()).collect();
        }
        let pins = parts.iter().flat_map(|part| &self.sheet.parts[*part].pins).filter(|pin| !pin.output);
        let read = pins.filter_map(|pin| match pin.link {
            Link::Net(net) => Some(net),
            Link::Operand(_) | Link::Open => None,
        });
        let mut nets: Vec<usize> = read.chain(goal).collect();
        // Nets that feed those nets.
        let mut known: HashSet<usize> = nets.iter().copied().collect();
        let mut at = 0;
        while let Some(net) = nets.get(at) {
            for source in &self.sheet.nets[*net].sources {
                if let Source::Net(from) = source
                    && *from < self.sheet.nets.len()
                    && known.insert(*from)
                {
                    nets.push(*from);
                }
            }
            at += 1;
        }
        nets.sort_unstable();
        nets.dedup();
        nets
    }

    fn part_block(
        &mut self,
        at: usize,
        parts: &HashSet<usize>,
        goal: Option<usize>,
        claimed: &mut HashSet<usize>,
        started: &mut Vec<(usize, String)>,
        named: &mut HashSet<usize>,
    ) -> PartBlock {
        let sheet = self.sheet;
        let part = &sheet.parts[at];
        let mut block = PartBlock { part: at, feeds: Vec::new(), tails: Vec::new(), connectors: Vec::new() };
        for (index, pin) in part.pins.iter().enumerate() {
            let Link::Net(net) = pin.link else { continue };
            if Some(index) == part.flow_in || Some(index) == part.flow_out {
                continue;
            }
            let name = &sheet.nets[net].name;
            if pin.place != Place::Side || self.level >= DEPTH_MAX {
                block.connectors.push((index, name.clone()));
                if !pin.output {
                    named.insert(net);
                }
                continue;
            }
            if !pin.output {
                match self.before(net, at, index, parts, claimed) {
                    Some(feed) => {
                        claimed.extend(&feed);
                        self.level += 1;
                        let mut rungs = self.rungs(&feed, None, Some(net));
                        self.level -= 1;
                        let rung = match rungs.pop() {
                            Some(rung) => rung,
                            None => Block::Series(Vec::new()),
                        };
                        block.feeds.push((index, net, rung));
                    }
                    None => {
                        block.connectors.push((index, name.clone()));
                        named.insert(net);
                    }
                }
            } else if self.readers[net].is_empty() && goal != Some(net) && sheet.nets[net].sources.len() > 1 {
                // Joined with another output, and leads nowhere.
                block.connectors.push((index, name.clone()));
                named.insert(net);
            } else if !self.readers[net].is_empty() || goal == Some(net) {
                match self.after(net, at, parts, claimed).filter(|_| goal != Some(net)) {
                    Some(follow) => {
                        claimed.extend(&follow);
                        self.level += 1;
                        let rungs = self.rungs(&follow, Some(net), None);
                        self.level -= 1;
                        block.tails.push((index, net, rungs));
                    }
                    None => {
                        block.connectors.push((index, name.clone()));
                        if !started.iter().any(|(known, _)| *known == net) {
                            started.push((net, name.clone()));
                        }
                    }
                }
            }
        }
        block
    }

    /// The parts of the rung that leads from the rail to a pin and to nothing else.
    fn before(
        &self,
        net: usize,
        at: usize,
        pin: usize,
        parts: &HashSet<usize>,
        claimed: &HashSet<usize>,
    ) -> Option<HashSet<usize>> {
        let mut found: HashSet<usize> = HashSet::new();
        let mut nets: HashSet<usize> = HashSet::from([net]);
        let mut open = vec![net];
        while let Some(net) = open.pop() {
            if self.rails[net] {
                continue;
            }
            if self.sheet.nets[net].sources.is_empty() {
                return None;
            }
            for source in &self.sheet.nets[net].sources {
                match source {
                    Source::Net(from) if *from < self.sheet.nets.len() => {
                        if nets.insert(*from) {
                            open.push(*from);
                        }
                    }
                    Source::Net(_) => return None,
                    Source::Rail | Source::Operand { .. } => {}
                    Source::Pin { part, pin } => {
                        let source = self.sheet.parts.get(*part)?;
                        let is_flow =
                            source.flow_out.is_some_and(|flow| flow == *pin || source.net(Some(flow)) == Some(net));
                        if *part == at || !parts.contains(part) || claimed.contains(part) || !is_flow {
                            return None;
                        }
                        if found.insert(*part) {
                            for input in source.pins.iter().filter(|pin| !pin.output) {
                                if let Link::Net(from) = input.link
                                    && nets.insert(from)
                                {
                                    open.push(from);
                                }
                            }
                        }
                    }
                }
            }
        }
        let inside = |net: &usize| {
            let read = |(part, index): &(usize, usize)| found.contains(part) || (*part, *index) == (at, pin);
            self.rails[*net]
                || self.readers[*net].iter().all(read) && self.fed[*net].iter().all(|net| nets.contains(net))
        };
        // Boxes on the way may have outputs that lead elsewhere.
        let outputs_stay = found.iter().all(|part| {
            let pins = self.sheet.parts[*part].pins.iter().filter(|pin| pin.output);
            pins.filter_map(|pin| match pin.link {
                Link::Net(net) => Some(net),
                Link::Operand(_) | Link::Open => None,
            })
            .all(|net| nets.contains(&net) || self.readers[net].is_empty())
        });
        (outputs_stay && nets.iter().all(inside)).then_some(found)
    }

    /// The parts that a further output leads to, if nothing else leads there.
    fn after(&self, net: usize, at: usize, parts: &HashSet<usize>, claimed: &HashSet<usize>) -> Option<HashSet<usize>> {
        if self.sheet.nets[net].sources.len() != 1 {
            return None;
        }
        let mut found: HashSet<usize> = HashSet::new();
        let mut nets: HashSet<usize> = HashSet::from([net]);
        let mut open = vec![net];
        while let Some(net) = open.pop() {
            if !self.fed[net].is_empty() {
                return None;
            }
            for (part, _) in &self.readers[net] {
                if *part == at || !parts.contains(part) || claimed.contains(part) {
                    return None;
                }
                if !found.insert(*part) {
                    continue;
                }
                for pin in self.sheet.parts[*part].pins.iter().filter(|pin| pin.output) {
                    if let Link::Net(to) = pin.link
                        && nets.insert(to)
                    {
                        open.push(to);
                    }
                }
            }
        }
        let inside = |part: &usize| {
            self.sheet.parts[*part].pins.iter().filter(|pin| !pin.output).all(|pin| match pin.link {
                Link::Net(net) => nets.contains(&net) || self.rails[net],
                Link::Operand(_) | Link::Open => true,
            })
        };
        // Each of them is on a line that comes from the output: a box with another line into EN stands in its own rung.
        let is_on_line = |part: &usize| {
            let part = &self.sheet.parts[*part];
            part.net(part.flow_in).is_some_and(|from| nets.contains(&from))
        };
        let alone = |other: &usize| *other == net || self.writers[*other].iter().all(|part| found.contains(part));
        (found.iter().all(inside) && found.iter().all(is_on_line) && nets.iter().all(alone)).then_some(found)
    }
}
