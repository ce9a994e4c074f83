//! Which functions are worth inlining.
//!
//! A call costs about as much as [`CALL_COST`] instructions: eleven registers of the CPU go in and nine come out. A function that is not
//! much larger is always inlined; so is one that is called once, because no other copy remains. In between, a program may grow by
//! part of its size, so that compile time stays linear in the size of the program.

use plcc_abi::functions::Effect;
use plcc_abi::layout::area;
use plcc_ir::{BinaryOp, Block, Function, InstData, IntCc, Module, Region, UnaryOp};
use rustc_hash::FxHashSet;

use crate::{block_moves, frames};

/// Instructions that cost as much as a call.
const CALL_COST: u32 = 24;
/// Up to this cost a function is inlined everywhere.
const SMALL: u32 = 2 * CALL_COST;
/// Up to this cost it is inlined as long as the program may grow.
const MEDIUM: u32 = 4 * CALL_COST;
/// The same of a function that gets pointers whose areas it then knows.
const ONE_AREA: u32 = 6 * CALL_COST;
/// Up to this size a function that is called once is inlined.
const ONCE_MAX: u32 = 2000;
/// No function grows beyond this size, but for small callees: code generation takes more than linear time for large ones.
const CALLER_MAX: u32 = 10_000;
/// Growth by callees that are not small: a part of the program's size, and a minimum for every program.
const GROWTH_PART: u32 = 8;
const GROWTH_FREE: u32 = 2000;

/// The properties of a function as a callee.
#[derive(Clone, Copy)]
pub struct Shape {
    /// Instructions on paths that are not cold, weighted.
    pub cost: u32,
    /// As `cost`, where pointers whose area the function looks at are known: then only the code for one area remains.
    pub cost_by_area: u32,
    /// Instructions.
    pub size: u32,
    /// It calls no function of the module, returns, and passes no address of local data on: the caller's local data stay
    /// private then.
    pub is_leaf: bool,
    /// The same but for block moves, which get the addresses of pointers. Where those are known it is one without calls.
    pub is_leaf_by_moves: bool,
    /// It calls no runtime function that may run organization blocks or stop the CPU.
    pub is_quiet: bool,
    /// Bytes of the caller's frame that it addresses directly.
    pub caller_bytes: u32,
}

impl Shape {
    pub fn of(function: &Function) -> Shape {
        let is_leaf = !frames::gives_address_away(function, |_, _| false);
        let is_leaf_by_moves = is_leaf || !frames::gives_address_away(function, block_moves::is_block_move);
        let mut shape =
            Shape { cost: 0, cost_by_area: 0, size: 0, is_leaf, is_leaf_by_moves, is_quiet: true, caller_bytes: 0 };
        let mut is_candidate = true;
        let mut returns = false;
        let other_areas = code_for_areas(function);
        for (id, block) in function.layout.iter().map(|&id| (id, &function.blocks[id])) {
            for &inst in &block.insts {
                let data = &function.insts[inst];
                shape.size += 1;
                if !block.cold {
                    shape.cost += cost(data);
                    if !other_areas.contains(&id) {
                        shape.cost_by_area += cost(data);
                    }
                }
                match data {
                    InstData::Call { .. } => is_candidate = false,
                    InstData::CallRuntime { function, .. } => {
                        shape.is_quiet &= matches!(function.effect(), Effect::Pure | Effect::Cells | Effect::System);
                    }
                    InstData::Return { .. } => returns = true,
                    _ => {}
                }
                data.for_each_address(|addr| {
                    let is_local = matches!(addr.region, Region::L | Region::V);
                    // An offset from a base that would not fit any frame: whatever it means, it is rare.
                    is_candidate &=
                        !(is_local && addr.base.is_some() && addr.offset >= plcc_abi::layout::L_CLASS_BYTES);
                    if addr.region == Region::V && addr.base.is_none() {
                        let bytes = direct_bytes(function, inst, data);
                        shape.caller_bytes = shape.caller_bytes.max(addr.offset.saturating_add(bytes));
                    }
                });
            }
        }
        shape.is_leaf &= is_candidate && returns;
        shape.is_leaf_by_moves &= is_candidate && returns;
        shape
    }
}

