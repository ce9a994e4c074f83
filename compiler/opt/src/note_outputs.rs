//! Writes through pointers tell the runtime when outputs have changed.
//!
//! After each cycle the outputs go to the modules, as far as the program writes some; an S7-1500 has 32 KB of them. A pointer whose area is
//! not known may lead there: code that writes through one compares the address, and makes a note in the CPU state if it is in the outputs.
//! That is cheaper than copying all outputs in each cycle. In a loop on a hot way each pass pays for it, which is worth it only where
//! there are many outputs.
//!
//! ```text
//!     store.i16 any[v5]+0, v1    ;     store.i16 any[v5]+0, v1
//!                                ;     v6 = iadd v5, 1 - Q
//!                                ;     v7 = ult v6, AREA_BYTES + 1
//!                                ;     v8 = load.i32 state 48
//!                                ;     v9 = select v7, 1, v8
//!                                ;     store.i32 state 48, v9
//! ```

use plcc_abi::RuntimeFn;
use plcc_abi::layout::{self, state};
use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::{Address, BinaryOp, Block, Function, Inst, InstData, IntCc, Loc, Region, Type, Value};

use crate::loops::Loops;
use crate::surroundings::Surroundings;

/// Bytes after an address that a text there may have.
const TEXT_BYTES_MAX: u32 = 0x1_0000;

/// Outputs that are copied in as little time as a short loop needs for its notes.
const FEW_BYTES: u32 = 2048;

/// Notes writes on cold sides and outside of loops, of a CPU with many outputs all writes. Result: whether there are any.
pub fn note_outputs(function: &mut Function, surroundings: &Surroundings) -> bool {
    let last_write = |block: &Block| {
        let insts: &[Inst] = &function.blocks[*block].insts;
        let is_noted = insts.iter().any(|&inst| is_note(&function.insts[inst]));
        let last = insts.iter().rposition(|&inst| written(function, &function.insts[inst]).is_some())?;
        (!is_noted).then_some((*block, last))
    };
    let mut writes: Vec<(Block, usize)> = function.layout.iter().filter_map(last_write).collect();
    let has_few = surroundings.areas.outputs <= FEW_BYTES;
    if has_few && writes.iter().any(|&(block, _)| !function.blocks[block].cold) {
        let cfg = ControlFlow::new(function);
        let loops = Loops::new(function, &cfg, &Dominators::new(function, &cfg));
        writes.retain(|&(block, _)| function.blocks[block].cold || loops.depth(block) == 0);
    }
    let changed = !writes.is_empty();
    for (block, last) in writes {
        let loc = function.locs[function.blocks[block].insts[last]];
        let mut note = Note { function, loc, insts: Vec::new() };
        note.write(block);
        let insts = note.insts;
        function.blocks[block].insts.splice(last + 1..last + 1, insts);
    }
    changed
}

/// The instructions of a note.
struct Note<'a> {
    function: &'a mut Function,
    loc: Loc,
    insts: Vec<Inst>,
}

impl Note<'_> {
    /// Makes the note of all writes in a block.
    fn write(&mut self, block: Block) {
        // Where writes begin and end from each base; `None`: some are surely to outputs.
        let mut ranges: Option<Vec<(Value, u32, u32)>> = Some(Vec::new());
        for &inst in &self.function.blocks[block].insts {
            let Some(written) = written(self.function, &self.function.insts[inst]) else { continue };
            ranges = match (ranges, written) {
                (Some(mut ranges), Written::From { base, start, end }) => {
                    match ranges.iter_mut().find(|range| range.0 == base) {
                        Some(range) => *range = (base, range.1.min(start), range.2.max(end)),
                        None => ranges.push((base, start, end)),
                    }
                    Some(ranges)
                }
                _ => None,
            };
        }
        let one = self.add(InstData::Const { bits: 1 }, Type::I32);
        let conditions: Option<Vec<Value>> =
            ranges.map(|ranges| ranges.into_iter().map(|range| self.is_output(range)).collect());
        let addr = Address::direct(Region::State, state::OUTPUTS_WRITTEN);
        let value = match conditions.as_deref() {
            None | Some([]) => one,
            Some([first, rest @ ..]) => {
                let cond = rest.iter().fold(*first, |any, &next| {
                    self.add(InstData::Binary { op: BinaryOp::Or, args: [any, next] }, Type::I1)
                });
                let before = self.add(InstData::Load { addr }, Type::I32);
                self.add(InstData::Select { cond, if_true: one, if_false: before }, Type::I32)
            }
        };
        let note = self.function.make_inst(InstData::Store { addr, value }, &[], self.loc);
        self.insts.push(note);
    }

    /// Whether a byte from `start` to before `end` after the base is an output.
    fn is_output(&mut self, (base, start, end): (Value, u32, u32)) -> Value {
        let span = end - start;
        // The last byte, from the first output on: at most the area and what is before the last byte.
        let distance = end.wrapping_sub(1).wrapping_sub(layout::Q);
        let distance = self.add(InstData::Const { bits: distance.into() }, Type::I32);
        let last = self.add(InstData::Binary { op: BinaryOp::Iadd, args: [base, distance] }, Type::I32);
        let bits = u64::from(layout::AREA_BYTES.saturating_add(span - 1));
        let limit = self.add(InstData::Const { bits }, Type::I32);
        self.add(InstData::IntCompare { cc: IntCc::Ult, args: [last, limit] }, Type::I1)
    }

    fn add(&mut self, data: InstData, ty: Type) -> Value {
        let inst = self.function.make_inst(data, &[ty], self.loc);
        self.insts.push(inst);
        self.function.result(inst)
    }
}

