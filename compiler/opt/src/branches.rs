//! Short branches become selections.
//!
//! What a branch decides in a PLC program often changes from cycle to cycle, so that the processor guesses it wrong; a few
//! instructions more cost less than that.
//!
//! ```text
//! b1:
//!     branch v1, b2, b3(v2)  ;     v3 = xor v2, 40961
//! b2:                        ;     v5 = select v1, v3, v2
//!     v3 = xor v2, 40961     ;     jump b3(v5)
//!     jump b3(v3)            ;
//! b3(v4: i16):               ; b3(v4: i16):
//! ```
//!
//! An arm may compute without side effects, load from constant addresses and from where an access before the branch shows that
//! there is memory, and store there once: then it stores what was there if the branch does not lead to it. `S` and `R` become AND and OR.
//! Two arms that store to the same place become one store. In a loop stores keep their branch: each pass would wait for the
//! store of the pass before.

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::Entity;
use plcc_ir::{
    Address, BinaryOp, Block, BlockCall, ConvertOp, Function, Inst, InstData, Loc, Region, Type, UnaryOp, Value, Values,
};
use rustc_hash::FxHashMap;

use crate::loops::Loops;

/// Instructions of both arms together, without constants.
const INSTS_MAX: usize = 6;
/// Values that the arms bring.
const VALUES_MAX: usize = 3;
/// Stores of bits in an arm, and of other values.
const BITS_MAX: usize = 2;
/// Rounds over a function: an outer branch may become short when an inner one is gone.
const ROUNDS_MAX: usize = 3;
/// Blocks with accesses through a base that are considered.
const ACCESSES_MAX: usize = 4;

/// Replaces short branches in a function. Result: whether there were any.
pub fn select_by_branches(function: &mut Function) -> bool {
    let mut changed = false;
    for _ in 0..ROUNDS_MAX {
        if !round(function) {
            break;
        }
        changed = true;
        function.remove_unreachable_blocks();
    }
    changed
}

fn round(function: &mut Function) -> bool {
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let loops = Loops::new(function, &cfg, &dominators);
    let bases = Bases::of(function, &cfg);
    let mut changed = false;
    // Blocks whose code has moved away in this round.
    let mut gone = vec![false; function.blocks.len()];
    for &block in &cfg.rpo {
        if gone[block.index()] {
            continue;
        }
        let is_known = |addr: &Address| addr.base.is_none_or(|base| bases.accessed(&dominators, base, block));
        let Some(shape) = shape(function, &cfg, block, &is_known) else { continue };
        let stores = [&shape.then_arm, &shape.else_arm].map(|arm| stores(function, &arm.insts));
        if loops.depth(block) > 0 && stores != [(0, 0); 2] {
            continue;
        }
        if [shape.then_arm.block, shape.else_arm.block].into_iter().flatten().any(|arm| gone[arm.index()]) {
            continue;
        }
        for arm in [shape.then_arm.block, shape.else_arm.block].into_iter().flatten() {
            gone[arm.index()] = true;
        }
        convert(function, block, shape);
        changed = true;
    }
    if changed {
        function.resolve_aliases();
    }
    changed
}

/// The blocks that access data blocks through a base: after them there surely is memory.
struct Bases {
    blocks: FxHashMap<Value, Vec<Block>>,
}

impl Bases {
    fn of(function: &Function, cfg: &ControlFlow) -> Bases {
        let mut blocks: FxHashMap<Value, Vec<Block>> = FxHashMap::default();
        for &block in &cfg.rpo {
            for &inst in &function.blocks[block].insts {
                function.insts[inst].for_each_address(|addr| {
                    if let (Region::AnyDb, Some(base)) = (addr.region, addr.base) {
                        let list = blocks.entry(base).or_default();
                        if list.len() < ACCESSES_MAX && list.last() != Some(&block) {
                            list.push(block);
                        }
                    }
                });
            }
        }
        Bases { blocks }
    }

    /// True if memory is accessed through `base` in `block` or on all ways to it.
    fn accessed(&self, dominators: &Dominators, base: Value, block: Block) -> bool {
        self.blocks.get(&base).is_some_and(|list| list.iter().any(|&other| dominators.dominates(other, block)))
    }
}

