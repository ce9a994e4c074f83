//! Inlining: a call becomes a copy of the callee's code.
//!
//! ```text
//! store.i16 L 0, v1          ; FC 1 (a := 7, b := MW 0)
//! v2 = address L 0
//! v3 = const.i32 200704
//! call @FC1(v2, v3)          ; v4 = load.i16 any[v2]; store.i16 any[v3], v4
//! ```
//!
//! Functions are visited with callees before callers, so code inlined into a callee moves with it. Only a function
//! that makes no calls, or whose calls have all been inlined, is inlined:
//!
//! - Its frame begins where that of any callee begins, [`Function::inlined_bytes`] after the caller's frame. So local data keep
//!   their addresses, and neither their total size nor the content of area V changes.
//! - It is not recursive.
//!
//! Block moves count as none where the caller knows the pointers, or where a test lets them be done in place and no other copy of the
//! function remains: what the caller passes may decide the test.
//!
//! A safepoint follows each call (see `safepoint`). A STOP in the callee is a return, and the safepoint makes the caller return, too:
//! inlined code goes there directly. If the callee calls nothing in the runtime that can bring a STOP or an interrupt, it is
//! as if its instructions stood in the caller, and the safepoint goes away.
//!
//! `cost` decides which functions are worth it. Functions without calls are then removed.

mod cost;
mod safepoint;
mod splice;

use plcc_abi::layout::area;
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::{Address, Block, FuncId, Function, Inst, InstData, Module, Region, Type};

use rustc_hash::FxHashSet;

use crate::block_moves;
use crate::surroundings::Surroundings;
use cost::{Budget, Known, Shape};
use safepoint::Safepoint;
use splice::Splice;

/// Inlines calls in all functions.
pub fn inline_calls(module: &mut Module) {
    let graph = CallGraph::new(module);
    let mut budget = Budget::new(module);
    // Only what is known of DBs is asked for.
    let mut surroundings: Option<Surroundings> = None;
    let mut shapes: EntityVec<FuncId, Option<Shape>> = EntityVec::filled(None, module.functions.len());
    for &id in &graph.callees_first {
        if !graph.callees[id].is_empty() {
            let mut caller = std::mem::replace(&mut module.functions[id], Function::new(""));
            let inliner = Inliner { module, graph: &graph, shapes: &shapes, budget: &mut budget };
            inliner.run(&mut caller);
            module.functions[id] = caller;
        }
        if graph.calls[id] > 0 {
            let function = &module.functions[id];
            let mut shape = Shape::of(function);
            shape.moves_in_place = shape.is_leaf_by_moves && !shape.is_leaf && {
                let surroundings = surroundings.get_or_insert_with(|| Surroundings::new(module));
                block_moves::are_possible(function, surroundings)
            };
            shapes[id] = Some(shape);
        }
    }
    remove_uncalled(module, &graph);
}

/// Who calls whom.
struct CallGraph {
    /// Callees of each function, with repeats.
    callees: EntityVec<FuncId, Vec<FuncId>>,
    /// Calls of each function.
    calls: EntityVec<FuncId, u32>,
    /// All functions; unless calls go round in a circle, callees come before their callers.
    callees_first: Vec<FuncId>,
}

impl CallGraph {
    fn new(module: &Module) -> CallGraph {
        let (mut callees, mut calls) = (EntityVec::new(), EntityVec::new());
        for function in module.functions.values() {
            callees.push(called_by(function));
            calls.push(0);
        }
        for callee in callees.values().flatten() {
            calls[*callee] += 1;
        }
        let mut graph = CallGraph { callees, calls, callees_first: Vec::new() };
        graph.callees_first = graph.postorder();
        graph
    }

    /// Walks without recursion: calls can be nested as deep as the program likes.
    fn postorder(&self) -> Vec<FuncId> {
        let mut order = Vec::with_capacity(self.callees.len());
        let mut seen = vec![false; self.callees.len()];
        for root in self.callees.keys() {
            if std::mem::replace(&mut seen[root.index()], true) {
                continue;
            }
            let mut stack = vec![(root, 0)];
            while let Some((id, next)) = stack.last_mut() {
                match self.callees[*id].get(*next) {
                    Some(&callee) => {
                        *next += 1;
                        if !std::mem::replace(&mut seen[callee.index()], true) {
                            stack.push((callee, 0));
                        }
                    }
                    None => {
                        order.push(*id);
                        stack.pop();
                    }
                }
            }
        }
        order
    }
}

fn called_by(function: &Function) -> Vec<FuncId> {
    let insts = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    insts
        .filter_map(|&inst| match &function.insts[inst] {
            InstData::Call { callee, .. } => Some(*callee),
            _ => None,
        })
        .collect()
}

struct Inliner<'a> {
    module: &'a Module,
    graph: &'a CallGraph,
    /// Of the functions that have been visited.
    shapes: &'a EntityVec<FuncId, Option<Shape>>,
    budget: &'a mut Budget,
}

