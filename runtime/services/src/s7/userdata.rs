//! Userdata: status lists, blocks, clock, passwords, cyclic services.

use std::time::Instant;

use super::cyclic::{self, CYCLIC, ON_CHANGE, UNSUBSCRIBE};
use super::plc::{BLOCK_KINDS, DateAndTime, Plc};
use super::session::{Session, USERDATA, userdata_pdu};
use super::status_lists;
use super::variables::{Refused, WRONG_PDU};
use super::watch_list;
use crate::wire::{Bytes, put16};

/// Groups of functions.
const TEST: u8 = watch_list::GROUP;
const BLOCKS: u8 = 3;
const CPU: u8 = 4;
const SECURITY: u8 = 5;
const TIME: u8 = 7;

/// Error words.
const NOT_IMPLEMENTED: u16 = 0x8104;
const NO_INFORMATION: u16 = 0xD406;
const NO_FURTHER_BLOCK: u16 = 0xD20E;
const BLOCK_MISSING: u16 = 0xD209;
const BLOCK_NUMBER: u16 = 0xD210;
const NOT_PERMITTED: u16 = 0xD241;
const WRONG_DATE: u16 = 0xDC01;
const TEST_NOT_PERMITTED: u16 = 0xD0A1;
const NO_SUCH_TEST: u16 = 0xD043;

/// Test functions that end a job or tell of jobs, and the one that makes a LED flash.
const DELETE_TEST: u8 = 0x0F;
const ENABLE_TEST: u8 = 0x0E;
const LIST_TESTS: u8 = 0x10;
const FLASH_LED: u8 = 0x16;

const PASSWORD_BYTES: usize = 8;

/// Head and parameter of an answer, and the head of its data.
const AROUND: usize = 10 + 12 + 4;

/// The rest of an answer that does not fit into one PDU.
#[derive(Debug)]
pub struct Pending {
    group: u8,
    function: u8,
    sequence: u8,
    rest: Vec<u8>,
}

/// A request.
struct Request<'a> {
    group: u8,
    function: u8,
    sequence: u8,
    /// It asks for the rest of an answer.
    follows: bool,
    payload: &'a [u8],
}

impl<'a> Request<'a> {
    fn read(mut parameter: Bytes<'a>, mut data: Bytes<'a>) -> Option<Request<'a>> {
        let [0, 1, 0x12, length, method, kind, function, sequence] = parameter.array::<8>()? else { return None };
        let follows = match (length, method, parameter.len()) {
            (4, 0x11, 0) => false,
            (8, 0x12, 4) => true,
            _ => return None,
        };
        let [_, _, high, low] = data.array::<4>()?;
        let payload = data.take(usize::from(u16::from_be_bytes([high, low])))?;
        // The upper two bits say that it is a request.
        let (direction, group) = (kind >> 6, kind & 0x3F);
        (direction == 1).then_some(Request { group, function, sequence, follows, payload })
    }
}

/// The password that a PDU sends, without the blanks after it.
pub fn password(pdu: &[u8]) -> Option<Vec<u8>> {
    /// With which each character is mixed.
    const MASK: u8 = 0x55;
    let mut rest = Bytes(pdu);
    let [_, USERDATA, _, _, _, _, high, low, ..] = rest.array::<10>()? else { return None };
    let parameter = rest.take(u16::from_be_bytes([high, low]).into())?;
    let request = Request::read(Bytes(parameter), rest)?;
    let coded: &[u8; PASSWORD_BYTES] = request.payload.try_into().ok()?;
    if (request.group, request.function, request.follows) != (SECURITY, 1, false) {
        return None;
    }
    // Each character is also mixed with the coded one before the last.
    let plain = |index: usize| coded[index] ^ MASK ^ index.checked_sub(2).map_or(0, |before| coded[before]);
    let mut password: Vec<u8> = (0..PASSWORD_BYTES).map(plain).collect();
    while password.last() == Some(&b' ') {
        password.pop();
    }
    Some(password)
}

/// The answer to a request: its payload, or an error word.
type Payload = Result<Vec<u8>, u16>;

