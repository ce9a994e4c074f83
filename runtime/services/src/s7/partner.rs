//! Jobs of the program for a partner, and what the partner sends: PUT, GET, USEND and URCV, BSEND and BRCV as PDUs.
//!
//! Everything here is a function of bytes and the [`Board`], on which blocks leave their jobs.
//! Source: System and standard functions, SFB 8 to 15; captures of CPUs.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use plcc_runtime::partners::{BIT, Board, COUNTERS, Data, Ended, NotTaken, Remote, TIMERS, Work, status};

use super::session::{ACK, ACK_DATA, JOB, PROTOCOL, USERDATA};
use super::variables::{BIT as DATA_BIT, INTEGER, OCTETS, READ, SUCCESS, WORDS, WRITE};
use crate::limits::{PARTNER_JOBS_MAX, PARTNER_TIME, TRANSFERS_MAX};
use crate::wire::{Bytes, put16};

/// Head of a job; head of an answer.
const JOB_HEAD: usize = 10;
const ANSWER_HEAD: usize = 12;
/// Function and number of items.
const PARAMETER: usize = 2;
const ITEM: usize = 12;
const DATA_HEAD: usize = 4;

/// Groups of userdata with their direction, and what identifies a R_ID in them.
const SEND: u8 = 0x46;
const SENT: u8 = 0x86;
const R_ID: [u8; 3] = [0x12, 6, 0x13];
/// Head and parameter of a segment of BSEND, then the head of its data, then R_ID.
const SEGMENT_AROUND: usize = 10 + 12 + 4 + 8;

/// Error words of segments.
const SERVICE_UNKNOWN: u16 = 0x8104;
const WRONG_STATE: u16 = 0x8402;
const NOT_READY: u16 = 0x8404;
const BLOCK_DISABLED: u16 = 0x8405;
const WRONG_LENGTH: u16 = 0x8500;
const TOO_LONG: u16 = 0x8701;
const DAMAGED: u16 = 0x8704;

/// The partner does not keep to the protocol, or answers too late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Broken;

/// What becomes of a PDU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It was for the program, and these are sent.
    Own(Vec<Vec<u8>>),
    /// A request of the partner.
    Request,
}

/// A job whose answer is missing.
struct Running {
    number: u32,
    reference: [u8; 2],
    until: Instant,
    what: What,
}

enum What {
    Read(Vec<Remote>),
    Write(usize),
    Block(Sending),
}

/// A block on its way.
struct Sending {
    r_id: u32,
    bytes: Vec<u8>,
    sent: usize,
    segments: u8,
}

/// A block that arrives.
struct Arriving {
    bytes: Vec<u8>,
    total: usize,
    sequence: u8,
    until: Instant,
}

/// A connection to a partner that is up.
pub struct Partner {
    board: Arc<Board>,
    line: usize,
    turn: u64,
    /// The longest PDU.
    pdu: usize,
    jobs_max: usize,
    reference: u16,
    sequence: u8,
    running: Vec<Running>,
    arriving: HashMap<u32, Arriving>,
}

impl Drop for Partner {
    fn drop(&mut self) {
        self.board.leave(self.line, self.turn);
    }
}

impl Partner {
    /// `jobs`: how many the partner answers at once. `wake`: tells that there is something to do.
    pub fn new(board: Arc<Board>, line: usize, pdu: u16, jobs: u16, wake: impl Fn() + Send + 'static) -> Partner {
        let turn = board.join(line, Box::new(wake));
        Partner {
            board,
            line,
            turn,
            pdu: pdu.into(),
            jobs_max: usize::from(jobs).clamp(1, PARTNER_JOBS_MAX),
            reference: 0,
            sequence: 0,
            running: Vec::new(),
            arriving: HashMap::new(),
        }
    }

    /// When it has to be looked at again, if nothing comes before.
    pub fn deadline(&self) -> Option<Instant> {
        let arriving = self.arriving.values().map(|block| block.until);
        self.running.iter().map(|job| job.until).chain(arriving).min()
    }

