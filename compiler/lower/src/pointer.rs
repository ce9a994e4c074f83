//! POINTER and ANY structures. Source: STL reference, composite encodings.

use plcc_abi::image::BlockKind;
use plcc_abi::layout::area;
use plcc_ir::{Address, BinaryOp, IntCc, Region, Type, Value};
use plcc_model::layout;
use plcc_model::{Actual, Direction, Passing, Place, Pointed, Width};

use crate::block::BlockLowering;
use crate::place::{BitNumber, Target};
use crate::plan;

/// Syntax id of an ANY for S7.
pub const ANY_S7: u32 = 0x10;
/// Data type ids inside an ANY come before its POINTER: id, type, repetition factor.
pub const ANY_HEAD_BYTES: u32 = 4;
/// Byte and bit address of a pointer.
const POINTER_BITS: i64 = 0x0007_FFFF;

/// The two fields of a POINTER.
#[derive(Clone, Copy)]
pub struct PointerFields {
    /// DB number, an i32; 0: not in a DB.
    pub db: Value,
    /// Area-crossing pointer, an i32.
    pub pointer: Value,
}

impl BlockLowering<'_, '_> {
    /// A pointer to `place` for a called block: local data of this block is the callee's area V.
    pub fn pointer_fields(&mut self, place: &Place) -> PointerFields {
        let known = |code: u8, byte: u32, bit: u8| (u32::from(code) << 24) | (byte << 3) | u32::from(bit);
        let (db, pointer) = match *place {
            Place::I { byte, bit } => (None, known(area::I, byte, bit)),
            Place::Q { byte, bit } => (None, known(area::Q, byte, bit)),
            Place::M { byte, bit } => (None, known(area::M, byte, bit)),
            Place::L { byte, bit } => (None, known(area::V, byte, bit)),
            Place::Pi { byte, bit } | Place::Pq { byte, bit } => (None, known(area::P, byte, bit)),
            Place::Db { number, byte, bit } => (Some(self.b.i32_const(u32::from(number))), known(area::DB, byte, bit)),
            Place::OpenDb { byte, bit } => (Some(self.get(self.regs.db)), known(area::DB, byte, bit)),
            Place::OpenDi { byte, bit } => (Some(self.get(self.regs.di)), known(area::DB, byte, bit)),
            Place::Instance { byte, bit } => return self.instance_pointer(byte, bit),
            Place::Parameter { parameter, byte, bit } => return self.parameter_pointer(parameter, byte, bit),
            Place::ThroughPointer { pointer, byte, bit } => {
                let (db, start) = self.pointer_in_instance(pointer);
                let pointer = self.b.binary_imm(BinaryOp::Iadd, start, i64::from(8 * byte + u32::from(bit)));
                let pointer = self.handed_on(pointer);
                return PointerFields { db, pointer };
            }
            Place::Element { ref base, ref indices } => {
                let located = self.located_element(base, indices);
                return self.pointer_in_bounds(&located);
            }
            Place::Indirect { .. } | Place::Register { .. } => {
                unreachable!("the binder passes no indirect address as an actual parameter")
            }
        };
        let db = db.unwrap_or_else(|| self.b.i32_const(0));
        PointerFields { db, pointer: self.b.i32_const(pointer) }
    }

    /// As [`pointer_fields`](Self::pointer_fields), for a pointer that nothing else checks: an index outside its bounds is an error.
    pub fn checked_pointer_fields(&mut self, place: &Place) -> PointerFields {
        match place {
            Place::Element { base, indices } => {
                let located = self.located_element(base, indices);
                self.checked_pointer(&located)
            }
            place => self.pointer_fields(place),
        }
    }

    /// In this FB's instance: in the DB of DI, at AR2.
    fn instance_pointer(&mut self, byte: u32, bit: u8) -> PointerFields {
        let (db, ar2) = (self.get(self.regs.di), self.get(self.regs.ar[1]));
        let base = self.b.binary_imm(BinaryOp::And, ar2, 0x00FF_FFFF);
        let address = self.b.binary_imm(BinaryOp::Iadd, base, i64::from(8 * byte + u32::from(bit)));
        let pointer = self.b.binary_imm(BinaryOp::Or, address, i64::from(area::DB) << 24);
        PointerFields { db, pointer }
    }

