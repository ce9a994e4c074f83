//! Removal of stores that are overwritten before anybody reads them.
//!
//! Walking a block backward, the pass keeps the ranges that are surely written before they can be read. At the end of a
//! block these are what all blocks after it agree on, without those of an address that is computed; before a jump back nothing, before `ret` the
//! own frame, which is dead. A load takes its range out, and from regions that it may alias everything; a call and a runtime function that may
//! run organization blocks take out everything.
//!
//! ```text
//! store.bit system 13.0, v1      ; removed: on both ways the next operation sets the flag
//! branch v2, b1, b2
//! b1 cold:                       ; notes an error, for which the flag does not matter
//!     rt @s7200_error(v3, v4)
//!     jump b2
//! b2:
//!     store.bit system 13.0, v5
//! ```
//!
//! Local data are also checked as a whole: in a private frame (see `frames`) bytes that are never read anywhere need
//! no store and no `clear`.

use std::rc::Rc;

use plcc_abi::functions::Effect;
use plcc_ir::analysis::ControlFlow;
use plcc_ir::{Block, Function, Inst, InstData, Region, Value};
use rustc_hash::FxHashMap;

use crate::effects::{REGISTERS, leaves_registers};
use crate::extents::{Access, Extents};
use crate::frames::Frames;
use crate::surroundings::Surroundings;

/// Removes dead stores from a function. Result: whether there were any.
pub fn eliminate_dead_stores(function: &mut Function, surroundings: &Surroundings) -> bool {
    let frames = surroundings.frames(function);
    let changed = remove_overwritten(function, &frames);
    remove_unread_local_data(function, &frames) || changed
}

/// Ranges that are kept for one base; more are forgotten, so that time stays linear.
const RANGES_MAX: usize = 1024;
/// Ranges that are kept for one region from block to block.
const SHARED_MAX: usize = 64;

/// Ranges from each base of a region. What blocks have in common is shared until one of them changes it.
type Bases = Rc<Vec<(Option<Value>, Extents<()>)>>;

/// Ranges that are written before they are read.
#[derive(Clone, Default)]
struct Overwritten {
    ranges: FxHashMap<Region, Bases>,
    /// The whole frame is dead, indexed or not, except the ranges that a read excluded.
    frame_ends: bool,
}

impl Overwritten {
    fn contains(&self, access: &Access) -> bool {
        if self.frame_ends && access.region == Region::L {
            return true;
        }
        let Some(bases) = self.ranges.get(&access.region) else { return false };
        let same = bases.iter().find(|(base, _)| *base == access.base);
        same.is_some_and(|(_, extents)| extents.covering(access.start, access.end).is_some())
    }

    /// The range of an access without the parts at its ends that are overwritten.
    fn rest_of(&self, access: &Access) -> (u64, u64) {
        let (mut start, mut end) = (access.start, access.end);
        let bases = self.ranges.get(&access.region);
        let same = bases.and_then(|bases| bases.iter().find(|(base, _)| *base == access.base));
        if let Some((_, extents)) = same
            && start < end
        {
            if let Some(first) = extents.covering(start, start + 1) {
                start = first.end.min(end);
            }
            if let Some(last) = extents.covering(end - 1, end) {
                end = last.start.max(start);
            }
        }
        (start, end)
    }

    fn write(&mut self, access: &Access) {
        if access.start == access.end {
            return;
        }
        let bases = Rc::make_mut(self.ranges.entry(access.region).or_default());
        let index = bases.iter().position(|(base, _)| *base == access.base).unwrap_or_else(|| {
            bases.push((access.base, Extents::default()));
            bases.len() - 1
        });
        let extents = &mut bases[index].1;
        if extents.len() >= RANGES_MAX {
            extents.clear();
        }
        extents.cut(access.start, access.end);
        extents.insert(access.start, access.end, ());
    }

