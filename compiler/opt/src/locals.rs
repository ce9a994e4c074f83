//! Local data that no other block can reach becomes values.
//!
//! STL keeps its loop counters and intermediate results in temporary variables, so that each pass of a loop would write and
//! read memory. Where only the function itself reaches its frame, and a place is always accessed with the same offset and
//! width, the place is a variable: a value that needs no memory at all.
//!
//! ```text
//! b1:
//!     v1 = load.i16 L 20
//!     v2 = iadd v1, 1        ; b1(v1: i16):
//!     store.i16 L 20, v2     ;     v2 = iadd v1, 1
//!     jump b1                ;     jump b1(v2)
//! ```

use plcc_ir::{Address, ConvertOp, Function, Inst, InstData, Loc, Region, Type, Value};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::frames::Frames;
use crate::surroundings::Surroundings;
use crate::variables::{Action, promote};

/// Promotes local data of a function. Result: whether there were any.
pub fn promote_locals(function: &mut Function, surroundings: &Surroundings) -> bool {
    is_unreachable_from_outside(function, &surroundings.frames(function)) && promote_in_function(function)
}

/// True if nothing but accesses to `L` with constant addresses reaches the frame.
fn is_unreachable_from_outside(function: &Function, frames: &Frames<'_>) -> bool {
    let is_harmless = |inst: &InstData| match inst {
        InstData::Call { callee, .. } => !frames.call_touches(*callee),
        InstData::FrameBase { .. } => false,
        InstData::AddressOf { addr } => addr.region != Region::L,
        data => {
            let mut direct = true;
            data.for_each_address(|addr| direct &= addr.region != Region::L || addr.base.is_none());
            direct
        }
    };
    let mut insts = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    frames.is_private() && insts.all(|&inst| is_harmless(&function.insts[inst]))
}

/// How a byte of the frame is accessed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    /// As part of a value of so many bytes from this offset on.
    Value(u32, u32),
    Bits,
    /// In several ways.
    Mixed,
}

/// A place that becomes a variable: offset in the frame, and width or bit.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Slot {
    Value(u32, u32),
    Bit(u32, u8),
}

fn promote_in_function(function: &mut Function) -> bool {
    let uses = uses(function);
    let mut slots: FxHashMap<Slot, usize> = FxHashMap::default();
    let mut types = Vec::new();
    let slot_of = |addr: &Address, ty: Type, bit: Option<u8>| -> Option<Slot> {
        if addr.region != Region::L {
            return None;
        }
        match (bit, uses.get(&addr.offset)?) {
            (Some(bit), Use::Bits) => Some(Slot::Bit(addr.offset, bit)),
            (None, Use::Value(offset, bytes)) if *offset == addr.offset && *bytes == ty.bytes() => {
                Some(Slot::Value(*offset, *bytes))
            }
            _ => None,
        }
    };
    let mut places: Vec<(Inst, usize, Option<Value>)> = Vec::new();
    let mut clears: Vec<(Inst, u32, u32)> = Vec::new();
    for &block in &function.layout {
        for &inst in &function.blocks[block].insts {
            let (slot, stored) = match &function.insts[inst] {
                InstData::Load { addr } => (slot_of(addr, function.ty(function.result(inst)), None), None),
                InstData::LoadBit { addr, bit } => (slot_of(addr, Type::I1, Some(*bit)), None),
                InstData::Store { addr, value } => (slot_of(addr, function.ty(*value), None), Some(*value)),
                InstData::StoreBit { addr, bit, value } => (slot_of(addr, Type::I1, Some(*bit)), Some(*value)),
                InstData::Clear { addr, len } if addr.region == Region::L => {
                    clears.push((inst, addr.offset, *len));
                    continue;
                }
                _ => continue,
            };
            let Some(slot) = slot else { continue };
            let var = *slots.entry(slot).or_insert_with(|| {
                types.push(match slot {
                    Slot::Value(_, bytes) => integer(bytes),
                    Slot::Bit(..) => Type::I1,
                });
                types.len() - 1
            });
            places.push((inst, var, stored));
        }
    }
    // One that is written and never read goes with other dead stores.
    let read: FxHashSet<usize> =
        places.iter().filter(|(_, _, stored)| stored.is_none()).map(|(_, var, _)| *var).collect();
    if read.is_empty() {
        return false;
    }
    let mut actions = same_types(function, &types, places);
    let cleared = clears_of(function, &slots, clears, &mut actions);
    let by_var: FxHashMap<usize, Slot> = slots.iter().map(|(&slot, &var)| (var, slot)).collect();
    let mut initial = |function: &mut Function, var: usize| {
        let (data, ty) = match by_var[&var] {
            Slot::Value(offset, bytes) => (InstData::Load { addr: Address::direct(Region::L, offset) }, integer(bytes)),
            Slot::Bit(offset, bit) => (InstData::LoadBit { addr: Address::direct(Region::L, offset), bit }, Type::I1),
        };
        function.make_inst(data, &[ty], Loc(0))
    };
    let promoted = promote(function, &types, &actions, &mut initial);
    if !promoted {
        cleared.undo(function);
    }
    promoted
}

