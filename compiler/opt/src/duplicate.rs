//! Copies of small blocks for ways on which more is known.
//!
//! Two shapes are common in all lowered programs:
//!
//! - A loop tests at its head whether it goes on, and its end jumps there. A copy of the test at the end saves the jump: the
//!   body is entered by one branch a pass.
//! - Two accesses with the same index are checked one after the other. The first check sends faults to a cold block, which then
//!   goes on where the other way does, so that the second check has to test again what is known on each way. With a copy of the
//!   code between them for the cold way, the hot one is straight.
//!
//! A third is common on an S7-200, where all boxes of a network have the same condition: a short block branches by what was tested
//! before. Ways on which the test went otherwise get a copy of it. So do ways that bring constants by which it branches: the number of
//! the next step of a sequence, a variable that says that all is done.
//!
//! ```text
//! b1: branch v1, b2, b3      ; b1: branch v1, b2, b3
//! b2: ... jump b4            ; b2: ... b4: ... jump b5
//! b3 cold: ... jump b4       ; b3 cold: ... copy of b4 ... jump b6
//! b4: ... branch v1, b5, b6  ;
//! ```

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::Entity;
use plcc_ir::function::ValueDef;
use plcc_ir::{Block, BlockCall, Function, InstData, Value};
use rustc_hash::FxHashMap;

use crate::control_flow::simplify_control_flow;
use crate::fold::fold;
use crate::variables::{Versions, join_versions};

/// Instructions of a loop's test that is copied.
const TEST_MAX: usize = 6;
/// Instructions of a block that is copied for ways on which its branch is decided.
const DECIDED_MAX: usize = 8;
/// Copies of a block for the constants that decide where it goes.
const WAYS_MAX: usize = 300;
/// Instructions of a block that is copied for cold ways.
const COLD_MAX: usize = 60;
/// Instructions that copies may add to a function, besides as many as it has.
const GROWTH: usize = 2000;
/// Rounds over a function: the next check comes to light when one is gone.
const ROUNDS_MAX: usize = 12;
/// Larger functions are left as they are.
const INSTS_MAX: usize = 100_000;

/// Copies the tests of loops to their ends. Result: whether there were any.
pub fn turn_loops(function: &mut Function) -> bool {
    if function.insts.len() > INSTS_MAX {
        return false;
    }
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let mut copies = Copies::default();
    for &header in &cfg.rpo {
        let place = cfg.rpo_index(header);
        let is_back = |&&pred: &&Block| cfg.rpo_index(pred) >= place && dominators.dominates(header, pred);
        let back: Vec<Block> = cfg.predecessors(header).iter().filter(is_back).copied().collect();
        // The function's first block has its parameters from outside.
        if !back.is_empty()
            && header != function.entry()
            && is_test(function, header)
            && !copies.touches(function, header)
        {
            copies.add(function, header, &back);
        }
    }
    let changed = !copies.made.is_empty();
    copies.finish(function);
    changed
}

/// True of a block that only computes a little and branches.
fn is_test(function: &Function, block: Block) -> bool {
    let insts = &function.blocks[block].insts;
    let pure = |data: &InstData| {
        matches!(
            data,
            InstData::Const { .. }
                | InstData::IntCompare { .. }
                | InstData::FloatCompare { .. }
                | InstData::Convert { .. }
                | InstData::Binary { .. }
                | InstData::Unary { .. }
                | InstData::Branch { .. }
        )
    };
    insts.len() <= TEST_MAX
        && insts.iter().all(|&inst| pure(&function.insts[inst]))
        && function.terminator(block).is_some_and(|inst| matches!(function.insts[inst], InstData::Branch { .. }))
}

/// Gives cold ways copies of the blocks in which they meet hot ones, where both then branch by what is known.
///
/// Result: whether there were any.
pub fn part_cold_ways(function: &mut Function) -> bool {
    if function.insts.len() > INSTS_MAX {
        return false;
    }
    let mut growth = function.insts.len() + GROWTH;
    let mut changed = false;
    for _ in 0..ROUNDS_MAX {
        if part_constant_ways(function, &mut growth) {
            // What the constants decide shows which constants other ways bring.
            simplify_control_flow(function);
            fold(function);
            simplify_control_flow(function);
        } else if !part_in_function(function, &mut growth) {
            break;
        }
        changed = true;
        function.remove_unreachable_blocks();
    }
    changed
}