    fn read(&mut self, access: &Access) {
        if matches!(access.region, Region::L | Region::Any) {
            self.frame_ends = false;
        }
        let is_touched = |(base, extents): &(Option<Value>, Extents<()>)| {
            *base != access.base || extents.is_empty() || extents.overlaps(access.start, access.end)
        };
        if let Some(shared) = self.ranges.get_mut(&access.region)
            && (shared.is_empty() || shared.iter().any(is_touched))
        {
            let bases = Rc::make_mut(shared);
            bases.retain_mut(|(base, extents)| {
                let same = *base == access.base;
                if same {
                    extents.cut(access.start, access.end);
                }
                same && !extents.is_empty()
            });
            if bases.is_empty() {
                self.ranges.remove(&access.region);
            }
        }
        if matches!(access.region, Region::Any | Region::AnyDb) {
            self.ranges.retain(|&region, _| region == access.region || !region.may_alias(access.region));
            return;
        }
        // A separate region overlaps these two and itself, however many there are.
        for wide in [Region::Any, Region::AnyDb] {
            if wide.may_alias(access.region) {
                self.ranges.remove(&wide);
            }
        }
    }

    fn read_all(&mut self, keep_frame: bool) {
        // A new table: one that was large once would be walked from end to end at each call.
        let frame = self.ranges.remove(&Region::L).filter(|_| keep_frame);
        self.ranges = frame.map(|bases| (Region::L, bases)).into_iter().collect();
        self.frame_ends &= keep_frame;
    }

    /// What the blocks before the one at whose beginning this holds may know.
    fn at_start(&mut self) {
        let is_told = |(base, extents): &(Option<Value>, Extents<()>)| base.is_none() && extents.len() <= SHARED_MAX;
        self.ranges.retain(|_, bases| {
            if !bases.iter().all(is_told) {
                Rc::make_mut(bases).retain(is_told);
            }
            !bases.is_empty()
        });
    }

    /// Keeps what holds in `other` too, which holds at the beginning of a block.
    fn intersect(&mut self, other: &Overwritten) {
        self.ranges.retain(|region, bases| {
            let Some(others) = other.ranges.get(region) else { return false };
            if Rc::ptr_eq(bases, others) && bases.iter().all(|(_, extents)| !extents.is_empty()) {
                return !bases.is_empty();
            }
            let bases = Rc::make_mut(bases);
            bases.retain_mut(|(base, extents)| {
                let same = others.iter().find(|(other, _)| other == base);
                same.is_some_and(|(_, others)| {
                    extents.intersect(others);
                    !extents.is_empty()
                })
            });
            !bases.is_empty()
        });
        self.frame_ends &= other.frame_ends;
    }

    /// A runtime function touches the system area of an S7-200 except for the registers.
    fn leave_registers(&mut self) {
        let Some(bases) = self.ranges.get_mut(&Region::System) else { return };
        let mut registers = Extents::default();
        REGISTERS.iter().for_each(|&(start, end)| registers.insert(start, end, ()));
        Rc::make_mut(bases).retain_mut(|(base, extents)| {
            extents.intersect(&registers);
            base.is_none() && !extents.is_empty()
        });
    }
}

/// What is known at the beginnings of blocks that the walk has been to, and how many blocks still ask for it.
type Starts = FxHashMap<Block, (Overwritten, usize)>;

/// What is overwritten after the end of `block`.
fn at_end(cfg: &ControlFlow, block: Block, starts: &mut Starts) -> Overwritten {
    let mut all: Option<Overwritten> = None;
    let mut goes_back = false;
    for &next in cfg.successors(block) {
        if cfg.rpo_index(next) <= cfg.rpo_index(block) {
            goes_back = true;
            continue;
        }
        let Some((known, readers)) = starts.get_mut(&next) else { continue };
        *readers -= 1;
        match &mut all {
            Some(all) => all.intersect(known),
            None if *readers == 0 => all = Some(std::mem::take(known)),
            None => all = Some(known.clone()),
        }
        if *readers == 0 {
            starts.remove(&next);
        }
    }
    if goes_back { Overwritten::default() } else { all.unwrap_or_default() }
}