    /// What is to be sent now, besides answers.
    pub fn work(&mut self, now: Instant) -> Result<Vec<Vec<u8>>, Broken> {
        if !self.board.is_current(self.line, self.turn) || self.running.iter().any(|job| job.until <= now) {
            return Err(Broken);
        }
        let late: Vec<u32> = self.arriving.iter().filter(|(_, block)| block.until <= now).map(|(id, _)| *id).collect();
        for r_id in late {
            self.arriving.remove(&r_id);
            self.board.drop_block(self.line, r_id);
        }
        let mut out = Vec::new();
        while self.running.len() < self.jobs_max
            && let Some((number, work)) = self.board.next(self.line, self.turn)
        {
            match self.begin(number, work, now) {
                Ok(pdu) => out.push(pdu),
                Err(code) => self.board.finish(number, Err(code)),
            }
        }
        Ok(out)
    }

    /// The first PDU of a job. `Err`: STATUS.
    fn begin(&mut self, number: u32, work: Work, now: Instant) -> Result<Vec<u8>, u16> {
        let reference = self.next_reference();
        let (pdu, what) = match work {
            Work::Read(items) => {
                let parameter = parameter(READ, &items);
                let answer: usize = items.iter().map(|item| DATA_HEAD + even(item.bytes())).sum();
                // The last one is not filled up.
                let odd = items.last().map_or(0, |item| item.bytes() % 2);
                if ANSWER_HEAD + PARAMETER + answer - odd > self.pdu {
                    return Err(status::AREA);
                }
                (job(reference, &parameter, &[]), Some(What::Read(items)))
            }
            Work::Write(items) => {
                let (remotes, values): (Vec<Remote>, Vec<Data>) = items.into_iter().unzip();
                let mut data = Vec::new();
                for (index, (remote, value)) in remotes.iter().zip(&values).enumerate() {
                    put_data(&mut data, remote, &value.bytes, index + 1 < remotes.len());
                }
                let count = remotes.len();
                (job(reference, &parameter(WRITE, &remotes), &data), Some(What::Write(count)))
            }
            Work::Message(r_id, areas) => (message(reference, r_id, &areas), None),
            Work::Block(r_id, bytes) => {
                let mut sending = Sending { r_id, bytes, sent: 0, segments: 0 };
                (self.segment(&mut sending, reference, 0), Some(What::Block(sending)))
            }
        };
        if pdu.len() > self.pdu {
            return Err(status::AREA);
        }
        match what {
            Some(what) => self.running.push(Running { number, reference, until: now + PARTNER_TIME, what }),
            // It is not answered.
            None => self.board.finish(number, Ok(Vec::new())),
        }
        Ok(pdu)
    }

    fn next_reference(&mut self) -> [u8; 2] {
        self.reference = self.reference.wrapping_add(1);
        self.reference.to_be_bytes()
    }

    /// The next segment of a block. `sequence`: as the receiver wants it.
    fn segment(&self, sending: &mut Sending, reference: [u8; 2], sequence: u8) -> Vec<u8> {
        let first = sending.sent == 0;
        let room = self.pdu - SEGMENT_AROUND - if first { 2 } else { 0 };
        let rest = &sending.bytes[sending.sent..];
        let piece = &rest[..rest.len().min(room)];
        let more = piece.len() < rest.len();
        let several = more || !first;
        sending.segments = if several { sending.segments.wrapping_add(1).max(1) } else { 0 };
        let parameter = [0, 1, 0x12, 8, 0x12, SEND, 1, sequence, sending.segments, u8::from(more), 0, 0];
        let mut payload = R_ID.to_vec();
        payload.push(0);
        payload.extend(sending.r_id.to_be_bytes());
        if first {
            put16(&mut payload, sending.bytes.len() as u16);
        }
        payload.extend(piece);
        let mut data = vec![0xFF, 9];
        put16(&mut data, payload.len() as u16);
        data.extend(payload);
        sending.sent += piece.len();
        userdata(reference, &parameter, &data)
    }

