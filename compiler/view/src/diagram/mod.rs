//! Drawings of FBD: boxes in columns from left to right, and wires in the channels between the columns.
//!
//! A box stands left of all that it feeds, as far to the right as possible, so that a gate stands next to the box that needs it; a coil at
//! a wire that leads on stands right after what feeds it. A wire that passes a column has a place of its own there. In a channel each net
//! has at most one vertical line; no two lines are on top of each other, since the ends of nets at both sides of a channel have different
//! heights (`place`), and nets whose vertical lines would meet have different tracks (`route`).

mod place;
mod route;

use crate::scene::Scene;
use crate::sheet::Sheet;

/// Free space around a drawing.
const MARGIN: i32 = 10;

/// Draws a network. Where it is wider than `width` pixels, wires end at connectors with the names of their nets.
pub fn draw(sheet: &Sheet, width: i32) -> Scene {
    let grid = place::place(sheet, width - 2 * MARGIN);
    let mut scene = Scene::default();
    let (right, bottom) = route::paint(sheet, &grid, &mut scene);
    let mut moved = Scene { width: right + 2 * MARGIN, height: bottom + 2 * MARGIN, items: Vec::new() };
    moved.add(scene, (MARGIN, MARGIN));
    moved
}
