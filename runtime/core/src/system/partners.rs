//! The runtime part of PUT, GET, USEND, URCV, BSEND, BRCV. RET_VAL is a STATUS of these blocks.
//!
//! Source: System and standard functions, SFB 8 to 15.

use plcc_abi::any::Fields;
use plcc_abi::layout::area;

use super::any::{self, Access};
use super::parameters::Call;
use super::{OK, Outcome, variants};
use crate::partners::{Arrived, BIT, BYTES, COUNTERS, Data, Kind, Receive, Remote, Slot, State, TIMERS, Work, status};

/// Areas of one job.
const AREAS_MAX: usize = 4;
/// The longest block of BSEND. Source: System and standard functions, SFB 12, LEN.
const BLOCK_BYTES_MAX: usize = 65534;
/// General parts of error codes of pointers: the DB is missing, or is write-protected.
const DB_ERRORS: [u16; 2] = [0x3A, 0x30];

/// ID, ADDR_1 to ADDR_4, RD_1 to RD_4 -> RET_VAL: 0 or an error; JOB.
pub(super) fn get(call: &Call) -> Outcome {
    let work = areas(call, 1, |index| {
        let (remote, place) = (remote(call.any(index))?, place(call, index + AREAS_MAX, Access::Write)?);
        fits(&remote, place.as_ref())?;
        Ok(remote)
    });
    begin(call, 10, call.word(0), work.map(Work::Read))
}

/// ID, ADDR_1 to ADDR_4, SD_1 to SD_4 -> RET_VAL: 0 or an error; JOB.
pub(super) fn put(call: &Call) -> Outcome {
    let work = areas(call, 1, |index| {
        let (remote, place) = (remote(call.any(index))?, place(call, index + AREAS_MAX, Access::Read)?);
        fits(&remote, place.as_ref())?;
        Ok((remote, place.ok_or(status::AREA)?.read(call)))
    });
    begin(call, 10, call.word(0), work.map(Work::Write))
}

/// ID, R_ID, SD_1 to SD_4 -> RET_VAL: 0 or an error; JOB.
pub(super) fn usend(call: &Call) -> Outcome {
    let r_id = call.dword(1);
    let work = areas(call, 2, |index| Ok(place(call, index, Access::Read)?.ok_or(status::AREA)?.read(call)));
    begin(call, 7, call.word(0), work.map(|areas| Work::Message(r_id, areas)))
}

/// ID, R_ID, SD_1, LEN -> RET_VAL: 0 or an error; JOB.
pub(super) fn bsend(call: &Call) -> Outcome {
    let (r_id, length) = (call.dword(1), usize::from(call.word(3)));
    let work = place(call, 2, Access::Read).and_then(|place| {
        let mut data = place.filter(|place| place.bit.is_none()).ok_or(status::AREA)?.read(call);
        if length == 0 || length > data.bytes.len().min(BLOCK_BYTES_MAX) {
            return Err(status::AREA);
        }
        data.bytes.truncate(length);
        Ok(Work::Block(r_id, data.bytes))
    });
    begin(call, 5, call.word(0), work)
}

/// JOB -> RET_VAL: 25 the job runs, else its STATUS, once; RD_1 to RD_4 take what was read.
pub(super) fn take(call: &Call) -> Outcome {
    match call.cpu.partners.state(call.dword(0)) {
        State::Running => {
            call.cpu.connections().note_waiting();
            Outcome::RetVal(status::RUNNING)
        }
        State::Ended(Ok(areas)) => Outcome::RetVal(store(call, 2, &areas)),
        State::Ended(Err(code)) => Outcome::RetVal(code),
    }
}

/// JOB -> RET_VAL: 25 the job runs, else its STATUS, once.
pub(super) fn state(call: &Call) -> Outcome {
    match call.cpu.partners.state(call.dword(0)) {
        State::Running => {
            call.cpu.connections().note_waiting();
            Outcome::RetVal(status::RUNNING)
        }
        State::Ended(ended) => Outcome::RetVal(ended.err().unwrap_or(status::DONE)),
    }
}

/// JOB -> RET_VAL: 0.
pub(super) fn cancel(call: &Call) -> Outcome {
    call.cpu.partners.cancel(call.dword(0));
    OK
}

