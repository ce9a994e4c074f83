//! Which blocks every path to a block passes, as far as that is certain while a function is being built.
//!
//! A variable that is not written between a block and the one at which its paths meet has the same value in both: it
//! need not be looked for in each block in between, and gets no parameter there. Without this, a thousand variables and
//! a thousand joins would be a million parameters, nearly all of them taken out again.
//!
//! - The *parent* of a block is the closest block that every path to it passes. A block has one if all of its
//!   predecessors are known; as long as jumps to a block are still to come, it is a root. What is said about a block
//!   stays true: blocks on the way have all their predecessors, so that no path is added later.
//! - Time is counted in blocks: it advances by 1 whenever another block is filled. Blocks on the paths from the parent
//!   are filled after the parent ended, and before the *limit* of the block. So if a variable is not written between
//!   these times, it is not written on these paths. Blocks of other paths may be filled in between, too: then the
//!   answer is "perhaps", and the predecessors are searched one by one.
//! - To cross a long row of blocks in few steps, each block also has a *jump* to an ancestor further away, by the scheme
//!   of skew-binary numbers (Myers, "An applicative random-access stack", 1983). Nothing jumps past a root; when the start of a
//!   loop stops being one, the jumps from its end are made again, or a row of loops would be crossed block by block.

use crate::entities::{Block, EntityVec};

/// Maximum number of jumps that are rebuilt when a loop is complete. In longer loops they are few among many.
const RENEWED_MAX: usize = 256;

/// Time of an event that has not happened.
const NEVER: u32 = u32::MAX;

/// A step from a block to one that every path to it passes.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub to: Block,
    /// A variable that is not written in blocks that are filled after `after` and up to `limit` has one value at
    /// the end of `to` and at the start of the block.
    pub after: u32,
    pub limit: u32,
}

#[derive(Clone, Debug)]
struct Node {
    /// Time at which the block was first filled, and at which it ended.
    start: u32,
    end: u32,
    parent: Option<Step>,
    jump: Option<Step>,
    /// Number of ancestors. That of a root is a guess; it only balances the jumps.
    depth: u32,
}

/// The tree of the blocks built so far.
#[derive(Clone, Debug, Default)]
pub struct Paths {
    nodes: EntityVec<Block, Node>,
    now: u32,
}

impl Paths {
    /// A block that is not filled yet.
    pub fn add(&mut self) {
        self.nodes.push(Node { start: NEVER, end: NEVER, parent: None, jump: None, depth: 0 });
    }

    /// Code is added to `block` from now on.
    pub fn enter(&mut self, block: Block) {
        self.now += 1;
        let node = &mut self.nodes[block];
        node.start = node.start.min(self.now);
    }

    /// `block` is complete.
    pub fn leave(&mut self, block: Block) {
        self.nodes[block].end = self.now;
    }

    /// The time, counted in filled blocks.
    pub fn now(&self) -> u32 {
        self.now
    }

    /// True if code was added to `block`.
    pub fn is_entered(&self, block: Block) -> bool {
        self.nodes[block].start != NEVER
    }

    /// The step to the parent; `None`: `block` is a root.
    pub fn parent(&self, block: Block) -> Option<Step> {
        self.nodes[block].parent
    }

    /// A step to the parent or further away.
    pub fn jump(&self, block: Block) -> Option<Step> {
        self.nodes[block].jump
    }

    /// More jumps to `block` will come, in addition to those from `predecessors`: it stays a root.
    pub fn open(&mut self, block: Block, predecessors: &[Block]) {
        if let Some(&first) = predecessors.first() {
            self.nodes[block].depth = self.nodes[first].depth + 1;
        }
    }

    /// All jumps to `block`, which is being filled, or has been filled while it was open, are known.
    pub fn close(&mut self, block: Block, predecessors: &[Block]) {
        let Some(parent) = self.meeting_point(block, predecessors) else { return };
        let (start, end) = (self.nodes[block].start, self.nodes[parent].end);
        // A block that was filled before its parent ended is in no order with the others.
        if end >= start {
            return;
        }
        let limit = match predecessors {
            // Nothing is in between.
            [_] => end,
            _ => self.now,
        };
        let step = Step { to: parent, after: end, limit };
        self.nodes[block].parent = Some(step);
        self.nodes[block].depth = self.nodes[parent].depth + 1;
        self.nodes[block].jump = Some(self.further(step));
        // A loop ends where its last jump back is.
        let last = predecessors.iter().copied().max_by_key(|&predecessor| self.nodes[predecessor].start);
        if let Some(last) = last.filter(|&last| self.nodes[last].start > start) {
            self.renew(last, block);
        }
    }

    /// Makes the jumps on the way from `first` up to `last` again, as far as that is near.
    fn renew(&mut self, first: Block, last: Block) {
        let mut way = Vec::new();
        let mut at = first;
        while at != last {
            let Some(step) = self.nodes[at].parent else { return };
            if way.len() == RENEWED_MAX {
                return;
            }
            way.push((at, step));
            at = step.to;
        }
        for (block, step) in way.into_iter().rev() {
            self.nodes[block].depth = self.nodes[step.to].depth + 1;
            self.nodes[block].jump = Some(self.further(step));
        }
    }

    /// The jump of a block whose step to its parent is `step`: the parent, or two jumps on if they are equally long.
    fn further(&self, step: Step) -> Step {
        let parent = &self.nodes[step.to];
        let Some(first) = parent.jump else { return step };
        let middle = &self.nodes[first.to];
        let Some(second) = middle.jump else { return step };
        let depths = [parent.depth, middle.depth, self.nodes[second.to].depth];
        if depths[0].wrapping_sub(depths[1]) != depths[1].wrapping_sub(depths[2]) {
            return step;
        }
        // Writes in the blocks between count as well.
        let limits = [step.limit, parent.end, first.limit, middle.end, second.limit];
        Step { to: second.to, after: second.after, limit: limits.into_iter().fold(0, u32::max) }
    }

    /// The closest block that all paths to `block` pass.
    fn meeting_point(&self, block: Block, predecessors: &[Block]) -> Option<Block> {
        let mut meeting = None;
        for &predecessor in predecessors {
            let root = self.root(predecessor);
            if root == block {
                // Comes from the block itself: a loop.
                continue;
            }
            meeting = Some(match meeting {
                None => predecessor,
                Some(other) => self.common(other, predecessor)?,
            });
        }
        meeting
    }

    fn root(&self, mut block: Block) -> Block {
        while let Some(step) = self.nodes[block].jump {
            block = step.to;
        }
        block
    }

    /// The closest common ancestor. Ancestors are filled before their descendants.
    fn common(&self, mut a: Block, mut b: Block) -> Option<Block> {
        while a != b {
            if self.nodes[a].start < self.nodes[b].start {
                std::mem::swap(&mut a, &mut b);
            }
            let least = self.nodes[b].start;
            let node = &self.nodes[a];
            let jump = node.jump.filter(|jump| self.nodes[jump.to].start >= least);
            a = jump.or(node.parent)?.to;
        }
        Some(a)
    }
}