/// One way from a branch to the block where both meet.
struct Arm {
    /// A block of its own, if the way is not direct.
    block: Option<Block>,
    insts: Vec<Inst>,
    args: Values,
}

/// A branch that can go.
struct Shape {
    cond: Value,
    then_arm: Arm,
    else_arm: Arm,
    meet: Block,
}

fn shape(function: &Function, cfg: &ControlFlow, block: Block, is_known: &dyn Fn(&Address) -> bool) -> Option<Shape> {
    let InstData::Branch { cond, then_to, else_to } = &function.insts[function.terminator(block)?] else { return None };
    if then_to.block == else_to.block {
        return None;
    }
    let then_arm = arm(function, cfg, then_to, is_known);
    let else_arm = arm(function, cfg, else_to, is_known);
    let direct = |call: &BlockCall| Arm { block: None, insts: Vec::new(), args: call.args.clone() };
    let (then_arm, else_arm, meet) = match (then_arm, else_arm) {
        (Some((a, meet)), _) if meet == else_to.block => (a, direct(else_to), meet),
        (_, Some((b, meet))) if meet == then_to.block => (direct(then_to), b, meet),
        (Some((a, meet)), Some((b, other))) if meet == other => (a, b, meet),
        _ => return None,
    };
    if function.blocks[meet].cold || meet == block {
        return None;
    }
    let size: usize = [&then_arm, &else_arm].into_iter().map(|arm| cost(function, &arm.insts)).sum();
    let values = then_arm.args.iter().zip(&else_arm.args).filter(|(a, b)| a != b).count();
    let stores = |arm: &Arm| stores(function, &arm.insts);
    // Two stores to different places would need their order settled.
    let stores_once = stores(&then_arm) == (0, 0)
        || stores(&else_arm) == (0, 0)
        || common_store(function, &then_arm.insts, &else_arm.insts).is_some();
    let few = |(bits, others): (usize, usize)| bits <= BITS_MAX && others <= 1 && (bits == 0 || others == 0);
    (size <= INSTS_MAX && values <= VALUES_MAX && stores_once && few(stores(&then_arm)) && few(stores(&else_arm)))
        .then_some(Shape { cond: *cond, then_arm, else_arm, meet })
}

/// The stores of both arms, if each has one and they write the same place, and what they write.
fn common_store(function: &Function, then_insts: &[Inst], else_insts: &[Inst]) -> Option<([Inst; 2], [Value; 2])> {
    let only = |insts: &[Inst]| {
        let mut stores = insts.iter().copied().filter(|&inst| function.insts[inst].has_side_effect());
        let first = stores.next()?;
        stores.next().is_none().then_some(first)
    };
    let stores = [only(then_insts)?, only(else_insts)?];
    let values = match (&function.insts[stores[0]], &function.insts[stores[1]]) {
        (InstData::Store { addr: a, value: x }, InstData::Store { addr: b, value: y })
            if a == b && function.ty(*x) == function.ty(*y) =>
        {
            [*x, *y]
        }
        (InstData::StoreBit { addr: a, bit: m, value: x }, InstData::StoreBit { addr: b, bit: n, value: y })
            if (a, m) == (b, n) =>
        {
            [*x, *y]
        }
        _ => return None,
    };
    Some((stores, values))
}

/// The way over a block that only the branch leads to, and where it ends.
fn arm(
    function: &Function,
    cfg: &ControlFlow,
    call: &BlockCall,
    is_known: &dyn Fn(&Address) -> bool,
) -> Option<(Arm, Block)> {
    let data = &function.blocks[call.block];
    if data.cold || !data.params.is_empty() || cfg.predecessors(call.block).len() != 1 {
        return None;
    }
    let (&last, insts) = data.insts.split_last()?;
    let InstData::Jump { target } = &function.insts[last] else { return None };
    if insts.len() > 2 * INSTS_MAX || !insts.iter().all(|&inst| is_allowed(function, inst, is_known)) {
        return None;
    }
    // A load after a store of the arm would read what is not stored yet.
    let stored = insts.iter().position(|&inst| function.insts[inst].has_side_effect());
    if stored.is_some_and(|at| insts[at..].iter().any(|&inst| reads_memory(&function.insts[inst]))) {
        return None;
    }
    Some((Arm { block: Some(call.block), insts: insts.to_vec(), args: target.args.clone() }, target.block))
}

