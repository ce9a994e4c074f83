//! Where a block move reads and writes.

use plcc_abi::layout::{AREA_BYTES, area};
use plcc_ir::{Address, BinaryOp, ConvertOp, Function, Inst, InstData, IntCc, Loc, Region, StaticDb, Type, Value};

use super::structure::{Number, Pointed, STRUCTURE_BYTES};
use crate::surroundings::Surroundings;

/// The bits of a pointer that say its area, and those of the bit in a byte.
const AREA_AND_BIT: u64 = 0xFF00_0007;
const DB_AREA: u64 = (area::DB as u64) << 24;
/// The offset in an area, in bytes, of a pointer that was shifted by [`BIT_BITS`].
const OFFSET: u64 = 0xFFFF;
const BIT_BITS: u64 = 3;

/// A range of bytes.
#[derive(Clone, Copy)]
pub(super) enum Place {
    /// All is known.
    Known(Address),
    /// In a DB of the program where an i32 points to, up to byte `last`.
    At { pointer: Value, db: u16, last: u32 },
    /// In the DB whose number is an i16, where an i32 points to.
    Open { number: Value, pointer: Value, bytes: u32 },
}

/// The frame in which a block move is called.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    /// Where pointers to local data begin in region L.
    pub base: u32,
    /// Where the structure of parameters is.
    pub structure: u32,
}

impl Place {
    /// The `bytes` bytes at `pointed`. `None`: what is not there, or is not known to be, is left to the call.
    pub fn of(
        function: &Function,
        pointed: &Pointed,
        bytes: u32,
        frame: Frame,
        surroundings: &Surroundings,
    ) -> Option<Place> {
        let pointer = function.constant(pointed.pointer);
        let (kind, byte) = match pointer {
            Some(pointer) => (pointer & AREA_AND_BIT, (pointer >> BIT_BITS & OFFSET) as u32),
            None => (DB_AREA, 0),
        };
        let in_area = |region: Region, length: u32| {
            (byte + bytes <= length).then_some(Place::Known(Address::direct(region, byte)))
        };
        if kind & 7 != 0 {
            return None;
        }
        match (kind >> 24) as u8 {
            area::I => in_area(Region::I, surroundings.areas.inputs),
            area::Q => in_area(Region::Q, surroundings.areas.outputs),
            area::M => in_area(Region::M, surroundings.areas.bit_memory),
            area::L | area::V => {
                // What a block passes on is before its own frame: addresses wrap.
                let start = frame.base.wrapping_add(byte) % AREA_BYTES;
                let is_free = start + bytes <= frame.structure || frame.structure + STRUCTURE_BYTES <= start;
                let is_there = start + bytes <= function.local_bytes() && is_free;
                is_there.then_some(Place::Known(Address::direct(Region::L, start)))
            }
            area::DB | area::DI => match pointed.db {
                Number::Known(number) => {
                    let db = find(surroundings, number)?;
                    let length = db.length.min(AREA_BYTES);
                    match pointer {
                        Some(_) => in_area(Region::Db(number), length),
                        None => {
                            let last = length.checked_sub(bytes)?;
                            Some(Place::At { pointer: pointed.pointer, db: number, last })
                        }
                    }
                }
                Number::Computed(number) if byte + bytes <= AREA_BYTES => {
                    Some(Place::Open { number, pointer: pointed.pointer, bytes })
                }
                Number::Computed(_) => None,
            },
            _ => None,
        }
    }

    /// True if all of it can be written.
    pub fn is_writable(self, surroundings: &Surroundings) -> bool {
        let number = match self {
            Place::Known(Address { region: Region::Db(number), .. }) => number,
            Place::Known(_) => return true,
            Place::At { db, .. } => db,
            Place::Open { .. } => return surroundings.dbs.iter().all(|db| !db.read_only),
        };
        find(surroundings, number).is_some_and(|db| !db.read_only)
    }
}

fn find(surroundings: &Surroundings, number: u16) -> Option<StaticDb> {
    surroundings.dbs.iter().find(|db| db.number == number).copied()
}

/// Makes instructions in a row.
pub(super) struct Builder<'f> {
    pub function: &'f mut Function,
    pub out: Vec<Inst>,
    pub loc: Loc,
}

