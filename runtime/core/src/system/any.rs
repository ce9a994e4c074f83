//! ANY parameters: from ten bytes to a range of memory, with the checks of the CPU.
//!
//! Source: Programming with STEP 7, format of ANY.

use plcc_abi::layout::{self, area, state};

use super::parameters::Call;
use crate::cpu::{Area, Cpu};

/// Direction of an access, which decides the error code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Access {
    Read,
    Write,
}

/// A range of memory that an ANY points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Range {
    /// Offset from the memory base.
    pub offset: u32,
    /// Length as the pointer says, in bytes.
    pub bytes: u32,
    /// Bytes that really exist there, up to `bytes`.
    pub existing: u32,
    /// Type code.
    pub type_code: u8,
}

/// Type code of STRING.
pub(super) const STRING: u8 = 0x13;

/// Type code of WSTRING, in a VARIANT.
pub(super) const WIDE_STRING: u8 = 0x14;

/// Type code of WCHAR, in a VARIANT.
pub(super) const WIDE_CHARACTER: u8 = 0x2C;

/// Bytes of an element by type code; 0 for BOOL, `None` if it is not data.
fn element_bytes(code: u8) -> Option<u32> {
    Some(match code {
        0x01 => 0,
        0x02 | 0x03 | 0x30 | 0x31 => 1,
        0x04 | 0x05 | 0x09 | 0x0C | WIDE_CHARACTER | 0x32 => 2,
        0x06..=0x08 | 0x0A | 0x0B | 0x33 => 4,
        0x0E | 0x2D | 0x34..=0x39 => 8,
        // Their number is that of bytes.
        STRING | WIDE_STRING => 1,
        _ => return None,
    })
}

/// The error code of parameter `index` (from 0), with the general part `yy`: 16#8xyy.
pub(super) fn code(index: usize, yy: u16) -> u16 {
    0x8000 | (index as u16 + 1) << 8 | yy
}

/// The DB is write-protected.
fn is_read_only(cpu: &Cpu, number: u16) -> bool {
    cpu.image.dbs.iter().any(|db| db.number == number && db.read_only)
}

/// Decodes parameter `index`. A range that exists only in part is not an error here: the callers report different errors.
/// `Err`: RET_VAL. `Ok(None)`: a NIL pointer or a length of 0.
pub(super) fn decode(call: &Call, index: usize, access: Access) -> Result<Option<Range>, u16> {
    let bytes = call.any_bytes(index);
    let [syntax, type_code, count_high, count_low, db_high, db_low, area_code, a, b, c] = bytes;
    let by_access = |read: u16, write: u16| code(index, if access == Access::Read { read } else { write });
    if syntax != 0x10 {
        return Err(code(index, 0x01));
    }
    let count = u32::from(u16::from_be_bytes([count_high, count_low]));
    if type_code == 0 || count == 0 {
        return Ok(None);
    }
    let pointer = u32::from_be_bytes([0, a, b, c]);
    let (byte, bit) = (pointer >> 3 & 0xFFFF, pointer & 7);
    let element = element_bytes(type_code).ok_or(by_access(0x24, 0x25))?;
    let bytes = if element == 0 {
        if count % 8 != 0 {
            return Err(by_access(0x22, 0x23));
        }
        count / 8
    } else {
        count * element
    };
    if bit != 0 {
        return Err(by_access(0x28, 0x29));
    }
    let memory = &call.cpu.memory;
    let (base, length) = match area_code {
        area::I => call.cpu.area(Area::Inputs),
        area::Q => call.cpu.area(Area::Outputs),
        area::M => call.cpu.area(Area::BitMemory),
        area::DB | area::DI => {
            let number = u16::from_be_bytes([db_high, db_low]);
            let (address, length) = memory.db(number);
            if length == 0 {
                return Err(code(index, 0x3A));
            }
            if access == Access::Write && is_read_only(call.cpu, number) {
                return Err(code(index, 0x30));
            }
            (address, length)
        }
        area::L => (call.lbase, memory.host32(state::L_END).saturating_sub(call.lbase)),
        area::V => {
            // Below the caller's frame are the caller's own parameters: addresses wrap inside the L stack.
            let stack = call.lbase & !(layout::L_CLASS_BYTES - 1);
            let start = stack | (call.lbase + byte) & (layout::L_CLASS_BYTES - 1);
            let existing = memory.host32(state::L_END).saturating_sub(start).min(bytes);
            return Ok(Some(Range { offset: start, bytes, existing, type_code }));
        }
        _ => return Err(by_access(0x24, 0x25)),
    };
    let length = length.min(layout::AREA_BYTES);
    let existing = length.saturating_sub(byte).min(bytes);
    Ok(Some(Range { offset: base + byte.min(length), bytes, existing, type_code }))
}
