//! Results of REAL operations that are stored only if they are finite, taken as finite at first.
//!
//! An S7-200 leaves the place of a result as it was if the result is infinite or not a number. So each operation of a chain waits for a test
//! of the one before it, and each value goes from a float register to an integer one and back:
//!
//! ```text
//! v3 = fsub v1, v2               ; v3 = fsub v1, v2
//! v4 = bitcast.i32 v3            ; v8 = fmul v3, v1
//! v5 = (v4 is finite)            ; v9 = (bitcast.i32 v8 is finite)
//! v6 = select v5, v4, v0         ; branch v9, b2(v8), b1
//! v7 = bitcast.f32 v6            ; b1 cold:
//! v8 = fmul v7, v1               ;     as it was, jump b2(v10)
//! ...                            ; b2(v10: f32):
//! ```
//!
//! A sum, difference or product that is finite has finite operands, so the last test of a chain says what the ones before it would. Where it
//! fails, a cold copy does all from the first test on. Nothing is stored or called between the tests that are taken together, so nothing shows what was
//! computed in vain. A result that is a number anyway needs no test. Takes time linear in the size of the function.

use plcc_ir::entities::Entity;
use plcc_ir::function::ValueDef;
use plcc_ir::{BinaryOp, Block, BlockCall, ConvertOp, Function, Inst, InstData, IntCc, Loc, Type, Value, Values};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::floats::Numbers;

/// The bits of the exponent of a REAL, all of which are 1 if it is infinite or not a number.
const EXPONENT: u64 = 0x7F80_0000;
/// Larger functions are left as they are.
const INSTS_MAX: usize = 100_000;

/// A selection between a result and what was there before.
#[derive(Clone, Copy)]
struct Kept {
    /// Its place in the block.
    at: usize,
    /// The selected bits, an i32.
    selected: Value,
    result: Value,
    bits: Value,
    fits: Value,
}

/// Selections of one block that are decided by one branch.
struct Group {
    kept: Vec<Kept>,
    /// Values that depend on one of them, up to the last.
    dependent: FxHashSet<Value>,
}

/// What stands for a value after the branch, but not in the two blocks before that: the one that computed it, and the cold one.
type Renamed = FxHashMap<Value, ([Block; 2], Value)>;

/// Parts the ways of finite results from the others. Result: false if there are none.
pub fn part_finite_results(function: &mut Function) -> bool {
    if function.insts.len() > INSTS_MAX || !has_candidates(function) {
        return false;
    }
    function.resolve_aliases();
    keep_numbers(function);
    let leaving = values_that_leave(function);
    let mut renamed = Renamed::default();
    let mut layout = Vec::with_capacity(function.layout.len());
    for block in function.layout.clone() {
        layout.push(block);
        if !function.blocks[block].cold {
            part_block(function, block, &leaving, &mut renamed, &mut layout);
        }
    }
    function.layout = layout;
    rename(function, &renamed);
    true
}

fn has_candidates(function: &Function) -> bool {
    let mut insts = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    insts.any(|&inst| kept(function, inst, 0).is_some())
}

/// `inst` as a selection that keeps what was there if a result is not finite.
fn kept(function: &Function, inst: Inst, at: usize) -> Option<Kept> {
    let InstData::Select { cond, if_true, .. } = function.insts[inst] else { return None };
    let (bits, fits) = (function.resolve(if_true), function.resolve(cond));
    let Some(&InstData::Convert { op: ConvertOp::Bitcast, arg }) = function.defining(bits) else { return None };
    let result = function.resolve(arg);
    if function.ty(result) != Type::F32 || !matches!(function.defining(result), Some(InstData::Binary { .. })) {
        return None;
    }
    let Some(InstData::IntCompare { cc: IntCc::Ne, args: [exponent, all] }) = function.defining(fits) else {
        return None;
    };
    let Some(InstData::Binary { op: BinaryOp::And, args: [one, mask] }) = function.defining(*exponent) else {
        return None;
    };
    let is_test = function.constant(*all) == Some(EXPONENT)
        && function.constant(*mask) == Some(EXPONENT)
        && function.resolve(*one) == bits;
    is_test.then(|| Kept { at, selected: function.result(inst), result, bits, fits })
}

