//! Which numbers each value can be, found by sweeps over the dominator tree.
//!
//! A sweep computes each value from its operands, in the order of the tree, so that what a branch has tested is known in all
//! blocks that only it leads to. Values that come over jumps back are those of the sweep before; none come in the first one,
//! so that a sweep only ever finds more numbers. A parameter that grows from sweep to sweep is widened to the next landmark;
//! when nothing grows, a few sweeps without widening make intervals smaller again.

mod companions;
mod ends;
mod learning;

use plcc_abi::layout;
use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::Entity;
use plcc_ir::{
    Address, BinaryOp, Block, BlockCall, ConvertOp, Function, Inst, InstData, Region, StaticDb, Type, UnaryOp, Value,
};
use rustc_hash::FxHashMap;

use super::interval::{self, Interval};

/// Sweeps until nothing grows; with more the function is left as it is.
const GROWING_MAX: usize = 40;
/// Sweeps after which what still grows may be any number.
const LANDMARKS_UNTIL: usize = 16;
/// Sweeps that make intervals smaller.
const SHRINKING: usize = 2;
/// Inner loops within each other that begin with what the outer one has got to.
const NESTED: usize = 2;
/// Address registers have the area above an address of 24 bits.
const ADDRESS_MASK: i64 = 0x00FF_FFFF;
/// How many steps back a condition is followed: conversions, sums with constants, conditions joined by AND and OR.
const DEPTH_MAX: u32 = 4;
/// Where widening stops: the numbers at which loops usually end, and the last address. Pointers with an area stop at the ends of that.
const LANDMARKS: [i64; 11] = [-32768, -128, -1, 0, 1, 127, 255, 1023, 32767, 65535, ADDRESS_MASK];

/// The knowledge of a point of the function while a sweep is there.
pub struct Ranges<'f> {
    function: &'f Function,
    cfg: &'f ControlFlow,
    dominators: &'f Dominators,
    /// Sorted by number.
    dbs: &'f [StaticDb],
    /// What each value can be anywhere; `None`: it was not computed yet.
    values: Vec<Option<Interval>>,
    /// What is known in addition here, of each value.
    here: Vec<Option<Interval>>,
    /// Entries of `here` before they were changed, for the way back up the tree.
    undo: Vec<(Value, Option<Interval>)>,
    /// Blocks on the way from the root, and the length of `undo` before each.
    path: Vec<(Block, usize)>,
    reached: Vec<bool>,
    /// For parameters of blocks: what came over jumps forward in this sweep, and over jumps back in the sweep before and in this one.
    forward: FxHashMap<Value, Interval>,
    back: FxHashMap<Value, Interval>,
    next_back: FxHashMap<Value, Interval>,
    /// Limits of parameters of loops that count along with another one.
    limits: FxHashMap<Value, Interval>,
    /// How many passes loops begin at most, by header.
    passes: FxHashMap<Block, i64>,
    /// Parameters of loops, with others that count along with them.
    together: FxHashMap<Value, Vec<Together>>,
    /// The first number of parameters that change by more than 1 with each pass, and by how much.
    strides: FxHashMap<Value, (i64, i64)>,
    /// Values that are made of another one and a constant, or a conversion of it: what is learnt of that one says something of them.
    derived: FxHashMap<Value, Vec<Value>>,
    /// The sweep in which each value was computed last, and the number of this one.
    computed: Vec<u32>,
    sweeps: u32,
    /// How many steps from the value that was learnt of; chains of sums can be as long as the program.
    deriving: u32,
    phase: Phase,
}

/// A parameter that is so many times another one of its loop, plus a constant, in each pass.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Together {
    param: Value,
    times: i64,
    plus: i64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    Growing(usize),
    Shrinking,
}

