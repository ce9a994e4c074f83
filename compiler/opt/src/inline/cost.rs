//! Which functions are worth inlining.
//!
//! A call costs about as much as [`CALL_COST`] instructions: eleven registers of the CPU go in and nine come out. A function that is not
//! much larger is always inlined; so is one that is called once, because no other copy remains. In between, a program may grow by
//! part of its size, so that compile time stays linear in the size of the program.

use plcc_abi::functions::Effect;
use plcc_abi::layout::area;
use plcc_ir::{BinaryOp, Block, ConvertOp, Function, Inst, InstData, IntCc, Module, Region, Type, UnaryOp, Value};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::usage::reads_upward;
use crate::{block_moves, frames};

/// Instructions that cost as much as a call.
const CALL_COST: u32 = 24;
/// Up to this cost a function is inlined everywhere.
const SMALL: u32 = 2 * CALL_COST;
/// Up to this cost it is inlined as long as the program may grow.
const MEDIUM: u32 = 4 * CALL_COST;
/// The same of a function that gets pointers whose areas, or addresses, it then knows.
const ONE_AREA: u32 = 7 * CALL_COST;
/// Up to this cost it is inlined as long as few have been: most of a small program runs in each cycle, and an instance whose address is known
/// needs no computed addresses.
const LARGE: u32 = 16 * CALL_COST;
/// Growth by those.
const LARGE_GROWTH: u32 = 4000;
/// Up to this size a function that is called once is inlined.
const ONCE_MAX: u32 = 2000;
/// No function grows beyond this size, but for small callees: code generation takes more than linear time for large ones.
const CALLER_MAX: u32 = 10_000;
/// Growth by callees that are not small: a part of the program's size, and a minimum for every program.
const GROWTH_PART: u32 = 8;
const GROWTH_FREE: u32 = 2000;

/// The properties of a function as a callee.
#[derive(Clone, Copy)]
pub struct Shape {
    /// Instructions on paths that are not cold, weighted.
    pub cost: u32,
    /// As `cost`, where pointers whose area the function looks at are known: then only the code for one area remains, and none for the
    /// distance of its frame from the caller's, by which it tests pointers into that.
    pub cost_by_area: u32,
    /// As `cost`, where the parameters in `pointers` are constants: what computes addresses and the numbers of bits needs no instructions then.
    pub cost_by_pointers: u32,
    /// The parameters from which alone the bases of addresses are computed, a bit for each.
    pub pointers: u64,
    /// Instructions.
    pub size: u32,
    /// It calls no function of the module, returns, and passes no address of local data on: the caller's local data stay
    /// private then.
    pub is_leaf: bool,
    /// The same but for block moves, which get the addresses of pointers. Where those are known it is one without calls.
    pub is_leaf_by_moves: bool,
    /// All of those can be done in place after a test.
    pub moves_in_place: bool,
    /// The same but for functions of texts, which get addresses of local data.
    pub is_leaf_by_texts: bool,
    /// It calls no runtime function that may run organization blocks or stop the CPU.
    pub is_quiet: bool,
    /// Bytes of the caller's frame that it addresses directly.
    pub caller_bytes: u32,
}

/// Instructions of a function.
pub fn size_of(function: &Function) -> u32 {
    function.layout.iter().map(|&block| function.blocks[block].insts.len() as u32).sum()
}