fn remove_overwritten(function: &mut Function, frames: &Frames<'_>) -> bool {
    let mut changed = false;
    let cfg = ControlFlow::new(function);
    let mut starts = Starts::default();
    for &block in cfg.rpo.iter().rev() {
        let mut insts = std::mem::take(&mut function.blocks[block].insts);
        let mut overwritten = at_end(&cfg, block, &mut starts);
        let mut dead: Vec<Inst> = Vec::new();
        for &inst in insts.iter().rev() {
            match visit(function, frames, inst, &mut overwritten) {
                Store::Needed => {}
                Store::Shorter => changed = true,
                Store::Dead => dead.push(inst),
            }
        }
        // The dead ones were found from the end.
        if !dead.is_empty() {
            changed = true;
            insts.retain(|inst| {
                let is_dead = dead.last() == Some(inst);
                if is_dead {
                    dead.pop();
                }
                !is_dead
            });
        }
        function.blocks[block].insts = insts;
        let earlier = |pred: &&Block| cfg.rpo_index(**pred) < cfg.rpo_index(block);
        let readers = cfg.predecessors(block).iter().filter(earlier).count();
        if readers > 0 {
            overwritten.at_start();
            starts.insert(block, (overwritten, readers));
        }
    }
    changed
}

/// What becomes of an instruction.
enum Store {
    Needed,
    /// A part of what it writes is enough.
    Shorter,
    Dead,
}

/// Goes back over one instruction.
fn visit(function: &mut Function, frames: &Frames<'_>, inst: Inst, overwritten: &mut Overwritten) -> Store {
    let write = |access: Access, overwritten: &mut Overwritten| {
        let dead = overwritten.contains(&access);
        if dead {
            return Store::Dead;
        }
        overwritten.write(&access);
        Store::Needed
    };
    match &mut function.insts[inst] {
        InstData::Load { addr } => {
            let addr = *addr;
            let ty = function.ty(function.result(inst));
            overwritten.read(&Access::of_type(&addr, ty));
            Store::Needed
        }
        InstData::LoadBit { addr, bit } => {
            overwritten.read(&Access::bit(addr, *bit));
            Store::Needed
        }
        InstData::Store { addr, value } => {
            let (addr, ty) = (*addr, function.values[*value].ty);
            write(Access::of_type(&addr, ty), overwritten)
        }
        InstData::StoreBit { addr, bit, .. } => write(Access::bit(addr, *bit), overwritten),
        InstData::Clear { addr, len } => {
            let access = Access::bytes(addr, *len);
            let (start, end) = overwritten.rest_of(&access);
            let store = write(access, overwritten);
            // Its ends may be overwritten already.
            let rest = ((start / 8) as u32, (end.div_ceil(8) - start / 8) as u32);
            if matches!(store, Store::Needed) && rest != (addr.offset, *len) {
                (addr.offset, *len) = rest;
                return Store::Shorter;
            }
            store
        }
        InstData::Copy { to, from, len } => {
            let store = write(Access::bytes(to, *len), overwritten);
            if matches!(store, Store::Needed) {
                overwritten.read(&Access::bytes(from, *len));
            }
            store
        }
        InstData::Call { callee, .. } => {
            overwritten.read_all(!frames.call_touches(*callee));
            Store::Needed
        }
        InstData::CallRuntime { function, .. } => {
            match function.effect() {
                Effect::Pure => {}
                Effect::Cells => {
                    overwritten.ranges.remove(&Region::Cells);
                }
                Effect::System if leaves_registers(*function) => {
                    overwritten.leave_registers();
                    overwritten.ranges.remove(&Region::Any);
                }
                Effect::System => {
                    overwritten.ranges.remove(&Region::System);
                    overwritten.ranges.remove(&Region::Any);
                }
                Effect::Io => {
                    overwritten.ranges.remove(&Region::Q);
                    overwritten.ranges.remove(&Region::Any);
                }
                Effect::Reads | Effect::All => overwritten.read_all(frames.is_private()),
            }
            Store::Needed
        }
        InstData::Return { .. } => {
            overwritten.frame_ends = true;
            Store::Needed
        }
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
        | InstData::FrameBase { .. }
        | InstData::Jump { .. }
        | InstData::Branch { .. }
        | InstData::Switch { .. } => Store::Needed,
    }
}