/// For each byte of the frame, how it is accessed.
fn uses(function: &Function) -> FxHashMap<u32, Use> {
    let mut uses: FxHashMap<u32, Use> = FxHashMap::default();
    let mut note = |offset: u32, bytes: u32, how: Use| {
        for byte in offset..offset.saturating_add(bytes) {
            uses.entry(byte).and_modify(|known| *known = if *known == how { how } else { Use::Mixed }).or_insert(how);
        }
    };
    for &block in &function.layout {
        for &inst in &function.blocks[block].insts {
            let local = |addr: &Address| addr.region == Region::L;
            match &function.insts[inst] {
                InstData::Load { addr } if local(addr) => {
                    let bytes = function.ty(function.result(inst)).bytes();
                    note(addr.offset, bytes, Use::Value(addr.offset, bytes));
                }
                InstData::Store { addr, value } if local(addr) => {
                    let bytes = function.ty(*value).bytes();
                    note(addr.offset, bytes, Use::Value(addr.offset, bytes));
                }
                InstData::LoadBit { addr, .. } | InstData::StoreBit { addr, .. } if local(addr) => {
                    note(addr.offset, 1, Use::Bits);
                }
                InstData::Copy { to, from, len } => {
                    for addr in [to, from].into_iter().filter(|addr| local(addr)) {
                        note(addr.offset, *len, Use::Mixed);
                    }
                }
                _ => {}
            }
        }
    }
    // A value is whole only if all of its bytes are used as its parts.
    let torn: Vec<u32> = uses
        .values()
        .filter_map(|how| match *how {
            Use::Value(offset, bytes) => {
                (offset..offset + bytes).any(|byte| uses.get(&byte) != Some(how)).then_some(offset)
            }
            _ => None,
        })
        .collect();
    for offset in torn {
        uses.insert(offset, Use::Mixed);
    }
    // A clear that ends inside a value takes it apart.
    for &block in &function.layout {
        for &inst in &function.blocks[block].insts {
            let InstData::Clear { addr, len } = &function.insts[inst] else { continue };
            for edge in [addr.offset, addr.offset.saturating_add(*len)] {
                if let (Region::L, Some(&Use::Value(offset, _))) = (addr.region, uses.get(&edge))
                    && offset < edge
                {
                    uses.insert(offset, Use::Mixed);
                }
            }
        }
    }
    uses
}

/// The integer of so many bytes, as which a variable is kept.
fn integer(bytes: u32) -> Type {
    match bytes {
        1 => Type::I8,
        2 => Type::I16,
        4 => Type::I32,
        _ => Type::I64,
    }
}

/// The actions of accesses; floats are converted on the way.
fn same_types(
    function: &mut Function,
    types: &[Type],
    places: Vec<(Inst, usize, Option<Value>)>,
) -> FxHashMap<Inst, Action> {
    let mut actions = FxHashMap::default();
    let mut before: FxHashMap<Inst, Inst> = FxHashMap::default();
    for (inst, var, stored) in places {
        let (ty, loc) = (types[var], function.locs[inst]);
        match stored {
            Some(value) if function.ty(value) == ty => {
                actions.insert(inst, Action::Write(var, value));
            }
            Some(value) => {
                let cast = function.make_inst(InstData::Convert { op: ConvertOp::Bitcast, arg: value }, &[ty], loc);
                before.insert(inst, cast);
                actions.insert(inst, Action::Write(var, function.result(cast)));
            }
            None if function.ty(function.result(inst)) == ty => {
                actions.insert(inst, Action::Read(var));
            }
            None => {
                // The load is one of the integer, whose bits are the float.
                let float = function.ty(function.result(inst));
                let load = function.make_inst(function.insts[inst].clone(), &[ty], loc);
                let bits = function.result(load);
                function.insts[inst] = InstData::Convert { op: ConvertOp::Bitcast, arg: bits };
                debug_assert!(!float.is_int());
                before.insert(inst, load);
                actions.insert(load, Action::Read(var));
            }
        }
    }
    insert_before(function, &before);
    actions
}

