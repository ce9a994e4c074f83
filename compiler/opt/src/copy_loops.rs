//! Loops that fill an array with zeros, or copy or move one, become one instruction.
//!
//! ```text
//! b1(v1: i16):                       ; FOR #i := 63 TO 1 BY -1 DO
//!     v2 = sext.i32 v1               ;     #a[#i] := #a[#i - 1];
//!     v3 = shl v2, 1                 ; END_FOR;
//!     v4 = load.i16 DB1[v3]-2
//!     store.i16 DB1[v3]+0, v4        ; copy DB1 2, DB1 0, 126
//!     v5 = iadd v1, -1
//!     v6 = sge v5, 1
//!     branch v6, b1(v5), b2
//! ```
//!
//! The counters of such a loop begin with constants, and what it copies decides nothing. So its passes are gone through here, which gives the
//! address of each access and what its values are in the end. If each pass writes the element after or before that of the last pass, and
//! nothing is read that was written before, the loop is what a move of the bytes is.

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::{Address, BinaryOp, Block, BlockCall, Function, Inst, InstData, Loc, Region, Type, Value, Values, eval};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::loops::{Loop, Loops};

/// Larger functions are left as they are.
const FUNCTION_MAX: usize = 50_000;
/// Instructions of a loop.
const INSTS_MAX: usize = 60;
/// Instructions that are gone through in one function, each in each pass.
const STEPS_MAX: usize = 200_000;
/// Rounds over a function: where one loop follows another, the second waits.
const ROUNDS_MAX: usize = 4;
/// Loops that write fewer bytes are left to be unrolled.
const BYTES_MIN: i64 = 16;

/// Finds such loops in a function. Result: whether there were any.
pub fn copy_loops(function: &mut Function) -> bool {
    if function.insts.len() > FUNCTION_MAX {
        return false;
    }
    let mut steps = STEPS_MAX;
    let mut changed = false;
    for _ in 0..ROUNDS_MAX {
        let replaced = replace_all(function, &mut steps);
        if replaced.is_empty() {
            break;
        }
        function.remove_unreachable_blocks();
        changed = true;
    }
    changed
}

/// Result: the blocks of the loops that were replaced. Loops that are within one of them or follow it wait for the next round.
fn replace_all(function: &mut Function, steps: &mut usize) -> FxHashSet<Block> {
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let loops = Loops::new(function, &cfg, &dominators);
    let mut replaced: FxHashSet<Block> = FxHashSet::default();
    for each in &loops.all {
        let follows = cfg.predecessors(each.header).iter().any(|pred| replaced.contains(pred));
        if follows || replaced.contains(&each.header) {
            continue;
        }
        let passes = Passes::of(function, &cfg, each, steps);
        if let Some(outcome) = passes.and_then(|passes| passes.outcome(function, each)) {
            replace(function, each, outcome);
            replaced.extend(&each.blocks);
        }
    }
    replaced
}

/// A number, or the sum of a value from before the loop and a number.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Known {
    from: Option<Value>,
    bits: u64,
}

impl Known {
    const fn number(bits: u64) -> Known {
        Known { from: None, bits }
    }
}

/// A place that a pass reads or writes: a region, and where in it.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Place {
    region: Region,
    from: Option<Value>,
    at: i64,
}

/// What a store of one element writes.
#[derive(Clone, Copy)]
enum Written {
    Zero,
    From(Place),
}

/// The passes of a loop, gone through.
struct Passes {
    /// The only block that enters the loop.
    enter: Block,
    /// The values of the loop.
    own: FxHashSet<Value>,
    known: FxHashMap<Value, Known>,
    /// Where each load of this pass was, by its result.
    loaded: FxHashMap<Value, Place>,
    /// The elements in their order.
    elements: Vec<(Place, Written)>,
    /// Bytes of each.
    element_bytes: i64,
    loc: Loc,
    /// Stores of known numbers to places that do not depend on the pass, such as counters: what they write in the end.
    last: Vec<(Address, Type, u64, Loc)>,
    exit: BlockCall,
}

/// What takes the place of a loop.
struct Outcome {
    enter: Block,
    moved: Moved,
    loc: Loc,
    last: Vec<(Address, Type, u64, Loc)>,
    exit: BlockCall,
    /// What the values of the loop that are used after it are then.
    values: Vec<(Value, Known)>,
}

/// Bytes that are set to 0 or moved.
struct Moved {
    to: Place,
    from: Option<Place>,
    len: u32,
}

