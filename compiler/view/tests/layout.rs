//! What holds of every drawing: nothing overlaps, no wire crosses a box or a text, wires of different nets are never on top of each other,
//! and the wires of a net are connected. Checked on random networks, also on such as no editor allows.

use proptest::prelude::*;

use plcc_view::scene::{Area, Item, Point, Scene};
use plcc_view::sheet::{Label, Link, Look, Meaning, Net, Part, Pin, Place, Sheet, Source};
use plcc_view::{diagram, ladder};

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
        low.0 < area.x + area.w && area.x < high.0.max(low.0 + 1) && low.1 < area.y + area.h && area.y < high.1.max(low.1 + 1)
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

/// Why a drawing is wrong.
fn faults(scene: &Scene, sheet: &Sheet) -> Vec<String> {
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
            Item::Wire { from, to, net } => Some(Wire { from: *from, to: *to, net: *net }),
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

/// All nets at the rail are one, and stand for one that no net is.
fn one(sheet: &Sheet, net: Option<usize>) -> Option<usize> {
    let rail = |net: &usize| sheet.nets.get(*net).is_none_or(|net| net.sources.iter().all(|source| *source == Source::Rail));
    net.map(|net| if rail(&net) { sheet.nets.len() } else { net })
}

/// Nets whose wires are in several parts, or that lack a wire.
fn unconnected(sheet: &Sheet, wires: &[Wire]) -> Vec<String> {
    let mut faults = Vec::new();
    for net in 0..sheet.nets.len() {
        if one(sheet, Some(net)) != Some(net) {
            continue;
        }
        let mine: Vec<Wire> = wires.iter().filter(|wire| wire.net == Some(net)).copied().collect();
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

fn pin(name: &str, place: Place, output: bool, link: Link) -> Pin {
    Pin { name: name.to_string(), place, output, link, negated: false }
}

fn operand(number: usize) -> Link {
    let text = ["#Start", "\"Tank\".Valves[3].IsOpen", "I0.0", "a", "\"PumpRunningFeedback\""][number % 5].to_string();
    let address = if number.is_multiple_of(3) { "DB10.DBX2.0".to_string() } else { String::new() };
    Link::Operand(Label { key: text.clone(), text, address })
}

/// A contact, a coil (without `to`) or a box between nets.
fn part(kind: usize, from: usize, to: Option<usize>, reset: Option<usize>, further: Option<usize>) -> Part {
    let mut pins = vec![pin("IN", Place::Side, false, Link::Net(from))];
    let mut flow_out = None;
    if let Some(to) = to {
        flow_out = Some(pins.len());
        pins.push(pin("Q", Place::Side, true, Link::Net(to)));
    }
    let look = match kind % 5 {
        0 | 1 if to.is_some() => {
            pins.push(pin("", Place::Above, false, operand(kind)));
            Look::Contact { sign: if kind.is_multiple_of(2) { String::new() } else { "/".to_string() } }
        }
        2 if to.is_some() => {
            pins.push(pin("", Place::Above, false, operand(kind)));
            pins.push(pin("", Place::Below, false, operand(kind + 1)));
            Look::Compare { sign: ">=".to_string(), ty: "Real".to_string() }
        }
        0..=2 => {
            pins.push(pin("", Place::Above, true, operand(kind)));
            Look::Coil { sign: ["", "S", "SET_BF"][kind % 3].to_string() }
        }
        _ => {
            pins.push(pin("PT", Place::Side, false, operand(kind)));
            pins.push(pin("ET", Place::Side, true, operand(kind + 1)));
            if let Some(reset) = reset {
                pins.push(pin("R", Place::Side, false, Link::Net(reset)));
            }
            if let Some(further) = further {
                pins.push(pin("QD", Place::Side, true, Link::Net(further)));
            }
            let instance = Some(Label::plain("#Instance"));
            Look::Box { title: "CTUD".to_string(), detail: "Int".to_string(), instance }
        }
    };
    Part { look, meaning: Meaning::Other, pins, flow_in: Some(0), flow_out }
}

/// Fills in the sources of nets.
fn finished(parts: Vec<Part>, nets: usize) -> Sheet {
    let mut sheet = Sheet { parts, nets: (0..nets).map(|n| Net { name: format!("w{n}"), sources: Vec::new() }).collect() };
    sheet.nets[0].sources.push(Source::Rail);
    for at in 0..sheet.parts.len() {
        for index in 0..sheet.parts[at].pins.len() {
            let pin = &sheet.parts[at].pins[index];
            if let (Link::Net(net), true) = (&pin.link, pin.output) {
                let net = *net;
                sheet.nets[net].sources.push(Source::Pin { part: at, pin: index });
            }
        }
    }
    sheet
}

/// Any graph: net 0 is the rail.
fn any_sheet(forward: bool) -> impl Strategy<Value = Sheet> {
    let element = (0usize..20, 0usize..9, 0usize..10, proptest::option::weighted(0.3, 0usize..9), proptest::option::weighted(0.2, 1usize..9));
    proptest::collection::vec(element, 1..14).prop_map(move |elements| {
        let parts = elements.into_iter().map(|(kind, from, to, reset, further)| {
            let to = match forward {
                true => Some(from + 1 + to).filter(|to| *to < 9),
                false => Some(to).filter(|to| (1..9).contains(to)),
            };
            part(kind, from, to, reset, further)
        });
        finished(parts.collect(), 9)
    })
}

/// Rungs as editors make them: series, parallel branches and coils, boxes with rungs of their own at further inputs.
#[derive(Clone, Debug)]
enum Rung {
    Element(usize),
    Box(Option<Box<Rung>>),
    Series(Vec<Rung>),
    Parallel(Vec<Rung>),
}

fn rung() -> impl Strategy<Value = Rung> {
    let leaf = (0usize..20).prop_map(Rung::Element);
    leaf.prop_recursive(4, 24, 4, |inner| {
        prop_oneof![
            proptest::option::of(inner.clone()).prop_map(|feed| Rung::Box(feed.map(Box::new))),
            proptest::collection::vec(inner.clone(), 1..5).prop_map(Rung::Series),
            proptest::collection::vec(inner, 2..4).prop_map(Rung::Parallel),
        ]
    })
}

struct Builder {
    parts: Vec<Part>,
    nets: usize,
}

impl Builder {
    fn net(&mut self) -> usize {
        self.nets += 1;
        self.nets - 1
    }

    fn add(&mut self, rung: &Rung, from: usize, to: usize) {
        match rung {
            Rung::Element(kind) => self.parts.push(part(kind % 5 % 3, from, Some(to), None, None)),
            Rung::Box(feed) => {
                let reset = feed.as_ref().map(|feed| {
                    let net = self.net();
                    self.add(feed, 0, net);
                    net
                });
                self.parts.push(part(3, from, Some(to), reset, None));
            }
            Rung::Series(list) => {
                let mut at = from;
                for (index, rung) in list.iter().enumerate() {
                    let next = if index + 1 == list.len() { to } else { self.net() };
                    self.add(rung, at, next);
                    at = next;
                }
            }
            Rung::Parallel(list) => list.iter().for_each(|rung| self.add(rung, from, to)),
        }
    }
}

fn editor_sheet() -> impl Strategy<Value = Sheet> {
    proptest::collection::vec((rung(), 1usize..4), 1..4).prop_map(|rungs| {
        let mut builder = Builder { parts: Vec::new(), nets: 1 };
        for (rung, coils) in rungs {
            let end = builder.net();
            builder.add(&rung, 0, end);
            (0..coils).for_each(|kind| builder.parts.push(part(kind % 3, end, None, None, None)));
        }
        finished(builder.parts, builder.nets)
    })
}

fn check(name: &str, scene: &Scene, sheet: &Sheet) {
    let faults = faults(scene, sheet);
    if let (false, Ok(path)) = (faults.is_empty(), std::env::var("PLCC_VIEW_FAULT")) {
        std::fs::write(path, plcc_view::svg::file(scene)).expect("a file can be written");
    }
    assert!(faults.is_empty(), "{name}: {faults:#?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn rungs_of_editors(sheet in editor_sheet(), width in 300i32..1400) {
        check("LAD", &ladder::draw(&sheet, width), &sheet);
    }

    #[test]
    fn rungs_of_any_graph(sheet in any_sheet(true), width in 300i32..1400) {
        check("LAD", &ladder::draw(&sheet, width), &sheet);
    }

    #[test]
    fn rungs_with_loops(sheet in any_sheet(false), width in 300i32..1400) {
        check("LAD", &ladder::draw(&sheet, width), &sheet);
    }

    #[test]
    fn diagrams_of_editors(sheet in editor_sheet(), width in 300i32..1400) {
        check("FBD", &diagram::draw(&sheet, width), &sheet);
    }

    #[test]
    fn diagrams_of_any_graph(sheet in any_sheet(true), width in 300i32..1400) {
        check("FBD", &diagram::draw(&sheet, width), &sheet);
    }

    #[test]
    fn diagrams_with_loops(sheet in any_sheet(false), width in 300i32..1400) {
        check("FBD", &diagram::draw(&sheet, width), &sheet);
    }
}
