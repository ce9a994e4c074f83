//! Bits of one word that are written one after the other become one store.
//!
//! Within a block the bits that are written to a word, or to a byte where that is enough (see [`Words`]), are collected in a register and
//! stored when it may be read: at an access that overlaps, at a call, and at the end of the block. Until then a bit that is written
//! again replaces itself.
//!
//! ```text
//! store.bit M 4.0, v1        ; v3 = zext.i32 v1
//!                            ; v4 = shl v3, 24
//! store.bit M 5.3, v2        ; v5 = zext.i32 v2
//!                            ; v6 = shl v5, 19
//!                            ; v7 = or v4, v6
//! ret                        ; v8 = load.i32 M 4
//!                            ; v9 = and v8, 16#FEF7_FFFF
//!                            ; v10 = or v9, v7
//!                            ; store.i32 M 4, v10
//!                            ; ret
//! ```
//!
//! Bits that were taken out of one value, and go as far from their places there, are taken and moved together:
//!
//! ```text
//! v1 = trunc.i1 v0           ; v3 = and v0, 3
//! v2 = lshr v0, 1            ; v4 = load.i8 M 4
//! v3 = trunc.i1 v2           ; v5 = and v4, 16#FC
//! store.bit M 4.0, v1        ; v6 = or v5, v3
//! store.bit M 4.1, v3        ; store.i8 M 4, v6
//! ```
//!
//! At most [`OPEN_MAX`] words are collected at a time, so that they fit into registers.

use plcc_abi::functions::Effect;
use plcc_ir::{Address, BinaryOp, Block, ConvertOp, Function, Inst, InstData, Loc, Type, Value};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::surroundings::Surroundings;
use crate::words::Words;

/// Words that are collected at the same time.
const OPEN_MAX: usize = 8;

/// Merges the stores of bits in a function. Result: whether there were any.
pub fn merge_bits(function: &mut Function, surroundings: &Surroundings) -> bool {
    let mut changed = false;
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        let words = Words::of(function, &function.blocks[block].insts, &surroundings.dbs);
        let groups = groups(function, block, &words);
        if !groups.is_empty() {
            rewrite(function, block, groups);
            changed = true;
        }
    }
    changed
}

/// Stores of bits that become one store.
struct Group {
    addr: Address,
    ty: Type,
    /// The stores, and the number of the bit that each writes in the value.
    stores: Vec<(Inst, u32)>,
    /// Stores of bits that are written again.
    dead: Vec<Inst>,
    /// Position in the block of the instruction before which the store comes.
    end: usize,
}

impl Group {
    fn overlaps(&self, addr: &Address, bytes: u32) -> bool {
        let (start, end) = (u64::from(addr.offset), u64::from(addr.offset) + u64::from(bytes));
        let (own_start, own_end) =
            (u64::from(self.addr.offset), u64::from(self.addr.offset) + u64::from(self.ty.bytes()));
        if (addr.region, addr.base) == (self.addr.region, self.addr.base) {
            own_start < end && start < own_end
        } else {
            addr.region.may_alias(self.addr.region)
        }
    }

    /// False for one store of a bit in its byte, which is as good by itself.
    fn is_worth_it(&self) -> bool {
        self.ty != Type::I8 || self.stores.len() > 1 || !self.dead.is_empty()
    }
}