/// EN_R, ID, R_ID, HANDLE -> RET_VAL: 0 new data, 9 new data that took the place of older data, 25 nothing yet, or an error; NEW: the handle; RD_1
/// to RD_4 take the data.
pub(super) fn urcv(call: &Call) -> Outcome {
    match arrived(call, Kind::Message, 0) {
        Ok(Arrived::All { areas, overwritten }) => Outcome::RetVal(match store(call, 6, &areas) {
            status::DONE if overwritten => status::OVERWRITTEN,
            code => code,
        }),
        Ok(Arrived::Some | Arrived::Nothing) => Outcome::RetVal(status::RUNNING),
        Err(code) => Outcome::RetVal(code),
    }
}

/// EN_R, ID, R_ID, HANDLE -> RET_VAL: 0 new data, 17 data is arriving, 25 nothing yet, or an error; NEW: the handle; LEN; RD_1 takes the data.
pub(super) fn brcv(call: &Call) -> Outcome {
    // The next call has the same handle, whatever becomes of this one.
    call.set_dword(5, call.dword(3));
    let room = match place(call, 7, Access::Write) {
        Ok(Some(place)) if place.bit.is_none() => place.bytes as usize,
        Ok(_) => return Outcome::RetVal(status::AREA),
        Err(code) => return Outcome::RetVal(code),
    };
    match arrived(call, Kind::Block, room) {
        Ok(Arrived::All { areas, .. }) => {
            let bytes = areas.first().map_or(&[][..], Vec::as_slice);
            // The area may have become shorter since the partner began.
            match place(call, 7, Access::Write) {
                Ok(Some(place)) if bytes.len() <= place.bytes as usize => {
                    call.cpu.memory.load(place.offset, bytes);
                    call.set_word(6, bytes.len() as u16);
                    OK
                }
                Ok(_) => Outcome::RetVal(status::AREA),
                Err(code) => Outcome::RetVal(code),
            }
        }
        Ok(Arrived::Some) => Outcome::RetVal(status::ARRIVING),
        Ok(Arrived::Nothing) => Outcome::RetVal(status::RUNNING),
        Err(code) => Outcome::RetVal(code),
    }
}

/// EN_R, ID, R_ID, HANDLE; the new handle is parameter 5.
fn arrived(call: &Call, kind: Kind, room: usize) -> Result<Arrived, u16> {
    let enabled = call.byte(0) & 1 != 0;
    let slot = Slot { kind, r_id: call.dword(2), handle: call.dword(3) };
    let (handle, arrived) = call.cpu.partners.receive(call.word(1), slot, &Receive { enabled, room });
    call.set_dword(5, handle);
    if enabled {
        call.cpu.connections().note_waiting();
    }
    arrived
}

fn begin(call: &Call, job: usize, id: u16, work: Result<Work, u16>) -> Outcome {
    match work.and_then(|work| call.cpu.partners.start(id, work)) {
        Ok(number) => {
            call.set_dword(job, number);
            call.cpu.connections().note_waiting();
            OK
        }
        Err(code) => Outcome::RetVal(code),
    }
}

/// The areas from parameter `first` on, up to the first that is empty. `Err`: STATUS.
fn areas<T>(call: &Call, first: usize, area: impl Fn(usize) -> Result<T, u16>) -> Result<Vec<T>, u16> {
    let is_given = |index: &usize| {
        let head = call.any(*index).head;
        head >> 16 & 0xFF != 0 && head & 0xFFFF != 0
    };
    let found: Vec<T> = (first..first + AREAS_MAX).take_while(is_given).map(area).collect::<Result<_, _>>()?;
    if found.is_empty() { Err(status::AREA) } else { Ok(found) }
}

