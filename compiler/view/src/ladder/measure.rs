//! How large blocks are, from the inside to the outside.

use std::collections::HashMap;

use super::reduce::{Block, PartBlock};
use crate::metrics;
use crate::scene::Ink;
use crate::shape::{self, Room, Shape};
use crate::sheet::{Label, Look, Part, Sheet};

/// The line from the rail to a rung.
pub const RAIL: i32 = 10;
/// From the line of a branch to what is in it.
pub const LEAD: i32 = 8;
/// Between branches.
pub const GAP: i32 = 8;
/// The least width of a branch before it goes on in a second line.
const ROOM_MIN: i32 = 240;
/// Box rows are not moved further down than this to keep lines to the rail free.
const DOWN_MAX: i32 = 200;

/// A block with its size. The flow enters at (0, 0) and leaves at (width, 0).
pub struct Laid {
    pub width: i32,
    pub up: i32,
    pub down: i32,
    /// No line leads to it.
    pub loose: bool,
    /// Nothing follows.
    pub ends: bool,
    pub kind: Kind,
}

pub enum Kind {
    Part {
        part: usize,
        shape: Shape,
        /// Pin, net, rung; lines lead to the main rail if `railed`.
        feeds: Vec<(usize, usize, Laid)>,
        tails: Vec<(usize, usize, Laid)>,
        connectors: Vec<(usize, String)>,
        railed: bool,
    },
    Series(Vec<(Laid, Option<usize>)>),
    /// Lines below each other that are one after the other.
    Lines(Vec<Laid>),
    Parallel(Vec<Laid>),
    Fork {
        main: Option<Box<Laid>>,
        tails: Vec<Laid>,
    },
    Connector {
        text: String,
        ink: Ink,
        goes_on: bool,
        negated: bool,
        key: String,
    },
}

pub struct Measure<'a> {
    pub sheet: &'a Sheet,
    /// Connectors between lines so far.
    pub connectors: usize,
    /// Width of the widest coil at an end: all have it, so that they stand below each other.
    coils: i32,
}

