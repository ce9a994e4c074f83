//! What the data logs, recipes and files of the library leave to the runtime: jobs. RET_VAL is a STATUS.
//!
//! Source: S7-1200 reference, data logging, recipes; TIA Portal help, file handling.

use plcc_abi::layout::area;

use super::any::{self, Access};
use super::parameters::Call;
use super::{Outcome, error, text};
use crate::assertion::windows_1252;
use crate::records::fields::Unfit;
use crate::records::logs::{Definition, status};
use crate::records::recipes::{self, Place};
use crate::records::{Job, fields};

const STARTED: u16 = 0x7001;
const RUNNING: u16 = 0x7002;
/// The job is no longer known.
const LOST: u16 = 0x807F;
const NO_ROOM: u16 = 0x8070;
const NAME_TYPE: u16 = 0x8091;
const FORMAT: u16 = 0x8353;
const TIMESTAMP: u16 = 0x8453;
const HEADER_TYPE: u16 = 0x8B51;
const DATA_AREA: u16 = 0x8C24;
const DATA_TYPE: u16 = 0x8C51;
const DATA_COUNT: u16 = 0x8C52;
/// Of FileReadC, FileWriteC.
const LENGTH: u16 = 0x8095;

fn result<T>(result: Result<T, u16>, good: impl FnOnce(T) -> u16) -> Outcome {
    match result {
        Ok(value) => Outcome::RetVal(good(value)),
        Err(code) => error(code),
    }
}

/// Asks for a job; parameter `number` gets its number.
fn ask(call: &Call, number: usize, job: Result<Job, u16>) -> Outcome {
    let asked = job.and_then(|job| call.cpu.record_jobs().ask(job).ok_or(NO_ROOM));
    result(asked, |job| {
        call.set_dword(number, job);
        STARTED
    })
}

/// The STRING that parameter `index` points to.
fn name(call: &Call, index: usize) -> Result<String, u16> {
    let characters = text::characters(call, index).ok_or(NAME_TYPE)?;
    Ok(unicode(characters.characters()))
}

fn unicode(characters: &[u8]) -> String {
    let units: Vec<u16> = characters.iter().map(|&byte| windows_1252(byte.into())).collect();
    String::from_utf16_lossy(&units)
}

/// A variable of a data block that exists as a whole; `unlinked`: also one in load memory only.
fn place(call: &Call, index: usize, unlinked: bool) -> Option<Place> {
    let pointer = call.any(index);
    if !matches!((pointer.pointer >> 24) as u8, area::DB | area::DI) || pointer.pointer & 7 != 0 {
        return None;
    }
    let (db, start) = (pointer.db, pointer.pointer >> 3 & 0xFFFF);
    if call.cpu.memory.db(db).1 == 0 && unlinked {
        let length = call.cpu.stored(db)?.len() as u32;
        return (start < length).then_some(Place { db, start, bytes: length - start });
    }
    let range = any::decode(call, index, Access::Read).ok()??;
    (range.existing == range.bytes).then_some(Place { db, start, bytes: range.bytes })
}

/// JOB -> RET_VAL: 7002 not done yet, else the STATUS of the end; VALUE.
pub(super) fn job_state(call: &Call) -> Outcome {
    let job = call.dword(0);
    let mut records = call.cpu.record_jobs();
    if records.waits(job) {
        return Outcome::RetVal(RUNNING);
    }
    let Some(done) = records.take(job) else { return error(LOST) };
    call.set_dword(2, done.value);
    Outcome::RetVal(done.status)
}

/// As [`job_state`], and DATA takes the bytes of the file.
pub(super) fn job_bytes(call: &Call) -> Outcome {
    let job = call.dword(0);
    let mut records = call.cpu.record_jobs();
    if records.waits(job) {
        return Outcome::RetVal(RUNNING);
    }
    let Some(done) = records.take(job) else { return error(LOST) };
    if done.status & 0x8000 == 0 {
        match any::decode(call, 3, Access::Write) {
            Ok(Some(range)) if range.existing as usize >= done.bytes.len() => {
                call.cpu.memory.load(range.offset, &done.bytes);
            }
            _ => return error(LENGTH),
        }
        call.set_dword(2, done.value);
    }
    Outcome::RetVal(done.status)
}

/// RECORDS, FORMAT, TIMESTAMP, FILE, HEADER, DATA -> RET_VAL, JOB.
pub(super) fn log_create(call: &Call) -> Outcome {
    ask(call, 7, created(call))
}

fn created(call: &Call) -> Result<Job, u16> {
    let name = name(call, 3)?;
    if call.word(1) != 1 {
        return Err(FORMAT);
    }
    if call.word(2) > 1 {
        return Err(TIMESTAMP);
    }
    let place = place(call, 5, false).ok_or(DATA_AREA)?;
    let Place { db, start, bytes } = place;
    let header = header(call)?;
    let definition = Definition { db, start, bytes, records: call.dword(0), stamped: call.word(2) == 1, header };
    let width = width(call, &definition)?;
    Ok(Job::CreateLog { name, definition, width })
}

/// Characters of the longest record.
fn width(call: &Call, definition: &Definition) -> Result<u64, u16> {
    let fields = definition.fields(&call.cpu.image.shapes).map_err(|unfit| match unfit {
        Unfit::Types => DATA_TYPE,
        Unfit::TooMany => DATA_COUNT,
    })?;
    Ok(fields.iter().map(fields::Field::width_max).sum())
}

