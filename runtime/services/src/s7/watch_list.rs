//! The status of variables: what a programming device shows in a watch table (VAT). The answer to a request has the number of a job; the
//! values come after it, once, as they are at the cycle control point. A device that goes on watching asks again. Source: S7comm reference,
//! test functions.
//!
//! Layout of requests, answers and values: lengths of a head and of what comes after it, then both.
//!
//! ```text
//! request  head of 20 bytes, the first word is the trigger, 0 for at once; number of variables, 6 bytes each
//! answer   head of 4 bytes
//! values   head of 4 bytes; number of variables, and each as in the answer to a read, filled up to whole words
//! ```

use super::plc::{Family, Plc};
use super::session::userdata_pdu;
use super::variables::{self, WRONG_PDU};
use crate::limits::SUBSCRIPTIONS_MAX;
use crate::wire::{Bytes, put16};

/// The group of userdata, and its function.
pub const GROUP: u8 = 1;
pub const FUNCTION: u8 = 2;

/// Error words.
const WRONG_PARAMETER: u16 = 0xD002;
pub const UNSUPPORTED: u16 = 0xD003;
const NO_RESOURCES: u16 = 0x8302;
const WRONG_ADDRESS: u16 = 0xD042;

const REQUEST_HEAD: usize = 20;
const HEAD: usize = 4;
/// Lengths of a head and of what comes after it.
const LENGTHS: usize = 4;
/// Head and parameter of the PDU, the head of its data, lengths, head, number of variables; a byte that fills the last one up.
const AROUND: usize = 10 + 12 + 4 + LENGTHS + HEAD + 2 + 1;
/// What [`variables::read`] counts besides data.
const READ_AROUND: usize = 14;

/// Programming devices of other families use another protocol.
pub fn is_served(family: Family) -> bool {
    matches!(family, Family::S7300 | Family::S7400)
}

/// Jobs whose values have not been sent.
#[derive(Debug, Default)]
pub struct Jobs(Vec<Job>);

#[derive(Debug)]
struct Job {
    id: u8,
    /// Number of items, then the items, as in a job that reads.
    items: Vec<u8>,
}

impl Job {
    /// The values, as they are now. `None`: they do not fit a PDU.
    fn read(&self, plc: &dyn Plc, pdu: u16) -> Option<Vec<u8>> {
        let room = usize::from(pdu) - AROUND + READ_AROUND;
        let (count, mut values) = variables::read(plc, Bytes(&self.items), room).ok()?;
        if values.len() % 2 != 0 {
            values.push(0);
        }
        Some([&[0, count], values.as_slice()].concat())
    }
}

/// An item of a job that reads, for the six bytes of a variable.
fn item(variable: [u8; 6]) -> Option<[u8; 12]> {
    const BIT: u8 = 0x01;
    const COUNTER: u8 = 0x1C;
    const TIMER: u8 = 0x1D;
    let [kind, factor, db_high, db_low, high, low] = variable;
    let area = match kind >> 4 {
        0 => 0x83,
        1 => 0x81,
        2 => 0x82,
        3 => 0x80,
        5 => TIMER,
        6 => COUNTER,
        7 => 0x84,
        _ => return None,
    };
    let cells = matches!(area, TIMER | COUNTER);
    let transport = match kind & 15 {
        4 if cells => area,
        _ if cells => return None,
        0 => BIT,
        1 => 0x02,
        2 => 0x04,
        3 => 0x06,
        _ => return None,
    };
    let number = u32::from(u16::from_be_bytes([high, low]));
    let (count, address) = match transport {
        BIT if factor > 7 => return None,
        BIT => (1, 8 * number + u32::from(factor)),
        COUNTER | TIMER => (factor, number),
        _ => (factor, 8 * number),
    };
    let [_, a, b, c] = address.to_be_bytes();
    Some([0x12, 0x0A, 0x10, transport, 0, count, db_high, db_low, area, a, b, c])
}

/// A message of test functions.
fn message(head: [u8; HEAD], rest: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(LENGTHS + HEAD + rest.len());
    put16(&mut out, HEAD as u16);
    put16(&mut out, rest.len() as u16);
    out.extend(head);
    out.extend(rest);
    out
}

impl Jobs {
    /// No number of a job whose values have not been sent.
    pub fn is_free(&self, id: u8) -> bool {
        self.0.iter().all(|job| job.id != id)
    }

    /// Takes a request as job `id`. `Err`: the error word.
    pub fn take(&mut self, plc: &dyn Plc, pdu: u16, id: u8, payload: &[u8]) -> Result<Vec<u8>, u16> {
        if !is_served(plc.family()) {
            return Err(UNSUPPORTED);
        }
        let parts = (|| {
            let mut rest = Bytes(payload);
            let (head, length) = (usize::from(rest.u16()?), usize::from(rest.u16()?));
            let head = rest.take(head)?;
            let variables = rest.take(length)?;
            rest.is_empty().then_some((head, variables))
        })();
        let (head, variables) = parts.ok_or(WRONG_PDU)?;
        if head.len() != REQUEST_HEAD {
            return Err(WRONG_PARAMETER);
        }
        if !head.starts_with(&[0, 0]) {
            return Err(UNSUPPORTED);
        }
        let mut rest = Bytes(variables);
        let count = rest.u16().ok_or(WRONG_PDU)?;
        let mut items = vec![u8::try_from(count).ok().filter(|count| *count > 0).ok_or(WRONG_PDU)?];
        for _ in 0..count {
            items.extend(item(rest.array::<6>().ok_or(WRONG_PDU)?).ok_or(WRONG_ADDRESS)?);
        }
        if !rest.is_empty() {
            return Err(WRONG_PDU);
        }
        if self.0.len() >= SUBSCRIPTIONS_MAX {
            return Err(NO_RESOURCES);
        }
        let job = Job { id, items };
        job.read(plc, pdu).ok_or(WRONG_PDU)?;
        self.0.push(job);
        Ok(message([0; HEAD], &[]))
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// The values of all jobs, which end with it.
    pub fn indications(&mut self, plc: &dyn Plc, pdu: u16) -> Vec<Vec<u8>> {
        let values = |job: Job| {
            let data = message([0; HEAD], &job.read(plc, pdu)?);
            let parameter = [0, 1, 0x12, 8, 0x12, GROUP, FUNCTION, job.id, 0, 0, 0, 0];
            let mut framed = vec![0xFF, 9];
            put16(&mut framed, data.len() as u16);
            framed.extend(data);
            Some(userdata_pdu([0, 0], &parameter, &framed))
        };
        self.0.drain(..).filter_map(values).collect()
    }
}
