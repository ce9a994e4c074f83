//! Blocks to which many jumps lead are entered through gates.
//!
//! A gate is an empty block that takes at most [`JUMPS_MAX`] jumps and passes on their arguments; gates of gates follow until few jumps
//! remain. Cranelift's register allocator compares the places and values of all jumps to a block with one another, so that an exit of ten thousand loops,
//! or the end of a CASE of ten thousand arms, takes quadratic time without them. A gate costs nothing at run time: it
//! is as a rule empty in machine code as well, and jumps to it are led on to where it jumps.

use cranelift_codegen::ir::{self, BlockArg, InstBuilder, SourceLoc};
use cranelift_frontend::FunctionBuilder;
use plcc_ir::entities::Entity;
use plcc_ir::{Block, Function};
use rustc_hash::FxHashMap;

/// Jumps that a block takes without gates, and that a gate takes.
const JUMPS_MAX: u32 = 32;

/// The gates of one block.
#[derive(Default)]
struct Gates {
    blocks: Vec<ir::Block>,
    /// Jumps that the last gate has taken.
    taken: u32,
}

/// The gates of a function.
pub struct Joins {
    /// Number of jumps to each block of the function.
    jumps: Vec<u32>,
    gates: FxHashMap<Block, Gates>,
    /// Blocks with gates, in the order in which they got them.
    order: Vec<Block>,
}

impl Joins {
    pub fn new(function: &Function) -> Joins {
        let mut jumps = vec![0; function.blocks.len()];
        for &block in &function.layout {
            if let Some(inst) = function.terminator(block) {
                function.insts[inst].for_each_target(|call| jumps[call.block.index()] += 1);
            }
        }
        Joins { jumps, gates: FxHashMap::default(), order: Vec::new() }
    }

    /// Where the next jump to `block` goes, after `made` jumps: there, or to a gate.
    pub fn entrance(&mut self, b: &mut FunctionBuilder<'_>, block: Block, made: ir::Block) -> ir::Block {
        if self.jumps[block.index()] <= JUMPS_MAX {
            return made;
        }
        let gates = self.gates.entry(block).or_insert_with(|| {
            self.order.push(block);
            Gates::default()
        });
        match gates.blocks.last() {
            Some(&last) if gates.taken < JUMPS_MAX => {
                gates.taken += 1;
                last
            }
            _ => {
                let gate = gate(b, made);
                gates.blocks.push(gate);
                gates.taken = 1;
                gate
            }
        }
    }

    /// Fills the gates, when all jumps are there.
    pub fn finish(self, b: &mut FunctionBuilder<'_>, made: impl Fn(Block) -> ir::Block) {
        b.set_srcloc(SourceLoc::default());
        for block in self.order {
            let target = made(block);
            let mut level = self.gates[&block].blocks.clone();
            while level.len() > JUMPS_MAX as usize {
                let mut above = Vec::with_capacity(level.len() / JUMPS_MAX as usize + 1);
                for gates in level.chunks(JUMPS_MAX as usize) {
                    let next = gate(b, target);
                    gates.iter().for_each(|&gate| lead(b, gate, next));
                    above.push(next);
                }
                level = above;
            }
            level.iter().for_each(|&gate| lead(b, gate, target));
        }
    }
}

/// A block with the parameters of `target`.
fn gate(b: &mut FunctionBuilder<'_>, target: ir::Block) -> ir::Block {
    let gate = b.create_block();
    for index in 0..b.block_params(target).len() {
        let ty = b.func.dfg.value_type(b.block_params(target)[index]);
        b.append_block_param(gate, ty);
    }
    if b.func.layout.is_cold(target) {
        b.set_cold_block(gate);
    }
    gate
}

/// `gate` jumps to `target` with its parameters.
fn lead(b: &mut FunctionBuilder<'_>, gate: ir::Block, target: ir::Block) {
    b.switch_to_block(gate);
    let args: Vec<BlockArg> = b.block_params(gate).iter().map(|&param| BlockArg::Value(param)).collect();
    b.ins().jump(target, &args);
}