/// The partner's area that an ANY names. `Err`: STATUS.
fn remote(any: Fields) -> Result<Remote, u16> {
    let (code, count) = ((any.head >> 16) as u8, (any.head & 0xFFFF) as u16);
    let (kind, address) = ((any.pointer >> 24) as u8, any.pointer & 0x00FF_FFFF);
    if any.head >> 24 != 0x10 {
        return Err(status::AREA);
    }
    // Timers and counters have a number in place of a pointer.
    let kind = if kind == 0 && matches!(code, COUNTERS | TIMERS) { code } else { kind };
    let (transport, count) = match (code, kind) {
        (COUNTERS, COUNTERS) | (TIMERS, TIMERS) => (code, count),
        (BIT, area::P | area::I | area::Q | area::M | area::DB | area::DI) if count == 1 => (BIT, 1),
        (_, area::P | area::I | area::Q | area::M | area::DB | area::DI) => {
            let bytes = plcc_abi::any::decode(any, 0, Access::Read).ok().flatten().ok_or(status::AREA)?.bytes;
            (BYTES, u16::try_from(bytes).map_err(|_| status::AREA)?)
        }
        _ => return Err(status::AREA),
    };
    Ok(Remote { transport, count, db: any.db, area: kind, address })
}

/// Data of the program: where it is.
struct Local {
    offset: u32,
    bytes: u32,
    /// One bit.
    bit: Option<u8>,
}

impl Local {
    fn read(&self, call: &Call) -> Data {
        match self.bit {
            Some(bit) => Data { is_bit: true, bytes: vec![u8::from(call.cpu.memory.bit(self.offset, bit))] },
            None => Data { is_bit: false, bytes: call.cpu.memory.view(self.offset, self.bytes, <[u8]>::to_vec) },
        }
    }
}

/// What parameter `index` points to; `None`: nothing. `Err`: STATUS.
fn place(call: &Call, index: usize, access: Access) -> Result<Option<Local>, u16> {
    let any = call.any(index);
    if any.head == 0x1000_0000 | u32::from(BIT) << 16 | 1 {
        let is_db = matches!((any.pointer >> 24) as u8, area::DB | area::DI);
        if access == Access::Write && is_db && call.cpu.is_read_only(any.db) {
            return Err(status::LOCAL_ACCESS);
        }
        if access == Access::Write && (any.pointer >> 24) as u8 == area::Q {
            call.cpu.note_outputs(u32::MAX);
        }
        let (offset, bit) = variants::bit_place(call, any).ok_or(status::LOCAL_ACCESS)?;
        return Ok(Some(Local { offset, bytes: 1, bit: Some(bit) }));
    }
    let wrong = |code: u16| if DB_ERRORS.contains(&(code & 0xFF)) { status::LOCAL_ACCESS } else { status::AREA };
    let Some(range) = any::decode(call, index, access).map_err(wrong)? else { return Ok(None) };
    if range.existing < range.bytes {
        return Err(status::LOCAL_ACCESS);
    }
    Ok(Some(Local { offset: range.offset, bytes: range.bytes, bit: None }))
}

/// Both sides have the same length.
fn fits(remote: &Remote, local: Option<&Local>) -> Result<(), u16> {
    match local {
        Some(local) if remote.bytes() == local.bytes as usize && (remote.transport == BIT) == local.bit.is_some() => {
            Ok(())
        }
        _ => Err(status::AREA),
    }
}

/// Writes areas to the parameters from `first` on, all or none. Result: STATUS.
fn store(call: &Call, first: usize, areas: &[Vec<u8>]) -> u16 {
    let places: Result<Vec<_>, u16> = (first..first + AREAS_MAX)
        .zip(areas)
        .map(|(index, bytes)| match place(call, index, Access::Write)? {
            Some(local) if local.bytes as usize == bytes.len() => Ok(local),
            _ => Err(status::AREA),
        })
        .collect();
    let places = match places {
        // A further area has nothing to take.
        Ok(places) if areas.len() <= AREAS_MAX => places,
        Ok(_) => return status::AREA,
        Err(code) => return code,
    };
    for (local, bytes) in places.iter().zip(areas) {
        match (local.bit, bytes.as_slice()) {
            (Some(bit), &[value]) => call.cpu.memory.set_bit(local.offset, bit, value & 1 != 0),
            (Some(_), _) => {}
            (None, bytes) => call.cpu.memory.load(local.offset, bytes),
        }
    }
    status::DONE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timers_and_counters_of_a_partner_are_numbers() {
        for transport in [TIMERS, COUNTERS] {
            let any = Fields { head: 0x1000_0002 | u32::from(transport) << 16, db: 0, pointer: 3 };
            assert_eq!(remote(any), Ok(Remote { transport, count: 2, db: 0, area: transport, address: 3 }));
        }
    }
}
