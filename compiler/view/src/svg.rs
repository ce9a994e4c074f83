//! Drawings as SVG.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use crate::metrics;
use crate::scene::{Anchor, Frame, Glyph, Ink, Item, Scene};

/// The look of drawings. Colours are variables, which a page sets for its dark look and for paper.
pub const STYLE: &str = "\
.w{stroke:var(--wire,#222);stroke-width:1.4;fill:none}.d{fill:var(--wire,#222)}.r{stroke:var(--rail,#222);stroke-width:3}\
.b{fill:var(--box,#f5f7fa);stroke:var(--wire,#222);stroke-width:1.2}.g{stroke:var(--wire,#222);stroke-width:1.8;fill:none}\
.s{stroke:var(--wire,#222);stroke-width:1.2;fill:none}.n{stroke:var(--wire,#222);stroke-width:1.2;fill:var(--paper,#fff)}\
.o{fill:var(--symbol,#0b3d91)}.a{fill:var(--address,#666)}.p{fill:var(--text,#222)}.t{fill:var(--text,#222);font-weight:bold}\
.y{fill:var(--address,#666)}.m{fill:var(--mark,#a33);font-weight:bold}.c{fill:var(--note,#3a7a3a)}.x{fill:var(--text,#222)}\
.on{stroke:var(--on,#1a9a2f);stroke-width:2.4}.off{stroke:var(--off,#3b6fc4);stroke-dasharray:5 3}.un{stroke:var(--un,#aaa)}\
.v{fill:var(--value,#b25d00);font-weight:bold}.act{fill:var(--active,#b9f0c0)}\
.bad{stroke:var(--bad,#c21d1d);stroke-width:3}";

/// A whole file.
pub fn file(scene: &Scene, state: Option<&Shown>) -> String {
    let (width, height) = (scene.width, scene.height);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"{}\">\n<style>{}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
        metrics::FONTS,
        plain_style(),
        content(scene, state, false)
    )
}

/// The style sheet with the colours themselves: some programs that read SVG know no variables.
fn plain_style() -> String {
    let mut out = String::new();
    let mut rest = STYLE;
    while let Some((before, after)) = rest.split_once("var(") {
        out.push_str(before);
        let (variable, after) = after.split_once(')').unwrap_or((after, ""));
        out.push_str(variable.split_once(',').map_or("", |(_, colour)| colour));
        rest = after;
    }
    out + rest
}

/// A drawing inside a page, which has the style sheet; with the places of operands in the source if it will show what they are there.
pub fn inline(scene: &Scene, places: bool) -> String {
    let (width, height) = (scene.width, scene.height);
    format!(
        "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">{}</svg>",
        content(scene, None, places)
    )
}

/// A drawing inside a page, with `under` below all its items, and `over` above the boxes.
pub fn inline_between(scene: &Scene, under: &str, over: &str) -> String {
    let (width, height) = (scene.width, scene.height);
    let (mut boxes, mut rest) = (String::new(), String::new());
    for item in scene.items.iter().filter(|item| !matches!(item, Item::Zone { .. })) {
        let out = if matches!(item, Item::Frame { .. }) { &mut boxes } else { &mut rest };
        write_item(out, item, None, false);
        out.push('\n');
    }
    format!(
        "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n{under}{boxes}{over}{rest}</svg>"
    )
}

/// The items, one on each line.
fn content(scene: &Scene, state: Option<&Shown>, places: bool) -> String {
    let mut out = String::new();
    for item in scene.items.iter().filter(|item| !matches!(item, Item::Zone { .. })) {
        write_item(&mut out, item, state, places);
        out.push('\n');
    }
    out
}

/// Writing to a String cannot fail.
const WRITES: &str = "a String takes all text";

