//! Names of instances: the runtime part of GetInstanceName and GetInstancePath.
//!
//! Source: S7-1500 information system, GetInstanceName and GetInstancePath.

use super::Outcome;
use super::any::{self, Access};
use super::parameters::Call;
use crate::names;

/// Bytes of a WSTRING before its characters: the greatest and the actual length.
const HEAD_BYTES: u32 = 4;

/// SELF, KIND, PATH -> TEXT, which is a WSTRING.
pub(super) fn instance(call: &Call) -> Outcome {
    let own = call.any(0);
    let byte = own.pointer >> 3 & 0xFFFF;
    let found = names::instance(&call.cpu.image, own.db, byte, call.dword(1));
    let wanted = found.as_ref().map(|found| if call.byte(2) & 1 == 1 { &found.path } else { &found.name });
    let Ok(Some(target)) = any::decode(call, 3, Access::Write) else { return Outcome::Flag(false) };
    if target.existing < HEAD_BYTES {
        return Outcome::Flag(false);
    }
    let memory = &call.cpu.memory;
    let room = u32::from(memory.word(target.offset)).min((target.existing - HEAD_BYTES) / 2);
    let characters = wanted.into_iter().flat_map(|name| name.encode_utf16()).take(room as usize);
    let mut length = 0;
    for (at, character) in (target.offset + HEAD_BYTES..).step_by(2).zip(characters) {
        memory.set_word(at, character);
        length += 1;
    }
    memory.set_word(target.offset + 2, length);
    Outcome::Flag(found.is_some())
}
