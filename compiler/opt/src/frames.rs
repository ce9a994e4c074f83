//! Who can reach the local data of a function.
//!
//! A frame is *private* if its address goes nowhere: then only the function itself reaches it by region `L`, and a callee by
//! region `V`. Pointers to local data in PLC memory are area pointers, which code turns into an address by `address` or
//! `frame_base` where they are used; so a frame that has neither cannot be reached in another way, by organization
//! blocks that run in between either: they have their own frames. An address does not escape if the
//! function calculates with it, chooses between it and another, compares it, where room on the L stack is counted, or makes
//! accesses to `any` with it as base; those may alias region `L` anyway.

use plcc_abi::layout::area;
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::function::ValueDef;
use plcc_ir::{Address, BinaryOp, FuncId, Function, Inst, InstData, IntCc, Module, Region, Type, Value};
use rustc_hash::FxHashMap;

use crate::usage::reads_upward;

/// The frame of a function, and what its callees do with it.
pub struct Frames<'a> {
    is_private: bool,
    callees: &'a Callees,
}

/// Which functions of a module touch the frames of their callers. Optimisation takes accesses away and adds none, so what was found
/// before holds after it.
pub struct Callees {
    touching: EntityVec<FuncId, bool>,
    reads: EntityVec<FuncId, CallerReads>,
}

/// What a function reads of the frame of its caller.
#[derive(Hash)]
pub struct CallerReads {
    /// The first byte that it reads at a known place; `u32::MAX` if there is none.
    first: u32,
    /// Places from which it reads that are parameters plus so many bytes, and whether double words are read there.
    places: Vec<(usize, u32, bool)>,
    /// Known places from which it reads double words.
    dwords: Vec<u32>,
    /// It reads by the pointers in these double words.
    follows_pointers: bool,
    /// For each parameter: if it is an address, nothing before it is read.
    upward: Vec<bool>,
}

impl CallerReads {
    /// True if nothing before the address that it gets for parameter `index` is read.
    pub fn is_upward(&self, index: usize) -> bool {
        self.upward.get(index).is_some_and(|is_upward| *is_upward)
    }

    /// The first byte of the frame of `caller` that a call reads: what is given to it as addresses is left out. `by_pointer`: the first byte that the
    /// pointers at a place in the frame lead to.
    pub fn first_of_call(&self, caller: &Function, args: &[Value], by_pointer: &mut dyn FnMut(u32) -> u32) -> u32 {
        let mut first = self.first;
        let dword = |place: u32, by_pointer: &mut dyn FnMut(u32) -> u32| match self.follows_pointers {
            true => by_pointer(place),
            false => u32::MAX,
        };
        for &place in &self.dwords {
            first = first.min(dword(place, by_pointer));
        }
        for &(index, offset, is_dword) in &self.places {
            let Some(place) = args.get(index).and_then(|&arg| caller.constant(arg)) else { return 0 };
            let place = (place as u32).saturating_add(offset);
            first = first.min(place);
            if is_dword {
                first = first.min(dword(place, by_pointer));
            }
        }
        first
    }

    /// `by_pointers`: neither the function nor what it calls looks before what it was given.
    fn of(function: &Function, by_pointers: bool) -> CallerReads {
        let parameters = function.layout.first().map_or(&[][..], |&block| &function.blocks[block].params);
        let mut reads = CallerReads {
            first: u32::MAX,
            places: Vec::new(),
            dwords: Vec::new(),
            follows_pointers: false,
            upward: vec![true; parameters.len()],
        };
        for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
            let data = &function.insts[inst];
            data.for_each_address(|addr| {
                if addr.region == Region::V {
                    reads.add(function, by_pointers, inst, addr);
                }
            });
            data.for_each_use(|value| {
                if let Some(index) = parameter_index(function, value) {
                    reads.upward[index] &= by_pointers
                        || is_base_only(function, data, value)
                        || matches!(data, InstData::CallRuntime { function, args } if reads_upward(*function, args));
                }
            });
        }
        reads
    }

    /// Adds an access to the frame of the caller.
    fn add(&mut self, function: &Function, by_pointers: bool, inst: Inst, addr: &Address) {
        let data = &function.insts[inst];
        let is_dword = matches!(data, InstData::Load { .. }) && function.ty(function.result(inst)) == Type::I32;
        let base = addr.base.map(|base| function.resolve(base));
        let constant = base.map_or(Some(0), |base| function.constant(base));
        match (data, constant, base) {
            (InstData::AddressOf { .. }, ..) if by_pointers && base.is_none() => self.follows_pointers = true,
            (InstData::Load { .. } | InstData::LoadBit { .. } | InstData::Store { .. }, Some(start), _) => {
                let place = (start as u32).saturating_add(addr.offset);
                self.first = self.first.min(place);
                self.dwords.extend(is_dword.then_some(place));
            }
            (InstData::Load { .. }, None, Some(base)) => match parameter_index(function, base) {
                Some(index) => self.places.push((index, addr.offset, is_dword)),
                None => self.first = 0,
            },
            _ => self.first = 0,
        }
    }
}