/// Gives ways copies of a short block that branches by constants that they bring.
fn part_constant_ways(function: &mut Function, growth: &mut usize) -> bool {
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let mut copies = Copies::default();
    for &meet in &cfg.rpo {
        let preds = cfg.predecessors(meet);
        let size = function.blocks[meet].insts.len();
        let is_loop = || preds.iter().any(|&pred| dominators.dominates(meet, pred));
        if preds.len() < 2 || size > DECIDED_MAX || meet == function.entry() || is_loop() {
            continue;
        }
        let Some(deciding) = deciding_params(function, meet) else { continue };
        let mut ways: Vec<(Vec<u64>, Vec<Block>)> = Vec::new();
        for &pred in preds {
            let Some(brought) = constants_brought(function, pred, meet, &deciding) else { continue };
            match ways.iter().position(|(other, _)| *other == brought) {
                Some(index) => ways[index].1.push(pred),
                None if ways.len() < WAYS_MAX => ways.push((brought, vec![pred])),
                None => {}
            }
        }
        if ways.iter().any(|(_, list)| list.len() == preds.len()) || copies.touches(function, meet) {
            continue;
        }
        for (_, list) in ways {
            if size > *growth {
                break;
            }
            *growth -= size;
            let is_cold = function.blocks[meet].cold || list.iter().all(|&way| function.blocks[way].cold);
            let copy = copies.add(function, meet, &list);
            function.blocks[copy].cold = is_cold;
        }
    }
    let changed = !copies.made.is_empty();
    copies.finish(function);
    changed
}

/// The parameters that alone decide where a block goes, by their positions; none if something else does.
fn deciding_params(function: &Function, block: Block) -> Option<Vec<usize>> {
    let (InstData::Branch { cond: decides, .. } | InstData::Switch { value: decides, .. }) =
        &function.insts[function.terminator(block)?]
    else {
        return None;
    };
    let mut open = vec![function.resolve(*decides)];
    let mut found = Vec::new();
    while let Some(value) = open.pop() {
        match function.values[value].def {
            ValueDef::Param(at, place) if at == block => found.push(place as usize),
            ValueDef::Result(inst, _) => match &function.insts[inst] {
                InstData::Const { .. } => {}
                InstData::IntCompare { .. }
                | InstData::Convert { .. }
                | InstData::Binary { .. }
                | InstData::Unary { .. }
                    if function.blocks[block].insts.contains(&inst) =>
                {
                    function.insts[inst].for_each_use(|used| open.push(function.resolve(used)));
                }
                _ => return None,
            },
            _ => return None,
        }
    }
    (!found.is_empty()).then_some(found)
}

/// The constants that the only jump from `pred` brings for these parameters of `block`.
fn constants_brought(function: &Function, pred: Block, block: Block, params: &[usize]) -> Option<Vec<u64>> {
    let mut calls: Vec<BlockCall> = Vec::new();
    function.insts[function.terminator(pred)?].clone().for_each_target_mut(|call| {
        if call.block == block {
            calls.push(call.clone());
        }
    });
    let [call] = calls.as_slice() else { return None };
    params.iter().map(|&param| function.constant(function.resolve(call.args[param]))).collect()
}

