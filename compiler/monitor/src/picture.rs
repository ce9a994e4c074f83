//! What a drawing of the page consists of. See `svg.rs` of the crate view, which writes one item after the other.

use ratatui::text::Span;

use crate::row::Tone;

/// A point: right, down.
type Point = (i32, i32);

/// One thing in a drawing.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A straight line; of a wire the net, or the place of the operand that it leads to.
    Line { from: Point, to: Point, net: Option<usize>, place: Option<u32> },
    /// A box; of a step its name.
    Frame { left: i32, top: i32, right: i32, bottom: i32, step: Option<String> },
    /// A contact or a coil with its sign, in a wire at `y`.
    Glyph { glyph: Glyph, left: i32, right: i32, y: i32, sign: String, part: usize },
    /// Two wires meet.
    Dot { x: i32, y: i32 },
    /// The circle of a negated pin.
    Circle { x: i32, y: i32, net: Option<usize> },
    /// The tip of an arrow that points down.
    Arrow { x: i32, y: i32 },
    /// A text; `y` is its middle. Of an operand: its address, and its place in the source.
    Text { x: i32, y: i32, anchor: Anchor, text: String, tone: Tone, is_pin: bool, key: String, place: Option<u32> },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Glyph {
    Contact,
    Coil,
}

/// Which part of a text is at its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    /// The column in which a text begins whose point is in `column`.
    pub fn begin(self, column: i32, text: &str) -> i32 {
        match self {
            Anchor::Start => column,
            Anchor::Middle => column - columns(text) / 2,
            Anchor::End => column - columns(text),
        }
    }
}

/// The columns of a text: characters of East Asia take two.
pub fn columns(text: &str) -> i32 {
    Span::raw(text).width() as i32
}

/// From the base line of a text to its middle.
const MIDDLE: i32 = 3;

/// The items of a drawing, in its order.
pub fn items(svg: &str) -> Vec<Item> {
    let mut items: Vec<Item> = Vec::new();
    // The step that came last.
    let mut step = None;
    for part in svg.split('<').skip(1) {
        let (head, text) = part.split_once('>').unwrap_or((part, ""));
        let (kind, attributes) = head.split_once(' ').unwrap_or((head, ""));
        let of = |name: &str| attribute(attributes, name);
        let number = |name: &str| of(name).and_then(|text| text.parse::<i32>().ok()).unwrap_or(0).clamp(-LIMIT, LIMIT);
        let class = of("class").unwrap_or_default();
        match (kind, class) {
            ("path", _) => path(&mut items, class, of("d").unwrap_or_default(), &of),
            // The inner frame of an initial step.
            ("rect", "s") => {}
            ("rect", _) => {
                let (left, top) = (number("x"), number("y"));
                let (right, bottom) = (left + number("width"), top + number("height"));
                // Its name follows.
                let name = (class == "b k").then(String::new);
                step = if name.is_some() { Some(items.len()) } else { step };
                items.push(Item::Frame { left, top, right, bottom, step: name });
            }
            ("circle", "n") => {
                let net = of("data-n").and_then(|net| net.parse().ok());
                items.push(Item::Circle { x: number("cx"), y: number("cy"), net });
            }
            ("circle", _) => items.push(Item::Dot { x: number("cx"), y: number("cy") }),
            ("text", _) => {
                let (x, y) = (number("x"), number("y"));
                let text = unescaped(text.trim_end());
                if class == "x" && signed(&mut items, (x, y), &text) {
                    continue;
                }
                if let Some(Item::Frame { left, top, right, bottom, step: Some(name) }) =
                    step.and_then(|at: usize| items.get_mut(at))
                    && (*left..*right).contains(&x)
                    && (*top..*bottom).contains(&y)
                {
                    // Above its name is its number.
                    name.clone_from(&text);
                }
                let anchor = match of("text-anchor") {
                    Some("middle") => Anchor::Middle,
                    Some("end") => Anchor::End,
                    _ => Anchor::Start,
                };
                let tone = match class {
                    "t" | "m" => Tone::Title,
                    "a" | "y" | "c" => Tone::Note,
                    "v" => Tone::Value,
                    _ => Tone::Plain,
                };
                let place = of("data-o").and_then(|place| place.parse().ok());
                let key = of("data-k").map(unescaped).unwrap_or_default();
                items.push(Item::Text { x, y: y - MIDDLE, anchor, text, tone, is_pin: class == "p", key, place });
            }
            _ => {}
        }
    }
    items
}