    /// A PDU of the partner.
    pub fn take(&mut self, pdu: &[u8], now: Instant) -> Result<Taken, Broken> {
        let mut rest = Bytes(pdu);
        let [protocol, kind, _, _, r0, r1, p0, p1, d0, d1] = rest.array::<10>().ok_or(Broken)?;
        if protocol != PROTOCOL {
            return Err(Broken);
        }
        let reference = [r0, r1];
        let (parameters, data) = (usize::from(u16::from_be_bytes([p0, p1])), usize::from(u16::from_be_bytes([d0, d1])));
        let error = match kind {
            ACK | ACK_DATA => rest.u16().ok_or(Broken)?,
            JOB => return Ok(Taken::Request),
            USERDATA => 0,
            _ => return Err(Broken),
        };
        if parameters + data != rest.len() {
            return Err(Broken);
        }
        let parameter = rest.take(parameters).ok_or(Broken)?;
        match (kind, parameter) {
            (USERDATA, [0, 1, 0x12, 6, 0x13, _, r_id @ ..]) => {
                let r_id = u32::from_be_bytes(r_id.try_into().map_err(|_| Broken)?);
                let areas = areas(rest).ok_or(Broken)?;
                self.board.message(self.line, r_id, areas);
                Ok(Taken::Own(Vec::new()))
            }
            (USERDATA, &[0, 1, 0x12, 8, 0x12, SEND, 1, sequence, _, last, _, _]) => {
                let answer = self.arrive(sequence, last == 0, rest, now);
                Ok(Taken::Own(vec![acknowledge_segment(reference, answer)]))
            }
            (USERDATA, &[0, 1, 0x12, 8, 0x12, SENT, 1, sequence, _, _, high, low]) => {
                Ok(Taken::Own(self.go_on(reference, sequence, u16::from_be_bytes([high, low]), now)))
            }
            (USERDATA, _) => Ok(Taken::Request),
            _ => {
                self.answered(reference, error, parameter, rest);
                Ok(Taken::Own(Vec::new()))
            }
        }
    }

    fn remove(&mut self, reference: [u8; 2]) -> Option<Running> {
        let index = self.running.iter().position(|job| job.reference == reference)?;
        Some(self.running.swap_remove(index))
    }

    /// An answer to PUT or GET. An answer that is not awaited has no effect.
    fn answered(&mut self, reference: [u8; 2], error: u16, parameter: &[u8], data: Bytes) {
        let Some(Running { number, what, .. }) = self.remove(reference) else { return };
        let ended = match what {
            _ if error != 0 => Err(status::REFUSED),
            What::Read(items) => read(&items, parameter, data),
            What::Write(count) => written(count, parameter, data),
            What::Block(_) => Err(status::REFUSED),
        };
        self.board.finish(number, ended);
    }

    /// A segment of BSEND was acknowledged.
    fn go_on(&mut self, reference: [u8; 2], sequence: u8, error: u16, now: Instant) -> Vec<Vec<u8>> {
        let Some(mut job) = self.remove(reference) else { return Vec::new() };
        let What::Block(sending) = &mut job.what else {
            self.board.finish(job.number, Err(status::REFUSED));
            return Vec::new();
        };
        if error != 0 {
            self.board.finish(job.number, Err(status_of(error)));
            return Vec::new();
        }
        if sending.sent == sending.bytes.len() {
            self.board.finish(job.number, Ok(Vec::new()));
            return Vec::new();
        }
        if !self.board.is_wanted(job.number) {
            // The receiver forgets what it has, in time.
            return Vec::new();
        }
        job.reference = self.next_reference();
        job.until = now + PARTNER_TIME;
        let What::Block(sending) = &mut job.what else { return Vec::new() };
        let pdu = self.segment(sending, job.reference, sequence);
        self.running.push(job);
        vec![pdu]
    }

