//! Drawings of LAD: the power rail at the left, rungs below each other, branches that open downwards and close upwards.

mod graph;
mod measure;
mod paint;
pub mod reduce;

use crate::scene::{Item, Scene};
use crate::sheet::{Net, Sheet, Source};
use measure::{Measure, RAIL};
use paint::Painter;

/// Free space between rungs.
const GAP: i32 = 12;
/// Free space around a drawing.
const MARGIN: i32 = 10;

/// Draws a network. Rungs wider than `width` pixels go on in a second line. Where branches join, the sheet gets nets for the wires before.
pub fn draw(sheet: &mut Sheet, width: i32) -> Scene {
    let mut measure = Measure::new(sheet);
    let room = (width - RAIL - 2 * MARGIN).max(200);
    let rungs: Vec<_> = reduce::rungs(sheet).iter().map(|rung| measure.rung(rung, room)).collect();
    let mut painter = Painter::new(sheet);
    let widest = rungs.iter().map(|rung| rung.width).max().unwrap_or(0);
    let left = MARGIN + RAIL;
    let mut top = MARGIN;
    for rung in &rungs {
        let y = top + rung.up;
        painter.rung(rung, (left, y), widest);
        top = y + rung.down + GAP;
    }
    let (mut scene, branches) = painter.finish();
    if !branches.is_empty() {
        // The rail is the net before them.
        sheet.nets.push(Net { sources: vec![Source::Rail], ..Net::default() });
        sheet.nets.extend(branches);
    }
    // The rail is where lines lead to it.
    let lead = |item: &Item| match item {
        Item::Wire { from, .. } if from.0 == MARGIN => Some(from.1),
        _ => None,
    };
    let leads: Vec<i32> = scene.items.iter().filter_map(lead).collect();
    if let (Some(first), Some(last)) = (leads.iter().min(), leads.iter().max()) {
        scene.items.insert(0, Item::Rail { from: (MARGIN, first - 12), to: (MARGIN, last + 12) });
    }
    scene.width = left + widest + MARGIN;
    scene.height = top.max(2 * MARGIN);
    scene
}