/// Blocks that are only for pointers into some area that is not a DB.
fn code_for_areas(function: &Function) -> FxHashSet<Block> {
    let mut found = FxHashSet::default();
    for &block in &function.layout {
        let Some(InstData::Branch { cond, then_to, .. }) = function.terminator(block).map(|inst| &function.insts[inst])
        else {
            continue;
        };
        if area_test(function, *cond).is_some_and(|area| area != u64::from(area::DB)) {
            found.insert(then_to.block);
            found.extend(function.successors(then_to.block).into_iter().filter(|&next| {
                // What the other areas also go to is the rest of the function.
                function.blocks[next].params.is_empty() && !function.blocks[next].cold
            }));
        }
    }
    found
}

/// The area that a condition compares that of a pointer with.
fn area_test(function: &Function, cond: plcc_ir::Value) -> Option<u64> {
    let &InstData::IntCompare { cc: IntCc::Eq, args: [code, area] } = function.defining(cond)? else { return None };
    let &InstData::Binary { op: BinaryOp::Lshr, args: [_, count] } = function.defining(code)? else { return None };
    let area = function.constant(area)?;
    (function.constant(count) == Some(24) && (u64::from(area::P)..=u64::from(area::V)).contains(&area)).then_some(area)
}

/// Bytes that an access touches.
fn direct_bytes(function: &Function, inst: plcc_ir::Inst, data: &InstData) -> u32 {
    match data {
        InstData::Load { .. } => function.ty(function.result(inst)).bytes(),
        InstData::Store { value, .. } => function.ty(*value).bytes(),
        InstData::LoadBit { .. } | InstData::StoreBit { .. } => 1,
        InstData::Clear { len, .. } | InstData::Copy { len, .. } => *len,
        _ => 0,
    }
}

fn cost(data: &InstData) -> u32 {
    match data {
        InstData::Const { .. } | InstData::Jump { .. } | InstData::Return { .. } => 0,
        InstData::CallRuntime { .. } => 8,
        InstData::Clear { .. } | InstData::Copy { .. } => 2,
        InstData::Binary { op: BinaryOp::Sdiv | BinaryOp::Srem | BinaryOp::Fdiv, .. }
        | InstData::Unary { op: UnaryOp::Fsqrt, .. } => 4,
        InstData::Switch { targets, .. } => 2 + targets.len() as u32,
        _ => 1,
    }
}

/// How much the program may still grow.
pub struct Budget {
    growth: u32,
    caller: u32,
}

impl Budget {
    pub fn new(module: &Module) -> Budget {
        let size: u32 = module.functions.values().map(|function| function.insts.len() as u32).sum();
        Budget { growth: size / GROWTH_PART + GROWTH_FREE, caller: 0 }
    }

    /// A caller of this size is visited.
    pub fn begin(&mut self, size: u32) {
        self.caller = size;
    }

    /// Whether a callee is to be inlined; if so, it counts. `knows_areas`: the caller passes pointers with constant areas.
    pub fn allows(&mut self, callee: &Shape, is_only_call: bool, knows_areas: bool) -> bool {
        let by_area = knows_areas && callee.cost_by_area < callee.cost;
        let (cost, size) =
            if by_area { (callee.cost_by_area, callee.cost_by_area) } else { (callee.cost, callee.size) };
        let caller = self.caller.saturating_add(callee.size);
        let fits = caller <= CALLER_MAX;
        let small = callee.cost <= SMALL && callee.size <= 2 * SMALL;
        let allowed = if small {
            true
        } else if is_only_call {
            fits && callee.size <= ONCE_MAX
        } else {
            fits && cost <= if by_area { ONE_AREA } else { MEDIUM } && size <= self.growth
        };
        if allowed {
            self.caller = caller;
            if !small && !is_only_call {
                self.growth -= size;
            }
        }
        allowed
    }
}
