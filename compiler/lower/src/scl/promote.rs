//! Variables in SSA values instead of memory: elementary TEMPs, inputs and the result of an FC that are only reached by
//! reads and writes of their own names.
//!
//! Values that span many statements cost the register allocator time for each statement, and a parameter for each path where
//! paths meet. So a block with thousands of variables that it uses everywhere keeps the ones in memory that span most of it.

use std::collections::BTreeMap;

use plcc_model::layout;
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Base, SclBody, Statement, StatementKind};
use plcc_model::types::{DataType, Elementary};
use plcc_model::{Assert, AssertSide, CodeBlock, Direction, Operand, Passing, Place};
use rustc_hash::{FxHashMap, FxHashSet};

/// Statements that all promoted variables of a block may span together: some tenths of a second of register allocation.
const SPANS_MAX: u64 = 1_000_000;
/// The cost of a path that meets others, in statements.
const PATH_WEIGHT: u64 = 20;

/// A variable that may be promoted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Slot {
    /// TEMP at this bit of the frame.
    Local(u32),
    /// Formal parameter of an FC.
    Parameter(usize),
}

/// The promoted variables of a block, in a fixed order.
pub fn promotable(block: &CodeBlock, body: &SclBody) -> Vec<(Slot, Elementary)> {
    let mut seen = Seen::default();
    walk::statements(&body.statements, &mut seen);
    if seen.everything {
        return Vec::new();
    }
    let mut slots = seen.locals(block);
    for (&index, &ty) in &seen.parameters {
        let Some(ty) = ty else { continue };
        let parameter = &block.interface.parameters[index];
        let by_value = match parameter.direction {
            Direction::Input => !body.inputs_in_place,
            Direction::Output => parameter.name == "RET_VAL",
            Direction::InOut => false,
        };
        let fits = matches!(parameter.passing, Passing::Elementary(width) if width == layout::width(ty));
        if by_value && fits {
            slots.push((Slot::Parameter(index), ty));
        }
    }
    seen.keep_short(slots)
}

/// The slot of an access, if it is one of a whole elementary variable. A slice counts as the variable that it is part of.
pub fn slot(access: &Access) -> Option<(Slot, Elementary)> {
    let DataType::Elementary(ty) = access.ty else { return None };
    if !access.indices.is_empty() {
        return None;
    }
    match access.base {
        Base::Place(Place::L { byte, bit }) => Some((Slot::Local(8 * byte + u32::from(bit)), ty)),
        Base::Place(Place::Parameter { parameter, byte: 0, bit: 0 }) => Some((Slot::Parameter(parameter), ty)),
        _ => None,
    }
}

/// Uses of local data and parameters.
#[derive(Default)]
struct Seen {
    /// Values by their first bit; none if they are seen as different types.
    values: BTreeMap<u32, Option<Elementary>>,
    /// Bit ranges that something reaches as memory.
    memory: Vec<(u32, u32)>,
    /// Parameters; none if they are reached as memory or as different types.
    parameters: BTreeMap<usize, Option<Elementary>>,
    /// All of it is reached as memory.
    everything: bool,
    /// Statements walked so far, and where each variable is used first and last.
    position: u64,
    spans: FxHashMap<Slot, (u64, u64)>,
}

impl Seen {
    fn locals(&self, block: &CodeBlock) -> Vec<(Slot, Elementary)> {
        // Data that the runtime writes at the start of an OB.
        let first = 8 * block.interface.start_bytes;
        let mut overlapped: FxHashSet<u32> = FxHashSet::default();
        let extents: FxHashMap<u32, u32> =
            self.values.iter().map(|(&start, ty)| (start, start + ty.map_or(64, Elementary::bits))).collect();
        let mut last: Option<(u32, u32)> = None;
        for &start in self.values.keys() {
            let end = extents[&start];
            if let Some((before, before_end)) = last
                && start < before_end
            {
                overlapped.insert(before);
                overlapped.insert(start);
            }
            if last.is_none_or(|(_, before_end)| end >= before_end) {
                last = Some((start, end));
            }
        }
        let memory = joined(&self.memory);
        let reached = |start: u32, end: u32| {
            let next = memory.partition_point(|&(_, to)| to <= start);
            memory.get(next).is_some_and(|&(from, _)| from < end)
        };
        self.values
            .iter()
            .filter_map(|(&start, &ty)| Some((start, ty?)))
            .filter(|&(start, _)| start >= first && !overlapped.contains(&start) && !reached(start, extents[&start]))
            .map(|(start, ty)| (Slot::Local(start), ty))
            .collect()
    }