impl Passes {
    /// Goes through the passes of an innermost loop; `None`: it does something else, or it does not end soon.
    fn of(function: &Function, cfg: &ControlFlow, each: &Loop, steps: &mut usize) -> Option<Passes> {
        let inside = |block: &Block| each.blocks.contains(block);
        let insts = || each.blocks.iter().flat_map(|&block| &function.blocks[block].insts);
        let writes_element = |&&inst: &&Inst| match &function.insts[inst] {
            InstData::Store { addr, .. } => addr.base.is_some(),
            _ => false,
        };
        let is_other = |&inst: &Inst| {
            let data = &function.insts[inst];
            data.has_side_effect() && !matches!(data, InstData::Store { .. }) && !data.is_terminator()
        };
        if insts().count() > INSTS_MAX || insts().filter(writes_element).count() != 1 || insts().any(is_other) {
            return None;
        }
        let mut enter = cfg.predecessors(each.header).iter().copied().filter(|pred| !inside(pred));
        let (enter, None) = (enter.next()?, enter.next()) else { return None };
        let calls = function.insts[function.terminator(enter)?].targets();
        let mut calls = calls.into_iter().filter(|call| call.block == each.header);
        let (call, None) = (calls.next()?.clone(), calls.next()) else { return None };
        let params = || each.blocks.iter().flat_map(|&block| &function.blocks[block].params);
        let mut passes = Passes {
            enter,
            own: params().chain(insts().flat_map(|&inst| &function.results[inst])).copied().collect(),
            known: FxHashMap::default(),
            loaded: FxHashMap::default(),
            elements: Vec::new(),
            element_bytes: 0,
            loc: Loc(0),
            last: Vec::new(),
            exit: call,
        };
        while inside(&passes.exit.block) {
            let block = passes.exit.block;
            passes.enter_block(function);
            for &inst in &function.blocks[block].insts {
                *steps = steps.checked_sub(1)?;
                if function.insts[inst].is_terminator() {
                    passes.exit = passes.next(function, inst)?;
                } else {
                    passes.step(function, inst)?;
                }
            }
        }
        Some(passes)
    }

    /// Gives the parameters of the block that the last jump leads to what it brings.
    fn enter_block(&mut self, function: &Function) {
        let brought: Vec<Option<Known>> = self.exit.args.iter().map(|&arg| self.get(function, arg)).collect();
        for (&param, known) in function.blocks[self.exit.block].params.iter().zip(brought) {
            self.set(param, known);
        }
    }

    fn set(&mut self, value: Value, known: Option<Known>) {
        match known {
            Some(known) => self.known.insert(value, known),
            None => self.known.remove(&value),
        };
        self.loaded.remove(&value);
    }

    fn get(&self, function: &Function, value: Value) -> Option<Known> {
        let value = function.resolve(value);
        match function.constant(value) {
            Some(bits) => Some(Known::number(bits)),
            None if self.own.contains(&value) => self.known.get(&value).copied(),
            None => Some(Known { from: Some(value), bits: 0 }),
        }
    }

    fn number(&self, function: &Function, value: Value) -> Option<u64> {
        self.get(function, value).filter(|known| known.from.is_none()).map(|known| known.bits)
    }

    /// The target of a jump.
    fn next(&self, function: &Function, inst: Inst) -> Option<BlockCall> {
        Some(match &function.insts[inst] {
            InstData::Jump { target } => target.clone(),
            InstData::Branch { cond, then_to, else_to } => {
                if self.number(function, *cond)? & 1 != 0 {
                    then_to.clone()
                } else {
                    else_to.clone()
                }
            }
            InstData::Switch { value, targets, default } => {
                let index = usize::try_from(self.number(function, *value)?).ok()?;
                targets.get(index).unwrap_or(default).clone()
            }
            _ => return None,
        })
    }

    /// An instruction that is not a jump.
    fn step(&mut self, function: &Function, inst: Inst) -> Option<()> {
        match &function.insts[inst] {
            InstData::Store { addr, value } if addr.base.is_some() => self.write(function, inst, addr, *value),
            InstData::Store { addr, value } => {
                let bits = self.number(function, *value)?;
                let ty = function.ty(*value);
                self.last.retain(|(known, known_ty, ..)| (*known, *known_ty) != (*addr, ty));
                self.last.push((*addr, ty, bits, function.locs[inst]));
                Some(())
            }
            InstData::Load { addr } => {
                let place = self.place(function, addr);
                let result = function.result(inst);
                self.set(result, None);
                if let Some(place) = place {
                    self.loaded.insert(result, place);
                }
                Some(())
            }
            data => {
                for &result in &function.results[inst] {
                    let known = self.computed(function, data, function.ty(result));
                    self.set(result, known);
                }
                Some(())
            }
        }
    }

