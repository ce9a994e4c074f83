//! A drawing: lines, rectangles and texts at their places, in pixels. What they look like is one style sheet.

use crate::metrics;

/// A drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    pub width: i32,
    pub height: i32,
    pub items: Vec<Item>,
}

/// A point: right, down.
pub type Point = (i32, i32);

/// One thing in a drawing.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A line of a net, or at an operand: where that is in the source.
    Wire { from: Point, to: Point, net: Option<usize>, place: Option<u32> },
    /// Two lines of a net meet.
    Dot { at: Point, net: Option<usize> },
    /// The power rail.
    Rail { from: Point, to: Point },
    /// A box. Of a step: the key of its X, and those of its faults, LA of the interlock and VA of the supervision.
    Frame { area: Area, kind: Frame, key: String, faults: Vec<String> },
    /// The bars of a contact, the arcs of a coil, with the sign between them; the flow passes through the middle of `area`.
    Glyph { area: Area, kind: Glyph, sign: String, part: usize },
    /// The circle of a negated pin.
    Circle { at: Point, net: Option<usize> },
    /// A text. `at` is the left, middle or right of its base line.
    /// `place` is where an operand is in the source.
    Text { at: Point, anchor: Anchor, text: String, ink: Ink, key: String, place: Option<u32> },
    /// A line that is not a wire.
    Stroke { points: Vec<Point>, ink: Ink },
    /// Draws nothing: the part of the drawing that shows what begins at `place` of the source.
    Zone { area: Area, place: u32 },
}

/// A rectangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    pub x: i32,
    pub y: i32,
    pub w: i32,
    pub h: i32,
}

impl Area {
    /// Both have a common inner point.
    pub fn meets(&self, other: &Area) -> bool {
        self.x < other.x + other.w
            && other.x < self.x + self.w
            && self.y < other.y + other.h
            && other.y < self.y + self.h
    }

    /// `other` is inside, or touches the edges from inside.
    pub fn holds(&self, other: &Area) -> bool {
        self.x <= other.x
            && self.y <= other.y
            && other.x + other.w <= self.x + self.w
            && other.y + other.h <= self.y + self.h
    }
}

/// Kinds of boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    Box,
    Step,
    InitialStep,
    Action,
}

/// Kinds of symbols in a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Glyph {
    Contact,
    Coil,
}

/// Where a text stands from its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// What a text or a line is, which decides its look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// A symbol or an operand.
    Operand,
    /// An address below its symbol.
    Address,
    /// The name of a pin.
    Pin,
    /// The title of a box.
    Title,
    /// A type below the title.
    Detail,
    /// A sign that leads to another place of the drawing.
    Mark,
    /// Comments and other notes.
    Note,
    /// The value of an operand.
    Value,
    Plain,
}

impl Ink {
    /// Height of its text.
    pub const fn height(self) -> i32 {
        match self {
            Ink::Operand | Ink::Title | Ink::Plain | Ink::Mark => metrics::TEXT,
            Ink::Address | Ink::Pin | Ink::Detail | Ink::Note | Ink::Value => metrics::SMALL,
        }
    }
}

impl Item {
    /// The area of a text, a box or a glyph.
    pub fn area(&self) -> Option<Area> {
        match self {
            Item::Text { at, anchor, text, ink, .. } => {
                let (w, height) = (metrics::width(text, ink.height()), ink.height());
                let x = match anchor {
                    Anchor::Start => at.0,
                    Anchor::Middle => at.0 - w / 2,
                    Anchor::End => at.0 - w,
                };
                Some(Area { x, y: at.1 - height + 3, w, h: height })
            }
            Item::Frame { area, .. } | Item::Glyph { area, .. } => Some(*area),
            Item::Wire { .. }
            | Item::Dot { .. }
            | Item::Rail { .. }
            | Item::Circle { .. }
            | Item::Stroke { .. }
            | Item::Zone { .. } => None,
        }
    }
}

impl Scene {
    /// A wire from left to right, or from top to bottom; nothing if it has no length.
    pub fn wire(&mut self, from: Point, to: Point, net: Option<usize>) {
        self.wire_at(from, to, net, None);
    }

    /// A wire at the operand whose place in the source is `place`.
    pub fn wire_at(&mut self, from: Point, to: Point, net: Option<usize>, place: Option<u32>) {
        if from != to {
            self.items.push(Item::Wire { from, to, net, place });
        }
    }

    pub fn text(&mut self, at: Point, anchor: Anchor, ink: Ink, text: &str, key: &str) {
        self.operand(at, anchor, ink, text, key, None);
    }

    /// A text of an operand that is at `place` of the source.
    pub fn operand(&mut self, at: Point, anchor: Anchor, ink: Ink, text: &str, key: &str, place: Option<u32>) {
        if !text.is_empty() {
            self.items.push(Item::Text { at, anchor, text: text.to_string(), ink, key: key.to_string(), place });
        }
    }

    pub fn frame(&mut self, area: Area, kind: Frame, key: &str) {
        self.items.push(Item::Frame { area, kind, key: key.to_string(), faults: Vec::new() });
    }

    /// A part of the drawing that shows what begins at `place` of the source, if that is known.
    pub fn zone(&mut self, area: Area, place: Option<u32>) {
        self.items.extend(place.map(|place| Item::Zone { area, place }));
    }

    /// Adds `by` to the numbers of all parts.
    pub fn renumber_parts(&mut self, by: usize) {
        for item in &mut self.items {
            if let Item::Glyph { part, .. } = item {
                *part += by;
            }
        }
    }

    /// Adds `by` to the numbers of all nets.
    pub fn renumber(&mut self, by: usize) {
        self.nets().for_each(|net| *net = net.map(|net| net + by));
    }

    /// What belongs to one net belongs to another.
    pub fn exchange(&mut self, net: usize, other: usize) {
        self.nets().filter(|known| **known == Some(net)).for_each(|known| *known = Some(other));
    }

    fn nets(&mut self) -> impl Iterator<Item = &mut Option<usize>> {
        self.items.iter_mut().filter_map(|item| match item {
            Item::Wire { net, .. } | Item::Dot { net, .. } | Item::Circle { net, .. } => Some(net),
            Item::Rail { .. }
            | Item::Frame { .. }
            | Item::Glyph { .. }
            | Item::Text { .. }
            | Item::Stroke { .. }
            | Item::Zone { .. } => None,
        })
    }

    /// Adds `other` at a place.
    pub fn add(&mut self, other: Scene, (dx, dy): Point) {
        let moved = |point: Point| (point.0 + dx, point.1 + dy);
        let area = |area: Area| Area { x: area.x + dx, y: area.y + dy, ..area };
        self.items.extend(other.items.into_iter().map(|item| match item {
            Item::Wire { from, to, net, place } => Item::Wire { from: moved(from), to: moved(to), net, place },
            Item::Dot { at, net } => Item::Dot { at: moved(at), net },
            Item::Rail { from, to } => Item::Rail { from: moved(from), to: moved(to) },
            Item::Frame { area: a, kind, key, faults } => Item::Frame { area: area(a), kind, key, faults },
            Item::Glyph { area: a, kind, sign, part } => Item::Glyph { area: area(a), kind, sign, part },
            Item::Circle { at, net } => Item::Circle { at: moved(at), net },
            Item::Text { at, anchor, text, ink, key, place } => {
                Item::Text { at: moved(at), anchor, text, ink, key, place }
            }
            Item::Zone { area: a, place } => Item::Zone { area: area(a), place },
            Item::Stroke { points, ink } => Item::Stroke { points: points.into_iter().map(moved).collect(), ink },
        }));
    }
}
