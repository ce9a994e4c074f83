//! Columns and heights of boxes.

use std::collections::{HashMap, HashSet};

use crate::metrics;
use crate::scene::Ink;
use crate::shape::{self, Shape};
use crate::sheet::{Label, Link, Look, Meaning, Sheet, Source};

/// Between things of a column.
const GAP: i32 = 10;
/// Ends of different nets at a channel differ at least by this.
const APART: i32 = 4;

/// What stands in a column.
pub enum Thing {
    Box {
        part: usize,
        shape: Shape,
    },
    /// A wire that passes.
    Wire {
        net: usize,
    },
    /// The operand that feeds a net.
    Operand {
        net: usize,
        label: Label,
        negated: bool,
    },
    /// A net comes from elsewhere.
    From {
        net: usize,
        text: String,
    },
    /// A net goes on elsewhere.
    To {
        net: usize,
        text: String,
    },
}

pub struct Placed {
    pub thing: Thing,
    pub width: i32,
    /// The height of its first row.
    pub y: i32,
    pub up: i32,
    pub down: i32,
}

/// An end of a net at a side of a column: the thing and its height below the first row of the thing.
#[derive(Clone, Copy, Debug)]
pub struct End {
    pub thing: usize,
    pub dy: i32,
    pub net: usize,
}

/// Columns from left to right. Channel `c` is right of column `c`.
#[derive(Default)]
pub struct Grid {
    /// Columns at which a band begins.
    pub bands: Vec<usize>,
    pub columns: Vec<Vec<Placed>>,
    /// Ends at the right side of a column, which feed the channel.
    pub outs: Vec<Vec<End>>,
    /// Ends at the left side of a column.
    pub ins: Vec<Vec<End>>,
}

/// Places everything.
pub fn place(sheet: &Sheet, width: i32) -> Grid {
    let shapes: Vec<Shape> =
        sheet.parts.iter().enumerate().map(|(at, part)| shape::shape(at, part, &HashMap::new())).collect();
    let drawn: Vec<usize> = (0..sheet.parts.len()).filter(|at| sheet.parts[*at].look != Look::Nothing).collect();
    let mut columns = columns(sheet, &drawn);
    let last = drawn.iter().map(|at| columns[*at]).max().unwrap_or(0);
    // Columns that do not fit beside each other begin a further band, below.
    let mut widths = vec![0; last + 1];
    drawn.iter().for_each(|at| widths[columns[*at]] = widths[columns[*at]].max(shapes[*at].width));
    let mut bands = vec![0; last + 1];
    let mut used = 0;
    for column in 0..=last {
        let need = widths[column] + 40;
        if column > 0 && used + need > width {
            used = 0;
            bands[column] = bands[column - 1] + 1;
        } else if column > 0 {
            bands[column] = bands[column - 1];
        }
        used += need;
    }
    let first_of_band: Vec<usize> =
        (0..=last).map(|column| bands.iter().position(|b| *b == bands[column]).unwrap_or(0)).collect();
    let band: Vec<usize> = columns.iter().map(|column| bands.get(*column).copied().unwrap_or(0)).collect();
    for at in &drawn {
        columns[*at] -= first_of_band[columns[*at]];
    }
    let readers = readers(sheet, &drawn);
    let mut feeds = vec![false; sheet.nets.len()];
    for source in sheet.nets.iter().flat_map(|net| &net.sources) {
        if let Source::Net(from) = source {
            feeds[*from] = true;
        }
    }
    let mut grid = Grid::default();
    let mut top = 0;
    for number in 0..=bands.last().copied().unwrap_or(0) {
        let members: Vec<usize> = drawn.iter().copied().filter(|at| band[*at] == number).collect();
        top = Band { sheet, shapes: &shapes, columns: &columns, band: &band, number, readers: &readers, feeds: &feeds }
            .place(&members, top, &mut grid)
            + 2 * GAP;
    }
    grid
}

/// The parts that read each net.
fn readers(sheet: &Sheet, drawn: &[usize]) -> Vec<Vec<usize>> {
    let mut readers: Vec<Vec<usize>> = vec![Vec::new(); sheet.nets.len()];
    for &at in drawn {
        for pin in sheet.parts[at].pins.iter().filter(|pin| !pin.output) {
            if let Link::Net(net) = pin.link {
                readers[net].push(at);
            }
        }
    }
    readers
}

