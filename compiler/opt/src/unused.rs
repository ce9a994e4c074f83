//! Removal of unused code and values within a function.
//!
//! As `dead_code`, but the function is called as before: its parameters, its results and those of its calls stay.

use plcc_ir::Function;
use plcc_ir::entities::Entity;
use plcc_ir::function::ValueDef;
use plcc_ir::{InstData, Value};

use crate::Change;
use crate::control_flow::remove_params;

/// Removes instructions without an effect whose results nothing uses, and parameters of blocks likewise.
pub fn remove_unused(function: &mut Function) -> Change {
    let mut changed = function.remove_unreachable_blocks() > 0;
    let live = live_values(function);
    let entry = function.entry();
    let mut removed: Vec<bool> = live.iter().map(|live| !live).collect();
    for &param in &function.blocks[entry].params {
        removed[param.index()] = false;
    }
    let mut params = function.layout.iter().flat_map(|&block| &function.blocks[block].params);
    if params.any(|param| removed[param.index()]) {
        remove_params(function, &removed);
        changed = true;
    }
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        let mut insts = std::mem::take(&mut function.blocks[block].insts);
        let before = insts.len();
        insts.retain(|&inst| {
            let data = &function.insts[inst];
            matches!(data, InstData::Call { .. })
                || data.has_side_effect()
                || function.results[inst].iter().any(|result| live[result.index()])
        });
        changed |= insts.len() < before;
        function.blocks[block].insts = insts;
    }
    if changed { Change::Unused } else { Change::Nothing }
}

/// Which values an effect needs.
fn live_values(function: &Function) -> Vec<bool> {
    let incoming = incoming_arguments(function);
    let mut live = vec![false; function.values.len()];
    let mut work = Vec::new();
    let mark = |live: &mut Vec<bool>, work: &mut Vec<Value>, value: Value| {
        if !std::mem::replace(&mut live[value.index()], true) {
            work.push(value);
        }
    };
    for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
        match &function.insts[inst] {
            InstData::Jump { .. } => {}
            InstData::Branch { cond: value, .. } | InstData::Switch { value, .. } => mark(&mut live, &mut work, *value),
            data if data.has_side_effect() || matches!(data, InstData::Call { .. } | InstData::Return { .. }) => {
                data.for_each_use(|value| mark(&mut live, &mut work, value));
            }
            _ => {}
        }
    }
    while let Some(value) = work.pop() {
        match function.values[value].def {
            ValueDef::Alias(other) => mark(&mut live, &mut work, other),
            ValueDef::Result(inst, _) => match &function.insts[inst] {
                InstData::Call { .. } => {}
                data => data.for_each_use(|used| mark(&mut live, &mut work, used)),
            },
            ValueDef::Param(block, index) => {
                incoming[block.index()].iter().for_each(|args| mark(&mut live, &mut work, args[index as usize]));
            }
        }
    }
    live
}

/// For each block the arguments that jumps bring, one list for each target that it is. A `switch` may bring thousands to one block.
fn incoming_arguments(function: &Function) -> Vec<Vec<&[Value]>> {
    let mut incoming = vec![Vec::new(); function.blocks.len()];
    for &block in &function.layout {
        if let Some(jump) = function.terminator(block) {
            function.insts[jump].for_each_target(|call| {
                if !call.args.is_empty() {
                    incoming[call.block.index()].push(call.args.as_slice());
                }
            });
        }
    }
    incoming
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn what_leaves_the_function_stays() {
        check_pass(
            "unused",
            "func @F -> i32, i32 {
            b0(v0: i32, v1: i1, v9: i32):
            v2 = load.i32 M 0
            v3 = iadd v2, v0
            v5, v6 = call @F(v0, v1, v3)
            v7 = const.i32 1
            v8 = iadd v7, v0
            jump b1(v0, v8, v7)
            b1(v10: i32, v11: i32, v12: i32):
            v13 = isub v10, v12
            v14 = iadd v11, v12
            branch v1, b1(v13, v14, v12), b2
            b2:
            ret v13, v0
            }",
            "func @F -> i32, i32 {
            b0(v0: i32, v1: i1, v2: i32):
            v3 = load.i32 M 0
            v4 = iadd v3, v0
            v5, v6 = call @F(v0, v1, v4)
            v7 = const.i32 1
            jump b1(v0, v7)
            b1(v8: i32, v9: i32):
            v10 = isub v8, v9
            branch v1, b1(v10, v9), b2
            b2:
            ret v10, v0
            }",
        );
    }
}
