//! Drawings with what tests have seen of them: the background of a contact shows its two values, that of all else whether it has run.

use std::collections::HashSet;
use std::fmt::Write;

use crate::scene::{Area, Ink, Item, Scene};
use crate::sheet::Sheet;
use crate::svg;

/// What has been seen of a part of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Of a bit: whether it was 0, whether it was 1.
    Bit([bool; 2]),
    /// Whether it has run, was active, or has switched.
    Ran(bool),
}

/// The look of marks, beside [`svg::STYLE`].
pub const STYLE: &str = ".ok{fill:var(--ok,#bfe8c5)}.no{fill:var(--no,#f9bdb5)}";

/// Space around what is marked, in pixels.
const MARGIN: i32 = 3;

/// A drawing for a page. `find`: what has been seen of what begins at a place of the source.
pub fn inline(scene: &Scene, sheet: &Sheet, find: &dyn Fn(u32) -> Option<Mark>) -> String {
    let (mut under, mut over) = (String::new(), String::new());
    for (area, mark, is_box) in marked(scene, sheet, find) {
        write_mark(if is_box { &mut under } else { &mut over }, area, mark);
    }
    svg::inline_between(scene, &under, &over)
}

/// The areas of a drawing of which something is known, and whether they are boxes, whose marks are their edges.
fn marked(scene: &Scene, sheet: &Sheet, find: &dyn Fn(u32) -> Option<Mark>) -> Vec<(Area, Mark, bool)> {
    let part_place = |part: usize| sheet.parts.get(part).and_then(|part| part.place.or(part.statement));
    let glyphs: HashSet<u32> = scene
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Glyph { part, .. } => part_place(*part),
            _ => None,
        })
        .collect();
    let of_item = |item: &Item| {
        let (area, place) = match item {
            Item::Glyph { area, part, .. } => (*area, part_place(*part)?),
            Item::Zone { area, place } => return Some((*area, find(*place)?, true)),
            // The operand of a contact is marked with its glyph.
            Item::Text { ink: Ink::Operand, place: Some(place), .. } if !glyphs.contains(place) => {
                let mark = find(*place)?;
                return matches!(mark, Mark::Bit(_)).then_some((item.area()?, mark, false));
            }
            Item::Text { .. }
            | Item::Wire { .. }
            | Item::Dot { .. }
            | Item::Rail { .. }
            | Item::Frame { .. }
            | Item::Circle { .. }
            | Item::Stroke { .. } => return None,
        };
        Some((area, find(place)?, false))
    };
    scene.items.iter().filter_map(of_item).collect()
}

/// A rectangle; for a bit its left half is for 0, its right half for 1.
fn write_mark(out: &mut String, area: Area, mark: Mark) {
    let (x, y) = (area.x - MARGIN, area.y - MARGIN);
    let (w, h) = (area.w + 2 * MARGIN, area.h + 2 * MARGIN);
    let class = |good: bool| if good { "ok" } else { "no" };
    let mut rectangle = |x: i32, w: i32, good: bool, title: &str| {
        writeln!(
            out,
            "<rect class=\"{}\" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"><title>{title}</title></rect>",
            class(good)
        )
        .expect("a String takes all text");
    };
    match mark {
        Mark::Bit([zero, one]) => {
            let half = w / 2;
            rectangle(x, half, zero, if zero { "has been 0" } else { "has never been 0" });
            rectangle(x + half, w - half, one, if one { "has been 1" } else { "has never been 1" });
        }
        Mark::Ran(ran) => rectangle(x, w, ran, if ran { "has run" } else { "has never run" }),
    }
}