/// The groups of a block, by their ends.
fn groups(function: &Function, block: Block, words: &Words<'_>) -> Vec<Group> {
    let mut open: Vec<Group> = Vec::new();
    let mut done: Vec<Group> = Vec::new();
    for (position, &inst) in function.blocks[block].insts.iter().enumerate() {
        let mut close = |open: &mut Vec<Group>, ends: &dyn Fn(&Group) -> bool| {
            for mut group in open.extract_if(.., |group| ends(group)) {
                group.end = position;
                done.push(group);
            }
        };
        match &function.insts[inst] {
            InstData::StoreBit { addr, bit, .. } if !addr.region.is_host_order() => {
                let word = words.around(addr);
                let (start, ty) = word.map_or((*addr, Type::I8), |word| (word, Type::I32));
                let number = (start.offset + ty.bytes() - 1 - addr.offset) * 8 + u32::from(*bit);
                close(&mut open, &|group| group.addr != start && group.overlaps(addr, 1));
                let index = open.iter().position(|group| group.addr == start).unwrap_or_else(|| {
                    open.push(Group { addr: start, ty, stores: Vec::new(), dead: Vec::new(), end: 0 });
                    open.len() - 1
                });
                let mut group = open.remove(index);
                if let Some(again) = group.stores.iter().position(|&(_, other)| other == number) {
                    group.dead.push(group.stores.remove(again).0);
                }
                group.stores.push((inst, number));
                open.push(group);
                if open.len() > OPEN_MAX {
                    let oldest = open[0].addr;
                    close(&mut open, &|group| group.addr == oldest);
                }
            }
            InstData::LoadBit { addr, .. } | InstData::StoreBit { addr, .. } => {
                close(&mut open, &|group| group.overlaps(addr, 1));
            }
            InstData::Load { addr } => {
                let bytes = function.ty(function.result(inst)).bytes();
                close(&mut open, &|group| group.overlaps(addr, bytes));
            }
            InstData::Store { addr, value } => {
                let bytes = function.ty(*value).bytes();
                close(&mut open, &|group| group.overlaps(addr, bytes));
            }
            InstData::Clear { addr, len } => close(&mut open, &|group| group.overlaps(addr, *len)),
            InstData::Copy { to, from, len } => {
                close(&mut open, &|group| group.overlaps(to, *len) || group.overlaps(from, *len));
            }
            InstData::CallRuntime { function, .. } if matches!(function.effect(), Effect::Pure | Effect::Cells) => {}
            InstData::CallRuntime { .. }
            | InstData::Call { .. }
            | InstData::Jump { .. }
            | InstData::Branch { .. }
            | InstData::Switch { .. }
            | InstData::Return { .. } => close(&mut open, &|_| true),
            InstData::Const { .. }
            | InstData::Unary { .. }
            | InstData::Binary { .. }
            | InstData::IntCompare { .. }
            | InstData::FloatCompare { .. }
            | InstData::Convert { .. }
            | InstData::Select { .. }
            | InstData::AddressOf { .. }
            | InstData::DbBase { .. }
            | InstData::DbLength { .. }
            | InstData::FrameBase { .. } => {}
        }
    }
    done.retain(Group::is_worth_it);
    done
}

/// Bits of one value that go to the same distance from their places there.
#[derive(Clone, Copy)]
struct Piece {
    from: Value,
    /// Shifts to the left, if it is positive.
    distance: i32,
    /// The bits, where they go to.
    mask: u64,
    /// The first of them.
    first: Value,
}

/// What a group has collected.
#[derive(Clone, Default)]
struct Collected {
    /// The bits that are variable, in place; all others are 0.
    bits: Option<Value>,
    pieces: Vec<Piece>,
    /// The bits that are 1.
    ones: u64,
    /// All bits that were written.
    mask: u64,
}

impl Collected {
    fn add(&mut self, from: Value, distance: i32, bit: u64, first: Value) {
        match self.pieces.iter_mut().find(|piece| (piece.from, piece.distance) == (from, distance)) {
            Some(piece) => piece.mask |= bit,
            None => self.pieces.push(Piece { from, distance, mask: bit, first }),
        }
    }
}

