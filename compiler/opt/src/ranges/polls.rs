//! Short loops do not ask whether something is due.
//!
//! Each pass of a loop is a safepoint: it looks at the attention flag, so that interrupts, the cycle monitor and the end of the
//! process do not wait for the loop. A loop that certainly ends soon needs none; what is due is served at the next
//! safepoint, microseconds later. Nothing but the watchdog raises the flag while the loop calls nothing. A loop around one that
//! may take long keeps its looks, and so does that one.

use plcc_abi::functions::Effect;
use plcc_abi::layout::state;
use plcc_ir::analysis::ControlFlow;
use plcc_ir::{Address, Block, BlockCall, Function, InstData, IntCc, Region, Value};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::loops::Loops;

/// Instructions that may run without a look at the flag: a few microseconds.
const INSTS_MAX: u64 = 20_000;

/// Removes the looks of loops that begin so many passes at most.
pub fn remove(function: &mut Function, cfg: &ControlFlow, loops: &Loops, passes: &FxHashMap<Block, i64>) {
    // Instructions of loops that look at the flag no more, with all their passes, by header.
    let mut unwatched: FxHashMap<Block, u64> = FxHashMap::default();
    // Inner loops first.
    for each in loops.all.iter().rev() {
        let Some(&passes) = passes.get(&each.header) else { continue };
        let inside: FxHashSet<Block> = each.blocks.iter().copied().collect();
        if !ends_inside(cfg, &inside, each.header, &unwatched) {
            continue;
        }
        let Some(insts) = cost(function, &inside, each.header, &unwatched) else { continue };
        let total = insts.saturating_mul(passes.unsigned_abs());
        if total > INSTS_MAX {
            continue;
        }
        unwatched.insert(each.header, total);
        for &block in &each.blocks {
            if let Some(target) = look(function, block) {
                let inst = function.terminator(block).expect("a look is a branch");
                function.insts[inst] = InstData::Jump { target };
            }
        }
    }
}

/// True if a pass ends: each jump back within the loop is one of a loop that is known to end soon.
fn ends_inside(cfg: &ControlFlow, inside: &FxHashSet<Block>, header: Block, unwatched: &FxHashMap<Block, u64>) -> bool {
    inside.iter().all(|&block| {
        let back = |&&target: &&Block| inside.contains(&target) && cfg.rpo_index(target) <= cfg.rpo_index(block);
        cfg.successors(block).iter().filter(back).all(|target| *target == header || unwatched.contains_key(target))
    })
}

/// Instructions of a pass; `None` if the loop calls something.
fn cost(
    function: &Function,
    inside: &FxHashSet<Block>,
    header: Block,
    unwatched: &FxHashMap<Block, u64>,
) -> Option<u64> {
    let mut sum = 0u64;
    for &block in inside {
        let data = &function.blocks[block];
        if data.cold {
            continue;
        }
        let calls = data.insts.iter().any(|&inst| match &function.insts[inst] {
            InstData::Call { .. } => true,
            InstData::CallRuntime { function, .. } => function.effect() != Effect::Pure,
            _ => false,
        });
        if calls {
            return None;
        }
        sum += data.insts.len() as u64;
        if block != header {
            sum += unwatched.get(&block).copied().unwrap_or(0);
        }
    }
    Some(sum)
}

/// Where a block goes on if it ends with a look at the flag and nothing is due.
fn look(function: &Function, block: Block) -> Option<BlockCall> {
    let InstData::Branch { cond, then_to, else_to } = &function.insts[function.terminator(block)?] else { return None };
    let is_flag = |value: Value| {
        matches!(
            function.defining(value),
            Some(InstData::Load { addr: Address { region: Region::State, base: None, offset: state::ATTENTION } })
        )
    };
    match function.defining(*cond)? {
        InstData::IntCompare { cc: IntCc::Ne, args: [a, b] }
            if is_flag(*a) && function.constant(*b) == Some(0) && function.blocks[then_to.block].cold =>
        {
            Some(else_to.clone())
        }
        _ => None,
    }
}
