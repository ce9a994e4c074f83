//! Parts of a chart below and beside each other.

use crate::metrics;
use crate::scene::{Anchor, Ink, Scene};

/// Between branches.
const GAP: i32 = 24;
/// Height of the line between tiles.
const LINK: i32 = 14;

/// A part of a chart. Its flow enters at `entry` at the top, and what follows is below `exit`, unless ways end at the bottom (`ends`).
#[derive(Clone, Debug, Default)]
pub struct Piece {
    pub scene: Scene,
    pub width: i32,
    pub height: i32,
    pub entry: i32,
    pub exit: i32,
    /// Where its ways end at the bottom, from left to right.
    pub ends: Vec<(i32, End)>,
}

/// What an open end waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// A step follows.
    Step(usize),
    /// The last step of a path; the transition joins the paths.
    Join(usize),
}

impl Piece {
    /// A short line with an arrow to what is named.
    pub fn arrow(text: &str) -> Piece {
        let mut piece =
            Piece { width: metrics::width(text, metrics::TEXT) + 22, height: 0, entry: 8, exit: 8, ..Piece::default() };
        piece.arrow_at(8, text);
        piece
    }

    /// The beginning of a transition that joins paths: what they come from, and a double line.
    pub fn joint(text: &str) -> Piece {
        let width = metrics::width(text, metrics::TEXT) + 40;
        let mut piece = Piece { width, height: 18, entry: 40, exit: 40, ..Piece::default() };
        piece.scene.text((30, 8), Anchor::Start, Ink::Mark, text, "");
        piece.line((26, 14), (54, 14));
        piece.line((26, 18), (54, 18));
        piece
    }

    /// The end of a sequence.
    pub fn stop() -> Piece {
        let mut scene = Scene::default();
        scene.items.push(crate::scene::Item::Stroke { points: vec![(8, 0), (8, 14)], ink: Ink::Plain });
        scene.items.push(crate::scene::Item::Stroke { points: vec![(0, 14), (16, 14)], ink: Ink::Plain });
        Piece { scene, width: 16, height: 20, entry: 8, exit: 8, ends: Vec::new() }
    }

    /// Adds an arrow at the bottom.
    pub fn arrow_at(&mut self, x: i32, text: &str) {
        let y = self.height;
        self.line((x, y), (x, y + 20));
        self.scene.items.push(crate::scene::Item::Stroke {
            points: vec![(x - 4, y + 13), (x, y + 20), (x + 4, y + 13)],
            ink: Ink::Plain,
        });
        self.scene.text((x + 8, y + 20), Anchor::Start, Ink::Mark, text, "");
        self.width = self.width.max(x + 10 + metrics::width(text, metrics::TEXT));
        self.bottom(y + 26);
    }

    /// The piece gets higher; its open ends go down with it.
    fn bottom(&mut self, height: i32) {
        for (x, _) in self.ends.clone() {
            self.line((x, self.height), (x, height));
        }
        self.height = self.height.max(height);
    }

    fn line(&mut self, from: (i32, i32), to: (i32, i32)) {
        if from != to {
            self.scene.items.push(crate::scene::Item::Stroke { points: vec![from, to], ink: Ink::Plain });
        }
    }

    /// Puts `next` below, with a line between.
    pub fn below(&mut self, next: Piece) {
        let from = self.ends.first().map_or(self.exit, |(x, _)| *x);
        // The one below may be wider at the left.
        let dx = from - next.entry;
        let (mine, its) = if dx < 0 { (-dx, 0) } else { (0, dx) };
        self.move_right(mine);
        let top = self.height + LINK;
        let at = from + mine;
        self.line((at, self.height), (at, top));
        self.scene.add(next.scene, (its, top));
        self.width = self.width.max(next.width + its);
        self.height = top + next.height;
        self.exit = next.exit + its;
        self.ends = next.ends.into_iter().map(|(x, end)| (x + its, end)).collect();
    }

    fn move_right(&mut self, by: i32) {
        if by == 0 {
            return;
        }
        let scene = std::mem::take(&mut self.scene);
        self.scene.add(scene, (by, 0));
        self.width += by;
        self.entry += by;
        self.exit += by;
        self.ends.iter_mut().for_each(|(x, _)| *x += by);
    }

    /// Branches under a common line, which is double for paths that run at the same time.
    pub fn beside(branches: Vec<Piece>, double: bool) -> Piece {
        let mut piece = Piece::default();
        let lead = if double { 14 } else { 10 };
        let mut entries = Vec::new();
        let height = branches.iter().map(|branch| branch.height).max().unwrap_or(0) + lead;
        for branch in branches {
            let left = if piece.width == 0 { 0 } else { piece.width + GAP };
            entries.push(left + branch.entry);
            for (x, end) in &branch.ends {
                piece.ends.push((left + x, *end));
                piece.line((left + x, lead + branch.height), (left + x, height));
            }
            piece.scene.add(branch.scene, (left, lead));
            piece.width = left + branch.width;
        }
        let (first, last) = (entries.first().copied().unwrap_or(0), entries.last().copied().unwrap_or(0));
        for entry in &entries {
            piece.line((*entry, if double { 4 } else { 0 }), (*entry, lead));
        }
        if double {
            let (first, last) = (first - 10, last + 10);
            piece.move_right((-first).max(0));
            let moved = (-first).max(0);
            piece.line((first + moved, 0), (last + moved, 0));
            piece.line((first + moved, 4), (last + moved, 4));
            piece.width = piece.width.max(last + moved);
            piece.entry = entries[0] + moved;
        } else {
            piece.line((first, 0), (last, 0));
            piece.entry = first;
        }
        piece.exit = piece.entry;
        piece.height = height;
        piece
    }

    /// Joins the open ends: one line remains.
    pub fn close(&mut self, double: bool) {
        let xs: Vec<i32> = self.ends.iter().map(|(x, _)| *x).collect();
        let (Some(first), Some(last)) = (xs.iter().min().copied(), xs.iter().max().copied()) else { return };
        if first == last && !double {
            return;
        }
        self.bottom(self.height + 10);
        let y = self.height;
        if double {
            self.line((first - 10, y), (last + 10, y));
            self.line((first - 10, y + 4), (last + 10, y + 4));
            self.height = y + 4;
            self.width = self.width.max(last + 10);
        } else {
            self.line((first, y), (last, y));
        }
        self.ends.retain(|(x, _)| *x == first);
        self.ends.truncate(1);
    }
}