fn rewrite(function: &mut Function, block: Block, groups: Vec<Group>) {
    let of_store: FxHashMap<Inst, (usize, u32)> = groups
        .iter()
        .enumerate()
        .flat_map(|(index, group)| group.stores.iter().map(move |&(inst, number)| (inst, (index, number))))
        .collect();
    let dead: FxHashSet<Inst> = groups.iter().flat_map(|group| group.dead.iter().copied()).collect();
    let mut collected = vec![Collected::default(); groups.len()];
    let mut ends = groups.iter().enumerate().peekable();
    let insts = std::mem::take(&mut function.blocks[block].insts);
    let mut out = Out { function, insts: Vec::with_capacity(insts.len()), loaded: Vec::new(), loc: Loc(0) };
    for (position, inst) in insts.into_iter().enumerate() {
        while let Some((index, group)) = ends.next_if(|(_, group)| group.end == position) {
            out.store(group, std::mem::take(&mut collected[index]));
        }
        if dead.contains(&inst) {
            continue;
        }
        match of_store.get(&inst) {
            Some(&(index, number)) => out.collect(inst, &mut collected[index], groups[index].ty, number),
            None => {
                out.note(inst);
                out.insts.push(inst);
            }
        }
    }
    let insts = out.insts;
    function.blocks[block].insts = insts;
}

struct Out<'f> {
    function: &'f mut Function,
    insts: Vec<Inst>,
    /// What was loaded last, and is still there, and after how many instructions.
    loaded: Vec<(Address, Value, usize)>,
    loc: Loc,
}

/// Loads that are remembered.
const LOADED_MAX: usize = 8;
/// Instructions after a load in which it is not made again: later it would rather go to the stack and come back.
const NEAR: usize = 24;

/// The value of which an i1 is a bit, and its number there.
fn bit_of(function: &Function, value: Value) -> Option<(Value, u32)> {
    let &InstData::Convert { op: ConvertOp::Trunc, arg } = function.defining(value)? else { return None };
    let (from, number) = match function.defining(arg) {
        Some(&InstData::Binary { op: BinaryOp::Lshr, args: [x, count] }) => match function.constant(count) {
            Some(count) if count < u64::from(function.ty(x).bits()) => (x, count as u32),
            _ => (arg, 0),
        },
        _ => (arg, 0),
    };
    Some((function.resolve(from), number))
}

/// True if an access may touch memory of a load.
fn overlap(function: &Function, (addr, value): (Address, Value), other: &Address, bytes: u32) -> bool {
    if (addr.region, addr.base) == (other.region, other.base) {
        let (start, end) = (u64::from(addr.offset), u64::from(addr.offset) + u64::from(function.ty(value).bytes()));
        u64::from(other.offset) < end && start < u64::from(other.offset) + u64::from(bytes)
    } else {
        addr.region.may_alias(other.region)
    }
}

