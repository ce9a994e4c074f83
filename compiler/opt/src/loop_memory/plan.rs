//! Which places which loops carry.

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::{Address, BinaryOp, Block, FuncId, Function, Inst, InstData, Region, Type, Value};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::effects::Effects;
use crate::extents::Access;
use crate::frames::Frames;
use crate::known_bits::unsigned_max;
use crate::loops::{Loop, Loops};
use crate::ranges::{BaseRanges, base_ranges};
use crate::surroundings::Surroundings;

/// Larger functions are left as they are.
const INSTS_MAX: usize = 400_000;
/// Instructions that are looked at, each once for each loop around it.
const STEPS_MAX: usize = 4_000_000;
/// Comparisons of places with accesses in one function.
const PAIRS_MAX: usize = 2_000_000;
/// Places that a loop carries: about as many as there are registers.
const PLACES_MAX: usize = 14;
/// Instructions of a loop without a switch that carries places which not every pass reads or writes.
const SMALL: usize = 64;
/// The same for sums and counters: the next pass that changes one waits for what was stored.
const COUNTING: usize = 400;
/// Stores and loads that the cold sides of a loop get.
const COLD_MAX: usize = 400;

/// A place: a range of bits of a region, without base.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Place {
    pub region: Region,
    pub start: u64,
    pub end: u64,
}

/// A loop with the places that it carries.
pub struct Carrier {
    pub header: Block,
    pub blocks: FxHashSet<Block>,
    pub places: Vec<Carried>,
}

/// A place that a loop carries.
pub struct Carried {
    pub place: Place,
    pub ty: Type,
    /// The loop writes it.
    pub is_stored: bool,
    /// Loads and stores of the place in the loop.
    pub accesses: Vec<Inst>,
    /// Loads and stores of parts of it, such as bits of a byte.
    pub parts: Vec<Inst>,
    /// Instructions on cold sides before which it is stored, and after which it is loaded again.
    pub shown: Vec<Inst>,
    pub renewed: Vec<Inst>,
    /// Indexed accesses in the loop that do not reach it if the guess is right.
    pub assumed: Vec<Inst>,
}

/// A place of a loop, by its header.
pub type Guess = (Block, Place);

/// Decides what the loops of a function carry. With `refused` it guesses that indexed accesses do not reach a place, except for those
/// guesses.
pub fn plan(function: &Function, surroundings: &Surroundings, refused: Option<&FxHashSet<Guess>>) -> Vec<Carrier> {
    let cfg = ControlFlow::new(function);
    let has_loops = cfg
        .rpo
        .iter()
        .any(|&block| cfg.successors(block).iter().any(|&target| cfg.rpo_index(target) <= cfg.rpo_index(block)));
    if function.insts.len() > INSTS_MAX || !has_loops {
        return Vec::new();
    }
    let dominators = Dominators::new(function, &cfg);
    let loops = Loops::new(function, &cfg, &dominators);
    let mut planner = Planner {
        surroundings,
        function,
        refused,
        frames: surroundings.frames(function),
        effects: &surroundings.effects,
        bases: None,
        taken: FxHashSet::default(),
        steps: 0,
        pairs: 0,
        loops: &loops,
    };
    let mut carriers = Vec::new();
    for each in &loops.all {
        planner.steps += each.blocks.iter().map(|&block| function.blocks[block].insts.len()).sum::<usize>();
        if planner.steps > STEPS_MAX || planner.pairs > PAIRS_MAX {
            break;
        }
        if each.header == function.entry() {
            continue;
        }
        let places = planner.places_of(each, &cfg, &dominators);
        if !places.is_empty() {
            planner
                .taken
                .extend(places.iter().flat_map(|carried| carried.accesses.iter().chain(&carried.parts).copied()));
            carriers.push(Carrier { header: each.header, blocks: each.blocks.iter().copied().collect(), places });
        }
    }
    carriers
}

/// What is reached by an access: bits of its region, and of the memory as a whole.
#[derive(Clone, Copy)]
struct Reach {
    region: Region,
    inside: (u64, u64),
    anywhere: (u64, u64),
}

impl Reach {
    fn meets(&self, other: &Reach) -> bool {
        let overlap = |a: (u64, u64), b: (u64, u64)| a.0 < b.1 && b.0 < a.1;
        if !self.region.may_alias(other.region) {
            return false;
        }
        if self.region == other.region {
            return overlap(self.inside, other.inside);
        }
        overlap(self.anywhere, other.anywhere)
    }
}