    /// A segment of BSEND of the partner: the sequence number to go on with, or an error word.
    fn arrive(&mut self, sequence: u8, last: bool, mut data: Bytes, now: Instant) -> Result<u8, u16> {
        let wrong = WRONG_LENGTH;
        let [_, _, high, low] = data.array::<4>().ok_or(wrong)?;
        let payload = data.take(usize::from(u16::from_be_bytes([high, low]))).ok_or(wrong)?;
        let mut payload = Bytes(payload);
        let [a, b, c, _] = payload.array::<4>().ok_or(wrong)?;
        let r_id = u32::from_be_bytes(payload.array::<4>().ok_or(wrong)?);
        if [a, b, c] != R_ID {
            return Err(wrong);
        }
        let answer = self.segment_of(r_id, sequence, last, payload, now);
        if answer.is_err() {
            self.board.drop_block(self.line, r_id);
        }
        answer
    }

    fn segment_of(&mut self, r_id: u32, sequence: u8, last: bool, mut rest: Bytes, now: Instant) -> Result<u8, u16> {
        let wrong = WRONG_LENGTH;
        let before = self.arriving.remove(&r_id);
        let mut block = if sequence == 0 {
            let total = usize::from(rest.u16().ok_or(wrong)?);
            if self.arriving.len() >= TRANSFERS_MAX {
                return Err(NOT_READY);
            }
            self.board.begin_block(self.line, r_id, total).map_err(error_of)?;
            self.sequence = self.sequence % 255 + 1;
            Arriving { bytes: Vec::new(), total, sequence: self.sequence, until: now }
        } else {
            before.filter(|block| block.sequence == sequence).ok_or(WRONG_STATE)?
        };
        if block.bytes.len() + rest.len() > block.total {
            return Err(wrong);
        }
        block.bytes.extend(rest.0);
        let sequence = block.sequence;
        if last {
            if block.bytes.len() != block.total {
                return Err(wrong);
            }
            self.board.end_block(self.line, r_id, block.bytes).map_err(error_of)?;
        } else {
            block.until = now + PARTNER_TIME;
            self.arriving.insert(r_id, block);
        }
        Ok(sequence)
    }
}

/// The length filled up.
fn even(bytes: usize) -> usize {
    bytes + bytes % 2
}

fn error_of(why: NotTaken) -> u16 {
    match why {
        NotTaken::Unknown => SERVICE_UNKNOWN,
        NotTaken::Disabled => BLOCK_DISABLED,
        NotTaken::Full => WRONG_STATE,
        NotTaken::TooLong => TOO_LONG,
    }
}

/// STATUS of BSEND.
fn status_of(error: u16) -> u16 {
    match error {
        SERVICE_UNKNOWN => status::R_ID_UNKNOWN,
        BLOCK_DISABLED => status::DISABLED,
        WRONG_STATE | NOT_READY => status::NOT_TAKEN,
        TOO_LONG | DAMAGED => status::ACCESS,
        _ => status::REFUSED,
    }
}

fn pdu(kind: u8, reference: [u8; 2], parameter: &[u8], data: &[u8]) -> Vec<u8> {
    let mut pdu = Vec::with_capacity(JOB_HEAD + parameter.len() + data.len());
    pdu.extend([PROTOCOL, kind, 0, 0]);
    pdu.extend(reference);
    put16(&mut pdu, parameter.len() as u16);
    put16(&mut pdu, data.len() as u16);
    pdu.extend(parameter);
    pdu.extend(data);
    pdu
}

pub(super) fn job(reference: [u8; 2], parameter: &[u8], data: &[u8]) -> Vec<u8> {
    pdu(JOB, reference, parameter, data)
}

fn userdata(reference: [u8; 2], parameter: &[u8], data: &[u8]) -> Vec<u8> {
    pdu(USERDATA, reference, parameter, data)
}

fn parameter(function: u8, items: &[Remote]) -> Vec<u8> {
    let mut out = Vec::with_capacity(PARAMETER + ITEM * items.len());
    out.extend([function, items.len() as u8]);
    for item in items {
        out.extend([0x12, 0x0A, 0x10, item.transport]);
        put16(&mut out, item.count);
        put16(&mut out, item.db);
        out.push(item.area);
        out.extend(&item.address.to_be_bytes()[1..]);
    }
    out
}

