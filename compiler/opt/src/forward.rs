//! Store-to-load forwarding and removal of redundant loads and stores.
//!
//! Walking forward, the pass keeps what is known about memory: ranges of bits that hold a value, or 0 after a `clear`. A load of
//! this range is the value, or a part of it; a store of the same value is removed.
//!
//! ```text
//! store.bit M 10.0, v1
//! v2 = load.bit M 10.0       ; v2 is v1
//! store.i16 DB5 2, v3
//! v4 = load.bit M 10.0       ; v1 again: DB5 is not M
//! v5 = load.bit DB5 3.0      ; bit 0 of v3
//! ```
//!
//! A load of bytes that several stores wrote is put together from their values: a processor would wait for all of them.
//!
//! A copy takes what is known of its source along: the parts of an ANY that a block looks at in a variable of its own.
//!
//! A store invalidates the ranges that it may overlap: in the same region and with the same base the real overlaps; with another
//! base everything in the region and in those that may alias it. A call makes everything unknown, except a private frame
//! (see `frames`) that the callee does not touch.
//!
//! A block with one predecessor begins with the facts at its end; a join with the facts that all predecessors share; a loop
//! head with none. A safepoint or an error makes unknown what other organization blocks write (see `effects`). A cold block that may
//! change all memory but a private frame begins with the facts about that. A block move with a constant destination changes only that. The
//! number of facts is bounded, so time stays linear.

mod memory;
#[cfg(test)]
mod tests;

use plcc_abi::functions::Effect;
use plcc_abi::layout::state;
use plcc_ir::analysis::ControlFlow;
use plcc_ir::entities::EntityVec;
use plcc_ir::{
    Address, BinaryOp, Block, Class, ConvertOp, Function, Inst, InstData, Loc, Region, StaticDb, Type, Value,
};

use crate::block_moves;
use crate::effects::{Effects, is_interruption};
use crate::extents::{Access, Extent};
use crate::frames::Frames;
use crate::surroundings::Surroundings;
use crate::words::Words;
use memory::{Content, Memory};

/// Values from which a load is put together at most.
const PIECES_MAX: usize = 4;
const DB_FACTS_MAX: usize = 32;

/// Forwards memory in a function. Result: whether anything changed.
pub fn forward_memory(function: &mut Function, surroundings: &Surroundings) -> bool {
    forward(function, surroundings, None)
}

/// Forwards memory in a function, and reads bits that nothing is known about with the word or byte around them: bits that
/// are read from one that was loaded early do not wait for what is written to their neighbours.
pub fn read_whole_words(function: &mut Function, surroundings: &Surroundings) -> bool {
    forward(function, surroundings, Some(&surroundings.dbs))
}

fn forward(function: &mut Function, surroundings: &Surroundings, whole_words: Option<&[StaticDb]>) -> bool {
    let (frames, effects) = (&surroundings.frames(function), &surroundings.effects);
    let cfg = ControlFlow::new(function);
    let mut at_end: EntityVec<Block, Option<Box<AtEnd>>> = EntityVec::filled(None, function.blocks.len());
    let cold_takes_frame = frames.is_private() && function.local_bytes() > 0;
    let mut pass = Forward {
        function,
        frames,
        surroundings,
        effects,
        words: None,
        known: Memory::default(),
        out: Vec::new(),
        loc: Loc(0),
        changed: false,
    };
    for &block in &cfg.rpo {
        let takes = |function: &Function, from, to| takes_from(function, &cfg, effects, from, to, cold_takes_frame);
        pass.known = known_at_start(pass.function, &cfg, effects, block, &mut at_end, &takes);
        let mut insts = std::mem::take(&mut pass.function.blocks[block].insts);
        pass.words = whole_words.map(|dbs| Words::of(pass.function, &insts, dbs));
        for &inst in &insts {
            pass.visit(inst);
        }
        insts.clear();
        insts.append(&mut pass.out);
        pass.function.blocks[block].insts = insts;
        let readers = cfg.successors(block).iter().filter(|&&next| takes(pass.function, block, next)).count();
        if readers > 0 {
            at_end[block] = Some(Box::new(AtEnd { memory: std::mem::take(&mut pass.known), readers }));
        }
    }
    let changed = pass.changed;
    if changed {
        function.resolve_aliases();
    }
    changed
}

/// The facts at the end of a block, and how many jumps still have to pass them on.
#[derive(Clone)]
struct AtEnd {
    memory: Memory,
    readers: usize,
}

