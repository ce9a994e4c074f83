//! A connection of S7 after it is open: each PDU has at most one answer.

use std::time::Instant;

use plcc_abi::services::{Protection, Right};

use super::cyclic::Subscriptions;
use super::plc::{Plc, Restart};
use super::userdata::{self, Pending};
use super::variables::{self, READ, Refused, WRITE, WRONG_PDU};
use super::watch_list;
use crate::limits::PARALLEL_JOBS_MAX;
use crate::wire::{Bytes, put16};

pub(super) const PROTOCOL: u8 = 0x32;

/// Kinds of PDUs.
pub(super) const JOB: u8 = 1;
pub(super) const ACK: u8 = 2;
pub(super) const ACK_DATA: u8 = 3;
pub(super) const USERDATA: u8 = 7;

/// Jobs besides reading and writing.
pub(super) const SETUP: u8 = 0xF0;
const START_UPLOAD: u8 = 0x1D;
const UPLOAD: u8 = 0x1E;
const END_UPLOAD: u8 = 0x1F;
const REQUEST_DOWNLOAD: u8 = 0x1A;
const DOWNLOAD_BLOCK: u8 = 0x1B;
const DOWNLOAD_ENDED: u8 = 0x1C;
const START: u8 = 0x28;
const STOP: u8 = 0x29;

/// Error words.
const NOT_IMPLEMENTED: u16 = 0x8104;
const WRONG_SEQUENCE: u16 = 0x8401;
const WRONG_STATE: u16 = 0x8402;
const NOT_PERMITTED: u16 = 0xD241;
const WRONG_NAME: u16 = 0xD201;
const WRONG_ARGUMENT: u16 = 0xD202;
const NO_BLOCK: u16 = 0xD209;
const WRONG_PASSWORD: u16 = 0xD602;
const ALREADY_LEGITIMATED: u16 = 0xD603;
const NOT_LEGITIMATED: u16 = 0xD604;
const NO_PASSWORD: u16 = 0xD605;

/// What a START is answered with besides the error word.
const ALREADY_RUNNING: u8 = 3;
const CANNOT_START: u8 = 2;
const ALREADY_STOPPED: u8 = 7;

/// The shortest PDU that may be agreed on.
pub const PDU_MIN: u16 = 240;
/// The longest that any CPU agrees on, which may come before that.
pub const PDU_BEFORE: usize = 960;

/// What stands between a client and the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gate {
    /// What the connection list allows.
    pub right: Right,
    pub protection: Protection,
    pub has_password: bool,
}

/// The state of a connection.
#[derive(Debug)]
pub struct Session {
    /// The length of PDUs that was agreed on.
    pub pdu: Option<u16>,
    gate: Gate,
    /// The client knows the password.
    legitimated: bool,
    /// Whether the password that it now sends is right.
    verdict: Option<bool>,
    pub(super) pending: Option<Pending>,
    pub(super) sequence: u8,
    pub(super) subscriptions: Subscriptions,
    pub(super) watched: watch_list::Jobs,
    /// Jobs that the other side answers at once.
    pub jobs: u16,
    /// How often the length was agreed on.
    pub setups: u8,
}

/// The connection has to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Broken;

impl Session {
    pub fn new(gate: Gate) -> Session {
        Session {
            pdu: None,
            gate,
            legitimated: false,
            verdict: None,
            pending: None,
            sequence: 0,
            subscriptions: Subscriptions::default(),
            watched: watch_list::Jobs::default(),
            jobs: 1,
            setups: 0,
        }
    }

    /// A connection for which this side has agreed on the length of PDUs.
    pub fn agreed(gate: Gate, pdu: u16, jobs: u16) -> Session {
        Session { pdu: Some(pdu), jobs, ..Session::new(gate) }
    }

    /// The client sends a password, and it is right or not.
    pub fn judge(&mut self, right: bool) {
        self.verdict = Some(right);
    }

    /// The longest PDU that the client may send.
    pub fn pdu_max(&self) -> usize {
        self.pdu.map_or(PDU_BEFORE, usize::from)
    }

    pub(super) fn may_read(&self) -> bool {
        self.gate.protection != Protection::Complete || self.legitimated
    }

    pub(super) fn may_write(&self) -> bool {
        self.gate.right >= Right::Write && self.may_read()
    }

    /// Stop and start the CPU, set its clock.
    pub(super) fn may_control(&self) -> bool {
        let open = matches!(self.gate.protection, Protection::None | Protection::Write);
        self.gate.right >= Right::Control && (open || self.legitimated)
    }

    /// Blocks could be read, if there were any.
    fn may_upload(&self) -> bool {
        matches!(self.gate.protection, Protection::None | Protection::Write) || self.legitimated
    }

