//! Makes places values in the loops that carry them.

use plcc_ir::{
    Address, BinaryOp, Block, BlockCall, ConvertOp, Function, Inst, InstData, Loc, Region, Type, Value, eval,
};
use rustc_hash::FxHashMap;

use super::plan::{Carried, Carrier, address_of, place_of};
use crate::variables::{Action, promote};

/// True if the place has what the variable is at the end of the block, since something there looked at it.
fn is_stored_at_end(function: &Function, block: Block, carried: &Carried) -> bool {
    if !function.blocks[block].cold || carried.shown.is_empty() {
        return false;
    }
    let is_last =
        |inst: &&Inst| [&carried.shown, &carried.accesses, &carried.parts].iter().any(|list| list.contains(inst));
    let last = function.blocks[block].insts.iter().rev().find(is_last);
    last.is_some_and(|last| carried.shown.contains(last))
}

/// Rewrites the loops of a function.
pub fn rewrite(function: &mut Function, carriers: &[Carrier]) {
    let mut edit = Edit {
        function,
        types: Vec::new(),
        actions: FxHashMap::default(),
        before: FxHashMap::default(),
        after: FxHashMap::default(),
    };
    let mut first_vars = Vec::new();
    for carrier in carriers {
        first_vars.push(edit.types.len());
        for carried in &carrier.places {
            edit.add(carried);
        }
    }
    edit.insert();
    edit.edges(carriers, &first_vars);
    let Edit { function, types, actions, .. } = edit;
    // A variable is loaded on every way into its loop, so that none is needed at the begin of the function.
    let mut initial =
        |function: &mut Function, var: usize| function.make_inst(InstData::Const { bits: 0 }, &[types[var]], Loc(0));
    // Its time is bounded by the plan.
    promote(function, &types, &actions, &mut initial);
}

struct Edit<'a> {
    function: &'a mut Function,
    types: Vec<Type>,
    actions: FxHashMap<Inst, Action>,
    /// Instructions that come before and after others.
    before: FxHashMap<Inst, Vec<Inst>>,
    after: FxHashMap<Inst, Vec<Inst>>,
}

