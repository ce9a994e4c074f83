//! Local data that only cold ways look at are stored there.
//!
//! A block that moves data, or a function of texts, is done in place where a test says that it can be; on the other side remains the
//! call, which finds its parameters in local data: pointers, lengths, constant texts. Where the way without the call does not look
//! at them, storing them is left to the cold side.
//!
//! ```text
//! store.i32 L 6, v1          ; branch v2, b1, b2
//! branch v2, b1, b2          ; b1:
//! b1:                        ;     copy DB2 0, DB1[v3]+0, 40
//!     copy DB2 0, DB1[v3]+0, 40
//! b2 cold:                   ; b2 cold:
//!     rt @system_function    ;     store.i32 L 6, v1
//!                            ;     rt @system_function
//! ```
//!
//! From each store the pass walks on until every way has come to the end of the function, to a store of the same bytes, or to a cold block.
//! If nobody looks at the bytes before, and those cold blocks are entered from such ways only, the store goes to the beginning of each. At most
//! [`TARGETS_MAX`] of them get it; what one walk and all of them look at is limited, so time stays linear.

use plcc_abi::functions::Effect;
use plcc_ir::analysis::ControlFlow;
use plcc_ir::{Address, Block, Function, Inst, InstData, Region};

use crate::extents::Access;
use crate::frames::Frames;
use crate::surroundings::Surroundings;

/// Cold blocks that get a store.
const TARGETS_MAX: usize = 3;
/// Blocks that one walk looks at.
const BLOCKS_MAX: usize = 24;
/// Instructions that one walk looks at.
const STEPS_MAX: usize = 600;
/// Instructions that all walks look at, for each instruction of the function.
const STEPS_PER_INST: usize = 16;

/// Moves stores to cold blocks in a function. Result: whether there were any.
pub fn sink_stores(function: &mut Function, surroundings: &Surroundings) -> bool {
    let is_cold = |&block: &Block| function.blocks[block].cold;
    if function.frame_bytes == 0 || !function.layout.iter().any(is_cold) {
        return false;
    }
    let is_candidate = |block: Block| {
        let block = &function.blocks[block];
        !block.cold && block.insts.iter().any(|&inst| written(function, inst).is_some())
    };
    let blocks: Vec<Block> = function.layout.iter().copied().filter(|&block| is_candidate(block)).collect();
    if blocks.is_empty() {
        return false;
    }
    let frames = surroundings.frames(function);
    let cfg = ControlFlow::new(function);
    let mut steps = function.insts.len().saturating_mul(STEPS_PER_INST);
    let mut changed = false;
    for block in blocks.into_iter().filter(|&block| cfg.is_reachable(block)) {
        // From the end, so that a store comes before those that were after it.
        for at in (0..function.blocks[block].insts.len()).rev() {
            let inst = function.blocks[block].insts[at];
            let Some(access) = written(function, inst) else { continue };
            let mut walk = Walk { function, frames: &frames, cfg: &cfg, access, steps: STEPS_MAX.min(steps) };
            let begun_with = walk.steps;
            let targets = walk.targets(block, at);
            steps -= begun_with - walk.steps;
            let Some(targets) = targets else { continue };
            for target in targets {
                let copy = function.make_inst(function.insts[inst].clone(), &[], function.locs[inst]);
                function.blocks[target].insts.insert(0, copy);
            }
            function.blocks[block].insts.remove(at);
            changed = true;
        }
    }
    changed
}

/// The own local data that an instruction only writes.
fn written(function: &Function, inst: Inst) -> Option<Access> {
    let is_local = |addr: &Address| addr.region == Region::L && addr.base.is_none();
    match &function.insts[inst] {
        InstData::Store { addr, value } if is_local(addr) => Some(Access::of_type(addr, function.ty(*value))),
        InstData::StoreBit { addr, bit, .. } if is_local(addr) => Some(Access::bit(addr, *bit)),
        InstData::Clear { addr, len } if is_local(addr) && *len > 0 => Some(Access::bytes(addr, *len)),
        _ => None,
    }
}

/// What a way does with the bytes of a store.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// It goes on to the end of the block.
    On,
    /// It writes all of them, or ends the function.
    Ends,
    /// It looks at them, or writes some of them.
    Looks,
}

struct Walk<'w> {
    function: &'w Function,
    frames: &'w Frames<'w>,
    cfg: &'w ControlFlow,
    access: Access,
    /// Instructions that may still be looked at.
    steps: usize,
}