/// The data of an item. `fills`: further data follows at an even byte.
fn put_data(out: &mut Vec<u8>, remote: &Remote, bytes: &[u8], fills: bool) {
    let (transport, length) = match remote.transport {
        BIT => (DATA_BIT, 1),
        COUNTERS | TIMERS => (OCTETS, bytes.len()),
        _ => (WORDS, 8 * bytes.len()),
    };
    out.extend([0, transport]);
    put16(out, length as u16);
    out.extend(bytes);
    if fills && !bytes.len().is_multiple_of(2) {
        out.push(0);
    }
}

fn message(reference: [u8; 2], r_id: u32, areas: &[Data]) -> Vec<u8> {
    let mut parameter = vec![0, 1, 0x12, 6, 0x13, 0];
    parameter.extend(r_id.to_be_bytes());
    let mut data = vec![0xFF, 0, 0, areas.len() as u8];
    for (index, area) in areas.iter().enumerate() {
        let (transport, length) = if area.is_bit { (DATA_BIT, 1) } else { (OCTETS, area.bytes.len()) };
        data.extend([0, transport]);
        put16(&mut data, length as u16);
        data.extend(&area.bytes);
        if !area.bytes.len().is_multiple_of(2) && index + 1 < areas.len() {
            data.push(0);
        }
    }
    userdata(reference, &parameter, &data)
}

fn acknowledge_segment(reference: [u8; 2], answer: Result<u8, u16>) -> Vec<u8> {
    let mut parameter = vec![0, 1, 0x12, 8, 0x12, SENT, 1, answer.unwrap_or(0), 0, 0];
    put16(&mut parameter, answer.err().unwrap_or(0));
    userdata(reference, &parameter, &[0x0A, 0, 0, 0])
}

/// An item of an answer, or of a message: its code and its bytes.
fn item<'a>(data: &mut Bytes<'a>) -> Option<(u8, &'a [u8])> {
    let [code, transport, high, low] = data.array::<4>()?;
    let length = usize::from(u16::from_be_bytes([high, low]));
    let bytes = if matches!(transport, DATA_BIT | WORDS | INTEGER) { length.div_ceil(8) } else { length };
    let value = data.take(bytes)?;
    // The last one need not be filled up.
    if !bytes.is_multiple_of(2) && !data.is_empty() {
        data.u8()?;
    }
    Some((code, value))
}

fn areas(mut data: Bytes) -> Option<Vec<Vec<u8>>> {
    let [_, _, _, count @ 1..=4] = data.array::<4>()? else { return None };
    let areas = (0..count).map(|_| item(&mut data).map(|(_, bytes)| bytes.to_vec())).collect::<Option<_>>()?;
    data.is_empty().then_some(areas)
}

fn read(items: &[Remote], parameter: &[u8], mut data: Bytes) -> Ended {
    if *parameter != [READ, items.len() as u8] {
        return Err(status::REFUSED);
    }
    let mut values = Vec::with_capacity(items.len());
    for remote in items {
        let (code, value) = item(&mut data).ok_or(status::REFUSED)?;
        result_of(code)?;
        if value.len() != remote.bytes() {
            return Err(status::REFUSED);
        }
        values.push(value.to_vec());
    }
    Ok(values)
}

fn written(count: usize, parameter: &[u8], data: Bytes) -> Ended {
    if *parameter != [WRITE, count as u8] || data.len() != count {
        return Err(status::REFUSED);
    }
    data.0.iter().try_for_each(|code| result_of(*code))?;
    Ok(Vec::new())
}

/// STATUS of the code of an item.
fn result_of(code: u8) -> Result<(), u16> {
    match code {
        SUCCESS => Ok(()),
        // Types or lengths do not fit.
        0x06 | 0x07 => Err(status::AREA),
        _ => Err(status::ACCESS),
    }
}

#[cfg(test)]
mod tests;