impl Shape {
    pub fn of(function: &Function) -> Shape {
        let is_leaf = !frames::gives_address_away(function, |_, _| false);
        let is_leaf_by_moves = is_leaf || !frames::gives_address_away(function, block_moves::is_block_move);
        let is_leaf_by_texts = is_leaf || !frames::gives_address_away(function, is_of_texts);
        let pointers = Pointers::of(function);
        let mut shape = Shape {
            cost: 0,
            cost_by_area: 0,
            cost_by_pointers: pointers.cost(function),
            pointers: pointers.params,
            size: 0,
            is_leaf,
            is_leaf_by_moves,
            moves_in_place: false,
            is_leaf_by_texts,
            is_quiet: true,
            caller_bytes: 0,
        };
        let mut is_candidate = true;
        let mut returns = false;
        let other_areas = code_for_areas(function);
        let mut places = FxHashSet::default();
        for (id, block) in function.layout.iter().map(|&id| (id, &function.blocks[id])) {
            for &inst in &block.insts {
                let data = &function.insts[inst];
                shape.size += 1;
                let is_place = is_made_of_places(function, data, &places);
                if is_place {
                    places.extend(&function.results[inst]);
                }
                if !block.cold {
                    shape.cost += cost(data);
                    if !is_place && !other_areas.contains(&id) {
                        shape.cost_by_area += cost(data);
                    }
                }
                match data {
                    InstData::Call { .. } => is_candidate = false,
                    InstData::CallRuntime { function, .. } => {
                        shape.is_quiet &= matches!(function.effect(), Effect::Pure | Effect::Cells | Effect::System);
                    }
                    InstData::Return { .. } => returns = true,
                    _ => {}
                }
                data.for_each_address(|addr| {
                    let is_local = matches!(addr.region, Region::L | Region::V);
                    // An offset from a base that would not fit any frame: whatever it means, it is rare.
                    is_candidate &=
                        !(is_local && addr.base.is_some() && addr.offset >= plcc_abi::layout::L_CLASS_BYTES);
                    if addr.region == Region::V && addr.base.is_none() {
                        let bytes = direct_bytes(function, inst, data);
                        shape.caller_bytes = shape.caller_bytes.max(addr.offset.saturating_add(bytes));
                    }
                });
            }
        }
        shape.is_leaf &= is_candidate && returns;
        shape.is_leaf_by_moves &= is_candidate && returns;
        shape.is_leaf_by_texts &= is_candidate && returns;
        shape
    }
}

/// True of a function of texts.
fn is_of_texts(_: &Function, data: &InstData) -> bool {
    matches!(data, InstData::CallRuntime { function, args } if reads_upward(*function, args))
}

/// What a function computes of its parameters and constants alone. A formal parameter of an FC is the address of its actual one, in bits:
///
/// ```text
/// v2 = lshr v0, 3          ; v0 is the address of a BOOL
/// v3 = and v0, 7
/// v4 = load.i8 any[v2]+0   ; with a constant v0 one load of a bit
/// v5 = zext.i32 v4
/// v6 = lshr v5, v3
/// v7 = trunc.i1 v6
/// ```
struct Pointers {
    /// Values, with the parameters from which they are computed, a bit for each.
    made_of: FxHashMap<Value, u64>,
    /// The parameters of bases of addresses.
    params: u64,
}

impl Pointers {
    fn of(function: &Function) -> Pointers {
        let params = function.blocks[function.entry()].params.iter().take(64).enumerate();
        let mut made_of: FxHashMap<Value, u64> = params
            .filter(|(_, param)| function.ty(**param) == Type::I32)
            .map(|(at, &param)| (param, 1 << at))
            .collect();
        let mut params = 0;
        for inst in insts(function) {
            let data = &function.insts[inst];
            data.for_each_address(|addr| {
                params |= addr.base.and_then(|base| made_of.get(&function.resolve(base))).copied().unwrap_or(0);
            });
            let is_computed = matches!(
                data,
                InstData::Binary { .. }
                    | InstData::IntCompare { .. }
                    | InstData::Convert { .. }
                    | InstData::Select { .. }
            );
            if is_computed {
                let mut from = Some(0);
                data.for_each_use(|value| {
                    let of_value = match function.constant(value) {
                        Some(_) => Some(0),
                        None => made_of.get(&function.resolve(value)).copied(),
                    };
                    from = from.zip(of_value).map(|(all, more)| all | more);
                });
                if let Some(from) = from {
                    made_of.insert(function.result(inst), from);
                }
            }
        }
        Pointers { made_of, params }
    }

