//! The natural loops of a function.

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::Entity;
use plcc_ir::{Block, Function};
use rustc_hash::FxHashSet;

/// Blocks that are visited at most, over all loops: beyond that a loop is taken for smaller than it is.
const STEPS_MAX: usize = 2_000_000;

/// A loop: a block that its jumps back go to, and everything between.
pub struct Loop {
    pub header: Block,
    /// The header first.
    pub blocks: Vec<Block>,
}

/// See the module comment.
pub struct Loops {
    /// Inner loops come after the loops around them.
    pub all: Vec<Loop>,
    depth: Vec<u32>,
}

impl Loops {
    pub fn new(function: &Function, cfg: &ControlFlow, dominators: &Dominators) -> Loops {
        let mut loops = Loops { all: Vec::new(), depth: vec![0u32; function.blocks.len()] };
        let mut steps = 0;
        for &header in &cfg.rpo {
            let place = cfg.rpo_index(header);
            let back = cfg.predecessors(header).iter().copied();
            let mut work: Vec<Block> =
                back.filter(|&pred| cfg.rpo_index(pred) >= place && dominators.dominates(header, pred)).collect();
            if work.is_empty() {
                continue;
            }
            let mut blocks = vec![header];
            let mut inside: FxHashSet<Block> = [header].into_iter().collect();
            while let Some(block) = work.pop() {
                steps += 1;
                if steps < STEPS_MAX && inside.insert(block) {
                    blocks.push(block);
                    work.extend_from_slice(cfg.predecessors(block));
                }
            }
            blocks.iter().for_each(|block| loops.depth[block.index()] += 1);
            loops.all.push(Loop { header, blocks });
        }
        loops
    }

    /// In how many loops a block is.
    pub fn depth(&self, block: Block) -> u32 {
        self.depth[block.index()]
    }
}