/// For each function whether it reaches local data of others only by what it was given, and whatever it calls as well: it may hand a pointer on.
fn only_by_pointers(module: &Module) -> Vec<bool> {
    let mut only: Vec<bool> = module.functions.values().map(|function| function.by_pointers).collect();
    loop {
        let mut changed = false;
        for (at, function) in module.functions.values().enumerate() {
            let mut insts = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
            let calls_other = |inst: &Inst| match &function.insts[*inst] {
                InstData::Call { callee, .. } => !only[callee.index()],
                _ => false,
            };
            if only[at] && insts.any(calls_other) {
                only[at] = false;
                changed = true;
            }
        }
        if !changed {
            return only;
        }
    }
}

/// The number of the parameter that a value is.
fn parameter_index(function: &Function, value: Value) -> Option<usize> {
    match function.values[function.resolve(value)].def {
        ValueDef::Param(block, index) if Some(&block) == function.layout.first() => Some(index as usize),
        _ => None,
    }
}

/// For each place in its frame where a function stores double words, the first byte of local data that they lead to as area pointers.
pub fn pointers_stored(function: &Function) -> FxHashMap<u32, u32> {
    let mut first: FxHashMap<u32, u32> = FxHashMap::default();
    for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
        if let InstData::Store { addr: Address { region: Region::L, base: None, offset }, value } =
            &function.insts[inst]
            && function.ty(*value) == Type::I32
        {
            let byte = local_byte(function, *value);
            first.entry(*offset).and_modify(|first| *first = byte.min(*first)).or_insert(byte);
        }
    }
    first
}

/// The first byte of local data that is read by an area pointer.
fn local_byte(function: &Function, pointer: Value) -> u32 {
    /// The number of the area is above these bits.
    const ADDRESS_BITS: u32 = 24;
    let constant = |value: Value| function.constant(value).map(|bits| bits as u32);
    let of_constant = |pointer: u32| match u64::from(pointer >> ADDRESS_BITS) {
        area if area == u64::from(area::V) || area == u64::from(area::L) => (pointer & 0x0007_FFFF) >> 3,
        _ => u32::MAX,
    };
    if let Some(pointer) = constant(pointer) {
        return of_constant(pointer);
    }
    // An element of an array, or nowhere with an index outside of it.
    let Some(InstData::Select { cond, if_true, if_false }) = function.defining(pointer) else { return 0 };
    let Some(InstData::Binary { op: BinaryOp::Iadd, args: [distance, start] }) = function.defining(*if_true) else {
        return 0;
    };
    let Some(InstData::Binary { op: op @ (BinaryOp::Shl | BinaryOp::Imul), args: [index, factor] }) =
        function.defining(*distance)
    else {
        return 0;
    };
    let Some(InstData::IntCompare { cc: IntCc::Ule, args: [compared, last] }) = function.defining(*cond) else {
        return 0;
    };
    let (Some(start), Some(factor), Some(last), Some(nowhere)) =
        (constant(*start), constant(*factor), constant(*last), constant(*if_false))
    else {
        return 0;
    };
    let most = match op {
        BinaryOp::Shl => u64::from(last) << (factor & 31),
        _ => u64::from(last) * u64::from(factor),
    };
    let fits = most + u64::from(start & ((1 << ADDRESS_BITS) - 1)) < 1 << ADDRESS_BITS;
    if !fits || function.resolve(*index) != function.resolve(*compared) {
        return 0;
    }
    of_constant(start).min(of_constant(nowhere))
}

/// True if an instruction uses an address for nothing but accesses at or after it.
pub fn is_base_only(function: &Function, data: &InstData, address: Value) -> bool {
    match data {
        InstData::Load { .. } | InstData::LoadBit { .. } | InstData::Clear { .. } | InstData::Copy { .. } => true,
        InstData::Store { value, .. } | InstData::StoreBit { value, .. } => {
            function.resolve(*value) != function.resolve(address)
        }
        _ => false,
    }
}

