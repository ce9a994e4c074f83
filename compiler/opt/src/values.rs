//! Sharing of equal computations (global value numbering).
//!
//! Blocks are visited in the order of the dominator tree. A pure instruction that computes what another one has computed
//! whose block dominates this one is replaced by it. Where a block is reached by one arm of a branch only, the condition is
//! known in it and in all that it dominates: `JC` after another `JC` on the same RLO needs no test.

use std::collections::hash_map::Entry;
use std::hash::Hash;

use plcc_abi::functions::Effect;
use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::function::ValueDef;
use plcc_ir::{Block, Function, Inst, InstData, Loc, Region, Type, Value};
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
    let mut computed = Computed::default();
    let mut conditions: EntityVec<Value, Option<Known>> = EntityVec::filled(None, function.values.len());
    let mut has_conditions = false;
    // Conditions that something in their block, or after it, reads.
    let mut used: FxHashMap<Value, Block> = FxHashMap::default();
    let mut out = Vec::new();
    for &block in &dominators.preorder {
        let mut insts = std::mem::take(&mut function.blocks[block].insts);
        if let Some((cond, bit)) = known_condition(function, &cfg, block)
            && uses.get(cond).is_none_or(|&count| count > 1)
            && conditions.get(cond).is_some()
        {
            let inst = function.make_inst(InstData::Const { bits: u64::from(bit) }, &[Type::I1], Loc(0));
            conditions[cond] = Some(Known { block, value: function.result(inst) });
            has_conditions = true;
        }
        for &inst in &insts {
            function.resolve_uses(inst);
            if has_conditions {
                function.insts[inst].map_uses(|value| match conditions.get(value) {
                    Some(Some(known)) if dominators.dominates(known.block, block) => {
                        used.insert(known.value, known.block);
                        known.value
                    }
                    _ => value,
                });
            }
            if let Some(value) = computed.before(function, &dominators, inst, block) {
                let is_small = matches!(function.insts[inst], InstData::Const { .. }) || function.ty(value) == Type::I1;
                if !is_small {
                    change = Change::Code;
                } else if change == Change::Nothing {
                    change = Change::Shared;
                }
                function.replace_value(function.result(inst), value);
                continue;
            }
            out.push(inst);
        }
        insts.clear();
        insts.append(&mut out);
        function.blocks[block].insts = insts;
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

/// What has been computed, and in which blocks.
#[derive(Default)]
struct Computed {
    values: FxHashMap<Key, (Value, Block)>,
    /// Of runtime functions without effect.
    calls: FxHashMap<InstData, (Value, Block)>,
}

/// What an instruction computes of what: equal ones compute the same.
type Key = (u64, u64);

impl Computed {
    /// The value that is what `inst` computes, from a block that dominates `block`. If there is none, that of `inst` is noted.
    fn before(&mut self, function: &Function, dominators: &Dominators, inst: Inst, block: Block) -> Option<Value> {
        let data = &function.insts[inst];
        if let InstData::CallRuntime { function: called, .. } = data {
            let is_pure = called.effect() == Effect::Pure;
            return before(&mut self.calls, is_pure.then(|| data.clone())?, function.result(inst), dominators, block);
        }
        let key = key_of(function, inst)?;
        before(&mut self.values, key, function.result(inst), dominators, block)
    }
}

fn before<K: Eq + Hash>(
    computed: &mut FxHashMap<K, (Value, Block)>,
    key: K,
    result: Value,
    dominators: &Dominators,
    block: Block,
) -> Option<Value> {
    match computed.entry(key) {
        Entry::Occupied(mut entry) => {
            let (value, at) = *entry.get();
            if dominators.dominates(at, block) {
                return Some(value);
            }
            entry.insert((result, block));
        }
        Entry::Vacant(entry) => {
            entry.insert((result, block));
        }
    }
    None
}

/// The key of the result of a pure instruction. Constant addresses are included.
fn key_of(function: &Function, inst: Inst) -> Option<Key> {
    let number = |value: Value| value.index() as u64;
    let pair = |[a, b]: [Value; 2]| number(a) | number(b) << 32;
    let (kind, op, third, operands) = match function.insts[inst] {
        InstData::Const { bits } => (0, 0, 0, bits),
        InstData::Unary { op, arg } => (1, op as u64, 0, number(arg)),
        InstData::Binary { op, args: [a, b] } if is_commutative(op) && b.index() < a.index() => {
            (2, op as u64, 0, pair([b, a]))
        }
        InstData::Binary { op, args } => (2, op as u64, 0, pair(args)),
        InstData::IntCompare { cc, args } => (3, cc as u64, 0, pair(args)),
        InstData::FloatCompare { cc, args } => (4, cc as u64, 0, pair(args)),
        InstData::Convert { op, arg } => (5, op as u64, 0, number(arg)),
        InstData::Select { cond, if_true, if_false } => (6, 0, number(cond), pair([if_true, if_false])),
        InstData::AddressOf { addr } => {
            let base = addr.base.map_or(0, |base| number(base) + 1);
            (7, region_number(addr.region), u64::from(addr.offset), base)
        }
        InstData::FrameBase { callee } => (8, u64::from(callee), 0, 0),
        InstData::Load { .. }
        | InstData::Store { .. }
        | InstData::LoadBit { .. }
        | InstData::StoreBit { .. }
        | InstData::Clear { .. }
        | InstData::Copy { .. }
        | InstData::DbBase { .. }
        | InstData::DbLength { .. }
        | InstData::Call { .. }
        | InstData::CallRuntime { .. }
        | InstData::Jump { .. }
        | InstData::Branch { .. }
        | InstData::Switch { .. }
        | InstData::Return { .. } => return None,
    };
    let ty = function.ty(function.result(inst)) as u64;
    Some((kind | ty << 4 | op << 8 | third << 32, operands))
}

/// A number of fewer than 24 bits for each region.
fn region_number(region: Region) -> u64 {
    match region {
        Region::State => 0,
        Region::I => 1,
        Region::Q => 2,
        Region::M => 3,
        Region::System => 4,
        Region::Cells => 5,
        Region::L => 6,
        Region::V => 7,
        Region::AnyDb => 8,
        Region::Any => 9,
        Region::Db(number) => 10 + u64::from(number),
    }
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
