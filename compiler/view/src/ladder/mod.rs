//! Drawings of LAD: the power rail at the left, rungs below each other, branches that open downwards and close upwards.

mod measure;
mod paint;
pub mod reduce;

use crate::scene::{Item, Scene};
use crate::sheet::Sheet;
use measure::{Measure, RAIL};

/// Free space between rungs.
const GAP: i32 = 12;
/// Free space around a drawing.
const MARGIN: i32 = 10;

/// Draws a network. Rungs wider than `width` pixels go on in a second line.
pub fn draw(sheet: &Sheet, width: i32) -> Scene {
    let mut measure = Measure { sheet, connectors: 0 };
    let room = (width - RAIL - 2 * MARGIN).max(200);
    let rungs: Vec<_> = reduce::rungs(sheet).iter().map(|rung| measure.rung(rung, room)).collect();
    let mut scene = Scene::default();
    let widest = rungs.iter().map(|rung| rung.width).max().unwrap_or(0);
    let left = MARGIN + RAIL;
    let mut top = MARGIN;
    let mut rail: Option<(i32, i32)> = None;
    for rung in &rungs {
        let y = top + rung.up;
        if !rung.loose {
            let first = rail.map_or(y - 12, |(first, _)| first);
            rail = Some((first, y + rung.down.min(12)));
            paint::rung(sheet, rung, left, y, widest, &mut scene);
        } else {
            paint::loose(sheet, rung, left, y, widest, &mut scene);
        }
        top = y + rung.down + GAP;
    }
    if let Some((first, last)) = rail {
        let last = scene
            .items
            .iter()
            .filter_map(|item| match item {
                Item::Wire { from, .. } if from.0 == MARGIN => Some(from.1 + 12),
                _ => None,
            })
            .fold(last, i32::max);
        scene.items.insert(0, Item::Rail { from: (MARGIN, first), to: (MARGIN, last) });
    }
    scene.width = left + widest + MARGIN;
    scene.height = top.max(2 * MARGIN);
    scene
}
