//! Writes through pointers on cold sides tell the runtime that outputs may have changed.
//!
//! After each cycle the outputs go to the modules, as far as the program writes some; an S7-1500 has 32 KB of them. A pointer whose area is
//! not known may lead there. Where such a write is on a side that hardly ever runs, a note in the CPU state is cheaper than copying all
//! outputs in each cycle:
//!
//! ```text
//! b7 cold:                       ; b7 cold:
//!     store.i16 any[v5]+0, v1    ;     store.i16 any[v5]+0, v1
//!                                ;     store.i32 state 48, 1
//! ```

use plcc_abi::layout::state;
use plcc_ir::{Address, Function, InstData, Region, Type};

/// Notes writes on cold sides. Result: whether there are any.
pub fn note_outputs(function: &mut Function) -> bool {
    let mut changed = false;
    for block in function.layout.clone() {
        let data = &function.blocks[block];
        let last = data.insts.iter().rposition(|&inst| may_write_outputs(&function.insts[inst]));
        let Some(last) = last.filter(|_| data.cold) else { continue };
        let insts = || data.insts.iter().map(|&inst| &function.insts[inst]);
        if insts().any(is_note) {
            continue;
        }
        let loc = function.locs[data.insts[last]];
        let one = function.make_inst(InstData::Const { bits: 1 }, &[Type::I32], loc);
        let addr = Address::direct(Region::State, state::OUTPUTS_WRITTEN);
        let note = function.make_inst(InstData::Store { addr, value: function.result(one) }, &[], loc);
        function.blocks[block].insts.splice(last + 1..last + 1, [one, note]);
        changed = true;
    }
    changed
}

/// True of a store that may be to outputs, for all that is known of its address.
pub fn may_write_outputs(data: &InstData) -> bool {
    matches!(data, InstData::Store { addr, .. } if is_unknown(addr))
}

/// True if some output may be at `addr`.
pub fn is_unknown(addr: &Address) -> bool {
    addr.region == Region::Any || addr.region == Region::Q && addr.base.is_some()
}

/// True of a store that tells the runtime that outputs may have been written.
pub fn is_note(data: &InstData) -> bool {
    matches!(data, InstData::Store { addr, .. } if *addr == Address::direct(Region::State, state::OUTPUTS_WRITTEN))
}

#[cfg(test)]
mod tests {
    use crate::tests::check_body;

    #[test]
    fn the_last_write_of_a_cold_block_is_noted() {
        let body = |note: &str| {
            format!(
                "store.i32 any[v0]+0, v0\n branch v1, b1, b2\nb1 cold:\n store.i16 M 0, v2\n store.i32 any[v0]+0, v0\n store.i32 \
                 Q[v0]+4, v0\n{note} jump b2\nb2:\n ret v0"
            )
            .replace("v2", "v9")
            .replace("branch", "v9 = const.i16 5\n branch")
        };
        check_body("note-outputs", &body(""), &body(" v10 = const.i32 1\n store.i32 state 48, v10\n"));
        let without = "branch v1, b1, b2\nb1 cold:\n store.i32 Q 4, v0\n jump b2\nb2:\n ret v0";
        check_body("note-outputs", without, without);
    }
}