impl<'f> Ranges<'f> {
    /// Analyses `function`; `None`: it takes too long. `dbs`, sorted by number, are those whose addresses are known.
    pub fn of(
        function: &'f Function,
        cfg: &'f ControlFlow,
        dominators: &'f Dominators,
        dbs: &'f [StaticDb],
    ) -> Option<Ranges<'f>> {
        let mut ranges = Ranges {
            function,
            cfg,
            dominators,
            dbs,
            values: vec![None; function.values.len()],
            here: vec![None; function.values.len()],
            undo: Vec::new(),
            path: Vec::new(),
            reached: vec![false; function.blocks.len()],
            forward: FxHashMap::default(),
            back: FxHashMap::default(),
            next_back: FxHashMap::default(),
            limits: FxHashMap::default(),
            passes: FxHashMap::default(),
            together: FxHashMap::default(),
            strides: FxHashMap::default(),
            derived: learning::derived(function, cfg),
            computed: vec![0; function.values.len()],
            sweeps: 0,
            deriving: 0,
            phase: Phase::Growing(0),
        };
        // Without loops nothing comes over jumps back: the sweep of who asks finds everything.
        if !has_loops(function, cfg) {
            return Some(ranges);
        }
        let mut sweeps = 0;
        while ranges.sweep() {
            sweeps += 1;
            if sweeps > GROWING_MAX {
                return None;
            }
            ranges.phase = Phase::Growing(sweeps);
        }
        ranges.phase = Phase::Shrinking;
        for _ in 0..SHRINKING {
            ranges.sweep();
        }
        // What an inner loop begins with is known once it is known how far the outer one gets.
        for _ in 0..=NESTED {
            let is_more_known = ranges.find_companions();
            for _ in 0..SHRINKING {
                ranges.sweep();
            }
            if !is_more_known {
                break;
            }
        }
        Some(ranges)
    }

    /// One sweep. Result: whether something grew.
    fn sweep(&mut self) -> bool {
        self.begin();
        let mut grew = false;
        for &block in &self.dominators.preorder {
            grew |= self.enter(block);
            if !self.reached[block.index()] {
                continue;
            }
            for &inst in &self.function.blocks[block].insts {
                self.compute(inst);
            }
            grew |= self.leave(block);
        }
        std::mem::swap(&mut self.back, &mut self.next_back);
        grew
    }

    /// A sweep begins.
    pub fn begin(&mut self) {
        self.sweeps += 1;
        self.forget(0);
        self.path.clear();
        self.forward.clear();
        self.next_back.clear();
    }

    /// The sweep comes to a block: what its branch has tested is known, and so are its parameters. Result: whether they grew.
    pub fn enter(&mut self, block: Block) -> bool {
        while let Some(&(above, length)) = self.path.last() {
            if self.dominators.dominates(above, block) {
                break;
            }
            self.path.pop();
            self.forget(length);
        }
        self.path.push((block, self.undo.len()));
        let entry = block == self.function.entry();
        self.reached[block.index()] |= entry;
        if !self.reached[block.index()] {
            return false;
        }
        // Jumps back to the head of a loop change nothing of what was tested before it.
        let outside = |&&pred: &&Block| !self.dominators.dominates(block, pred);
        let mut preds = self.cfg.predecessors(block).iter().filter(outside);
        if let (Some(&pred), None) = (preds.next(), preds.next()) {
            self.learn_edge(pred, block);
        }
        let mut grew = false;
        for &param in &self.function.blocks[block].params {
            let full = Interval::full(self.function.ty(param));
            let came = match (self.forward.get(&param), self.back.get(&param)) {
                _ if entry => Some(full),
                (Some(&a), Some(&b)) => Some(a.join(b)),
                (a, b) => a.or(b).copied(),
            };
            let Some(mut came) = came else { continue };
            if let Some(&limit) = self.limits.get(&param) {
                came = came.meet(limit).unwrap_or(limit);
            }
            let before = self.values[param.index()];
            if let (Some(before), Phase::Growing(sweep)) = (before, self.phase) {
                came = came.join(before);
                if came != before && sweep > LANDMARKS_UNTIL {
                    came = full;
                } else if came != before && sweep > 1 {
                    came = widened(before, came, full);
                }
            }
            grew |= before.is_none_or(|before| !before.contains(came));
            self.values[param.index()] = Some(came);
        }
        grew
    }

    /// The sweep comes to the end of a block: its jumps bring values. Result: whether they reach a block for the first time.
    pub fn leave(&mut self, block: Block) -> bool {
        let Some(inst) = self.function.terminator(block) else { return false };
        match &self.function.insts[inst] {
            InstData::Jump { target } => self.bring(block, target),
            InstData::Branch { cond, then_to, else_to } => {
                let known = self.get(*cond).and_then(Interval::single);
                let mut grew = false;
                for (target, holds) in [(then_to, true), (else_to, false)] {
                    if known.is_none_or(|known| (known != 0) == holds) {
                        let length = self.undo.len();
                        // Both arms to one block bring what they know apart.
                        if !target.args.is_empty() {
                            self.learn(*cond, holds, DEPTH_MAX);
                        }
                        grew |= self.bring(block, target);
                        self.forget(length);
                    }
                }
                grew
            }
            InstData::Switch { targets, default, .. } => {
                targets.iter().chain([default]).fold(false, |grew, target| self.bring(block, target) | grew)
            }
            _ => false,
        }
    }

    fn forget(&mut self, length: usize) {
        while self.undo.len() > length {
            let Some((value, before)) = self.undo.pop() else { break };
            self.here[value.index()] = before;
        }
    }

    fn bring(&mut self, from: Block, target: &BlockCall) -> bool {
        let new = !std::mem::replace(&mut self.reached[target.block.index()], true);
        let back = self.cfg.rpo_index(target.block) <= self.cfg.rpo_index(from);
        for (&param, &arg) in self.function.blocks[target.block].params.iter().zip(&target.args) {
            let Some(range) = self.get(arg) else { continue };
            let into = if back { &mut self.next_back } else { &mut self.forward };
            into.entry(param).and_modify(|known| *known = known.join(range)).or_insert(range);
        }
        // What is brought back is only seen in the next sweep.
        new || (back && self.phase != Phase::Shrinking && self.brought_more(target.block))
    }

    fn brought_more(&self, block: Block) -> bool {
        self.function.blocks[block].params.iter().any(|param| {
            match (self.next_back.get(param), self.values[param.index()]) {
                (Some(&next), Some(now)) => !now.contains(next),
                (Some(_), None) => true,
                (None, _) => false,
            }
        })
    }

    /// What `value` can be here; `None`: nothing, this place is not reached.
    pub fn get(&self, value: Value) -> Option<Interval> {
        let value = self.function.resolve(value);
        if let Some(bits) = self.function.constant(value) {
            let ty = self.function.ty(value);
            let tracked = ty.is_int() || ty == Type::I1;
            return Some(if tracked { Interval::constant(ty, bits) } else { Interval::full(ty) });
        }
        let range = self.values[value.index()]?;
        match self.here[value.index()] {
            Some(known) => range.meet(known),
            None => Some(range),
        }
    }

    /// Computes the results of an instruction.
    pub fn compute(&mut self, inst: Inst) {
        for &result in &self.function.results[inst] {
            self.computed[result.index()] = self.sweeps;
            let ty = self.function.ty(result);
            let range =
                if ty.is_int() || ty == Type::I1 { self.result(inst, ty) } else { Some(Interval::full(Type::I64)) };
            if range.is_some() {
                self.values[result.index()] = range;
            }
        }
    }

    fn result(&mut self, inst: Inst, ty: Type) -> Option<Interval> {
        let full = Interval::full(ty);
        let decided = |known: Option<bool>| known.map_or(full, |known| Interval::between(known.into(), known.into()));
        Some(match &self.function.insts[inst] {
            InstData::Const { bits } => Interval::constant(ty, *bits),
            InstData::Binary { op, args } => {
                let [a, b] = [self.get(args[0])?, self.get(args[1])?];
                if ty == Type::I1 { bit(*op, a, b) } else { interval::binary(*op, ty, a, b) }
            }
            InstData::IntCompare { cc, args } => {
                let [a, b] = [self.get(args[0])?, self.get(args[1])?];
                if self.function.ty(args[0]) == Type::I1 { full } else { decided(interval::compare(*cc, a, b)) }
            }
            InstData::Convert { op: op @ (ConvertOp::Sext | ConvertOp::Zext | ConvertOp::Trunc), arg } => {
                interval::convert(*op, self.function.ty(*arg), ty, self.get(*arg)?)
            }
            InstData::Select { cond, if_true, if_false } => {
                let arms = [(*if_true, true), (*if_false, false)].map(|(arm, holds)| {
                    let length = self.undo.len();
                    let possible = self.get(*cond).and_then(Interval::single).is_none_or(|known| (known != 0) == holds);
                    self.learn(*cond, holds, DEPTH_MAX);
                    let range = self.get(arm).filter(|_| possible);
                    self.forget(length);
                    range
                });
                match arms {
                    [Some(a), Some(b)] => a.join(b),
                    [a, b] => a.or(b)?,
                }
            }
            InstData::AddressOf { addr } => {
                let base = addr.base.map_or(Some(Interval::between(0, 0)), |base| self.get(base))?;
                self.address(addr, base).unwrap_or(Interval::between(0, i64::from(i32::MAX)))
            }
            InstData::Unary { op: UnaryOp::Ctz, .. } => Interval::between(0, i64::from(ty.bits())),
            _ => full,
        })
    }

    /// Where a place is from the memory base on, if that is known and its `base` does not wrap.
    fn address(&self, addr: &Address, base: Interval) -> Option<Interval> {
        let first = match addr.region {
            Region::I => layout::I,
            Region::Q => layout::Q,
            Region::M => layout::M,
            Region::Db(number) => {
                let index = self.dbs.binary_search_by_key(&number, |db| db.number).ok()?;
                self.dbs[index].address
            }
            _ => return None,
        };
        let first = i64::from(first) + i64::from(addr.offset);
        let hi = first.checked_add(base.hi)?;
        (base.is_natural() && hi <= i64::from(i32::MAX)).then(|| Interval::between(first + base.lo, hi))
    }

    /// How many passes loops begin at most, by header.
    pub fn into_passes(self) -> FxHashMap<Block, i64> {
        self.passes
    }

    /// True if the sweeps have found a way to `block`.
    pub fn is_reached(&self, block: Block) -> bool {
        self.reached[block.index()]
    }

    fn constant(&self, value: Value) -> Option<i64> {
        let bits = self.function.constant(value)?;
        Interval::constant(self.function.ty(value), bits).single()
    }
}

