//! ATH and HTA: hexadecimal characters and bytes.
//!
//! Source: S7-1200 reference, string conversion.

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error};

/// A character that is no hexadecimal digit.
const NO_DIGIT: u16 = 0x8007;
/// N is below 0, or an area is shorter than it says.
const AREA: u16 = 0x8120;
const TARGET: u16 = 0x8151;

fn range(call: &Call, index: usize, access: Access) -> Option<Range> {
    any::decode(call, index, access).ok().flatten().filter(|range| range.existing == range.bytes)
}

/// IN, N -> RET_VAL, OUT: N characters to digits of four bits, the first leftmost; an odd last one is filled with 0.
pub(super) fn from_text(call: &Call) -> Outcome {
    let (Some(from), Some(to)) = (range(call, 0, Access::Read), range(call, 3, Access::Write)) else {
        return error(AREA);
    };
    let count = call.word(1) as i16;
    let Some(count) = u32::try_from(count).ok().filter(|&count| count <= from.bytes) else { return error(AREA) };
    if count.div_ceil(2) > to.bytes {
        return error(TARGET);
    }
    let memory = &call.cpu.memory;
    let mut bad = false;
    let mut digit = |at: u32| {
        let digit = if at < count { char::from(memory.byte(from.offset + at)).to_digit(16) } else { Some(0) };
        bad |= digit.is_none();
        digit.unwrap_or(0) as u8
    };
    let bytes: Vec<u8> = (0..count.div_ceil(2)).map(|at| digit(2 * at) << 4 | digit(2 * at + 1)).collect();
    memory.load(to.offset, &bytes);
    if bad { error(NO_DIGIT) } else { OK }
}

/// IN, N -> RET_VAL, OUT: N bytes to two upper-case characters each.
pub(super) fn to_text(call: &Call) -> Outcome {
    let (Some(from), Some(to)) = (range(call, 0, Access::Read), range(call, 3, Access::Write)) else {
        return error(AREA);
    };
    let count = call.word(1) as i16;
    let Some(count) = u32::try_from(count).ok().filter(|&count| count <= from.bytes) else { return error(AREA) };
    if 2 * count > to.bytes {
        return error(TARGET);
    }
    let memory = &call.cpu.memory;
    let text: String = (0..count).map(|at| format!("{:02X}", memory.byte(from.offset + at))).collect();
    memory.load(to.offset, text.as_bytes());
    OK
}