    /// True of what is a constant where the pointers are.
    fn is_known(&self, function: &Function, value: Value) -> bool {
        self.made_of.get(&function.resolve(value)).is_some_and(|&from| from != 0 && from & !self.params == 0)
    }

    /// The cost of the function where its pointers are constants.
    fn cost(&self, function: &Function) -> u32 {
        if self.params == 0 {
            return u32::MAX;
        }
        // Bytes of which single bits are read or replaced: what moves the bits becomes part of loads and stores.
        let mut bytes: FxHashSet<Value> = FxHashSet::default();
        let mut all = 0;
        for &block in &function.layout {
            for &inst in &function.blocks[block].insts {
                let data = &function.insts[inst];
                let is_free = match *data {
                    InstData::Load { addr } => {
                        if addr.base.is_some_and(|base| self.is_known(function, base)) {
                            bytes.insert(function.result(inst));
                        }
                        false
                    }
                    InstData::Binary { op: BinaryOp::Shl, args: [_, count] } if self.is_known(function, count) => {
                        bytes.insert(function.result(inst));
                        true
                    }
                    InstData::Binary { op: BinaryOp::Lshr | BinaryOp::And, args: [byte, with] }
                        if bytes.contains(&function.resolve(byte)) && self.is_known(function, with) =>
                    {
                        bytes.insert(function.result(inst));
                        true
                    }
                    InstData::Binary { op: BinaryOp::Or, args }
                        if args.iter().all(|&arg| bytes.contains(&function.resolve(arg))) =>
                    {
                        bytes.insert(function.result(inst));
                        true
                    }
                    InstData::Convert { op: ConvertOp::Zext | ConvertOp::Trunc, arg } => {
                        let is_byte = bytes.contains(&function.resolve(arg));
                        if is_byte && function.ty(function.result(inst)) != Type::I1 {
                            bytes.insert(function.result(inst));
                        }
                        is_byte || function.ty(arg) == Type::I1
                    }
                    _ => false,
                };
                let is_known = matches!(&function.results[inst][..], [result] if self.is_known(function, *result));
                if !is_free && !is_known && !function.blocks[block].cold {
                    all += cost(data);
                }
            }
        }
        all
    }
}

/// The instructions of a function in the order of its layout.
fn insts(function: &Function) -> impl Iterator<Item = Inst> {
    function.layout.iter().flat_map(|&block| function.blocks[block].insts.iter().copied())
}

/// True of the address of a place in local data, of what is computed of `places` and constants alone, and of a branch by that.
fn is_made_of_places(function: &Function, data: &InstData, places: &FxHashSet<Value>) -> bool {
    let is_place = |value: Value| places.contains(&function.resolve(value));
    match data {
        InstData::AddressOf { addr } => addr.base.is_none() && matches!(addr.region, Region::L | Region::V),
        InstData::FrameBase { .. } => true,
        InstData::Branch { cond, .. } => is_place(*cond),
        InstData::Binary { .. } | InstData::IntCompare { .. } | InstData::Convert { .. } | InstData::Select { .. } => {
            let (mut any, mut all) = (false, true);
            data.for_each_use(|value| {
                any |= is_place(value);
                all &= is_place(value) || function.constant(value).is_some();
            });
            any && all
        }
        _ => false,
    }
}

/// Blocks that are only for pointers into some area that is not a DB.
fn code_for_areas(function: &Function) -> FxHashSet<Block> {
    let mut found = FxHashSet::default();
    for &block in &function.layout {
        let Some(InstData::Branch { cond, then_to, .. }) = function.terminator(block).map(|inst| &function.insts[inst])
        else {
            continue;
        };
        if area_test(function, *cond).is_some_and(|area| area != u64::from(area::DB)) {
            found.insert(then_to.block);
            found.extend(function.successors(then_to.block).into_iter().filter(|&next| {
                // What the other areas also go to is the rest of the function.
                function.blocks[next].params.is_empty() && !function.blocks[next].cold
            }));
        }
    }
    found
}

