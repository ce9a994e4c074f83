//! POINTER, ANY and VARIANT as actual parameters.

use plcc_abi::any::{Fields, block_move};
use plcc_ir::{Address, BinaryOp, IntCc, Value};
use plcc_model::layout;
use plcc_model::scl::{Access, Actual, Base};
use plcc_model::types::DataType;
use plcc_model::{Passing, Place, Pointed, Width};

use super::{Given, Source, Supply};
use crate::block::BlockLowering;
use crate::call::known_bytes;
use crate::fault::Substitute;
use crate::place::{self, BitNumber, Target};
use crate::pointer::{ANY_HEAD_BYTES, PointerFields, moved};
use crate::scl::located::Located;

/// A POINTER or ANY.
pub enum PointerSource<'m> {
    Bytes(&'m [u8]),
    Fields {
        head: u32,
        fields: PointerFields,
    },
    /// An ARRAY[*]: its number of elements, an i32, and how many units of the ANY's type each of them is.
    Counted {
        type_code: u8,
        elements: Value,
        each: u16,
        fields: PointerFields,
    },
    Copy(Located<'m>),
    Variant(Box<PointerSource<'m>>, Pointed),
}

impl BlockLowering<'_, '_> {
    pub(super) fn pointer_source<'m>(&mut self, actual: &'m Actual) -> PointerSource<'m> {
        let head = |type_code: u8, count: u16| 0x10 << 24 | u32::from(type_code) << 16 | u32::from(count);
        match actual {
            Actual::PointerBytes(bytes) => PointerSource::Bytes(bytes),
            Actual::PointerTo { access, type_code, count } if matches!(access.ty, DataType::OpenArray(_)) => {
                let located = self.locate(access);
                let fields = self.checked_pointer(&located);
                let elements = self.elements_of(access);
                PointerSource::Counted { type_code: *type_code, elements, each: *count, fields }
            }
            Actual::PointerTo { access, type_code, count } => {
                let fields = match self.elementary_formal(access) {
                    Some(width) => self.pointer_to_copy(access, width),
                    None => {
                        let located = self.locate(access);
                        self.checked_pointer(&located)
                    }
                };
                PointerSource::Fields { head: head(*type_code, *count), fields }
            }
            Actual::PointerCopy(access) => PointerSource::Copy(self.locate(access)),
            Actual::PointerToValue { value, type_code } => {
                let ty = value.ty;
                let value = self.value(value);
                let value = self.untyped(value, ty);
                let width = layout::width(ty);
                let temporary = self.temporary(width.bytes());
                self.write_target(Target::at(temporary, BitNumber::Known(0)), width, value);
                let fields = self.pointer_fields(&Place::L { byte: temporary.offset, bit: 0 });
                PointerSource::Fields { head: head(*type_code, 1), fields }
            }
            Actual::PointerToComplex { value, type_code, count } => {
                let fields = match self.source(value) {
                    Source::Variable { located, .. } => self.checked_pointer(&located),
                    Source::Frame(addr) => self.pointer_fields(&Place::L { byte: addr.offset, bit: 0 }),
                };
                PointerSource::Fields { head: head(*type_code, *count), fields }
            }
            Actual::Variant(any, pointed) => PointerSource::Variant(Box::new(self.pointer_source(any)), *pointed),
            _ => unreachable!("only used for pointers"),
        }
    }

    /// The pointers of a block move, if both are known.
    pub fn given_block_move_pointers(&self, given: &[Given]) -> Option<(Fields, Fields)> {
        let known = |parameter| {
            let given = given.iter().find(|given| given.parameter == parameter)?;
            match &given.supply {
                Supply::Pointer(PointerSource::Bytes(bytes)) => known_bytes(bytes),
                Supply::Pointer(PointerSource::Fields { head, fields }) => self.known_any(*head, *fields),
                _ => None,
            }
        };
        Some((known(block_move::SOURCE)?, known(block_move::DESTINATION)?))
    }

    /// The width of the access if it is one of a whole elementary formal of this FC. The FC knows the address of the actual in
    /// memory, but has no POINTER to it.
    fn elementary_formal(&self, access: &Access) -> Option<Width> {
        match access.base {
            Base::Place(Place::Parameter { parameter, .. }) => match self.passing(parameter) {
                Passing::Elementary(width) => Some(width),
                Passing::Complex { .. }
                | Passing::Number
                | Passing::Pointer
                | Passing::Any
                | Passing::Variant
                | Passing::OpenArray { .. } => None,
            },
            _ => None,
        }
    }

    /// A pointer to a copy in this frame, which is copied back after the call.
    fn pointer_to_copy(&mut self, access: &Access, width: Width) -> PointerFields {
        let ty = access.elementary().expect("an elementary formal has an elementary type");
        let value = self.read_access(access);
        let value = self.untyped(value, ty);
        let copy = self.temporary(width.bytes());
        self.write_target(Target::at(copy, BitNumber::Known(0)), width, value);
        self.scl.pointed_copies.push((access.clone(), copy));
        self.pointer_fields(&Place::L { byte: copy.offset, bit: 0 })
    }

    /// Copies back the copies that pointers of a call pointed at: those that were made after the first `before`.
    pub fn take_pointed_copies(&mut self, before: usize) {
        for (access, copy) in self.scl.pointed_copies.split_off(before) {
            let ty = access.elementary().expect("an elementary formal has an elementary type");
            let value = self.read_target(Target::at(copy, BitNumber::Known(0)), layout::width(ty));
            let value = self.typed(value, ty);
            self.write_access(&access, value);
        }
    }

    pub(super) fn store_pointer_source(&mut self, addr: Address, source: &PointerSource, any: bool) {
        match source {
            PointerSource::Bytes(bytes) => self.store_pointer_bytes(addr, bytes),
            PointerSource::Fields { head, fields } if any => {
                let head = self.b.i32_const(*head);
                self.store_low(addr, Width::Dword, head);
                self.store_pointer_fields(moved(addr, ANY_HEAD_BYTES), *fields);
            }
            PointerSource::Fields { fields, .. } => self.store_pointer_fields(addr, *fields),
            PointerSource::Counted { type_code, elements, each, fields } => {
                let count = self.b.binary_imm(BinaryOp::Imul, *elements, i64::from(*each));
                let most = self.b.i32_const(0xFFFF);
                let fits = self.b.icmp(IntCc::Ult, count, most);
                let count = self.b.select(fits, count, most);
                let head = self.b.binary_imm(BinaryOp::Or, count, 0x10 << 24 | i64::from(*type_code) << 16);
                self.store_low(addr, Width::Dword, head);
                self.store_pointer_fields(moved(addr, ANY_HEAD_BYTES), *fields);
            }
            PointerSource::Copy(located) => {
                let (from, checks) = self.located_address(located, place::Direction::Read);
                let guard = self.begin_guard(checks, Substitute::None);
                self.copy_pointer(addr, from, any);
                self.end_guard(guard);
            }
            PointerSource::Variant(pointer, pointed) => {
                self.store_pointer_source(addr, pointer, any);
                match (pointed, &**pointer) {
                    (Pointed::Known { elements, ty }, _) => {
                        let elements = self.b.i32_const(*elements);
                        self.store_pointed(addr, elements, *ty);
                    }
                    (Pointed::Counted { ty }, PointerSource::Counted { elements, .. }) => {
                        self.store_pointed(addr, *elements, *ty);
                    }
                    (Pointed::Counted { .. }, _) => unreachable!("the binder only counts elements of ARRAY[*]"),
                    (Pointed::Copied, PointerSource::Copy(located)) => {
                        let (from, checks) = self.located_address(located, place::Direction::Read);
                        let guard = self.begin_guard(checks, Substitute::None);
                        self.copy_pointed(addr, from);
                        self.end_guard(guard);
                    }
                    (Pointed::Copied, _) => unreachable!("the binder only copies pointers"),
                }
            }
        }
    }

    /// Number of elements of an ARRAY[*], an i32; none if it was not supplied.
    fn elements_of(&mut self, access: &Access) -> Value {
        let DataType::OpenArray(array) = &access.ty else { unreachable!("only used for ARRAY[*]") };
        let mut elements = self.b.i32_const(1);
        for dimension in 0..array.dimensions {
            let (low, high) = self.bounds_of(access, dimension);
            let length = self.b.binary(BinaryOp::Isub, high, low);
            let length = self.b.binary_imm(BinaryOp::Iadd, length, 1);
            elements = self.b.binary(BinaryOp::Imul, elements, length);
        }
        elements
    }
}
