//! Look-ups in the table of DBs move from a loop to the code before it.
//!
//! Base and length of an open DB are loaded at each access. In a loop that opens no other DB, and calls nothing that may make, delete or
//! move one, they stay the same. Looking up a number that the loop never uses does no harm; one that nothing is known of is cut to the 16
//! bits that every number of a DB has, for the case that it is not used.
//!
//! ```text
//! b1:                        ;     v2 = db_base v1
//!     v2 = db_base v1        ;     jump b1
//!     ...                    ; b1:
//!     branch v9, b1, b2      ;     ...
//! ```

use plcc_abi::functions::Effect;
use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::Entity;
use plcc_ir::function::ValueDef;
use plcc_ir::{BinaryOp, Block, Function, Inst, InstData, Value};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::effects::{Effects, is_interruption};
use crate::known_bits::unsigned_max;
use crate::loops::Loops;
use crate::surroundings::Surroundings;

/// Instructions that are looked at, each once for each loop around it.
const STEPS_MAX: usize = 4_000_000;

/// Moves the look-ups out of loops, in a function. Result: whether there were any.
pub fn hoist_lookups(function: &mut Function, surroundings: &Surroundings) -> bool {
    let mut changed = false;
    let effects = &surroundings.effects;
    let is_lookup = |data: &InstData| matches!(data, InstData::DbBase { .. } | InstData::DbLength { .. });
    let insts = || function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    if !insts().any(|&inst| is_lookup(&function.insts[inst])) {
        return false;
    }
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let loops = Loops::new(function, &cfg, &dominators);
    let mut owner: FxHashMap<Inst, Block> = FxHashMap::default();
    for &block in &cfg.rpo {
        owner.extend(function.blocks[block].insts.iter().map(|&inst| (inst, block)));
    }
    // Inner loops first, so that a look-up moves through them one by one.
    let mut steps = 0;
    for each in loops.all.iter().rev() {
        steps += each.blocks.iter().map(|&block| function.blocks[block].insts.len()).sum::<usize>();
        let Some(before) = dominators.immediate(each.header).filter(|_| steps <= STEPS_MAX) else { continue };
        let inside: FxHashSet<Block> = each.blocks.iter().copied().collect();
        let all = |block: &Block| function.blocks[*block].insts.iter();
        // What is between there and the loop must not change the table either.
        let mut enter = cfg.predecessors(each.header).iter().copied().filter(|pred| !inside.contains(pred));
        let blocks = if enter.all(|pred| pred == before) { &each.blocks } else { &cfg.rpo };
        if blocks.iter().flat_map(all).any(|&inst| changes_table(&function.insts[inst], effects)) {
            continue;
        }
        let is_outside = |value: Value| match function.values[function.resolve(value)].def {
            ValueDef::Param(block, _) => !inside.contains(&block),
            ValueDef::Result(inst, _) => owner.get(&inst).is_none_or(|block| !inside.contains(block)),
            ValueDef::Alias(_) => false,
        };
        let mut moved: Vec<Inst> = Vec::new();
        for &inst in each.blocks.iter().flat_map(all) {
            if let InstData::DbBase { number } | InstData::DbLength { number } = &function.insts[inst]
                && is_outside(*number)
            {
                moved.push(inst);
            }
        }
        if moved.is_empty() {
            continue;
        }
        changed = true;
        moved.sort_unstable_by_key(|inst| inst.index());
        let gone: FxHashSet<Inst> = moved.iter().copied().collect();
        let moved = with_short_numbers(function, moved);
        for &block in &each.blocks {
            function.blocks[block].insts.retain(|inst| !gone.contains(inst));
        }
        owner.extend(moved.iter().map(|&inst| (inst, before)));
        let insts = &mut function.blocks[before].insts;
        let end = insts.len() - 1;
        insts.splice(end..end, moved);
    }
    changed
}

/// The look-ups `moved`, after what cuts their numbers to 16 bits where they may have more.
fn with_short_numbers(function: &mut Function, moved: Vec<Inst>) -> Vec<Inst> {
    let mut cut: FxHashMap<Value, Value> = FxHashMap::default();
    let mut all = Vec::new();
    for &inst in &moved {
        let number = match function.insts[inst] {
            InstData::DbBase { number } | InstData::DbLength { number } => function.resolve(number),
            _ => continue,
        };
        if unsigned_max(function, number) <= u64::from(u16::MAX) {
            continue;
        }
        let short = match cut.get(&number) {
            Some(&short) => short,
            None => {
                let (ty, loc) = (function.ty(number), function.locs[inst]);
                let mask = function.make_inst(InstData::Const { bits: u64::from(u16::MAX) }, &[ty], loc);
                let args = [number, function.result(mask)];
                let and = function.make_inst(InstData::Binary { op: BinaryOp::And, args }, &[ty], loc);
                all.extend([mask, and]);
                function.result(and)
            }
        };
        cut.insert(number, short);
        if let InstData::DbBase { number } | InstData::DbLength { number } = &mut function.insts[inst] {
            *number = short;
        }
    }
    all.extend(moved);
    all
}

/// True if an instruction may change the table of DBs.
fn changes_table(data: &InstData, effects: &Effects) -> bool {
    match data {
        InstData::Call { .. } => true,
        InstData::CallRuntime { function, .. } if is_interruption(*function) => effects.interruption_changes_dbs(),
        InstData::CallRuntime { function, .. } => function.effect() == Effect::All,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    fn around(before: &str, inside: &str) -> String {
        format!(
            "func @F {{
            b0(v0: i16, v9: i1):
            v1 = zext.i32 v0
            {before}
            jump b1
            b1:
            {inside}
            v3 = load.i8 anydb[v2]+0
            store.i8 M 0, v3
            branch v9, b1, b2
            b2:
            ret
            }}"
        )
    }

    #[test]
    fn a_db_is_looked_up_before_the_loop() {
        check_pass("hoist-lookups", &around("", "v2 = db_base v1"), &around("v2 = db_base v1", ""));
    }

    #[test]
    fn a_number_that_nothing_is_known_of_has_sixteen_bits() {
        let text = |before: &str, inside: &str| around(before, inside).replace("v1 = zext.i32 v0", "v1 = load.i32 M 4");
        check_pass(
            "hoist-lookups",
            &text("", "v2 = db_base v1"),
            &text("v4 = const.i32 65535\nv5 = and v1, v4\nv2 = db_base v5", ""),
        );
    }

    #[test]
    fn what_may_change_the_table_keeps_it_in_the_loop() {
        let text = around("", "v2 = db_base v1\nv8 = rt @safepoint(v1)");
        check_pass("hoist-lookups", &text, &text);
    }
}