/// The area that a condition compares that of a pointer with.
fn area_test(function: &Function, cond: plcc_ir::Value) -> Option<u64> {
    let &InstData::IntCompare { cc: IntCc::Eq, args: [code, area] } = function.defining(cond)? else { return None };
    let &InstData::Binary { op: BinaryOp::Lshr, args: [_, count] } = function.defining(code)? else { return None };
    let area = function.constant(area)?;
    (function.constant(count) == Some(24) && (u64::from(area::P)..=u64::from(area::V)).contains(&area)).then_some(area)
}

/// Bytes that an access touches.
fn direct_bytes(function: &Function, inst: plcc_ir::Inst, data: &InstData) -> u32 {
    match data {
        InstData::Load { .. } => function.ty(function.result(inst)).bytes(),
        InstData::Store { value, .. } => function.ty(*value).bytes(),
        InstData::LoadBit { .. } | InstData::StoreBit { .. } => 1,
        InstData::Clear { len, .. } | InstData::Copy { len, .. } => *len,
        _ => 0,
    }
}

fn cost(data: &InstData) -> u32 {
    match data {
        InstData::Const { .. } | InstData::Jump { .. } | InstData::Return { .. } => 0,
        InstData::CallRuntime { .. } => 8,
        InstData::Clear { .. } | InstData::Copy { .. } => 2,
        InstData::Binary { op: BinaryOp::Sdiv | BinaryOp::Srem | BinaryOp::Fdiv, .. }
        | InstData::Unary { op: UnaryOp::Fsqrt, .. } => 4,
        InstData::Switch { targets, .. } => 2 + targets.len() as u32,
        _ => 1,
    }
}

/// What a caller knows of what it passes.
#[derive(Clone, Copy)]
pub struct Known {
    /// Pointers in its local data have constant areas.
    pub areas: bool,
    /// The parameters in [`Shape::pointers`] are constants.
    pub pointers: bool,
}

/// How much the program may still grow.
pub struct Budget {
    growth: u32,
    /// The same by large callees.
    large: u32,
    caller: u32,
}

impl Budget {
    pub fn new(module: &Module) -> Budget {
        let size: u32 = module.functions.values().map(size_of).sum();
        Budget { growth: size / GROWTH_PART + GROWTH_FREE, large: LARGE_GROWTH, caller: 0 }
    }

    /// A caller of this size is visited.
    pub fn begin(&mut self, size: u32) {
        self.caller = size;
    }

    /// Whether a callee is to be inlined; if so, it counts. `known`: what the caller passes.
    pub fn allows(&mut self, callee: &Shape, is_only_call: bool, known: Known) -> bool {
        let by_area = known.areas && callee.cost_by_area < callee.cost;
        let by_pointers = known.pointers && callee.cost_by_pointers < callee.cost;
        let (cost, size) = match (by_area, by_pointers) {
            (_, true) => (callee.cost_by_pointers, callee.cost_by_pointers),
            (true, false) => (callee.cost_by_area, callee.cost_by_area),
            (false, false) => (callee.cost, callee.size),
        };
        let caller = self.caller.saturating_add(callee.size);
        let fits = caller <= CALLER_MAX;
        let small = callee.cost <= SMALL && callee.size <= 2 * SMALL;
        let allowed = if small {
            true
        } else if is_only_call {
            fits && callee.size <= ONCE_MAX
        } else {
            let medium = cost <= if by_area || by_pointers { ONE_AREA } else { MEDIUM } && size <= self.growth;
            let large = cost <= LARGE && size <= self.large;
            fits && (medium || large)
        };
        if allowed {
            self.caller = caller;
            if !small && !is_only_call {
                self.growth = self.growth.saturating_sub(size);
                self.large = self.large.saturating_sub(size);
            }
        }
        allowed
    }
}
