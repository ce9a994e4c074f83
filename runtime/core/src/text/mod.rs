//! STRING and WSTRING in PLC memory. Source: STL reference, composite encodings; SCL reference, strings.
//!
//! What the functions of the library do with texts is here, once: system functions bring texts as ANY pointers, generated code
//! brings addresses ([`Texts`]).

pub mod decimal;
pub mod join;
pub mod real;
pub mod search;
pub mod way;

use plcc_abi::layout::state;
use plcc_abi::text::{LOCAL, OPERAND_BITS};

use crate::memory::{Bytes, Memory};

/// Characters of the longest STRING.
pub const LONGEST: usize = 254;

/// A valid STRING.
///
/// A STRING begins with its maximum and its actual length. It is not valid if the maximum is 0 or 255 or less than the
/// actual length: this includes TEMP variables that were never written.
///
/// The head and as many characters as there is room for are inside memory; this module alone makes one.
#[derive(Clone, Copy)]
pub struct Text {
    offset: u32,
    room: u32,
    length: u32,
}

impl Text {
    /// The STRING at `offset` from the memory base, of which `existing` bytes exist; `None` if it is not valid.
    #[inline(always)]
    pub fn at(memory: &Memory, offset: u32, existing: u32) -> Option<Text> {
        // No STRING is longer.
        let existing = existing.min(LONGEST as u32 + 2);
        if existing < 2 || !memory.contains(offset, existing) {
            return None;
        }
        // SAFETY: two bytes exist.
        let head = u32::from(unsafe { memory.bytes_at().word(offset) });
        let (maximum, length) = (head & 0xFF, head >> 8);
        // The data block may end before the STRING that its header describes.
        let room = maximum.min(existing - 2);
        let valid = maximum.wrapping_sub(1) < LONGEST as u32 && length <= room;
        valid.then_some(Text { offset, room, length })
    }

    /// Characters that it has room for.
    #[inline(always)]
    pub fn maximum(self) -> u32 {
        self.room
    }

    /// Characters that it has.
    #[inline(always)]
    pub fn length(self) -> u32 {
        self.length
    }

    /// The position of its first character.
    #[inline(always)]
    fn start(self) -> u32 {
        self.offset + 2
    }

    /// Writes both bytes of the head, the first as it is: a processor waits when it reads a word of which it has just written a part, and the
    /// next function of the text reads the head.
    #[inline(always)]
    fn set_length(self, memory: Bytes, length: u32) {
        // SAFETY: the head is inside memory.
        unsafe {
            let maximum = memory.word(self.offset) & 0xFF;
            memory.set_word(self.offset, maximum | (length as u16) << 8);
        }
    }

    /// Writes the characters that have room, and the length; false if some have none.
    #[inline(always)]
    pub fn write(self, memory: Bytes, characters: &[u8]) -> bool {
        let kept = &characters[..characters.len().min(self.room as usize)];
        // SAFETY: there is room for them.
        unsafe { memory.load(self.start(), kept) }
        self.set_length(memory, kept.len() as u32);
        kept.len() == characters.len()
    }

    /// Shows its characters to `read`, which writes nothing.
    #[inline(always)]
    pub fn view<R>(self, memory: Bytes, read: impl FnOnce(&[u8]) -> R) -> R {
        // SAFETY: there is room for them.
        unsafe { memory.view(self.start(), self.length, read) }
    }
}

/// Texts that generated code brings: offsets from the memory base, and what is known of them, see [`plcc_abi::text`].
pub struct Texts<'a> {
    memory: &'a Memory,
    bytes: Bytes<'a>,
    known: u64,
}

impl<'a> Texts<'a> {
    #[inline(always)]
    pub fn new(memory: &'a Memory, known: u64) -> Texts<'a> {
        Texts { memory, bytes: memory.bytes_at(), known }
    }

    /// Memory for the functions of texts.
    #[inline(always)]
    pub fn bytes(&self) -> Bytes<'a> {
        self.bytes
    }