impl Callees {
    pub fn new(module: &Module) -> Callees {
        let (mut touching, mut reads) = (EntityVec::new(), EntityVec::new());
        for (function, by_pointers) in module.functions.values().zip(only_by_pointers(module)) {
            touching.push(touches_caller(function));
            reads.push(CallerReads::of(function, by_pointers));
        }
        Callees { touching, reads }
    }

    /// What a function reads of the frame of its caller.
    pub fn caller_reads(&self, callee: FuncId) -> &CallerReads {
        &self.reads[callee]
    }

    /// True if a call of `callee` may read or write the frame of its caller.
    pub fn touches_caller(&self, callee: FuncId) -> bool {
        self.touching[callee]
    }
}

impl<'a> Frames<'a> {
    pub fn new(function: &Function, callees: &'a Callees) -> Frames<'a> {
        Frames { is_private: !is_given_away(function, &|region| region == Region::L, |_, _| false), callees }
    }

    /// True if only the function and its direct callees can reach its frame.
    pub fn is_private(&self) -> bool {
        self.is_private
    }

    /// True if a call of `callee` may read or write the frame.
    pub fn call_touches(&self, callee: FuncId) -> bool {
        !self.is_private || self.callees.touches_caller(callee)
    }
}

fn touches_caller(function: &Function) -> bool {
    let mut touches = false;
    for block in function.layout.iter().map(|&block| &function.blocks[block]) {
        for &inst in &block.insts {
            function.insts[inst].for_each_address(|addr| touches |= addr.region == Region::V);
        }
    }
    touches
}

/// True if the address of local data, own ones or the caller's, goes anywhere but to instructions that `keep` it.
pub fn gives_address_away(function: &Function, keep: fn(&Function, &InstData) -> bool) -> bool {
    is_given_away(function, &|region| matches!(region, Region::L | Region::V), keep)
}

/// True if the address of a place in a region that `is_local` names is used for more than accesses and comparisons.
fn is_given_away(
    function: &Function,
    is_local: &dyn Fn(Region) -> bool,
    keep: fn(&Function, &InstData) -> bool,
) -> bool {
    let is_source = |data: &InstData| match data {
        InstData::AddressOf { addr } => is_local(addr.region),
        InstData::FrameBase { .. } => true,
        _ => false,
    };
    let insts = || function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    if !insts().any(|&inst| is_source(&function.insts[inst])) {
        return false;
    }
    let Some(derived) = derived_values(function, &is_source) else { return true };
    insts().any(|&inst| {
        let data = &function.insts[inst];
        let is_derived = |value: Value| derived[function.resolve(value).index()];
        match data {
            InstData::IntCompare { .. } | InstData::Load { .. } | InstData::LoadBit { .. } => false,
            InstData::Clear { .. } | InstData::Copy { .. } => false,
            InstData::Store { value, .. } | InstData::StoreBit { value, .. } => is_derived(*value),
            InstData::Binary { .. } | InstData::Select { .. } | InstData::Jump { .. } | InstData::Branch { .. } => {
                false
            }
            _ => uses_any(function, data, &derived) && !keep(function, data),
        }
    })
}

/// Marks the values computed from an address, also those that blocks pass on. `None`: that takes too many rounds.
fn derived_values(function: &Function, is_source: &dyn Fn(&InstData) -> bool) -> Option<Vec<bool>> {
    const ROUNDS_MAX: u32 = 8;
    let mut derived = vec![false; function.values.len()];
    for _ in 0..ROUNDS_MAX {
        let mut changed = false;
        let mut mark = |derived: &mut Vec<bool>, value: Value| {
            changed |= !std::mem::replace(&mut derived[value.index()], true);
        };
        for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
            let data = &function.insts[inst];
            let computes = match data {
                InstData::Binary { op: BinaryOp::Isub, args } => {
                    // The distance between two places is not an address.
                    !args.iter().all(|&arg| function.defining(arg).is_some_and(is_source))
                }
                InstData::Binary { .. } | InstData::Select { .. } => true,
                _ => false,
            };
            if is_source(data) || computes && uses_any(function, data, &derived) {
                mark(&mut derived, function.result(inst));
            }
            data.for_each_target(|target| {
                for (&argument, &parameter) in target.args.iter().zip(&function.blocks[target.block].params) {
                    if derived[function.resolve(argument).index()] {
                        mark(&mut derived, parameter);
                    }
                }
            });
        }
        if !changed {
            return Some(derived);
        }
    }
    None
}

fn uses_any(function: &Function, data: &InstData, marked: &[bool]) -> bool {
    let mut any = false;
    data.for_each_use(|value: Value| any |= marked[function.resolve(value).index()]);
    any
}