/// HEADER: a STRING, or characters up to the first zero; nothing if it points to nothing.
fn header(call: &Call) -> Result<String, u16> {
    const STRING: u8 = any::STRING;
    const BYTE_AND_CHAR: [u8; 2] = [0x02, 0x03];
    let Some(range) = any::decode(call, 4, Access::Read).map_err(|_| HEADER_TYPE)? else { return Ok(String::new()) };
    let text = match range.type_code {
        STRING => name(call, 4).map_err(|_| HEADER_TYPE)?,
        code if BYTE_AND_CHAR.contains(&code) => call
            .cpu
            .memory
            .view(range.offset, range.existing, |bytes| unicode(bytes.split(|&byte| byte == 0).next().unwrap_or(&[]))),
        _ => return Err(HEADER_TYPE),
    };
    Ok(text.replace(char::is_control, " ").trim().to_string())
}

/// MODE, FILE -> RET_VAL, JOB.
pub(super) fn log_open(call: &Call) -> Outcome {
    let job = name(call, 1).map(|name| Job::OpenLog { name, clear: call.word(0) == 1 });
    ask(call, 3, job)
}

const WRITE: u8 = 1;
const CLOSE: u8 = 2;
const CLEAR: u8 = 3;

/// ACTION (1 write, 2 close, 3 clear), ID -> RET_VAL, JOB. A record has the values and the time of this call.
pub(super) fn log_action(call: &Call) -> Outcome {
    let id = call.dword(1);
    let job = match call.byte(0) {
        WRITE => record(call, id).map(|record| Job::WriteLog { id, record }),
        CLOSE => Ok(Job::CloseLog { id }),
        CLEAR => Ok(Job::ClearLog { id }),
        _ => Err(LOST),
    };
    ask(call, 3, job)
}

fn record(call: &Call, id: u32) -> Result<String, u16> {
    let mut records = call.cpu.record_jobs();
    let definition = &records.logs.find(id).ok_or(status::MISSING)?.definition;
    let (address, length) = call.cpu.memory.db(definition.db);
    if definition.start + definition.bytes > length {
        return Err(DATA_AREA);
    }
    let wall = call.cpu.clock.wall();
    Ok(call.cpu.memory.view(address + definition.start, definition.bytes, |data| {
        definition.record(&call.cpu.image.shapes, data, wall)
    }))
}

/// RECORDS, FILE, ID -> RET_VAL, JOB.
pub(super) fn log_new(call: &Call) -> Outcome {
    let id = call.dword(2);
    let job = name(call, 1).and_then(|name| {
        let definition = call.cpu.record_jobs().logs.find(id).map(|log| log.definition.clone());
        let width = width(call, &definition.ok_or(status::MISSING)?)?;
        Ok(Job::NewLog { id, name, records: call.dword(0), width })
    });
    ask(call, 4, job)
}

/// FILE, WITH_FILE, ID -> RET_VAL, JOB.
pub(super) fn log_delete(call: &Call) -> Outcome {
    let with_file = call.byte(1) & 1 != 0;
    ask(call, 4, name(call, 0).map(|name| Job::DeleteLog { name, id: call.dword(2), with_file }))
}

/// IMPORT, DATA -> RET_VAL, JOB.
pub(super) fn recipes(call: &Call) -> Outcome {
    let place = place(call, 1, true).ok_or(recipes::status::STRUCTURE);
    let job = if call.byte(0) & 1 != 0 { Job::ImportRecipes } else { Job::ExportRecipes };
    ask(call, 3, place.map(job))
}

/// Bytes that LEN, parameter `length`, names of DATA, parameter `data`; 0: all of it.
fn part(call: &Call, length: usize, data: usize, access: Access) -> Result<(u32, u32), u16> {
    let range = any::decode(call, data, access).ok().flatten().ok_or(LENGTH)?;
    let bytes = if call.dword(length) == 0 { range.bytes } else { call.dword(length) };
    if bytes > range.existing { Err(LENGTH) } else { Ok((range.offset, bytes)) }
}

/// FILE, OFFSET, LEN, DATA -> RET_VAL, JOB.
pub(super) fn file_read(call: &Call) -> Outcome {
    let job = name(call, 0).and_then(|name| {
        let (_, count) = part(call, 2, 3, Access::Write)?;
        Ok(Job::ReadFile { name, offset: call.dword(1), count })
    });
    ask(call, 5, job)
}

/// FILE, OFFSET, LEN, DATA -> RET_VAL, JOB: the bytes are those of this call.
pub(super) fn file_write(call: &Call) -> Outcome {
    let job = name(call, 0).and_then(|name| {
        let (offset, count) = part(call, 2, 3, Access::Read)?;
        let bytes = call.cpu.memory.view(offset, count, <[u8]>::to_vec);
        Ok(Job::WriteFile { name, offset: call.dword(1), bytes })
    });
    ask(call, 5, job)
}

/// FILE -> RET_VAL, JOB.
pub(super) fn file_delete(call: &Call) -> Outcome {
    ask(call, 2, name(call, 0).map(|name| Job::DeleteFile { name }))
}