fn part_in_function(function: &mut Function, growth: &mut usize) -> bool {
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let mut copies = Copies::default();
    let mut decided: Vec<(Block, bool)> = Vec::new();
    for &meet in &cfg.rpo {
        let data = &function.blocks[meet];
        if data.insts.len() > COLD_MAX || data.insts.len() > *growth || meet == function.entry() {
            continue;
        }
        let Some(&last) = data.insts.last() else { continue };
        let InstData::Branch { cond, then_to, else_to } = &function.insts[last] else { continue };
        // In a loop, what was tested in the pass before is another value.
        if is_made_in(function, meet, *cond) {
            continue;
        }
        let preds = cfg.predecessors(meet);
        if copies.touches(function, meet) || then_to.block == meet || else_to.block == meet {
            continue;
        }
        // A short block is copied for the ways on which its branch is decided.
        if data.insts.len() <= DECIDED_MAX && preds.len() > 1 {
            let way = |&pred: &Block| known_at(function, &cfg, &dominators, pred, *cond);
            let all_cold = |ways: &[Block]| ways.iter().all(|&way| function.blocks[way].cold);
            let decided_ways = [true, false].map(|holds| {
                (holds, preds.iter().copied().filter(|pred| way(pred) == Some(holds)).collect::<Vec<Block>>())
            });
            let apart = decided_ways
                .into_iter()
                .filter(|(_, ways)| !ways.is_empty() && ways.len() < preds.len())
                .min_by_key(|(_, ways)| (!all_cold(ways), ways.len()));
            if let Some((holds, ways)) = apart {
                let others: Vec<Block> = preds.iter().copied().filter(|pred| !ways.contains(pred)).collect();
                let is_cold = data.cold || all_cold(&ways);
                let others_cold = all_cold(&others);
                let rest = others.iter().all(|pred| way(pred) == Some(!holds));
                *growth -= data.insts.len();
                let copy = copies.add(function, meet, &ways);
                function.blocks[copy].cold = is_cold;
                function.blocks[meet].cold |= others_cold;
                decided.push((copy, holds));
                if rest {
                    decided.push((meet, !holds));
                }
                continue;
            }
        }
        if function.blocks[meet].cold {
            continue;
        }
        let cold: Vec<Block> = preds.iter().copied().filter(|&pred| function.blocks[pred].cold).collect();
        let hot: Vec<Block> = preds.iter().copied().filter(|&pred| !function.blocks[pred].cold).collect();
        if cold.is_empty() || hot.is_empty() {
            continue;
        }
        // The condition was tested on the way: true on all hot ways and not on the cold ones, or the other way around.
        let known = |ways: &[Block]| {
            let mut known = ways.iter().map(|&way| known_at(function, &cfg, &dominators, way, *cond));
            let first = known.next()??;
            known.all(|other| other == Some(first)).then_some(first)
        };
        let Some(on_hot) = known(&hot) else { continue };
        // Only where the cold way goes to another place, or what it does then is not known, is a copy worth it.
        let on_cold = known(&cold);
        if on_cold == Some(on_hot) {
            continue;
        }
        *growth -= data.insts.len();
        let copy = copies.add(function, meet, &cold);
        function.blocks[copy].cold = true;
        decided.push((meet, on_hot));
        decided.extend(on_cold.map(|on_cold| (copy, on_cold)));
    }
    if decided.is_empty() {
        return false;
    }
    for (block, holds) in decided {
        let inst = function.terminator(block).expect("it ends with a branch");
        if let InstData::Branch { then_to, else_to, .. } = &function.insts[inst] {
            let target = if holds { then_to } else { else_to }.clone();
            function.insts[inst] = InstData::Jump { target };
        }
    }
    copies.finish(function);
    true
}

/// True if the block computes the value.
fn is_made_in(function: &Function, block: Block, value: Value) -> bool {
    match function.values[function.resolve(value)].def {
        ValueDef::Param(at, _) => at == block,
        ValueDef::Result(inst, _) => function.blocks[block].insts.contains(&inst),
        ValueDef::Alias(_) => false,
    }
}

/// What a branch above `block` says of `cond` there.
fn known_at(
    function: &Function,
    cfg: &ControlFlow,
    dominators: &Dominators,
    block: Block,
    cond: Value,
) -> Option<bool> {
    /// Branches that are looked at.
    const STEPS_MAX: usize = 16;
    let cond = function.resolve(cond);
    let mut at = block;
    for _ in 0..STEPS_MAX {
        if let &[pred] = cfg.predecessors(at)
            && let InstData::Branch { cond: tested, then_to, else_to } = &function.insts[function.terminator(pred)?]
            && function.resolve(*tested) == cond
            && then_to.block != else_to.block
        {
            return Some(then_to.block == at);
        }
        at = dominators.immediate(at)?;
    }
    None
}

/// Blocks that were copied, and the versions of their values.
#[derive(Default)]
struct Copies {
    versions: Versions,
    /// Blocks that were copied, and their copies.
    made: FxHashMap<Block, Block>,
}

impl Copies {
    /// True if a copied block jumps to `block`, or it was copied: the copy would be out of date.
    fn touches(&self, function: &Function, block: Block) -> bool {
        self.made.contains_key(&block)
            || self
                .made
                .iter()
                .any(|(&from, &to)| [from, to].into_iter().any(|at| function.successors(at).contains(&block)))
    }

