//! ReadFromArrayDB, WriteToArrayDB: elements of data blocks that are arrays. DB_ANY_TO_VARIANT, VARIANT_TO_DB_ANY, TypeOfDB: data blocks as values.
//!
//! Source: TIA Portal help, move operations, array data blocks.

use plcc_abi::any::Fields;
use plcc_abi::image::AssertType;
use plcc_abi::layout::area;
use plcc_abi::names::{Dimension, NamedType, TypeNumber, structure_number};

use super::any::{self, Access};
use super::parameters::Call;
use super::{OK, Outcome, error, variants};

const TYPES_DIFFER: u16 = 0x80B4;
const NO_DB: u16 = 0x8132;
const WRITE_PROTECTED: u16 = 0x8134;
const NO_ARRAY: u16 = 0x8135;
const NO_ELEMENT: u16 = 0x8222;
const NO_VALUE: u16 = 0x8350;
/// Type number of BOOL.
const BOOL: u32 = 0x01;

/// DB, INDEX -> RET_VAL, VALUE.
pub(super) fn read(call: &Call) -> Outcome {
    outcome(transfer(call, 3, Access::Write))
}

/// DB, INDEX, VALUE -> RET_VAL.
pub(super) fn write(call: &Call) -> Outcome {
    outcome(transfer(call, 2, Access::Read))
}

fn outcome(result: Result<(), u16>) -> Outcome {
    match result {
        Ok(()) => OK,
        Err(code) => error(code),
    }
}

/// Copies between element INDEX and VALUE, parameter `value`, which is accessed so.
fn transfer(call: &Call, value: usize, access: Access) -> Result<(), u16> {
    let (number, index) = (call.word(0), call.dword(1) as i32);
    let memory = &call.cpu.memory;
    let (base, length) = memory.db(number);
    if length == 0 {
        return Err(NO_DB);
    }
    let (dimension, element) = array(call, number).ok_or(NO_ARRAY)?;
    if access == Access::Read && call.cpu.is_read_only(number) {
        return Err(WRITE_PROTECTED);
    }
    let (elements, ty) = call.pointed(value);
    let any = call.any(value);
    let ty = if ty == 0 { any.head >> 16 & 0xFF } else { ty };
    if elements != 0 || type_of(call, element).is_some_and(|own| own != ty) {
        return Err(TYPES_DIFFER);
    }
    if index < dimension.low || index > dimension.high {
        return Err(NO_ELEMENT);
    }
    // The array is not longer than a DB, so all of this fits.
    let place = (i64::from(index) - i64::from(dimension.low)) as u32 * dimension.distance;
    if ty == BOOL {
        let (offset, bit) = variants::bit_place(call, any).ok_or(NO_VALUE)?;
        let own = (base + place / 8, (place % 8) as u8);
        let (from, to) = if access == Access::Write { (own, (offset, bit)) } else { ((offset, bit), own) };
        if access == Access::Write {
            call.cpu.note_outputs(u32::MAX);
        }
        memory.set_bit(to.0, to.1, memory.bit(from.0, from.1));
        return Ok(());
    }
    let range = any::decode(call, value, access).ok().flatten().filter(|range| range.existing == range.bytes);
    let range = range.ok_or(NO_VALUE)?;
    // Elements begin at even bytes if they are longer than one.
    let room = dimension.distance / 8;
    if range.bytes != room && range.bytes + 1 != room {
        return Err(TYPES_DIFFER);
    }
    let offset = base + place / 8;
    if place / 8 + range.bytes > length {
        return Err(NO_ELEMENT);
    }
    let (from, to) = if access == Access::Write { (offset, range.offset) } else { (range.offset, offset) };
    memory.copy(from, to, range.bytes);
    Ok(())
}

/// ERR of a number that is 0.
const NO_NUMBER: u16 = 0x8130;
/// ERR of a data block that does not exist.
const MISSING: u16 = 0x8131;
/// ERR of a VARIANT that points to nothing.
const NOTHING: u16 = 0x252C;
/// Marks the number of the type of an array, as opposed to that of its elements.
const ARRAY: u32 = 1 << 30;

/// Number of elements of the array that a DB is, else 0, and the number of the type; 0: it has none.
fn shape(call: &Call, number: u16) -> (u32, u32) {
    if let Some((dimension, element)) = array(call, number) {
        let elements = (i64::from(dimension.high) - i64::from(dimension.low) + 1) as u32;
        return (elements, type_of(call, element).unwrap_or(0));
    }
    let image = &call.cpu.image;
    let db = image.dbs.iter().find(|db| db.number == number);
    (0, db.and_then(|db| db.ty).and_then(|ty| type_of(call, ty)).unwrap_or(0))
}

