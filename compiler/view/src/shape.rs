//! A part as it is drawn: its symbol or box, the operands at its pins, and where its wires go. LAD and FBD share it.

use std::collections::HashMap;

use crate::metrics::{self, LINE};
use crate::scene::{Anchor, Area, Frame, Glyph, Ink, Point, Scene};
use crate::sheet::{Label, Link, Look, Part, Pin, Place};

/// Characters of a line of an operand.
const CELLS: usize = 22;
/// Characters of a value, at least: other values take the same place.
const VALUE: usize = 8;
/// The line from a box to what is connected to it.
pub const STUB: i32 = 14;
/// Around an operand at the side of a box, so that it does not run into that of the next box.
const BESIDE: i32 = 8;
/// From one pin of a box to the next, at least.
const PITCH: i32 = 22;

/// A part with its place around the flow: the flow enters at (0, 0) and leaves at (width, 0).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    pub width: i32,
    /// Height above and below the flow.
    pub up: i32,
    pub down: i32,
    pub scene: Scene,
    /// Where the wires of its pins end; not of those with an operand.
    pub ends: HashMap<usize, Point>,
}

/// Room that something at a pin needs: above and below its row, and beside the box.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Room {
    pub up: i32,
    pub down: i32,
    pub width: i32,
}

/// The shape of a part. `rooms`: what is drawn at its pins besides operands. `part` is the number of `of`.
pub fn shape(part: usize, of: &Part, rooms: &HashMap<usize, Room>) -> Shape {
    match &of.look {
        Look::Contact { sign } => small(part, of, sign, "", Glyph::Contact),
        Look::Compare { sign, ty } => small(part, of, sign, ty, Glyph::Contact),
        Look::Coil { sign } => small(part, of, sign, "", Glyph::Coil),
        Look::Box { title, detail, instance } => boxed(of, title, detail, instance.as_ref(), rooms),
        Look::Nothing => Shape::default(),
    }
}

/// The lines of an operand.
struct Lines(Vec<(String, Ink)>, String, Option<u32>);

impl Lines {
    /// The name, and the address in a line of its own.
    fn all(label: &Label) -> Lines {
        let mut lines = Lines::name(label);
        if !label.address.is_empty() {
            lines.0.push((label.address.clone(), Ink::Address));
        }
        lines
    }

    fn name(label: &Label) -> Lines {
        let lines = metrics::wrapped(&label.text, CELLS).into_iter().map(|line| (line, Ink::Operand));
        let value = label.value.iter().map(|value| (format!("{value:^VALUE$}"), Ink::Value));
        Lines(lines.chain(value).collect(), label.key.clone(), label.place)
    }

    fn width(&self) -> i32 {
        self.0.iter().map(|(line, ink)| metrics::width(line, ink.height())).max().unwrap_or(0)
    }

    fn height(&self) -> i32 {
        self.0.len() as i32 * LINE
    }

    /// Draws the lines below each other; `top` is the upper edge of the first.
    fn draw(&self, scene: &mut Scene, x: i32, top: i32, anchor: Anchor) {
        for (index, (line, ink)) in self.0.iter().enumerate() {
            scene.operand((x, top + index as i32 * LINE + 10), anchor, *ink, line, &self.1, self.2);
        }
    }
}

fn label(pin: &Pin) -> Option<Label> {
    match &pin.link {
        Link::Operand(label) => Some(label.clone()),
        Link::Net(_) => None,
        Link::Open if pin.output => None,
        Link::Open => Some(Label::plain("...")),
    }
}