impl<'a> Measure<'a> {
    pub fn new(sheet: &'a Sheet) -> Measure<'a> {
        let is_coil = |part: &Part| matches!(part.look, Look::Coil { .. }) && part.net(part.flow_out).is_none();
        let coils = sheet.parts.iter().enumerate().filter(|(_, part)| is_coil(part));
        let widths = coils.map(|(at, part)| shape::shape(at, part, &HashMap::new()).width);
        Measure { sheet, connectors: 0, coils: widths.max().unwrap_or(0) }
    }

    /// A rung from the rail.
    pub fn rung(&mut self, block: &Block, room: i32) -> Laid {
        self.block(block, room, true)
    }

    fn block(&mut self, block: &Block, room: i32, at_rail: bool) -> Laid {
        match block {
            Block::Part(part) => self.part(part, room, at_rail.then_some(0)),
            Block::Series(items) => self.series(items, room, at_rail),
            Block::Parallel(branches) => {
                let inner = (room - 2 * LEAD).max(ROOM_MIN);
                let branches: Vec<Laid> = branches.iter().map(|branch| self.block(branch, inner, false)).collect();
                let width = branches.iter().map(|branch| branch.width).max().unwrap_or(0) + 2 * LEAD;
                stacked(width, Kind::Parallel(branches), false)
            }
            Block::Fork { main, tails } => {
                let inner = (room - LEAD).max(ROOM_MIN);
                let tails: Vec<Laid> = tails.iter().map(|tail| self.block(tail, inner, false)).collect();
                let main = main.as_ref().map(|main| Box::new(self.block(main, inner, false)));
                let all = main.iter().map(|main| &**main).chain(&tails);
                let width = all.map(|branch| branch.width).max().unwrap_or(0) + LEAD;
                let ends = main.is_none();
                stacked(width, Kind::Fork { main, tails }, ends)
            }
            Block::Connector { name, goes_on, label } => connector(name, *goes_on, label.as_ref()),
        }
    }

    fn series(&mut self, items: &[(Block, Option<usize>)], room: i32, at_rail: bool) -> Laid {
        let mut lines: Vec<Vec<(Laid, Option<usize>)>> = vec![Vec::new()];
        let (mut width, mut down) = (0, 0);
        for (block, net) in items {
            let clear = (at_rail && lines.len() == 1 && down < DOWN_MAX).then_some(down);
            let laid = match block {
                Block::Part(part) => self.part(part, room, clear),
                other => self.block(other, room, false),
            };
            let line = lines.last_mut().expect("there is a line from the beginning");
            let gap = line.last().map_or(0, |(before, _)| joint(before, &laid));
            if width + gap + laid.width > room && !line.is_empty() && !line.iter().all(|(laid, _)| laid.loose) {
                self.connectors += 1;
                let name = self.connectors.to_string();
                let net_before = line.last().and_then(|(_, net)| *net);
                line.push((connector(&name, false, None), None));
                let start = connector(&name, true, None);
                width = start.width;
                // Feeds of a part in a later line begin beside it.
                let laid = match block {
                    Block::Part(part) => self.part(part, room, None),
                    _ => laid,
                };
                width += laid.width;
                lines.push(vec![(start, net_before), (laid, *net)]);
                continue;
            }
            width += gap + laid.width;
            down = down.max(laid.down);
            line.push((laid, *net));
        }
        let mut lines: Vec<Laid> = lines.into_iter().map(row).collect();
        match lines.len() {
            1 => lines.remove(0),
            _ => {
                let width = lines.iter().map(|line| line.width).max().unwrap_or(0) + LEAD;
                let ends = lines.last().is_some_and(|line| line.ends);
                let loose = lines[0].loose;
                Laid { loose, ..stacked(width, Kind::Lines(lines), ends) }
            }
        }
    }

    /// `clear`: the lines of its other inputs lead to the rail, below what is this high.
    fn part(&mut self, block: &PartBlock, room: i32, clear: Option<i32>) -> Laid {
        let of = &self.sheet.parts[block.part];
        let inner = (room / 2).max(ROOM_MIN);
        let mut rooms: HashMap<usize, Room> = HashMap::new();
        let mut feeds = Vec::new();
        for (index, (pin, net, feed)) in block.feeds.iter().enumerate() {
            let laid = self.block(feed, inner, false);
            let above = match (index, clear) {
                (0, Some(clear)) => laid.up + clear,
                _ => laid.up,
            };
            rooms.insert(*pin, Room { up: above.max(8), down: laid.down, width: laid.width + LEAD });
            feeds.push((*pin, *net, laid));
        }
        let mut tails = Vec::new();
        for (pin, net, blocks) in &block.tails {
            let fork = Block::Fork { main: None, tails: blocks.clone() };
            let laid = match &blocks[..] {
                [one] => self.block(one, inner, false),
                _ => self.block(&fork, inner, false),
            };
            rooms.insert(*pin, Room { up: laid.up, down: laid.down, width: laid.width });
            tails.push((*pin, *net, laid));
        }
        for (pin, name) in &block.connectors {
            let laid = connector(name, true, None);
            rooms.insert(*pin, Room { up: laid.up, down: laid.down, width: laid.width });
        }
        let mut shape = shape::shape(block.part, of, &rooms);
        let ends = of.net(of.flow_out).is_none();
        if ends && matches!(of.look, Look::Coil { .. }) && shape.width < self.coils {
            shape = centered(shape, self.coils, of.net(of.flow_in));
        }
        Laid {
            width: shape.width,
            up: shape.up,
            down: shape.down,
            // A box without EN.
            loose: of.flow_in.is_none() && matches!(of.look, Look::Box { .. }),
            ends,
            kind: Kind::Part {
                part: block.part,
                shape,
                feeds,
                tails,
                connectors: block.connectors.clone(),
                railed: clear.is_some(),
            },
        }
    }
}

/// A shape in the middle of a wider place, with the wire that leads to it.
fn centered(shape: Shape, width: i32, net: Option<usize>) -> Shape {
    let left = (width - shape.width) / 2;
    let mut wider = Shape { width, up: shape.up, down: shape.down, ..Shape::default() };
    wider.scene.add(shape.scene, (left, 0));
    if net.is_some() {
        wider.scene.wire((0, 0), (left, 0), net);
    }
    wider.ends = shape.ends.into_iter().map(|(pin, end)| (pin, (end.0 + left, end.1))).collect();
    wider
}

/// The line between branches that come together and others that part there: two columns show that they do.
pub fn joint(before: &Laid, next: &Laid) -> i32 {
    let parts = matches!(&next.kind, Kind::Parallel(_) | Kind::Fork { .. });
    if matches!(&before.kind, Kind::Parallel(_)) && parts && !before.loose { LEAD } else { 0 }
}

/// Items beside each other.
fn row(items: Vec<(Laid, Option<usize>)>) -> Laid {
    let joints = items.windows(2).map(|pair| joint(&pair[0].0, &pair[1].0)).sum::<i32>();
    let sum = |of: fn(&Laid) -> i32| items.iter().map(|(laid, _)| of(laid)).sum::<i32>();
    let most = |of: fn(&Laid) -> i32| items.iter().map(|(laid, _)| of(laid)).max().unwrap_or(8);
    Laid {
        width: sum(|laid| laid.width) + joints,
        up: most(|laid| laid.up),
        down: most(|laid| laid.down),
        loose: items.first().is_some_and(|(laid, _)| laid.loose),
        ends: items.last().is_some_and(|(laid, _)| laid.ends),
        kind: Kind::Series(items),
    }
}

impl Laid {
    /// The branches of a block, in the order from top to bottom.
    pub fn branches(&self) -> Vec<&Laid> {
        match &self.kind {
            Kind::Parallel(branches) | Kind::Lines(branches) => branches.iter().collect(),
            Kind::Fork { main, tails } => main.iter().map(|main| &**main).chain(tails).collect(),
            Kind::Part { .. } | Kind::Series(_) | Kind::Connector { .. } => Vec::new(),
        }
    }

