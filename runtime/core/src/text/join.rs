//! Texts put together from parts of others: CONCAT, LEFT, RIGHT, MID, DELETE, INSERT, REPLACE.
//!
//! The functions of STEP 7 V5 (FC 2 to 32) and the instructions of the TIA Portal differ in special cases ([`Rules`]). The result of each
//! is whether all is well, which is BR. An operand that is not valid makes the result empty; variables may be the same. How the result gets into
//! memory is the [`Way`].
//!
//! Source: STL reference, IEC function library; S7-1200 reference, strings.

use plcc_abi::text::Rules;

use super::way::{Part, Way};
use super::{LONGEST, Text};

/// IN1, then IN2.
#[inline(always)]
pub fn concat<W: Way>(memory: W, in1: Option<Text>, in2: Option<Text>, out: Option<Text>) -> Option<bool> {
    let (Some(in1), Some(in2)) = (in1, in2) else { return memory.clear(out) };
    memory.put(out, [Part::all(in1), Part::all(in2)], true)
}

/// IN1, IN2 and IN3, as two calls do it: the text of the first two has room for [`LONGEST`] characters, and is empty if one of them is not valid. The
/// first result belongs to the first two.
#[inline(always)]
pub fn concat_three<W: Way>(memory: W, inputs: [Option<Text>; 3], out: Option<Text>) -> Option<(bool, bool)> {
    let [in1, in2, in3] = inputs;
    let Some(in3) = in3 else { return Some((true, memory.clear(out)?)) };
    let (Some(in1), Some(in2)) = (in1, in2) else { return Some((false, memory.put(out, [Part::all(in3)], true)?)) };
    // The short way is only for texts that all have room.
    let room = if W::GIVES_UP { LONGEST as u32 } else { LONGEST as u32 - in1.length() };
    let second = Part::of(in2, 0, room);
    let first = second.count == in2.length();
    Some((first, memory.put(out, [Part::all(in1), second, Part::all(in3)], true)?))
}

/// The first L characters. L is negative, with the rules of the TIA Portal also 0: empty, and wrong.
#[inline(always)]
pub fn left<W: Way>(memory: W, text: Option<Text>, l: i16, rules: Rules, out: Option<Text>) -> Option<bool> {
    let Some(text) = text else { return memory.clear(out) };
    memory.put(out, [Part::of(text, 0, positive(l))], l >= least_count(rules))
}

/// The last L characters, otherwise as [`left`].
#[inline(always)]
pub fn right<W: Way>(memory: W, text: Option<Text>, l: i16, rules: Rules, out: Option<Text>) -> Option<bool> {
    let Some(text) = text else { return memory.clear(out) };
    let skipped = text.length().saturating_sub(positive(l));
    memory.put(out, [Part::after(text, skipped)], l >= least_count(rules))
}

/// L characters from position P on. L or P is not positive, or P is above the length: empty, and wrong.
#[inline(always)]
pub fn mid<W: Way>(memory: W, text: Option<Text>, l: i16, p: i16, out: Option<Text>) -> Option<bool> {
    let Some(text) = text else { return memory.clear(out) };
    if l < 1 || p < 1 || positive(p) > text.length() {
        return memory.clear(out);
    }
    memory.put(out, [Part::of(text, positive(p) - 1, positive(l))], true)
}

/// The text without L characters from position P on. L or P is negative, with the rules of the TIA Portal P also 0: empty, and wrong. With
/// these rules P above the length is wrong too, if L is not 0; the result is the text.
#[inline(always)]
pub fn delete<W: Way>(memory: W, text: Option<Text>, l: i16, p: i16, rules: Rules, out: Option<Text>) -> Option<bool> {
    let Some(text) = text else { return memory.clear(out) };
    if l < 0 || p < least_count(rules) {
        return memory.clear(out);
    }
    let (l, p) = (positive(l), positive(p));
    if l == 0 || p == 0 {
        return memory.put(out, [Part::all(text)], true);
    }
    let good = !(rules == Rules::Tia && p > text.length());
    memory.put(out, [Part::of(text, 0, p - 1), Part::after(text, p - 1 + l)], good)
}

/// IN1 with IN2 after position P. P is negative: empty, and wrong. P is above the length: IN2 is appended, which is wrong with the rules of
/// the TIA Portal.
#[inline(always)]
pub fn insert<W: Way>(
    memory: W,
    in1: Option<Text>,
    in2: Option<Text>,
    p: i16,
    rules: Rules,
    out: Option<Text>,
) -> Option<bool> {
    let (Some(in1), Some(in2)) = (in1, in2) else { return memory.clear(out) };
    if p < 0 {
        return memory.clear(out);
    }
    let p = positive(p);
    let good = !(rules == Rules::Tia && p > in1.length());
    memory.put(out, [Part::of(in1, 0, p), Part::all(in2), Part::after(in1, p)], good)
}

/// IN1 with IN2 instead of L characters from position P on.
///
/// V5: L or P is negative: empty, and wrong. L is 0 and P is not: IN1. P is 0: from the first character on.
/// TIA Portal: L is negative, P is not positive: empty, and wrong. L characters from P on are not there: wrong.
#[inline(always)]
pub fn replace<W: Way>(
    memory: W,
    in1: Option<Text>,
    in2: Option<Text>,
    [l, p]: [i16; 2],
    rules: Rules,
    out: Option<Text>,
) -> Option<bool> {
    let (Some(in1), Some(in2)) = (in1, in2) else { return memory.clear(out) };
    if l < 0 || p < least_count(rules) {
        return memory.clear(out);
    }
    let (l, p) = (positive(l), positive(p));
    if rules == Rules::V5 && l == 0 && p != 0 {
        return memory.put(out, [Part::all(in1)], true);
    }
    let first = p.max(1) - 1;
    let good = !(rules == Rules::Tia && (p > in1.length() || l > in1.length().saturating_sub(first)));
    memory.put(out, [Part::of(in1, 0, first), Part::all(in2), Part::after(in1, first + l)], good)
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
