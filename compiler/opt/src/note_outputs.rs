//! Writes through pointers tell the runtime that outputs may have changed.
//!
//! After each cycle the outputs go to the modules, as far as the program writes some; an S7-1500 has 32 KB of them. A pointer whose area is
//! not known may lead there. Many such writes are on sides that hardly ever run, or in blocks that are called there: a note in the CPU state
//! is cheaper than copying all outputs in each cycle. In a loop on a hot way each pass would pay for it.
//!
//! ```text
//! b7 cold:                       ; b7 cold:
//!     store.i16 any[v5]+0, v1    ;     store.i16 any[v5]+0, v1
//!                                ;     store.i32 state 48, 1
//! ```

use plcc_abi::layout::state;
use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::{Address, Block, Function, Inst, InstData, Region, Type};

use crate::loops::Loops;

/// Notes writes on cold sides and outside of loops. Result: whether there are any.
pub fn note_outputs(function: &mut Function) -> bool {
    let last_write = |block: &Block| {
        let insts: &[Inst] = &function.blocks[*block].insts;
        let is_noted = insts.iter().any(|&inst| is_note(&function.insts[inst]));
        let last = insts.iter().rposition(|&inst| may_write_outputs(&function.insts[inst]))?;
        (!is_noted).then_some((*block, last))
    };
    let mut writes: Vec<(Block, usize)> = function.layout.iter().filter_map(last_write).collect();
    if writes.iter().any(|&(block, _)| !function.blocks[block].cold) {
        let cfg = ControlFlow::new(function);
        let loops = Loops::new(function, &cfg, &Dominators::new(function, &cfg));
        writes.retain(|&(block, _)| function.blocks[block].cold || loops.depth(block) == 0);
    }
    let changed = !writes.is_empty();
    for (block, last) in writes {
        let data = &function.blocks[block];
        let loc = function.locs[data.insts[last]];
        let one = function.make_inst(InstData::Const { bits: 1 }, &[Type::I32], loc);
        let addr = Address::direct(Region::State, state::OUTPUTS_WRITTEN);
        let note = function.make_inst(InstData::Store { addr, value: function.result(one) }, &[], loc);
        function.blocks[block].insts.splice(last + 1..last + 1, [one, note]);
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
    fn the_last_write_of_a_block_is_noted() {
        let body = |loop_note: &str, cold_note: &str, note: &str| {
            format!(
                "jump b1\nb1:\n store.i32 any[v0]+0, v0\n{loop_note} branch v1, b2, b1\nb2:\n branch v1, b3, b4\nb3 cold:\n store.i32 \
                 any[v0]+0, v0\n store.i32 Q[v0]+4, v0\n{cold_note} jump b4\nb4:\n store.i32 any[v0]+4, v0\n{note} ret v0"
            )
        };
        let note = |value: &str| format!(" {value} = const.i32 1\n store.i32 state 48, {value}\n");
        check_body("note-outputs", &body("", "", ""), &body("", &note("v2"), &note("v3")));
        let without = "branch v1, b1, b2\nb1 cold:\n store.i32 Q 4, v0\n jump b2\nb2:\n ret v0";
        check_body("note-outputs", without, without);
    }
}