    /// The client sends a password. `Err`: the error word.
    pub(super) fn legitimate(&mut self) -> Result<(), u16> {
        match (self.gate.has_password, self.legitimated, self.verdict.take()) {
            (false, _, _) => Err(NO_PASSWORD),
            (true, true, _) => Err(ALREADY_LEGITIMATED),
            (true, false, Some(true)) => {
                self.legitimated = true;
                Ok(())
            }
            (true, false, Some(false) | None) => Err(WRONG_PASSWORD),
        }
    }

    /// The client wants to be protected from itself again. `Err`: the error word.
    pub(super) fn forget_password(&mut self) -> Result<(), u16> {
        if std::mem::take(&mut self.legitimated) { Ok(()) } else { Err(NOT_LEGITIMATED) }
    }

    /// When jobs have values to send.
    pub fn due(&self) -> Option<Instant> {
        if self.watched.is_empty() { self.subscriptions.due() } else { Some(Instant::now()) }
    }

    /// What jobs send now.
    pub fn indications(&mut self, plc: &dyn Plc, now: Instant) -> Vec<Vec<u8>> {
        match self.pdu {
            Some(pdu) if self.may_read() => {
                let mut pdus = self.watched.indications(plc, pdu);
                pdus.extend(self.subscriptions.indications(plc, pdu, now));
                pdus
            }
            // The client has given its right back: nothing is due.
            _ => {
                self.watched.clear();
                self.subscriptions.clear();
                Vec::new()
            }
        }
    }

    /// Protection level: the one that is set, and the one that holds for this client.
    pub(super) fn levels(&self) -> (u16, u16) {
        let set = match self.gate.protection {
            Protection::None => 0,
            Protection::Write => 2,
            Protection::ReadWrite | Protection::Complete => 3,
        };
        (set, if self.legitimated { 1 } else { set.max(1) })
    }

    /// The answer to a PDU, if it has one.
    pub fn answer(&mut self, pdu: &[u8], plc: &dyn Plc) -> Result<Option<Vec<u8>>, Broken> {
        let mut rest = Bytes(pdu);
        let head = rest.array::<10>().ok_or(Broken)?;
        let [protocol, kind, _, _, r0, r1, p0, p1, d0, d1] = head;
        if protocol != PROTOCOL {
            return Err(Broken);
        }
        let reference = [r0, r1];
        let (parameters, data) = (usize::from(u16::from_be_bytes([p0, p1])), usize::from(u16::from_be_bytes([d0, d1])));
        match kind {
            // Nothing was asked of the client.
            ACK | ACK_DATA => return Ok(None),
            JOB | USERDATA => {}
            _ => return Err(Broken),
        }
        if pdu.len() > self.pdu_max() || parameters + data != rest.len() || parameters == 0 {
            return Ok(Some(refusal(reference, WRONG_PDU)));
        }
        let parameter = Bytes(rest.take(parameters).ok_or(Broken)?);
        let answer = match kind {
            JOB => self.job(reference, parameter, rest, plc),
            _ => userdata::answer(self, reference, parameter, rest, plc),
        };
        Ok(Some(answer.unwrap_or_else(|Refused(error)| refusal(reference, error))))
    }

    fn job(&mut self, reference: [u8; 2], parameter: Bytes, data: Bytes, plc: &dyn Plc) -> Result<Vec<u8>, Refused> {
        let mut rest = parameter;
        let function = rest.u8().ok_or(Refused(WRONG_PDU))?;
        if function == SETUP {
            return self.set_up(reference, rest, plc);
        }
        let Some(pdu) = self.pdu else { return Err(Refused(NOT_IMPLEMENTED)) };
        // Uploads of code have nothing to upload, and programs are not changed this way.
        let refused = |error| Ok(acknowledge(reference, error, &[function], &[]));
        match function {
            READ | WRITE if !self.may_read() => Err(Refused(NOT_IMPLEMENTED)),
            // By this python-snap7 3 asks whether the CPU runs: it takes any answer but an error for RUN.
            READ if rest.is_empty() && plc.is_running() => Ok(acknowledge(reference, 0, &[READ, 0], &[])),
            READ if rest.is_empty() => refused(WRONG_STATE),
            READ => {
                let (count, data) = variables::read(plc, rest, pdu.into())?;
                Ok(acknowledge(reference, 0, &[READ, count], &data))
            }
            WRITE => {
                let codes = variables::write(plc, rest, data, self.may_write())?;
                Ok(acknowledge(reference, 0, &[WRITE, codes.len() as u8], &codes))
            }
            START | STOP | REQUEST_DOWNLOAD..=END_UPLOAD if plc.family().is_portal() => Err(Refused(NOT_IMPLEMENTED)),
            START | STOP if !self.may_control() => refused(NOT_PERMITTED),
            START => Ok(start(reference, rest, plc)),
            STOP => Ok(stop(reference, rest, plc)),
            START_UPLOAD if !self.may_upload() => refused(NOT_PERMITTED),
            START_UPLOAD => refused(NO_BLOCK),
            UPLOAD | END_UPLOAD | DOWNLOAD_BLOCK | DOWNLOAD_ENDED => refused(WRONG_SEQUENCE),
            REQUEST_DOWNLOAD => refused(NOT_PERMITTED),
            _ => Err(Refused(NOT_IMPLEMENTED)),
        }
    }

