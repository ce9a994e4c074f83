//! ANY pointers as system functions read them: what is wrong with one by itself, and what it points at.
//!
//! The compiler decides by the same rules as the runtime, where it knows a pointer.
//! Source: Programming with STEP 7, format of ANY; System and standard functions, errors of block parameters.

use crate::image::Family;

/// Direction of an access, which decides the error code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    Read,
    Write,
}

/// What an ANY points at; whether it exists is not checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Any {
    /// Type code.
    pub type_code: u8,
    /// Length in bytes.
    pub bytes: u32,
    /// Number of the DB, for the areas of DBs.
    pub db: u16,
    /// Area code, one of [`area`](crate::layout::area) if the pointer is right.
    pub area: u8,
    /// Offset in the area.
    pub byte: u32,
}

/// Type code of BYTE.
const BYTE: u8 = 0x02;

/// Type code of STRING.
pub const STRING: u8 = 0x13;

/// Type code of WSTRING, in a VARIANT.
pub const WIDE_STRING: u8 = 0x14;

/// Type code of WCHAR, in a VARIANT.
pub const WIDE_CHARACTER: u8 = 0x2C;

/// Type codes of ANY pointers that hold the number of a block, a counter or a timer in the place of an address.
pub const BLOCK_FB: u8 = 0x17;
pub const BLOCK_FC: u8 = 0x18;
pub const BLOCK_DB: u8 = 0x19;
pub const COUNTER: u8 = 0x1C;
pub const TIMER: u8 = 0x1D;

/// General part of an error code: the source or the destination is shorter than its pointer says.
const SHORT_READ: u16 = 0x22;
const SHORT_WRITE: u16 = 0x23;
/// The area or the type does not exist.
const AREA_READ: u16 = 0x24;
const AREA_WRITE: u16 = 0x25;
/// The address is not that of a byte.
const ALIGN_READ: u16 = 0x28;
const ALIGN_WRITE: u16 = 0x29;
/// The DB is write-protected.
const PROTECTED: u16 = 0x30;
/// The DB is not loaded.
const DB_MISSING: u16 = 0x3A;

/// RET_VAL of block moves on an S7-300 where an area is shorter than its pointer says.
const SHORT_300: u16 = 0x837F;

/// RET_VAL of an error of parameter `index` (from 0), with the general part `yy`: 16#8xyy.
#[inline]
pub const fn error(index: usize, yy: u16) -> u16 {
    0x8000 | (index as u16 + 1) << 8 | yy
}

/// Bytes of an element by type code; 0 for BOOL, `None` if it is not data.
#[inline]
const fn element_bytes(code: u8) -> Option<u32> {
    // The library counts all in bytes.
    if code == BYTE {
        return Some(1);
    }
    Some(match code {
        0x01 => 0,
        BYTE | 0x03 | 0x30 | 0x31 => 1,
        0x04 | 0x05 | 0x09 | 0x0C | WIDE_CHARACTER | 0x32 => 2,
        0x06..=0x08 | 0x0A | 0x0B | 0x33 => 4,
        0x0E | 0x2D | 0x34..=0x39 => 8,
        // Their number is that of bytes.
        STRING | WIDE_STRING => 1,
        _ => return None,
    })
}

#[inline]
const fn by_access(index: usize, access: Access, read: u16, write: u16) -> u16 {
    error(index, if matches!(access, Access::Read) { read } else { write })
}

/// The fields of an ANY, as they are in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fields {
    /// Syntax id, type code, number of elements.
    pub head: u32,
    /// Number of the DB, or 0.
    pub db: u16,
    /// Area-crossing pointer.
    pub pointer: u32,
}

/// Reads parameter `index`. `Err`: RET_VAL. `Ok(None)`: a NIL pointer or a length of 0.
#[inline]
pub const fn decode(fields: Fields, index: usize, access: Access) -> Result<Option<Any>, u16> {
    let Fields { head, db, pointer } = fields;
    if head >> 24 != 0x10 {
        return Err(error(index, 0x01));
    }
    let (type_code, count) = ((head >> 16) as u8, head & 0xFFFF);
    if type_code == 0 || count == 0 {
        return Ok(None);
    }
    let (byte, bit) = (pointer >> 3 & 0xFFFF, pointer & 7);
    let Some(element) = element_bytes(type_code) else { return Err(area_error(index, access)) };
    let bytes = if element == 0 {
        if count % 8 != 0 {
            return Err(by_access(index, access, SHORT_READ, SHORT_WRITE));
        }
        count / 8
    } else {
        count * element
    };
    if bit != 0 {
        return Err(by_access(index, access, ALIGN_READ, ALIGN_WRITE));
    }
    Ok(Some(Any { type_code, bytes, db, area: (pointer >> 24) as u8, byte }))
}

/// RET_VAL of parameter `index` for an area that does not exist.
#[inline]
pub const fn area_error(index: usize, access: Access) -> u16 {
    by_access(index, access, AREA_READ, AREA_WRITE)
}

/// RET_VAL of parameter `index` for a DB with `length` bytes; `None` if it can be used.
#[inline]
pub const fn db_error(index: usize, access: Access, length: u32, read_only: bool) -> Option<u16> {
    match access {
        _ if length == 0 => Some(error(index, DB_MISSING)),
        Access::Write if read_only => Some(error(index, PROTECTED)),
        Access::Read | Access::Write => None,
    }
}

/// RET_VAL of a block move whose source or destination is shorter than its pointer says.
pub const fn short_error(family: Family, short_source: bool, short_destination: bool) -> Option<u16> {
    match (family, short_source, short_destination) {
        (_, false, false) => None,
        (Family::S7300, _, _) => Some(SHORT_300),
        (_, true, _) => Some(error(block_move::SOURCE, SHORT_READ)),
        (_, false, true) => Some(error(block_move::DESTINATION, SHORT_WRITE)),
    }
}

/// SFC 20 BLKMOV, SFC 21 FILL, SFC 81 UBLKMOV.
pub mod block_move {
    use super::{SHORT_READ, error};

    pub const BLKMOV: u16 = 20;
    pub const FILL: u16 = 21;
    pub const UBLKMOV: u16 = 81;

    /// Their parameters by place.
    pub const SOURCE: usize = 0;
    pub const RET_VAL: usize = 1;
    pub const DESTINATION: usize = 2;

    /// Longest block that UBLKMOV copies.
    pub const UNINTERRUPTED_MAX: u32 = 512;
    /// RET_VAL of UBLKMOV for a longer one.
    pub const TOO_LONG: u16 = error(SOURCE, SHORT_READ);
}