/// The column of each part: as far to the right as what it feeds allows. A coil or a last box at a wire that leads on stands right after
/// what feeds it: in the last column, that wire would pass all the others on its way.
fn columns(sheet: &Sheet, drawn: &[usize]) -> Vec<usize> {
    // Distance from the right, over the parts that read its outputs. Loops are cut where they close.
    let mut readers = readers(sheet, drawn);
    for _ in 0..sheet.nets.len().min(8) {
        for (at, net) in sheet.nets.iter().enumerate() {
            for source in &net.sources {
                if let Source::Net(from) = source {
                    let more: Vec<usize> =
                        readers[at].iter().copied().filter(|part| !readers[*from].contains(part)).collect();
                    readers[*from].extend(more);
                }
            }
        }
    }
    let mut depth: Vec<Option<usize>> = vec![None; sheet.parts.len()];
    let mut busy: HashSet<usize> = HashSet::new();
    for &start in drawn {
        let mut stack = vec![(start, false)];
        while let Some((at, done)) = stack.pop() {
            if depth[at].is_some() {
                continue;
            }
            let nexts: HashSet<usize> = sheet.parts[at]
                .pins
                .iter()
                .filter(|pin| pin.output)
                .filter_map(|pin| match pin.link {
                    Link::Net(net) => Some(net),
                    Link::Operand(_) | Link::Open => None,
                })
                .flat_map(|net| readers[net].iter().copied())
                .collect();
            if done {
                busy.remove(&at);
                depth[at] =
                    Some(nexts.iter().filter_map(|next| depth[*next]).map(|depth| depth + 1).max().unwrap_or(0));
                continue;
            }
            if !busy.insert(at) {
                continue;
            }
            stack.push((at, true));
            stack.extend(
                nexts
                    .into_iter()
                    .filter(|next| depth[*next].is_none() && !busy.contains(next))
                    .map(|next| (next, false)),
            );
        }
    }
    let deepest = depth.iter().flatten().copied().max().unwrap_or(0);
    let mut columns: Vec<usize> = depth.iter().map(|depth| deepest - depth.unwrap_or(0)).collect();
    for &at in drawn {
        let part = &sheet.parts[at];
        let may_end = matches!(part.meaning, Meaning::Through | Meaning::Other);
        let Some(net) = part.net(part.flow_in).filter(|_| may_end) else { continue };
        let nets = |output: bool| {
            part.pins.iter().filter(move |pin| pin.output == output).filter_map(|pin| match pin.link {
                Link::Net(net) => Some(net),
                Link::Operand(_) | Link::Open => None,
            })
        };
        let ends = nets(true).next().is_none();
        let leads_on = readers[net].iter().any(|other| columns[*other] < columns[at]);
        // All that its pins need is before it. What feeds the flow must be a part.
        let feeders = nets(false).flat_map(|own| sheet.nets[own].sources.iter().map(move |source| (own, source)));
        let feeders = feeders.map(|(own, source)| match source {
            Source::Pin { part, .. } => Some(columns[*part] + 1),
            Source::Rail | Source::Operand { .. } if own != net => Some(0),
            Source::Rail | Source::Operand { .. } | Source::Net(_) => None,
        });
        let feeders: Option<Vec<usize>> = feeders.collect();
        let after = feeders.and_then(|columns| columns.into_iter().max());
        if let Some(after) = after.filter(|after| ends && leads_on && *after < columns[at]) {
            columns[at] = after;
        }
    }
    columns
}

/// Columns that fit beside each other.
struct Band<'a> {
    sheet: &'a Sheet,
    shapes: &'a [Shape],
    columns: &'a [usize],
    band: &'a [usize],
    number: usize,
    /// Parts that read a net.
    readers: &'a [Vec<usize>],
    /// Nets that feed another net.
    feeds: &'a [bool],
}

/// Where a net begins and ends within a band.
#[derive(Default)]
struct Way {
    /// Columns whose right side it leaves.
    starts: Vec<usize>,
    /// Columns whose left side it enters.
    ends: Vec<usize>,
    elsewhere_from: bool,
    elsewhere_to: bool,
}