    /// The target of a formal parameter of this FC: its own POINTER, moved on. An elementary one has none: the pointer goes to a
    /// copy in this frame, which [`bring_back`](BlockLowering::bring_back) copies back after the call.
    fn parameter_pointer(&mut self, parameter: usize, byte: u32, bit: u8) -> PointerFields {
        match self.passing(parameter) {
            Passing::Complex { .. } | Passing::OpenArray { .. } => {
                let db = self.read_parameter_structure(parameter, 0, Width::Word);
                let start = self.read_parameter_structure(parameter, 2, Width::Dword);
                let pointer = self.b.binary_imm(BinaryOp::Iadd, start, i64::from(8 * byte + u32::from(bit)));
                let pointer = self.handed_on(pointer);
                PointerFields { db, pointer }
            }
            Passing::Elementary(width) => {
                let place = Place::Parameter { parameter, byte, bit };
                let copy = self.temporary(plan::POINTED_COPY_BYTES);
                let value = self.read(&place, width);
                self.write_target(Target::at(copy, BitNumber::Known(0)), width, value);
                // A function's changes to its input stay inside it.
                if self.block.interface.parameters[parameter].direction != Direction::Input {
                    self.pointed_copies.push((place, width, copy));
                }
                self.pointer_fields(&Place::L { byte: copy.offset, bit: 0 })
            }
            Passing::Number | Passing::Pointer | Passing::Any | Passing::Variant => {
                unreachable!("the binder copies pointers, and numbers have no address")
            }
        }
    }

    /// Copies back the copies that pointers of a call pointed at.
    pub fn bring_back(&mut self) {
        for (place, width, copy) in std::mem::take(&mut self.pointed_copies) {
            let value = self.read_target(Target::at(copy, BitNumber::Known(0)), width);
            self.write(&place, width, value);
        }
    }

    /// A pointer that this block was given, for a block that it calls. Area V is the caller's local data here, but this
    /// block's there, so its addresses are moved by the distance of the two frames. They wrap inside the L stack.
    fn handed_on(&mut self, pointer: Value) -> Value {
        let frame = self.b.address_of(Address::direct(Region::L, 0));
        let caller = self.b.address_of(Address::direct(Region::V, 0));
        let distance = self.b.isub(frame, caller);
        let bits = self.b.binary_imm(BinaryOp::Shl, distance, 3);
        let moved = self.b.isub(pointer, bits);
        let moved = self.b.binary_imm(BinaryOp::And, moved, POINTER_BITS);
        let moved = self.b.binary_imm(BinaryOp::Or, moved, i64::from(area::V) << 24);
        let code = self.b.binary_imm(BinaryOp::Lshr, pointer, 24);
        let is_local = self.b.icmp_imm(IntCc::Eq, code, i64::from(area::V));
        self.b.select(is_local, moved, pointer)
    }

    /// Reads from the structure that the caller put into its frame for a formal parameter.
    pub fn read_parameter_structure(&mut self, parameter: usize, offset: u32, width: Width) -> Value {
        let base = self.parameters[parameter][0];
        self.load_zero_extended(Address::indexed(Region::V, base, offset), width)
    }

    pub fn store_pointer_fields(&mut self, addr: Address, fields: PointerFields) {
        self.store_low(addr, Width::Word, fields.db);
        self.store_low(moved(addr, 2), Width::Dword, fields.pointer);
    }

