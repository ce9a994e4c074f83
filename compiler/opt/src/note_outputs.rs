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
use plcc_abi::functions::Effect;
use plcc_abi::layout::{self, state};
use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::function::ValueDef;
use plcc_ir::{Address, BinaryOp, Block, ConvertOp, Function, Inst, InstData, IntCc, Loc, Region, Type, Value};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::loops::Loops;
use crate::surroundings::Surroundings;

/// Bytes after an address that a text there may have.
const TEXT_BYTES_MAX: u32 = 0x1_0000;

/// Distances up to this are small. Around the outputs nothing that is larger is written often.
const SMALL_MAX: i64 = 0x2_0000;

/// After the last output.
const OUTPUTS_END: i64 = (layout::Q + layout::AREA_BYTES) as i64;

/// Outputs that are copied in as little time as a short loop needs for its notes.
const FEW_BYTES: u32 = 2048;

/// Notes writes on cold sides and outside of loops, of a CPU with many outputs all writes. Result: whether there are any.
pub fn note_outputs(function: &mut Function, surroundings: &Surroundings) -> bool {
    let is_write = |inst: &Inst| written(function, &function.insts[*inst]).is_some();
    if !function.layout.iter().any(|&block| function.blocks[block].insts.iter().any(is_write)) {
        return false;
    }
    let cfg = ControlFlow::new(function);
    let writes = Writes::of(function, &cfg);
    let has_note = |block: Block| function.blocks[block].insts.iter().any(|&inst| is_note(&function.insts[inst]));
    let has_few = surroundings.areas.outputs <= FEW_BYTES;
    let loops = has_few.then(|| Loops::new(function, &cfg, &Dominators::new(function, &cfg)));
    let is_noted = |block: Block| {
        function.blocks[block].cold || loops.as_ref().is_none_or(|loops| loops.depth(block) == 0) || has_note(block)
    };
    let later = writes.noted_later(function, &cfg, &is_noted);
    let blocks: Vec<Block> = function
        .layout
        .iter()
        .copied()
        .filter(|block| writes.of_blocks.contains_key(block) && !later.contains(block))
        .filter(|&block| is_noted(block) && !has_note(block))
        .collect();
    for &block in &blocks {
        let of_block = &writes.of_blocks[&block];
        let loc = function.locs[function.blocks[block].insts[of_block.last]];
        let mut note = Note { function, loc, insts: Vec::new() };
        note.write(of_block, &writes.ranges);
        let insts = note.insts;
        function.blocks[block].insts.splice(of_block.last + 1..of_block.last + 1, insts);
    }
    !blocks.is_empty()
}

/// What a function writes through pointers.
pub struct Writes {
    /// For each value from which addresses are computed, where writes begin and end from it, in all of the function.
    ranges: Vec<(Value, i64, i64)>,
    of_blocks: FxHashMap<Block, BlockWrites>,
}

/// What a block writes through pointers.
#[derive(Default)]
struct BlockWrites {
    /// Indices into the ranges.
    from: Vec<usize>,
    /// Some writes are surely to outputs.
    outputs: bool,
    /// The last such instruction.
    last: usize,
}

impl Writes {
    pub fn of(function: &Function, cfg: &ControlFlow) -> Writes {
        let mut writes = Writes { ranges: Vec::new(), of_blocks: FxHashMap::default() };
        let mut places: FxHashMap<Value, usize> = FxHashMap::default();
        for &block in &function.layout {
            let mut of_block: Option<BlockWrites> = None;
            for (index, &inst) in function.blocks[block].insts.iter().enumerate() {
                let Some(written) = written(function, &function.insts[inst]) else { continue };
                let Written::From { base, start, end } = written else {
                    let of_block = of_block.get_or_insert_default();
                    (of_block.outputs, of_block.last) = (true, index);
                    continue;
                };
                let (base, start, end) = origin(function, cfg, (base, start, end));
                if let Some((least, greatest)) = small(function, cfg, base, 0)
                    && (start + least >= OUTPUTS_END || end + greatest <= i64::from(layout::Q))
                {
                    continue;
                }
                let place = *places.entry(base).or_insert(writes.ranges.len());
                match writes.ranges.get_mut(place) {
                    Some(range) => *range = (base, range.1.min(start), range.2.max(end)),
                    None => writes.ranges.push((base, start, end)),
                }
                let of_block = of_block.get_or_insert_default();
                of_block.last = index;
                if !of_block.from.contains(&place) {
                    of_block.from.push(place);
                }
            }
            if let Some(of_block) = of_block {
                writes.of_blocks.insert(block, of_block);
            }
        }
        writes
    }