/// The interval with ends that grew moved on to the next landmark.
fn widened(before: Interval, now: Interval, full: Interval) -> Interval {
    let is_pointer = |end: i64| (-0x8000_0000..-0x7800_0000).contains(&end);
    let lo = if now.lo < before.lo {
        // An address that wraps within its 24 bits may be any in its area.
        let start_of_area = now.lo & !ADDRESS_MASK;
        let mark =
            LANDMARKS.iter().rev().copied().find(|&mark| mark <= now.lo).map_or(full.lo, |mark| mark.max(full.lo));
        if is_pointer(now.lo) { start_of_area } else { mark }
    } else {
        now.lo
    };
    let hi = if now.hi > before.hi {
        let end_of_area = now.hi | ADDRESS_MASK;
        let mark = LANDMARKS.iter().copied().find(|&mark| mark >= now.hi).map_or(full.hi, |mark| mark.min(full.hi));
        if is_pointer(now.hi) && end_of_area > before.hi { end_of_area } else { mark }
    } else {
        now.hi
    };
    Interval { lo, hi, zeros: now.zeros }
}

/// An operation on bits.
fn bit(op: BinaryOp, a: Interval, b: Interval) -> Interval {
    match (op, a.single(), b.single()) {
        (BinaryOp::And, Some(0), _) | (BinaryOp::And, _, Some(0)) => Interval::between(0, 0),
        (BinaryOp::Or, Some(1), _) | (BinaryOp::Or, _, Some(1)) => Interval::between(1, 1),
        (BinaryOp::And | BinaryOp::Or | BinaryOp::Xor, Some(a), Some(b)) => {
            let value = match op {
                BinaryOp::And => a & b,
                BinaryOp::Or => a | b,
                _ => a ^ b,
            };
            Interval::between(value, value)
        }
        _ => Interval::full(Type::I1),
    }
}

/// True if a jump leads back.
pub fn has_loops(function: &Function, cfg: &ControlFlow) -> bool {
    function
        .layout
        .iter()
        .filter(|&&block| cfg.is_reachable(block))
        .any(|&block| cfg.successors(block).iter().any(|&target| cfg.rpo_index(target) <= cfg.rpo_index(block)))
}
