//! How a text that is put together from parts gets into memory.
//!
//! What a function of texts does is written once, for two ways. [`Short`] is inlined into the functions that generated code calls: it does what
//! nearly all calls need, without a call, so that few registers are saved. Where something is out of the ordinary it gives up before it has
//! written anything. [`Bytes`] is the long way, which always gets there.

use super::{LONGEST, Text, give};
use crate::memory::Bytes;

/// Characters of a text.
#[derive(Clone, Copy, Default)]
pub struct Part {
    /// Offset from the memory base.
    pub at: u32,
    pub count: u32,
}

impl Part {
    /// At most `count` characters after the first `skipped`, as far as they are there.
    #[inline(always)]
    pub fn of(text: Text, skipped: u32, count: u32) -> Part {
        let first = skipped.min(text.length());
        Part { at: text.start() + first, count: count.min(text.length() - first) }
    }

    #[inline(always)]
    pub fn all(text: Text) -> Part {
        Part { at: text.start(), count: text.length() }
    }

    /// What follows the first `skipped` characters.
    #[inline(always)]
    pub fn after(text: Text, skipped: u32) -> Part {
        let first = skipped.min(text.length());
        Part { at: text.start() + first, count: text.length() - first }
    }
}

/// How results are written. `None`: nothing was written, and only the long way can do it.
pub trait Way: Copy {
    /// Whether it gives up.
    const GIVES_UP: bool;

    fn bytes(&self) -> Bytes<'_>;

    /// Writes `parts` one after the other to `out`, as far as they fit. They may be parts of this very text. The result is `good`, or false if
    /// they do not fit.
    fn put<const N: usize>(self, out: Option<Text>, parts: [Part; N], good: bool) -> Option<bool>;

    /// Makes the result empty, which is not what was wanted: the result is false.
    fn clear(self, out: Option<Text>) -> Option<bool>;
}

impl Way for Bytes<'_> {
    const GIVES_UP: bool = false;

    #[inline(always)]
    fn bytes(&self) -> Bytes<'_> {
        *self
    }

    #[inline(always)]
    fn put<const N: usize>(self, out: Option<Text>, parts: [Part; N], good: bool) -> Option<bool> {
        Some(put(self, out, parts) && good)
    }

    #[inline(always)]
    fn clear(self, out: Option<Text>) -> Option<bool> {
        give(self, out, &[]);
        Some(false)
    }
}

/// The way of short results that fit, where all is well.
#[derive(Clone, Copy)]
pub struct Short<'a>(pub Bytes<'a>);

impl Way for Short<'_> {
    const GIVES_UP: bool = true;

    #[inline(always)]
    fn bytes(&self) -> Bytes<'_> {
        self.0
    }

    #[inline(always)]
    fn put<const N: usize>(self, out: Option<Text>, parts: [Part; N], good: bool) -> Option<bool> {
        const { assert!(N <= 3) }
        let out = out?;
        let start = out.start();
        // Whether what is written before a part leaves it as it is, see `put`.
        let mut are_kept = true;
        let mut total = parts[0].count;
        for part in &parts[1..] {
            total += part.count;
            are_kept &= part.at.wrapping_sub(start).wrapping_add(part.count) >= total;
        }
        if !good || !are_kept || total > out.maximum().min(Bytes::SHORT_MAX) {
            return None;
        }
        // A text that something is appended to, or that gets shorter, begins where it is.
        if parts[0].at != start {
            self.copy(parts[0], start);
        }
        // Written out: a loop would stay one.
        if N > 1 {
            let second = start + parts[0].count;
            self.copy(parts[1], second);
            if N > 2 {
                self.copy(parts[2], second + parts[1].count);
            }
        }
        out.set_length(self.0, total);
        Some(true)
    }

    #[inline(always)]
    fn clear(self, _: Option<Text>) -> Option<bool> {
        None
    }
}

impl Short<'_> {
    /// Copies a part of a text to `to`.
    #[inline(always)]
    fn copy(self, part: Part, to: u32) {
        // SAFETY: they are characters of a text, there is room for them, and no more of them than that.
        unsafe { self.0.copy_short(part.at, to, part.count) }
    }
}

