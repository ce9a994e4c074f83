//! Places of variables with run-time indices: their addresses, checks and pointers. Source: SCL reference, addressing.

use plcc_abi::codes::{fault_info, sync};
use plcc_abi::layout::area;
use plcc_ir::{Address, BinaryOp, IntCc, Type, Value};
use plcc_model::scl::{Access, Base, Expr, Index, IndexBounds, IndexedArea};
use plcc_model::types::Elementary;
use plcc_model::{Place, PlaceArea, Width, layout};

use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};
use crate::place::crossing::Crossing;
use crate::place::{BitNumber, Direction, Target, TargetKind};
use crate::pointer::PointerFields;

/// An access with computed indices: the place may be reached several times.
pub struct Located<'m> {
    base: LocatedBase<'m>,
    /// Distance from the base, in bits; none if it is 0.
    offset: Option<Value>,
    /// Indices that are out of bounds: the value is right if all hold.
    in_bounds: Option<Value>,
    /// It is a character of a text by its index: `offset` is that of the first one if the text does not have it.
    character: Option<Character>,
    /// The index, if there is one and `in_bounds` is about it alone.
    index: Option<Value>,
}

/// A character of a text by its index.
#[derive(Clone, Copy)]
pub struct Character {
    /// Whether the text has it: if not, it reads 0 and is not written. An i1.
    pub there: Value,
    /// Its distance from the base, in bits, if the text has it.
    offset: Value,
}

#[derive(Clone, Copy)]
enum LocatedBase<'m> {
    Place(&'m Place),
    /// Byte address and bit number in an area.
    Indexed {
        area: LocatedArea,
        byte: Value,
        bit: Option<Value>,
    },
}

#[derive(Clone, Copy)]
enum LocatedArea {
    Memory(PlaceArea),
    /// Number of the DB, an i32.
    Db(Value),
    /// Area code of a pointer and number of the DB, i32 both.
    Coded {
        code: Value,
        db: Value,
    },
}

impl<'m> Located<'m> {
    /// An element of the array at `place`, `offset` bits after its first one. `index`: if there is only one.
    pub fn element(place: &'m Place, offset: Value, in_bounds: Value, index: Option<Value>) -> Located<'m> {
        let in_bounds = Some(in_bounds);
        Located { base: LocatedBase::Place(place), offset: Some(offset), in_bounds, character: None, index }
    }

    /// The character of a text that this is. `None`: it is not a character, or always there.
    pub const fn character(&self) -> Option<Character> {
        self.character
    }

    /// The place of `character`, for where its text has it and all indices are in their bounds.
    pub const fn of_character(&self, character: Character) -> Located<'m> {
        Located { base: self.base, offset: Some(character.offset), in_bounds: None, character: None, index: None }
    }

    /// False for places that are, or may be, in the peripheral area.
    pub fn is_memory(&self) -> bool {
        match &self.base {
            LocatedBase::Place(place) => !matches!(place, Place::Pi { .. } | Place::Pq { .. }),
            LocatedBase::Indexed { area: LocatedArea::Memory(area), .. } => {
                !matches!(area, PlaceArea::Pi | PlaceArea::Pq)
            }
            LocatedBase::Indexed { area: LocatedArea::Db(_), .. } => true,
            LocatedBase::Indexed { area: LocatedArea::Coded { .. }, .. } => false,
        }
    }
}