impl Edit<'_> {
    fn add(&mut self, carried: &Carried) {
        let var = self.types.len();
        self.types.push(carried.ty);
        for &inst in &carried.accesses {
            let writes = place_of(self.function, inst).is_some_and(|(_, _, writes)| writes);
            let action = match &self.function.insts[inst] {
                InstData::Store { value, .. } | InstData::StoreBit { value, .. } if writes => {
                    Action::Write(var, *value)
                }
                _ => Action::Read(var),
            };
            self.actions.insert(inst, action);
        }
        for &inst in &carried.parts {
            self.add_part(carried, var, inst);
        }
        for &inst in &carried.shown {
            let [read, store] = self.store(carried, var, self.function.locs[inst]);
            self.before.entry(inst).or_default().extend([read, store]);
        }
        for &inst in &carried.renewed {
            let [load, write] = self.load(carried, var, self.function.locs[inst]);
            self.after.entry(inst).or_default().extend([load, write]);
        }
    }

    /// Makes an access of a part of the place one of the variable.
    fn add_part(&mut self, carried: &Carried, var: usize, inst: Inst) {
        let Some((part, ty, writes)) = place_of(self.function, inst) else { return };
        let (loc, whole) = (self.function.locs[inst], carried.ty);
        // Memory is big-endian: bytes after the part are below it. Within its byte a bit has its own number.
        let shift = match ty {
            Type::I1 => carried.place.end - (part.start / 8 + 1) * 8 + part.start % 8,
            _ => carried.place.end - part.end,
        };
        let read = self.load_of(carried, loc);
        self.actions.insert(read, Action::Read(var));
        let old = self.function.result(read);
        let mut insts = vec![read];
        let mut emit = |function: &mut Function, data: InstData| -> Value {
            let inst = function.make_inst(data, &[whole], loc);
            insts.push(inst);
            function.result(inst)
        };
        let function = &mut *self.function;
        let moved = |emit: &mut dyn FnMut(&mut Function, InstData) -> Value, function: &mut Function, op, value| {
            if shift == 0 {
                return value;
            }
            let count = emit(function, InstData::Const { bits: shift });
            emit(function, InstData::Binary { op, args: [value, count] })
        };
        let value = match &function.insts[inst] {
            InstData::Store { value, .. } | InstData::StoreBit { value, .. } if writes => *value,
            _ => {
                let arg = moved(&mut emit, function, BinaryOp::Lshr, old);
                function.insts[inst] = InstData::Convert { op: ConvertOp::Trunc, arg };
                self.before.entry(inst).or_default().extend(insts);
                return;
            }
        };
        let others = eval::mask(whole, !(eval::mask(ty, u64::MAX) << shift));
        let others = emit(function, InstData::Const { bits: others });
        let kept = emit(function, InstData::Binary { op: BinaryOp::And, args: [old, others] });
        let wide = emit(function, InstData::Convert { op: ConvertOp::Zext, arg: value });
        let placed = moved(&mut emit, function, BinaryOp::Shl, wide);
        let value = emit(function, InstData::Binary { op: BinaryOp::Or, args: [kept, placed] });
        function.insts[inst] = InstData::Store { addr: address_of(&carried.place).0, value };
        self.actions.insert(inst, Action::Write(var, value));
        self.before.entry(inst).or_default().extend(insts);
    }

    /// Instructions that store a variable in its place.
    fn store(&mut self, carried: &Carried, var: usize, loc: Loc) -> [Inst; 2] {
        let read = self.load_of(carried, loc);
        let value = self.function.result(read);
        self.actions.insert(read, Action::Read(var));
        let (addr, bit) = address_of(&carried.place);
        let data = match carried.ty {
            Type::I1 => InstData::StoreBit { addr, bit, value },
            _ => InstData::Store { addr, value },
        };
        [read, self.function.make_inst(data, &[], loc)]
    }

    /// Instructions that load a variable from its place.
    fn load(&mut self, carried: &Carried, var: usize, loc: Loc) -> [Inst; 2] {
        let load = self.load_of(carried, loc);
        let value = self.function.result(load);
        let nothing = InstData::Clear { addr: Address::direct(Region::M, 0), len: 0 };
        let write = self.function.make_inst(nothing, &[], loc);
        self.actions.insert(write, Action::Write(var, value));
        [load, write]
    }

    fn load_of(&mut self, carried: &Carried, loc: Loc) -> Inst {
        let (addr, bit) = address_of(&carried.place);
        let data = match carried.ty {
            Type::I1 => InstData::LoadBit { addr, bit },
            _ => InstData::Load { addr },
        };
        self.function.make_inst(data, &[carried.ty], loc)
    }

    fn insert(&mut self) {
        for index in 0..self.function.layout.len() {
            let block = self.function.layout[index];
            let insts = &self.function.blocks[block].insts;
            if !insts.iter().any(|inst| self.before.contains_key(inst) || self.after.contains_key(inst)) {
                continue;
            }
            let mut out = Vec::with_capacity(insts.len() + 8);
            for inst in std::mem::take(&mut self.function.blocks[block].insts) {
                out.extend(self.before.remove(&inst).unwrap_or_default());
                out.push(inst);
                out.extend(self.after.remove(&inst).unwrap_or_default());
            }
            self.function.blocks[block].insts = out;
        }
    }

    /// Stores variables on the ways out of loops, and loads them on the ways in. The ways get blocks of their own.
    fn edges(&mut self, carriers: &[Carrier], first_vars: &[usize]) {
        // The carriers that each block is in.
        let mut inside: FxHashMap<Block, Vec<usize>> = FxHashMap::default();
        for (index, carrier) in carriers.iter().enumerate() {
            for &block in &carrier.blocks {
                inside.entry(block).or_default().push(index);
            }
        }
        let nowhere = Vec::new();
        for block in self.function.layout.clone() {
            let Some(last) = self.function.terminator(block) else { continue };
            let from = inside.get(&block).unwrap_or(&nowhere);
            let targets: Vec<Block> = self.function.successors(block);
            for (number, target) in targets.into_iter().enumerate() {
                let to = inside.get(&target).unwrap_or(&nowhere);
                let left: Vec<usize> = from.iter().copied().filter(|index| !to.contains(index)).collect();
                let entered: Vec<usize> = to.iter().copied().filter(|index| !from.contains(index)).collect();
                let mut insts = Vec::new();
                let loc = self.function.locs[last];
                for index in left {
                    for (var, carried) in (first_vars[index]..).zip(&carriers[index].places) {
                        if carried.is_stored && !is_stored_at_end(self.function, block, carried) {
                            insts.extend(self.store(carried, var, loc));
                        }
                    }
                }
                for index in entered {
                    for (var, carried) in (first_vars[index]..).zip(&carriers[index].places) {
                        insts.extend(self.load(carried, var, loc));
                    }
                }
                if !insts.is_empty() {
                    self.split(block, last, number, target, insts);
                }
            }
        }
    }

    /// Puts instructions on the jump number `number` of a terminator.
    fn split(&mut self, from: Block, last: Inst, number: usize, target: Block, mut insts: Vec<Inst>) {
        let function = &mut *self.function;
        let edge = function.add_block();
        function.blocks[edge].cold = function.blocks[from].cold || function.blocks[target].cold;
        let mut index = 0;
        let mut call = BlockCall::new(edge);
        function.insts[last].for_each_target_mut(|to| {
            if index == number {
                std::mem::swap(to, &mut call);
            }
            index += 1;
        });
        insts.push(function.make_inst(InstData::Jump { target: call }, &[], function.locs[last]));
        function.blocks[edge].insts = insts;
        // It is laid out after the block that it comes from.
        let made = function.layout.pop();
        let at = function.layout.iter().position(|&at| at == from).map_or(function.layout.len(), |at| at + 1);
        function.layout.splice(at..at, made);
    }
}
