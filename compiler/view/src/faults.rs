//! What holds for every drawing of a network: nothing overlaps, no wire crosses a box or a text, wires of different
//! nets are never on top of each other, and the wires of a net are connected. Tests check it.

use crate::scene::{Area, Item, Point, Scene};
use crate::sheet::{Link, Part, Sheet, Source};

/// Why a drawing of a network is wrong, one sentence for each place.
pub fn faults(scene: &Scene, sheet: &Sheet) -> Vec<String> {
    let mut faults = Vec::new();
    let is_solid = |item: &&Item| matches!(item, Item::Frame { .. } | Item::Glyph { .. });
    let solids: Vec<Area> = scene.items.iter().filter(is_solid).filter_map(Item::area).collect();
    let texts: Vec<(&str, Area)> = scene
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Text { text, .. } => Some((text.as_str(), item.area()?)),
            _ => None,
        })
        .collect();
    let wires: Vec<Wire> = scene
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Wire { from, to, net, .. } => Some(Wire { from: *from, to: *to, net: *net }),
            _ => None,
        })
        .collect();
    let page = Area { x: 0, y: 0, w: scene.width, h: scene.height };
    for (index, (text, area)) in texts.iter().enumerate() {
        for (other, known) in &texts[..index] {
            if area.meets(known) {
                faults.push(format!("`{text}` overlaps `{other}`"));
            }
        }
        for solid in &solids {
            if area.meets(solid) && !solid.holds(area) {
                faults.push(format!("`{text}` overlaps the edge of a box"));
            }
        }
        if !page.holds(area) {
            faults.push(format!("`{text}` is outside"));
        }
    }
    for (index, solid) in solids.iter().enumerate() {
        if solids[..index].iter().any(|other| other.meets(solid)) {
            faults.push(format!("boxes overlap at {solid:?}"));
        }
        if !page.holds(solid) {
            faults.push(format!("a box is outside: {solid:?}"));
        }
    }
    for (index, wire) in wires.iter().enumerate() {
        if wire.from.0 != wire.to.0 && wire.from.1 != wire.to.1 {
            faults.push(format!("a wire is not straight: {wire:?}"));
        }
        if solids.iter().any(|solid| wire.crosses(shrunk(*solid, 1))) {
            faults.push(format!("a wire crosses a box: {wire:?}"));
        }
        if let Some((text, _)) = texts.iter().find(|(_, area)| wire.crosses(shrunk(*area, 1))) {
            faults.push(format!("a wire crosses `{text}`: {wire:?}"));
        }
        for other in &wires[..index] {
            if one(sheet, wire.net) != one(sheet, other.net) && wire.covers(other) {
                faults.push(format!("wires of two nets on one line: {wire:?} {other:?}"));
            }
        }
        if !page.holds(&Area { x: wire.low().0, y: wire.low().1, w: 0, h: 0 }) {
            faults.push(format!("a wire is outside: {wire:?}"));
        }
    }
    let has_connectors = texts.iter().any(|(text, _)| text.contains('»') || text.contains("??"));
    if !has_connectors {
        faults.extend(unconnected(sheet, &wires));
    }
    faults
}

/// A wire as a rectangle without an area.
#[derive(Clone, Copy, Debug)]
struct Wire {
    from: Point,
    to: Point,
    net: Option<usize>,
}

impl Wire {
    fn low(&self) -> Point {
        (self.from.0.min(self.to.0), self.from.1.min(self.to.1))
    }

    fn high(&self) -> Point {
        (self.from.0.max(self.to.0), self.from.1.max(self.to.1))
    }

    fn holds(&self, point: Point) -> bool {
        let (low, high) = (self.low(), self.high());
        low.0 <= point.0 && point.0 <= high.0 && low.1 <= point.1 && point.1 <= high.1
    }

    /// The wire has a point inside of `area`.
    fn crosses(&self, area: Area) -> bool {
        let (low, high) = (self.low(), self.high());
        low.0 < area.x + area.w
            && area.x < high.0.max(low.0 + 1)
            && low.1 < area.y + area.h
            && area.y < high.1.max(low.1 + 1)
    }

    fn is_flat(&self) -> bool {
        self.from.1 == self.to.1
    }

    /// Both are on one line and have more than a point in common.
    fn covers(&self, other: &Wire) -> bool {
        if self.is_flat() != other.is_flat() {
            return false;
        }
        let (a, b, c, d) = (self.low(), self.high(), other.low(), other.high());
        match self.is_flat() {
            true => a.1 == c.1 && a.0.max(c.0) < b.0.min(d.0),
            false => a.0 == c.0 && a.1.max(c.1) < b.1.min(d.1),
        }
    }
}

fn shrunk(area: Area, by: i32) -> Area {
    Area { x: area.x + by, y: area.y + by, w: area.w - 2 * by, h: area.h - 2 * by }
}

/// All nets at the rail are one, and stand for one that no net is. Wires before a join belong to the net of the join.
fn one(sheet: &Sheet, net: Option<usize>) -> Option<usize> {
    let net = net.and_then(|net| sheet.nets.get(net)?.joins).or(net);
    let rail =
        |net: &usize| sheet.nets.get(*net).is_none_or(|net| net.sources.iter().all(|source| *source == Source::Rail));
    net.map(|net| if rail(&net) { sheet.nets.len() } else { net })
}

/// Nets whose wires are in several parts, or that lack a wire.
fn unconnected(sheet: &Sheet, wires: &[Wire]) -> Vec<String> {
    let mut faults = Vec::new();
    for net in 0..sheet.nets.len() {
        if one(sheet, Some(net)) != Some(net) {
            continue;
        }
        let mine: Vec<Wire> = wires.iter().filter(|wire| one(sheet, wire.net) == Some(net)).copied().collect();
        let Some(first) = mine.first() else {
            let is_read = |part: &Part| part.pins.iter().any(|pin| pin.link == Link::Net(net));
            if sheet.parts.iter().any(is_read) {
                faults.push(format!("net {net} has no wire"));
            }
            continue;
        };
        let mut reached = vec![*first];
        let mut left: Vec<Wire> = mine[1..].to_vec();
        loop {
            let touches = |wire: &Wire| {
                reached.iter().any(|known| {
                    known.holds(wire.from) || known.holds(wire.to) || wire.holds(known.from) || wire.holds(known.to)
                })
            };
            let (near, far): (Vec<Wire>, Vec<Wire>) = left.iter().partition(|wire| touches(wire));
            left = far;
            if near.is_empty() {
                break;
            }
            reached.extend(near);
        }
        if !left.is_empty() {
            faults.push(format!("net {net} is in parts: {:?}", left[0]));
        }
    }
    faults
}
