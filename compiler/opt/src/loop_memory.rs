//! Places in memory that a loop reads or writes in each pass become values.
//!
//! STL has its sums and counters in data blocks and bit memory, an S7-200 even its accumulators, so that each pass of a loop would
//! load, compute and store, and wait for the store of the pass before. If nothing else in the loop can reach a place, it is loaded
//! once before the loop and stored once after it:
//!
//! ```text
//! b1:                        ;     v0 = load.i32 DB1 8
//!     v1 = load.i32 DB1 8    ;     jump b1(v0)
//!     v2 = iadd v1, v9       ; b1(v1: i32):
//!     store.i32 DB1 8, v2    ;     v2 = iadd v1, v9
//!     branch v3, b1, b2      ;     branch v3, b1(v2), b2
//! b2:                        ; b2:
//!                            ;     store.i32 DB1 8, v2
//! ```
//!
//! On its cold sides a loop may do what it likes: before something that may look at the place it is stored, after something that
//! may have changed it (see `effects`) it is loaded again. Storing a place that was not written in between changes nothing,
//! since nothing else runs.
//!
//! What else can reach the place is decided by regions, and by the ranges of the bases of indexed accesses: a sum after an array is
//! not an element of it. The largest loop is best, so that outer loops choose first.
//!
//! A pointer or a counter that is in memory itself has no range before it is a value, and becomes a value only if no pointer reaches it.
//! So the pass guesses that indexed accesses reach none of the places, makes these values in a copy of the function, and looks at the
//! ranges there. Where they say that the guesses were right, no access is ever the first one to reach a place in the copy, and up to that
//! one the copy does what the function does: the guesses hold for the function too. Wrong ones are taken back, and the rest tried again.

mod plan;
mod rewrite;

use plcc_ir::Function;
use rustc_hash::FxHashSet;

use crate::fold::fold;
use crate::forward::forward_memory;
use crate::ranges::use_ranges;
use crate::surroundings::Surroundings;

/// Guesses are made for functions with at most so many instructions, and so often.
const GUESSED_INSTS_MAX: usize = 20_000;
const GUESSES_MAX: usize = 3;

/// Carries memory through loops in a function. Result: whether there was any.
pub fn carry_memory(function: &mut Function, surroundings: &Surroundings) -> bool {
    if let Some(guessed) = carry_by_guesses(function, surroundings) {
        *function = guessed;
        return true;
    }
    let plan = plan::plan(function, surroundings, None);
    if !plan.is_empty() {
        rewrite::rewrite(function, &plan);
    }
    !plan.is_empty()
}

/// The function after guesses that were right, if there are any.
fn carry_by_guesses(function: &Function, surroundings: &Surroundings) -> Option<Function> {
    if function.insts.len() > GUESSED_INSTS_MAX {
        return None;
    }
    let mut refused = FxHashSet::default();
    for _ in 0..GUESSES_MAX {
        let plan = plan::plan(function, surroundings, Some(&refused));
        if plan.iter().flat_map(|carrier| &carrier.places).all(|carried| carried.assumed.is_empty()) {
            return None;
        }
        let mut copy = function.clone();
        rewrite::rewrite(&mut copy, &plan);
        // Constants reach the values, then the first look at ranges finds by how much they change in each pass.
        forward_memory(&mut copy, surroundings);
        fold(&mut copy);
        use_ranges(&mut copy, surroundings);
        fold(&mut copy);
        let wrong = plan::unproven(&plan, function, &copy, surroundings);
        if wrong.is_empty() {
            return Some(copy);
        }
        refused.extend(wrong);
    }
    None
}

#[cfg(test)]
mod tests;