/// True of a cold block after which only the own frame can still be known. Others ask the runtime for the time or about a timer.
fn forgets(function: &Function, effects: &Effects, block: Block) -> bool {
    let calls_all = |data: &InstData| match data {
        InstData::CallRuntime { function, .. } => {
            function.effect() == Effect::All
                && (!is_interruption(*function) || effects.may_write(*function, Region::M, None))
        }
        data => matches!(data, InstData::Call { .. }),
    };
    let block = &function.blocks[block];
    block.cold && block.insts.iter().any(|&inst| calls_all(&function.insts[inst]))
}

/// True if `next`, which comes later in the walk, begins with the facts at the end of `block`, maybe only those about its own frame.
fn takes_from(
    function: &Function,
    cfg: &ControlFlow,
    effects: &Effects,
    block: Block,
    next: Block,
    cold_takes_frame: bool,
) -> bool {
    (!forgets(function, effects, next) || cold_takes_frame) && cfg.rpo_index(block) < cfg.rpo_index(next)
}

fn known_at_start(
    function: &Function,
    cfg: &ControlFlow,
    effects: &Effects,
    block: Block,
    at_end: &mut EntityVec<Block, Option<Box<AtEnd>>>,
    takes: &dyn Fn(&Function, Block, Block) -> bool,
) -> Memory {
    let is_cold = forgets(function, effects, block);
    let mut known: Option<Memory> = None;
    let mut complete = true;
    for &pred in cfg.predecessors(block) {
        if !takes(function, pred, block) {
            complete = false;
            continue;
        }
        let Some(end) = &mut at_end[pred] else {
            complete = false;
            continue;
        };
        end.readers -= 1;
        let memory = if end.readers == 0 {
            std::mem::take(&mut end.memory)
        } else if is_cold {
            end.memory.frame()
        } else {
            end.memory.bound();
            end.memory.clone()
        };
        if end.readers == 0 {
            at_end[pred] = None;
        }
        match &mut known {
            None => known = Some(memory),
            Some(known) => known.intersect(&memory),
        }
    }
    match known {
        Some(known) if complete && is_cold => known.frame(),
        Some(known) if complete => known,
        _ => Memory::default(),
    }
}

/// The action for an instruction.
enum Step {
    Keep,
    /// It does nothing.
    Drop,
    /// Its result is this value.
    Replace(Value),
}

struct Forward<'a> {
    function: &'a mut Function,
    frames: &'a Frames<'a>,
    surroundings: &'a Surroundings,
    /// Words that are read for their bits, if any are.
    words: Option<Words<'a>>,
    effects: &'a Effects,
    known: Memory,
    out: Vec<Inst>,
    loc: Loc,
    changed: bool,
}

