//! Loops that leave their hot way do not come back to it.
//!
//! The cold sides of a loop, faults and safepoints, go on in the loop: where they meet the hot way again, an index has another range,
//! a pointer another area, and memory may be another. What the hot way knows by itself, that a pointer that was in its area and moves
//! on by 2 is still there, is lost. So a loop gets a copy, which is all cold. A cold side goes on there, until the loop ends.
//!
//! ```text
//! b1: ... branch v1, b2, b3  ; b1: ... branch v1, b2, b3
//! b2: ... jump b1            ; b2: ... jump b1
//! b3 cold: ... jump b2       ; b3 cold: ... jump b5
//!                            ; b4 cold: copy of b1, to b5 and b6
//!                            ; b5 cold: copy of b2, to b4
//!                            ; b6 cold: copy of b3, to b5
//! ```
//!
//! The outermost loop that is small enough is copied with all in it.
//!
//! Cold sides before a loop also go on in the copy, so that what they bring does not count on the hot way: the length of a text that the
//! runtime had to look for. The block in which they would meet the hot way is copied with the loop.

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::{Block, Function, InstData, Region, RuntimeFn};
use rustc_hash::FxHashSet;

use crate::effects::{Effects, is_interruption};
use crate::loops::{Loop, Loops};
use crate::surroundings::Surroundings;
use crate::variables::{Versions, copy_blocks, join_versions, move_constants};

/// Instructions of a loop that is copied.
const LOOP_MAX: usize = 1500;
/// Instructions that copies may add to a function.
const GROWTH: usize = 4000;
/// Instructions of a block before a loop that is copied with it.
const MEET_MAX: usize = 60;
/// Larger functions are left as they are.
const INSTS_MAX: usize = 20_000;

/// Copies loops for their cold sides, in a function. Result: whether there were any.
pub fn part_cold_loops(function: &mut Function, surroundings: &Surroundings) -> bool {
    if function.insts.len() > INSTS_MAX || function.layout.iter().all(|&block| !function.blocks[block].cold) {
        return false;
    }
    let effects = &surroundings.effects;
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let loops = Loops::new(function, &cfg, &dominators);
    let mut growth = GROWTH;
    let mut done: FxHashSet<Block> = FxHashSet::default();
    let mut versions = Versions::default();
    for each in &loops.all {
        let inside: FxHashSet<Block> = each.blocks.iter().copied().collect();
        let meeting =
            meeting_before(function, &cfg, &dominators, each, &inside).filter(|(meet, _)| !done.contains(meet));
        let meet = meeting.as_ref().map(|&(meet, _)| meet).filter(|&meet| meet != each.header);
        let copied = each.blocks.iter().copied().chain(meet);
        let insts: usize = copied.map(|block| function.blocks[block].insts.len()).sum();
        if insts > LOOP_MAX.min(growth) || each.header == function.entry() || done.contains(&each.header) {
            continue;
        }
        let has_cold_sides = meeting.is_some() || comes_back(function, effects, &cfg, each, &inside);
        if function.blocks[each.header].cold || !has_cold_sides {
            continue;
        }
        // A block of a loop that was copied is no longer on all ways.
        let before = dominators.immediate(meet.unwrap_or(each.header)).filter(|before| !done.contains(before));
        let before = before.unwrap_or(function.entry());
        growth -= insts;
        let mut cold: Vec<Block> = each.blocks.iter().copied().filter(|&block| function.blocks[block].cold).collect();
        cold.extend(meeting.into_iter().flat_map(|(_, ways)| ways));
        let copied: FxHashSet<Block> = inside.into_iter().chain(meet).collect();
        done.extend(&copied);
        copy(function, &cold, &copied, before, &mut versions);
    }
    if !versions.made.is_empty() {
        join_versions(function, &versions);
    }
    !versions.made.is_empty()
}

/// The block before a loop in which cold sides meet the hot way, or the loop's header, and these sides.
fn meeting_before(
    function: &Function,
    cfg: &ControlFlow,
    dominators: &Dominators,
    each: &Loop,
    inside: &FxHashSet<Block>,
) -> Option<(Block, Vec<Block>)> {
    let ways: Vec<Block> = cfg.predecessors(each.header).iter().copied().filter(|way| !inside.contains(way)).collect();
    let (meet, ways) = match ways[..] {
        [only] => (only, cfg.predecessors(only).to_vec()),
        _ => (each.header, ways),
    };
    let is_header = ways.iter().any(|&way| dominators.dominates(meet, way));
    let data = &function.blocks[meet];
    if data.cold || data.params.is_empty() || data.insts.len() > MEET_MAX || meet == function.entry() || is_header {
        return None;
    }
    let (cold, hot): (Vec<Block>, Vec<Block>) = ways.into_iter().partition(|&way| function.blocks[way].cold);
    (!cold.is_empty() && !hot.is_empty()).then_some((meet, cold))
}

