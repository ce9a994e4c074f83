//! Which functions are worth inlining.
//!
//! A call costs about as much as [`CALL_COST`] instructions: eleven registers of the CPU go in and nine come out. A function that is not
//! much larger is always inlined; so is one that is called once, because no other copy remains. In between, a program may grow by
//! part of its size, so that compile time stays linear in the size of the program.

use plcc_abi::functions::Effect;
use plcc_ir::{BinaryOp, Function, InstData, Module, Region, UnaryOp};

use crate::frames;

/// Instructions that cost as much as a call.
const CALL_COST: u32 = 24;
/// Up to this cost a function is inlined everywhere.
const SMALL: u32 = 2 * CALL_COST;
/// Up to this cost it is inlined as long as the program may grow.
const MEDIUM: u32 = 4 * CALL_COST;
/// Up to this size a function that is called once is inlined.
const ONCE_MAX: u32 = 2000;
/// No function grows beyond this size, but for small callees: code generation takes more than linear time for large ones.
const CALLER_MAX: u32 = 10_000;
/// Growth by callees that are not small: a part of the program's size, and a minimum for every program.
const GROWTH_PART: u32 = 8;
const GROWTH_FREE: u32 = 1000;

/// The properties of a function as a callee.
#[derive(Clone, Copy)]
pub struct Shape {
    /// Instructions on paths that are not cold, weighted.
    pub cost: u32,
    /// Instructions.
    pub size: u32,
    /// It calls no function of the module, returns, and passes no address of local data on: the caller's local data stay
    /// private then.
    pub is_leaf: bool,
    /// It calls no runtime function that may run organization blocks or stop the CPU.
    pub is_quiet: bool,
    /// Bytes of the caller's frame that it addresses directly.
    pub caller_bytes: u32,
}

impl Shape {
    pub fn of(function: &Function) -> Shape {
        let is_leaf = !frames::gives_address_away(function);
        let mut shape = Shape { cost: 0, size: 0, is_leaf, is_quiet: true, caller_bytes: 0 };
        let mut returns = false;
        for block in function.layout.iter().map(|&block| &function.blocks[block]) {
            for &inst in &block.insts {
                let data = &function.insts[inst];
                shape.size += 1;
                if !block.cold {
                    shape.cost += cost(data);
                }
                match data {
                    InstData::Call { .. } => shape.is_leaf = false,
                    InstData::CallRuntime { function, .. } => {
                        shape.is_quiet &= matches!(function.effect(), Effect::Pure | Effect::Cells | Effect::System);
                    }
                    InstData::Return { .. } => returns = true,
                    _ => {}
                }
                data.for_each_address(|addr| {
                    let is_local = matches!(addr.region, Region::L | Region::V);
                    // An offset from a base that would not fit any frame: whatever it means, it is rare.
                    shape.is_leaf &=
                        !(is_local && addr.base.is_some() && addr.offset >= plcc_abi::layout::L_CLASS_BYTES);
                    if addr.region == Region::V && addr.base.is_none() {
                        let bytes = direct_bytes(function, inst, data);
                        shape.caller_bytes = shape.caller_bytes.max(addr.offset.saturating_add(bytes));
                    }
                });
            }
        }
        shape.is_leaf &= returns;
        shape
    }
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

    /// Whether a callee is to be inlined; if so, it counts.
    pub fn allows(&mut self, callee: &Shape, is_only_call: bool) -> bool {
        let caller = self.caller.saturating_add(callee.size);
        let fits = caller <= CALLER_MAX;
        let small = callee.cost <= SMALL && callee.size <= 2 * SMALL;
        let allowed = if small {
            true
        } else if is_only_call {
            fits && callee.size <= ONCE_MAX
        } else {
            fits && callee.cost <= MEDIUM && callee.size <= self.growth
        };
        if allowed {
            self.caller = caller;
            if !small && !is_only_call {
                self.growth -= callee.size;
            }
        }
        allowed
    }
}
