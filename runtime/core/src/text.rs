//! STRING and WSTRING in PLC memory. Source: STL reference, composite encodings; SCL reference, strings.

use crate::memory::Memory;

/// Copies the text at `from` to the one at `to`, which keeps its maximum: at most `limit` characters, with `u32::MAX` as many as the head at
/// `to` allows. True if something was cut.
pub fn copy(memory: &Memory, to: u32, from: u32, limit: u32, wide: bool) -> bool {
    let word = |at: u32| u32::from(u16::from_be_bytes(memory.bytes::<2>(at)));
    let byte = |at: u32| u32::from(memory.byte(at));
    let (head, size) = if wide { (4u32, 2) } else { (2, 1) };
    let (length, maximum) =
        if wide { (word(from.wrapping_add(2)), word(to)) } else { (byte(from.wrapping_add(1)), byte(to)) };
    let limit = if limit == u32::MAX { maximum } else { limit };
    let kept = length.min(limit);
    memory.copy(from.wrapping_add(head), to.wrapping_add(head), kept * size);
    if wide {
        memory.set_bytes(to.wrapping_add(2), (kept as u16).to_be_bytes());
    } else {
        memory.set_byte(to.wrapping_add(1), kept as u8);
    }
    kept < length
}
