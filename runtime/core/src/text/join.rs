//! Texts put together from parts of others: CONCAT, LEFT, RIGHT, MID, DELETE, INSERT, REPLACE.
//!
//! The functions of STEP 7 V5 (FC 2 to 32) and the instructions of the TIA Portal differ in special cases ([`Rules`]). The result of each
//! is whether all is well, which is BR. An operand that is not valid makes the result empty; variables may be the same.
//!
//! Source: STL reference, IEC function library; S7-1200 reference, strings.

use plcc_abi::text::Rules;

use super::{LONGEST, Text, give};
use crate::memory::Bytes;

/// Characters of a text.
#[derive(Clone, Copy, Default)]
struct Part {
    /// Offset from the memory base.
    at: u32,
    count: u32,
}

impl Part {
    /// At most `count` characters after the first `skipped`, as far as they are there.
    #[inline(always)]
    fn of(text: Text, skipped: u32, count: u32) -> Part {
        let first = skipped.min(text.length());
        Part { at: text.start() + first, count: count.min(text.length() - first) }
    }

    #[inline(always)]
    fn all(text: Text) -> Part {
        Part { at: text.start(), count: text.length() }
    }

    /// What follows the first `skipped` characters.
    #[inline(always)]
    fn after(text: Text, skipped: u32) -> Part {
        Part::of(text, skipped, LONGEST as u32)
    }
}

/// IN1, then IN2.
#[inline(always)]
pub fn concat(memory: Bytes, in1: Option<Text>, in2: Option<Text>, out: Option<Text>) -> bool {
    let (Some(in1), Some(in2)) = (in1, in2) else { return invalid(memory, out) };
    put(memory, out, [Part::all(in1), Part::all(in2)])
}

/// IN1, IN2 and IN3, as two calls do it: the text of the first two has room for [`LONGEST`] characters, and is empty if one of them is not valid. The
/// first result belongs to the first two.
#[inline(always)]
pub fn concat_three(memory: Bytes, inputs: [Option<Text>; 3], out: Option<Text>) -> (bool, bool) {
    let [in1, in2, in3] = inputs;
    let Some(in3) = in3 else { return (true, invalid(memory, out)) };
    let (Some(in1), Some(in2)) = (in1, in2) else { return (false, put(memory, out, [Part::all(in3)])) };
    let second = Part::of(in2, 0, LONGEST as u32 - in1.length());
    (second.count == in2.length(), put(memory, out, [Part::all(in1), second, Part::all(in3)]))
}

/// The first L characters. L is negative, with the rules of the TIA Portal also 0: empty, and wrong.
#[inline(always)]
pub fn left(memory: Bytes, text: Option<Text>, l: i16, rules: Rules, out: Option<Text>) -> bool {
    let Some(text) = text else { return invalid(memory, out) };
    put(memory, out, [Part::of(text, 0, positive(l))]) && l >= least_count(rules)
}

/// The last L characters, otherwise as [`left`].
#[inline(always)]
pub fn right(memory: Bytes, text: Option<Text>, l: i16, rules: Rules, out: Option<Text>) -> bool {
    let Some(text) = text else { return invalid(memory, out) };
    let skipped = text.length().saturating_sub(positive(l));
    put(memory, out, [Part::after(text, skipped)]) && l >= least_count(rules)
}

/// L characters from position P on. L or P is not positive, or P is above the length: empty, and wrong.
#[inline(always)]
pub fn mid(memory: Bytes, text: Option<Text>, l: i16, p: i16, out: Option<Text>) -> bool {
    let Some(text) = text else { return invalid(memory, out) };
    if l < 1 || p < 1 || positive(p) > text.length() {
        return invalid(memory, out);
    }
    put(memory, out, [Part::of(text, positive(p) - 1, positive(l))])
}

/// The text without L characters from position P on. L or P is negative, with the rules of the TIA Portal P also 0: empty, and wrong. With
/// these rules P above the length is wrong too, if L is not 0; the result is the text.
#[inline(always)]
pub fn delete(memory: Bytes, text: Option<Text>, l: i16, p: i16, rules: Rules, out: Option<Text>) -> bool {
    let Some(text) = text else { return invalid(memory, out) };
    if l < 0 || p < least_count(rules) {
        return invalid(memory, out);
    }
    let (l, p) = (positive(l), positive(p));
    if l == 0 || p == 0 {
        return put(memory, out, [Part::all(text)]);
    }
    let done = put(memory, out, [Part::of(text, 0, p - 1), Part::after(text, p - 1 + l)]);
    done && !(rules == Rules::Tia && p > text.length())
}

/// IN1 with IN2 after position P. P is negative: empty, and wrong. P is above the length: IN2 is appended, which is wrong with the rules of
/// the TIA Portal.
#[inline(always)]
pub fn insert(memory: Bytes, in1: Option<Text>, in2: Option<Text>, p: i16, rules: Rules, out: Option<Text>) -> bool {
    let (Some(in1), Some(in2)) = (in1, in2) else { return invalid(memory, out) };
    if p < 0 {
        return invalid(memory, out);
    }
    let p = positive(p);
    let done = put(memory, out, [Part::of(in1, 0, p), Part::all(in2), Part::after(in1, p)]);
    done && !(rules == Rules::Tia && p > in1.length())
}

/// IN1 with IN2 instead of L characters from position P on.
///
/// V5: L or P is negative: empty, and wrong. L is 0 and P is not: IN1. P is 0: from the first character on.
/// TIA Portal: L is negative, P is not positive: empty, and wrong. L characters from P on are not there: wrong.
#[inline(always)]
pub fn replace(
    memory: Bytes,
    in1: Option<Text>,
    in2: Option<Text>,
    [l, p]: [i16; 2],
    rules: Rules,
    out: Option<Text>,
) -> bool {
    let (Some(in1), Some(in2)) = (in1, in2) else { return invalid(memory, out) };
    if l < 0 || p < least_count(rules) {
        return invalid(memory, out);
    }
    let (l, p) = (positive(l), positive(p));
    if rules == Rules::V5 && l == 0 && p != 0 {
        return put(memory, out, [Part::all(in1)]);
    }
    let first = p.max(1) - 1;
    let done = put(memory, out, [Part::of(in1, 0, first), Part::all(in2), Part::after(in1, first + l)]);
    done && !(rules == Rules::Tia && (p > in1.length() || l > in1.length() - first))
}

/// A number of characters or a position; 0 if it is negative.
#[inline(always)]
fn positive(value: i16) -> u32 {
    u32::from(value.max(0) as u16)
}

/// The least L of LEFT and RIGHT, and the least P of DELETE and REPLACE.
#[inline(always)]
fn least_count(rules: Rules) -> i16 {
    i16::from(rules == Rules::Tia)
}

/// Makes the result empty.
#[cold]
fn invalid(memory: Bytes, out: Option<Text>) -> bool {
    give(memory, out, &[]);
    false
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
