//! Wires in channels, and everything at its place.

use std::collections::BTreeMap;

use super::place::{Grid, Thing};
use crate::scene::{Anchor, Ink, Item, Scene};
use crate::sheet::Sheet;

/// Between vertical lines.
const TRACK: i32 = 8;
/// The least width of a channel.
const CHANNEL: i32 = 16;

/// A net in a channel.
struct Run {
    net: usize,
    /// Heights at the left and at the right.
    left: Vec<i32>,
    right: Vec<i32>,
    track: Option<usize>,
}

impl Run {
    fn span(&self) -> (i32, i32) {
        let all = || self.left.iter().chain(&self.right).copied();
        (all().min().unwrap_or(0), all().max().unwrap_or(0))
    }

    fn is_straight(&self) -> bool {
        let (low, high) = self.span();
        low == high
    }
}

/// Paints a grid; returns the right and the lower edge.
pub fn paint(sheet: &Sheet, grid: &Grid, scene: &mut Scene) -> (i32, i32) {
    let mut x = 0;
    let (mut right, mut bottom) = (0, 0);
    for column in 0..grid.columns.len() {
        if grid.bands.contains(&column) {
            x = 0;
        }
        let width = grid.columns[column].iter().map(|thing| thing.width).max().unwrap_or(0);
        things(sheet, grid, column, x, width, scene);
        x += width;
        right = right.max(x);
        bottom = grid.columns[column].iter().map(|thing| thing.y + thing.down).fold(bottom, i32::max);
        if column + 1 < grid.columns.len() {
            let channel = channel(grid, column, x, scene);
            x += channel;
        }
    }
    (right, bottom)
}

fn things(sheet: &Sheet, grid: &Grid, column: usize, x: i32, width: i32, scene: &mut Scene) {
    for thing in &grid.columns[column] {
        let y = thing.y;
        match &thing.thing {
            Thing::Box { part, shape } => {
                // Boxes that end a rung stand at the left of their column, all others in the middle.
                let has_output = shape.ends.iter().any(|(pin, _)| sheet.parts[*part].pins[*pin].output);
                let from = x + if has_output { width - shape.width } else { 0 };
                scene.add(shape.scene.clone(), (from, y));
                for (pin, end) in &shape.ends {
                    let pin = &sheet.parts[*part].pins[*pin];
                    let crate::sheet::Link::Net(net) = pin.link else { continue };
                    let (near, far) = if pin.output { (from + end.0, x + width) } else { (x, from + end.0) };
                    scene.wire((near, y + end.1), (far, y + end.1), Some(net));
                }
            }
            Thing::Wire { net } => scene.wire((x, y), (x + width, y), Some(*net)),
            Thing::Operand { net, label, negated } => {
                let end = x + width;
                let text_end = end - 16 - if *negated { 8 } else { 0 };
                scene.operand((text_end, y + 4), Anchor::End, Ink::Operand, &label.text, &label.key, label.place);
                let from = text_end + if *negated { 11 } else { 4 };
                if *negated {
                    scene.items.push(Item::Circle { at: (text_end + 7, y), net: Some(*net) });
                }
                scene.wire((from, y), (end, y), Some(*net));
            }
            Thing::From { net, text } => {
                let end = x + width;
                scene.text((end - 16, y + 4), Anchor::End, Ink::Mark, text, "");
                scene.wire((end - 12, y), (end, y), Some(*net));
            }
            Thing::To { net, text } => {
                scene.wire((x, y), (x + 12, y), Some(*net));
                scene.text((x + 15, y + 4), Anchor::Start, Ink::Mark, text, "");
            }
        }
    }
}

/// Paints the wires right of a column, from `x`; returns the width of the channel.
fn channel(grid: &Grid, column: usize, x: i32, scene: &mut Scene) -> i32 {
    let mut runs: BTreeMap<usize, Run> = BTreeMap::new();
    for end in &grid.outs[column] {
        let y = grid.columns[column][end.thing].y + end.dy;
        let new = Run { net: end.net, left: Vec::new(), right: Vec::new(), track: None };
        runs.entry(end.net).or_insert(new).left.push(y);
    }
    for end in &grid.ins[column + 1] {
        let y = grid.columns[column + 1][end.thing].y + end.dy;
        if let Some(run) = runs.get_mut(&end.net) {
            run.right.push(y);
        }
    }
    let mut runs: Vec<Run> = runs.into_values().filter(|run| !run.left.is_empty() && !run.right.is_empty()).collect();
    runs.sort_by_key(Run::span);
    // A track for each net that is not straight: no two spans on one track meet.
    let mut tracks: Vec<Vec<(i32, i32)>> = Vec::new();
    for run in runs.iter_mut().filter(|run| !run.is_straight()) {
        let span = run.span();
        let free = |track: &Vec<(i32, i32)>| track.iter().all(|(low, high)| span.0 > high + 3 || span.1 < low - 3);
        let track = match tracks.iter().position(free) {
            Some(track) => track,
            None => {
                tracks.push(Vec::new());
                tracks.len() - 1
            }
        };
        tracks[track].push(span);
        run.track = Some(track);
    }
    if runs.is_empty() {
        return 0;
    }
    let width = CHANNEL.max((tracks.len() as i32 + 1) * TRACK);
    for run in &runs {
        let net = Some(run.net);
        let Some(track) = run.track else {
            scene.wire((x, run.left[0]), (x + width, run.left[0]), net);
            continue;
        };
        let at = x + (track as i32 + 1) * TRACK;
        let (low, high) = run.span();
        run.left.iter().for_each(|y| scene.wire((x, *y), (at, *y), net));
        run.right.iter().for_each(|y| scene.wire((at, *y), (x + width, *y), net));
        scene.wire((at, low), (at, high), net);
        let mut meetings: Vec<i32> = run.left.iter().chain(&run.right).copied().collect();
        meetings.sort_unstable();
        meetings.dedup();
        for y in meetings {
            let ends = run.left.iter().chain(&run.right).filter(|other| **other == y).count();
            if ends > 1 || y > low && y < high {
                scene.items.push(Item::Dot { at: (at, y), net });
            }
        }
    }
    width
}
