//! STRING values after ANY parameters, and the functions of the library that work on their characters.
//!
//! A STRING begins with its maximum and its actual length. It is not valid if the maximum is 0 or 255 or less than the
//! actual length: this includes TEMP variables that were never written.
//! Source: STL reference, composite encodings; string functions FC 2 to FC 32.
//!
//! RET_VAL of these functions: 0, [`CUT`] or [`INVALID`].

use super::any::{self, Access};
use super::parameters::Call;
use super::{OK, Outcome, error};

/// The result was longer than its STRING can hold.
pub(super) const CUT: u16 = 0x8001;
/// A STRING is not valid, or a text does not have the required form.
pub(super) const INVALID: u16 = 0x8002;

/// Characters of the longest STRING.
pub(super) const LONGEST: usize = 254;

/// The position of a valid STRING.
#[derive(Clone, Copy)]
pub(super) struct Text {
    offset: u32,
    pub maximum: u32,
    pub length: u32,
}

impl Text {
    /// The STRING of parameter `index`; `None` if there is none, or it is not valid.
    pub fn of(call: &Call, index: usize, access: Access) -> Option<Text> {
        let range = any::decode(call, index, access).ok()??;
        if range.existing < 2 {
            return None;
        }
        let maximum = u32::from(call.cpu.memory.byte(range.offset));
        let length = u32::from(call.cpu.memory.byte(range.offset + 1));
        // The data block may end before the STRING that its header describes.
        let room = maximum.min(range.existing - 2);
        (maximum != 0 && maximum != 255 && length <= room).then_some(Text {
            offset: range.offset,
            maximum: room,
            length,
        })
    }

    /// Character `index`, from 0.
    fn character(&self, call: &Call, index: u32) -> u8 {
        call.cpu.memory.byte(self.offset + 2 + index)
    }

    fn set_length(&self, call: &Call, length: u32) {
        call.cpu.memory.set_byte(self.offset + 1, length as u8);
    }

    /// Writes the characters that have room; false if some have none.
    pub fn write(&self, call: &Call, characters: &[u8]) -> bool {
        let count = (characters.len() as u32).min(self.maximum);
        for (index, &character) in characters.iter().take(count as usize).enumerate() {
            call.cpu.memory.set_byte(self.offset + 2 + index as u32, character);
        }
        self.set_length(call, count);
        count as usize == characters.len()
    }
}

/// Characters outside PLC memory, so that a function may write into the STRING that it reads.
pub(super) struct Buffer<const N: usize> {
    characters: [u8; N],
    length: usize,
}

impl<const N: usize> Buffer<N> {
    pub fn new() -> Buffer<N> {
        Buffer { characters: [0; N], length: 0 }
    }

    /// Adds a character; a character beyond the capacity is dropped.
    pub fn push(&mut self, character: u8) {
        if self.length < N {
            self.characters[self.length] = character;
            self.length += 1;
        }
    }

    /// Adds `count` characters of a STRING from position `position` (1-based), as far as they are there.
    fn push_part(&mut self, call: &Call, text: Text, position: i16, count: i16) {
        let first = u32::from(position.max(1) as u16) - 1;
        let count = u32::from(count.max(0) as u16);
        for index in first..(first + count).min(text.length) {
            self.push(text.character(call, index));
        }
    }

    pub fn characters(&self) -> &[u8] {
        &self.characters[..self.length]
    }

    /// The characters as a text; none if one is not of ASCII.
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(self.characters()).unwrap_or("")
    }
}

impl<const N: usize> std::fmt::Write for Buffer<N> {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        text.bytes().for_each(|character| self.push(character));
        Ok(())
    }
}

/// All characters of parameter `index`.
pub(super) fn characters(call: &Call, index: usize) -> Option<Buffer<LONGEST>> {
    let text = Text::of(call, index, Access::Read)?;
    let mut buffer = Buffer::new();
    buffer.push_part(call, text, 1, i16::MAX);
    Some(buffer)
}

/// Writes a result into parameter `index`, as far as it fits.
pub(super) fn give(call: &Call, index: usize, characters: &[u8]) -> Outcome {
    match Text::of(call, index, Access::Write) {
        Some(text) if text.write(call, characters) => OK,
        Some(_) => error(CUT),
        None => error(INVALID),
    }
}

/// Writes a result into parameter `index` if all of it fits.
pub(super) fn give_whole(call: &Call, index: usize, characters: &[u8]) -> Outcome {
    match Text::of(call, index, Access::Write) {
        Some(text) if characters.len() as u32 <= text.maximum => {
            text.write(call, characters);
            OK
        }
        Some(_) => error(CUT),
        None => error(INVALID),
    }
}

/// IN1, P1, L1, IN2, P2, L2, IN3, P3, L3 -> RET_VAL, OUT: three parts of texts, one after the other. A part has L characters from
/// position P; missing characters are left out. An invalid position makes the result empty.
pub(super) fn join(call: &Call) -> Outcome {
    const OUT: usize = 10;
    let mut buffer: Buffer<{ 3 * LONGEST }> = Buffer::new();
    let mut valid = true;
    for part in [0, 3, 6] {
        let (position, count) = (call.word(part + 1) as i16, call.word(part + 2) as i16);
        match Text::of(call, part, Access::Read) {
            Some(text) => buffer.push_part(call, text, position, count),
            None => valid = false,
        }
    }
    if valid {
        return give(call, OUT, buffer.characters());
    }
    give(call, OUT, &[]);
    error(INVALID)
}

/// S1, S2 -> RET_VAL: 0 if S1 is less, 1 if they are equal, 2 if it is greater, by the codes of the characters.
pub(super) fn compare(call: &Call) -> Outcome {
    match (characters(call, 0), characters(call, 1)) {
        (Some(one), Some(two)) => Outcome::RetVal((one.characters().cmp(two.characters()) as i8 + 1) as u16),
        _ => error(INVALID),
    }
}

/// IN1, IN2 -> RET_VAL: position of the first IN2 in IN1, 0 if there is none or IN2 is empty.
pub(super) fn find(call: &Call) -> Outcome {
    match (characters(call, 0), characters(call, 1)) {
        (Some(text), Some(part)) if !part.characters().is_empty() => {
            let found = text.characters().windows(part.length).position(|window| window == part.characters());
            Outcome::RetVal(found.map_or(0, |index| index as u16 + 1))
        }
        (Some(_), Some(_)) => Outcome::RetVal(0),
        _ => error(INVALID),
    }
}

/// S -> RET_VAL: actual length.
pub(super) fn length(call: &Call) -> Outcome {
    Text::of(call, 0, Access::Read).map_or(error(INVALID), |text| Outcome::RetVal(text.length as u16))
}

/// S -> RET_VAL: maximum length.
pub(super) fn maximum(call: &Call) -> Outcome {
    Text::of(call, 0, Access::Read).map_or(error(INVALID), |text| Outcome::RetVal(text.maximum as u16))
}