/// Answers a PDU of userdata.
pub fn answer(
    session: &mut Session,
    reference: [u8; 2],
    parameter: Bytes,
    data: Bytes,
    plc: &dyn Plc,
) -> Result<Vec<u8>, Refused> {
    let Some(request) = Request::read(parameter, data) else { return Err(Refused(WRONG_PDU)) };
    let Some(pdu) = session.pdu else { return Err(Refused(NOT_IMPLEMENTED)) };
    let capacity = usize::from(pdu) - AROUND;
    let Request { group, function, .. } = request;
    // The answer to a subscription has the number of its job.
    let sequence = if request.follows { request.sequence } else { session.next_sequence() };
    let payload = if request.follows {
        match session.pending.take().filter(|pending| {
            (pending.group, pending.function, pending.sequence) == (group, function, request.sequence)
        }) {
            Some(pending) => Ok(pending.rest),
            None => Err(NO_INFORMATION),
        }
    } else {
        session.pending = None;
        first(session, &request, sequence, plc)
    };
    let (error, mut payload) = match payload {
        Ok(payload) => (0, payload),
        Err(error) => (error, Vec::new()),
    };
    let more = payload.len() > capacity;
    if more {
        let rest = payload.split_off(capacity);
        session.pending = Some(Pending { group, function, sequence, rest });
    }
    let several = more || request.follows;
    let mut parameter = vec![0, 1, 0x12, 8, 0x12, 0x80 | group, function, sequence];
    parameter.extend([u8::from(several), u8::from(more)]);
    put16(&mut parameter, error);
    let mut data = if payload.is_empty() { vec![0x0A, 0] } else { vec![0xFF, 9] };
    put16(&mut data, payload.len() as u16);
    data.extend(payload);
    Ok(userdata_pdu(reference, &parameter, &data))
}

impl Session {
    /// From 1 to 255, then from 1 again, without those of cyclic jobs.
    fn next_sequence(&mut self) -> u8 {
        loop {
            self.sequence = self.sequence % 255 + 1;
            if self.subscriptions.is_free(self.sequence) && self.watched.is_free(self.sequence) {
                return self.sequence;
            }
        }
    }
}

fn first(session: &mut Session, request: &Request, sequence: u8, plc: &dyn Plc) -> Payload {
    let payload = request.payload;
    match (request.group, request.function) {
        (CPU, 1) => match payload {
            &[id_high, id_low, index_high, index_low] => {
                let (id, index) = (u16::from_be_bytes([id_high, id_low]), u16::from_be_bytes([index_high, index_low]));
                match session.may_read() || status_lists::identifies(id) {
                    true => status_lists::read(plc, session.levels(), id, index),
                    false => Err(NOT_IMPLEMENTED),
                }
            }
            _ => Err(status_lists::WRONG_REQUEST),
        },
        // Under complete protection a client learns what CPU it is, and may send a password.
        (BLOCKS | TIME | TEST, _) if !session.may_read() => Err(NOT_IMPLEMENTED),
        // It is not seen, and nothing else comes of it.
        (TEST, FLASH_LED) => Ok(Vec::new()),
        (TEST, watch_list::FUNCTION) => {
            let pdu = session.pdu.ok_or(NOT_IMPLEMENTED)?;
            session.watched.take(plc, pdu, sequence, payload)
        }
        // Test jobs end before the client could ask for them.
        (TEST, LIST_TESTS) => Ok(vec![0, 0]),
        (TEST, DELETE_TEST | ENABLE_TEST) => Err(NO_SUCH_TEST),
        (TEST, _) if !session.may_write() => Err(TEST_NOT_PERMITTED),
        (TEST, _) => Err(watch_list::UNSUPPORTED),
        (cyclic::GROUP, CYCLIC | ON_CHANGE) if !session.may_read() => Err(NOT_IMPLEMENTED),
        (cyclic::GROUP, function @ (CYCLIC | ON_CHANGE)) => {
            let pdu = session.pdu.ok_or(NOT_IMPLEMENTED)?;
            session.subscriptions.subscribe(plc, pdu, (sequence, function), payload, Instant::now())
        }
        (cyclic::GROUP, UNSUBSCRIBE) => session.subscriptions.unsubscribe(payload).map(|()| Vec::new()),
        // Messages are not sent.
        (CPU, 2) => Ok(vec![2, 0]),
        (CPU, 0x13) => Ok(vec![0, 1, 0x0A, 0, 0, 0]),
        (BLOCKS, 1) => Ok(block_counts(plc)),
        (BLOCKS, 2) => blocks_of_kind(plc, payload),
        (BLOCKS, 3) => block_info(plc, payload),
        (SECURITY, 1) => session.legitimate().map(|()| Vec::new()),
        (SECURITY, 2) => session.forget_password().map(|()| Vec::new()),
        (TIME, 1 | 3) => Ok(clock(plc.clock())),
        (TIME, 2 | 4) if !session.may_control() => Err(NOT_PERMITTED),
        (TIME, 2 | 4) => {
            match payload.strip_prefix(&[0]).and_then(|rest| rest.get(1..)).and_then(|time| time.try_into().ok()) {
                Some(time) if plc.set_clock(time) => Ok(Vec::new()),
                Some(_) | None => Err(WRONG_DATE),
            }
        }
        _ => Err(NOT_IMPLEMENTED),
    }
}

