//! Sharing of equal computations (global value numbering).
//!
//! Blocks are visited in the order of the dominator tree. A pure instruction that computes what another one has computed
//! whose block dominates this one is replaced by it. Where a block is reached by one arm of a branch only, the condition is
//! known in it and in all that it dominates: `JC` after another `JC` on the same RLO needs no test.

use std::collections::hash_map::Entry;

use plcc_abi::functions::Effect;
use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::function::ValueDef;
use plcc_ir::{Block, Class, Function, Inst, InstData, Loc, Type, Value};
use rustc_hash::FxHashMap;

use crate::Change;
use crate::fold::integer::is_commutative;

/// A condition that is known after a block.
#[derive(Clone, Copy)]
struct Known {
    block: Block,
    value: Value,
}

/// Shares equal computations in a function.
pub fn share_values(function: &mut Function) -> Change {
    let mut change = Change::Nothing;
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let mut uses: EntityVec<Value, u32> = EntityVec::filled(0, function.values.len());
    for data in function.insts.values() {
        data.for_each_use(|value| uses[value] += 1);
    }
    let mut computed: FxHashMap<(Type, InstData), (Value, Block)> = FxHashMap::default();
    let mut conditions: FxHashMap<Value, Known> = FxHashMap::default();
    // Conditions that something in their block, or after it, reads.
    let mut used: FxHashMap<Value, Block> = FxHashMap::default();
    for &block in &dominators.preorder {
        let insts = std::mem::take(&mut function.blocks[block].insts);
        let mut out = Vec::with_capacity(insts.len());
        if let Some((cond, bit)) = known_condition(function, &cfg, block)
            && uses.get(cond).is_none_or(|&count| count > 1)
        {
            let inst = function.make_inst(InstData::Const { bits: u64::from(bit) }, &[Type::I1], Loc(0));
            conditions.insert(cond, Known { block, value: function.result(inst) });
        }
        for inst in insts {
            function.resolve_uses(inst);
            if !conditions.is_empty() {
                function.insts[inst].map_uses(|value| match conditions.get(&value) {
                    Some(known) if dominators.dominates(known.block, block) => {
                        used.insert(known.value, known.block);
                        known.value
                    }
                    _ => value,
                });
            }
            if let Some(key) = key_of(function, inst) {
                match computed.entry(key) {
                    Entry::Occupied(mut entry) => {
                        let (value, at) = *entry.get();
                        if dominators.dominates(at, block) {
                            let is_small = matches!(function.insts[inst], InstData::Const { .. })
                                || function.ty(value) == Type::I1;
                            if !is_small {
                                change = Change::Code;
                            } else if change == Change::Nothing {
                                change = Change::Shared;
                            }
                            function.replace_value(function.result(inst), value);
                            continue;
                        }
                        entry.insert((function.result(inst), block));
                    }
                    Entry::Vacant(entry) => {
                        entry.insert((function.result(inst), block));
                    }
                }
            }
            out.push(inst);
        }
        function.blocks[block].insts = out;
    }
    if !used.is_empty() {
        change = Change::Code;
    }
    for (value, block) in used {
        if let ValueDef::Result(inst, _) = function.values[value].def {
            function.blocks[block].insts.insert(0, inst);
        }
    }
    if change != Change::Nothing {
        function.resolve_aliases();
    }
    change
}

/// The condition of the only branch to `block`, and its value there.
fn known_condition(function: &Function, cfg: &ControlFlow, block: Block) -> Option<(Value, bool)> {
    let &[pred] = cfg.predecessors(block) else { return None };
    match &function.insts[function.terminator(pred)?] {
        InstData::Branch { cond, then_to, .. } => {
            let cond = function.resolve(*cond);
            function.constant(cond).is_none().then_some((cond, then_to.block == block))
        }
        _ => None,
    }
}

/// The key of the result of a pure instruction. Constant addresses and runtime functions without effect are included.
fn key_of(function: &Function, inst: Inst) -> Option<(Type, InstData)> {
    let data = match &function.insts[inst] {
        InstData::Binary { op, args: [a, b] } if is_commutative(*op) && b.index() < a.index() => {
            InstData::Binary { op: *op, args: [*b, *a] }
        }
        data @ InstData::CallRuntime { function, .. } if function.effect() == Effect::Pure => data.clone(),
        data => match data.class() {
            Class::Constant | Class::Value | Class::Address => data.clone(),
            Class::Memory | Class::Call | Class::Choice | Class::Exit => return None,
        },
    };
    Some((function.ty(function.result(inst)), data))
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn equal_computations_are_shared_where_one_dominates() {
        check_pass(
            "values",
            "func @F -> i32, i32 {
            b0(v0: i32, v1: i32, v2: i1):
            v3 = iadd v0, v1
            branch v2, b1, b2
            b1:
            v4 = iadd v1, v0
            v5 = xor v0, v1
            ret v4, v5
            b2:
            v6 = xor v0, v1
            ret v6, v3
            }",
            "func @F -> i32, i32 {
            b0(v0: i32, v1: i32, v2: i1):
            v3 = iadd v0, v1
            branch v2, b1, b2
            b1:
            v4 = xor v0, v1
            ret v3, v4
            b2:
            v5 = xor v0, v1
            ret v5, v3
            }",
        );
    }

    #[test]
    fn a_condition_is_known_behind_its_branch() {
        check_pass(
            "values",
            "func @F -> i1 {
            b0(v0: i1):
            branch v0, b1, b2
            b1:
            ret v0
            b2:
            ret v0
            }",
            "func @F -> i1 {
            b0(v0: i1):
            branch v0, b1, b2
            b1:
            v1 = const.i1 1
            ret v1
            b2:
            v2 = const.i1 0
            ret v2
            }",
        );
    }
}
