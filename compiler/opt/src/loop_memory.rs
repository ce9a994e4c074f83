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

mod plan;
mod rewrite;

use plcc_ir::Function;

use crate::surroundings::Surroundings;

/// Carries memory through loops in a function. Result: whether there was any.
pub fn carry_memory(function: &mut Function, surroundings: &Surroundings) -> bool {
    let plan = plan::plan(function, surroundings);
    if !plan.is_empty() {
        rewrite::rewrite(function, &plan);
    }
    !plan.is_empty()
}

#[cfg(test)]
mod tests;