/// What an instruction does to memory besides accesses of places.
enum Other {
    Access { reach: Reach, writes: bool },
    Call(FuncId),
    Runtime(plcc_ir::RuntimeFn),
}

/// A candidate.
struct Candidate {
    ty: Option<Type>,
    reads: u64,
    writes: u64,
    accesses: Vec<Inst>,
    parts: Vec<Inst>,
    /// Each pass of the loop reads or writes it.
    is_usual: bool,
    /// The block outside of cold sides that was the last to read it.
    read_in: Option<Block>,
    /// Such a block reads it, then writes it.
    is_changed: bool,
}

struct Planner<'a> {
    surroundings: &'a Surroundings,
    function: &'a Function,
    refused: Option<&'a FxHashSet<Guess>>,
    frames: Frames<'a>,
    effects: &'a Effects,
    loops: &'a Loops,
    /// The ranges of bases in bytes, once they are needed.
    bases: Option<BaseRanges>,
    /// Accesses that an outer loop has made values.
    taken: FxHashSet<Inst>,
    steps: usize,
    pairs: usize,
}

impl Planner<'_> {
    fn places_of(&mut self, each: &Loop, cfg: &ControlFlow, dominators: &Dominators) -> Vec<Carried> {
        let function = self.function;
        let mut found: FxHashMap<Place, Candidate> = FxHashMap::default();
        let mut hot: Vec<(Inst, Other)> = Vec::new();
        let mut cold: Vec<(Inst, Other)> = Vec::new();
        let latches: Vec<Block> =
            cfg.predecessors(each.header).iter().copied().filter(|block| each.blocks.contains(block)).collect();
        let hot_blocks = || each.blocks.iter().filter(|&&block| !function.blocks[block].cold);
        // An arm of a switch is one of many: a pass needs few of the places.
        let has_arms = hot_blocks().any(|&block| ends_with_switch(function, block));
        let insts: usize = hot_blocks().map(|&block| function.blocks[block].insts.len()).sum();
        let is_small = insts <= SMALL && !has_arms;
        let is_counting = insts <= COUNTING && !has_arms;
        for &block in &each.blocks {
            let is_cold = function.blocks[block].cold;
            // In a large loop that does this and that a place costs more before and after it than in the few passes that need it.
            let is_usual = !is_cold && (is_small || latches.iter().all(|&latch| dominators.dominates(block, latch)));
            let weight = if is_cold { 0 } else { 8u64.pow(self.loops.depth(block).min(8)) };
            for &inst in &function.blocks[block].insts {
                if self.taken.contains(&inst) {
                    continue;
                }
                if let Some((place, ty, writes)) = place_of(function, inst) {
                    let candidate = found.entry(place).or_insert_with(|| Candidate {
                        ty: Some(ty),
                        reads: 0,
                        writes: 0,
                        accesses: Vec::new(),
                        parts: Vec::new(),
                        is_usual: false,
                        read_in: None,
                        is_changed: false,
                    });
                    if candidate.ty != Some(ty) {
                        candidate.ty = None;
                    }
                    *(if writes { &mut candidate.writes } else { &mut candidate.reads }) += weight.max(1);
                    candidate.is_usual |= is_usual;
                    if !writes && !is_cold {
                        candidate.read_in = Some(block);
                    }
                    candidate.is_changed |= writes && candidate.read_in == Some(block);
                    candidate.accesses.push(inst);
                } else {
                    let list = if is_cold { &mut cold } else { &mut hot };
                    self.others_of(inst, cfg, dominators, list);
                }
            }
        }
        let mut candidates: Vec<(Place, Candidate)> = found.into_iter().collect();
        candidates.sort_unstable_by_key(|(place, _)| *place);
        join_parts(&mut candidates);
        drop_overlapping(&mut candidates);
        candidates.retain(|(_, candidate)| {
            (candidate.is_usual || is_counting && candidate.is_changed) && candidate.ty.is_some()
        });
        // Without this order a loop would carry what it can, not what it uses most.
        candidates.sort_by_key(|(_, candidate)| std::cmp::Reverse(candidate.reads + candidate.writes));
        let mut places = Vec::new();
        let mut cold_work = 0;
        for (place, candidate) in candidates {
            self.pairs += hot.len() + cold.len();
            if self.pairs > PAIRS_MAX || places.len() >= PLACES_MAX {
                break;
            }
            let is_stored = candidate.writes > 0;
            let disturbs = |other: &Other| {
                let (reads, writes) = self.touches(other, &place);
                writes || reads && is_stored
            };
            let is_guessed = self.refused.is_some_and(|refused| !refused.contains(&(each.header, place)));
            let assumed: Vec<Inst> = hot.iter().filter(|(_, other)| disturbs(other)).map(|&(inst, _)| inst).collect();
            if assumed.iter().any(|&inst| !is_guessed || !is_indexed(function, inst)) {
                continue;
            }
            let (mut shown, mut renewed) = (Vec::new(), Vec::new());
            for (inst, other) in &cold {
                let (reads, writes) = self.touches(other, &place);
                // What is changed in part must be there before.
                if is_stored && (reads || writes) && shown.last() != Some(inst) {
                    shown.push(*inst);
                }
                if writes && renewed.last() != Some(inst) {
                    renewed.push(*inst);
                }
            }
            cold_work += shown.len() + renewed.len();
            if cold_work > COLD_MAX {
                break;
            }
            let Some(ty) = candidate.ty else { continue };
            let Candidate { accesses, parts, .. } = candidate;
            places.push(Carried { place, ty, is_stored, accesses, parts, shown, renewed, assumed });
        }
        places
    }

    /// What an instruction other than an access of a place does to memory.
    fn others_of(&mut self, inst: Inst, cfg: &ControlFlow, dominators: &Dominators, out: &mut Vec<(Inst, Other)>) {
        let function = self.function;
        let mut access = |index: usize, access: Access, writes: bool| {
            let base = access.base.map(|base| self.base_range(inst, index, base, cfg, dominators));
            let reach = reach(self.surroundings, &access, base);
            out.push((inst, Other::Access { reach, writes }));
        };
        match &function.insts[inst] {
            InstData::Load { addr } => access(0, Access::of_type(addr, function.ty(function.result(inst))), false),
            InstData::LoadBit { addr, .. } => access(0, Access::bytes(addr, 1), false),
            InstData::Store { addr, value } => access(0, Access::of_type(addr, function.ty(*value)), true),
            InstData::StoreBit { addr, .. } => access(0, Access::bytes(addr, 1), true),
            InstData::Clear { addr, len } => access(0, Access::bytes(addr, *len), true),
            InstData::Copy { to, from, len } => {
                access(0, Access::bytes(to, *len), true);
                access(1, Access::bytes(from, *len), false);
            }
            InstData::Call { callee, .. } => out.push((inst, Other::Call(*callee))),
            InstData::CallRuntime { function, .. } => out.push((inst, Other::Runtime(*function))),
            _ => {}
        }
    }

    /// The numbers that the base of an access can be.
    fn base_range(
        &mut self,
        inst: Inst,
        index: usize,
        base: Value,
        cfg: &ControlFlow,
        dominators: &Dominators,
    ) -> (u64, u64) {
        let function = self.function;
        let bases = self.bases.get_or_insert_with(|| base_ranges(function, cfg, dominators));
        let known = bases.get(&inst).and_then(|ranges| ranges[index]);
        let max = unsigned_max(function, base);
        known.map_or((0, max), |(lo, hi)| (lo, hi.min(max)))
    }

    /// Whether something may read the place, and whether it may write it.
    fn touches(&self, other: &Other, place: &Place) -> (bool, bool) {
        match other {
            Other::Access { reach: other, writes } => {
                let access = Access { region: place.region, base: None, start: place.start, end: place.end };
                let meets = reach(self.surroundings, &access, None).meets(other);
                (meets && !writes, meets && *writes)
            }
            Other::Call(callee) => {
                let touched = place.region != Region::L || self.frames.call_touches(*callee);
                (touched, touched)
            }
            Other::Runtime(function) => {
                if place.region == Region::L && self.frames.is_private() {
                    return (false, false);
                }
                let range = Some((place.start, place.end));
                (self.effects.may_read(*function, place.region), self.effects.may_write(*function, place.region, range))
            }
        }
    }
}

