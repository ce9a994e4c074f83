//! Blocks at their places.

use super::measure::{Kind, LEAD, Laid, RAIL, joint};
use crate::scene::{Anchor, Item, Scene};
use crate::sheet::{Link, Look, Net, Sheet, Source};

/// Height of the short rail at which an inner rung begins, above and below its line.
const SHORT_RAIL: i32 = 7;

/// Paints rungs.
pub struct Painter<'a> {
    sheet: &'a Sheet,
    scene: Scene,
    /// The nets of the sheet that lead somewhere.
    read: Vec<bool>,
    /// Where the power rail is.
    rail: Option<i32>,
    /// Nets of wires before joins; the first has the number after that of the rail.
    branches: Vec<Net>,
}

impl<'a> Painter<'a> {
    pub fn new(sheet: &'a Sheet) -> Painter<'a> {
        let mut read = vec![false; sheet.nets.len()];
        let pins = sheet.parts.iter().flat_map(|part| &part.pins).filter(|pin| !pin.output);
        let by_pins = pins.filter_map(|pin| if let Link::Net(net) = pin.link { Some(net) } else { None });
        let sources = sheet.nets.iter().flat_map(|net| &net.sources);
        let by_nets = sources.filter_map(|source| if let Source::Net(net) = source { Some(*net) } else { None });
        for net in by_pins.chain(by_nets) {
            if let Some(read) = read.get_mut(net) {
                *read = true;
            }
        }
        Painter { sheet, scene: Scene::default(), read, rail: None, branches: Vec::new() }
    }

    /// The drawing, and the nets of wires before joins.
    pub fn finish(self) -> (Scene, Vec<Net>) {
        (self.scene, self.branches)
    }

    /// Paints a rung. Its flow comes from the rail, `RAIL` left of `x`, unless it begins at a connector.
    pub fn rung(&mut self, laid: &Laid, (x, y): (i32, i32), width: i32) {
        let before = (!laid.loose).then_some(self.sheet.nets.len());
        if before.is_some() {
            self.scene.wire((x - RAIL, y), (x, y), before);
        }
        self.rail = Some(x - RAIL);
        self.block(laid, (x, y), width, before, None);
    }

    fn net(&self, net: usize) -> Option<&Net> {
        match net.checked_sub(self.sheet.nets.len() + 1) {
            Some(branch) => self.branches.get(branch),
            None => self.sheet.nets.get(net),
        }
    }

    /// The net of the wires between a block and `net`, which it leads to: `net`, unless others join it.
    fn own(&mut self, laid: &Laid, net: Option<usize>) -> Option<usize> {
        let of = self.net(net?);
        let (all, joined) = of.map_or((0, None), |of| (of.sources.len(), of.joins.or(net)));
        let mut sources = Vec::new();
        if all < 2 || !self.feeders(laid, joined?, &mut sources) || sources.len() >= all {
            return net;
        }
        self.branches.push(Net { sources, joins: joined, ..Net::default() });
        Some(self.sheet.nets.len() + self.branches.len())
    }

    /// Adds what feeds `net` from inside of a block that leads to it. False: it is not known.
    fn feeders(&self, laid: &Laid, net: usize, sources: &mut Vec<Source>) -> bool {
        match &laid.kind {
            Kind::Part { part, .. } => {
                let of = &self.sheet.parts[*part];
                let (Some(pin), Some(to)) = (of.flow_out, of.net(of.flow_out)) else { return false };
                sources.push(if to == net { Source::Pin { part: *part, pin } } else { Source::Net(to) });
                true
            }
            Kind::Series(items) => match items.last() {
                Some((_, Some(to))) if *to != net => {
                    sources.push(Source::Net(*to));
                    true
                }
                Some((item, _)) => self.feeders(item, net, sources),
                None => false,
            },
            Kind::Lines(lines) => lines.last().is_some_and(|line| self.feeders(line, net, sources)),
            Kind::Parallel(branches) => {
                branches.iter().filter(|branch| !branch.ends).all(|branch| self.feeders(branch, net, sources))
            }
            Kind::Fork { main, .. } => main.as_ref().is_some_and(|main| self.feeders(main, net, sources)),
            Kind::Connector { .. } => false,
        }
    }

    /// Paints a block in a space of `width`, which is at least its own. `before` and `after`: the nets at its ends.
    fn block(&mut self, laid: &Laid, (x, y): (i32, i32), width: i32, before: Option<usize>, after: Option<usize>) {
        match &laid.kind {
            Kind::Part { .. } => self.part(laid, (x, y), after),
            Kind::Series(items) => self.series(laid, items, (x, y), width, before, after),
            Kind::Lines(lines) => {
                let end = x + width - LEAD;
                let rows = laid.rows();
                for (line, row) in lines.iter().zip(&rows) {
                    let (first, last) = (*row == rows[0], row == rows.last().unwrap_or(&0));
                    let space = if last { end - x } else { line.width };
                    self.block(line, (x, y + row), space, before.filter(|_| first), after.filter(|_| last));
                }
                if let (false, Some(last)) = (laid.ends, rows.last()) {
                    self.scene.wire((end, y + last), (x + width, y + last), after);
                    self.scene.wire((x + width, y), (x + width, y + last), after);
                }
            }
            Kind::Parallel(branches) => {
                let (left, right) = (x + LEAD, x + width - LEAD);
                // What is open ends before the place where something else may begin.
                let is_open = after.is_some_and(|net| self.read.get(net) == Some(&false));
                let end = if is_open { right + LEAD / 2 } else { x + width };
                let rows = laid.rows();
                for (branch, row) in branches.iter().zip(&rows) {
                    if !branch.loose {
                        self.scene.wire((x, y + row), (left, y + row), before);
                    }
                    let own = self.own(branch, after);
                    self.block(branch, (left, y + row), right - left, before, own);
                    if !branch.ends {
                        self.scene.wire((right, y + row), (end, y + row), own);
                    }
                }
                self.spine(branches.iter().zip(&rows).filter(|(b, _)| !b.loose).map(|(_, r)| *r), x, y, before);
                self.spine(branches.iter().zip(&rows).filter(|(b, _)| !b.ends).map(|(_, r)| *r), end, y, after);
            }
            Kind::Fork { main, .. } => {
                let rows = laid.rows();
                let branches = laid.branches();
                for (index, (branch, row)) in branches.iter().zip(&rows).enumerate() {
                    if !branch.loose {
                        self.scene.wire((x, y + row), (x + LEAD, y + row), before);
                    }
                    let after = after.filter(|_| index == 0 && main.is_some());
                    self.block(branch, (x + LEAD, y + row), width - LEAD, before, after);
                }
                self.spine(branches.iter().zip(&rows).filter(|(b, _)| !b.loose).map(|(_, r)| *r), x, y, before);
            }
            Kind::Connector { text, ink, goes_on, negated, key } => {
                if text.is_empty() {
                    return;
                }
                let text_width = laid.width - 18;
                match goes_on {
                    true => {
                        self.scene.text((x, y + 4), Anchor::Start, *ink, text, key);
                        let from = x + text_width + 4;
                        if *negated {
                            self.scene.items.push(Item::Circle { at: (from + 4, y), net: after });
                        }
                        self.scene.wire((from + if *negated { 8 } else { 0 }, y), (x + laid.width, y), after);
                        self.scene.wire((x + laid.width, y), (x + width, y), after);
                    }
                    false => {
                        self.scene.wire((x, y), (x + 14, y), before);
                        self.scene.text((x + 17, y + 4), Anchor::Start, *ink, text, key);
                    }
                }
            }
        }
    }

    /// The line that joins branches at one side.
    fn spine(&mut self, rows: impl Iterator<Item = i32>, x: i32, y: i32, net: Option<usize>) {
        // The flow of the block itself is in the first row.
        let last = rows.max().unwrap_or(0);
        self.scene.wire((x, y), (x, y + last), net);
    }

    fn series(
        &mut self,
        laid: &Laid,
        items: &[(Laid, Option<usize>)],
        (x, y): (i32, i32),
        width: i32,
        before: Option<usize>,
        after: Option<usize>,
    ) {
        let mut at = x;
        let mut net = before;
        let mut loose = laid.loose;
        let outer = self.rail;
        for (index, (item, next)) in items.iter().enumerate() {
            let is_last = index + 1 == items.len();
            let gap = if index == 0 { 0 } else { joint(&items[index - 1].0, item) };
            if gap > 0 && !loose {
                self.scene.wire((at, y), (at + gap, y), net);
            }
            at += gap;
            let next = self.own(item, if is_last { after.or(*next) } else { *next });
            let free = x + width - at - item.width;
            let mut space = item.width;
            if is_last && free > 0 {
                match (&item.kind, item.ends) {
                    (Kind::Part { .. }, true) if item.is_coil(self.sheet) => {
                        self.scene.wire((at, y), (at + free, y), net.filter(|_| !loose));
                        at += free;
                    }
                    (Kind::Part { .. } | Kind::Connector { .. }, _) => {}
                    (Kind::Series(_) | Kind::Lines(_) | Kind::Parallel(_) | Kind::Fork { .. }, _) => space += free,
                }
            }
            if index > 0 {
                self.rail = outer.filter(|_| matches!(&item.kind, Kind::Part { railed: true, .. }));
            }
            self.block(item, (at, y), space, net, next);
            self.rail = outer;
            at += space;
            net = next;
            loose = loose && item.width == 0;
        }
        if !laid.ends && !loose {
            self.scene.wire((at, y), (x + width, y), net);
        }
    }

    fn part(&mut self, laid: &Laid, (x, y): (i32, i32), after: Option<usize>) {
        let Kind::Part { shape, feeds, tails, connectors, railed, .. } = &laid.kind else { return };
        let mut drawn = shape.scene.clone();
        if let Some((own, joined)) = after.and_then(|own| Some((own, self.net(own)?.joins?))) {
            drawn.exchange(joined, own);
        }
        self.scene.add(drawn, (x, y));
        let rail_net = Some(self.sheet.nets.len());
        let place = |pin: &usize| shape.ends.get(pin).map(|end| (x + end.0, y + end.1));
        for (pin, net, feed) in feeds {
            let Some(end) = place(pin) else { continue };
            let rail = self.rail.filter(|_| *railed && !feed.loose);
            let start = rail.map_or(end.0 - feed.width, |rail| rail + RAIL);
            self.scene.wire((start + feed.width, end.1), end, Some(*net));
            if !feed.loose {
                match rail {
                    Some(rail) => self.scene.wire((rail, end.1), (start, end.1), rail_net),
                    None => self
                        .scene
                        .items
                        .push(Item::Rail { from: (start, end.1 - SHORT_RAIL), to: (start, end.1 + SHORT_RAIL) }),
                }
            }
            let outer = self.rail.take();
            self.block(feed, (start, end.1), feed.width, rail_net, Some(*net));
            self.rail = outer;
        }
        for (pin, net, tail) in tails {
            let Some(end) = place(pin) else { continue };
            let outer = self.rail.take();
            self.block(tail, end, tail.width, Some(*net), None);
            self.rail = outer;
        }
        for (pin, name) in connectors {
            let Some(end) = place(pin) else { continue };
            let part = self.sheet.parts.get(part_of(laid));
            // The operands of a comparison are above and below its bars.
            if part.is_some_and(|part| matches!(part.look, Look::Compare { .. })) {
                let dy = if end.1 < y { -6 } else { 13 };
                self.scene.text((end.0, end.1 + dy), Anchor::Middle, crate::scene::Ink::Mark, &format!("{name}»"), "");
                continue;
            }
            let output = part.and_then(|part| part.pins.get(*pin)).is_some_and(|pin| pin.output);
            let (text, anchor, dx) = match output {
                true => (format!("»{name}"), Anchor::Start, 3),
                false => (format!("{name}»"), Anchor::End, -3),
            };
            self.scene.text((end.0 + dx, end.1 + 4), anchor, crate::scene::Ink::Mark, &text, "");
        }
    }
}

fn part_of(laid: &Laid) -> usize {
    match &laid.kind {
        Kind::Part { part, .. } => *part,
        Kind::Series(_) | Kind::Lines(_) | Kind::Parallel(_) | Kind::Fork { .. } | Kind::Connector { .. } => usize::MAX,
    }
}
