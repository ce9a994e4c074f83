//! STRING values after ANY parameters, for the functions of [`crate::text`].
//!
//! Source: STL reference, composite encodings; string functions FC 2 to FC 32.

use plcc_abi::text::Rules;

use super::Outcome;
use super::any::{self, Access};
use super::parameters::Call;
use crate::text::{self, join, search};
pub(super) use crate::text::{LONGEST, Text};

/// The result was longer than its STRING can hold.
pub(super) const CUT: u16 = 0x8001;
/// A STRING is not valid, or a text does not have the required form.
pub(super) const INVALID: u16 = 0x8002;

/// The STRING of parameter `index`; `None` if there is none, or it is not valid.
pub(super) fn of(call: &Call, index: usize, access: Access) -> Option<Text> {
    let (offset, existing) = match any::decode_bytes(call, index, access) {
        Some(found) => found,
        None => any::decode(call, index, access).ok()?.map(|range| (range.offset, range.existing))?,
    };
    Text::at(&call.cpu.memory, offset, existing)
}

/// Characters outside PLC memory, so that a function may write into the STRING that it reads.
pub(crate) struct Buffer<const N: usize> {
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
    let text = of(call, index, Access::Read)?;
    Some(text.view(call.cpu.memory.bytes_at(), |characters| {
        let mut buffer = Buffer::new();
        buffer.push_all(characters);
        buffer
    }))
}

/// The text that a function reads.
fn input(call: &Call, index: usize) -> Option<Text> {
    of(call, index, Access::Read)
}

/// The text that a function writes.
fn output(call: &Call, index: usize) -> Option<Text> {
    of(call, index, Access::Write)
}

/// The result of a function that writes a text.
fn written(good: Option<bool>) -> Outcome {
    Outcome::Flag(good == Some(true))
}

fn number(call: &Call, index: usize) -> i16 {
    call.word(index) as i16
}

fn rules(call: &Call, index: usize) -> Rules {
    Rules::of(call.word(index))
}

/// IN1, IN2 -> OUT
pub(super) fn concat(call: &Call) -> Outcome {
    written(join::concat(call.cpu.memory.bytes_at(), input(call, 0), input(call, 1), output(call, 2)))
}

/// S1, S2, RELATION -> OUT BOOL
pub(super) fn compare(call: &Call) -> Outcome {
    let holds = search::relation(call.cpu.memory.bytes_at(), input(call, 0), input(call, 1), call.word(2).into());
    call.set_bool(3, holds == Some(true));
    Outcome::Flag(holds.is_some())
}

/// IN1, IN2, RULES -> OUT INT
pub(super) fn find(call: &Call) -> Outcome {
    let (position, good) = search::find(call.cpu.memory.bytes_at(), input(call, 0), input(call, 1), rules(call, 2));
    call.set_word(3, position as u16);
    Outcome::Flag(good)
}

/// S, MAXIMUM -> OUT INT
pub(super) fn length(call: &Call) -> Outcome {
    call.set_word(2, text::length(input(call, 0), call.word(1) != 0) as u16);
    Outcome::Flag(true)
}

/// IN1, IN2, L, P, RULES -> OUT
pub(super) fn replace(call: &Call) -> Outcome {
    let place = [number(call, 2), number(call, 3)];
    let (in1, in2) = (input(call, 0), input(call, 1));
    written(join::replace(call.cpu.memory.bytes_at(), in1, in2, place, rules(call, 4), output(call, 5)))
}

/// IN, L, RULES -> OUT
pub(super) fn left(call: &Call) -> Outcome {
    written(join::left(call.cpu.memory.bytes_at(), input(call, 0), number(call, 1), rules(call, 2), output(call, 3)))
}

/// IN, L, RULES -> OUT
pub(super) fn right(call: &Call) -> Outcome {
    written(join::right(call.cpu.memory.bytes_at(), input(call, 0), number(call, 1), rules(call, 2), output(call, 3)))
}

/// IN, L, P -> OUT
pub(super) fn mid(call: &Call) -> Outcome {
    written(join::mid(call.cpu.memory.bytes_at(), input(call, 0), number(call, 1), number(call, 2), output(call, 3)))
}

/// IN, L, P, RULES -> OUT
pub(super) fn delete(call: &Call) -> Outcome {
    let (l, p) = (number(call, 1), number(call, 2));
    written(join::delete(call.cpu.memory.bytes_at(), input(call, 0), l, p, rules(call, 3), output(call, 4)))
}

/// IN1, IN2, P, RULES -> OUT
pub(super) fn insert(call: &Call) -> Outcome {
    let (in1, in2) = (input(call, 0), input(call, 1));
    written(join::insert(call.cpu.memory.bytes_at(), in1, in2, number(call, 2), rules(call, 3), output(call, 4)))
}
