//! A graph of rungs that gets smaller.
//!
//! The nets between the elements are a graph whose edges are elements. Two edges that follow each other become one, and so do two edges
//! between the same nets, until only branches from the first net remain. Where a graph cannot be reduced (a bridge, a loop), one edge ends
//! at a connector with a name, and goes on at a second connector; then reduction goes on.

use std::collections::HashMap;

use super::reduce::Block;
use crate::sheet::Sheet;

/// Blocks inside each other; what would be deeper is drawn at a connector.
pub const DEPTH_MAX: usize = 60;

/// What leads from one net to another.
#[derive(Clone)]
pub struct Edge {
    pub from: usize,
    pub to: usize,
    pub items: Vec<(Block, Option<usize>)>,
    pub order: usize,
    pub depth: usize,
}

/// A branch that ends.
#[derive(Clone)]
pub struct Tail {
    pub block: Block,
    pub order: usize,
    pub depth: usize,
}

/// A graph that gets smaller.
pub struct Reduction {
    root: usize,
    edges: Vec<Option<Edge>>,
    inputs: Vec<Vec<usize>>,
    outputs: Vec<Vec<usize>>,
    pub tails: Vec<Vec<Tail>>,
    /// Nets to look at.
    open: Vec<usize>,
}

impl Reduction {
    pub fn new(nets: usize, root: usize) -> Reduction {
        Reduction {
            root,
            edges: Vec::new(),
            inputs: vec![Vec::new(); nets],
            outputs: vec![Vec::new(); nets],
            tails: vec![Vec::new(); nets],
            open: Vec::new(),
        }
    }

    pub fn add(&mut self, edge: Edge) {
        let at = self.edges.len();
        self.inputs[edge.to].push(at);
        if edge.from != self.root {
            self.outputs[edge.from].push(at);
        }
        self.open.push(edge.to);
        self.open.push(edge.from);
        self.edges.push(Some(edge));
    }

    fn remove(&mut self, at: usize) -> Option<Edge> {
        let edge = self.edges[at].take()?;
        self.inputs[edge.to].retain(|other| *other != at);
        if edge.from != self.root {
            self.outputs[edge.from].retain(|other| *other != at);
        }
        self.open.push(edge.to);
        self.open.push(edge.from);
        Some(edge)
    }

    /// Reduces until only the tails of the root are left.
    pub fn reduce(&mut self, sheet: &Sheet) {
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
    pub fn reduced_to(mut self, sheet: &Sheet, goal: usize) -> Option<Block> {
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
            let mut branches: Vec<(usize, Block)> = Vec::new();
            for edge in edges {
                match <[(Block, Option<usize>); 1]>::try_from(edge.items) {
                    // Branches of branches are branches. They may have been joined before a branch between them was known.
                    Ok([(Block::Parallel(inner), _)]) => {
                        branches.extend(inner.into_iter().map(|one| (first_part(&one).unwrap_or(edge.order), one)));
                    }
                    Ok([item]) => branches.push((edge.order, Block::Series(vec![item]))),
                    Err(items) => branches.push((edge.order, Block::Series(items))),
                }
            }
            branches.sort_by_key(|(order, _)| *order);
            let branches = branches.into_iter().map(|(_, branch)| branch).collect();
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
                let items = open_ended(items);
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

/// The part that a block begins with: its number is its place in the network.
fn first_part(block: &Block) -> Option<usize> {
    match block {
        Block::Part(part) => Some(part.part),
        Block::Series(items) => items.iter().find_map(|(item, _)| first_part(item)),
        Block::Parallel(branches) => branches.iter().filter_map(first_part).min(),
        Block::Fork { main, tails } => main.as_deref().into_iter().chain(tails).filter_map(first_part).min(),
        Block::Connector { .. } => None,
    }
}

/// Nothing follows the items: where one branch goes on and others end, all of them end, and have the same room.
fn open_ended(mut items: Vec<(Block, Option<usize>)>) -> Vec<(Block, Option<usize>)> {
    let goes_on = |(block, _): &(Block, Option<usize>)| matches!(block, Block::Fork { main: Some(_), .. });
    let Some(at) = items.iter().position(goes_on) else { return items };
    let rest = items.split_off(at + 1);
    if let Some((Block::Fork { main: Some(main), tails: mut branches }, net)) = items.pop() {
        let mut branch = match *main {
            Block::Series(items) => items,
            other => vec![(other, net)],
        };
        branch.extend(rest);
        let branch = Block::Series(open_ended(branch));
        // The CPU executes them from top to bottom.
        let own = first_part(&branch);
        let earlier = branches.iter().rposition(|other| first_part(other).is_some_and(|first| Some(first) < own));
        branches.insert(earlier.map_or(0, |at| at + 1), branch);
        items.push((Block::Fork { main: None, tails: branches }, None));
    }
    items
}

/// Blocks in series, each with the net after it.
type Series = Vec<(Block, Option<usize>)>;

/// What follows at a net with branches: `main` goes on to a net.
fn fork(mut tails: Vec<Tail>, main: Option<(Series, usize)>) -> Series {
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