fn reads_memory(data: &InstData) -> bool {
    matches!(data, InstData::Load { .. } | InstData::LoadBit { .. })
}

/// Instructions that may run although the branch does not lead to them.
fn is_allowed(function: &Function, inst: Inst, is_known: &dyn Fn(&Address) -> bool) -> bool {
    let data = &function.insts[inst];
    match data {
        InstData::Const { .. }
        | InstData::IntCompare { .. }
        | InstData::FloatCompare { .. }
        | InstData::Select { .. }
        | InstData::AddressOf { .. } => true,
        InstData::Unary { op, .. } => !matches!(op, UnaryOp::Fsqrt),
        InstData::Binary { op, .. } => {
            !matches!(op, BinaryOp::Sdiv | BinaryOp::Srem | BinaryOp::Udiv | BinaryOp::Urem | BinaryOp::Fdiv)
        }
        InstData::Convert { op, .. } => !matches!(op, ConvertOp::ToSint | ConvertOp::ToUint),
        InstData::Load { addr }
        | InstData::LoadBit { addr, .. }
        | InstData::Store { addr, .. }
        | InstData::StoreBit { addr, .. } => is_known(addr),
        _ => false,
    }
}

fn cost(function: &Function, insts: &[Inst]) -> usize {
    insts.iter().filter(|&&inst| !matches!(function.insts[inst], InstData::Const { .. })).count()
}

/// Stores of bits, and others.
fn stores(function: &Function, insts: &[Inst]) -> (usize, usize) {
    let count = |is: fn(&InstData) -> bool| insts.iter().filter(|&&inst| is(&function.insts[inst])).count();
    (count(|data| matches!(data, InstData::StoreBit { .. })), count(|data| matches!(data, InstData::Store { .. })))
}

fn convert(function: &mut Function, block: Block, shape: Shape) {
    let branch = function.blocks[block].insts.pop().expect("a branch ends the block");
    let loc = function.locs[branch];
    let mut out = std::mem::take(&mut function.blocks[block].insts);
    let mut not = None;
    let common = common_store(function, &shape.then_arm.insts, &shape.else_arm.insts);
    for (arm, holds) in [(&shape.then_arm, true), (&shape.else_arm, false)] {
        for &inst in &arm.insts {
            if common.is_some_and(|(stores, _)| stores.contains(&inst)) {
                continue;
            }
            move_out(function, &mut out, inst, (shape.cond, holds), &mut not);
        }
        if let Some(from) = arm.block {
            // The block stays until it is found unreachable.
            let jump = function.blocks[from].insts.pop().expect("a jump ends the arm");
            function.blocks[from].insts = vec![jump];
        }
    }
    if let Some(([store, _], [if_true, if_false])) = common {
        let ty = function.ty(if_true);
        let value = emit(function, &mut out, InstData::Select { cond: shape.cond, if_true, if_false }, ty, loc);
        match &mut function.insts[store] {
            InstData::Store { value: stored, .. } | InstData::StoreBit { value: stored, .. } => *stored = value,
            _ => unreachable!("a store"),
        }
        out.push(store);
    }
    let mut args = Values::with_capacity(shape.then_arm.args.len());
    for (&if_true, &if_false) in shape.then_arm.args.iter().zip(&shape.else_arm.args) {
        args.push(if if_true == if_false {
            if_true
        } else {
            let ty = function.ty(if_true);
            emit(function, &mut out, InstData::Select { cond: shape.cond, if_true, if_false }, ty, loc)
        });
    }
    let jump = function.make_inst(InstData::Jump { target: BlockCall { block: shape.meet, args } }, &[], loc);
    out.push(jump);
    function.blocks[block].insts = out;
}

fn emit(function: &mut Function, out: &mut Vec<Inst>, data: InstData, ty: Type, loc: Loc) -> Value {
    let inst = function.make_inst(data, &[ty], loc);
    out.push(inst);
    function.result(inst)
}