    /// Writes the POINTER (6 bytes) or ANY (10 bytes) of an actual parameter to `addr`.
    pub fn store_pointer(&mut self, addr: Address, actual: &Actual, any: bool) {
        match actual {
            Actual::PointerBytes(bytes) | Actual::Const(bytes) => self.store_pointer_bytes(addr, bytes),
            Actual::PointerTo { place, type_code, count } => {
                let fields = self.checked_pointer_fields(place);
                if any {
                    let head = ANY_S7 << 24 | u32::from(*type_code) << 16 | u32::from(*count);
                    let head = self.b.i32_const(head);
                    self.store_low(addr, Width::Dword, head);
                    self.store_pointer_fields(moved(addr, ANY_HEAD_BYTES), fields);
                } else {
                    self.store_pointer_fields(addr, fields);
                }
            }
            Actual::PointerCopy(place) => {
                let source = self.target(place, Width::Byte, crate::place::Direction::Read);
                let guard = self.begin_guard(source.checks, crate::fault::Substitute::None);
                if let crate::place::TargetKind::Memory { addr: from, .. } = source.kind {
                    self.copy_pointer(addr, from, any);
                }
                self.end_guard(guard);
            }
            Actual::Variant(pointer, pointed) => {
                self.store_pointer(addr, pointer, any);
                match (pointed, &**pointer) {
                    (Pointed::Known { elements, ty }, _) => {
                        let elements = self.b.i32_const(*elements);
                        self.store_pointed(addr, elements, *ty);
                    }
                    (Pointed::Counted { .. }, _) => unreachable!("only SCL has ARRAY[*]"),
                    (Pointed::Copied, Actual::PointerCopy(place)) => {
                        let source = self.target(place, Width::Byte, crate::place::Direction::Read);
                        let guard = self.begin_guard(source.checks, crate::fault::Substitute::None);
                        if let crate::place::TargetKind::Memory { addr: from, .. } = source.kind {
                            self.copy_pointed(addr, from);
                        }
                        self.end_guard(guard);
                    }
                    (Pointed::Copied, _) => unreachable!("the binder only copies pointers"),
                }
            }
            Actual::Place(_) | Actual::Number(_) => unreachable!("the binder gives pointer formals pointers"),
        }
    }

    /// Writes the contents of a VARIANT at `addr` after its ANY.
    pub fn store_pointed(&mut self, addr: Address, elements: Value, ty: u32) {
        let ty = self.b.i32_const(ty);
        for (at, field) in [(layout::VARIANT_ELEMENTS, elements), (layout::VARIANT_TYPE, ty)] {
            self.store_low(moved(addr, at), Width::Dword, field);
        }
    }

    /// Copies the contents of the VARIANT at `from` after its ANY.
    pub fn copy_pointed(&mut self, addr: Address, from: Address) {
        let bytes = Passing::Variant.pointer_bytes() - layout::ANY_BYTES;
        self.b.copy(moved(addr, layout::ANY_BYTES), moved(from, layout::ANY_BYTES), bytes);
    }

    /// Copies a POINTER or ANY for a block that is called.
    pub fn copy_pointer(&mut self, addr: Address, from: Address, any: bool) {
        let bytes = if any { 10 } else { 6 };
        // As programs fill them, word by word, so that what is known of a field stays known.
        for at in (0..bytes - 4).step_by(2) {
            let field = self.b.load(Type::I16, moved(from, at));
            self.b.store(moved(addr, at), field);
        }
        let mut pointer = self.b.load(Type::I32, moved(from, bytes - 4));
        if self.block.kind != BlockKind::Ob {
            pointer = self.handed_on(pointer);
        }
        self.b.store(moved(addr, bytes - 4), pointer);
    }

    /// Writes a constant POINTER, ANY or VARIANT, field by field as it is read.
    pub fn store_pointer_bytes(&mut self, addr: Address, bytes: &[u8]) {
        let head = if bytes.len() < layout::ANY_BYTES as usize { 0 } else { ANY_HEAD_BYTES };
        let mut at = 0;
        for end in [head, head + 2, bytes.len() as u32] {
            self.store_bytes(moved(addr, at), &bytes[at as usize..end as usize]);
            at = end;
        }
    }

    /// Writes constant bytes to `addr`, the widest pieces first.
    pub fn store_bytes(&mut self, addr: Address, bytes: &[u8]) {
        let mut at = 0;
        while at < bytes.len() {
            let left = bytes.len() - at;
            let (width, count) = match left {
                4.. => (Width::Dword, 4),
                2.. => (Width::Word, 2),
                _ => (Width::Byte, 1),
            };
            let value = bytes[at..at + count].iter().fold(0u32, |value, &byte| value << 8 | u32::from(byte));
            let value = self.b.i32_const(value);
            self.store_low(moved(addr, at as u32), width, value);
            at += count;
        }
    }
}

/// `addr` plus `bytes`.
pub fn moved(addr: Address, bytes: u32) -> Address {
    Address { offset: addr.offset + bytes, ..addr }
}
