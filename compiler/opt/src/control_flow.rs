//! Simplification of control flow.
//!
//! - Blocks that cannot be reached are dropped.
//! - Jumps to a block that only jumps on go where that one goes; so do jumps that bring a constant to a block that only
//!   branches by it.
//! - A block parameter that always gets the same value is that value.
//! - A block whose only predecessor only jumps to it is appended to that one.
//! - A block to which only cold ones lead is cold; one to which another one always goes on is not.
//!
//! Each step is one sweep over the blocks; a few rounds are made, since one step makes room for another.

use plcc_ir::analysis::ControlFlow;
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::function::BlockData;
use plcc_ir::{Block, BlockCall, Function, Inst, InstData, Loc, Value, Values};

/// Rounds over a function; a later one finds little.
const ROUNDS_MAX: usize = 3;
/// How many empty blocks in a row are skipped by one jump: also the end of circles of empty blocks.
const HOPS_MAX: usize = 16;

/// Simplifies the control flow of a function. Result: whether anything changed.
pub fn simplify_control_flow(function: &mut Function) -> bool {
    let mut any = false;
    for _ in 0..ROUNDS_MAX {
        let mut changed = function.remove_unreachable_blocks() > 0;
        if thread_jumps(function) {
            function.remove_unreachable_blocks();
            changed = true;
        }
        changed |= remove_redundant_params(function);
        changed |= merge_blocks(function);
        if !changed {
            break;
        }
        any = true;
        spread_cold(function);
    }
    any
}

/// Marks the blocks that only cold ones lead to, and unmarks those that others always go on to. Returns stay as they are: a cold one
/// is that of a STOP.
fn spread_cold(function: &mut Function) {
    if function.layout.iter().all(|&block| !function.blocks[block].cold) {
        return;
    }
    let cfg = ControlFlow::new(function);
    for &block in &cfg.rpo {
        if let (false, &[next]) = (function.blocks[block].cold, cfg.successors(block)) {
            function.blocks[next].cold &= is_end(function, next);
        }
        let preds = cfg.predecessors(block);
        if block != function.entry() && !is_end(function, block) && preds.iter().all(|&pred| function.blocks[pred].cold)
        {
            function.blocks[block].cold = true;
        }
    }
}

/// True if the function ends with the block.
fn is_end(function: &Function, block: Block) -> bool {
    function.terminator(block).is_none_or(|last| matches!(function.insts[last], InstData::Return { .. }))
}

/// Skips blocks that only jump on.
fn thread_jumps(function: &mut Function) -> bool {
    let foreign = params_used_elsewhere(function);
    let mut changed = false;
    for index in 0..function.layout.len() {
        let Some(inst) = function.terminator(function.layout[index]) else { continue };
        let mut data = std::mem::replace(&mut function.insts[inst], InstData::Return { values: Values::new() });
        data.for_each_target_mut(|call| {
            for _ in 0..HOPS_MAX {
                match next_target(function, &foreign, call) {
                    Some(next) if next != *call => *call = next,
                    _ => break,
                }
                changed = true;
            }
        });
        if let InstData::Branch { then_to, else_to, .. } = &data
            && then_to == else_to
        {
            data = InstData::Jump { target: then_to.clone() };
            changed = true;
        }
        function.insts[inst] = data;
    }
    changed
}

/// For each block that could be skipped, whether a parameter of it is used anywhere but in its terminator.
fn params_used_elsewhere(function: &Function) -> Vec<bool> {
    let may_be_skipped = |block: &BlockData| block.insts.len() == 1 && !block.params.is_empty();
    if !function.layout.iter().any(|&block| may_be_skipped(&function.blocks[block])) {
        return vec![false; function.blocks.len()];
    }
    let mut owner: EntityVec<Value, Option<Block>> = EntityVec::filled(None, function.values.len());
    for &block in &function.layout {
        for &param in &function.blocks[block].params {
            owner[param] = Some(block);
        }
    }
    let mut used = vec![false; function.blocks.len()];
    for &block in &function.layout {
        let terminator = function.terminator(block);
        for &inst in &function.blocks[block].insts {
            function.insts[inst].for_each_use(|value| {
                if let Some(at) = owner[function.resolve(value)]
                    && (at != block || Some(inst) != terminator)
                {
                    used[at.index()] = true;
                }
            });
        }
    }
    used
}

/// Where a jump ends up if the target does nothing but jump on.
fn next_target(function: &Function, foreign: &[bool], call: &BlockCall) -> Option<BlockCall> {
    let data = &function.blocks[call.block];
    let [only] = data.insts[..] else { return None };
    if foreign[call.block.index()] {
        return None;
    }
    let argument = |value: Value| {
        let value = function.resolve(value);
        data.params.iter().position(|&param| param == value).map_or(value, |index| call.args[index])
    };
    let target = match &function.insts[only] {
        InstData::Jump { target } => target,
        InstData::Branch { cond, then_to, else_to } => {
            if function.constant(argument(*cond))? != 0 {
                then_to
            } else {
                else_to
            }
        }
        _ => return None,
    };
    Some(BlockCall { block: target.block, args: target.args.iter().map(|&arg| argument(arg)).collect() })
}