/// True if a cold side that may change something goes on where the hot way does.
fn comes_back(
    function: &Function,
    effects: &Effects,
    cfg: &ControlFlow,
    each: &Loop,
    inside: &FxHashSet<Block>,
) -> bool {
    let is_way_back = |&&block: &&Block| {
        let is_hot = |target: &Block| inside.contains(target) && !function.blocks[*target].cold;
        function.blocks[block].cold && cfg.successors(block).iter().any(is_hot)
    };
    each.blocks.iter().filter(is_way_back).any(|&block| {
        let is_quiet = |data: &InstData| match data {
            InstData::CallRuntime { function: RuntimeFn::Safepoint, .. } => {
                !effects.may_write(RuntimeFn::Safepoint, Region::M, None)
            }
            data => !data.has_side_effect() || data.is_terminator(),
        };
        let insts = &function.blocks[block].insts;
        let brings = function.terminator(block).is_some_and(|last| {
            let mut any = false;
            function.insts[last].for_each_target(|call| any |= inside.contains(&call.block) && !call.args.is_empty());
            any
        });
        brings || !insts.iter().all(|&inst| is_quiet(&function.insts[inst])) || !calls(function, block)
    })
}

/// True if the block calls the runtime.
fn calls(function: &Function, block: Block) -> bool {
    let is_call =
        |data: &InstData| matches!(data, InstData::CallRuntime { function, .. } if is_interruption(*function));
    function.blocks[block].insts.iter().any(|&inst| is_call(&function.insts[inst]))
}

/// Copies a loop, the blocks `inside`; where the `cold` blocks go on in it, they go on in the copy. `before` is a block that all ways to the loop
/// pass.
fn copy(function: &mut Function, cold: &[Block], inside: &FxHashSet<Block>, before: Block, versions: &mut Versions) {
    let order: Vec<Block> = function.layout.iter().copied().filter(|block| inside.contains(block)).collect();
    move_constants(function, &order, before);
    let copies = copy_blocks(function, &order, versions);
    for copy in copies.values() {
        function.blocks[*copy].cold = true;
    }
    for &block in cold {
        let Some(last) = function.terminator(block) else { continue };
        let mut data = function.insts[last].clone();
        data.for_each_target_mut(|call| {
            if !function.blocks[call.block].cold {
                call.block = copies.get(&call.block).copied().unwrap_or(call.block);
            }
        });
        function.insts[last] = data;
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn a_fault_goes_on_in_a_copy_of_the_loop() {
        check_pass(
            "part-cold-loops",
            "func @F -> i32 {
            b0(v0: i32):
            jump b1(v0)
            b1(v1: i32):
            v2 = const.i32 9
            v3 = ult v1, v2
            branch v3, b2(v1), b3
            b2(v4: i32):
            v5 = iadd v4, v2
            v6 = ne v5, v0
            branch v6, b1(v5), b4
            b3 cold:
            v7 = rt @sync_error(v1, v1, v1, v1)
            jump b2(v7)
            b4:
            ret v5
            }",
            "func @F -> i32 {
            b0(v0: i32):
            v1 = const.i32 9
            jump b1(v0)
            b1(v2: i32):
            v3 = ult v2, v1
            branch v3, b2(v2), b3
            b2(v4: i32):
            v5 = iadd v4, v1
            v6 = ne v5, v0
            branch v6, b1(v5), b4(v5)
            b3 cold:
            v7 = rt @sync_error(v2, v2, v2, v2)
            jump b6(v7)
            b4(v8: i32):
            ret v8
            b5(v9: i32) cold:
            v10 = ult v9, v1
            branch v10, b6(v9), b7
            b6(v11: i32) cold:
            v12 = iadd v11, v1
            v13 = ne v12, v0
            branch v13, b5(v12), b4(v12)
            b7 cold:
            v14 = rt @sync_error(v9, v9, v9, v9)
            jump b6(v14)
            }",
        );
    }
}