/// Removes stores to local data that are never read, and shortens `clear`.
fn remove_unread_local_data(function: &mut Function, frames: &Frames<'_>) -> bool {
    let Some(read) = local_data_read(function, frames) else { return false };
    let mut changed = false;
    let overlap = |access: &Access| access.base.is_some() || read.overlaps(access.start, access.end);
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        let mut insts = std::mem::take(&mut function.blocks[block].insts);
        let before = insts.len();
        insts.retain(|&inst| match &mut function.insts[inst] {
            InstData::Store { addr, value } if addr.region == Region::L => {
                overlap(&Access::of_type(addr, function.values[*value].ty))
            }
            InstData::StoreBit { addr, bit, .. } if addr.region == Region::L => overlap(&Access::bit(addr, *bit)),
            InstData::Copy { to, len, .. } if to.region == Region::L => overlap(&Access::bytes(to, *len)),
            InstData::Clear { addr, len } if addr.region == Region::L && addr.base.is_none() => {
                let access = Access::bytes(addr, *len);
                let mut needed = read.iter().filter(|item| item.start < access.end && access.start < item.end);
                let Some(first) = needed.next() else { return false };
                let last = needed.last().unwrap_or(first);
                let start = first.start.max(access.start) / 8;
                let end = last.end.min(access.end).div_ceil(8);
                let rest = (start as u32, (end - start) as u32);
                changed |= rest != (addr.offset, *len);
                (addr.offset, *len) = rest;
                true
            }
            _ => true,
        });
        changed |= insts.len() < before;
        function.blocks[block].insts = insts;
    }
    changed
}

/// Ranges of local data that are read anywhere; `None` if they are unknown.
fn local_data_read(function: &Function, frames: &Frames<'_>) -> Option<Extents<()>> {
    if !frames.is_private() || function.frame_bytes == 0 {
        return None;
    }
    let mut read = Extents::default();
    let mut note = |access: Access| -> Option<()> {
        match access.region {
            Region::L if access.base.is_none() => {
                read.cut(access.start, access.end);
                read.insert(access.start, access.end, ());
                Some(())
            }
            Region::L | Region::Any => None,
            Region::State
            | Region::I
            | Region::Q
            | Region::M
            | Region::System
            | Region::Cells
            | Region::V
            | Region::Db(_)
            | Region::AnyDb => Some(()),
        }
    };
    for block in function.layout.iter().map(|&block| &function.blocks[block]) {
        for &inst in &block.insts {
            match &function.insts[inst] {
                InstData::Load { addr } => note(Access::of_type(addr, function.ty(function.result(inst))))?,
                InstData::LoadBit { addr, bit } => note(Access::bit(addr, *bit))?,
                InstData::Copy { from, len, .. } if *len > 0 => note(Access::bytes(from, *len))?,
                InstData::Call { callee, .. } if frames.call_touches(*callee) => return None,
                _ => {}
            }
        }
    }
    Some(read)
}

#[cfg(test)]
mod tests {
    use crate::tests::check_body;

    fn check(body: &str, expected: &str) {
        check_body("dead-stores", body, expected);
    }

    #[test]
    fn the_last_store_counts() {
        check(
            "store.bit M 1.0, v1\nstore.i32 M 4, v0\nstore.bit M 1.0, v1\nstore.i32 M 4, v0\nret v0",
            "store.bit M 1.0, v1\nstore.i32 M 4, v0\nret v0",
        );
    }