    fn computed(&self, function: &Function, data: &InstData, ty: Type) -> Option<Known> {
        let number = |value: Value| self.number(function, value);
        Some(match *data {
            InstData::Const { bits } => Known::number(bits),
            InstData::Binary { op: BinaryOp::Iadd, args: [a, b] } if ty == Type::I32 => {
                let [a, b] = [self.get(function, a)?, self.get(function, b)?];
                if a.from.is_some() && b.from.is_some() {
                    return None;
                }
                Known { from: a.from.or(b.from), bits: eval::mask(ty, a.bits.wrapping_add(b.bits)) }
            }
            InstData::Binary { op, args: [a, b] } => Known::number(eval::binary(op, ty, number(a)?, number(b)?)?),
            InstData::IntCompare { cc, args: [a, b] } => {
                Known::number(u64::from(eval::int_compare(cc, function.ty(a), number(a)?, number(b)?)))
            }
            InstData::Convert { op, arg } if ty.is_int() && function.ty(arg).is_int() => {
                Known::number(eval::convert(op, function.ty(arg), ty, number(arg)?))
            }
            InstData::Select { cond, if_true, if_false } => {
                let chosen = if number(cond)? & 1 != 0 { if_true } else { if_false };
                self.get(function, chosen)?
            }
            _ => return None,
        })
    }

    /// The place of an address, if it is known.
    fn place(&self, function: &Function, addr: &Address) -> Option<Place> {
        let base = match addr.base {
            Some(base) => self.get(function, base)?,
            None => Known::number(0),
        };
        let bytes = eval::signed(Type::I32, base.bits);
        Some(Place { region: addr.region, from: base.from, at: bytes + i64::from(addr.offset) })
    }

    /// The store of an element.
    fn write(&mut self, function: &Function, inst: Inst, addr: &Address, value: Value) -> Option<()> {
        let value = function.resolve(value);
        let to = self.place(function, addr)?;
        let written = match self.loaded.get(&value) {
            Some(&from) => Written::From(from),
            None => (self.number(function, value)? == 0).then_some(Written::Zero)?,
        };
        self.element_bytes = i64::from(function.ty(value).bytes());
        self.loc = function.locs[inst];
        self.elements.push((to, written));
        Some(())
    }

    /// What the loop does as a whole, if that is one move.
    fn outcome(self, function: &Function, each: &Loop) -> Option<Outcome> {
        let bytes = self.element_bytes;
        let len = bytes * self.elements.len() as i64;
        let &(to, written) = self.elements.first()?;
        let &(second, _) = self.elements.get(1)?;
        let by = second.at - to.at;
        if len < BYTES_MIN || by.abs() != bytes {
            return None;
        }
        let after = |place: Place, index: usize| Place { at: place.at + by * index as i64, ..place };
        let in_a_row = self.elements.iter().enumerate().all(|(index, &(own, what))| {
            own == after(to, index)
                && match (written, what) {
                    (Written::Zero, Written::Zero) => true,
                    (Written::From(first), Written::From(from)) => from == after(first, index),
                    _ => false,
                }
        });
        let lowest = |place: Place| after(place, if by < 0 { self.elements.len() - 1 } else { 0 });
        let moved = Moved {
            to: lowest(to),
            from: match written {
                Written::Zero => None,
                Written::From(from) => Some(lowest(from)),
            },
            len: u32::try_from(len).ok()?,
        };
        let overlaps = |a: Place, b: Place, b_len: i64| {
            a.region.may_alias(b.region)
                && (a.region != b.region || a.from != b.from || a.at < b.at + b_len && b.at < a.at + len)
        };
        // A move reads all before it writes: what this loop reads must not have been written.
        let is_move = moved.from.is_none_or(|from| {
            let is_before = if by > 0 { moved.to.at < from.at } else { moved.to.at > from.at };
            let is_same_order = moved.to.region.is_host_order() == from.region.is_host_order();
            let is_apart = !overlaps(moved.to, from, len);
            let reads_ahead = moved.to.region == from.region && moved.to.from == from.from && is_before;
            is_same_order && (is_apart || reads_ahead)
        });
        let is_apart = self.last.iter().all(|(addr, ty, ..)| {
            let place = Place { region: addr.region, from: None, at: addr.offset.into() };
            let own = i64::from(ty.bytes());
            !overlaps(moved.to, place, own) && moved.from.is_none_or(|from| !overlaps(from, place, own))
        });
        if !in_a_row || !is_move || !is_apart {
            return None;
        }
        let mut values = Vec::new();
        for value in self.used_after(function, each) {
            values.push((value, self.get(function, value)?));
        }
        Some(Outcome { enter: self.enter, moved, loc: self.loc, last: self.last, exit: self.exit, values })
    }