impl Out<'_> {
    fn emit(&mut self, data: InstData, ty: Type) -> Value {
        let inst = self.function.make_inst(data, &[ty], self.loc);
        self.insts.push(inst);
        self.function.result(inst)
    }

    fn constant(&mut self, bits: u64, ty: Type) -> Value {
        self.emit(InstData::Const { bits }, ty)
    }

    /// An instruction is next: remembers what it loads, and forgets what it may write.
    fn note(&mut self, inst: Inst) {
        let function = &*self.function;
        let written = match &function.insts[inst] {
            InstData::Load { addr } => {
                let value = function.result(inst);
                if matches!(function.ty(value), Type::I8 | Type::I32) {
                    if self.loaded.len() == LOADED_MAX {
                        self.loaded.remove(0);
                    }
                    self.loaded.push((*addr, value, self.insts.len()));
                }
                return;
            }
            InstData::Store { addr, value } => Some((addr, function.ty(*value).bytes())),
            InstData::StoreBit { addr, .. } => Some((addr, 1)),
            InstData::Clear { addr, len } | InstData::Copy { to: addr, len, .. } => Some((addr, *len)),
            InstData::CallRuntime { function, .. } if matches!(function.effect(), Effect::Pure | Effect::Cells) => {
                return;
            }
            InstData::Call { .. } | InstData::CallRuntime { .. } => None,
            _ => return,
        };
        match written {
            Some((addr, bytes)) => {
                self.loaded.retain(|&(load, value, _)| !overlap(function, (load, value), addr, bytes))
            }
            None => self.loaded.clear(),
        }
    }

    fn binary(&mut self, op: BinaryOp, args: [Value; 2], ty: Type) -> Value {
        self.emit(InstData::Binary { op, args }, ty)
    }

    /// Adds the bit that `store` writes.
    fn collect(&mut self, store: Inst, collected: &mut Collected, ty: Type, number: u32) {
        let InstData::StoreBit { value, .. } = self.function.insts[store] else { return };
        self.loc = self.function.locs[store];
        collected.mask |= 1 << number;
        match self.function.constant(value) {
            Some(bits) => collected.ones |= bits << number,
            None => match bit_of(self.function, value) {
                Some((from, bit)) => collected.add(from, number as i32 - bit as i32, 1 << number, value),
                None => {
                    let placed = self.placed_bit(value, number, ty);
                    collected.bits = Some(match collected.bits {
                        Some(bits) => self.binary(BinaryOp::Or, [bits, placed], ty),
                        None => placed,
                    });
                }
            },
        }
    }

    /// A bit in its place; all others are 0.
    fn placed_bit(&mut self, bit: Value, number: u32, ty: Type) -> Value {
        let bit = self.emit(InstData::Convert { op: ConvertOp::Zext, arg: bit }, ty);
        self.shifted(bit, number as i32)
    }

    fn shifted(&mut self, value: Value, distance: i32) -> Value {
        if distance == 0 {
            return value;
        }
        let ty = self.function.ty(value);
        let op = if distance > 0 { BinaryOp::Shl } else { BinaryOp::Lshr };
        let count = self.constant(u64::from(distance.unsigned_abs()), ty);
        self.binary(op, [value, count], ty)
    }

    /// The bits of a piece, in place; all others are 0.
    fn placed(&mut self, piece: Piece, ty: Type) -> Value {
        let from = self.function.ty(piece.from);
        let is_wider = from.bits() > ty.bits();
        if is_wider && piece.mask.is_power_of_two() {
            // It was taken out of the word anyway, for whatever else it is used.
            return self.placed_bit(piece.first, piece.mask.trailing_zeros(), ty);
        }
        let mut bits = piece.from;
        let (before, after) =
            if is_wider { (piece.distance.min(0), piece.distance.max(0)) } else { (0, piece.distance) };
        bits = self.shifted(bits, before);
        if from != ty {
            let op = if is_wider { ConvertOp::Trunc } else { ConvertOp::Zext };
            bits = self.emit(InstData::Convert { op, arg: bits }, ty);
        }
        bits = self.shifted(bits, after);
        let mask = self.constant(piece.mask, ty);
        self.binary(BinaryOp::And, [bits, mask], ty)
    }

    /// Stores what was collected.
    fn store(&mut self, group: &Group, collected: Collected) {
        let ty = group.ty;
        let all = u64::MAX >> (64 - ty.bits());
        let mut parts = Vec::new();
        if collected.mask != all {
            let now = self.insts.len();
            let is_old = |&&(addr, value, at): &&(Address, Value, usize)| {
                addr == group.addr && self.function.ty(value) == ty && now - at <= NEAR
            };
            let loaded = self.loaded.iter().find(is_old).map(|&(_, value, _)| value);
            let old = loaded.unwrap_or_else(|| self.emit(InstData::Load { addr: group.addr }, ty));
            let others = self.constant(all & !collected.mask, ty);
            parts.push(self.binary(BinaryOp::And, [old, others], ty));
        }
        if collected.ones != 0 {
            parts.push(self.constant(collected.ones, ty));
        }
        parts.extend(collected.bits);
        for piece in collected.pieces {
            parts.push(self.placed(piece, ty));
        }
        let value = parts.into_iter().reduce(|a, b| self.binary(BinaryOp::Or, [a, b], ty));
        let value = value.unwrap_or_else(|| self.constant(0, ty));
        let inst = self.function.make_inst(InstData::Store { addr: group.addr, value }, &[], self.loc);
        self.note(inst);
        self.insts.push(inst);
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::{check_body, check_pass};

    fn check(body: &str, expected: &str) {
        check_body("merge-bits", body, expected);
    }

    const TWO_BYTES: &str = "v2 = zext.i32 v1\nv3 = const.i32 24\nv4 = shl v2, v3\nv5 = zext.i32 v1\nv6 = const.i32 19\nv7 = shl v5, v6\n\
                             v8 = or v4, v7\n";
    const STORED: &str =
        "v9 = load.i32 M 4\nv10 = const.i32 4277665791\nv11 = and v9, v10\nv12 = or v11, v8\nstore.i32 M 4, v12\n";

    #[test]
    fn bits_of_a_word_are_stored_at_the_end() {
        check("store.bit M 4.0, v1\nstore.bit M 5.3, v1\nret v0", &format!("{TWO_BYTES}{STORED}ret v0"));
    }

    #[test]
    fn who_looks_sees_the_bits() {
        for look in [
            "v20 = load.i16 M 6",
            "v20 = load.bit M 4.1",
            "v20 = load.i8 any[v0]+0",
            "call @G()",
            "store.i32 M 2, v0",
            "copy Q 0, M 4, 1",
        ] {
            check(
                &format!("store.bit M 4.0, v1\nstore.bit M 5.3, v1\n{look}\nret v0"),
                &format!("{TWO_BYTES}{STORED}{look}\nret v0"),
            );
        }
    }

    #[test]
    fn others_may_look_elsewhere() {
        for look in ["v20 = load.i8 M 8", "v20 = load.i8 anydb[v0]+0", "store.i32 Q 4, v0"] {
            check(
                &format!("store.bit M 4.0, v1\nstore.bit M 5.3, v1\n{look}\nret v0"),
                &format!("{TWO_BYTES}{look}\n{STORED}ret v0"),
            );
        }
    }

    #[test]
    fn a_bit_that_is_written_again_replaces_itself() {
        check(
            "v2 = load.bit Q 0.0\nstore.bit M 4.0, v1\nstore.bit M 5.3, v1\nstore.bit M 4.0, v2\nret v0",
            "v2 = load.bit Q 0.0\nv3 = zext.i32 v1\nv4 = const.i32 19\nv5 = shl v3, v4\nv6 = zext.i32 v2\nv7 = const.i32 \
             24\nv8 = shl v6, v7\nv9 = or v5, v8\nv10 = load.i32 M 4\nv11 = const.i32 4277665791\nv12 = and v10, v11\nv13 = or v12, \
             v9\nstore.i32 M 4, v13\nret v0",
        );
    }

    #[test]
    fn a_word_stays_inside_its_data_block() {
        let around = |body: &str| {
            format!("db 5 at 0x400000 length 19\nfunc @F {{\nb0(v0: i1):\n{body}\nret\n}}\nfunc @G {{\nb0:\nret\n}}\n")
        };
        let same = around("store.bit DB5 17.0, v0\nstore.bit DB5 18.0, v0");
        check_pass("merge-bits", &same, &same);
        let stores = around("v1 = const.i1 1\nstore.bit DB5 12.0, v1\nstore.bit DB5 13.0, v1");
        let store = around(
            "v1 = const.i1 1\nv2 = load.i32 DB5 12\nv3 = const.i32 4278124543\nv4 = and v2, v3\nv5 = const.i32 16842752\nv6 = or v4, \
             v5\nstore.i32 DB5 12, v6",
        );
        check_pass("merge-bits", &stores, &store);
    }

    #[test]
    fn bits_of_one_byte_move_together() {
        check(
            "v2 = load.i8 M 9\nv3 = trunc.i1 v2\nv4 = const.i8 1\nv5 = lshr v2, v4\nv6 = trunc.i1 v5\nv7 = const.i8 6\nv8 = lshr v2, \
             v7\nv9 = trunc.i1 v8\nstore.bit Q 4.0, v3\nstore.bit Q 4.1, v6\nstore.bit Q 4.2, v9\nret v0",
            "v2 = load.i8 M 9\nv3 = trunc.i1 v2\nv4 = const.i8 1\nv5 = lshr v2, v4\nv6 = trunc.i1 v5\nv7 = const.i8 6\nv8 = lshr v2, \
             v7\nv9 = trunc.i1 v8\nv10 = load.i8 Q 4\nv11 = const.i8 248\nv12 = and v10, v11\nv13 = const.i8 3\nv14 = and v2, \
             v13\nv15 = const.i8 4\nv16 = lshr v2, v15\nv17 = const.i8 4\nv18 = and v16, v17\nv19 = or v12, v14\nv20 = or v19, \
             v18\nstore.i8 Q 4, v20\nret v0",
        );
    }

    #[test]
    fn bits_of_a_word_move_together_into_a_byte() {
        let bits = "v2 = const.i32 24\nv3 = lshr v0, v2\nv4 = trunc.i1 v3\nv5 = const.i32 25\nv6 = lshr v0, v5\nv7 = trunc.i1 v6\n";
        check(
            &format!("{bits}store.bit Q 4.0, v4\nstore.bit Q 4.1, v7\nret v0"),
            &format!(
                "{bits}v8 = load.i8 Q 4\nv9 = const.i8 252\nv10 = and v8, v9\nv11 = const.i32 24\nv12 = lshr v0, v11\nv13 = trunc.i8 \
                 v12\nv14 = const.i8 3\nv15 = and v13, v14\nv16 = or v10, v15\nstore.i8 Q 4, v16\nret v0"
            ),
        );
        // One at a time: what was taken out is used.
        check(
            &format!("{bits}store.bit Q 4.1, v4\nstore.bit Q 4.0, v7\nret v0"),
            &format!(
                "{bits}v8 = load.i8 Q 4\nv9 = const.i8 252\nv10 = and v8, v9\nv11 = zext.i8 v4\nv12 = const.i8 1\nv13 = shl v11, v12\nv14 = \
                 zext.i8 v7\nv15 = or v10, v13\nv16 = or v15, v14\nstore.i8 Q 4, v16\nret v0"
            ),
        );
    }

    #[test]
    fn what_was_loaded_is_not_loaded_again() {
        let text = |between: &str, load: &str, old: &str| {
            format!(
                "v2 = load.i8 Q 4\n{between}v3 = zext.i8 v1\nv4 = const.i8 5\nv5 = shl v3, v4\n{load}v7 = const.i8 95\nv8 = and \
                 {old}, v7\nv9 = or v8, v5\nstore.i8 Q 4, v9\nret v0"
            )
        };
        let from = |between: &str| {
            format!("v2 = load.i8 Q 4\n{between}v6 = const.i1 0\nstore.bit Q 4.5, v1\nstore.bit Q 4.7, v6\nret v0")
        };
        let expected = |between: &str, load: &str, old: &str| text(&format!("{between}v6 = const.i1 0\n"), load, old);
        check(&from("store.i32 Q 8, v0\n"), &expected("store.i32 Q 8, v0\n", "", "v2"));
        let between = "store.i32 any[v0]+8, v0\n";
        check(&from(between), &expected(between, "v10 = load.i8 Q 4\n", "v10"));
    }

    #[test]
    fn one_byte_is_enough() {
        check(
            "v2 = const.i1 0\nstore.bit M 4.0, v1\nstore.bit M 4.7, v2\nret v0",
            "v2 = const.i1 0\nv3 = zext.i8 v1\nv4 = load.i8 M 4\nv5 = const.i8 126\nv6 = and v4, v5\nv7 = or v6, v3\nstore.i8 M \
             4, v7\nret v0",
        );
        let text = "store.bit M 4.0, v1\nstore.bit M 9.0, v1\nret v0";
        check(text, text);
    }
}
