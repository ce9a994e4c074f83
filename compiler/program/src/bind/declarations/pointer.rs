//! The bytes of POINTER, ANY and VARIANT.

use plcc_abi::any;
use plcc_model::layout::{self, type_code};
use plcc_model::types::{DataType, ParameterType};
use plcc_model::{Actual, Parameter, Place, Pointed};
use plcc_syntax::ast::{BlockPrefix, CellKind};

pub const CODE_BYTE: u8 = 0x02;
pub const CODE_DATE_AND_TIME: u8 = 0x0E;
/// First byte of every ANY.
const ANY_SYNTAX: u8 = 0x10;

/// Type code and repetition factor for a variable in an ANY.
pub fn any_of(ty: &DataType) -> (u8, u32) {
    match ty {
        DataType::Elementary(ty) => (type_code(*ty), 1),
        DataType::DateAndTime => (CODE_DATE_AND_TIME, 1),
        DataType::Array(array) => match &array.element {
            DataType::Elementary(ty) => (type_code(*ty), layout::element_count(&array.bounds) as u32),
            DataType::DateAndTime => (CODE_DATE_AND_TIME, layout::element_count(&array.bounds) as u32),
            _ => (CODE_BYTE, array.bytes),
        },
        DataType::String(length) => (CODE_BYTE, u32::from(*length) + 2),
        DataType::Struct(_)
        | DataType::WideString(_)
        | DataType::Parameter(_)
        | DataType::OpenArray(_)
        | DataType::Void => (CODE_BYTE, layout::bytes(ty)),
    }
}

/// The pointer to a place with a known address: DB number and area pointer. Local data has another area for the callee.
pub fn known_pointer(place: &Place) -> Option<(u16, u32)> {
    use plcc_abi::layout::area;
    let pointer = |area: u8, byte: u32, bit: u8| u32::from(area) << 24 | byte << 3 | u32::from(bit);
    match place {
        Place::I { byte, bit } => Some((0, pointer(area::I, *byte, *bit))),
        Place::Q { byte, bit } => Some((0, pointer(area::Q, *byte, *bit))),
        Place::M { byte, bit } => Some((0, pointer(area::M, *byte, *bit))),
        Place::Pi { byte, bit } | Place::Pq { byte, bit } => Some((0, pointer(area::P, *byte, *bit))),
        Place::Db { number, byte, bit } => Some((*number, pointer(area::DB, *byte, *bit))),
        Place::OpenDb { byte, bit } => Some((0, pointer(area::DB, *byte, *bit))),
        Place::OpenDi { byte, bit } => Some((0, pointer(area::DI, *byte, *bit))),
        Place::L { .. }
        | Place::Instance { .. }
        | Place::Parameter { .. }
        | Place::ThroughPointer { .. }
        | Place::Indirect { .. }
        | Place::Register { .. }
        | Place::Element { .. } => None,
    }
}

/// The place in L that a pointer constant names.
pub fn local_place(pointer: u32) -> Option<Place> {
    let area = (pointer >> 24) as u8;
    (area == plcc_abi::layout::area::L)
        .then_some(Place::L { byte: (pointer & 0x00FF_FFFF) >> 3, bit: (pointer & 7) as u8 })
}

pub fn any_bytes(code: u8, count: u16, db: u16, pointer: u32) -> Vec<u8> {
    let mut bytes = vec![ANY_SYNTAX, code];
    bytes.extend(count.to_be_bytes());
    bytes.extend(db.to_be_bytes());
    bytes.extend(pointer.to_be_bytes());
    bytes
}

/// The ANY of a timer or counter.
pub fn any_number_of_cell(kind: CellKind, number: u16) -> Vec<u8> {
    let code = match kind {
        CellKind::Timer => any::TIMER,
        CellKind::Counter => any::COUNTER,
    };
    any_bytes(code, 1, 0, u32::from(number))
}

/// The ANY of a block; some kinds do not have one.
pub fn any_number_of_block(prefix: BlockPrefix, number: u16) -> Option<Vec<u8>> {
    let code = match prefix {
        BlockPrefix::Fb | BlockPrefix::Sfb => any::BLOCK_FB,
        BlockPrefix::Fc | BlockPrefix::Sfc => any::BLOCK_FC,
        BlockPrefix::Db | BlockPrefix::Di => any::BLOCK_DB,
        BlockPrefix::Ob | BlockPrefix::Udt | BlockPrefix::Vat => return None,
    };
    Some(any_bytes(code, 1, 0, u32::from(number)))
}

pub fn pointer_bytes(db: u16, pointer: u32) -> Vec<u8> {
    let mut bytes = db.to_be_bytes().to_vec();
    bytes.extend(pointer.to_be_bytes());
    bytes
}

/// The contents of a VARIANT that points at no data.
pub const POINTS_AT_NOTHING: Pointed = Pointed::Known { elements: 0, ty: 0 };

/// The contents of a VARIANT that is written as `P#DB1.DBX0.0 BYTE 10`.
pub fn pointed_at_by_literal(type_code: u8, count: u16) -> Pointed {
    Pointed::Known { elements: if count > 1 { u32::from(count) } else { 0 }, ty: u32::from(type_code) }
}

/// The contents of a VARIANT for a variable of type `ty`.
pub fn pointed_at(ty: &DataType) -> Pointed {
    match ty {
        DataType::Array(array) => Pointed::Known {
            elements: u32::try_from(layout::element_count(&array.bounds)).unwrap_or(u32::MAX),
            ty: layout::type_number(&array.element),
        },
        other => Pointed::Known { elements: 0, ty: layout::type_number(other) },
    }
}

/// Type code of an array of `element` in an ANY, and the number that one element counts as. [`any_of`] names the source.
pub fn code_for_elements(element: &DataType) -> (u8, u16) {
    let bytes_of = |elements: i32| layout::array_bytes(&[(1, elements)], element);
    match element {
        DataType::Elementary(ty) => (type_code(*ty), 1),
        DataType::DateAndTime => (CODE_DATE_AND_TIME, 1),
        _ => (CODE_BYTE, (bytes_of(2) - bytes_of(1)).min(0xFFFF) as u16),
    }
}

/// Type code and number for `ty` in an ANY; that of a VARIANT distinguishes texts from bytes.
pub fn code_for(formal: &Parameter, ty: &DataType) -> (u8, u32) {
    match (&formal.ty, ty) {
        (DataType::Parameter(ParameterType::Variant), DataType::String(_) | DataType::WideString(_)) => {
            let (_, bytes) = any_of(ty);
            (layout::type_number(ty) as u8, bytes)
        }
        _ => any_of(ty),
    }
}

/// The actual of `formal`, an ANY or a VARIANT.
pub fn for_formal<A: Pointer>(formal: &Parameter, any: A, pointed: Pointed) -> A {
    match formal.ty {
        DataType::Parameter(ParameterType::Variant) => any.with(pointed),
        _ => any,
    }
}

/// An actual that can become a VARIANT.
pub trait Pointer {
    /// The VARIANT that begins with this ANY.
    fn with(self, pointed: Pointed) -> Self;
}

impl Pointer for Actual {
    fn with(self, pointed: Pointed) -> Actual {
        Actual::Variant(Box::new(self), pointed)
    }
}

impl Pointer for plcc_model::scl::Actual {
    fn with(self, pointed: Pointed) -> Self {
        plcc_model::scl::Actual::Variant(Box::new(self), pointed)
    }
}