/// True of accesses whose address has a base.
fn is_indexed(function: &Function, inst: Inst) -> bool {
    let mut indexed = false;
    function.insts[inst].for_each_address(|addr| indexed |= addr.base.is_some());
    indexed
}

/// The guesses of a plan for the function `before` that the function, after it was rewritten by that plan, does not prove.
pub fn unproven(
    carriers: &[Carrier],
    before: &Function,
    function: &Function,
    surroundings: &Surroundings,
) -> Vec<Guess> {
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let bases = base_ranges(function, &cfg, &dominators);
    // The ranges of bases, by where they are used. A load that is there no more has the address of another one in its block.
    let mut known: FxHashMap<(Block, Value), (u64, u64)> = FxHashMap::default();
    let mut left: FxHashSet<Inst> = FxHashSet::default();
    for &block in &cfg.rpo {
        for inst in &function.blocks[block].insts {
            left.insert(*inst);
            let mut ranges = bases.get(inst).copied().unwrap_or_default().into_iter();
            function.insts[*inst].for_each_address(|addr| {
                if let (Some(base), Some(Some(range))) = (addr.base, ranges.next()) {
                    known.insert((block, function.resolve(base)), range);
                }
            });
        }
    }
    let mut block_of: FxHashMap<Inst, Block> = FxHashMap::default();
    for &block in &before.layout {
        block_of.extend(before.blocks[block].insts.iter().map(|&inst| (inst, block)));
    }
    let range_of = |block: Block, base: Value| {
        let base = function.resolve(base);
        let max = unsigned_max(function, base);
        let sum = || match *function.defining(base)? {
            // The constant has gone into the offset.
            InstData::Binary { op: BinaryOp::Iadd, args: [x, by] } => {
                let (lo, hi) = *known.get(&(block, function.resolve(x)))?;
                let by = i64::from(function.constant(by)? as i32);
                let moved = (lo.checked_add_signed(by)?, hi.checked_add_signed(by)?);
                (moved.1 <= u64::from(u32::MAX)).then_some(moved)
            }
            _ => None,
        };
        let range = known.get(&(block, base)).copied().or_else(sum);
        range.map_or((0, max), |(lo, hi)| (lo, hi.min(max)))
    };
    let avoids = |inst: Inst, place: &Place| {
        let access = Access { region: place.region, base: None, start: place.start, end: place.end };
        let place = reach(surroundings, &access, None);
        let (Some(bytes), Some(&block)) = (bytes_of(before, inst), block_of.get(&inst)) else { return false };
        let data = if left.contains(&inst) { &function.insts[inst] } else { &before.insts[inst] };
        let mut avoids = true;
        data.for_each_address(|addr| {
            let access = Access::bytes(addr, bytes);
            let range = access.base.map(|base| range_of(block, base));
            avoids &= !reach(surroundings, &access, range).meets(&place);
        });
        avoids
    };
    let mut wrong = Vec::new();
    for carrier in carriers {
        for carried in &carrier.places {
            if !carried.assumed.iter().all(|&inst| avoids(inst, &carried.place)) {
                wrong.push((carrier.header, carried.place));
            }
        }
    }
    wrong
}