    #[test]
    fn reads_and_calls_keep_stores() {
        for between in
            ["v2 = load.i8 M 1", "v2 = load.i8 M[v0]+7", "v2 = load.i8 any[v0]+7", "call @G()", "copy Q 0, M 0, 2"]
        {
            let text = format!("store.bit M 1.0, v1\n{between}\nstore.bit M 1.0, v1\nret v0");
            check(&text, &text);
        }
        check(
            "store.i32 M 0, v0\nv2 = load.i32 DB5 0\nv3 = rt @s7200_counter(v0)\nstore.i32 M 0, v2\nret v0",
            "v2 = load.i32 DB5 0\nv3 = rt @s7200_counter(v0)\nstore.i32 M 0, v2\nret v0",
        );
    }

    #[test]
    fn a_byte_is_not_overwritten_by_its_bits() {
        let text = "store.i32 M 0, v0\nstore.bit M 0.0, v1\nret v0";
        check(text, text);
        check("store.bit M 0.0, v1\nstore.i32 M 0, v0\nret v0", "store.i32 M 0, v0\nret v0");
    }

    #[test]
    fn what_all_ways_overwrite_needs_no_store() {
        let text = |before: &str, one: &str, two: &str| {
            format!("{before}branch v1, b1, b2\nb1:\n{one}jump b3\nb2:\n{two}jump b3\nb3:\nstore.bit M 1.0, v1\nret v0")
        };
        let store = "store.bit M 1.0, v1\n";
        check(&text(store, "", ""), &text("", "", ""));
        check(
            &text("store.i32 M 4, v0\n", "store.i32 M 4, v0\n", "store.i32 M 4, v0\n"),
            &text("", "store.i32 M 4, v0\n", "store.i32 M 4, v0\n"),
        );
        for between in ["v2 = load.i8 M 1\n", "call @G()\n", "v2 = load.i8 M[v0]+7\n"] {
            check(&text(store, between, ""), &text(store, between, ""));
            check(&text(store, "", between), &text(store, "", between));
        }
    }

    #[test]
    fn a_loop_keeps_what_is_stored_before_its_jump_back() {
        let text = "jump b1\nb1:\nstore.i32 M 4, v0\nbranch v1, b1, b2\nb2:\nstore.i32 M 4, v0\nret v0";
        check(text, text);
    }

    #[test]
    fn errors_of_an_s7_200_leave_its_registers() {
        let text =
            |first: &str, region: &str| format!("{first}rt @s7200_error(v0, v0)\nstore.i32 {region}, v0\nret v0");
        let accumulator = format!("system {}", plcc_abi::s7200::system::ACCUMULATORS);
        check(&text(&format!("store.i32 {accumulator}, v0\n"), &accumulator), &text("", &accumulator));
        let special = format!("system {}", plcc_abi::s7200::system::SM + 4);
        let text = text(&format!("store.i32 {special}, v0\n"), &special);
        check(&text, &text);
    }

    #[test]
    fn local_data_die_with_the_call() {
        check("store.i32 L 0, v0\nstore.i32 M 0, v0\nret v0", "store.i32 M 0, v0\nret v0");
        check(
            "clear L 0, 16\nbranch v1, b1, b2\nb1:\nv2 = load.i16 L 4\njump b2\nb2:\nret v0",
            "clear L 4, 2\nbranch v1, b1, b2\nb1:\nv2 = load.i16 L 4\njump b2\nb2:\nret v0",
        );
        check(
            "v9 = trunc.i16 v0\nclear M 0, 16\nstore.i32 M 0, v0\nstore.i16 M 13, v9\nv3 = load.i8 M 15\nret v0",
            "v9 = trunc.i16 v0\nclear M 4, 12\nstore.i32 M 0, v0\nstore.i16 M 13, v9\nv3 = load.i8 M 15\nret v0",
        );
        check("store.i32 L 0, v0\ncall @G()\nret v0", "call @G()\nret v0");
        let text = "store.i32 L 0, v0\ncall @H()\nret v0";
        check(text, text);
    }
}
