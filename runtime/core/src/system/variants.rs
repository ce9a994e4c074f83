//! Variables of any type as bytes: Serialize, Deserialize, READ_BIG … WRITE_LITTLE, VariantGet, VariantPut, MOVE_BLK_VARIANT.
//!
//! All data has the standard layout, so a variable's image is its bytes in memory. An ANY of a structure, or of an array of such, is
//! one of BYTE: only its size tells whether two of them fit.
//!
//! Source: S7-1200 reference, move operations.

use plcc_abi::layout::area;

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::cpu::Area;

/// The areas overlap, or one of them is no variable.
const AREAS: u16 = 0x80B0;
/// POS is outside the array.
const POSITION: u16 = 0x8382;
/// The array ends before the variable does.
const TOO_SHORT: u16 = 0x8383;
/// MOVE_BLK_VARIANT: types differ; SRC_INDEX or COUNT, DEST_INDEX or COUNT out of the array.
const TYPES_DIFFER: u16 = 0x80B4;
const SOURCE_INDEX: u16 = 0x8154;
const TARGET_INDEX: u16 = 0x8155;
/// Type codes of ANY.
const BOOL: u8 = 0x01;
/// Longest elementary value.
const VALUE_MAX: u32 = 8;

/// Parameter `index`, all of whose bytes exist.
fn whole(call: &Call, index: usize, access: Access) -> Option<Range> {
    any::decode(call, index, access).ok().flatten().filter(|range| range.existing == range.bytes)
}

/// The bytes of the array, parameter `array`, from POS on that the variable, parameter `variable`, takes.
fn part(call: &Call, variable: usize, array: usize, to_array: bool) -> Result<(u32, Range), u16> {
    let (read, write) = (Access::Read, Access::Write);
    let value = whole(call, variable, if to_array { read } else { write }).ok_or(AREAS)?;
    let bytes = whole(call, array, if to_array { write } else { read }).ok_or(AREAS)?;
    let position = u32::try_from(call.dword(3) as i32).ok().filter(|&at| at < bytes.bytes).ok_or(POSITION)?;
    if value.bytes > bytes.bytes - position {
        return Err(TOO_SHORT);
    }
    if value.offset < bytes.offset + bytes.bytes && bytes.offset < value.offset + value.bytes {
        return Err(AREAS);
    }
    Ok((bytes.offset + position, value))
}

/// Copies between a variable and an array of bytes; POS, parameter 3, moves on.
fn transfer(call: &Call, to_array: bool, little: bool) -> Outcome {
    let (variable, array) = if to_array { (0, 2) } else { (2, 0) };
    let (at, value) = match part(call, variable, array, to_array) {
        Ok(found) => found,
        Err(code) => return error(code),
    };
    if little && value.bytes > VALUE_MAX {
        return error(AREAS);
    }
    let (from, to) = if to_array { (value.offset, at) } else { (at, value.offset) };
    let memory = &call.cpu.memory;
    memory.copy(from, to, value.bytes);
    if little {
        for (low, high) in (0..value.bytes / 2).map(|low| (to + low, to + value.bytes - 1 - low)) {
            let (a, b) = (memory.byte(low), memory.byte(high));
            memory.set_byte(low, b);
            memory.set_byte(high, a);
        }
    }
    call.set_dword(3, call.dword(3) + value.bytes);
    OK
}

/// SRC_VARIABLE, POS -> RET_VAL, DEST_ARRAY, POS.
pub(super) fn serialize(call: &Call) -> Outcome {
    transfer(call, true, false)
}

/// SRC_ARRAY, POS -> RET_VAL, DEST_VARIABLE, POS.
pub(super) fn deserialize(call: &Call) -> Outcome {
    transfer(call, false, false)
}

/// As [`serialize`], of one value, the lowest byte first.
pub(super) fn write_little(call: &Call) -> Outcome {
    transfer(call, true, true)
}

/// As [`deserialize`], of one value, the lowest byte first.
pub(super) fn read_little(call: &Call) -> Outcome {
    transfer(call, false, true)
}

/// SRC -> DST: copied if types and number agree.
pub(super) fn get(call: &Call) -> Outcome {
    Outcome::Flag(assign(call).is_some())
}

/// SRC, DST: as [`get`], to where DST points.
pub(super) fn put(call: &Call) -> Outcome {
    get(call)
}

fn assign(call: &Call) -> Option<()> {
    let (from, to) = (call.any_bytes(0), call.any_bytes(1));
    if from[..4] != to[..4] {
        return None;
    }
    let memory = &call.cpu.memory;
    if from[..4] == [0x10, BOOL, 0, 1] {
        let ((from, from_bit), (to, to_bit)) = (bit_place(call, from)?, bit_place(call, to)?);
        memory.set_bit(to, to_bit, memory.bit(from, from_bit));
        return Some(());
    }
    let (from, to) = (whole(call, 0, Access::Read)?, whole(call, 1, Access::Write)?);
    memory.copy(from.offset, to.offset, from.bytes);
    Some(())
}

/// Offset and bit of the BOOL that an ANY names.
fn bit_place(call: &Call, any: [u8; 10]) -> Option<(u32, u8)> {
    let pointer = u32::from_be_bytes([0, any[7], any[8], any[9]]);
    let (byte, bit) = (pointer >> 3 & 0xFFFF, (pointer & 7) as u8);
    let (base, length) = match any[6] {
        area::I => call.cpu.area(Area::Inputs),
        area::Q => call.cpu.area(Area::Outputs),
        area::M => call.cpu.area(Area::BitMemory),
        area::DB | area::DI => call.cpu.memory.db(u16::from_be_bytes([any[4], any[5]])),
        area::V => {
            let stack = call.lbase & !(plcc_abi::layout::L_CLASS_BYTES - 1);
            return Some((stack | (call.lbase + byte) & (plcc_abi::layout::L_CLASS_BYTES - 1), bit));
        }
        _ => return None,
    };
    (byte < length).then_some((base + byte, bit))
}

/// SRC, COUNT, SRC_INDEX, DEST_INDEX -> RET_VAL, DEST: elements counted from 0. 80B4 the types differ, 8154 and 8155 out of SRC and DEST.
pub(super) fn move_block(call: &Call) -> Outcome {
    let (source, target) = (whole(call, 0, Access::Read), whole(call, 5, Access::Write));
    let Some((source, target)) = source.zip(target) else { return error(AREAS) };
    if source.type_code != target.type_code || source.type_code == BOOL {
        return error(TYPES_DIFFER);
    }
    let size = |any: [u8; 10], range: &Range| range.bytes / u32::from(u16::from_be_bytes([any[2], any[3]])).max(1);
    let bytes = size(call.any_bytes(0), &source);
    let offset = |index: u32, range: &Range| {
        let start = u64::try_from(index as i32).ok()?.checked_mul(u64::from(bytes))?;
        let length = u64::from(call.dword(1)).checked_mul(u64::from(bytes))?;
        (start.checked_add(length)? <= u64::from(range.bytes)).then_some((range.offset + start as u32, length as u32))
    };
    let Some((from, length)) = offset(call.dword(2), &source) else { return error(SOURCE_INDEX) };
    let Some((to, _)) = offset(call.dword(3), &target) else { return error(TARGET_INDEX) };
    call.cpu.memory.copy(from, to, length);
    OK
}
