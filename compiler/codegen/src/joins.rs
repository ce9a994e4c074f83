//! Blocks to which many jumps lead are entered through gates.
//!
//! A gate is an empty block that takes at most [`JUMPS_MAX`] jumps and passes on their arguments; gates of gates follow until few jumps
//! remain. Cranelift's register allocator compares the places and values of all jumps to a block with one another, so that an exit of ten thousand loops,
//! or the end of a CASE of ten thousand arms, takes quadratic time without them. A gate costs nothing at run time: it
//! is as a rule empty in machine code as well, and jumps to it are led on to where it jumps.
//!
//! Gates of gates do not keep the values apart: the allocator joins the parameters of all gates first, and then compares each jump with
//! that whole. Where there are so many jumps, the first gates leave their arguments in memory, and the block is entered with what is there.

use cranelift_codegen::ir::{self, BlockArg, InstBuilder, SourceLoc, StackSlot, StackSlotData, StackSlotKind, types};
use cranelift_frontend::FunctionBuilder;
use plcc_ir::entities::Entity;
use plcc_ir::{Block, Function};
use rustc_hash::FxHashMap;

/// Jumps that a block takes without gates, and that a gate takes.
const JUMPS_MAX: u32 = 32;

/// Parameters that go through memory at most: each gate stores all of them.
const SLOTS_MAX: usize = 8;

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
            let mut target = made(block);
            let mut level = self.gates[&block].blocks.clone();
            if level.len() > JUMPS_MAX as usize && (1..=SLOTS_MAX).contains(&b.block_params(target).len()) {
                let slots = slots(b, target);
                target = entrance_from(b, &slots, target);
                level.iter_mut().for_each(|gate| *gate = leave_in(b, *gate, &slots, target));
            }
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

/// A place on the stack for each parameter of a block.
fn slots(b: &mut FunctionBuilder<'_>, block: ir::Block) -> Vec<StackSlot> {
    let types: Vec<ir::Type> = b.block_params(block).iter().map(|&param| b.func.dfg.value_type(param)).collect();
    let data = |ty: ir::Type| StackSlotData::new(StackSlotKind::ExplicitSlot, ty.bytes(), ty.bytes().ilog2() as u8);
    types.into_iter().map(|ty| b.create_sized_stack_slot(data(ty))).collect()
}

/// A block without parameters that enters `target` with what is in the slots.
fn entrance_from(b: &mut FunctionBuilder<'_>, slots: &[StackSlot], target: ir::Block) -> ir::Block {
    let entrance = block_beside(b, target);
    b.switch_to_block(entrance);
    let args: Vec<BlockArg> = (slots.iter().enumerate())
        .map(|(index, &slot)| {
            let ty = b.func.dfg.value_type(b.block_params(target)[index]);
            BlockArg::Value(b.ins().stack_load(types::I64, ty, slot, 0))
        })
        .collect();
    b.ins().jump(target, &args);
    entrance
}

/// `gate` leaves its parameters in the slots; the result is the block without parameters that follows it.
fn leave_in(b: &mut FunctionBuilder<'_>, gate: ir::Block, slots: &[StackSlot], target: ir::Block) -> ir::Block {
    let next = block_beside(b, target);
    b.switch_to_block(gate);
    for (index, &slot) in slots.iter().enumerate() {
        let param = b.block_params(gate)[index];
        b.ins().stack_store(types::I64, param, slot, 0);
    }
    b.ins().jump(next, &[]);
    next
}

/// A block, cold if `target` is.
fn block_beside(b: &mut FunctionBuilder<'_>, target: ir::Block) -> ir::Block {
    let block = b.create_block();
    if b.func.layout.is_cold(target) {
        b.set_cold_block(block);
    }
    block
}

/// A block with the parameters of `target`.
fn gate(b: &mut FunctionBuilder<'_>, target: ir::Block) -> ir::Block {
    let gate = block_beside(b, target);
    for index in 0..b.block_params(target).len() {
        let ty = b.func.dfg.value_type(b.block_params(target)[index]);
        b.append_block_param(gate, ty);
    }
    gate
}

/// `gate` jumps to `target` with its parameters.
fn lead(b: &mut FunctionBuilder<'_>, gate: ir::Block, target: ir::Block) {
    b.switch_to_block(gate);
    let args: Vec<BlockArg> = b.block_params(gate).iter().map(|&param| BlockArg::Value(param)).collect();
    b.ins().jump(target, &args);
}
