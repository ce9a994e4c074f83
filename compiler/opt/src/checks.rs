//! Functions whose checks are decided at their beginning get a second copy.
//!
//! A block in SCL finds out where its IN_OUT parameters are before its first statement, and tests the result at each access: the cold
//! side goes on where the hot one does, so nothing is known after it. If a function asks several times for what it computes at its
//! beginning, a copy of it, all cold, is for the case that one of the checks fails. The other copy tests nothing.
//!
//! ```text
//! b0: v1 = ...                    ; b0: v1 = ...  branch v1, b1, b7
//!     jump b1                     ; b1: ... jump b2
//! b1: ... branch v1, b2, b3       ; b2: ... jump b4
//! b3 cold: ... jump b2            ; b7 cold: copy of b1, to b8 and b9
//! b2: ... branch v1, b4, b5       ; ...
//! ```
//!
//! The code grows by the cold copy; the hot one is smaller than before.

use plcc_ir::{BinaryOp, Block, BlockCall, Function, InstData, Type, Value};
use rustc_hash::FxHashMap;

use crate::control_flow::simplify_control_flow;
use crate::variables::{Versions, copy_blocks, join_versions};

/// Larger functions are left as they are.
const INSTS_MAX: usize = 6000;
/// Hot branches by values of the beginning that are worth a copy.
const TESTS_MIN: usize = 3;
/// Values that are tested together at the beginning.
const VALUES_MAX: usize = 8;

/// Copies a function for the case that its checks fail. Result: whether it did.
pub fn part_checks(function: &mut Function) -> bool {
    let entry = function.entry();
    if function.insts.len() > INSTS_MAX || function.blocks[entry].cold {
        return false;
    }
    let checks = checks(function);
    if checks.values().map(|(tests, _)| tests).sum::<usize>() < TESTS_MIN {
        return false;
    }
    let mut values: Vec<(Value, bool)> = checks.into_iter().map(|(value, (_, hot))| (value, hot)).collect();
    values.sort_unstable();
    values.truncate(VALUES_MAX);
    divide(function, entry, &values);
    true
}

/// Values that are computed in the first block, with the number of hot blocks that branch by them to one cold and one hot side, and
/// which side is the hot one.
fn checks(function: &Function) -> FxHashMap<Value, (usize, bool)> {
    let begin = &function.blocks[function.entry()];
    let mut found: FxHashMap<Value, (usize, bool)> =
        begin.insts.iter().flat_map(|&inst| &function.results[inst]).map(|&value| (value, (0, true))).collect();
    for &block in &function.layout {
        let data = function.terminator(block).map(|last| &function.insts[last]);
        let Some(InstData::Branch { cond, then_to, else_to }) = data else { continue };
        let cond = function.resolve(*cond);
        let is_cold = |call: &BlockCall| function.blocks[call.block].cold;
        if function.blocks[block].cold || is_cold(then_to) == is_cold(else_to) {
            continue;
        }
        if let Some((tests, hot)) = found.get_mut(&cond) {
            let side = is_cold(else_to);
            if *tests == 0 {
                *hot = side;
            }
            // A value by which some go to the one and some to the other side is not a check.
            *tests = if *hot == side && *tests != usize::MAX { *tests + 1 } else { usize::MAX };
        }
    }
    found.retain(|_, (tests, _)| (2..usize::MAX).contains(tests));
    found
}

/// Copies all that follows the first block. The original is for the case that all values are as they say.
fn divide(function: &mut Function, entry: Block, values: &[(Value, bool)]) {
    let next = function.add_block();
    let last = function.blocks[entry].insts.pop().expect("a block has a terminator");
    function.blocks[next].insts.push(last);
    function.layout.pop();
    function.layout.insert(1, next);
    let order: Vec<Block> = function.layout[1..].to_vec();

    let mut versions = Versions::default();
    let copies = copy_blocks(function, &order, &mut versions);
    for &block in &order {
        function.blocks[copies[&block]].cold = true;
    }
    let loc = function.locs[last];
    let mut all = None;
    for &(value, hot) in values {
        let add = |function: &mut Function, data: InstData| {
            let inst = function.make_inst(data, &[Type::I1], loc);
            function.blocks[entry].insts.push(inst);
            function.result(inst)
        };
        let is_so = match hot {
            true => value,
            false => {
                let one = add(function, InstData::Const { bits: 1 });
                add(function, InstData::Binary { op: BinaryOp::Xor, args: [value, one] })
            }
        };
        all = Some(match all {
            None => is_so,
            Some(all) => add(function, InstData::Binary { op: BinaryOp::And, args: [all, is_so] }),
        });
    }
    let cond = all.expect("there are checks");
    let branch = InstData::Branch { cond, then_to: BlockCall::new(next), else_to: BlockCall::new(copies[&next]) };
    let branch = function.make_inst(branch, &[], loc);
    function.blocks[entry].insts.push(branch);

    for &block in &order {
        let Some(last) = function.terminator(block) else { continue };
        let InstData::Branch { cond, then_to, else_to } = &function.insts[last] else { continue };
        let cond = function.resolve(*cond);
        let Some(&(_, value)) = values.iter().find(|(value, _)| *value == cond) else { continue };
        let target = if value { then_to.clone() } else { else_to.clone() };
        function.insts[last] = InstData::Jump { target };
    }
    join_versions(function, &versions);
    simplify_control_flow(function);
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn a_failed_check_goes_on_in_a_copy_of_the_function() {
        check_pass(
            "part-checks",
            "func @F -> i32 {
            b0(v0: i32):
            v1 = const.i32 9
            v2 = ult v0, v1
            branch v2, b1, b2
            b1:
            store.i32 M 0, v0
            jump b3
            b2 cold:
            store.i32 M 4, v0
            jump b3
            b3:
            v3 = load.i32 M 8
            branch v2, b4, b5
            b4:
            store.i32 M 12, v3
            jump b6
            b5 cold:
            store.i32 M 16, v3
            jump b6
            b6:
            branch v2, b7, b8
            b7:
            ret v3
            b8 cold:
            ret v0
            }",
            "func @F -> i32 {
            b0(v0: i32):
            v1 = const.i32 9
            v2 = ult v0, v1
            branch v2, b1, b2
            b1:
            store.i32 M 0, v0
            v3 = load.i32 M 8
            store.i32 M 12, v3
            ret v3
            b2 cold:
            branch v2, b3, b4
            b3 cold:
            store.i32 M 0, v0
            jump b5
            b4 cold:
            store.i32 M 4, v0
            jump b5
            b5 cold:
            v4 = load.i32 M 8
            branch v2, b6, b7
            b6 cold:
            store.i32 M 12, v4
            jump b8
            b7 cold:
            store.i32 M 16, v4
            jump b8
            b8 cold:
            branch v2, b9, b10
            b9 cold:
            ret v4
            b10 cold:
            ret v0
            }",
        );
    }

    #[test]
    fn two_checks_and_other_choices_stay() {
        let text = "func @F -> i32 {
            b0(v0: i32):
            v1 = const.i32 9
            v2 = ult v0, v1
            branch v2, b1, b2
            b1:
            store.i32 M 0, v0
            branch v2, b3, b3
            b2 cold:
            store.i32 M 4, v0
            jump b3
            b3:
            ret v0
            }";
        check_pass("part-checks", text, text);
    }
}
