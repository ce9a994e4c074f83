//! Comparisons, masks and checks that the range of a value decides.
//!
//! The analysis finds which numbers each value can be: what a branch has tested, how far the variable of a loop gets, which
//! low bits of a pointer are 0. With that most checks of indexed accesses go, and what is left of an address is a shift:
//!
//! ```text
//! b2(v1: i16):               ; FOR #i := 0 TO 99: v1 is 0 to 99
//!     v2 = sext.i32 v1
//!     v3 = ule v2, 99        ; is true
//!     v4 = shl v2, 4         ; the pointer of an INT in a table, in bits ...
//!     v5 = ashr v4, 3        ; ... and in bytes: shl v2, 1
//! ```
//!
//! An access at the address of an element of an array, which was passed to a block that is now part of its caller, is one of that
//! array where the index says so (`access.rs`).
//!
//! `analysis.rs` finds the ranges, `change.rs` says what an instruction becomes with them, and `apply.rs` makes the changes.

mod access;
mod analysis;
mod apply;
mod change;
mod interval;
mod polls;

use crate::loops::Loops;
use crate::surroundings::Surroundings;
use analysis::Ranges;
use change::Change;
use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::{BinaryOp, Block, Function, Inst, InstData, Value};
use rustc_hash::FxHashMap;

/// Larger functions are left as they are: each sweep looks at all of their code.
const INSTS_MAX: usize = 400_000;
/// So are functions whose jumps bring more values.
const ARGUMENTS_MAX: usize = 1_000_000;

fn is_too_large(function: &Function) -> bool {
    let mut arguments = 0;
    for inst in function.layout.iter().filter_map(|&block| function.terminator(block)) {
        function.insts[inst].for_each_target(|call| arguments += call.args.len());
    }
    function.insts.len() > INSTS_MAX || arguments > ARGUMENTS_MAX
}

/// See [`base_ranges`].
pub type BaseRanges = FxHashMap<Inst, [Option<(u64, u64)>; 2]>;

/// The numbers, from least to greatest, that the bases of an instruction's addresses can be where it is; a copy has two. Bases of
/// which nothing is known are left out.
pub fn base_ranges(function: &Function, cfg: &ControlFlow, dominators: &Dominators) -> BaseRanges {
    let mut found = BaseRanges::default();
    if is_too_large(function) {
        return found;
    }
    let Some(mut ranges) = Ranges::of(function, cfg, dominators, &[]) else { return found };
    ranges.begin();
    for &block in &dominators.preorder {
        ranges.enter(block);
        if !ranges.is_reached(block) {
            continue;
        }
        for &inst in &function.blocks[block].insts {
            ranges.compute(inst);
            let mut index = 0;
            function.insts[inst].for_each_address(|addr| {
                let range = addr.base.and_then(|base| ranges.get(base)).filter(|range| range.is_natural());
                if let Some(range) = range {
                    found.entry(inst).or_insert([None; 2])[index] = Some((range.lo as u64, range.hi as u64));
                }
                index += 1;
            });
        }
        ranges.leave(block);
    }
    found
}

/// Uses ranges in a function.
///
/// Result: whether anything changed.
pub fn use_ranges(function: &mut Function, surroundings: &Surroundings) -> bool {
    use_all(function, surroundings, false)
}

/// `last`: also for what hides how far pointers get from passes that have run by then.
fn use_all(function: &mut Function, surroundings: &Surroundings, last: bool) -> bool {
    if is_too_large(function) {
        return false;
    }
    let first = use_once(function, surroundings, last);
    // A sum in the wide type, then its multiple, then the address: each shows when the one before is there.
    if first.has_sums {
        use_once(function, surroundings, last);
        use_once(function, surroundings, last);
    }
    first.changed
}

/// Uses ranges in a function with loops: for the pointers of loops that have been rid of cold ways.
///
/// Result: whether anything changed.
pub fn use_ranges_of_loops(function: &mut Function, surroundings: &Surroundings) -> bool {
    analysis::has_loops(function, &ControlFlow::new(function)) && use_all(function, surroundings, true)
}

/// What one look at the ranges did.
#[derive(Default)]
struct Done {
    changed: bool,
    /// There are new sums of indices and constants.
    has_sums: bool,
}

fn use_once(function: &mut Function, surroundings: &Surroundings, last: bool) -> Done {
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let Some(mut ranges) = Ranges::of(function, &cfg, &dominators, &surroundings.dbs) else { return Done::default() };
    let mut changes: Vec<(Block, Inst, Change)> = Vec::new();
    ranges.begin();
    for &block in &dominators.preorder {
        ranges.enter(block);
        if !ranges.is_reached(block) {
            continue;
        }
        for &inst in &function.blocks[block].insts {
            ranges.compute(inst);
            let change = access::addresses(function, &ranges, surroundings, inst)
                .or_else(|| if last { access::from_the_least(function, &ranges, inst) } else { None })
                .or_else(|| change::change_of(function, &ranges, inst));
            if let Some(change) = change {
                changes.push((block, inst, change));
            }
        }
        ranges.leave(block);
    }
    let passes = ranges.into_passes();
    if !passes.is_empty() {
        polls::remove(function, &cfg, &Loops::new(function, &cfg, &dominators), &passes);
    }
    let has_sums = changes.iter().any(|(_, inst, change)| match change {
        Change::ExtendAndAdd(..) | Change::MaskAndAdd(..) => true,
        // A sum that has lost its mask is shifted in parts.
        Change::Value(sum) => change::is_mask(&function.insts[*inst]) && is_sum(function, *sum),
        _ => false,
    });
    let changed = !changes.is_empty() || !passes.is_empty();
    apply::apply(function, changes);
    Done { changed, has_sums }
}

fn is_sum(function: &Function, value: Value) -> bool {
    matches!(function.defining(value), Some(InstData::Binary { op: BinaryOp::Iadd, .. }))
}

#[cfg(test)]
mod tests;