impl Builder<'_> {
    pub fn push(&mut self, data: InstData) {
        let inst = self.function.make_inst(data, &[], self.loc);
        self.out.push(inst);
    }

    fn value(&mut self, data: InstData, ty: Type) -> Value {
        let inst = self.function.make_inst(data, &[ty], self.loc);
        self.out.push(inst);
        self.function.result(inst)
    }

    pub fn constant(&mut self, ty: Type, bits: u64) -> Value {
        self.value(InstData::Const { bits }, ty)
    }

    pub fn binary(&mut self, op: BinaryOp, ty: Type, one: Value, two: Value) -> Value {
        self.value(InstData::Binary { op, args: [one, two] }, ty)
    }

    fn binary_with(&mut self, op: BinaryOp, one: Value, constant: u64) -> Value {
        let two = self.constant(Type::I32, constant);
        self.binary(op, Type::I32, one, two)
    }

    fn compare(&mut self, cc: IntCc, one: Value, two: Value) -> Value {
        self.value(InstData::IntCompare { cc, args: [one, two] }, Type::I1)
    }

    fn compare_with(&mut self, cc: IntCc, one: Value, constant: u64) -> Value {
        let two = self.constant(Type::I32, constant);
        self.compare(cc, one, two)
    }

    fn both(&mut self, one: Option<Value>, two: Option<Value>) -> Option<Value> {
        match (one, two) {
            (Some(one), Some(two)) => Some(self.binary(BinaryOp::And, Type::I1, one, two)),
            (one, two) => one.or(two),
        }
    }

    /// Where a place begins, and whether it is there. `None`: it surely is.
    pub fn locate(&mut self, place: Place) -> (Address, Option<Value>) {
        match place {
            Place::Known(addr) => (addr, None),
            Place::At { pointer, db, last } => {
                let (byte, is_db) = self.offset(pointer);
                let is_there = self.compare_with(IntCc::Ule, byte, u64::from(last));
                (Address::indexed(Region::Db(db), byte, 0), self.both(is_db, Some(is_there)))
            }
            Place::Open { number, pointer, bytes } => {
                let (byte, is_db) = self.offset(pointer);
                let number = self.value(InstData::Convert { op: ConvertOp::Zext, arg: number }, Type::I32);
                let length = self.value(InstData::DbLength { number }, Type::I32);
                let end = self.binary_with(BinaryOp::Iadd, byte, u64::from(bytes));
                let mut is_there = Some(self.compare(IntCc::Ule, end, length));
                if self.function.constant(byte).is_none() {
                    let is_in_area = self.compare_with(IntCc::Ule, end, u64::from(AREA_BYTES));
                    is_there = self.both(is_there, Some(is_in_area));
                }
                let base = self.value(InstData::DbBase { number }, Type::I32);
                let addr = match self.function.constant(byte) {
                    Some(byte) => Address::indexed(Region::AnyDb, base, byte as u32),
                    None => {
                        let start = self.binary(BinaryOp::Iadd, Type::I32, base, byte);
                        Address::indexed(Region::AnyDb, start, 0)
                    }
                };
                (addr, self.both(is_db, is_there))
            }
        }
    }

    /// The byte of a DB to which a pointer points, an i32, and whether it is one. `None`: it surely is.
    fn offset(&mut self, pointer: Value) -> (Value, Option<Value>) {
        if let Some(pointer) = self.function.constant(pointer) {
            return (self.constant(Type::I32, pointer >> BIT_BITS & OFFSET), None);
        }
        let kind = self.binary_with(BinaryOp::And, pointer, AREA_AND_BIT);
        let is_db = self.compare_with(IntCc::Eq, kind, DB_AREA);
        let shifted = self.binary_with(BinaryOp::Lshr, pointer, BIT_BITS);
        (self.binary_with(BinaryOp::And, shifted, OFFSET), Some(is_db))
    }

    /// Whether `read` bytes at `from` and `written` bytes at `to` have none in common. `Some(None)`: surely; `None`: surely not.
    pub fn apart(&mut self, from: Address, read: u32, to: Address, written: u32) -> Option<Option<Value>> {
        if !from.region.may_alias(to.region) {
            return Some(None);
        }
        if from.region == to.region && from.base == to.base {
            let is_apart = from.offset + read <= to.offset || to.offset + written <= from.offset;
            return is_apart.then_some(None);
        }
        let first = self.value(InstData::AddressOf { addr: from }, Type::I32);
        let second = self.value(InstData::AddressOf { addr: to }, Type::I32);
        let after = self.binary(BinaryOp::Isub, Type::I32, second, first);
        let before = self.binary(BinaryOp::Isub, Type::I32, first, second);
        let is_after = self.compare_with(IntCc::Uge, after, u64::from(read));
        let is_before = self.compare_with(IntCc::Uge, before, u64::from(written));
        Some(self.both(Some(is_after), Some(is_before)))
    }
}
