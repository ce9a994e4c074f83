//! Counters: what the runtime itself asks. Generated code counts; see `cells.rs` of the lowering.

use plcc_abi::layout::{self, COUNTER_CELL_BYTES, TIMERS_MAX, counter_cell};

use crate::memory::Memory;

/// The largest count.
pub const MAX: u16 = 999;

/// Count, 0..=999; 0 if there is no counter `number`.
pub fn value(memory: &Memory, number: u32) -> u32 {
    if number >= TIMERS_MAX {
        return 0;
    }
    let at = layout::C + COUNTER_CELL_BYTES * number + counter_cell::COUNT;
    u32::from(u16::from_ne_bytes(memory.bytes(at)))
}

/// Gives a counter another count, 0..=999. A counter that does not exist takes none.
pub fn set_value(memory: &Memory, number: u32, count: u16) {
    if number < TIMERS_MAX {
        let at = layout::C + COUNTER_CELL_BYTES * number + counter_cell::COUNT;
        memory.set_bytes(at, count.min(MAX).to_ne_bytes());
    }
}