/// The largest coordinate: sums of a few are numbers too.
const LIMIT: i32 = 1 << 20;

/// The items of a path.
fn path<'a>(items: &mut Vec<Item>, class: &str, way: &str, of: &impl Fn(&str) -> Option<&'a str>) {
    let numbers = numbers(way);
    let line = |from: Point, to: Point| Item::Line { from, to, net: None, place: None };
    match (class, numbers.as_slice()) {
        ("g", [left, top, bottom, right, _, _, rest @ ..]) if !way.contains('q') => {
            let sign = if rest.is_empty() { String::new() } else { "/".to_string() };
            items.push(glyph(Glyph::Contact, (*left, *right), (top + bottom) / 2, sign, of));
        }
        // `M5 0q-10 9 0 18M17 0q10 9 0 18`: both arcs begin 5 pixels inside.
        ("g", [left, top, _, _, _, height, right, ..]) => {
            items.push(glyph(Glyph::Coil, (left - 5, right + 5), top + height / 2, String::new(), of));
        }
        ("r", [x, top, bottom, ..]) => items.push(line((*x, *top), (*x, *bottom))),
        // Three points are the tip of an arrow.
        ("s", [_, _, x, y, _, _]) => items.push(Item::Arrow { x: *x, y: *y }),
        ("s", points) => {
            let points: Vec<Point> = points.chunks_exact(2).map(|point| (point[0], point[1])).collect();
            items.extend(points.windows(2).map(|ends| line(ends[0], ends[1])));
        }
        // A wire goes on from its first point by what follows.
        (_, [x, y, by, rest @ ..]) => {
            let to = match (way.contains('h'), way.contains('v'), rest) {
                (true, ..) => (x + by, *y),
                (_, true, _) => (*x, y + by),
                (.., [down, ..]) => (x + by, y + down),
                (.., []) => (*x, *y),
            };
            let (net, place) =
                (of("data-n").and_then(|net| net.parse().ok()), of("data-o").and_then(|at| at.parse().ok()));
            items.push(Item::Line { from: (*x, *y), to, net, place });
        }
        _ => {}
    }
}

fn glyph<'a>(
    glyph: Glyph,
    (left, right): (i32, i32),
    y: i32,
    sign: String,
    of: &impl Fn(&str) -> Option<&'a str>,
) -> Item {
    let part = of("data-p").and_then(|part| part.parse().ok()).unwrap_or(usize::MAX);
    Item::Glyph { glyph, left, right, y, sign, part }
}

/// A text inside the symbol that came last is its sign.
fn signed(items: &mut [Item], (x, y): Point, text: &str) -> bool {
    match items.last_mut() {
        Some(Item::Glyph { left, right, y: middle, sign, .. })
            if *left < x && x < *right && (y - *middle).abs() < 15 =>
        {
            *sign = text.to_string();
            true
        }
        _ => false,
    }
}

/// The whole numbers of a path.
fn numbers(way: &str) -> Vec<i32> {
    let mut numbers = Vec::new();
    for (at, letter) in way.char_indices() {
        let is_part = |letter: char| letter.is_ascii_digit() || letter == '-';
        let before = way[..at].chars().next_back();
        if is_part(letter) && !before.is_some_and(is_part) {
            let rest = &way[at..];
            let end = rest.find(|letter: char| !is_part(letter)).unwrap_or(rest.len());
            numbers.push(rest[..end].parse::<i32>().unwrap_or(0).clamp(-LIMIT, LIMIT));
        }
    }
    numbers
}

/// The value of an attribute, as it is written.
fn attribute<'a>(attributes: &'a str, name: &str) -> Option<&'a str> {
    let mut rest = attributes;
    loop {
        let (known, after) = rest.split_once("=\"")?;
        let (value, after) = after.split_once('"')?;
        if known.trim() == name {
            return Some(value);
        }
        rest = after;
    }
}

fn unescaped(text: &str) -> String {
    text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&")
}