    /// Copies `block` for the ways from `ways`.
    fn add(&mut self, function: &mut Function, block: Block, ways: &[Block]) -> Block {
        let copy = function.add_block();
        let mut values: FxHashMap<Value, Value> = FxHashMap::default();
        for param in function.blocks[block].params.clone() {
            let new = function.add_param(copy, function.ty(param));
            values.insert(param, new);
        }
        for inst in function.blocks[block].insts.clone() {
            let mut data = function.insts[inst].clone();
            data.map_uses(|value| {
                let value = function.resolve(value);
                values.get(&value).copied().unwrap_or(value)
            });
            let types: Vec<_> = function.results[inst].iter().map(|&result| function.ty(result)).collect();
            let new = function.make_inst(data, &types, function.locs[inst]);
            for (&old, &result) in function.results[inst].clone().iter().zip(&function.results[new].clone()) {
                values.insert(old, result);
            }
            function.blocks[copy].insts.push(new);
        }
        for &way in ways {
            let Some(inst) = function.terminator(way) else { continue };
            function.insts[inst].for_each_target_mut(|call: &mut BlockCall| {
                if call.block == block {
                    call.block = copy;
                }
            });
        }
        // The copy is laid out after the last of the ways to it.
        let last = ways.iter().filter_map(|way| function.layout.iter().position(|at| at == way)).max();
        if let Some(last) = last {
            function.layout.retain(|&at| at != copy);
            function.layout.insert((last + 1).min(function.layout.len()), copy);
        }
        let mut values: Vec<(Value, Value)> = values.into_iter().collect();
        values.sort_unstable_by_key(|(old, _)| old.index());
        for (old, new) in values {
            self.versions.add(function, old, new);
        }
        self.made.insert(block, copy);
        copy
    }

    fn finish(self, function: &mut Function) {
        if !self.made.is_empty() {
            join_versions(function, &self.versions);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn the_end_of_a_loop_tests_itself() {
        check_pass(
            "turn-loops",
            "func @F -> i16 {
            b0(v0: i16):
            jump b1(v0)
            b1(v1: i16):
            v2 = const.i16 9
            v3 = sle v1, v2
            branch v3, b2, b3
            b2:
            v4 = const.i16 1
            v5 = iadd v1, v4
            jump b1(v5)
            b3:
            ret v1
            }",
            "func @F -> i16 {
            b0(v0: i16):
            jump b1(v0)
            b1(v1: i16):
            v2 = const.i16 9
            v3 = sle v1, v2
            branch v3, b2(v1), b4(v1)
            b2(v4: i16):
            v5 = const.i16 1
            v6 = iadd v4, v5
            jump b3(v6)
            b3(v7: i16):
            v8 = const.i16 9
            v9 = sle v7, v8
            branch v9, b2(v7), b4(v7)
            b4(v10: i16):
            ret v10
            }",
        );
    }

    #[test]
    fn a_constant_goes_where_it_leads() {
        check_pass(
            "part-cold-ways",
            "func @F -> i16 {
            b0(v0: i16, v1: i1):
            branch v1, b1, b2
            b1:
            v2 = const.i32 1
            store.i16 M 0, v0
            jump b3(v2)
            b2:
            v3 = sext.i32 v0
            jump b3(v3)
            b3(v4: i32):
            switch v4 [b4, b5], b6
            b4:
            v5 = const.i16 4
            ret v5
            b5:
            v6 = const.i16 5
            ret v6
            b6:
            v7 = trunc.i16 v4
            ret v7
            }",
            "func @F -> i16 {
            b0(v0: i16, v1: i1):
            branch v1, b1, b2
            b1:
            v2 = const.i32 1
            store.i16 M 0, v0
            jump b4
            b2:
            v3 = sext.i32 v0
            switch v3 [b3, b4], b5
            b3:
            v4 = const.i16 4
            ret v4
            b4:
            v5 = const.i16 5
            ret v5
            b5:
            v6 = trunc.i16 v3
            ret v6
            }",
        );
    }

    #[test]
    fn a_cold_way_has_its_own_copy_of_what_follows() {
        check_pass(
            "part-cold-ways",
            "func @F -> i32 {
            b0(v0: i1, v1: i32):
            branch v0, b1, b2
            b1:
            jump b3(v1)
            b2 cold:
            v2 = load.i32 state 4
            jump b3(v2)
            b3(v3: i32):
            v4 = iadd v3, v1
            branch v0, b4, b5
            b4:
            ret v4
            b5 cold:
            ret v3
            }",
            "func @F -> i32 {
            b0(v0: i1, v1: i32):
            branch v0, b1, b2
            b1:
            jump b4(v1)
            b2 cold:
            v2 = load.i32 state 4
            jump b3(v2)
            b3(v3: i32) cold:
            v4 = iadd v3, v1
            jump b6
            b4(v5: i32):
            v6 = iadd v5, v1
            jump b5
            b5:
            ret v6
            b6 cold:
            ret v3
            }",
        );
    }
}