    /// The values of the loop that are used after it, in the order of their uses.
    fn used_after(&self, function: &Function, each: &Loop) -> Vec<Value> {
        let mut used = Vec::new();
        let mut note = |value: Value| {
            let value = function.resolve(value);
            if self.own.contains(&value) && !used.contains(&value) {
                used.push(value);
            }
        };
        self.exit.args.iter().copied().for_each(&mut note);
        for block in function.layout.iter().filter(|block| !each.blocks.contains(block)) {
            for &inst in &function.blocks[*block].insts {
                function.insts[inst].for_each_use(&mut note);
            }
        }
        used
    }
}

/// Puts one block in the place of a loop.
fn replace(function: &mut Function, each: &Loop, found: Outcome) {
    let Outcome { enter, moved, loc, last, mut exit, values } = found;
    let block = function.add_block();
    let mut made = Made { function, block, loc };
    let to = made.address(moved.to);
    let data = match moved.from {
        Some(from) => InstData::Copy { to, from: made.address(from), len: moved.len },
        None => InstData::Clear { addr: to, len: moved.len },
    };
    made.push(data, &[]);
    for (addr, ty, bits, loc) in last {
        let value = made.constant(ty, bits);
        Made { function: made.function, block, loc }.push(InstData::Store { addr, value }, &[]);
    }
    let mut after: FxHashMap<Value, Value> = FxHashMap::default();
    for (value, Known { from, bits }) in values {
        let ty = made.function.ty(value);
        let now = match from {
            Some(from) => made.sum(from, bits),
            None => made.constant(ty, bits),
        };
        after.insert(value, now);
    }
    let function = made.function;
    let now = |function: &Function, value: Value| {
        let value = function.resolve(value);
        after.get(&value).copied().unwrap_or(value)
    };
    for arg in &mut exit.args {
        *arg = now(function, *arg);
    }
    let others: Vec<Block> = function.layout.iter().copied().filter(|other| !each.blocks.contains(other)).collect();
    for other in others {
        for inst in function.blocks[other].insts.clone() {
            let mut data = std::mem::replace(&mut function.insts[inst], InstData::Const { bits: 0 });
            data.map_uses(|value| now(function, value));
            function.insts[inst] = data;
        }
    }
    Made { function: &mut *function, block, loc }.push(InstData::Jump { target: exit }, &[]);
    let entering = function.terminator(enter).expect("it jumps to the loop");
    function.insts[entering].for_each_target_mut(|call| {
        if call.block == each.header {
            *call = BlockCall { block, args: Values::new() };
        }
    });
    // `add_block` has laid it out last.
    let place = function.layout.iter().position(|&other| other == each.header).unwrap_or(0);
    function.layout.retain(|&other| other != block);
    function.layout.insert(place, block);
}

/// The block that is made.
struct Made<'f> {
    function: &'f mut Function,
    block: Block,
    loc: Loc,
}

impl Made<'_> {
    fn push(&mut self, data: InstData, types: &[Type]) -> Inst {
        let inst = self.function.make_inst(data, types, self.loc);
        self.function.blocks[self.block].insts.push(inst);
        inst
    }

    fn constant(&mut self, ty: Type, bits: u64) -> Value {
        let inst = self.push(InstData::Const { bits: eval::mask(ty, bits) }, &[ty]);
        self.function.result(inst)
    }

    fn sum(&mut self, from: Value, bits: u64) -> Value {
        if eval::mask(Type::I32, bits) == 0 {
            return from;
        }
        let by = self.constant(Type::I32, bits);
        let inst = self.push(InstData::Binary { op: BinaryOp::Iadd, args: [from, by] }, &[Type::I32]);
        self.function.result(inst)
    }

    fn address(&mut self, place: Place) -> Address {
        match place.from {
            Some(from) => Address::indexed(place.region, self.sum(from, place.at as u64), 0),
            None => Address::direct(place.region, place.at as u32),
        }
    }
}
