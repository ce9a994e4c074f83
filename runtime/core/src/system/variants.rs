//! Variables of any type as bytes: Serialize, Deserialize, READ_BIG … WRITE_LITTLE, VariantGet, VariantPut, MOVE_BLK_VARIANT.
//!
//! All data has the standard layout, so a variable's image is its bytes in memory. The ANY with which a VARIANT begins says BYTE of a
//! structure, and of an array of structures: number and type of elements come after it.
//!
//! Source: S7-1200 reference, move operations.

use plcc_abi::any::Fields;
use plcc_abi::layout::area;

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error, text};
use crate::cpu::Area;

/// The areas overlap, or one of them is not a variable.
const AREAS: u16 = 0x80B0;
/// POS is outside the array.
const POSITION: u16 = 0x8382;
/// The array ends before the variable does.
const TOO_SHORT: u16 = 0x8383;
/// MOVE_BLK_VARIANT.
const TYPES_DIFFER: u16 = 0x80B4;
const COUNT: u16 = 0x8281;
/// Codes of SRC, and the difference to those of DEST.
const NO_ACCESS: u16 = 0x8151;
const OF_BOOL: u16 = 0x8154;
const OF_TARGET: u16 = 0x0400;
const FIRST_ELEMENT: u16 = 0x8382;
const LAST_ELEMENT: u16 = 0x8383;
const OF_TARGET_INDEX: u16 = 0x0100;
const WRITE_PROTECTED: u16 = 0x8534;
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
    let (from, to) = (call.any(0), call.any(1));
    let text = u32::from(any::STRING);
    let (source, target) = (call.pointed(0), call.pointed(1));
    if source == (0, text) && target == (0, text) {
        let characters = text::characters(call, 0)?;
        let target = text::of(call, 1, Access::Write)?;
        return target.write(call.cpu.memory.bytes_at(), characters.characters()).then_some(());
    }
    let known = source.1 != 0 && target.1 != 0;
    if from.head != to.head || (known && source != target) {
        return None;
    }
    let memory = &call.cpu.memory;
    if from.head == u32::from_be_bytes([0x10, BOOL, 0, 1]) {
        let ((from, from_bit), (to, to_bit)) = (bit_place(call, from)?, bit_place(call, to)?);
        if (call.any(1).pointer >> 24) as u8 == area::Q {
            call.cpu.note_outputs(u32::MAX);
        }
        memory.set_bit(to, to_bit, memory.bit(from, from_bit));
        return Some(());
    }
    let (from, to) = (whole(call, 0, Access::Read)?, whole(call, 1, Access::Write)?);
    memory.copy(from.offset, to.offset, from.bytes);
    Some(())
}

/// Offset and bit of the BOOL that an ANY names.
pub(super) fn bit_place(call: &Call, any: Fields) -> Option<(u32, u8)> {
    let (byte, bit) = (any.pointer >> 3 & 0xFFFF, (any.pointer & 7) as u8);
    let (base, length) = match (any.pointer >> 24) as u8 {
        area::I => call.cpu.area(Area::Inputs),
        area::Q => call.cpu.area(Area::Outputs),
        area::M => call.cpu.area(Area::BitMemory),
        area::DB | area::DI => call.cpu.memory.db(any.db),
        area::V => {
            let stack = call.lbase & !(plcc_abi::layout::L_CLASS_BYTES - 1);
            return Some((stack | (call.lbase + byte) & (plcc_abi::layout::L_CLASS_BYTES - 1), bit));
        }
        _ => return None,
    };
    (byte < length).then_some((base + byte, bit))
}

