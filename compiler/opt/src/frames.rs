//! Who can reach the local data of a function.
//!
//! A frame is *private* if its address goes nowhere: then only the function itself reaches it by region `L`, and a callee by
//! region `V`. Pointers to local data in PLC memory are area pointers, which code turns into an address by `address` or
//! `frame_base` where they are used; so a frame that has neither cannot be reached in another way, by organization
//! blocks that run in between either: they have their own frames. An address does not escape if the
//! function calculates with it, chooses between it and another, compares it, where room on the L stack is counted, or makes
//! accesses to `any` with it as base; those may alias region `L` anyway.

use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::{BinaryOp, FuncId, Function, InstData, Module, Region, Value};

/// The frame of a function, and what its callees do with it.
pub struct Frames<'a> {
    is_private: bool,
    callees: &'a Callees,
}

/// Which functions of a module touch the frames of their callers. Optimisation takes accesses away and adds none, so what was found
/// before holds after it.
pub struct Callees {
    touching: EntityVec<FuncId, bool>,
}

impl Callees {
    pub fn new(module: &Module) -> Callees {
        let mut touching = EntityVec::new();
        for function in module.functions.values() {
            touching.push(touches_caller(function));
        }
        Callees { touching }
    }

    /// True if a call of `callee` may read or write the frame of its caller.
    pub fn touches_caller(&self, callee: FuncId) -> bool {
        self.touching[callee]
    }
}

impl<'a> Frames<'a> {
    pub fn new(function: &Function, callees: &'a Callees) -> Frames<'a> {
        Frames { is_private: !is_given_away(function, &|region| region == Region::L, |_, _| false), callees }
    }

    /// True if only the function and its direct callees can reach its frame.
    pub fn is_private(&self) -> bool {
        self.is_private
    }

    /// True if a call of `callee` may read or write the frame.
    pub fn call_touches(&self, callee: FuncId) -> bool {
        !self.is_private || self.callees.touches_caller(callee)
    }
}

fn touches_caller(function: &Function) -> bool {
    let mut touches = false;
    for block in function.layout.iter().map(|&block| &function.blocks[block]) {
        for &inst in &block.insts {
            function.insts[inst].for_each_address(|addr| touches |= addr.region == Region::V);
        }
    }
    touches
}

/// True if the address of local data, own ones or the caller's, goes anywhere but to instructions that `keep` it.
pub fn gives_address_away(function: &Function, keep: fn(&Function, &InstData) -> bool) -> bool {
    is_given_away(function, &|region| matches!(region, Region::L | Region::V), keep)
}

/// True if the address of a place in a region that `is_local` names is used for more than accesses and comparisons.
fn is_given_away(
    function: &Function,
    is_local: &dyn Fn(Region) -> bool,
    keep: fn(&Function, &InstData) -> bool,
) -> bool {
    let is_source = |data: &InstData| match data {
        InstData::AddressOf { addr } => is_local(addr.region),
        InstData::FrameBase { .. } => true,
        _ => false,
    };
    let insts = || function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    if !insts().any(|&inst| is_source(&function.insts[inst])) {
        return false;
    }
    let Some(derived) = derived_values(function, &is_source) else { return true };
    insts().any(|&inst| {
        let data = &function.insts[inst];
        let is_derived = |value: Value| derived[function.resolve(value).index()];
        match data {
            InstData::IntCompare { .. } | InstData::Load { .. } | InstData::LoadBit { .. } => false,
            InstData::Clear { .. } | InstData::Copy { .. } => false,
            InstData::Store { value, .. } | InstData::StoreBit { value, .. } => is_derived(*value),
            InstData::Binary { .. } | InstData::Select { .. } | InstData::Jump { .. } | InstData::Branch { .. } => {
                false
            }
            _ => uses_any(function, data, &derived) && !keep(function, data),
        }
    })
}

/// Marks the values computed from an address, also those that blocks pass on. `None`: that takes too many rounds.
fn derived_values(function: &Function, is_source: &dyn Fn(&InstData) -> bool) -> Option<Vec<bool>> {
    const ROUNDS_MAX: u32 = 8;
    let mut derived = vec![false; function.values.len()];
    for _ in 0..ROUNDS_MAX {
        let mut changed = false;
        let mut mark = |derived: &mut Vec<bool>, value: Value| {
            changed |= !std::mem::replace(&mut derived[value.index()], true);
        };
        for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
            let data = &function.insts[inst];
            let computes = match data {
                InstData::Binary { op: BinaryOp::Isub, args } => {
                    // The distance between two places is not an address.
                    !args.iter().all(|&arg| function.defining(arg).is_some_and(is_source))
                }
                InstData::Binary { .. } | InstData::Select { .. } => true,
                _ => false,
            };
            if is_source(data) || computes && uses_any(function, data, &derived) {
                mark(&mut derived, function.result(inst));
            }
            data.for_each_target(|target| {
                for (&argument, &parameter) in target.args.iter().zip(&function.blocks[target.block].params) {
                    if derived[function.resolve(argument).index()] {
                        mark(&mut derived, parameter);
                    }
                }
            });
        }
        if !changed {
            return Some(derived);
        }
    }
    None
}

fn uses_any(function: &Function, data: &InstData, marked: &[bool]) -> bool {
    let mut any = false;
    data.for_each_use(|value: Value| any |= marked[function.resolve(value).index()]);
    any
}