fn block_counts(plc: &dyn Plc) -> Vec<u8> {
    let mut payload = Vec::new();
    for kind in BLOCK_KINDS {
        payload.extend([0x30, code_letter(kind)]);
        put16(&mut payload, plc.blocks(kind).len() as u16);
    }
    payload
}

/// The letter by which a kind of block is named: `0A` is `A`.
fn code_letter(kind: u8) -> u8 {
    match kind {
        0..=9 => b'0' + kind,
        _ => b'A' + (kind - 10),
    }
}

fn kind_of(letter: u8) -> Option<u8> {
    let kind = match letter {
        b'0'..=b'9' => letter - b'0',
        b'A'..=b'F' => letter - b'A' + 10,
        _ => return None,
    };
    BLOCK_KINDS.contains(&kind).then_some(kind)
}

/// The language of blocks of a kind, as lists have it: an executable does not know what a block was written in.
fn language_of(kind: u8) -> u8 {
    const UNKNOWN: u8 = 0;
    const DATA_BLOCK: u8 = 5;
    if kind == 0x0A { DATA_BLOCK } else { UNKNOWN }
}

fn blocks_of_kind(plc: &dyn Plc, payload: &[u8]) -> Payload {
    let &[0x30, letter] = payload else { return Err(NO_FURTHER_BLOCK) };
    let kind = kind_of(letter).ok_or(NO_FURTHER_BLOCK)?;
    let mut list = Vec::new();
    for number in plc.blocks(kind) {
        put16(&mut list, number);
        // Linked; its language.
        list.extend([0x01, language_of(kind)]);
    }
    if list.is_empty() { Err(NO_FURTHER_BLOCK) } else { Ok(list) }
}

fn block_info(plc: &dyn Plc, payload: &[u8]) -> Payload {
    let &[0x30, letter, ref number @ .., _system] = payload else { return Err(BLOCK_NUMBER) };
    let digits =
        std::str::from_utf8(number).ok().filter(|text| text.len() == 5 && text.bytes().all(|b| b.is_ascii_digit()));
    let number: u16 = digits.and_then(|text| text.parse().ok()).ok_or(BLOCK_NUMBER)?;
    let kind = kind_of(letter).ok_or(BLOCK_MISSING)?;
    let info = plc.block(kind, number).ok_or(BLOCK_MISSING)?;
    let text = |text: &str| {
        let mut bytes = [0u8; 8];
        text.bytes().filter(u8::is_ascii_graphic).zip(&mut bytes).for_each(|(byte, place)| *place = byte);
        bytes
    };
    let mut out = vec![0x30, letter];
    put16(&mut out, 0x004A);
    out.extend([0, 0x22, b'p', b'p', 1]);
    out.push(0x01);
    out.push(language_of(kind));
    out.push(kind);
    put16(&mut out, info.number);
    out.extend((u32::from(info.bytes) + 92).to_be_bytes());
    out.extend([0; 4]);
    // Dates of code and interface.
    out.extend([0; 12]);
    out.extend([0; 4]);
    put16(&mut out, info.local_data);
    put16(&mut out, info.bytes);
    out.extend(text("plcc"));
    out.extend(text(""));
    out.extend(text(&info.name));
    out.extend([0x10, 0]);
    out.extend([0; 10]);
    Ok(out)
}

/// The ten bytes of the clock: 0, century, then DATE_AND_TIME.
fn clock(time: DateAndTime) -> Vec<u8> {
    // Years from 90 on are of the last century.
    let century = if time[0] >= 0x90 { 0x19 } else { 0x20 };
    let mut out = vec![0, century];
    out.extend(time);
    out
}