/// Moves an instruction of an arm before the branch; a store becomes one of the old value where the arm is not taken.
fn move_out(
    function: &mut Function,
    out: &mut Vec<Inst>,
    inst: Inst,
    (cond, holds): (Value, bool),
    not: &mut Option<Value>,
) {
    let loc = function.locs[inst];
    match function.insts[inst].clone() {
        InstData::Store { addr, value } => {
            let ty = function.ty(value);
            let old = emit(function, out, InstData::Load { addr }, ty, loc);
            let (if_true, if_false) = if holds { (value, old) } else { (old, value) };
            let value = emit(function, out, InstData::Select { cond, if_true, if_false }, ty, loc);
            function.insts[inst] = InstData::Store { addr, value };
        }
        InstData::StoreBit { addr, bit, value } => {
            let old = emit(function, out, InstData::LoadBit { addr, bit }, Type::I1, loc);
            let taken = if holds { cond } else { *not.get_or_insert_with(|| negation(function, out, cond, loc)) };
            let data = match function.constant(value) {
                Some(0) => {
                    let kept =
                        if holds { *not.get_or_insert_with(|| negation(function, out, cond, loc)) } else { cond };
                    InstData::Binary { op: BinaryOp::And, args: [old, kept] }
                }
                Some(_) => InstData::Binary { op: BinaryOp::Or, args: [old, taken] },
                None => InstData::Select { cond: taken, if_true: value, if_false: old },
            };
            let value = emit(function, out, data, Type::I1, loc);
            function.insts[inst] = InstData::StoreBit { addr, bit, value };
        }
        _ => {}
    }
    out.push(inst);
}

fn negation(function: &mut Function, out: &mut Vec<Inst>, cond: Value, loc: Loc) -> Value {
    let one = emit(function, out, InstData::Const { bits: 1 }, Type::I1, loc);
    emit(function, out, InstData::Binary { op: BinaryOp::Xor, args: [cond, one] }, Type::I1, loc)
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn an_arm_that_computes_is_a_selection() {
        check_pass(
            "branches",
            "func @F -> i16 {
            b0(v0: i1, v1: i16):
            branch v0, b1, b2(v1)
            b1:
            v2 = const.i16 7
            v3 = xor v1, v2
            jump b2(v3)
            b2(v4: i16):
            ret v4
            }",
            "func @F -> i16 {
            b0(v0: i1, v1: i16):
            v2 = const.i16 7
            v3 = xor v1, v2
            v4 = select v0, v3, v1
            jump b1(v4)
            b1(v5: i16):
            ret v5
            }",
        );
    }

    #[test]
    fn a_reset_bit_is_an_and() {
        check_pass(
            "branches",
            "func @F {
            b0(v0: i1):
            v1 = const.i1 0
            branch v0, b1, b2
            b1:
            store.bit M 2.3, v1
            jump b2
            b2:
            ret
            }",
            "func @F {
            b0(v0: i1):
            v1 = const.i1 0
            v2 = load.bit M 2.3
            v3 = const.i1 1
            v4 = xor v0, v3
            v5 = and v2, v4
            store.bit M 2.3, v5
            jump b1
            b1:
            ret
            }",
        );
    }

    #[test]
    fn two_arms_that_store_to_one_place_store_once() {
        check_pass(
            "branches",
            "func @F {
            b0(v0: i1, v1: i32):
            v2 = const.i1 0
            v3 = db_base v1
            v4 = load.bit anydb[v3]+4.1
            branch v0, b1, b2
            b1:
            store.bit anydb[v3]+4.0, v2
            jump b3
            b2:
            store.bit anydb[v3]+4.0, v4
            jump b3
            b3:
            ret
            }",
            "func @F {
            b0(v0: i1, v1: i32):
            v2 = const.i1 0
            v3 = db_base v1
            v4 = load.bit anydb[v3]+4.1
            v5 = select v0, v2, v4
            store.bit anydb[v3]+4.0, v5
            jump b1
            b1:
            ret
            }",
        );
    }

    #[test]
    fn divisions_and_indexed_accesses_stay_where_they_are() {
        let text = "func @F -> i32 {
            b0(v0: i1, v1: i32):
            branch v0, b1, b2(v1)
            b1:
            v2 = load.i32 M[v1]+0
            jump b2(v2)
            b2(v3: i32):
            ret v3
            }";
        check_pass("branches", text, text);
    }
}