/// Results that are surely numbers are selected without a test.
fn keep_numbers(function: &mut Function) {
    let numbers = Numbers::of(function);
    let insts: Vec<Inst> = function.layout.iter().flat_map(|&block| &function.blocks[block].insts).copied().collect();
    let mut gone: FxHashSet<Inst> = FxHashSet::default();
    for inst in insts {
        if let Some(kept) = kept(function, inst, 0)
            && numbers.is_number(function, kept.result)
        {
            function.replace_value(kept.selected, kept.bits);
            if let ValueDef::Result(test, _) = function.values[kept.fits].def {
                function.insts[test] = InstData::Const { bits: 1 };
            }
            gone.insert(inst);
        }
    }
    if !gone.is_empty() {
        for index in 0..function.layout.len() {
            let block = function.layout[index];
            function.blocks[block].insts.retain(|inst| !gone.contains(inst));
        }
        function.resolve_aliases();
    }
}

/// Values that other blocks use than the one that computes them.
fn values_that_leave(function: &Function) -> Vec<bool> {
    let mut home: Vec<Option<Block>> = vec![None; function.values.len()];
    for &block in &function.layout {
        for &inst in &function.blocks[block].insts {
            function.results[inst].iter().for_each(|result| home[result.index()] = Some(block));
        }
    }
    let mut leaving = vec![false; function.values.len()];
    for &block in &function.layout {
        for &inst in &function.blocks[block].insts {
            function.insts[inst].for_each_use(|value| {
                let value = function.resolve(value);
                leaving[value.index()] |= home[value.index()] != Some(block);
            });
        }
    }
    leaving
}

/// The groups of a block, in order.
fn groups(function: &Function, insts: &[Inst]) -> Vec<Group> {
    let mut groups = Vec::new();
    let mut open = Group { kept: Vec::new(), dependent: FxHashSet::default() };
    for (at, &inst) in insts.iter().enumerate() {
        let data = &function.insts[inst];
        let mut depends = false;
        data.for_each_use(|value| depends |= open.dependent.contains(&function.resolve(value)));
        // What depends on a result that is not tested yet may only be computed.
        if data.has_side_effect() || matches!(data, InstData::Call { .. }) || depends && !is_computed(data) {
            if !open.kept.is_empty() {
                groups.push(std::mem::replace(&mut open, Group { kept: Vec::new(), dependent: FxHashSet::default() }));
            }
            continue;
        }
        let kept = kept(function, inst, at);
        if depends || kept.is_some() {
            open.dependent.extend(function.results[inst].iter().copied());
        }
        open.kept.extend(kept);
    }
    groups
}

/// True if the instruction only computes, and whatever its operands are.
fn is_computed(data: &InstData) -> bool {
    match data {
        InstData::Binary { op, .. } => !matches!(op, BinaryOp::Sdiv | BinaryOp::Srem | BinaryOp::Udiv | BinaryOp::Urem),
        InstData::Unary { .. }
        | InstData::IntCompare { .. }
        | InstData::FloatCompare { .. }
        | InstData::Convert { .. }
        | InstData::Select { .. } => true,
        _ => false,
    }
}

/// The tests that no other one makes needless.
fn needed(function: &Function, kept: &[Kept]) -> Vec<Value> {
    let mut implied: FxHashSet<Value> = FxHashSet::default();
    for later in kept {
        let Some(InstData::Binary { op, args: [one, two] }) = function.defining(later.result) else { continue };
        let operands: &[Value] = match op {
            BinaryOp::Fadd | BinaryOp::Fsub | BinaryOp::Fmul => &[*one, *two],
            BinaryOp::Fdiv => &[*one],
            _ => continue,
        };
        for &operand in operands {
            if let Some(&InstData::Convert { op: ConvertOp::Bitcast, arg }) = function.defining(operand) {
                implied.insert(function.resolve(arg));
            }
        }
    }
    kept.iter().filter(|kept| !implied.contains(&kept.selected)).map(|kept| kept.fits).collect()
}