/// Where an instruction writes outputs, perhaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// From `start` to before `end` after `base`, which is a distance from the beginning of memory.
    From { base: Value, start: u32, end: u32 },
    /// Somewhere in the outputs.
    Outputs,
}

/// Where an instruction writes through a pointer, if outputs may be there.
pub fn written(function: &Function, data: &InstData) -> Option<Written> {
    let (addr, bytes) = match data {
        InstData::Store { addr, value } => (addr, function.ty(*value).bytes()),
        InstData::StoreBit { addr, .. } => (addr, 1),
        InstData::Clear { addr, len } | InstData::Copy { to: addr, len, .. } => (addr, *len),
        InstData::CallRuntime { function: called, args } => {
            let base = text_target(*called, args)?;
            let from = Written::From { base, start: 0, end: TEXT_BYTES_MAX };
            return (!is_elsewhere(function, base)).then_some(from);
        }
        _ => return None,
    };
    match (addr.region, addr.base) {
        (Region::Any, Some(base)) if bytes > 0 => {
            Some(Written::From { base, start: addr.offset, end: addr.offset.saturating_add(bytes) })
        }
        (Region::Any | Region::Q, _) if is_unknown(addr) => Some(Written::Outputs),
        _ => None,
    }
}

/// Where a function of the runtime writes a text.
pub fn text_target(called: RuntimeFn, args: &[Value]) -> Option<Value> {
    match called {
        RuntimeFn::CopyText => args.first().copied(),
        RuntimeFn::TextConcat
        | RuntimeFn::TextConcatThree
        | RuntimeFn::TextReplace
        | RuntimeFn::TextLeft
        | RuntimeFn::TextRight
        | RuntimeFn::TextMid
        | RuntimeFn::TextDelete
        | RuntimeFn::TextInsert
        | RuntimeFn::TextOfDint
        | RuntimeFn::TextOfReal
        | RuntimeFn::TextFixedOfReal => args.last().copied(),
        _ => None,
    }
}

/// True if `address` is surely not one of the outputs.
fn is_elsewhere(function: &Function, address: Value) -> bool {
    let is_output = |at: u64| (u64::from(layout::Q)..u64::from(layout::Q + layout::AREA_BYTES)).contains(&at);
    match function.defining(address) {
        Some(InstData::Const { bits }) => !is_output(*bits),
        Some(InstData::AddressOf { addr }) => !matches!(addr.region, Region::Q | Region::Any),
        Some(InstData::DbBase { .. }) => true,
        Some(InstData::Binary { op: BinaryOp::Iadd, args: [start, distance] }) => {
            let is_start = matches!(
                function.defining(*start),
                Some(
                    InstData::DbBase { .. }
                        | InstData::AddressOf { addr: Address { region: Region::L | Region::V, .. } }
                )
            );
            is_start && function.constant(*distance).is_some_and(|distance| distance < u64::from(layout::AREA_BYTES))
        }
        _ => false,
    }
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
    use plcc_abi::layout::{AREA_BYTES, Q};

    use crate::tests::check_body;

    /// The note of writes from v0, with values from `first` on; `distance` and `limit` of its comparison.
    fn note(first: u32, distance: u32, limit: u32) -> String {
        let v = |number: u32| format!("v{}", first + number);
        format!(
            " {} = const.i32 1\n {} = const.i32 {}\n {} = iadd v0, {}\n {} = const.i32 {limit}\n {} = ult {}, {}\n {} = load.i32 state \
             48\n {} = select {}, {}, {}\n store.i32 state 48, {}\n",
            v(0),
            v(1),
            distance.wrapping_sub(Q),
            v(2),
            v(1),
            v(3),
            v(4),
            v(2),
            v(3),
            v(5),
            v(6),
            v(4),
            v(0),
            v(5),
            v(6)
        )
    }

    #[test]
    fn all_writes_of_a_block_are_noted_after_the_last_one() {
        let body = |loop_note: &str, cold_note: &str, note: &str| {
            format!(
                "jump b1\nb1:\n store.i32 any[v0]+0, v0\n{loop_note} branch v1, b2, b1\nb2:\n branch v1, b3, b4\nb3 cold:\n store.i32 \
                 any[v0]+0, v0\n store.i32 Q[v0]+4, v0\n{cold_note} jump b4\nb4:\n store.bit any[v0]+9.1, v1\n copy any[v0]+4, M 0, \
                 2\n{note} ret v0"
            )
        };
        // Surely outputs.
        let outputs = " v2 = const.i32 1\n store.i32 state 48, v2\n";
        check_body("note-outputs", &body("", "", ""), &body("", outputs, &note(3, 9, AREA_BYTES + 5)));
        let without = "branch v1, b1, b2\nb1 cold:\n store.i32 Q 4, v0\n jump b2\nb2:\n ret v0";
        check_body("note-outputs", without, without);
    }

    #[test]
    fn a_text_is_noted_where_it_may_be_an_output() {
        let body = |to: &str, note: &str| {
            format!(" v2 = const.i64 0\n {to} v4 = rt @text_concat(v2, v0, v0, v3)\n{note} ret v0")
        };
        check_body("note-outputs", &body("v3 = address M 4\n", ""), &body("v3 = address M 4\n", ""));
    }
}
