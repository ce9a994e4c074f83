//! STRING values after ANY parameters, and the functions of the library that work on their characters.
//!
//! A STRING begins with its maximum and its actual length. It is not valid if the maximum is 0 or 255 or less than the
//! actual length: this includes TEMP variables that were never written.
//! Source: STL reference, composite encodings; string functions FC 2 to FC 32.
//!
//! RET_VAL of these functions: 0, [`CUT`] or [`INVALID`].

use std::num::NonZeroU64;

use super::any::{self, Access};
use super::parameters::Call;
use super::{OK, Outcome, error};

/// The result was longer than its STRING can hold.
pub(super) const CUT: u16 = 0x8001;
/// A STRING is not valid, or a text does not have the required form.
pub(super) const INVALID: u16 = 0x8002;

/// Characters of the longest STRING.
pub(super) const LONGEST: usize = 254;

/// The position of a valid STRING, its maximum and its length, in one word: it is handed around a lot. The highest bit is set.
#[derive(Clone, Copy)]
pub(super) struct Text(NonZeroU64);

impl Text {
    /// The STRING of parameter `index`; `None` if there is none, or it is not valid.
    pub fn of(call: &Call, index: usize, access: Access) -> Option<Text> {
        let (offset, existing) = match any::decode_bytes(call, index, access) {
            Some(found) => found,
            None => any::decode(call, index, access).ok()?.map(|range| (range.offset, range.existing))?,
        };
        if existing < 2 {
            return None;
        }
        let maximum = u32::from(call.cpu.memory.byte(offset));
        let length = u32::from(call.cpu.memory.byte(offset + 1));
        // The data block may end before the STRING that its header describes.
        let room = maximum.min(existing - 2);
        let valid = maximum != 0 && maximum != 255 && length <= room;
        // The highest bit, so that even an empty text without room is not 0.
        let packed = 1 << 63 | u64::from(offset) << 16 | u64::from(room) << 8 | u64::from(length);
        NonZeroU64::new(packed).filter(|_| valid).map(Text)
    }

    /// Characters that it has room for.
    pub fn maximum(self) -> u32 {
        (self.0.get() >> 8 & 0xFF) as u32
    }

    fn length(self) -> u32 {
        (self.0.get() & 0xFF) as u32
    }

    fn offset(self) -> u32 {
        (self.0.get() >> 16) as u32
    }

    /// The position of its first character.
    fn start(&self) -> u32 {
        self.offset() + 2
    }

    fn set_length(&self, call: &Call, length: u32) {
        call.cpu.memory.set_byte(self.offset() + 1, length as u8);
    }

    /// Writes the characters that have room, and the length; false if some have none.
    pub fn write(&self, call: &Call, characters: &[u8]) -> bool {
        let kept = &characters[..characters.len().min(self.maximum() as usize)];
        call.cpu.memory.load(self.start(), kept);
        self.set_length(call, kept.len() as u32);
        kept.len() == characters.len()
    }

    /// Shows its characters to `read`, which writes nothing.
    fn view<R>(&self, call: &Call, read: impl FnOnce(&[u8]) -> R) -> R {
        call.cpu.memory.view(self.start(), self.length(), read)
    }

    /// `count` characters from position `position` (1-based), as far as they are there.
    fn part(&self, position: i16, count: i16) -> Part {
        let first = (u32::from(position.max(1) as u16) - 1).min(self.length());
        let count = u32::from(count.max(0) as u16);
        Part { at: self.start() + first, count: count.min(self.length() - first) }
    }
}

/// Characters of a text.
#[derive(Clone, Copy, Default)]
struct Part {
    /// Offset from the memory base.
    at: u32,
    count: u32,
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

    /// Adds characters; those beyond the capacity are dropped.
    fn push_all(&mut self, characters: &[u8]) {
        let count = characters.len().min(N - self.length);
        self.characters[self.length..self.length + count].copy_from_slice(&characters[..count]);
        self.length += count;
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
        self.push_all(text.as_bytes());
        Ok(())
    }
}

/// All characters of parameter `index`.
pub(super) fn characters(call: &Call, index: usize) -> Option<Buffer<LONGEST>> {
    view(call, index, |characters| {
        let mut buffer = Buffer::new();
        buffer.push_all(characters);
        buffer
    })
}