    /// Whether a block may write outputs through a pointer.
    pub fn may_be_in(&self, block: Block) -> bool {
        self.of_blocks.contains_key(&block)
    }

    /// Blocks whose writes need no note of their own: whichever way the function goes on, a block that `is_noted` and writes from the same
    /// places comes before the next call. Many blocks write one text, or one structure, and the last of them makes the note.
    pub fn noted_later(
        &self,
        function: &Function,
        cfg: &ControlFlow,
        is_noted: &dyn Fn(Block) -> bool,
    ) -> FxHashSet<Block> {
        /// Places that are looked at, one bit each.
        const PLACES_MAX: usize = u128::BITS as usize;
        /// Rounds until loops know what comes after them; later ones only find that less is noted.
        const ROUNDS_MAX: usize = 8;
        if self.of_blocks.len() < 2 {
            return FxHashSet::default();
        }
        let places = |block: Block| {
            let of_block = self.of_blocks.get(&block);
            let from = of_block.into_iter().flat_map(|of_block| &of_block.from);
            from.filter(|place| **place < PLACES_MAX).fold(0u128, |bits, &place| bits | 1 << place)
        };
        let calls = |block: Block| {
            function.blocks[block].insts.iter().any(|&inst| match &function.insts[inst] {
                InstData::Call { .. } => true,
                InstData::CallRuntime { function, .. } => !matches!(function.effect(), Effect::Pure | Effect::Cells),
                _ => false,
            })
        };
        // Of each block, what is noted from its beginning on.
        let mut before: FxHashMap<Block, u128> = FxHashMap::default();
        let after = |before: &FxHashMap<Block, u128>, block: Block| match cfg.successors(block) {
            [] => 0,
            next => next.iter().fold(u128::MAX, |all, next| all & before.get(next).copied().unwrap_or(u128::MAX)),
        };
        let mut is_stable = false;
        for _ in 0..ROUNDS_MAX {
            is_stable = true;
            for &block in cfg.rpo.iter().rev() {
                let noted = match calls(block) {
                    true => 0,
                    false => after(&before, block) | if is_noted(block) { places(block) } else { 0 },
                };
                is_stable &= before.insert(block, noted) == Some(noted);
            }
            if is_stable {
                break;
            }
        }
        if !is_stable {
            return FxHashSet::default();
        }
        let is_later = |block: &Block| {
            let of_block = &self.of_blocks[block];
            let all = places(*block);
            !of_block.outputs
                && of_block.from.iter().all(|&place| place < PLACES_MAX)
                && !calls(*block)
                && all & !after(&before, *block) == 0
        };
        self.of_blocks.keys().copied().filter(is_later).collect()
    }
}

/// The instructions of a note.
struct Note<'a> {
    function: &'a mut Function,
    loc: Loc,
    insts: Vec<Inst>,
}