    fn set_up(&mut self, reference: [u8; 2], mut rest: Bytes, plc: &dyn Plc) -> Result<Vec<u8>, Refused> {
        let wrong = Refused(WRONG_PDU);
        rest.u8().ok_or(wrong)?;
        let (calling, called) = (rest.u16().ok_or(wrong)?, rest.u16().ok_or(wrong)?);
        let asked = rest.u16().filter(|length| *length > 0 && rest.is_empty()).ok_or(wrong)?;
        let pdu = asked.clamp(PDU_MIN, plc.family().pdu_max());
        self.pdu = Some(pdu);
        self.jobs = calling.min(called).clamp(1, PARALLEL_JOBS_MAX);
        self.setups = self.setups.wrapping_add(1);
        self.pending = None;
        self.subscriptions.clear();
        self.watched.clear();
        let mut parameter = vec![SETUP, 0];
        for jobs in [calling, called] {
            put16(&mut parameter, jobs.clamp(1, PARALLEL_JOBS_MAX));
        }
        put16(&mut parameter, pdu);
        Ok(acknowledge(reference, 0, &parameter, &[]))
    }
}

/// PI services: restarts, and what changes nothing here.
fn start(reference: [u8; 2], mut rest: Bytes, plc: &dyn Plc) -> Vec<u8> {
    let named = (|| {
        rest.take(7)?;
        let length = rest.u16()?;
        let argument = rest.take(length.into())?;
        let length = rest.u8()?;
        let name = rest.take(length.into())?;
        rest.is_empty().then_some((argument, name))
    })();
    let Some((argument, name)) = named else { return refusal(reference, WRONG_PDU) };
    match name {
        b"P_PROGRAM" if plc.is_running() => acknowledge(reference, WRONG_STATE, &[START, ALREADY_RUNNING], &[]),
        b"P_PROGRAM" => {
            let restart = match argument {
                b"" => Restart::Warm,
                b"C " => Restart::Cold,
                _ => return acknowledge(reference, WRONG_ARGUMENT, &[START], &[]),
            };
            match plc.start(restart) {
                true => acknowledge(reference, 0, &[START], &[]),
                false => acknowledge(reference, WRONG_STATE, &[START, CANNOT_START], &[]),
            }
        }
        // There is neither work memory to be compressed nor a ROM.
        b"_GARB" | b"_MODU" => acknowledge(reference, 0, &[START], &[]),
        b"_INSE" | b"_DELE" => acknowledge(reference, NOT_PERMITTED, &[START], &[]),
        _ => acknowledge(reference, WRONG_NAME, &[START], &[]),
    }
}

fn stop(reference: [u8; 2], mut rest: Bytes, plc: &dyn Plc) -> Vec<u8> {
    let named = (|| {
        rest.take(5)?;
        let length = rest.u8()?;
        let name = rest.take(length.into())?;
        rest.is_empty().then_some(name)
    })();
    match named {
        Some(b"P_PROGRAM") if plc.is_running() => {
            plc.stop();
            acknowledge(reference, 0, &[STOP], &[])
        }
        Some(b"P_PROGRAM") => acknowledge(reference, WRONG_STATE, &[STOP, ALREADY_STOPPED], &[]),
        Some(_) => acknowledge(reference, WRONG_NAME, &[STOP], &[]),
        None => refusal(reference, WRONG_PDU),
    }
}

/// The whole job is refused.
fn refusal(reference: [u8; 2], error: u16) -> Vec<u8> {
    pdu(ACK, reference, Some(error), &[], &[])
}

fn acknowledge(reference: [u8; 2], error: u16, parameter: &[u8], data: &[u8]) -> Vec<u8> {
    pdu(ACK_DATA, reference, Some(error), parameter, data)
}

/// An answer to userdata, which has its error word in the parameter.
pub(super) fn userdata_pdu(reference: [u8; 2], parameter: &[u8], data: &[u8]) -> Vec<u8> {
    pdu(USERDATA, reference, None, parameter, data)
}

fn pdu(kind: u8, reference: [u8; 2], error: Option<u16>, parameter: &[u8], data: &[u8]) -> Vec<u8> {
    let mut pdu = Vec::with_capacity(12 + parameter.len() + data.len());
    pdu.extend([PROTOCOL, kind, 0, 0]);
    pdu.extend(reference);
    put16(&mut pdu, parameter.len() as u16);
    put16(&mut pdu, data.len() as u16);
    if let Some(error) = error {
        put16(&mut pdu, error);
    }
    pdu.extend(parameter);
    pdu.extend(data);
    pdu
}