impl BlockLowering<'_, '_> {
    /// Computes the indices of an access, from left to right.
    pub fn locate<'m>(&mut self, access: &'m Access) -> Located<'m> {
        let base = match &access.base {
            Base::Place(place) => LocatedBase::Place(place),
            Base::Indexed { area, byte, bit } => {
                let area = match area {
                    IndexedArea::Memory(area) => LocatedArea::Memory(*area),
                    IndexedArea::Db(number) => LocatedArea::Db(self.b.i32_const(u32::from(*number))),
                    IndexedArea::DynamicDb(number) => LocatedArea::Db(self.unsigned_index(number)),
                    IndexedArea::Coded { area, db } => {
                        let (code, db) = (self.unsigned_index(area), self.unsigned_index(db));
                        LocatedArea::Coded { code: self.peek_area(code), db }
                    }
                };
                let byte = self.signed_index(byte);
                let bit = bit.as_ref().map(|bit| self.signed_index(bit));
                LocatedBase::Indexed { area, byte, bit }
            }
        };
        let (mut offset, mut in_bounds) = (None, self.is_in_db(access, &base));
        let mut character = None;
        let (alone, mut only) = (in_bounds.is_none() && access.indices.len() == 1, None);
        for (at, index) in access.indices.iter().enumerate() {
            let value = self.signed_index(&index.value);
            only = alone.then_some(value);
            if let IndexBounds::Characters { length, in_head } = index.bounds {
                let (distance, there) = self.character_index(access, index, value, length, in_head);
                let before = offset.unwrap_or_else(|| self.b.i32_const(0));
                let its = self.b.iadd(before, distance);
                character = Some(Character { there, offset: its });
                offset = Some(self.b.select(there, its, before));
                continue;
            }
            let (distance, ok) = self.index(index, value, &access.indices[at + 1..]);
            offset = Some(match offset {
                Some(before) => self.b.iadd(before, distance),
                None => distance,
            });
            in_bounds = Some(match in_bounds {
                Some(before) => self.b.and(before, ok),
                None => ok,
            });
        }
        Located { base, offset, in_bounds, character, index: only }
    }

    /// As [`index`](Self::index), for the character with number `value` of a text with a declared `length`; `in_head`: its head may say fewer.
    fn character_index(
        &mut self,
        access: &Access,
        index: &Index,
        value: Value,
        length: i32,
        in_head: bool,
    ) -> (Value, Value) {
        let Base::Place(first) = &access.base else { return self.index_in_bounds(value, (1, length), index.stride) };
        let width = if index.stride == 8 { Width::Byte } else { Width::Word };
        let head = if in_head { place_before(first, 2 * width.bytes()) } else { None };
        let Some(head) = head else { return self.index_in_bounds(value, (1, length), index.stride) };
        // All callers give a text that has as many.
        if let &Place::Parameter { parameter, byte: 0, .. } = &head
            && let Some(given) = self.plan.given_text(self.block.key(), parameter)
            && given.declared != 0
        {
            return self.index_in_bounds(value, (1, length.min(given.declared.into())), index.stride);
        }
        let at_head =
            Located { base: LocatedBase::Place(&head), offset: None, in_bounds: None, character: None, index: None };
        let maximum = self.read_at(&at_head, width);
        let declared = self.b.i32_const(length as u32);
        let is_less = self.b.icmp(IntCc::Ult, maximum, declared);
        let count = self.b.select(is_less, maximum, declared);
        let from_first = self.b.binary_imm(BinaryOp::Iadd, value, -1);
        let there = self.b.icmp(IntCc::Ult, from_first, count);
        (self.b.binary_imm(BinaryOp::Imul, from_first, i64::from(index.stride)), there)
    }

    /// Whether all of a structure or of an array that a reference refers to is in its DB; `None`: each access finds that out.
    fn is_in_db(&mut self, access: &Access, base: &LocatedBase) -> Option<Value> {
        let LocatedBase::Indexed { area: LocatedArea::Db(db), byte, .. } = base else { return None };
        if access.indices.is_empty() && access.elementary().is_some() {
            return None;
        }
        let last = access.indices.iter().map(|index| match index.bounds.known() {
            Some((low, high)) => (i64::from(high) - i64::from(low)).unsigned_abs() * u64::from(index.stride),
            None => 0,
        });
        let bytes = last.sum::<u64>().div_ceil(8) + u64::from(layout::bytes(&access.ty));
        let length = self.b.db_length(*db);
        let low = self.b.icmp_imm(IntCc::Ule, *byte, 0xFFFF);
        let end = self.b.binary_imm(BinaryOp::Iadd, *byte, bytes as i64);
        let fits = self.b.icmp(IntCc::Ule, end, length);
        Some(self.b.and(low, fits))
    }

    fn signed_index(&mut self, value: &Expr) -> Value {
        let ty = value.ty;
        let value = self.value(value);
        self.as_i32(value, ty)
    }

    fn unsigned_index(&mut self, value: &Expr) -> Value {
        let value = self.value(value);
        if self.b.ty(value).bits() < 32 { self.b.zext(Type::I32, value) } else { value }
    }

    /// An integer as an i32, with the sign of its type; 64 bits keep the low half.
    pub fn as_i32(&mut self, value: Value, ty: Elementary) -> Value {
        match self.b.ty(value).bits() {
            32 => value,
            64 => self.b.trunc(Type::I32, value),
            _ if ty.is_signed() => self.b.sext(Type::I32, value),
            _ => self.b.zext(Type::I32, value),
        }
    }

    /// Area code of a pointer for the code of PEEK and POKE; 0 stays 0: not an area.
    fn peek_area(&mut self, code: Value) -> Value {
        let low = self.b.binary_imm(BinaryOp::And, code, 0xFF);
        let one = self.b.icmp_imm(IntCc::Eq, low, 1);
        let two = self.b.icmp_imm(IntCc::Eq, low, 2);
        let peripheral = self.b.or(one, two);
        let area_p = self.b.i32_const(u32::from(area::P));
        self.b.select(peripheral, area_p, low)
    }

    /// Distance of the index `value`, an i32, from the first element in bits, and whether it is within its bounds.
    fn index(&mut self, index: &Index, value: Value, after: &[Index]) -> (Value, Value) {
        match index.bounds {
            IndexBounds::Known(low, high) => self.index_in_bounds(value, (low, high), index.stride),
            IndexBounds::Characters { length, .. } => self.index_in_bounds(value, (1, length), index.stride),
            IndexBounds::Open { parameter, dimension } => {
                let (low, high) = self.open_bounds(parameter, dimension);
                let above = self.b.icmp(IntCc::Sge, value, low);
                let below = self.b.icmp(IntCc::Sle, value, high);
                let ok = self.b.and(above, below);
                let mut distance = self.b.isub(value, low);
                for inner in after {
                    if let IndexBounds::Open { parameter, dimension } = inner.bounds {
                        let (low, high) = self.open_bounds(parameter, dimension);
                        let length = self.b.isub(high, low);
                        let length = self.b.binary_imm(BinaryOp::Iadd, length, 1);
                        distance = self.b.binary(BinaryOp::Imul, distance, length);
                    }
                }
                (self.b.binary_imm(BinaryOp::Imul, distance, i64::from(index.stride)), ok)
            }
        }
    }

    /// As [`index`](Self::index), with bounds that are known.
    pub fn index_in_bounds(&mut self, value: Value, (low, high): (i32, i32), stride: u32) -> (Value, Value) {
        let from_low = self.b.binary_imm(BinaryOp::Iadd, value, -i64::from(low));
        let last = i64::from(high) - i64::from(low);
        let ok = self.b.icmp_imm(IntCc::Ule, from_low, last);
        (self.b.binary_imm(BinaryOp::Imul, from_low, i64::from(stride)), ok)
    }

    /// Low and high bound of a dimension of the ARRAY[*] formal `parameter`, i32.
    pub fn open_bounds(&mut self, parameter: usize, dimension: u8) -> (Value, Value) {
        let at = 2 * usize::from(dimension);
        if let Some(values) = self.parameters.get(parameter) {
            return (values[2 + at], values[3 + at]);
        }
        let byte = self.block.interface.parameters[parameter].byte + 6 + 4 * at as u32;
        let low = self.read(&Place::Instance { byte, bit: 0 }, Width::Dword);
        let high = self.read(&Place::Instance { byte: byte + 4, bit: 0 }, Width::Dword);
        (low, high)
    }

    /// The memory access at a located place.
    pub fn located_target(&mut self, located: &Located, width: Width, direction: Direction) -> Target {
        let mut target = match &located.base {
            LocatedBase::Place(place) => {
                let db = self.get(self.regs.db);
                let target = self.target(place, width, direction);
                self.set(self.regs.db, db);
                target
            }
            LocatedBase::Indexed { area, byte, bit } => self.indexed_target(area, *byte, *bit, width, direction),
        };
        self.move_located(&mut target, located, width, direction);
        target
    }

    /// Moves a target at the base to the located place, and checks the indices.
    pub fn move_located(&mut self, target: &mut Target, located: &Located, width: Width, direction: Direction) {
        if let Some(offset) = located.offset {
            self.move_target(target, offset);
        }
        if let Some(check) = self.index_check(located, width, direction) {
            target.checks.insert(0, check);
        }
    }

    /// The check of the indices; none if they cannot be outside.
    pub(super) fn index_check(&mut self, located: &Located, width: Width, direction: Direction) -> Option<Check> {
        let ok = self.open_question(located)?;
        let code = if direction == Direction::Read { sync::LENGTH_READ } else { sync::LENGTH_WRITE };
        let code = self.b.i32_const(u32::from(code));
        let area = match &located.base {
            LocatedBase::Place(place) => place_area(place),
            LocatedBase::Indexed { .. } => PlaceArea::Db,
        };
        let (form, info) = match (located.index, located.offset, &located.base) {
            (Some(index), ..) => (fault_info::INDEX, index),
            (None, Some(_), LocatedBase::Place(_)) => (fault_info::INDICES, self.b.i32_const(0)),
            (None, Some(offset), LocatedBase::Indexed { .. }) => {
                (fault_info::ADDRESS, self.b.binary_imm(BinaryOp::Lshr, offset, 3))
            }
            (None, None, _) => (fault_info::ADDRESS, self.b.i32_const(0)),
        };
        let access = self.access_about(width, area, form);
        Some(Check { ok, code, access, info, db: None })
    }

    /// Whether the indices are in bounds, if that is not known before the program runs.
    pub(super) fn open_question(&self, located: &Located) -> Option<Value> {
        located.in_bounds.filter(|&ok| self.b.constant_bits(ok) != Some(1))
    }

    /// As [`open_question`](Self::open_question), and whether a text has the character.
    fn is_there(&mut self, located: &Located) -> Option<Value> {
        match (self.open_question(located), located.character.map(|character| character.there)) {
            (Some(in_bounds), Some(character)) => Some(self.b.and(in_bounds, character)),
            (in_bounds, character) => in_bounds.or(character),
        }
    }

    fn indexed_target(
        &mut self,
        area: &LocatedArea,
        byte: Value,
        bit: Option<Value>,
        width: Width,
        direction: Direction,
    ) -> Target {
        let shifted = self.b.binary_imm(BinaryOp::Shl, byte, 3);
        let mut checks = Vec::new();
        let address = match bit {
            None => shifted,
            Some(bit) => {
                let ok = self.b.icmp_imm(IntCc::Ule, bit, 7);
                let code = if direction == Direction::Read { sync::LENGTH_READ } else { sync::LENGTH_WRITE };
                let code = self.b.i32_const(u32::from(code));
                let access = self.access_of(width, PlaceArea::M);
                checks.push(Check { ok, code, access, info: byte, db: None });
                self.b.iadd(shifted, bit)
            }
        };
        // A byte address that does not fit a pointer would wrap.
        let ok = self.b.icmp_imm(IntCc::Ule, byte, 0xFFFF);
        let code = if direction == Direction::Read { sync::LENGTH_READ } else { sync::LENGTH_WRITE };
        let code = self.b.i32_const(u32::from(code));
        let access = self.access_of(width, PlaceArea::M);
        checks.push(Check { ok, code, access, info: byte, db: None });
        let target = match area {
            LocatedArea::Memory(area) => self.in_area_at(*area, address, width, direction),
            LocatedArea::Db(number) => {
                let before = self.get(self.regs.db);
                self.set(self.regs.db, *number);
                let loaded = self.b.db_length(*number);
                let ok = self.b.icmp_imm(IntCc::Ne, loaded, 0);
                let none = self.b.icmp_imm(IntCc::Eq, *number, 0);
                let ok = self.b.or(ok, none);
                let code = self.b.i32_const(u32::from(sync::DB_MISSING));
                let access = self.access_of(width, PlaceArea::Db);
                checks.push(Check { ok, code, access, info: *number, db: None });
                let target = self.in_area_at(PlaceArea::Db, address, width, direction);
                self.set(self.regs.db, before);
                target
            }
            LocatedArea::Coded { code, db } => {
                let high = self.b.binary_imm(BinaryOp::Shl, *code, 24);
                let low = self.b.binary_imm(BinaryOp::And, address, 0x00FF_FFFF);
                let pointer = self.b.or(high, low);
                self.area_crossing(&Crossing { pointer, offset: 0, db: *db, di: *db }, width, direction)
            }
        };
        checks.extend(target.checks);
        Target { kind: target.kind, checks }
    }

    /// Adds `offset` bits to a target.
    fn move_target(&mut self, target: &mut Target, offset: Value) {
        let (addr, bit) = match &mut target.kind {
            TargetKind::Memory { addr, bit } | TargetKind::Either { addr, bit, .. } => (addr, bit),
            TargetKind::Peripheral { address, .. } => {
                let bytes = self.b.binary_imm(BinaryOp::Ashr, offset, 3);
                *address = self.b.iadd(*address, bytes);
                return;
            }
        };
        let total = match *bit {
            BitNumber::Known(0) | BitNumber::Alone => offset,
            BitNumber::Known(bit) => self.b.binary_imm(BinaryOp::Iadd, offset, i64::from(bit)),
            BitNumber::Dynamic(bit) => self.b.iadd(offset, bit),
        };
        let bytes = self.b.binary_imm(BinaryOp::Ashr, total, 3);
        addr.base = Some(match addr.base {
            Some(base) => self.b.iadd(base, bytes),
            None => bytes,
        });
        *bit = BitNumber::Dynamic(self.b.binary_imm(BinaryOp::And, total, 7));
    }

    /// Accesses a place in a variable that an IN_OUT refers to, see [`by_reference`](Self::by_reference). False if it is not there.
    pub(super) fn by_located_reference(
        &mut self,
        located: &Located,
        width: Width,
        direction: Direction,
        access: &mut dyn FnMut(&mut Self, Target),
    ) -> bool {
        let LocatedBase::Place(place) = &located.base else { return false };
        if !self.is_by_reference(place) {
            return false;
        }
        let db = self.get(self.regs.db);
        self.by_reference(place, width, direction, &mut |this, mut target| {
            this.move_located(&mut target, located, width, direction);
            access(this, target);
        });
        self.set(self.regs.db, db);
        true
    }

    /// The address of a located place, and the conditions for its use.
    pub fn located_address(&mut self, located: &Located, direction: Direction) -> (Address, Vec<Check>) {
        let target = self.located_target(located, Width::Byte, direction);
        let (addr, _, checks) = self.in_memory(target, Width::Byte, direction);
        (addr, checks)
    }

    /// A pointer to a located place, for a called block; only right if the indices are in their bounds.
    pub fn located_pointer(&mut self, located: &Located) -> PointerFields {
        let fields = match &located.base {
            LocatedBase::Place(place) => {
                let db = self.get(self.regs.db);
                let fields = self.pointer_fields(place);
                self.set(self.regs.db, db);
                fields
            }
            LocatedBase::Indexed { area, byte, bit } => {
                let address = self.b.binary_imm(BinaryOp::Shl, *byte, 3);
                let address = match bit {
                    Some(bit) => self.b.iadd(address, *bit),
                    None => address,
                };
                let address = self.b.binary_imm(BinaryOp::And, address, 0x0007_FFFF);
                match area {
                    LocatedArea::Memory(area) => {
                        let code = i64::from(area_code(*area)) << 24;
                        let pointer = self.b.binary_imm(BinaryOp::Or, address, code);
                        PointerFields { db: self.b.i32_const(0), pointer }
                    }
                    LocatedArea::Db(number) => {
                        let pointer = self.b.binary_imm(BinaryOp::Or, address, i64::from(area::DB) << 24);
                        PointerFields { db: *number, pointer }
                    }
                    LocatedArea::Coded { code, db } => {
                        let high = self.b.binary_imm(BinaryOp::Shl, *code, 24);
                        PointerFields { db: *db, pointer: self.b.or(high, address) }
                    }
                }
            }
        };
        match located.offset {
            Some(offset) => PointerFields { pointer: self.b.iadd(fields.pointer, offset), ..fields },
            None => fields,
        }
    }

    /// As [`located_pointer`](Self::located_pointer), but with an index outside its bounds the pointer is into no data block.
    pub fn pointer_in_bounds(&mut self, located: &Located) -> PointerFields {
        let fields = self.located_pointer(located);
        let Some(ok) = self.is_there(located) else { return fields };
        let (no_db, nowhere) = (self.b.i32_const(0), self.b.i32_const(u32::from(area::DB) << 24));
        PointerFields { db: self.b.select(ok, fields.db, no_db), pointer: self.b.select(ok, fields.pointer, nowhere) }
    }

    /// As [`pointer_in_bounds`](Self::pointer_in_bounds), for a pointer that nothing else checks: an index outside its bounds is an error.
    pub fn checked_pointer(&mut self, located: &Located) -> PointerFields {
        let check = self.index_check(located, Width::Byte, Direction::Read);
        let guard = self.begin_guard(check.into_iter().collect(), Substitute::None);
        self.end_guard(guard);
        self.pointer_in_bounds(located)
    }
}