impl<'a> Inliner<'a> {
    fn run(mut self, caller: &mut Function) {
        self.budget.begin(cost::size_of(caller));
        let mut changed = false;
        let mut independent = FxHashSet::default();
        for block in std::mem::take(&mut caller.layout) {
            caller.layout.push(block);
            if !caller.blocks[block].insts.iter().any(|&inst| matches!(caller.insts[inst], InstData::Call { .. })) {
                continue;
            }
            let insts = std::mem::take(&mut caller.blocks[block].insts);
            let mut at = block;
            for (index, &inst) in insts.iter().enumerate() {
                match self.chosen(caller, block, &insts[..=index]) {
                    Some((callee, shape)) => {
                        let safepoint = Safepoint::after_call(caller, &insts[index + 1..]);
                        if shape.is_quiet
                            && let Some(safepoint) = &safepoint
                        {
                            safepoint.remove(caller);
                        }
                        let stop = safepoint.map(|safepoint| safepoint.exit);
                        if let Some(exit) = stop
                            && !shape.is_quiet
                            && independent.insert(exit)
                        {
                            safepoint::make_independent(caller, exit);
                        }
                        at = Splice::new(caller, callee, inst, at, stop).run();
                        changed = true;
                    }
                    None => caller.blocks[at].insts.push(inst),
                }
            }
        }
        if changed {
            caller.remove_unreachable_blocks();
            caller.resolve_aliases();
        }
    }

    /// The callee of the last of `insts`, which begin `block`, if it is to be inlined.
    fn chosen(&mut self, caller: &Function, block: Block, insts: &[Inst]) -> Option<(&'a Function, Shape)> {
        let (&inst, before) = insts.split_last()?;
        let InstData::Call { callee, args } = &caller.insts[inst] else { return None };
        let shape = self.shapes[*callee]?;
        let module = self.module;
        let function = &module.functions[*callee];
        let is_only_call = self.graph.calls[*callee] == 1 && !self.module.entries.contains(callee);
        let knows_areas = knows_areas(caller, before);
        let is_pointer = |at: usize| at < 64 && shape.pointers >> at & 1 != 0;
        let mut pointers = args.iter().enumerate().filter(|&(at, _)| is_pointer(at));
        let known = Known { areas: knows_areas, pointers: pointers.all(|(_, &arg)| caller.constant(arg).is_some()) };
        // The local data of a caller that works with texts itself are not private anyway.
        let is_leaf_for_caller = || shape.is_leaf_by_texts && crate::frames::gives_address_away(caller, |_, _| false);
        let moves_away = || shape.is_leaf_by_moves && (knows_areas || shape.moves_in_place && is_only_call);
        let fits = (shape.is_leaf || moves_away() || is_leaf_for_caller())
            && shape.caller_bytes <= caller.frame_bytes
            && caller.frame_bytes + function.local_bytes() <= plcc_abi::layout::L_CLASS_BYTES
            && !caller.blocks[block].cold
            && !function.apart;
        (fits && self.budget.allows(&shape, is_only_call, known)).then_some((function, shape))
    }
}

/// True if instructions before a call store a constant pointer with its area for the callee.
fn knows_areas(caller: &Function, before: &[Inst]) -> bool {
    /// Instructions before a call in which its parameters are stored.
    const LAST: usize = 40;
    before.iter().rev().take(LAST).any(|&inst| match &caller.insts[inst] {
        InstData::Store { addr, value } if addr.region == Region::L && caller.ty(*value) == Type::I32 => caller
            .constant(*value)
            .is_some_and(|pointer| (u64::from(area::P)..=u64::from(area::V)).contains(&(pointer >> 24))),
        _ => false,
    })
}

/// The address of an inlined function as seen from the function that has a frame of `frame_bytes`.
fn address_in_caller(addr: Address, frame_bytes: u32) -> Address {
    match addr.region {
        Region::L => Address { offset: addr.offset + frame_bytes, ..addr },
        Region::V => Address { region: Region::L, ..addr },
        Region::State
        | Region::I
        | Region::Q
        | Region::M
        | Region::System
        | Region::Cells
        | Region::Db(_)
        | Region::AnyDb
        | Region::Any => addr,
    }
}

/// Removes functions whose calls have all been inlined.
fn remove_uncalled(module: &mut Module, before: &CallGraph) {
    let mut is_needed = vec![false; module.functions.len()];
    for (id, function) in module.functions.iter() {
        is_needed[id.index()] |= before.calls[id] == 0;
        for callee in called_by(function) {
            is_needed[callee.index()] = true;
        }
    }
    for &entry in &module.entries {
        is_needed[entry.index()] = true;
    }
    if !is_needed.contains(&false) {
        return;
    }
    let mut functions = EntityVec::new();
    let mut numbers = Vec::with_capacity(is_needed.len());
    let all: Vec<FuncId> = module.functions.keys().collect();
    for id in all {
        let function = std::mem::replace(&mut module.functions[id], Function::new(""));
        numbers.push(FuncId::new(functions.len()));
        if is_needed[id.index()] {
            functions.push(function);
        }
    }
    for function in functions.values_mut() {
        for data in function.insts.values_mut() {
            if let InstData::Call { callee, .. } = data {
                *callee = numbers[callee.index()];
            }
        }
    }
    for entry in &mut module.entries {
        *entry = numbers[entry.index()];
    }
    module.functions = functions;
}

#[cfg(test)]
mod tests;