/// Parts one block; what follows it goes to `layout`.
fn part_block(function: &mut Function, block: Block, leaving: &[bool], renamed: &mut Renamed, layout: &mut Vec<Block>) {
    let insts = std::mem::take(&mut function.blocks[block].insts);
    let groups = groups(function, &insts);
    if groups.is_empty() {
        function.blocks[block].insts = insts;
        return;
    }
    // Where each value is used last.
    let mut last_use: FxHashMap<Value, usize> = FxHashMap::default();
    for (at, &inst) in insts.iter().enumerate() {
        function.insts[inst].for_each_use(|value| {
            last_use.insert(function.resolve(value), at);
        });
    }
    let mut home = block;
    let mut begin = 0;
    for group in groups {
        let (first, last) = (group.kept[0].at, group.kept[group.kept.len() - 1].at);
        let leaves = |value: Value| {
            leaving.get(value.index()).copied().unwrap_or(false) || last_use.get(&value).is_some_and(|&at| at > last)
        };
        let (cold, next) = (function.add_block(), function.add_block());
        function.blocks[cold].cold = true;
        let copies = copy_dependent(function, &insts[first..=last], &group, cold);
        let tests = needed(function, &group.kept);
        let loc = function.locs[insts[last]];
        let mut hot: Vec<Inst> = std::mem::take(&mut function.blocks[home].insts);
        take_results(function, &insts[begin..=last], &group.kept, &mut hot);
        let (yes, cond) = all_of(function, &tests, loc, &mut hot);
        let sides = Sides { home, cold, next, yes, loc };
        let mut meeting = meet(function, &insts[first..=last], &group, &copies, &leaves, sides, renamed);
        pass_tests(function, &insts[begin..=last], &group, &leaves, sides, &mut meeting, renamed);
        let to_next = |args| BlockCall { block: next, args };
        let branch = InstData::Branch { cond, then_to: to_next(meeting.hot), else_to: BlockCall::new(cold) };
        let branch = function.make_inst(branch, &[], loc);
        hot.push(branch);
        function.blocks[home].insts = hot;
        let jump = function.make_inst(InstData::Jump { target: to_next(meeting.cold) }, &[], loc);
        function.blocks[cold].insts.push(jump);
        function.blocks[next].insts = meeting.start;
        layout.extend([next, cold]);
        home = next;
        begin = last + 1;
    }
    function.blocks[home].insts.extend_from_slice(&insts[begin..]);
}

/// Moves code to the hot side, on which selections are results; what depends on them stays as it is.
fn take_results(function: &mut Function, insts: &[Inst], kept: &[Kept], hot: &mut Vec<Inst>) {
    let raw: FxHashMap<Value, Value> = kept.iter().map(|kept| (kept.selected, kept.bits)).collect();
    for &inst in insts {
        if function.results[inst].first().is_some_and(|result| raw.contains_key(result)) {
            continue;
        }
        let mut data = std::mem::replace(&mut function.insts[inst], InstData::Const { bits: 0 });
        data.map_uses(|value| raw.get(&value).copied().unwrap_or(value));
        function.insts[inst] = data;
        hot.push(inst);
    }
}

/// A constant 1, and whether all tests hold; both are computed at the end of `hot`.
fn all_of(function: &mut Function, tests: &[Value], loc: Loc, hot: &mut Vec<Inst>) -> (Value, Value) {
    let one = function.make_inst(InstData::Const { bits: 1 }, &[Type::I1], Loc(0));
    hot.push(one);
    let yes = function.result(one);
    let mut cond = tests[0];
    for &test in &tests[1..] {
        let both = function.make_inst(InstData::Binary { op: BinaryOp::And, args: [cond, test] }, &[Type::I1], loc);
        hot.push(both);
        cond = function.result(both);
    }
    (yes, cond)
}

/// The blocks of a group: the one that ends with the branch, the cold one, and the one in which both ways meet.
#[derive(Clone, Copy)]
struct Sides {
    home: Block,
    cold: Block,
    next: Block,
    /// A constant 1 of the first one.
    yes: Value,
    loc: Loc,
}

/// What goes to the block in which both ways meet: a value for each of its parameters from either side, and its first instructions.
struct Meeting {
    hot: Values,
    cold: Values,
    start: Vec<Inst>,
}