/// Shows the characters of parameter `index` to `read`, which writes nothing.
pub(super) fn view<R>(call: &Call, index: usize, read: impl FnOnce(&[u8]) -> R) -> Option<R> {
    Some(Text::of(call, index, Access::Read)?.view(call, read))
}

/// As [`view`], of two parameters.
fn view_two<R>(call: &Call, read: impl FnOnce(&[u8], &[u8]) -> R) -> Option<R> {
    let (one, two) = (Text::of(call, 0, Access::Read)?, Text::of(call, 1, Access::Read)?);
    Some(one.view(call, |one| two.view(call, |two| read(one, two))))
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
        Some(text) if characters.len() as u32 <= text.maximum() => {
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
    let mut parts = [Part::default(); 3];
    let mut valid = true;
    let first = Text::of(call, 0, Access::Read);
    for (index, part) in parts.iter_mut().enumerate() {
        let at = 3 * index;
        // Mostly they are parts of one text.
        let text = if index == 0 || call.any(at) == call.any(0) { first } else { Text::of(call, at, Access::Read) };
        match text {
            Some(text) => *part = text.part(call.word(at + 1) as i16, call.word(at + 2) as i16),
            None => valid = false,
        }
    }
    if valid {
        return match Text::of(call, OUT, Access::Write) {
            Some(text) if put_together(call, text, parts) => OK,
            Some(_) => error(CUT),
            None => error(INVALID),
        };
    }
    give(call, OUT, &[]);
    error(INVALID)
}

/// Writes `parts` one after the other to `text`, as far as they fit; false if they do not. They may be parts of this very text.
fn put_together(call: &Call, text: Text, mut parts: [Part; 3]) -> bool {
    let start = text.start();
    let mut total = 0;
    let mut fits = true;
    // Whether what is written before a part leaves it as it is.
    let mut apart = true;
    for part in &mut parts {
        let room = text.maximum() - total;
        fits &= part.count <= room;
        part.count = part.count.min(room);
        apart &= part.count == 0 || part.at + part.count <= start || part.at >= start + total;
        total += part.count;
    }
    if apart {
        let mut to = start;
        for part in parts {
            if part.at != to {
                call.cpu.memory.copy(part.at, to, part.count);
            }
            to += part.count;
        }
    } else {
        let mut buffer: Buffer<LONGEST> = Buffer::new();
        for part in parts {
            call.cpu.memory.view(part.at, part.count, |characters| buffer.push_all(characters));
        }
        call.cpu.memory.load(start, buffer.characters());
    }
    text.set_length(call, total);
    fits
}

/// S1, S2 -> RET_VAL: 0 if S1 is less, 1 if they are equal, 2 if it is greater, by the codes of the characters.
pub(super) fn compare(call: &Call) -> Outcome {
    let order = view_two(call, |one, two| one.cmp(two) as i8 + 1);
    order.map_or(error(INVALID), |order| Outcome::RetVal(order as u16))
}

/// IN1, IN2 -> RET_VAL: position of the first IN2 in IN1, 0 if there is none or IN2 is empty.
pub(super) fn find(call: &Call) -> Outcome {
    let found = view_two(call, |text, part| position(text, part).map_or(0, |index| index as u16 + 1));
    found.map_or(error(INVALID), Outcome::RetVal)
}

/// The first `part` in `text`; `None` if there is none or it is empty.
fn position(text: &[u8], part: &[u8]) -> Option<usize> {
    let (first, rest) = part.split_first()?;
    let starts = text.get(..=text.len().checked_sub(part.len())?)?;
    let mut from = 0;
    loop {
        let at = from + starts[from..].iter().position(|character| character == first)?;
        if &text[at + 1..at + part.len()] == rest {
            return Some(at);
        }
        from = at + 1;
    }
}

/// S -> RET_VAL: actual length.
pub(super) fn length(call: &Call) -> Outcome {
    Text::of(call, 0, Access::Read).map_or(error(INVALID), |text| Outcome::RetVal(text.length() as u16))
}

/// S -> RET_VAL: maximum length.
pub(super) fn maximum(call: &Call) -> Outcome {
    Text::of(call, 0, Access::Read).map_or(error(INVALID), |text| Outcome::RetVal(text.maximum() as u16))
}