/// DB -> RET_VAL (a VARIANT of all of it), ERR.
pub(super) fn to_variant(call: &Call) -> Outcome {
    const ERR: usize = 2;
    const BYTES: u32 = 0x1002_0000;
    let number = call.word(0);
    let length = call.cpu.memory.db(number).1;
    let none = Fields { head: 0x1000_0000, db: 0, pointer: 0 };
    let code = match (number, length) {
        (0, _) => NO_NUMBER,
        (_, 0) => MISSING,
        _ => 0,
    };
    if code == 0 {
        let (elements, ty) = shape(call, number);
        let fields = Fields { head: BYTES | length.min(0xFFFF), db: number, pointer: u32::from(area::DB) << 24 };
        call.set_variant(1, fields, elements, ty);
    } else {
        call.set_variant(1, none, 0, 0);
    }
    call.set_word(ERR, code);
    Outcome::Flag(code == 0)
}

/// IN -> RET_VAL (number of the DB that it points to, 0 for none), ERR.
pub(super) fn of_variant(call: &Call) -> Outcome {
    let any = call.any(0);
    let in_db = matches!((any.pointer >> 24) as u8, area::DB | area::DI) && any.pointer & 0x00FF_FFFF == 0;
    let nothing = any.head >> 16 & 0xFF == 0;
    let code = match () {
        () if nothing => NOTHING,
        () if !in_db || call.cpu.memory.db(any.db).1 == 0 => MISSING,
        () => 0,
    };
    call.set_word(1, if code == 0 { any.db } else { 0 });
    call.set_word(2, code);
    Outcome::Flag(code == 0)
}

/// DB -> RET_VAL: number of its type, as TypeOf has it; 0: it has none, or does not exist.
pub(super) fn type_of_db(call: &Call) -> Outcome {
    let (elements, ty) = shape(call, call.word(0));
    call.set_dword(1, if elements > 0 { ty ^ ARRAY } else { ty });
    Outcome::Plain
}

/// The array that a DB is: its only dimension, and the type of its elements.
fn array<'a>(call: &Call<'a>, number: u16) -> Option<(&'a Dimension, TypeNumber)> {
    let image = &call.cpu.image;
    let db = image.dbs.iter().find(|db| db.number == number)?;
    let ty = match image.types.get(db.ty? as usize)? {
        NamedType::Struct(structure) => match &structure.members[..] {
            [only] if only.byte == 0 => image.types.get(only.ty as usize)?,
            _ => return None,
        },
        other => other,
    };
    match ty {
        NamedType::Array { dimensions, element } => match &dimensions[..] {
            [dimension] => Some((dimension, *element)),
            _ => None,
        },
        _ => None,
    }
}

/// The number that a VARIANT has for a type; `None`: it cannot be told.
fn type_of(call: &Call, ty: TypeNumber) -> Option<u32> {
    match call.cpu.image.types.get(ty as usize)? {
        NamedType::Value(value) => Some(match value {
            AssertType::Bool => BOOL,
            AssertType::Bits(8) => 0x02,
            AssertType::Bits(16) => 0x04,
            AssertType::Bits(32) => 0x06,
            AssertType::Bits(_) => 0x2D,
            AssertType::Signed(8) => 0x30,
            AssertType::Signed(16) => 0x05,
            AssertType::Signed(32) => 0x07,
            AssertType::Signed(_) => 0x35,
            AssertType::Unsigned(8) => 0x31,
            AssertType::Unsigned(16) => 0x32,
            AssertType::Unsigned(32) => 0x33,
            AssertType::Unsigned(_) => 0x36,
            AssertType::Real => 0x08,
            AssertType::Lreal => 0x34,
            AssertType::Char => 0x03,
            AssertType::Wchar => 0x2C,
            AssertType::S5Time => 0x0C,
            AssertType::Time => 0x0B,
            AssertType::Ltime => 0x37,
            AssertType::Date => 0x09,
            AssertType::TimeOfDay => 0x0A,
            AssertType::Ltod => 0x38,
            AssertType::Ldt => 0x39,
            AssertType::DateAndTime => 0x0E,
            AssertType::Dtl => structure_number("DTL"),
            AssertType::Text => 0x13,
            AssertType::WideText => 0x14,
        }),
        NamedType::Text { wide, .. } => Some(if *wide { 0x14 } else { 0x13 }),
        NamedType::Struct(structure) if !structure.name.is_empty() => Some(structure_number(&structure.name)),
        NamedType::Struct(structure) if !structure.data_type.is_empty() => Some(structure_number(&structure.data_type)),
        NamedType::Struct(_) | NamedType::Array { .. } | NamedType::Other { .. } => None,
    }
}
