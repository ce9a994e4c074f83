//! ANY parameters: from ten bytes to a range of memory, with the checks of the CPU.

pub(super) use plcc_abi::any::{Access, STRING, WIDE_CHARACTER, WIDE_STRING, error as code};
use plcc_abi::any::{Any, Fields};
use plcc_abi::layout::{self, area, state};

use super::parameters::Call;
use crate::cpu::Area;

/// Syntax id and type code of bytes.
const BYTES_HEAD: u32 = 0x1002;

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

/// Decodes parameter `index`. A range that exists only in part is not an error here: the callers report different errors.
/// `Err`: RET_VAL. `Ok(None)`: a NIL pointer or a length of 0.
pub(super) fn decode(call: &Call, index: usize, access: Access) -> Result<Option<Range>, u16> {
    let Some(any) = plcc_abi::any::decode(call.any(index), index, access)? else { return Ok(None) };
    let Any { type_code, bytes, byte, .. } = any;
    let memory = &call.cpu.memory;
    let (base, length) = match any.area {
        area::I => call.cpu.area(Area::Inputs),
        area::Q => {
            if access == Access::Write {
                call.cpu.note_outputs(byte.saturating_add(bytes));
            }
            call.cpu.area(Area::Outputs)
        }
        area::M => call.cpu.area(Area::BitMemory),
        area::DB | area::DI => {
            let (address, length) = memory.db(any.db);
            let read_only = access == Access::Write && call.cpu.is_read_only(any.db);
            if let Some(error) = plcc_abi::any::db_error(index, access, length, read_only) {
                return Err(error);
            }
            (address, length)
        }
        area::L => (call.lbase, memory.host32(state::L_END).saturating_sub(call.lbase)),
        area::V => {
            let (offset, existing) = local_bytes(call, byte, bytes);
            return Ok(Some(Range { offset, bytes, existing, type_code }));
        }
        _ => return Err(plcc_abi::any::area_error(index, access)),
    };
    let length = length.min(layout::AREA_BYTES);
    let existing = length.saturating_sub(byte).min(bytes);
    Ok(Some(Range { offset: base + byte.min(length), bytes, existing, type_code }))
}

/// As [`decode`] for what the library passes most, bytes of a DB or of local data: their offset from the memory base, and how many
/// exist. `None`: only [`decode`] knows.
#[inline]
pub(super) fn decode_bytes(call: &Call, index: usize, access: Access) -> Option<(u32, u32)> {
    let Fields { head, db, pointer } = call.any(index);
    let bytes = head & 0xFFFF;
    if head >> 16 != BYTES_HEAD || pointer & 7 != 0 || bytes == 0 {
        return None;
    }
    let byte = pointer >> 3 & 0xFFFF;
    match (pointer >> 24) as u8 {
        area::DB if access == Access::Read || !call.cpu.is_read_only(db) => {
            let (address, length) = call.cpu.memory.db(db);
            let existing = length.min(layout::AREA_BYTES).checked_sub(byte)?;
            Some((address + byte, existing.min(bytes)))
        }
        area::V => Some(local_bytes(call, byte, bytes)),
        _ => None,
    }
}

/// Area V for a caller that passes on pointers of its own callers. Below its frame are its own parameters: addresses wrap inside the
/// L stack. Offset from the memory base, and how many of `bytes` exist.
#[inline]
fn local_bytes(call: &Call, byte: u32, bytes: u32) -> (u32, u32) {
    let stack = call.lbase & !(layout::L_CLASS_BYTES - 1);
    let start = stack | (call.lbase + byte) & (layout::L_CLASS_BYTES - 1);
    (start, call.cpu.memory.host32(state::L_END).saturating_sub(start).min(bytes))
}