/// A contact, a coil or a comparison: the first operand above, the others below.
fn small(part: usize, of: &Part, sign: &str, ty: &str, kind: Glyph) -> Shape {
    let place = |place: Place| of.pins.iter().filter(move |pin| pin.place == place).filter_map(label);
    let below: Vec<Label> = place(Place::Below).collect();
    let above: Vec<Lines> = place(Place::Above)
        .map(|label| if below.is_empty() { Lines::name(&label) } else { Lines::all(&label) })
        .collect();
    let mut lower: Vec<Lines> = Vec::new();
    if below.is_empty() {
        let addresses = place(Place::Above).filter(|label| !label.address.is_empty());
        lower.extend(addresses.map(|label| Lines(vec![(label.address, Ink::Address)], label.key, None)));
    }
    lower.extend(below.iter().map(Lines::all));
    let inner = metrics::width(sign, 11).max(metrics::width(ty, metrics::SMALL));
    let glyph_width = match kind {
        Glyph::Contact if matches!(sign, "" | "/") => 10,
        Glyph::Contact => inner + 8,
        Glyph::Coil => (inner + 12).max(22),
    };
    let half = if ty.is_empty() { 9 } else { 15 };
    let texts = above.iter().chain(&lower).map(Lines::width).max().unwrap_or(0);
    let width = (glyph_width + 40).max(texts + 14);
    let middle = width / 2;
    let left = middle - glyph_width / 2;
    let mut shape = Shape { width, ..Shape::default() };
    let scene = &mut shape.scene;
    let area = Area { x: left, y: -half, w: glyph_width, h: 2 * half };
    let shown = if ty.is_empty() { sign } else { "" };
    scene.items.push(crate::scene::Item::Glyph { area, kind, sign: shown.to_string(), part });
    if !ty.is_empty() {
        scene.text((middle, -1), Anchor::Middle, Ink::Plain, sign, "");
        scene.text((middle, 11), Anchor::Middle, Ink::Detail, ty, "");
    }
    let mut top = -half - 4;
    for lines in above.iter().rev() {
        top -= lines.height();
        lines.draw(scene, middle, top, Anchor::Middle);
    }
    let mut bottom = half + 3;
    for lines in &lower {
        lines.draw(scene, middle, bottom, Anchor::Middle);
        bottom += lines.height();
    }
    if let (Some(net), Some(pin)) = (of.net(of.flow_in), of.flow_in) {
        scene.wire((0, 0), (left, 0), Some(net));
        shape.ends.insert(pin, (0, 0));
    }
    if let (Some(net), Some(pin)) = (of.net(of.flow_out), of.flow_out) {
        scene.wire((left + glyph_width, 0), (width, 0), Some(net));
        shape.ends.insert(pin, (width, 0));
    }
    (shape.up, shape.down) = (-top + 2, bottom + 3);
    // Pins without an operand: a net that a named connector leads to.
    for (index, pin) in of.pins.iter().enumerate() {
        if matches!(pin.link, Link::Net(_)) && pin.place != Place::Side {
            shape.ends.insert(index, (middle, if pin.place == Place::Above { -half } else { half }));
        }
    }
    shape
}

/// A box: the flow in the first row, then the other pins.
fn boxed(of: &Part, title: &str, detail: &str, instance: Option<&Label>, rooms: &HashMap<usize, Room>) -> Shape {
    let column = |output: bool, flow: Option<usize>| -> Vec<Option<usize>> {
        std::iter::once(flow).chain(of.side(output).map(Some)).collect()
    };
    let (lefts, rights) = (column(false, of.flow_in), column(true, of.flow_out));
    let pin = |at: &Option<usize>| at.and_then(|at| of.pins.get(at));
    let text = |at: &Option<usize>| pin(at).and_then(label).map(|label| Lines::all(&label));
    let name = |at: &Option<usize>| pin(at).map_or("", |pin| pin.name.as_str());
    let names =
        |list: &[Option<usize>]| list.iter().map(|at| metrics::width(name(at), metrics::SMALL)).max().unwrap_or(0);
    let beside = |list: &[Option<usize>]| {
        let room = |at: &Option<usize>| at.and_then(|at| rooms.get(&at)).map_or(0, |room| room.width);
        list.iter().map(|at| text(at).map_or(0, |lines| lines.width() + BESIDE).max(room(at))).max().unwrap_or(0)
    };
    let titles: Vec<(String, Ink)> = metrics::wrapped(title, 26)
        .into_iter()
        .map(|line| (line, Ink::Title))
        .chain(detail.lines().flat_map(|line| metrics::wrapped(line, 26)).map(|line| (line, Ink::Detail)))
        .collect();
    let title_width = titles.iter().map(|(line, ink)| metrics::width(line, ink.height())).max().unwrap_or(0);
    let (left_names, right_names) = (names(&lefts), names(&rights));
    let is_sign = left_names == 0 && right_names == 0;
    let inner = (left_names + right_names + 22).max(title_width + 14).max(if is_sign { 36 } else { 60 });
    let upper: Vec<Lines> = instance
        .into_iter()
        .map(Lines::all)
        .chain(of.pins.iter().filter(|pin| pin.place == Place::Above).filter_map(label).map(|label| Lines::all(&label)))
        .collect();
    let lower: Vec<Lines> = of
        .pins
        .iter()
        .filter(|pin| pin.place == Place::Below)
        .filter_map(label)
        .map(|label| Lines::all(&label))
        .collect();
    let (left_space, right_space) = (beside(&lefts) + STUB, beside(&rights) + STUB);
    let outer = upper.iter().chain(&lower).map(Lines::width).max().unwrap_or(0);
    let left = left_space.max((outer - inner) / 2 + 4);
    let right = right_space.max((outer - inner) / 2 + 4);

    let needs = |at: &Option<usize>| {
        let lines = text(at).map_or(0, |lines| lines.height() / 2);
        let room = at.and_then(|at| rooms.get(&at)).copied().unwrap_or_default();
        (lines.max(room.up), lines.max(room.down))
    };
    let Rows { ys, up, down } = rows(&lefts, &rights, needs);
    let last = ys.last().copied().unwrap_or(0);
    let header = titles.len() as i32 * LINE + if is_sign { 2 } else { 12 };
    let area = Area { x: left, y: -header, w: inner, h: header + last + 12 };
    let mut shape = Shape { width: left + inner + right, ..Shape::default() };
    let scene = &mut shape.scene;
    scene.frame(area, Frame::Box, "");
    scene.zone(area, of.place.or(of.statement));
    for (index, (line, ink)) in titles.iter().enumerate() {
        scene.text((left + inner / 2, area.y + 13 + index as i32 * LINE), Anchor::Middle, *ink, line, "");
    }
    let mut top = area.y - 4;
    for lines in upper.iter().rev() {
        top -= lines.height();
        lines.draw(scene, left + inner / 2, top, Anchor::Middle);
    }
    let mut bottom = area.y + area.h + 3;
    for lines in &lower {
        lines.draw(scene, left + inner / 2, bottom, Anchor::Middle);
        bottom += lines.height();
    }
    let widths = Widths { left, inner, right };
    for (row, y) in ys.iter().enumerate() {
        if let Some(Some(at)) = lefts.get(row) {
            draw_end(&mut shape, of, (*at, *y), false, widths);
        }
        if let Some(Some(at)) = rights.get(row) {
            draw_end(&mut shape, of, (*at, *y), true, widths);
        }
    }
    shape.up = (-top + 2).max(up);
    shape.down = (bottom + 2).max(last + down + 2);
    shape
}

