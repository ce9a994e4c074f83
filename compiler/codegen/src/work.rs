//! How much work Cranelift has with a function, so that large ones are compiled in ways that take near-linear time.
//!
//! Good register allocation takes quadratic time where many values live at once, or where values of many places are tied together by
//! parameters of blocks. Its time is estimated here, before anything is compiled: a wrong estimate costs time, nothing else.

use plcc_ir::analysis::ControlFlow;
use plcc_ir::entities::Entity;
use plcc_ir::{Block, Function, InstData, Region};
use rustc_hash::FxHashMap;

/// A value that a jump passes to a block is this much more work for register allocation than an instruction: it is tied to those of the other
/// jumps, and they are pulled apart again one by one.
const ARGUMENT_WORK: usize = 5;

/// A value that is live across this many instructions counts as one of them: it is compared with all values that are live at the
/// same time.
const CROSSED_PER_WORK: usize = 100;

/// How much work good register allocation is, in instructions.
pub fn allocation(function: &Function) -> usize {
    // Place at which each value is defined, and the last one at which it is used, in the order of blocks.
    let mut lives = vec![(0usize, 0usize); function.values.len()];
    let (mut place, mut arguments, mut crossed) = (0, 0, 0);
    for &block in &function.layout {
        let block = &function.blocks[block];
        let mut loaded = Loaded::default();
        for &param in &block.params {
            lives[param.index()].0 = place;
        }
        for &inst in &block.insts {
            place += 1;
            function.insts[inst].for_each_target(|call| arguments += call.args.len());
            crossed += loaded.again(&function.insts[inst], place);
            function.insts[inst].for_each_use(|value| {
                let value = function.resolve(value);
                // Constants are made where they are used.
                if function.constant(value).is_none() {
                    lives[value.index()].1 = place;
                }
            });
            for &result in &function.results[inst] {
                lives[result.index()].0 = place;
            }
        }
    }
    crossed += lives.iter().map(|&(defined, used)| used.saturating_sub(defined)).sum::<usize>();
    place + ARGUMENT_WORK * arguments + crossed / CROSSED_PER_WORK
}

/// The values loaded in a block, and the last position. Cranelift keeps them for the next load, however far away it is.
#[derive(Default)]
struct Loaded {
    places: FxHashMap<Region, FxHashMap<u32, usize>>,
}

impl Loaded {
    /// Number of instructions across which the value of this load lives already.
    fn again(&mut self, inst: &InstData, place: usize) -> usize {
        match inst {
            InstData::Load { addr } | InstData::LoadBit { addr, .. } if addr.base.is_none() => {
                let before = self.places.entry(addr.region).or_default().insert(addr.offset, place);
                before.map_or(0, |before| place - before)
            }
            InstData::Call { .. } | InstData::CallRuntime { .. } => {
                self.places.clear();
                0
            }
            _ => {
                if inst.has_side_effect() {
                    inst.for_each_address(|addr| {
                        self.places.remove(&addr.region);
                    });
                }
                0
            }
        }
    }
}

/// Number of jumps that close a loop: those to a block that reverse postorder does not put after the jump. The positions of blocks say
/// nothing about loops.
pub fn jumps_back(function: &Function) -> usize {
    let flow = ControlFlow::new(function);
    let closes = |block: Block, target: &Block| flow.rpo_index(*target) <= flow.rpo_index(block);
    let of_block = |&block: &Block| flow.successors(block).iter().filter(|target| closes(block, target)).count();
    flow.rpo.iter().map(of_block).sum()
}