/// How many bytes an access touches.
fn bytes_of(function: &Function, inst: Inst) -> Option<u32> {
    match &function.insts[inst] {
        InstData::Load { .. } => Some(function.ty(function.result(inst)).bytes()),
        InstData::Store { value, .. } => Some(function.ty(*value).bytes()),
        InstData::LoadBit { .. } | InstData::StoreBit { .. } => Some(1),
        InstData::Clear { len, .. } | InstData::Copy { len, .. } => Some(*len),
        _ => None,
    }
}

fn ends_with_switch(function: &Function, block: Block) -> bool {
    function.terminator(block).is_some_and(|last| matches!(function.insts[last], InstData::Switch { .. }))
}

/// The place that an instruction loads or stores, its type, and whether it stores.
pub fn place_of(function: &Function, inst: Inst) -> Option<(Place, Type, bool)> {
    let (access, ty, writes) = match &function.insts[inst] {
        InstData::Load { addr } => {
            let ty = function.ty(function.result(inst));
            (Access::of_type(addr, ty), ty, false)
        }
        InstData::LoadBit { addr, bit } => (Access::bit(addr, *bit), Type::I1, false),
        InstData::Store { addr, value } => {
            let ty = function.ty(*value);
            (Access::of_type(addr, ty), ty, true)
        }
        InstData::StoreBit { addr, bit, .. } => (Access::bit(addr, *bit), Type::I1, true),
        _ => return None,
    };
    // The attention flag changes by itself, and cells of timers with the clock.
    let is_data = !matches!(access.region, Region::State | Region::Cells);
    (access.base.is_none() && is_data).then_some((
        Place { region: access.region, start: access.start, end: access.end },
        ty,
        writes,
    ))
}