/// The arguments of all jumps for a block parameter.
#[derive(Clone, Copy)]
enum Incoming {
    Nothing,
    One(Value),
    /// Different values that are the same constant.
    Constant(u64),
    Several,
}

/// Replaces parameters that always get the same value.
fn remove_redundant_params(function: &mut Function) -> bool {
    if function.layout.iter().skip(1).all(|&block| function.blocks[block].params.is_empty()) {
        return false;
    }
    let mut any = false;
    for _ in 0..ROUNDS_MAX {
        let incoming = incoming_values(function);
        let mut removed = vec![false; function.values.len()];
        let mut changed = false;
        for index in 1..function.layout.len() {
            let block = function.layout[index];
            for param in function.blocks[block].params.clone() {
                let value = match incoming[param] {
                    Incoming::One(value) => function.resolve(value),
                    Incoming::Constant(bits) => constant_at_start(function, block, param, bits),
                    Incoming::Nothing | Incoming::Several => continue,
                };
                if value == param {
                    continue;
                }
                function.replace_value(param, value);
                removed[param.index()] = true;
                changed = true;
            }
        }
        if !changed {
            break;
        }
        any = true;
        remove_params(function, &removed);
        function.resolve_aliases();
    }
    any
}

fn incoming_values(function: &Function) -> EntityVec<Value, Incoming> {
    let mut incoming = EntityVec::filled(Incoming::Nothing, function.values.len());
    for &block in &function.layout {
        let Some(inst) = function.terminator(block) else { continue };
        function.insts[inst].for_each_target(|call| {
            for (&param, &arg) in function.blocks[call.block].params.iter().zip(&call.args) {
                let arg = function.resolve(arg);
                if arg == param {
                    continue;
                }
                let constant = function.constant(arg);
                incoming[param] = match incoming[param] {
                    Incoming::Nothing => Incoming::One(arg),
                    Incoming::One(known) if known == arg => Incoming::One(arg),
                    Incoming::One(known) => match (function.constant(known), constant) {
                        (Some(a), Some(b)) if a == b => Incoming::Constant(a),
                        _ => Incoming::Several,
                    },
                    Incoming::Constant(bits) if constant == Some(bits) => Incoming::Constant(bits),
                    Incoming::Constant(_) | Incoming::Several => Incoming::Several,
                };
            }
        });
    }
    incoming
}

fn constant_at_start(function: &mut Function, block: Block, like: Value, bits: u64) -> Value {
    let ty = function.ty(like);
    let inst = function.make_inst(InstData::Const { bits }, &[ty], Loc(0));
    function.blocks[block].insts.insert(0, inst);
    function.result(inst)
}

/// Takes the parameters that `removed` marks out of all blocks but the entry, and their values out of all jumps.
pub fn remove_params(function: &mut Function, removed: &[bool]) {
    let is_removed = |value: &Value| removed.get(value.index()) == Some(&true);
    for index in 0..function.layout.len() {
        let Some(inst) = function.terminator(function.layout[index]) else { continue };
        let blocks = &function.blocks;
        function.insts[inst].for_each_target_mut(|call| {
            let mut params = blocks[call.block].params.iter();
            call.args.retain(|_| params.next().is_none_or(|param| !is_removed(param)));
        });
    }
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        if !function.blocks[block].params.iter().any(is_removed) {
            continue;
        }
        function.blocks[block].params.retain(|param| !is_removed(param));
        for (number, &param) in (0u32..).zip(&function.blocks[block].params) {
            function.values[param].def = plcc_ir::function::ValueDef::Param(block, number);
        }
    }
}

/// Appends blocks to their only predecessor.
fn merge_blocks(function: &mut Function) -> bool {
    if !has_sole_successors(function) {
        return false;
    }
    let cfg = ControlFlow::new(function);
    let mut merged = vec![false; function.blocks.len()];
    for &block in &cfg.rpo {
        if merged[block.index()] {
            continue;
        }
        while let Some(next) = sole_successor(function, &cfg, block) {
            let jump = function.blocks[block].insts.pop().expect("the block ends with a jump");
            let InstData::Jump { target } = function.insts[jump].clone() else { unreachable!("it is a jump") };
            for (param, arg) in std::mem::take(&mut function.blocks[next].params).into_iter().zip(target.args) {
                function.replace_value(param, arg);
            }
            // A return that is not that of a STOP must not become one.
            let is_constant = |inst: &Inst| matches!(function.insts[*inst], InstData::Const { .. });
            if is_end(function, next) && function.blocks[block].insts.iter().all(is_constant) {
                function.blocks[block].cold &= function.blocks[next].cold;
            }
            let insts: Vec<Inst> = std::mem::take(&mut function.blocks[next].insts);
            function.blocks[block].insts.extend(insts);
            merged[next.index()] = true;
        }
    }
    let any = merged.contains(&true);
    if any {
        function.layout.retain(|block| !merged[block.index()]);
        function.resolve_aliases();
    }
    any
}