    /// The declared maximum of text operand `index`; 0 if it is not known.
    #[inline(always)]
    fn declared(&self, index: u32) -> u16 {
        ((self.known >> (index * OPERAND_BITS + OPERAND_BITS / 2)) as u8).into()
    }

    /// The actual length of text operand `index` of the function, at `offset`, if its maximum is as declared; otherwise more than 255.
    #[inline(always)]
    fn length(&self, index: u32, offset: u32) -> u16 {
        // SAFETY: generated code passes on only texts with a head.
        let head = unsafe { self.bytes.word(offset) };
        // The maximum is the low byte; it is 0 then, and becomes the high one.
        head.wrapping_sub(self.declared(index)).rotate_right(8)
    }

    /// True if the head of text operand `index`, at `offset`, is as declared, which it mostly is: then such a variable exists, and nothing else is
    /// looked up.
    #[inline(always)]
    pub fn is_as_declared(&self, index: u32, offset: u32) -> bool {
        let declared = self.declared(index);
        self.length(index, offset) <= declared && declared != 0
    }

    /// Text operand `index`, at `offset`, which [is as declared](Texts::is_as_declared).
    #[inline(always)]
    pub fn as_declared(&self, index: u32, offset: u32) -> Text {
        Text { offset, room: self.declared(index).into(), length: self.length(index, offset).into() }
    }

    /// Text operand `index`, whatever its head; `None` if it is not valid.
    #[cold]
    #[inline(never)]
    pub fn other(&self, index: u32, offset: u32) -> Option<Text> {
        let existing = match (self.known >> (index * OPERAND_BITS)) as u8 {
            LOCAL => self.memory.state32::<{ state::L_END }>().saturating_sub(offset),
            room => u32::from(room) + 2,
        };
        Text::at(self.memory, offset, existing)
    }
}

/// Writes a result, as far as it fits: `None` for an operand that is not valid, which leaves an empty text.
#[inline(always)]
pub fn give(memory: Bytes, out: Option<Text>, characters: &[u8]) -> bool {
    out.is_some_and(|out| out.write(memory, characters))
}

/// Writes a result if all of it fits; false if it does not.
#[inline(always)]
pub fn give_whole(memory: Bytes, out: Option<Text>, characters: &[u8]) -> bool {
    out.is_some_and(|out| characters.len() as u32 <= out.maximum() && out.write(memory, characters))
}

/// The actual or maximum length; 0 if the text is not valid.
pub fn length(text: Option<Text>, maximum: bool) -> u32 {
    text.map_or(0, |text| if maximum { text.maximum() } else { text.length() })
}

/// Copies the text at `from` to the one at `to`, which keeps its maximum: at most `limit` characters, with `u32::MAX` as many as the head at
/// `to` allows. True if something was cut.
pub fn copy(memory: &Memory, to: u32, from: u32, limit: u32, wide: bool) -> bool {
    if wide {
        return copy_wide(memory, to, from, limit);
    }
    let last = from.max(to);
    if !memory.contains(last, 2) {
        return true;
    }
    let bytes = memory.bytes_at();
    // SAFETY: the heads are inside memory, and so are the characters.
    unsafe {
        let length = u32::from(bytes.word(from) >> 8);
        let limit = if limit == u32::MAX { u32::from(bytes.word(to) & 0xFF) } else { limit };
        let kept = length.min(limit);
        if !memory.contains(last, 2 + kept) {
            return true;
        }
        bytes.copy(from + 2, to + 2, kept);
        bytes.set_word(to, bytes.word(to) & 0xFF | (kept as u16) << 8);
        kept < length
    }
}

fn copy_wide(memory: &Memory, to: u32, from: u32, limit: u32) -> bool {
    let word = |at: u32| u32::from(u16::from_be_bytes(memory.bytes::<2>(at)));
    let (length, maximum) = (word(from.wrapping_add(2)), word(to));
    let kept = length.min(if limit == u32::MAX { maximum } else { limit });
    memory.copy(from.wrapping_add(4), to.wrapping_add(4), kept * 2);
    memory.set_bytes(to.wrapping_add(2), (kept as u16).to_be_bytes());
    kept < length
}