/// The address of a place, and its bit.
pub fn address_of(place: &Place) -> (Address, u8) {
    (Address::direct(place.region, (place.start / 8) as u32), (place.start % 8) as u8)
}

/// Makes places parts of others that contain them, where these are written or they are: bits of a byte, bytes of a word. They are sorted.
fn join_parts(candidates: &mut Vec<(Place, Candidate)>) {
    let mut rest = std::mem::take(candidates).into_iter().peekable();
    while let Some(first) = rest.next() {
        let (region, mut end) = (first.0.region, first.0.end);
        let mut overlapping = vec![first];
        while let Some(next) = rest.next_if(|(place, _)| place.region == region && place.start < end) {
            end = end.max(next.0.end);
            overlapping.push(next);
        }
        let start = overlapping[0].0.start;
        let is_whole = |(place, candidate): &(Place, Candidate)| {
            (place.start, place.end) == (start, end)
                && (candidate.is_usual || candidate.is_changed)
                && candidate.ty.is_some_and(|ty| ty.is_int() && ty != Type::I1)
        };
        let is_part = |(_, candidate): &(Place, Candidate)| candidate.ty.is_some_and(Type::is_int);
        let is_written = overlapping.iter().any(|(_, candidate)| candidate.writes > 0);
        match overlapping.iter().position(is_whole) {
            Some(whole) if overlapping.len() > 1 && is_written && overlapping.iter().all(is_part) => {
                let (place, mut candidate) = overlapping.swap_remove(whole);
                for (_, part) in overlapping {
                    candidate.reads += part.reads;
                    candidate.writes += part.writes;
                    candidate.parts.extend(part.accesses);
                }
                candidates.push((place, candidate));
            }
            _ => candidates.extend(overlapping),
        }
    }
}

/// Takes out the places that overlap others, unless both are only read. They are sorted.
fn drop_overlapping(candidates: &mut Vec<(Place, Candidate)>) {
    let mut keep = vec![true; candidates.len()];
    let is_written = |index: usize| candidates[index].1.writes > 0;
    // How far the places before reach, all of them and those that are written, in the region of the one that is looked at.
    let (mut all, mut written): (Option<Place>, Option<Place>) = (None, None);
    let farther = |reached: Option<Place>, place: Place| match reached {
        Some(before) if before.region == place.region && before.end >= place.end => Some(before),
        _ => Some(place),
    };
    for index in 0..candidates.len() {
        let place = candidates[index].0;
        let before = if is_written(index) { all } else { written };
        keep[index] &= before.is_none_or(|before| before.region != place.region || before.end <= place.start);
        all = farther(all, place);
        if is_written(index) {
            written = farther(written, place);
        }
    }
    // The next place after each, and the next that is written.
    let (mut all, mut written): (Option<Place>, Option<Place>) = (None, None);
    for index in (0..candidates.len()).rev() {
        let place = candidates[index].0;
        let after = if is_written(index) { all } else { written };
        keep[index] &= after.is_none_or(|after| after.region != place.region || after.start >= place.end);
        all = Some(place);
        if is_written(index) {
            written = Some(place);
        }
    }
    let mut keep = keep.into_iter();
    candidates.retain(|_| keep.next() == Some(true));
}

fn reach(surroundings: &Surroundings, access: &Access, base: Option<(u64, u64)>) -> Reach {
    let moved = |bit: u64, by: u64| bit.saturating_add(by.saturating_mul(8));
    let (lo, hi) = base.unwrap_or((0, 0));
    let inside = (moved(access.start, lo), moved(access.end, hi));
    let (start, end) = surroundings.extent_of(access.region);
    let anywhere = match access.region {
        Region::Any | Region::AnyDb => (inside.0.max(start), inside.1.min(end)),
        Region::L | Region::V | Region::State | Region::Cells => (start, end),
        _ => (start.saturating_add(inside.0), start.saturating_add(inside.1).min(end)),
    };
    Reach { region: access.region, inside, anywhere }
}