impl Forward<'_> {
    fn visit(&mut self, inst: Inst) {
        let function = &mut *self.function;
        function.resolve_uses(inst);
        if !matches!(function.insts[inst].class(), Class::Memory | Class::Call) {
            self.out.push(inst);
            return;
        }
        self.loc = function.locs[inst];
        let data = std::mem::replace(&mut function.insts[inst], InstData::Const { bits: 0 });
        let step = self.step(inst, &data);
        self.function.insts[inst] = data;
        self.changed |= !matches!(step, Step::Keep);
        match step {
            Step::Keep => self.out.push(inst),
            Step::Drop => {}
            Step::Replace(value) => {
                let result = self.function.result(inst);
                self.function.replace_value(result, value);
            }
        }
    }

    fn step(&mut self, inst: Inst, data: &InstData) -> Step {
        match data {
            InstData::Load { addr } => {
                let result = self.function.result(inst);
                let ty = self.function.ty(result);
                self.load(&Access::of_type(addr, ty), ty, result)
            }
            InstData::LoadBit { addr, bit } => {
                self.read_around(addr, *bit);
                self.load(&Access::bit(addr, *bit), Type::I1, self.function.result(inst))
            }
            InstData::Store { addr, value } => self.store(&Access::of_type(addr, self.function.ty(*value)), *value),
            InstData::StoreBit { addr, bit, value } => {
                self.read_around(addr, *bit);
                self.store(&Access::bit(addr, *bit), *value)
            }
            InstData::Clear { addr, len } => self.clear(addr, *len),
            InstData::Copy { to, from, len } => {
                self.known.copy(&Access::bytes(to, *len), &Access::bytes(from, *len));
                Step::Keep
            }
            InstData::DbBase { number } => self.db_entry(inst, *number, false),
            InstData::DbLength { number } => self.db_entry(inst, *number, true),
            InstData::Call { callee, .. } => {
                let keep_frame = !self.frames.call_touches(*callee);
                self.known.forget_all(keep_frame, self.function);
                Step::Keep
            }
            InstData::CallRuntime { function, .. } => {
                match function.effect() {
                    Effect::Pure | Effect::Reads => {}
                    Effect::Cells => {
                        self.known.regions.remove(&Region::Cells);
                    }
                    Effect::System => {
                        self.known.forget_system(*function, self.effects);
                        self.known.regions.remove(&Region::Any);
                    }
                    Effect::Io => {
                        self.known.regions.remove(&Region::Q);
                        self.known.regions.remove(&Region::Any);
                    }
                    Effect::All if is_interruption(*function) => {
                        self.known.interrupt(*function, self.effects, self.frames.is_private());
                    }
                    Effect::All => self.call_system(data),
                }
                Step::Keep
            }
            InstData::Const { .. }
            | InstData::Unary { .. }
            | InstData::Binary { .. }
            | InstData::IntCompare { .. }
            | InstData::FloatCompare { .. }
            | InstData::Convert { .. }
            | InstData::Select { .. }
            | InstData::AddressOf { .. }
            | InstData::FrameBase { .. }
            | InstData::Jump { .. }
            | InstData::Branch { .. }
            | InstData::Switch { .. }
            | InstData::Return { .. } => Step::Keep,
        }
    }

    /// Forgets what a runtime function changes that may change anything.
    fn call_system(&mut self, data: &InstData) {
        let Some(written) = block_moves::written(self.function, &self.out, data, self.surroundings) else {
            self.known.forget_all(self.frames.is_private(), self.function);
            return;
        };
        self.known.regions.remove(&Region::State);
        for (addr, len) in written {
            self.known.forget(&Access::bytes(&addr, len));
        }
    }

    fn load(&mut self, access: &Access, ty: Type, result: Value) -> Step {
        if is_attention(access) {
            return Step::Keep;
        }
        if let Some(extents) = self.known.find(access)
            && let Some(extent) = extents.covering(access.start, access.end)
        {
            return match self.part_of(extent, access, ty) {
                Some(value) => Step::Replace(value),
                None => Step::Keep,
            };
        }
        if let Some(pieces) = self.pieces(access, ty) {
            return Step::Replace(self.assembled(&pieces, access, ty));
        }
        // Facts about its parts, above all bits, are worth more than the whole.
        self.known.learn(access, result, false);
        Step::Keep
    }

    /// The known values that together are what `access` reads, if one of them was stored.
    fn pieces(&self, access: &Access, ty: Type) -> Option<Vec<Extent<Content>>> {
        if !ty.is_int() || access.region.is_host_order() {
            return None;
        }
        let mut pieces = Vec::new();
        let mut at = access.start;
        let mut is_stored = false;
        for item in self.known.find(access)?.iter_in(access.start, access.end) {
            let (start, end) = (item.start.max(access.start), item.end.min(access.end));
            if start != at || end % 8 != 0 || pieces.len() == PIECES_MAX {
                return None;
            }
            is_stored |= match item.known {
                Content::Zero => true,
                Content::Value { value, .. } if !self.function.ty(value).is_int() => return None,
                Content::Value { stored, .. } => stored,
            };
            pieces.push(Extent { start, end, known: item.known });
            at = end;
        }
        (at == access.end && is_stored).then_some(pieces)
    }

    /// The value of type `ty` of which each of `pieces` is a part.
    fn assembled(&mut self, pieces: &[Extent<Content>], access: &Access, ty: Type) -> Value {
        let mut all: Option<Value> = None;
        for piece in pieces {
            let Content::Value { value, start, end, .. } = piece.known else { continue };
            let value = self.function.resolve(value);
            let whole = self.function.ty(value);
            let mut part = self.shifted(BinaryOp::Lshr, value, whole, end - piece.end);
            if whole.bits() > ty.bits() {
                part = self.emit(InstData::Convert { op: ConvertOp::Trunc, arg: part }, ty);
            } else if whole.bits() < ty.bits() {
                part = self.emit(InstData::Convert { op: ConvertOp::Zext, arg: part }, ty);
            }
            // What is before the piece in its value goes, unless the shift drops it.
            if start < piece.start && piece.start > access.start {
                let mask = self.emit(InstData::Const { bits: (1 << (piece.end - piece.start)) - 1 }, ty);
                part = self.emit(InstData::Binary { op: BinaryOp::And, args: [part, mask] }, ty);
            }
            part = self.shifted(BinaryOp::Shl, part, ty, access.end - piece.end);
            all = Some(match all {
                Some(all) => self.emit(InstData::Binary { op: BinaryOp::Or, args: [all, part] }, ty),
                None => part,
            });
        }
        all.unwrap_or_else(|| self.emit(InstData::Const { bits: 0 }, ty))
    }

    fn shifted(&mut self, op: BinaryOp, value: Value, ty: Type, count: u64) -> Value {
        if count == 0 {
            return value;
        }
        let count = self.emit(InstData::Const { bits: count }, ty);
        self.emit(InstData::Binary { op, args: [value, count] }, ty)
    }

    /// Reads the word or byte around a bit that nothing is known about.
    fn read_around(&mut self, addr: &Address, bit: u8) {
        let (byte, bit) = (Access::bytes(addr, 1), Access::bit(addr, bit));
        let Some(words) = &self.words else { return };
        if self.known.find(&byte).is_some_and(|extents| extents.overlaps(bit.start, bit.end)) {
            return;
        }
        let (addr, ty) = match words.around(addr) {
            Some(word) => (word, Type::I32),
            None if words.shares_byte(addr) => (*addr, Type::I8),
            None => return,
        };
        let value = self.emit(InstData::Load { addr }, ty);
        self.changed = true;
        self.known.learn(&Access::of_type(&addr, ty), value, false);
    }

    /// The value of type `ty` that `access` reads from a range that contains it.
    fn part_of(&mut self, extent: Extent<Content>, access: &Access, ty: Type) -> Option<Value> {
        let (whole, start, end) = match extent.known {
            Content::Zero => return Some(self.emit(InstData::Const { bits: 0 }, ty)),
            Content::Value { value, start, end, .. } => (self.function.resolve(value), start, end),
        };
        let whole_type = self.function.ty(whole);
        if (start, end) == (access.start, access.end) {
            if whole_type == ty {
                return Some(whole);
            }
            // An i32 that is read as an f32.
            let same_width = whole_type.bits() == ty.bits() && whole_type.is_int() != ty.is_int();
            return same_width.then(|| self.emit(InstData::Convert { op: ConvertOp::Bitcast, arg: whole }, ty));
        }
        if !whole_type.is_int() || !ty.is_int() || access.region.is_host_order() {
            return None;
        }
        // Memory is big-endian: bytes after the part are below it. Within its byte a bit has its own number.
        let bytes_after = (end - access.end.next_multiple_of(8)) / 8;
        let shift = bytes_after * 8 + if ty == Type::I1 { access.start % 8 } else { 0 };
        let shifted = self.shifted(BinaryOp::Lshr, whole, whole_type, shift);
        Some(self.emit(InstData::Convert { op: ConvertOp::Trunc, arg: shifted }, ty))
    }

    fn emit(&mut self, data: InstData, ty: Type) -> Value {
        let inst = self.function.make_inst(data, &[ty], self.loc);
        self.out.push(inst);
        self.function.result(inst)
    }

    fn store(&mut self, access: &Access, value: Value) -> Step {
        if is_attention(access) {
            return Step::Keep;
        }
        if let Some(extent) = self.known.find(access).and_then(|extents| extents.covering(access.start, access.end)) {
            let same = match extent.known {
                Content::Zero => self.function.constant(value) == Some(0),
                Content::Value { value: known, start, end, .. } => {
                    (start, end) == (access.start, access.end) && self.is_same(known, value)
                }
            };
            if same {
                return Step::Drop;
            }
        }
        self.known.forget(access);
        self.known.learn(access, value, true);
        Step::Keep
    }

    fn is_same(&self, a: Value, b: Value) -> bool {
        let (a, b) = (self.function.resolve(a), self.function.resolve(b));
        let constant = self.function.constant(a);
        a == b
            || self.function.ty(a) == self.function.ty(b) && constant.is_some() && constant == self.function.constant(b)
    }

    fn clear(&mut self, addr: &Address, len: u32) -> Step {
        let access = Access::bytes(addr, len);
        if len == 0 {
            return Step::Drop;
        }
        let known = self.known.find(&access).and_then(|extents| extents.covering(access.start, access.end));
        if known.is_some_and(|extent| extent.known == Content::Zero) {
            return Step::Drop;
        }
        self.known.forget(&access);
        self.known.fill(&access, Content::Zero);
        Step::Keep
    }

    fn db_entry(&mut self, inst: Inst, number: Value, length: bool) -> Step {
        let result = self.function.result(inst);
        if let Some(&(_, _, value)) = self.known.dbs.iter().find(|entry| (entry.0, entry.1) == (number, length)) {
            return Step::Replace(value);
        }
        if self.known.dbs.len() >= DB_FACTS_MAX {
            self.known.dbs.clear();
        }
        self.known.dbs.push((number, length, result));
        Step::Keep
    }
}

/// The only word of memory that changes asynchronously: signals set it.
fn is_attention(access: &Access) -> bool {
    let start = u64::from(state::ATTENTION) * 8;
    access.region == Region::State && (access.base.is_some() || access.start < start + 32 && start < access.end)
}