/// The rows of a box, and the room that its first row needs above and its last one below.
struct Rows {
    /// Their middles, the first at 0.
    ys: Vec<i32>,
    up: i32,
    down: i32,
}

/// Lays out the rows of a box. `needs`: the room above and below the middle that a pin takes beside it.
fn rows(lefts: &[Option<usize>], rights: &[Option<usize>], needs: impl Fn(&Option<usize>) -> (i32, i32)) -> Rows {
    let count = lefts.len().max(rights.len());
    let mut ys: Vec<i32> = Vec::with_capacity(count);
    let (mut up, mut down) = (0, 0);
    for row in 0..count {
        let both = [lefts.get(row), rights.get(row)].map(|at| at.map_or((0, 0), &needs));
        let (above, below) = (both[0].0.max(both[1].0), both[0].1.max(both[1].1));
        match ys.last() {
            None => {
                ys.push(0);
                up = above;
            }
            Some(last) => ys.push(last + PITCH.max(down + above + 4)),
        }
        down = below;
    }
    Rows { ys, up, down }
}

/// Widths of a box, and of what is beside it on the left and on the right.
#[derive(Clone, Copy)]
struct Widths {
    left: i32,
    inner: i32,
    right: i32,
}

/// Draws the pin at index `at` of a box, in the row with the middle `y`: its name, its circle if it is negated, its wire and its operand.
fn draw_end(shape: &mut Shape, of: &Part, (at, y): (usize, i32), is_right: bool, widths: Widths) {
    let Widths { left, inner, right } = widths;
    let scene = &mut shape.scene;
    let pin = &of.pins[at];
    let (edge, stub) = if is_right { (left + inner, left + inner + STUB) } else { (left, left - STUB) };
    let (wire_edge, towards) = match (pin.negated, is_right) {
        (false, _) => (edge, 0),
        (true, true) => (edge + 7, 3),
        (true, false) => (edge - 7, -4),
    };
    let is_flow = Some(at) == of.flow_in || Some(at) == of.flow_out;
    let net = match &pin.link {
        Link::Net(net) => Some(*net),
        Link::Operand(_) | Link::Open => None,
    };
    if pin.negated {
        scene.items.push(crate::scene::Item::Circle { at: (edge + towards, y), net });
    }
    let lines = label(pin).map(|label| Lines::all(&label));
    if net.is_some() || lines.is_some() {
        let far = match (is_flow && net.is_some(), is_right) {
            (true, true) => left + inner + right,
            (true, false) => 0,
            (false, _) => stub,
        };
        let (from, to) = if is_right { (wire_edge, far) } else { (far, wire_edge) };
        let place = lines.as_ref().and_then(|lines| lines.2);
        scene.wire_at((from, y), (to, y), net, place);
        if net.is_some() {
            shape.ends.insert(at, (far, y));
        }
    }
    if let Some(lines) = lines {
        let (x, anchor) = if is_right { (stub + 3, Anchor::Start) } else { (stub - 3, Anchor::End) };
        lines.draw(scene, x, y - lines.height() / 2, anchor);
    }
    let (x, anchor) = if is_right { (edge - 4, Anchor::End) } else { (edge + 4, Anchor::Start) };
    scene.text((x, y + 3), anchor, Ink::Pin, &pin.name, "");
}