impl Band<'_> {
    /// Adds the band to `grid`, below `top`; returns its lower edge.
    fn place(&self, members: &[usize], top: i32, grid: &mut Grid) -> i32 {
        let base = grid.columns.len();
        grid.bands.push(base);
        // A band begins with a column for what comes from elsewhere and for operands.
        let count = members.iter().map(|at| self.columns[*at]).max().unwrap_or(0) + 3;
        let column_of = |at: usize| self.columns[at] + 1;
        for _ in 0..count {
            grid.columns.push(Vec::new());
            grid.outs.push(Vec::new());
            grid.ins.push(Vec::new());
        }
        let mut ways: Vec<Way> = (0..self.sheet.nets.len()).map(|_| Way::default()).collect();
        for &at in members {
            for (index, pin) in self.sheet.parts[at].pins.iter().enumerate() {
                let Link::Net(net) = pin.link else { continue };
                if !self.shapes[at].ends.contains_key(&index) {
                    continue;
                }
                if pin.output { ways[net].starts.push(column_of(at)) } else { ways[net].ends.push(column_of(at)) }
            }
        }
        let mut things: Vec<Vec<(Thing, usize)>> = (0..count).map(|_| Vec::new()).collect();
        let order = self.order(members);
        for &at in members {
            things[column_of(at)].push((Thing::Box { part: at, shape: self.shapes[at].clone() }, order[&at] * 4 + 1));
        }
        for (net, way) in ways.iter_mut().enumerate() {
            self.complete(net, way);
            let rank = self.rank(net, &order);
            let name = &self.sheet.nets[net].name;
            let first_end = way.ends.iter().copied().min();
            if let Some(end) = first_end {
                for source in &self.sheet.nets[net].sources {
                    if let Source::Operand { label, negated } = source {
                        things[end - 1]
                            .push((Thing::Operand { net, label: label.clone(), negated: *negated }, rank * 4));
                        way.starts.push(end - 1);
                    }
                }
                // A source right of all that it feeds: the wire goes on at the left.
                let last_end = way.ends.iter().copied().max().unwrap_or(end);
                let before = way.starts.iter().min().is_some_and(|start| *start >= end);
                let loops = before || way.starts.iter().max().is_some_and(|start| *start >= last_end);
                let rail = self.sheet.nets[net].sources.contains(&Source::Rail);
                if way.elsewhere_from || loops || way.starts.is_empty() && !rail {
                    let text = if way.starts.is_empty() && !way.elsewhere_from {
                        "<??.?>".to_string()
                    } else {
                        format!("{name}»")
                    };
                    things[end - 1].push((Thing::From { net, text }, rank * 4));
                    way.starts.push(end - 1);
                    way.elsewhere_to |= loops;
                }
            }
            // Outputs that are joined and lead nowhere.
            way.elsewhere_to |= way.starts.len() > 1 && way.ends.is_empty();
            if way.elsewhere_to
                && let Some(start) = way.starts.iter().copied().max()
            {
                let at = (start + 1).min(count - 1);
                things[at].push((Thing::To { net, text: format!("»{name}") }, rank * 4 + 2));
                way.ends.push(at);
            }
            // Columns that the wire passes.
            if let (Some(start), Some(end)) = (way.starts.iter().min(), way.ends.iter().max()) {
                for list in things.iter_mut().take(*end).skip(start + 1) {
                    list.push((Thing::Wire { net }, rank * 4 + 3));
                }
            }
        }
        for (column, list) in things.into_iter().enumerate() {
            self.column(base + column, list, grid);
        }
        self.heights(base, count, top, grid)
    }

    /// Sources and readers in other bands.
    fn complete(&self, net: usize, way: &mut Way) {
        let elsewhere = |part: usize| self.band.get(part).is_some_and(|band| *band != self.number);
        for source in &self.sheet.nets[net].sources {
            match source {
                Source::Pin { part, .. } => way.elsewhere_from |= elsewhere(*part) && !way.ends.is_empty(),
                Source::Net(_) => way.elsewhere_from |= !way.ends.is_empty(),
                Source::Rail | Source::Operand { .. } => {}
            }
        }
        if !way.starts.is_empty() {
            way.elsewhere_to |= self.feeds[net] || self.readers[net].iter().any(|part| elsewhere(*part));
        }
    }

    /// The order of boxes from top to bottom: that of a walk from the outputs back to the inputs.
    fn order(&self, members: &[usize]) -> HashMap<usize, usize> {
        let mut order = HashMap::new();
        let inside: HashSet<usize> = members.iter().copied().collect();
        let mut roots: Vec<usize> = members.to_vec();
        roots.sort_by_key(|at| (usize::MAX - self.columns[*at], *at));
        // The rungs stay in their order: the walk begins at the first part whose outputs no part of the band reads.
        roots.sort_by_key(|at| {
            let written = |pin: &crate::sheet::Pin| matches!(pin.link, Link::Net(net) if pin.output && self.is_read(net, &inside));
            (self.sheet.parts[*at].pins.iter().any(written), *at)
        });
        let mut seen: HashSet<usize> = HashSet::new();
        for root in roots {
            let mut stack = vec![(root, false)];
            while let Some((at, done)) = stack.pop() {
                if done {
                    let number = order.len();
                    order.entry(at).or_insert(number);
                    continue;
                }
                if !inside.contains(&at) || !seen.insert(at) {
                    continue;
                }
                stack.push((at, true));
                for pin in self.sheet.parts[at].pins.iter().rev().filter(|pin| !pin.output) {
                    let Link::Net(net) = pin.link else { continue };
                    for source in self.sheet.nets[net].sources.iter().rev() {
                        if let Source::Pin { part, .. } = source {
                            stack.push((*part, false));
                        }
                    }
                }
            }
        }
        order
    }

    fn is_read(&self, net: usize, inside: &HashSet<usize>) -> bool {
        self.readers[net].iter().any(|at| inside.contains(at))
    }

    /// The order of a wire among boxes: that of the last box that it leads to.
    fn rank(&self, net: usize, order: &HashMap<usize, usize>) -> usize {
        self.readers[net].iter().filter_map(|at| order.get(at)).copied().max().unwrap_or(0)
    }

    fn column(&self, column: usize, mut list: Vec<(Thing, usize)>, grid: &mut Grid) {
        list.sort_by_key(|(_, rank)| *rank);
        for (index, (thing, _)) in list.into_iter().enumerate() {
            let text_width = |text: &str| metrics::width(text, Ink::Operand.height()) + 16;
            let (mut outs, mut ins) = (Vec::new(), Vec::new());
            let (width, up, down) = match &thing {
                Thing::Box { part, shape } => {
                    for (pin, end) in &shape.ends {
                        let Link::Net(net) = self.sheet.parts[*part].pins[*pin].link else { continue };
                        let end = End { thing: index, dy: end.1, net };
                        if self.sheet.parts[*part].pins[*pin].output { outs.push(end) } else { ins.push(end) }
                    }
                    (shape.width, shape.up, shape.down)
                }
                Thing::Wire { net } => {
                    outs.push(End { thing: index, dy: 0, net: *net });
                    ins.push(End { thing: index, dy: 0, net: *net });
                    (0, 4, 4)
                }
                Thing::Operand { net, label, negated } => {
                    outs.push(End { thing: index, dy: 0, net: *net });
                    (text_width(&label.text) + if *negated { 8 } else { 0 }, 10, 10)
                }
                Thing::From { net, text } => {
                    outs.push(End { thing: index, dy: 0, net: *net });
                    (text_width(text), 10, 10)
                }
                Thing::To { net, text } => {
                    ins.push(End { thing: index, dy: 0, net: *net });
                    (text_width(text), 10, 10)
                }
            };
            outs.sort_by_key(|end| (end.dy, end.net));
            ins.sort_by_key(|end| (end.dy, end.net));
            grid.outs[column].extend(outs);
            grid.ins[column].extend(ins);
            grid.columns[column].push(Placed { thing, width, y: 0, up, down });
        }
    }

    /// Heights: first from the right, so that what feeds a pin is in its row; then from the left, so that a box moves down to what feeds it.
    fn heights(&self, base: usize, count: usize, top: i32, grid: &mut Grid) -> i32 {
        let firsts = |ends: &Vec<End>| {
            let mut firsts: HashMap<usize, End> = HashMap::new();
            ends.iter().for_each(|end| {
                firsts.entry(end.net).or_insert(*end);
            });
            firsts
        };
        let outs: Vec<HashMap<usize, End>> = grid.outs[base..].iter().map(firsts).collect();
        let ins: Vec<HashMap<usize, End>> = grid.ins[base..].iter().map(firsts).collect();
        for pass in 0..3 {
            let from_left = pass == 1;
            let list: Vec<usize> =
                if from_left { (base..base + count).collect() } else { (base..base + count).rev().collect() };
            for column in list {
                let neighbour = if from_left {
                    column.checked_sub(1).filter(|c| *c >= base)
                } else {
                    Some(column + 1).filter(|c| *c < base + count)
                };
                let mut bottom = top;
                for index in 0..grid.columns[column].len() {
                    let wanted = neighbour.and_then(|other| {
                        let (mine, theirs) = match from_left {
                            true => (&grid.ins[column], &outs[other - base]),
                            false => (&grid.outs[column], &ins[other - base]),
                        };
                        wanted(of(mine, index), theirs, &grid.columns[other])
                    });
                    let thing = &grid.columns[column][index];
                    let least = bottom + thing.up;
                    let current = if pass == 0 { least } else { thing.y };
                    let mut y = least.max(wanted.unwrap_or(current));
                    if pass == 2 {
                        y = y.max(current.min(y + 400)).max(least);
                    }
                    let thing = &mut grid.columns[column][index];
                    thing.y = y;
                    let is_wire = matches!(thing.thing, Thing::Wire { .. });
                    bottom = y + thing.down + if is_wire { 2 } else { GAP };
                }
            }
        }
        // The last word: from the left, ends that are too near to those of other nets move down.
        for column in base..base + count {
            let mut bottom = top;
            // Heights at the other side of the channel, in order.
            let mut others: Vec<(i32, usize)> = match column > base {
                true => grid.outs[column - 1]
                    .iter()
                    .map(|end| (grid.columns[column - 1][end.thing].y + end.dy, end.net))
                    .collect(),
                false => Vec::new(),
            };
            others.sort_unstable();
            for index in 0..grid.columns[column].len() {
                let least = bottom + grid.columns[column][index].up;
                let y = least.max(grid.columns[column][index].y);
                let y = apart(of(&grid.ins[column], index), &others, y);
                let thing = &mut grid.columns[column][index];
                thing.y = y;
                bottom = y + thing.down + if matches!(thing.thing, Thing::Wire { .. }) { 2 } else { GAP };
            }
        }
        // What has moved down to its neighbours leaves no empty space above.
        let highest = grid.columns[base..base + count].iter().flatten().map(|thing| thing.y - thing.up).min();
        let space = highest.map_or(0, |highest| highest - top);
        grid.columns[base..base + count].iter_mut().flatten().for_each(|thing| thing.y -= space);
        grid.columns[base..base + count].iter().flatten().map(|thing| thing.y + thing.down).max().unwrap_or(top)
    }
}

/// The ends of one thing; ends are in the order of their things.
fn of(ends: &[End], thing: usize) -> &[End] {
    let from = ends.partition_point(|end| end.thing < thing);
    let to = ends.partition_point(|end| end.thing <= thing);
    &ends[from..to]
}

/// The height at which the first net of a thing goes straight to a neighbour.
fn wanted(mine: &[End], theirs: &HashMap<usize, End>, things: &[Placed]) -> Option<i32> {
    mine.iter().find_map(|end| {
        let to = theirs.get(&end.net)?;
        Some(things[to.thing].y + to.dy - end.dy)
    })
}

/// Moves a thing down until none of its ends at the left is in the row of the end of another net at the other side of the channel.
fn apart(mine: &[End], others: &[(i32, usize)], mut y: i32) -> i32 {
    let clash = |y: i32| {
        mine.iter().any(|end| {
            let near = others.partition_point(|(other, _)| *other <= y + end.dy - APART);
            others[near..].iter().take_while(|(other, _)| *other < y + end.dy + APART).any(|(_, net)| *net != end.net)
        })
    };
    while clash(y) {
        y += 1;
    }
    y
}
