//! What the complex IN_OUT parameters of an FB refer to, found out once.
//!
//! Such a parameter is a POINTER in the instance. To read it, to look for its area and to compare with the length of its DB costs
//! many times what the access itself does. Blocks in SCL, LAD and FBD read their pointers where they begin and after each call of
//! a block of the program; nothing else changes them (decision 97). Most refer to a variable that is a DB with all of its bytes: then accesses go
//! there, without further checks. All other pointers take the ordinary way, on a cold side.

use plcc_abi::layout::area;
use plcc_ir::{Address, BinaryOp, IntCc, Region, Type, Value, Var};
use plcc_model::{Direction as Passed, Passing, Place, PlaceArea, Width};
use rustc_hash::FxHashMap;

use super::{BitNumber, Direction, Target};
use crate::block::BlockLowering;

/// References of a block by the byte of their POINTER in the instance.
pub type References = FxHashMap<u32, Reference>;

/// The POINTER of an IN_OUT, and what it refers to.
#[derive(Clone, Copy)]
pub struct Reference {
    /// Size of the variable, in bytes.
    bytes: u32,
    /// The fields of the POINTER, i32 both.
    db: Var,
    pointer: Var,
    /// Offset of the variable from the memory base, an i32: right if `readable`.
    target: Var,
    /// The variable is in a DB with all of its bytes, an i1.
    readable: Var,
    /// It is, and the DB is not write-protected.
    writable: Var,
}

impl BlockLowering<'_, '_> {
    /// Reads the pointers of all complex IN_OUT of this block.
    pub fn begin_references(&mut self) {
        if self.instance.is_none() {
            return;
        }
        for parameter in &self.block.interface.parameters {
            let (Passing::Complex { bytes }, Passed::InOut) = (parameter.passing, parameter.direction) else {
                continue;
            };
            let reference = Reference {
                bytes,
                db: self.b.declare_var(Type::I32),
                pointer: self.b.declare_var(Type::I32),
                target: self.b.declare_var(Type::I32),
                readable: self.b.declare_var(Type::I1),
                writable: self.b.declare_var(Type::I1),
            };
            self.references.insert(parameter.byte, reference);
            self.resolve(parameter.byte, reference);
        }
    }

    /// Reads the pointers again, after a block that may have changed them.
    pub fn renew_references(&mut self) {
        for parameter in &self.block.interface.parameters {
            if let Some(&reference) = self.references.get(&parameter.byte) {
                self.resolve(parameter.byte, reference);
            }
        }
    }

    fn resolve(&mut self, at: u32, reference: Reference) {
        let db = self.read(&Place::Instance { byte: at, bit: 0 }, Width::Word);
        let pointer = self.read(&Place::Instance { byte: at + 2, bit: 0 }, Width::Dword);
        let code = self.b.binary_imm(BinaryOp::Lshr, pointer, 24);
        let is_db = self.b.icmp_imm(IntCc::Eq, code, i64::from(area::DB));
        let effective = self.effective(pointer, 0);
        let aligned = self.b.icmp_imm(IntCc::Eq, effective.bit, 0);
        let (base, length) = (self.b.db_base(db), self.b.db_length(db));
        let end = self.b.binary_imm(BinaryOp::Iadd, effective.byte, i64::from(reference.bytes));
        let inside = self.b.icmp(IntCc::Ule, end, length);
        let readable = self.b.and(is_db, aligned);
        let readable = self.b.and(readable, inside);
        let writable = match self.protection_check(db, Width::Byte, PlaceArea::Db, Direction::Write) {
            Some(check) => self.b.and(readable, check.ok),
            None => readable,
        };
        let target = self.b.iadd(base, effective.byte);
        self.b.def_var(reference.db, db);
        self.b.def_var(reference.pointer, pointer);
        self.b.def_var(reference.target, target);
        self.b.def_var(reference.readable, readable);
        self.b.def_var(reference.writable, writable);
    }

    /// Number of the DB and pointer of the POINTER at byte `at` of the instance, i32 both.
    pub fn pointer_in_instance(&mut self, at: u32) -> (Value, Value) {
        match self.references.get(&at) {
            Some(&Reference { db, pointer, .. }) => (self.b.use_var(db), self.b.use_var(pointer)),
            None => {
                let db = self.read(&Place::Instance { byte: at, bit: 0 }, Width::Word);
                (db, self.read(&Place::Instance { byte: at + 2, bit: 0 }, Width::Dword))
            }
        }
    }

    /// True if [`by_reference`](Self::by_reference) reaches `place`.
    pub fn is_by_reference(&self, place: &Place) -> bool {
        matches!(place, Place::ThroughPointer { pointer, .. } if self.references.contains_key(pointer))
    }

    /// Where `place` is, in a variable that an IN_OUT refers to, if the i1 is true.
    pub fn referenced(&mut self, place: &Place, direction: Direction) -> Option<(Address, Value)> {
        let Place::ThroughPointer { pointer, byte, bit: 0 } = *place else { return None };
        let reference = *self.references.get(&pointer)?;
        let good = match direction {
            Direction::Read => reference.readable,
            Direction::Write => reference.writable,
        };
        let (good, target) = (self.b.use_var(good), self.b.use_var(reference.target));
        Some((Address::indexed(Region::AnyDb, target, byte), good))
    }

    /// Accesses `place`, in a variable that an IN_OUT refers to. `access` is done twice: with the place in a DB, and on a cold way with
    /// whatever else the pointer may be. It moves neither out of the variable without a check of its own.
    pub fn by_reference(
        &mut self,
        place: &Place,
        width: Width,
        direction: Direction,
        access: &mut dyn FnMut(&mut Self, Target),
    ) {
        let Place::ThroughPointer { pointer, byte, bit } = *place else {
            unreachable!("only asked for what an IN_OUT refers to")
        };
        let reference = self.references[&pointer];
        let good = match direction {
            Direction::Read => reference.readable,
            Direction::Write => reference.writable,
        };
        let (good, target) = (self.b.use_var(good), self.b.use_var(reference.target));
        let (there, other, join) = (self.b.create_block(), self.b.create_cold_block(), self.b.create_block());
        self.b.branch(good, there, other);
        self.b.seal_block(there);
        self.b.seal_block(other);
        self.b.switch_to(there);
        access(self, Target::at(Address::indexed(Region::AnyDb, target, byte), BitNumber::Known(bit)));
        self.b.jump(join, &[]);
        self.b.switch_to(other);
        let elsewhere = self.target(place, width, direction);
        access(self, elsewhere);
        self.b.jump(join, &[]);
        self.b.seal_block(join);
        self.b.switch_to(join);
    }
}