    /// The distances of the flows of its branches from that of the first.
    pub fn rows(&self) -> Vec<i32> {
        let mut rows = Vec::new();
        let mut bottom = 0;
        for (index, branch) in self.branches().iter().enumerate() {
            let y = if index == 0 { 0 } else { bottom + GAP + branch.up };
            bottom = y + branch.down;
            rows.push(y);
        }
        rows
    }

    /// It is a coil at the end, which stands at the right.
    pub fn is_coil(&self, sheet: &Sheet) -> bool {
        matches!(&self.kind, Kind::Part { part, .. } if matches!(sheet.parts[*part].look, Look::Coil { .. }))
    }
}

/// Blocks below each other.
fn stacked(width: i32, kind: Kind, ends: bool) -> Laid {
    let mut laid = Laid { width, up: 8, down: 8, loose: false, ends, kind };
    let branches = laid.branches();
    let (up, last) = (branches.first().map_or(8, |first| first.up), branches.last().map_or(8, |last| last.down));
    let loose = !branches.is_empty() && branches.iter().all(|branch| branch.loose);
    let down = laid.rows().last().copied().unwrap_or(0) + last;
    (laid.up, laid.down, laid.loose) = (up, down, loose);
    laid
}

fn connector(name: &str, goes_on: bool, label: Option<&(Label, bool)>) -> Laid {
    let (text, ink, negated, key) = match label {
        Some((label, negated)) => (label.text.clone(), Ink::Operand, *negated, label.key.clone()),
        None if name.is_empty() || name.starts_with('<') => (name.to_string(), Ink::Mark, false, String::new()),
        None if goes_on => (format!("{name}»"), Ink::Mark, false, String::new()),
        None => (format!("»{name}"), Ink::Mark, false, String::new()),
    };
    let width = if text.is_empty() { 0 } else { metrics::width(&text, ink.height()) + 18 };
    let kind = Kind::Connector { text, ink, goes_on, negated, key };
    Laid { width, up: 10, down: 10, loose: goes_on, ends: !goes_on, kind }
}