/// Puts instructions before others.
fn insert_before(function: &mut Function, before: &FxHashMap<Inst, Inst>) {
    if before.is_empty() {
        return;
    }
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        let insts = std::mem::take(&mut function.blocks[block].insts);
        let with = |inst: Inst| before.get(&inst).copied().into_iter().chain([inst]);
        function.blocks[block].insts = insts.into_iter().flat_map(with).collect();
    }
}

/// Instructions that stand for the effect of clears on variables, and clears that they can be instead.
struct Cleared(Vec<(Inst, InstData)>);

impl Cleared {
    fn undo(self, function: &mut Function) {
        for (inst, data) in self.0 {
            function.insts[inst] = data;
        }
    }
}

/// A clear makes the variables in its range 0.
fn clears_of(
    function: &mut Function,
    slots: &FxHashMap<Slot, usize>,
    clears: Vec<(Inst, u32, u32)>,
    actions: &mut FxHashMap<Inst, Action>,
) -> Cleared {
    let mut cleared = Cleared(Vec::new());
    let mut before = FxHashMap::default();
    for (inst, offset, len) in clears {
        let end = offset.saturating_add(len);
        let mut vars = Vec::new();
        for (slot, &var) in slots {
            let (start, bytes) = match *slot {
                Slot::Value(start, bytes) => (start, bytes),
                Slot::Bit(start, _) => (start, 1),
            };
            if offset <= start && start + bytes <= end {
                vars.push(var);
            } else {
                // A part of a value would be cleared: the caller's check of uses excludes it.
                debug_assert!(start + bytes <= offset || end <= start);
            }
        }
        if vars.is_empty() {
            continue;
        }
        vars.sort_unstable();
        // The memory is cleared as before; where nothing reads it, that is a dead store.
        let loc = function.locs[inst];
        let zero = function.make_inst(InstData::Clear { addr: Address::direct(Region::L, offset), len: 0 }, &[], loc);
        before.insert(inst, zero);
        actions.insert(zero, Action::Clear(vars));
        cleared.0.push((zero, InstData::Clear { addr: Address::direct(Region::L, offset), len }));
    }
    insert_before(function, &before);
    cleared
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn a_counter_in_local_data_is_a_value() {
        check_pass(
            "locals",
            "func @F -> i16 frame 16 {
            b0:
            clear L 0, 16
            v0 = const.f32 0x3f800000
            store.f32 L 4, v0
            jump b1
            b1:
            v1 = load.i16 L 2
            v2 = const.i16 1
            v3 = iadd v1, v2
            store.i16 L 2, v3
            v4 = const.i16 9
            v5 = slt v3, v4
            branch v5, b1, b2
            b2:
            v6 = load.i16 L 2
            v7 = load.i32 L 4
            v8 = load.i8 L 8
            v9 = load.i8 L 9
            ret v6
            }",
            "func @F -> i16 frame 16 {
            b0:
            v0 = const.i32 0
            v1 = const.i16 0
            v2 = const.i8 0
            clear L 0, 16
            v3 = const.f32 0x3f800000
            v4 = bitcast.i32 v3
            jump b1(v1)
            b1(v5: i16):
            v6 = const.i16 1
            v7 = iadd v5, v6
            v8 = const.i16 9
            v9 = slt v7, v8
            branch v9, b1(v7), b2
            b2:
            ret v7
            }",
        );
    }

    #[test]
    fn a_place_that_is_accessed_in_two_ways_stays_in_memory() {
        let text = "func @F -> i16 frame 16 {
            b0(v0: i32):
            store.i32 L 4, v0
            v1 = load.i16 L 6
            ret v1
            }";
        check_pass("locals", text, text);
    }

    #[test]
    fn bits_are_variables_of_their_own() {
        check_pass(
            "locals",
            "func @F -> i1 frame 16 {
            b0(v0: i1, v1: i1):
            store.bit L 4.0, v0
            store.bit L 4.1, v1
            v2 = load.bit L 4.0
            v3 = load.bit L 4.2
            v4 = and v2, v3
            ret v4
            }",
            "func @F -> i1 frame 16 {
            b0(v0: i1, v1: i1):
            v2 = load.bit L 4.2
            v3 = and v0, v2
            ret v3
            }",
        );
    }
}