/// True if a block only jumps to another one to which nothing else jumps. All blocks of the layout are reachable.
fn has_sole_successors(function: &Function) -> bool {
    let mut jumps = vec![0u32; function.blocks.len()];
    let terminators = || function.layout.iter().filter_map(|&block| function.terminator(block));
    for inst in terminators() {
        function.insts[inst].for_each_target(|call| jumps[call.block.index()] += 1);
    }
    terminators().any(|inst| match &function.insts[inst] {
        InstData::Jump { target } => jumps[target.block.index()] == 1,
        _ => false,
    })
}

fn sole_successor(function: &Function, cfg: &ControlFlow, block: Block) -> Option<Block> {
    let InstData::Jump { target } = &function.insts[function.terminator(block)?] else { return None };
    let alone = cfg.predecessors(target.block).len() == 1;
    (alone && target.block != block && target.block != function.entry()).then_some(target.block)
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn a_return_after_cold_blocks_is_not_that_of_a_stop() {
        check_pass(
            "control-flow",
            "func @F {
            b0(v0: i32, v1: i1):
            branch v1, b1, b2
            b1 cold:
            jump b3
            b2 cold:
            v2 = rt @safepoint(v0)
            jump b4
            b3:
            jump b5
            b4:
            store.i32 M 0, v0
            jump b3
            b5:
            ret
            }",
            "func @F {
            b0(v0: i32, v1: i1):
            branch v1, b2, b1
            b1 cold:
            v2 = rt @safepoint(v0)
            store.i32 M 0, v0
            jump b2
            b2:
            ret
            }",
        );
    }

    #[test]
    fn empty_blocks_are_skipped_with_their_values() {
        check_pass(
            "control-flow",
            "func @F -> i32 {
            b0(v0: i32, v1: i1):
            branch v1, b1, b2(v0)
            b1:
            v2 = const.i32 7
            jump b2(v2)
            b2(v3: i32):
            jump b3(v3)
            b3(v4: i32):
            ret v4
            }",
            "func @F -> i32 {
            b0(v0: i32, v1: i1):
            branch v1, b1, b2(v0)
            b1:
            v2 = const.i32 7
            jump b2(v2)
            b2(v3: i32):
            ret v3
            }",
        );
    }

    #[test]
    fn a_constant_decides_the_branch_behind_a_join() {
        check_pass(
            "control-flow",
            "func @F -> i32 {
            b0(v0: i32, v1: i1):
            v2 = const.i1 0
            branch v1, b1(v2), b1(v1)
            b1(v3: i1):
            branch v3, b2, b3
            b2:
            ret v0
            b3:
            v4 = const.i32 9
            ret v4
            }",
            "func @F -> i32 {
            b0(v0: i32, v1: i1):
            v2 = const.i1 0
            branch v1, b3, b1
            b1:
            branch v1, b2, b3
            b2:
            ret v0
            b3:
            v3 = const.i32 9
            ret v3
            }",
        );
    }

    #[test]
    fn equal_values_need_no_parameter() {
        check_pass(
            "control-flow",
            "func @F -> i32, i32 {
            b0(v0: i32, v1: i1):
            v2 = const.i32 7
            store.i32 M 0, v0
            branch v1, b1, b2(v0, v2)
            b1:
            v3 = const.i32 7
            store.i32 M 4, v0
            jump b2(v0, v3)
            b2(v4: i32, v5: i32):
            ret v4, v5
            }",
            "func @F -> i32, i32 {
            b0(v0: i32, v1: i1):
            v2 = const.i32 7
            store.i32 M 0, v0
            branch v1, b1, b2
            b1:
            v3 = const.i32 7
            store.i32 M 4, v0
            jump b2
            b2:
            v6 = const.i32 7
            ret v0, v6
            }",
        );
    }

    #[test]
    fn circles_of_empty_blocks_stay() {
        let text = "func @F {\nb0:\njump b1\nb1:\njump b2\nb2:\njump b1\n}";
        let mut module = plcc_ir::parse::parse_module(text).expect("text is well formed");
        crate::run_pass(&mut module, "control-flow").expect("there is such a pass");
        crate::check("control-flow", &module);
    }
}
