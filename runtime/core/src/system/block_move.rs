//! SFC 20 BLKMOV, SFC 21 FILL, SFC 81 UBLKMOV.
//!
//! Source: System and standard functions, SFC 20, 21, 81.

use plcc_abi::any::block_move::{DESTINATION, SOURCE, TOO_LONG, UNINTERRUPTED_MAX};
use plcc_abi::any::short_error;

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::cpu::Cpu;

/// Copies in ascending order; the shorter length decides.
pub(super) fn blkmov(call: &Call) -> Outcome {
    copy(call, u32::MAX)
}

/// As BLKMOV, at most 512 bytes.
pub(super) fn ublkmov(call: &Call) -> Outcome {
    copy(call, UNINTERRUPTED_MAX)
}

fn copy(call: &Call, longest: u32) -> Outcome {
    match ranges(call) {
        Ok(Some((source, destination))) => {
            let source = string_characters(call.cpu, source);
            let bytes = source.bytes.min(destination.bytes);
            if bytes > longest {
                return error(TOO_LONG);
            }
            if let Err(code) = complete(call.cpu, &source, &destination, bytes, bytes) {
                return error(code);
            }
            call.cpu.memory.copy(source.offset, destination.offset, bytes);
            OK
        }
        Ok(None) => OK,
        Err(code) => error(code),
    }
}

/// Repeats the source in the destination; the last part may be cut.
pub(super) fn fill(call: &Call) -> Outcome {
    match ranges(call) {
        Ok(Some((source, destination))) => {
            if let Err(code) = complete(call.cpu, &source, &destination, source.bytes, destination.bytes) {
                return error(code);
            }
            let mut done = 0;
            while done < destination.bytes {
                let part = source.bytes.min(destination.bytes - done);
                call.cpu.memory.copy(source.offset, destination.offset + done, part);
                done += part;
            }
            OK
        }
        Ok(None) => OK,
        Err(code) => error(code),
    }
}

fn ranges(call: &Call) -> Result<Option<(Range, Range)>, u16> {
    let source = any::decode(call, SOURCE, Access::Read)?;
    let destination = any::decode(call, DESTINATION, Access::Write)?;
    Ok(source.zip(destination))
}

/// Of a STRING only the characters count.
fn string_characters(cpu: &Cpu, range: Range) -> Range {
    if range.type_code != any::STRING || range.existing < 2 {
        return range;
    }
    let actual = u32::from(cpu.memory.byte(range.offset + 1)).min(range.existing - 2);
    Range { offset: range.offset + 2, bytes: actual, existing: actual, ..range }
}

/// `Err`: the area is smaller than the pointer says.
fn complete(cpu: &Cpu, source: &Range, destination: &Range, read: u32, written: u32) -> Result<(), u16> {
    let (short_source, short_destination) = (source.existing < read, destination.existing < written);
    short_error(cpu.image.profile.family, short_source, short_destination).map_or(Ok(()), Err)
}