    /// The variables that span the fewest statements, as many as together span at most [`SPANS_MAX`].
    fn keep_short(&self, slots: Vec<(Slot, Elementary)>) -> Vec<(Slot, Elementary)> {
        let span = |slot: &Slot| self.spans.get(slot).map_or(0, |(first, last)| last - first);
        if slots.iter().map(|(slot, _)| span(slot)).sum::<u64>() <= SPANS_MAX {
            return slots;
        }
        let mut order: Vec<usize> = (0..slots.len()).collect();
        order.sort_by_key(|&index| span(&slots[index].0));
        let mut total = 0;
        let kept: FxHashSet<usize> = order
            .into_iter()
            .take_while(|&index| {
                total += span(&slots[index].0);
                total <= SPANS_MAX
            })
            .collect();
        slots.into_iter().enumerate().filter(|(index, _)| kept.contains(index)).map(|(_, slot)| slot).collect()
    }

    fn memory(&mut self, place: &Place, bits: u32) {
        match place {
            Place::L { byte, bit } => {
                let start = 8 * byte + u32::from(*bit);
                self.memory.push((start, start + bits));
            }
            Place::Parameter { parameter, .. } => {
                self.parameters.insert(*parameter, None);
            }
            Place::Indirect { pointer, .. } => self.memory(pointer, 32),
            Place::Element { base, indices } => {
                let reach: u32 = indices.iter().map(|index| index.reach()).fold(0, u32::saturating_add);
                self.memory(base, bits.saturating_add(reach));
                indices.iter().for_each(|index| self.memory(&index.place, 32));
            }
            _ => {}
        }
    }
}

impl Visitor for Seen {
    /// STL reaches local data and parameters by address, even a computed one.
    fn statement(&mut self, statement: &Statement) {
        self.position += match statement.kind {
            StatementKind::Exit | StatementKind::Continue | StatementKind::Goto(_) => PATH_WEIGHT,
            _ => 1,
        };
        if matches!(statement.kind, StatementKind::Stl(_)) {
            self.everything = true;
        }
    }

    fn paths_meet(&mut self, paths: usize) {
        // Two paths need at most a parameter.
        self.position += 1 + PATH_WEIGHT * (paths as u64 - 2);
    }

    fn access(&mut self, access: &Access, role: Role) {
        if let Some((slot, _)) = slot(access) {
            let position = self.position;
            self.spans.entry(slot).and_modify(|span| span.1 = position).or_insert((position, position));
        }
        match (slot(access), role) {
            (Some((Slot::Local(start), ty)), Role::Value) => {
                self.values
                    .entry(start)
                    .and_modify(|known| *known = known.filter(|&known| known == ty))
                    .or_insert(Some(ty));
            }
            (Some((Slot::Parameter(index), ty)), Role::Value) => {
                let known = self.parameters.entry(index).or_insert(Some(ty));
                *known = known.filter(|&known| known == ty);
            }
            _ => {
                if let Base::Place(place) = &access.base {
                    self.memory(place, reach(access));
                }
            }
        }
    }

    fn place(&mut self, place: &Place) {
        self.memory(place, 32);
    }

    fn assert(&mut self, assert: &Assert) {
        for side in assert.sides() {
            match side {
                AssertSide::Memory(place) => self.memory(place, 8 * plcc_abi::layout::L_CLASS_BYTES),
                AssertSide::Operand(Operand::Memory { place, .. }) => self.memory(place, 64),
                AssertSide::Operand(Operand::Cell { number: plcc_model::Number::Word(place), .. }) => {
                    self.memory(place, 32);
                }
                AssertSide::CellValue { number: plcc_model::Number::Word(place), .. } => {
                    self.memory(place, 16);
                }
                AssertSide::Operand(_) | AssertSide::CellValue { .. } | AssertSide::Register(_) => {}
            }
        }
    }
}

/// Bits that an access may touch from its first element on. An index out of its bounds touches nothing.
pub fn reach(access: &Access) -> u32 {
    let whole_stack = 8 * plcc_abi::layout::L_CLASS_BYTES;
    let mut bits = 8 * u64::from(layout::bytes(&access.ty));
    for index in &access.indices {
        let Some((low, high)) = index.bounds.known() else { return whole_stack };
        bits += u64::try_from(i64::from(high) - i64::from(low)).unwrap_or(0) * u64::from(index.stride);
    }
    u32::try_from(bits).map_or(whole_stack, |bits| bits.min(whole_stack))
}

/// The ranges in order, those that touch as one.
pub fn joined(ranges: &[(u32, u32)]) -> Vec<(u32, u32)> {
    let mut ranges = ranges.to_vec();
    ranges.sort_unstable();
    let mut joined: Vec<(u32, u32)> = Vec::new();
    for (from, to) in ranges {
        match joined.last_mut() {
            Some(last) if from <= last.1 => last.1 = last.1.max(to),
            _ => joined.push((from, to)),
        }
    }
    joined
}
