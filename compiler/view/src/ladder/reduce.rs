//! A sheet as nested rungs: what follows each other, what is parallel, and what branches off.
//!
//! The nets between the elements are a graph whose edges are elements. Two edges that follow each other become one, and so do two edges
//! between the same nets, until only branches from the first net remain. Where a graph cannot be reduced (a bridge, a loop), one edge ends
//! at a connector with a name, and goes on at a second connector; then reduction goes on.

use std::collections::{HashMap, HashSet};

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

/// Blocks inside each other; what would be deeper is drawn at a connector.
const DEPTH_MAX: usize = 60;

#[derive(Clone)]
struct Edge {
    from: usize,
    to: usize,
    items: Vec<(Block, Option<usize>)>,
    order: usize,
    depth: usize,
}

/// A branch that ends.
#[derive(Clone)]
struct Tail {
    block: Block,
    order: usize,
    depth: usize,
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
        for (net, name) in started {
            let items = vec![(Block::Connector { name, goes_on: true, label: None }, Some(net))];
            graph.add(Edge { from: root_net, to: net, items, order: 0, depth: 0 });
        }
        for (at, net) in self.sheet.nets.iter().enumerate() {
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
        for &net in &named {
            let order = self.readers[net].iter().map(|(part, _)| *part).min().unwrap_or(usize::MAX);
            let block = Block::Connector { name: self.sheet.nets[net].name.clone(), goes_on: false, label: None };
            let from = start(self, net);
            if from != root_net || Some(net) == root {
                graph.tails[from].push(Tail { block: Block::Series(vec![(block, None)]), order, depth: 0 });
            }
        }
        if let Some(goal) = goal {
            return graph.to_goal(self.sheet, start(self, goal)).into_iter().collect();
        }
        graph.reduce(self.sheet);
        let mut tails = std::mem::take(&mut graph.tails[root_net]);
        tails.sort_by_key(|tail| tail.order);
        tails.into_iter().map(|tail| tail.block).collect()
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
                                if let Link::Net(from) = input.link {
                                    if nets.insert(from) {
                                        open.push(from);
                                    }
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
                    if let Link::Net(to) = pin.link {
                        if nets.insert(to) {
                            open.push(to);
                        }
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
        let alone = |other: &usize| *other == net || self.writers[*other].iter().all(|part| found.contains(part));
        (found.iter().all(inside) && nets.iter().all(alone)).then_some(found)
    }
}

/// A graph that gets smaller.
struct Reduction {
    root: usize,
    edges: Vec<Option<Edge>>,
    inputs: Vec<Vec<usize>>,
    outputs: Vec<Vec<usize>>,
    tails: Vec<Vec<Tail>>,
    /// Nets to look at.
    open: Vec<usize>,
}

impl Reduction {
    fn new(nets: usize, root: usize) -> Reduction {
        Reduction {
            root,
            edges: Vec::new(),
            inputs: vec![Vec::new(); nets],
            outputs: vec![Vec::new(); nets],
            tails: vec![Vec::new(); nets],
            open: Vec::new(),
        }
    }

    fn add(&mut self, edge: Edge) {
        let at = self.edges.len();
        self.inputs[edge.to].push(at);
        self.outputs[edge.from].push(at);
        self.open.push(edge.to);
        self.open.push(edge.from);
        self.edges.push(Some(edge));
    }

    fn remove(&mut self, at: usize) -> Option<Edge> {
        let edge = self.edges[at].take()?;
        self.inputs[edge.to].retain(|other| *other != at);
        self.outputs[edge.from].retain(|other| *other != at);
        self.open.push(edge.to);
        self.open.push(edge.from);
        Some(edge)
    }

    /// Reduces until only the tails of the root are left.
    fn reduce(&mut self, sheet: &Sheet) {
        loop {
            while let Some(net) = self.open.pop() {
                self.shallow(net, sheet);
                while self.step(net) {
                    self.shallow(net, sheet);
                }
            }
            if !self.cut(sheet) {
                return;
            }
        }
    }

    /// Reduces to one block from the root to `goal`, beside which nothing is drawn.
    fn to_goal(mut self, sheet: &Sheet, goal: usize) -> Option<Block> {
        if goal == self.root {
            return None;
        }
        self.tails[goal].push(Tail { block: Block::Series(Vec::new()), order: usize::MAX, depth: 0 });
        self.reduce(sheet);
        let mut tails = std::mem::take(&mut self.tails[self.root]);
        tails.sort_by_key(|tail| tail.order);
        let mut blocks = tails.into_iter().map(|tail| tail.block);
        let first = blocks.next()?;
        let others: Vec<Block> = blocks.collect();
        Some(if others.is_empty() { first } else { Block::Fork { main: Some(Box::new(first)), tails: others } })
    }

    /// Blocks that are too deep become rungs of their own, with connectors in their places.
    fn shallow(&mut self, net: usize, sheet: &Sheet) {
        let name = |net: usize| sheet.nets.get(net).map_or(String::new(), |net| net.name.clone());
        let connector = |net: usize, goes_on: bool| Block::Connector { name: name(net), goes_on, label: None };
        let deep = |depth: usize| depth > DEPTH_MAX;
        for at in self.inputs[net].clone() {
            if self.edges[at].as_ref().is_none_or(|edge| !deep(edge.depth) || edge.from == self.root) {
                continue;
            }
            let Some(edge) = self.remove(at) else { continue };
            let mut items = vec![(connector(edge.from, true), Some(edge.from))];
            items.extend(edge.items);
            items.push((connector(net, false), None));
            self.tails[self.root].push(Tail { block: Block::Series(items), order: edge.order, depth: 0 });
            let end = Block::Series(vec![(connector(edge.from, false), None)]);
            self.tails[edge.from].push(Tail { block: end, order: edge.order, depth: 0 });
            let items = vec![(connector(net, true), Some(net))];
            self.add(Edge { from: self.root, to: net, items, order: edge.order, depth: 0 });
        }
        if net == self.root || !self.tails[net].iter().any(|tail| deep(tail.depth)) {
            return;
        }
        let (far, near): (Vec<Tail>, Vec<Tail>) = self.tails[net].drain(..).partition(|tail| deep(tail.depth));
        self.tails[net] = near;
        let order = far[0].order;
        for tail in far {
            let items = vec![(connector(net, true), Some(net)), (tail.block, None)];
            self.tails[self.root].push(Tail { block: Block::Series(items), order: tail.order, depth: 0 });
        }
        let end = Block::Series(vec![(connector(net, false), None)]);
        self.tails[net].push(Tail { block: end, order, depth: 0 });
    }

    /// One reduction at a net.
    fn step(&mut self, net: usize) -> bool {
        if net == self.root {
            return false;
        }
        // Parallel branches.
        let mut from: HashMap<usize, Vec<usize>> = HashMap::new();
        for &edge in &self.inputs[net] {
            if let Some(known) = &self.edges[edge] {
                from.entry(known.from).or_default().push(edge);
            }
        }
        let mut groups: Vec<Vec<usize>> = from.into_values().filter(|edges| edges.len() > 1).collect();
        groups.sort_unstable();
        if let Some(group) = groups.into_iter().next() {
            let mut edges: Vec<Edge> = group.into_iter().filter_map(|edge| self.remove(edge)).collect();
            edges.sort_by_key(|edge| edge.order);
            let Some(first) = edges.first() else { return false };
            let (start, order) = (first.from, first.order);
            let depth = edges.iter().map(|edge| edge.depth).max().unwrap_or(0) + 1;
            let mut branches = Vec::new();
            for edge in edges {
                match <[(Block, Option<usize>); 1]>::try_from(edge.items) {
                    // Branches of branches are branches.
                    Ok([(Block::Parallel(inner), _)]) => branches.extend(inner),
                    Ok([item]) => branches.push(Block::Series(vec![item])),
                    Err(items) => branches.push(Block::Series(items)),
                }
            }
            self.add(Edge { from: start, to: net, items: vec![(Block::Parallel(branches), Some(net))], order, depth });
            return true;
        }
        let [only] = self.inputs[net][..] else { return false };
        match self.outputs[net][..] {
            [] => {
                let Some(edge) = self.remove(only) else { return false };
                let tails = std::mem::take(&mut self.tails[net]);
                let depth = edge.depth + tails.iter().map(|tail| tail.depth + 1).max().unwrap_or(0);
                let mut items = edge.items;
                items.extend(fork(tails, None));
                self.tails[edge.from].push(Tail { block: Block::Series(items), order: edge.order, depth });
                true
            }
            [next] if next != only => {
                let (Some(edge), Some(next)) = (self.remove(only), self.remove(next)) else { return false };
                let tails = std::mem::take(&mut self.tails[net]);
                let mut items = edge.items;
                let deepest = tails.iter().map(|tail| tail.depth + 1).max().unwrap_or(0);
                let depth = edge.depth.max(next.depth + usize::from(!tails.is_empty())).max(edge.depth + deepest);
                match tails.is_empty() {
                    true => items.extend(next.items),
                    false => items.extend(fork(tails, Some((next.items, next.to)))),
                }
                self.add(Edge { from: edge.from, to: next.to, items, order: edge.order, depth });
                true
            }
            _ => false,
        }
    }

    /// Cuts one edge where nothing can be reduced. False: nothing is left.
    fn cut(&mut self, sheet: &Sheet) -> bool {
        let root = self.root;
        let name = |net: usize| sheet.nets.get(net).map_or(String::new(), |net| net.name.clone());
        // A net without a source.
        let bare = (0..self.inputs.len()).find(|&net| {
            net != root && self.inputs[net].is_empty() && (!self.outputs[net].is_empty() || !self.tails[net].is_empty())
        });
        if let Some(net) = bare {
            let order = self.outputs[net].iter().filter_map(|edge| self.edges[*edge].as_ref()).map(|edge| edge.order);
            let order = order.chain(self.tails[net].iter().map(|tail| tail.order)).min().unwrap_or(0);
            let start = Block::Connector { name: "<??.?>".to_string(), goes_on: true, label: None };
            self.add(Edge { from: root, to: net, items: vec![(start, Some(net))], order, depth: 0 });
            return true;
        }
        let candidates = self.edges.iter().enumerate().filter_map(|(at, edge)| Some((at, edge.as_ref()?)));
        let candidates: Vec<(usize, usize, usize)> = candidates
            .filter(|(_, edge)| {
                edge.from != root && (self.inputs[edge.to].len() > 1 || edge.from == edge.to || edge.to == root)
            })
            .map(|(at, edge)| (edge.order, at, edge.to))
            .collect();
        let chosen = candidates.iter().max().copied().or_else(|| {
            // Loops that nothing leads to.
            self.edges.iter().enumerate().find_map(|(at, edge)| {
                let edge = edge.as_ref()?;
                (edge.from != root || edge.to == root).then_some((edge.order, at, edge.to))
            })
        });
        let Some((_, at, to)) = chosen else { return false };
        let Some(mut edge) = self.remove(at) else { return false };
        edge.items.push((Block::Connector { name: name(to), goes_on: false, label: None }, None));
        self.tails[edge.from].push(Tail { block: Block::Series(edge.items), order: edge.order, depth: edge.depth });
        let is_connector = |edge: &Edge| matches!(edge.items.as_slice(), [(Block::Connector { goes_on: true, name: known, .. }, _)] if *known == name(to));
        let known = self.inputs[to].iter().filter_map(|edge| self.edges[*edge].as_ref()).any(is_connector);
        if to != root && !known {
            let start = Block::Connector { name: name(to), goes_on: true, label: None };
            let order =
                self.inputs[to].iter().filter_map(|edge| self.edges[*edge].as_ref()).map(|edge| edge.order).max();
            let order = order.unwrap_or(edge.order);
            self.add(Edge { from: root, to, items: vec![(start, Some(to))], order, depth: 0 });
        }
        true
    }
}

/// What follows at a net with branches: `main` goes on to a net.
fn fork(mut tails: Vec<Tail>, main: Option<(Vec<(Block, Option<usize>)>, usize)>) -> Vec<(Block, Option<usize>)> {
    tails.sort_by_key(|tail| tail.order);
    // The end that a rung leads to.
    tails.retain(|tail| tail.block != Block::Series(Vec::new()) || tail.order == usize::MAX);
    let mut blocks: Vec<Block> = tails.into_iter().map(|tail| tail.block).collect();
    match main {
        None if blocks.len() == 1 => match blocks.pop() {
            Some(Block::Series(items)) => items,
            Some(other) => vec![(other, None)],
            None => Vec::new(),
        },
        None if blocks.is_empty() => Vec::new(),
        None => vec![(Block::Fork { main: None, tails: blocks }, None)],
        Some((items, to)) => {
            vec![(Block::Fork { main: Some(Box::new(Block::Series(items))), tails: blocks }, Some(to))]
        }
    }
}