fn write_item(out: &mut String, item: &Item, state: Option<&Shown>, places: bool) {
    let data = |net: &Option<usize>| net.map_or(String::new(), |net| format!(" data-n=\"{net}\""));
    match item {
        Item::Wire { from, to, net, place } => {
            let way = match (to.0 - from.0, to.1 - from.1) {
                (dx, 0) => format!("h{dx}"),
                (0, dy) => format!("v{dy}"),
                (dx, dy) => format!("l{dx} {dy}"),
            };
            let state = state.map_or("", |state| state.class(*net));
            let place = place.filter(|_| places).map_or(String::new(), |place| format!(" data-o=\"{place}\""));
            write!(out, "<path class=\"w{state}\"{}{place} d=\"M{} {}{way}\"/>", data(net), from.0, from.1)
        }
        Item::Dot { at, net } => {
            write!(out, "<circle class=\"d\"{} cx=\"{}\" cy=\"{}\" r=\"2.5\"/>", data(net), at.0, at.1)
        }
        Item::Rail { from, to } => {
            write!(out, "<path class=\"r\" d=\"M{} {}V{}\"/>", from.0, from.1, to.1)
        }
        Item::Frame { area, kind, key, faults } => {
            let mut data = if key.is_empty() { String::new() } else { format!(" data-s=\"{}\"", escaped(key)) };
            for (name, key) in ["la", "va"].iter().zip(faults) {
                data.push_str(&format!(" data-{name}=\"{}\"", escaped(key)));
            }
            let is_faulty = state.is_some_and(|state| faults.iter().any(|key| state.active.contains(key)));
            let class = match kind {
                Frame::Box | Frame::Action => "b",
                Frame::Step | Frame::InitialStep if state.is_some_and(|state| state.active.contains(key)) => "b act",
                Frame::Step | Frame::InitialStep => "b k",
            };
            write!(
                out,
                "<rect class=\"{class}{}\"{data} x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
                if is_faulty { " bad" } else { "" },
                area.x,
                area.y,
                area.w,
                area.h
            )
            .expect(WRITES);
            if *kind == Frame::InitialStep {
                write!(
                    out,
                    "<rect class=\"s\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
                    area.x + 3,
                    area.y + 3,
                    area.w - 6,
                    area.h - 6
                )
                .expect(WRITES);
            }
            Ok(())
        }
        Item::Glyph { area, kind, sign, part } => {
            let (left, right, top, bottom) = (area.x, area.x + area.w, area.y, area.y + area.h);
            let height = area.h;
            let way = match kind {
                Glyph::Contact => format!("M{left} {top}V{bottom}M{right} {top}V{bottom}"),
                Glyph::Coil => {
                    format!(
                        "M{} {top}q-10 {} 0 {height}M{} {top}q10 {} 0 {height}",
                        left + 5,
                        height / 2,
                        right - 5,
                        height / 2
                    )
                }
            };
            let slash = match sign.as_str() {
                "/" => format!("M{} {bottom}L{} {top}", left + area.w / 4, right - area.w / 4),
                _ => String::new(),
            };
            write!(out, "<path class=\"g\" data-p=\"{part}\" d=\"{way}{slash}\"/>").expect(WRITES);
            if sign != "/" && !sign.is_empty() {
                write!(
                    out,
                    "<text class=\"x\" x=\"{}\" y=\"{}\" font-size=\"11\" text-anchor=\"middle\">{}</text>",
                    left + area.w / 2,
                    top + height / 2 + 4,
                    escaped(sign)
                )
                .expect(WRITES);
            }
            Ok(())
        }
        Item::Circle { at, net } => {
            write!(out, "<circle class=\"n\"{} cx=\"{}\" cy=\"{}\" r=\"3.5\"/>", data(net), at.0, at.1)
        }
        Item::Text { at, anchor, text, ink, key, place } => {
            let anchor = match anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            };
            let mut key = if key.is_empty() { String::new() } else { format!(" data-k=\"{}\"", escaped(key)) };
            if let Some(place) = place.filter(|_| places) {
                key.push_str(&format!(" data-o=\"{place}\""));
            }
            let (class, height) = (class(*ink), ink.height());
            write!(
                out,
                "<text class=\"{class}\"{key} x=\"{}\" y=\"{}\" font-size=\"{height}\"{anchor}>{}</text>",
                at.0,
                at.1,
                escaped(text)
            )
        }
        Item::Stroke { points, .. } => {
            let mut way = String::new();
            for (index, point) in points.iter().enumerate() {
                write!(way, "{}{} {}", if index == 0 { 'M' } else { 'L' }, point.0, point.1).expect(WRITES);
            }
            write!(out, "<path class=\"s\" d=\"{way}\"/>")
        }
        Item::Zone { .. } => Ok(()),
    }
    .expect(WRITES);
}

fn class(ink: Ink) -> &'static str {
    match ink {
        Ink::Operand => "o",
        Ink::Address => "a",
        Ink::Pin => "p",
        Ink::Title => "t",
        Ink::Detail => "y",
        Ink::Mark => "m",
        Ink::Note => "c",
        Ink::Value => "v",
        Ink::Plain => "x",
    }
}

/// A state of a drawing.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// The values of nets; those that are not there are not known.
    pub nets: HashMap<usize, bool>,
    /// Keys whose value is 1: those of active steps and of faults among them.
    pub active: HashSet<String>,
}

impl Shown {
    fn class(&self, net: Option<usize>) -> &'static str {
        match net.and_then(|net| self.nets.get(&net)) {
            Some(true) => " on",
            Some(false) => " off",
            None => " un",
        }
    }
}

/// Text inside SVG or HTML. Control characters, which no XML may have, are blanks.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' => out.push(c),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