impl Walk<'_> {
    /// The cold blocks that need the store at place `at` of `block`; `None`: it stays.
    fn targets(&mut self, block: Block, at: usize) -> Option<Vec<Block>> {
        let mut passed = vec![block];
        let mut ended: Vec<Block> = Vec::new();
        let mut cold: Vec<Block> = Vec::new();
        match self.way(block, at + 1) {
            Way::On => {}
            // What nobody looks at any more is left to the pass for that.
            Way::Ends | Way::Looks => return None,
        }
        let mut next = 0;
        while let Some(&from) = passed.get(next) {
            next += 1;
            for &to in self.cfg.successors(from) {
                if to == block {
                    // The store itself comes again.
                    match self.way(block, 0) {
                        Way::On | Way::Looks => return None,
                        Way::Ends => continue,
                    }
                }
                if passed.contains(&to) || ended.contains(&to) || cold.contains(&to) {
                    continue;
                }
                let is_cold = self.function.blocks[to].cold;
                match self.way(to, 0) {
                    Way::Ends => ended.push(to),
                    Way::On | Way::Looks if is_cold => cold.push(to),
                    Way::On => passed.push(to),
                    Way::Looks => return None,
                }
                if cold.len() > TARGETS_MAX || passed.len() > BLOCKS_MAX {
                    return None;
                }
            }
        }
        // What comes from elsewhere must not get the store.
        let come_from = |to: Block, from: &[Block]| self.cfg.predecessors(to).iter().all(|pred| from.contains(pred));
        if !cold.iter().all(|&to| come_from(to, &passed)) {
            return None;
        }
        let after = self.cold_blocks_after(&cold)?;
        let mut known = passed.clone();
        known.extend(&after);
        if !passed[1..].iter().all(|&to| come_from(to, &known)) {
            return None;
        }
        // A cold side may write the bytes: what goes on after it must not come to another one.
        let mut joined: Vec<Block> = Vec::new();
        let is_next = |from: &[Block], joined: &[Block], to: Block| {
            to != block && !joined.contains(&to) && self.cfg.predecessors(to).iter().any(|pred| from.contains(pred))
        };
        joined.extend(passed.iter().filter(|&&to| is_next(&after, &[], to)));
        let mut next = 0;
        while let Some(&from) = joined.get(next) {
            next += 1;
            joined.extend(passed.iter().copied().filter(|&to| is_next(&[from], &joined, to)).collect::<Vec<_>>());
            if self.cfg.successors(from).iter().any(|to| cold.contains(to)) {
                return None;
            }
        }
        Some(cold)
    }

    /// Cold blocks and those cold ones to which they lead; `None`: others lead there, too.
    fn cold_blocks_after(&self, cold: &[Block]) -> Option<Vec<Block>> {
        let mut after = cold.to_vec();
        let mut next = 0;
        while let Some(&from) = after.get(next) {
            next += 1;
            for &to in self.cfg.successors(from) {
                if self.function.blocks[to].cold && !after.contains(&to) {
                    after.push(to);
                }
            }
            if after.len() > BLOCKS_MAX {
                return None;
            }
        }
        let others = &after[cold.len()..];
        let is_after = |&to: &Block| self.cfg.predecessors(to).iter().all(|pred| after.contains(pred));
        others.iter().all(is_after).then_some(after)
    }

    /// What the instructions of `block` from place `from` on do.
    fn way(&mut self, block: Block, from: usize) -> Way {
        for &inst in &self.function.blocks[block].insts[from..] {
            if self.steps == 0 {
                return Way::Looks;
            }
            self.steps -= 1;
            match self.step(inst) {
                Way::On => {}
                way => return way,
            }
        }
        Way::On
    }

    fn step(&self, inst: Inst) -> Way {
        let looks = |other: Access| if self.meets(other) { Way::Looks } else { Way::On };
        let writes = |other: Access| {
            let is_same = (other.region, other.base) == (self.access.region, self.access.base);
            if is_same && other.start <= self.access.start && self.access.end <= other.end {
                Way::Ends
            } else {
                looks(other)
            }
        };
        match &self.function.insts[inst] {
            InstData::Load { addr } => looks(Access::of_type(addr, self.function.ty(self.function.result(inst)))),
            InstData::LoadBit { addr, bit } => looks(Access::bit(addr, *bit)),
            InstData::Store { addr, value } => writes(Access::of_type(addr, self.function.ty(*value))),
            InstData::StoreBit { addr, bit, .. } => writes(Access::bit(addr, *bit)),
            InstData::Clear { addr, len } => writes(Access::bytes(addr, *len)),
            InstData::Copy { to, from, len } => match looks(Access::bytes(from, *len)) {
                Way::Looks => Way::Looks,
                _ => writes(Access::bytes(to, *len)),
            },
            InstData::Call { callee, .. } if self.frames.call_touches(*callee) => Way::Looks,
            InstData::CallRuntime { function, .. }
                if matches!(function.effect(), Effect::Reads | Effect::All) && !self.frames.is_private() =>
            {
                Way::Looks
            }
            InstData::Return { .. } => Way::Ends,
            InstData::Call { .. }
            | InstData::CallRuntime { .. }
            | InstData::Const { .. }
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
            | InstData::Switch { .. } => Way::On,
        }
    }

    /// True if another access may touch bytes of the store.
    fn meets(&self, other: Access) -> bool {
        if other.region == Region::L && other.base.is_none() {
            return other.start < self.access.end && self.access.start < other.end;
        }
        other.region.may_alias(Region::L)
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::check_body;

    fn check(body: &str, expected: &str) {
        check_body("sink-stores", body, expected);
    }

    /// A function that takes the address of its frame, with a cold side that may look at it.
    fn text(before: &str, hot: &str, cold: &str) -> String {
        format!(
            "v2 = frame_base\nv3 = const.i32 20\n{before}branch v1, b1, b2\nb1:\n{hot}jump b3\nb2 cold:\n{cold}v4 = rt \
             @system_function(v3, v3, v2, v2)\njump b3\nb3:\nret v0"
        )
    }

    #[test]
    fn parameters_of_a_cold_call_are_stored_there() {
        check(
            &text("store.i32 L 0, v0\nclear L 4, 2\nstore.bit L 0.0, v1\n", "store.i32 M 0, v0\n", ""),
            &text("", "store.i32 M 0, v0\n", "store.i32 L 0, v0\nclear L 4, 2\nstore.bit L 0.0, v1\n"),
        );
    }

    #[test]
    fn what_the_hot_way_looks_at_stays() {
        for hot in [
            "v5 = load.i8 L 3\n",
            "v5 = load.i8 any[v0]+0\n",
            "store.i8 L 1, v6\nv5 = load.i32 L 0\n",
            "v5 = rt @safepoint(v0)\n",
        ] {
            let hot = if hot.contains("v6") { format!("v6 = trunc.i8 v0\n{hot}") } else { hot.to_string() };
            let text = text("store.i32 L 0, v0\n", &hot, "");
            check(&text, &text);
        }
        let merged = "v2 = frame_base\nstore.i32 L 0, v0\nbranch v1, b1, b2\nb1:\njump b3\nb2 cold:\nv4 = rt @safepoint(v2)\njump \
                      b3\nb3:\nv5 = load.i32 L 0\nret v5";
        check(merged, merged);
    }

    #[test]
    fn what_is_written_again_needs_no_store() {
        check(
            &text("store.i32 L 0, v0\nstore.i32 L 8, v0\n", "store.i32 L 0, v3\nv5 = load.i32 L 0\n", ""),
            &text("", "store.i32 L 0, v3\nv5 = load.i32 L 0\n", "store.i32 L 0, v0\nstore.i32 L 8, v0\n"),
        );
    }

    #[test]
    fn a_cold_block_that_others_enter_gets_nothing() {
        let text = "v2 = frame_base\nv3 = const.i32 20\nbranch v1, b1, b2\nb1:\nstore.i32 L 0, v0\nbranch v1, b3, b2\nb2 cold:\nv4 = rt \
                    @system_function(v3, v3, v2, v2)\njump b3\nb3:\nret v0";
        check(text, text);
    }

    #[test]
    fn after_a_cold_side_that_may_write_the_bytes_there_is_no_other() {
        let text = |store: &str, end: &str, cold: &str| {
            format!(
                "v2 = frame_base\n{store}jump b1\nb1:\nbranch v1, b2, b3\nb2:\n{end}b3 cold:\n{cold}v3 = rt @safepoint(v2)\njump \
                 b2\nb4:\nret v0"
            )
        };
        let store = "store.i32 L 0, v0\n";
        for end in ["branch v1, b1, b4\n", "branch v1, b4, b5\nb5 cold:\nv4 = rt @safepoint(v2)\njump b4\n"] {
            check(&text(store, end, ""), &text(store, end, ""));
        }
        let end = "store.i32 M 0, v0\njump b4\n";
        check(&text(store, end, ""), &text("", end, store));
    }
}
