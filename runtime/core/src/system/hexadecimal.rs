//! ATH and HTA: hexadecimal characters and bytes.
//!
//! Each side is a text, with its characters and length, or a row of characters or bytes. Codes are those of the table: 81yy of
//! IN, 83yy of OUT.
//!
//! Source: S7-1200 reference, string conversion, ATH and HTA.

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error};

/// RET_VAL: a character is not a hexadecimal digit. ENO is 0, though it is not an error code.
const NO_DIGIT: u16 = 0x0007;
/// Codes of IN; those of OUT are higher by [`OF_OUTPUT`].
const NO_ACCESS: u16 = 0x8101;
const NO_TEXT: u16 = 0x8120;
const TOO_SHORT: u16 = 0x8182;
const OF_OUTPUT: u16 = 0x0200;

const IN: usize = 0;
const OUT: usize = 3;

/// Characters or bytes in memory.
struct Row {
    /// Of the first one.
    offset: u32,
    /// Bytes of each character.
    width: u32,
    /// Characters that there are, or for which there is room.
    count: u32,
    /// Where a text keeps its length.
    length: Option<u32>,
}

impl Row {
    /// The variable that parameter `index` points to; to read it, a text ends with its actual length, and to write it with its longest.
    fn of(call: &Call, index: usize, access: Access) -> Result<Row, u16> {
        let codes = if access == Access::Read { 0 } else { OF_OUTPUT };
        let range = any::decode(call, index, access).ok().flatten().ok_or(NO_ACCESS + codes)?;
        match range.type_code {
            any::STRING => Row::text(call, &range, access, 1).ok_or(NO_TEXT + codes),
            any::WIDE_STRING => Row::text(call, &range, access, 2).ok_or(NO_TEXT + codes),
            _ if range.existing < range.bytes => Err(NO_ACCESS + codes),
            code => {
                let width = if code == any::WIDE_CHARACTER { 2 } else { 1 };
                Ok(Row { offset: range.offset, width, count: range.bytes / width, length: None })
            }
        }
    }

    /// A STRING or WSTRING, whose characters and lengths have `width` bytes; `None` if it is not valid.
    fn text(call: &Call, range: &Range, access: Access, width: u32) -> Option<Row> {
        let memory = &call.cpu.memory;
        let number = |at: u32| if width == 1 { u32::from(memory.byte(at)) } else { u32::from(memory.word(at)) };
        let room = range.existing.checked_sub(2 * width)? / width;
        let (maximum, actual) = (number(range.offset), number(range.offset + width));
        let valid = maximum > 0 && (width == 2 || maximum < 255) && actual <= maximum.min(room);
        let count = if access == Access::Read { actual } else { maximum.min(room) };
        valid.then_some(Row { offset: range.offset + 2 * width, width, count, length: Some(range.offset + width) })
    }

    fn character(&self, call: &Call, index: u32) -> u32 {
        let at = self.offset + self.width * index;
        if self.width == 1 { u32::from(call.cpu.memory.byte(at)) } else { u32::from(call.cpu.memory.word(at)) }
    }

    /// Writes characters that have room, and the length of a text.
    fn write(&self, call: &Call, characters: &[u8]) {
        let memory = &call.cpu.memory;
        for (at, &character) in (self.offset..).step_by(self.width as usize).zip(characters) {
            if self.width == 1 { memory.set_byte(at, character) } else { memory.set_word(at, character.into()) }
        }
        match self.length {
            Some(at) if self.width == 1 => memory.set_byte(at, characters.len() as u8),
            Some(at) => memory.set_word(at, characters.len() as u16),
            None => {}
        }
    }
}

/// IN and OUT, and N, which IN must hold. `units`: how many characters of OUT come from N of IN.
fn sides(call: &Call, units: impl Fn(u32) -> u32) -> Result<(Row, u32, Row), u16> {
    let from = Row::of(call, IN, Access::Read)?;
    let to = Row::of(call, OUT, Access::Write)?;
    let count = u32::try_from(call.word(1) as i16).ok().filter(|&count| count <= from.count).ok_or(TOO_SHORT)?;
    if units(count) > to.count {
        return Err(TOO_SHORT + OF_OUTPUT);
    }
    Ok((from, count, to))
}

/// IN, N -> RET_VAL, OUT: N characters to digits of four bits, the first leftmost; an odd last one is filled with 0.
pub(super) fn from_text(call: &Call) -> Outcome {
    let (from, count, to) = match sides(call, |count| count.div_ceil(2)) {
        Ok(sides) => sides,
        Err(code) => return error(code),
    };
    let mut good = true;
    let mut digit = |at: u32| {
        let letter = if at < count { char::from_u32(from.character(call, at)) } else { Some('0') };
        let digit = letter.and_then(|letter| letter.to_digit(16));
        good &= digit.is_some();
        digit.unwrap_or(0) as u8
    };
    let bytes: Vec<u8> = (0..count.div_ceil(2)).map(|at| digit(2 * at) << 4 | digit(2 * at + 1)).collect();
    to.write(call, &bytes);
    call.set_word(2, if good { 0 } else { NO_DIGIT });
    Outcome::Flag(good)
}

/// IN, N -> RET_VAL, OUT: N bytes to two upper-case characters each.
pub(super) fn to_text(call: &Call) -> Outcome {
    // Each character of a WSTRING is one byte: codes up to 255.
    let (from, count, to) = match sides(call, |count| 2 * count) {
        Ok(sides) => sides,
        Err(code) => return error(code),
    };
    let text: String = (0..count).map(|at| format!("{:02X}", from.character(call, at) & 0xFF)).collect();
    to.write(call, text.as_bytes());
    OK
}