/// DATA, KIND, ELEMENTS, BYTES -> RET_VAL: number of the DB, bit and byte in it; all 0 if DATA is not in a DB, or has another type.
pub(super) fn reference(call: &Call) -> Outcome {
    call.set_date_and_time(4, [0; 8]);
    let (any, (elements, ty)) = (call.any(0), call.pointed(0));
    let (wanted, count, bytes) = (call.dword(1), call.dword(2), call.dword(3));
    let in_db = matches!((any.pointer >> 24) as u8, area::DB | area::DI) && call.cpu.memory.db(any.db).1 > 0;
    let fits = wanted == 0 || (wanted, count) == (ty, elements) && (bytes == 0 || bytes == any.head & 0xFFFF);
    if in_db && ty != 0 && fits {
        let (db, bit) = (any.db.to_be_bytes(), (any.pointer & 7) as u8);
        let byte = (any.pointer >> 3 & 0xFFFF).to_be_bytes();
        let [b0, b1, b2, b3] = byte;
        call.set_date_and_time(4, [db[0], db[1], 0, bit, b0, b1, b2, b3]);
    }
    Outcome::Plain
}

/// Elements that a VARIANT points at.
struct Elements {
    offset: u32,
    count: u32,
    /// Of each.
    bytes: u32,
    ty: u32,
}

impl Elements {
    /// The variable that parameter `index` points to; one element if it is not an array. `Err`: whether it is write-protected.
    fn of(call: &Call, index: usize, access: Access) -> Result<Elements, bool> {
        let protected = any::code(index, 0x30);
        let range = match any::decode(call, index, access) {
            Ok(Some(range)) if range.existing == range.bytes => range,
            Err(code) if code == protected => return Err(true),
            Ok(_) | Err(_) => return Err(false),
        };
        let any = call.any(index);
        let (count, ty) = match call.pointed(index) {
            (_, 0) => (any.head & 0xFFFF, u32::from(range.type_code)),
            (elements, ty) => (elements.max(1), ty),
        };
        // A text takes an even number of bytes in an array.
        let bytes = (range.bytes / count.max(1)).max(1);
        let bytes = if ty == u32::from(any::STRING) { bytes.next_multiple_of(2) } else { bytes };
        Ok(Elements { offset: range.offset, count, bytes, ty })
    }

    /// Offset of the first of `count` elements from `index` on; `Err`: whether the first one is there.
    fn part(&self, index: i32, count: u32) -> Result<u32, bool> {
        let index = u32::try_from(index).ok().filter(|&index| index < self.count).ok_or(false)?;
        if count > self.count - index {
            return Err(true);
        }
        Ok(self.offset + index * self.bytes)
    }
}

/// SRC, COUNT, SRC_INDEX, DEST_INDEX -> RET_VAL, DEST: elements counted from 0.
pub(super) fn move_block(call: &Call) -> Outcome {
    match moved_block(call) {
        Ok(()) => OK,
        Err(code) => error(code),
    }
}

fn moved_block(call: &Call) -> Result<(), u16> {
    let bits = |index: usize| (call.any(index).head >> 16) as u8 == BOOL;
    if bits(0) {
        return Err(OF_BOOL);
    }
    if bits(5) {
        return Err(OF_BOOL + OF_TARGET);
    }
    let source = Elements::of(call, 0, Access::Read).map_err(|_| NO_ACCESS)?;
    let target = Elements::of(call, 5, Access::Write);
    let target = target.map_err(|protected| if protected { WRITE_PROTECTED } else { NO_ACCESS + OF_TARGET })?;
    if source.ty != target.ty || source.bytes != target.bytes {
        return Err(TYPES_DIFFER);
    }
    let count = call.dword(1);
    if count == 0 {
        return Err(COUNT);
    }
    let outside = |first_is_there: bool| if first_is_there { LAST_ELEMENT } else { FIRST_ELEMENT };
    let from = source.part(call.dword(2) as i32, count).map_err(outside)?;
    let to = target.part(call.dword(3) as i32, count);
    let to = to.map_err(|first_is_there| outside(first_is_there) + OF_TARGET_INDEX)?;
    call.cpu.memory.copy(from, to, count * source.bytes);
    Ok(())
}