impl Note<'_> {
    /// Makes the note of all writes in a block.
    fn write(&mut self, writes: &BlockWrites, ranges: &[(Value, i64, i64)]) {
        let one = self.add(InstData::Const { bits: 1 }, Type::I32);
        let conditions: Vec<Value> = match writes.outputs {
            true => Vec::new(),
            false => writes.from.iter().map(|&place| self.is_output(ranges[place])).collect(),
        };
        let addr = Address::direct(Region::State, state::OUTPUTS_WRITTEN);
        let value = match &conditions[..] {
            [] => one,
            [first, rest @ ..] => {
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
    fn is_output(&mut self, (base, start, end): (Value, i64, i64)) -> Value {
        let span = u32::try_from(end - start).unwrap_or(u32::MAX);
        // The last byte, from the first output on: at most the area and what is before the last byte.
        let distance = (end - 1 - i64::from(layout::Q)) as u32;
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
    From { base: Value, start: i64, end: i64 },
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
            let from = Written::From { base, start: 0, end: TEXT_BYTES_MAX.into() };
            return (!is_elsewhere(function, base)).then_some(from);
        }
        _ => return None,
    };
    match (addr.region, addr.base) {
        (Region::Any, Some(base)) if bytes > 0 => {
            Some(Written::From { base, start: addr.offset.into(), end: addr.offset.saturating_add(bytes).into() })
        }
        (Region::Any | Region::Q, _) if is_unknown(addr) => Some(Written::Outputs),
        _ => None,
    }
}

/// A value of which `base` is a sum with a number that is known to be small, and from where to where that reaches instead of from `start` to before
/// `end`: parts of a text, or of a structure, are then from one place.
fn origin(function: &Function, cfg: &ControlFlow, (base, start, end): (Value, i64, i64)) -> (Value, i64, i64) {
    /// Terms of a sum.
    const TERMS_MAX: usize = 8;
    let mut origin = (function.resolve(base), start, end);
    for _ in 0..TERMS_MAX {
        let (base, start, end) = origin;
        let Some(&InstData::Binary { op: BinaryOp::Iadd, args: [one, two] }) = function.defining(base) else { break };
        let (next, (least, greatest)) = match (small(function, cfg, two, 0), small(function, cfg, one, 0)) {
            (Some(range), _) => (one, range),
            (None, Some(range)) => (two, range),
            (None, None) => break,
        };
        if start + least < -SMALL_MAX || end + greatest > SMALL_MAX {
            break;
        }
        origin = (function.resolve(next), start + least, end + greatest);
    }
    origin
}

/// The least and the greatest number that an i32 can be, if its instructions say that it is small.
fn small(function: &Function, cfg: &ControlFlow, value: Value, depth: u32) -> Option<(i64, i64)> {
    /// Instructions that are looked at, one after the other.
    const DEPTH_MAX: u32 = 5;
    if depth > DEPTH_MAX {
        return None;
    }
    let of = |value: Value| small(function, cfg, value, depth + 1);
    let Some(data) = function.defining(value) else { return counted(function, cfg, value, depth) };
    let (least, greatest) = match data {
        InstData::Const { bits } => (i64::from(*bits as u32 as i32), i64::from(*bits as u32 as i32)),
        InstData::Convert { op: ConvertOp::Zext, arg } => match function.ty(*arg) {
            Type::I1 => (0, 1),
            Type::I8 => (0, i64::from(u8::MAX)),
            Type::I16 => (0, i64::from(u16::MAX)),
            Type::I32 | Type::I64 | Type::F32 | Type::F64 => return None,
        },
        InstData::Binary { op: BinaryOp::And, args } => {
            let most = args.iter().find_map(|&arg| function.constant(arg))?;
            (0, i64::try_from(most).ok()?)
        }
        InstData::Binary { op: BinaryOp::Lshr, args: [number, count] } => {
            let (least, greatest) = of(*number).filter(|range| range.0 >= 0)?;
            let count = function.constant(*count).filter(|&count| count < 32)?;
            (least >> count, greatest >> count)
        }
        InstData::Binary { op: BinaryOp::Iadd, args: [one, two] } => {
            let (one, two) = (of(*one)?, of(*two)?);
            (one.0 + two.0, one.1 + two.1)
        }
        InstData::Binary { op: BinaryOp::Isub, args: [one, two] } => {
            let (one, two) = (of(*one)?, of(*two)?);
            (one.0 - two.1, one.1 - two.0)
        }
        InstData::Select { if_true, if_false, .. } => {
            let (one, two) = (of(*if_true)?, of(*if_false)?);
            (one.0.min(two.0), one.1.max(two.1))
        }
        _ => return None,
    };
    (least >= -SMALL_MAX && greatest <= SMALL_MAX).then_some((least, greatest))
}

/// As [`small`], of the parameter of a loop of one block that counts up while it is below a limit:
///
/// ```text
/// b1(v1: i32):               ; begins with 0
///     v2 = iadd v1, 16
///     v3 = ult v2, v4        ; v4 is at most 240, so is v1
///     branch v3, b1(v2), b2
/// ```
fn counted(function: &Function, cfg: &ControlFlow, value: Value, depth: u32) -> Option<(i64, i64)> {
    let value = function.resolve(value);
    let ValueDef::Param(block, index) = function.values[value].def else { return None };
    let mut range: Option<(i64, i64)> = None;
    for &pred in cfg.predecessors(block) {
        let data = &function.insts[function.terminator(pred)?];
        for target in data.targets().into_iter().filter(|target| target.block == block) {
            let argument = function.resolve(*target.args.get(index as usize)?);
            let (least, greatest) = match data {
                InstData::Branch { cond, then_to, .. } if pred == block && std::ptr::eq(target, then_to) => {
                    let InstData::IntCompare { cc: IntCc::Ult, args: [next, limit] } = function.defining(*cond)? else {
                        return None;
                    };
                    let (next, limit) = (function.resolve(*next), small(function, cfg, *limit, depth + 1)?);
                    if next != argument || limit.0 < 0 {
                        return None;
                    }
                    (0, limit.1)
                }
                _ if pred == block => return None,
                _ => small(function, cfg, argument, depth + 1)?,
            };
            range = Some(range.map_or((least, greatest), |range| (range.0.min(least), range.1.max(greatest))));
        }
    }
    range
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
        check_body("note-outputs", &body("", "", ""), &body("", outputs, &note(3, 9, AREA_BYTES + 9)));
        let without = "branch v1, b1, b2\nb1 cold:\n store.i32 Q 4, v0\n jump b2\nb2:\n ret v0";
        check_body("note-outputs", without, without);
    }

    #[test]
    fn writes_from_one_place_are_noted_by_the_last_block() {
        let body = |note: &str| {
            format!(
                "v2 = const.i32 255\nv3 = trunc.i8 v0\nv4 = trunc.i16 v0\nbranch v1, b1, b2\nb1:\n store.i32 any[v0]+20, v0\n jump \
                 b2\nb2:\n v5 = load.i32 M 0\n v6 = and v5, v2\n v7 = iadd v6, v0\n store.i8 any[v7]+2, v3\n store.i16 any[v0]+0, \
                 v4\n{note} ret v0"
            )
        };
        // From v0 to before v0 + 255 + 3.
        check_body("note-outputs", &body(""), &body(&note(8, 257, AREA_BYTES + 257)));
    }

    #[test]
    fn a_call_between_writes_sees_the_note_of_the_first() {
        let body = |first: &str, second: &str| {
            format!(
                "branch v1, b1, b2\nb1:\n store.i32 any[v0]+4, v0\n{first} jump b2\nb2:\n call @G()\n store.i32 any[v0]+0, v0\n{second} ret v0"
            )
        };
        check_body("note-outputs", &body("", ""), &body(&note(2, 7, AREA_BYTES + 7), &note(9, 7, AREA_BYTES + 7)));
    }

    #[test]
    fn a_text_is_noted_where_it_may_be_an_output() {
        let body = |to: &str, note: &str| {
            format!(" v2 = const.i64 0\n {to} v4 = rt @text_concat(v2, v0, v0, v3)\n{note} ret v0")
        };
        check_body("note-outputs", &body("v3 = address M 4\n", ""), &body("v3 = address M 4\n", ""));
    }
}