/// The place `bytes` before one in a variable that is passed by reference; `None`: it is in none.
fn place_before(place: &Place, bytes: u32) -> Option<Place> {
    let mut before = place.clone();
    match &mut before {
        Place::Parameter { byte, .. } | Place::ThroughPointer { byte, .. } => *byte = byte.checked_sub(bytes)?,
        Place::I { .. }
        | Place::Q { .. }
        | Place::M { .. }
        | Place::L { .. }
        | Place::Pi { .. }
        | Place::Pq { .. }
        | Place::OpenDb { .. }
        | Place::OpenDi { .. }
        | Place::Db { .. }
        | Place::Instance { .. }
        | Place::Indirect { .. }
        | Place::Register { .. }
        | Place::Element { .. } => return None,
    }
    Some(before)
}

const fn place_area(place: &Place) -> PlaceArea {
    match place {
        Place::I { .. } => PlaceArea::I,
        Place::Q { .. } => PlaceArea::Q,
        Place::M { .. } => PlaceArea::M,
        Place::L { .. } => PlaceArea::L,
        Place::Pi { .. } => PlaceArea::Pi,
        Place::Pq { .. } => PlaceArea::Pq,
        Place::OpenDi { .. } | Place::Instance { .. } => PlaceArea::Di,
        Place::OpenDb { .. }
        | Place::Db { .. }
        | Place::Parameter { .. }
        | Place::ThroughPointer { .. }
        | Place::Indirect { .. }
        | Place::Register { .. }
        | Place::Element { .. } => PlaceArea::Db,
    }
}

const fn area_code(of: PlaceArea) -> u8 {
    match of {
        PlaceArea::I => area::I,
        PlaceArea::Q => area::Q,
        PlaceArea::M => area::M,
        PlaceArea::Pi | PlaceArea::Pq => area::P,
        PlaceArea::L => area::L,
        PlaceArea::Db => area::DB,
        PlaceArea::Di => area::DI,
    }
}