/// Writes `parts` one after the other to `out`, as far as they fit; false if they do not. They may be parts of this very text.
#[inline(always)]
fn put<const N: usize>(memory: Bytes, out: Option<Text>, mut parts: [Part; N]) -> bool {
    const { assert!(N <= 3) }
    let Some(out) = out else { return false };
    let start = out.start();
    let mut total = parts.iter().map(|part| part.count).sum::<u32>();
    let fits = total <= out.maximum();
    if !fits {
        total = cut(&mut parts, out.maximum());
    }
    // Whether what is written before a part leaves it as it is: the part ends before the result or begins after what is written then.
    let mut apart = true;
    let mut written = parts[0].count;
    for part in &parts[1..] {
        let from_start = part.at.wrapping_sub(start);
        apart &= part.count == 0 || from_start.wrapping_add(part.count) >= written + part.count;
        written += part.count;
    }
    if apart {
        // Written out: a loop would stay one.
        let second = copy_part(memory, parts[0], start);
        if N > 1 {
            let third = copy_part(memory, parts[1], second);
            if N > 2 {
                copy_part(memory, parts[2], third);
            }
        }
    } else {
        through_buffer(memory, start, &parts);
    }
    out.set_length(memory, total);
    fits
}

/// Shortens `parts` to `room` characters together. Returns how many are left.
#[cold]
fn cut(parts: &mut [Part], room: u32) -> u32 {
    let mut total = 0;
    for part in parts {
        part.count = part.count.min(room - total);
        total += part.count;
    }
    total
}

/// Copies a part of a text to `to`, where there is room. Returns what is after it.
#[inline(always)]
fn copy_part(memory: Bytes, part: Part, to: u32) -> u32 {
    if part.at != to {
        // SAFETY: they are characters of a text, and there is room for them.
        unsafe { memory.copy(part.at, to, part.count) }
    }
    to + part.count
}

/// Writes `parts`, which fit, to `start`.
#[cold]
fn through_buffer(memory: Bytes, start: u32, parts: &[Part]) {
    let mut buffer = [0; LONGEST];
    let mut total = 0;
    for part in parts {
        let mut take = |characters: &[u8]| {
            buffer[total..total + characters.len()].copy_from_slice(characters);
            total += characters.len();
        };
        // SAFETY: they are characters of a text.
        unsafe { memory.view(part.at, part.count, &mut take) }
    }
    // SAFETY: there is room for them.
    unsafe { memory.load(start, &buffer[..total]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Memory;
    use crate::text::join;
    use plcc_abi::layout;
    use plcc_abi::text::Rules;

    /// Memory with two texts, the second one 10 bytes after the first, whose room reaches over it.
    fn memory(lengths: [u8; 2]) -> (Memory, [Option<Text>; 2]) {
        let memory = Memory::new(layout::DB_DATA);
        let bytes: Vec<u8> = (0..=255).collect();
        memory.load(layout::M, &bytes);
        for (at, length) in [(0, lengths[0]), (10, lengths[1])] {
            memory.load(layout::M + at, &[90, length]);
        }
        let texts = [0, 10].map(|at| Text::at(&memory, layout::M + at, 200));
        (memory, texts)
    }

    fn show(memory: &Memory) -> Vec<u8> {
        memory.view(layout::M, 256, <[u8]>::to_vec)
    }

    /// One of the functions.
    fn call<W: Way>(way: W, function: u8, place: i16, [a, b]: [Option<Text>; 2], out: Option<Text>) -> Option<bool> {
        match function {
            0 => join::concat(way, a, b, out),
            1 => join::concat_three(way, [a, b, b], out).map(|(first, good)| first && good),
            2 => join::left(way, a, place, Rules::Tia, out),
            3 => join::right(way, a, place, Rules::V5, out),
            4 => join::delete(way, a, 2, place, Rules::Tia, out),
            5 => join::insert(way, a, b, place, Rules::V5, out),
            _ => join::replace(way, a, b, [3, place], Rules::Tia, out),
        }
    }

    #[test]
    fn both_ways_write_the_same() {
        let mut short_ones = 0;
        for lengths in [[0, 0], [3, 5], [5, 3], [8, 20], [20, 8], [33, 17], [60, 40], [90, 90]] {
            for place in [-1, 0, 1, 2, 7, 30, 100] {
                for (function, out) in (0..7).flat_map(|function| [(function, 0), (function, 1)]) {
                    let (long, texts) = memory(lengths);
                    let expected = call(long.bytes_at(), function, place, texts, texts[out]);
                    assert!(expected.is_some(), "the long way always gets there");
                    let (short, texts) = memory(lengths);
                    let done = call(Short(short.bytes_at()), function, place, texts, texts[out]);
                    if done.is_none() {
                        assert_eq!(show(&short), show(&memory(lengths).0), "who gives up has written nothing");
                        continue;
                    }
                    short_ones += 1;
                    let same = done == expected && show(&short) == show(&long);
                    assert!(same, "function {function} of {lengths:?} characters at {place} to text {out}");
                }
            }
        }
        assert!(short_ones > 200, "{short_ones}");
    }
}