/// Makes the parameters of the block in which both ways meet, for the selections and for what depends on them. `copies`: of the cold side;
/// `leaves`: true of a value that is used after the group.
fn meet(
    function: &mut Function,
    insts: &[Inst],
    group: &Group,
    copies: &FxHashMap<Value, Value>,
    leaves: &impl Fn(Value) -> bool,
    sides: Sides,
    renamed: &mut Renamed,
) -> Meeting {
    let Sides { home, cold, next, loc, .. } = sides;
    let mut meeting = Meeting { hot: Values::new(), cold: Values::new(), start: Vec::new() };
    let mut floats: FxHashMap<Value, Value> = FxHashMap::default();
    for &inst in insts {
        let Some(&value) = function.results[inst].first().filter(|value| group.dependent.contains(*value)) else {
            continue;
        };
        if let Some(kept) = group.kept.iter().find(|kept| kept.selected == value) {
            // As a float, which most of its users want.
            let back = InstData::Convert { op: ConvertOp::Bitcast, arg: copies[&value] };
            let back = function.make_inst(back, &[Type::F32], loc);
            function.blocks[cold].insts.push(back);
            let float = function.add_param(next, Type::F32);
            let bits = InstData::Convert { op: ConvertOp::Bitcast, arg: float };
            let bits = function.make_inst(bits, &[Type::I32], loc);
            meeting.start.push(bits);
            meeting.hot.push(kept.result);
            meeting.cold.push(function.result(back));
            floats.insert(value, float);
            renamed.insert(value, ([home, cold], function.result(bits)));
            continue;
        }
        if !leaves(value) {
            continue;
        }
        if let InstData::Convert { op: ConvertOp::Bitcast, .. } = function.insts[inst]
            && let Some(float) = original_float(group, &floats, function, inst)
        {
            renamed.insert(value, ([home, cold], float));
            continue;
        }
        let param = function.add_param(next, function.ty(value));
        meeting.hot.push(value);
        meeting.cold.push(copies[&value]);
        renamed.insert(value, ([home, cold], param));
    }
    meeting
}

/// Passes tests on to where both ways meet: what a test says is known on the hot side, where it is 1.
fn pass_tests(
    function: &mut Function,
    insts: &[Inst],
    group: &Group,
    leaves: &impl Fn(Value) -> bool,
    sides: Sides,
    meeting: &mut Meeting,
    renamed: &mut Renamed,
) {
    let Sides { home, cold, next, yes, .. } = sides;
    for kept in &group.kept {
        if let Some(position) = meeting.hot.iter().position(|&arg| arg == kept.fits) {
            meeting.hot[position] = yes;
            continue;
        }
        let is_here = insts.iter().any(|&inst| function.results[inst].first() == Some(&kept.fits));
        if is_here && leaves(kept.fits) && !group.dependent.contains(&kept.fits) {
            let param = function.add_param(next, Type::I1);
            meeting.hot.push(yes);
            meeting.cold.push(kept.fits);
            renamed.insert(kept.fits, ([home, cold], param));
        }
    }
}

/// Copies what depends on a selection to `cold`; the copies by what they are copies of.
fn copy_dependent(function: &mut Function, insts: &[Inst], group: &Group, cold: Block) -> FxHashMap<Value, Value> {
    let mut copies: FxHashMap<Value, Value> = FxHashMap::default();
    for &inst in insts {
        if !function.results[inst].iter().any(|result| group.dependent.contains(result)) {
            continue;
        }
        let mut data = function.insts[inst].clone();
        data.map_uses(|value| copies.get(&value).copied().unwrap_or(value));
        let types: Vec<Type> = function.results[inst].iter().map(|&result| function.ty(result)).collect();
        let copy = function.make_inst(data, &types, function.locs[inst]);
        for (&old, &new) in function.results[inst].clone().iter().zip(&function.results[copy].clone()) {
            copies.insert(old, new);
        }
        function.blocks[cold].insts.push(copy);
    }
    copies
}

/// The float after the branch of the selection that `inst`, a conversion of bits, is of.
fn original_float(group: &Group, floats: &FxHashMap<Value, Value>, function: &Function, inst: Inst) -> Option<Value> {
    let InstData::Convert { arg, .. } = function.insts[inst] else { return None };
    // On the hot side its operand is already the result's bits.
    let kept = group.kept.iter().find(|kept| kept.bits == arg)?;
    if function.ty(function.result(inst)) != Type::F32 {
        return None;
    }
    floats.get(&kept.selected).copied()
}

/// Gives uses outside the block that computed a value what stands for it there.
fn rename(function: &mut Function, renamed: &Renamed) {
    if renamed.is_empty() {
        return;
    }
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        for position in 0..function.blocks[block].insts.len() {
            let inst = function.blocks[block].insts[position];
            let mut data = std::mem::replace(&mut function.insts[inst], InstData::Const { bits: 0 });
            data.map_uses(|value| match renamed.get(&value) {
                Some(&(before, other)) if !before.contains(&block) => other,
                _ => value,
            });
            function.insts[inst] = data;
        }
    }
}
