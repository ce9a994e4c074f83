//! Cyclic services: variables that a client gets again and again without asking.

use std::time::{Duration, Instant};

use super::plc::Plc;
use super::session::userdata_pdu;
use super::variables;
use crate::limits::{SUBSCRIBED_ITEMS_MAX, SUBSCRIPTIONS_MAX};
use crate::wire::{Bytes, put16};

/// The group of userdata, and its functions.
pub const GROUP: u8 = 2;
pub const CYCLIC: u8 = 1;
pub const UNSUBSCRIBE: u8 = 4;
pub const ON_CHANGE: u8 = 5;

/// Error words.
const WRONG_ADDRESS: u16 = 0xD801;
const NO_SUCH_JOB: u16 = 0xD802;
const WRONG_TIME: u16 = 0xD804;
const TOO_MANY: u16 = 0xD805;

/// Units of periods: 100 ms, 1 s, 10 s.
const UNITS_MS: [u64; 3] = [100, 1000, 10_000];
/// Head and parameter of an indication, the head of its data, and the number of items.
const AROUND: usize = 10 + 12 + 4 + 2;
/// What [`variables::read`] counts besides data.
const READ_AROUND: usize = 14;
/// All jobs of the connection end.
const ALL: u8 = 0;

/// What one client has subscribed to on one connection.
#[derive(Debug, Default)]
pub struct Subscriptions(Vec<Subscription>);

#[derive(Debug)]
struct Subscription {
    id: u8,
    function: u8,
    /// Number of items, then the items, as in a job.
    items: Vec<u8>,
    period: Duration,
    due: Instant,
    /// What the client has, if it wants changes only.
    last: Vec<u8>,
}

impl Subscription {
    /// Number and data of all items, as they are now. `None`: they do not fit a PDU.
    fn read(&self, plc: &dyn Plc, pdu: u16) -> Option<Vec<u8>> {
        let room = usize::from(pdu) - AROUND + READ_AROUND;
        let (count, data) = variables::read(plc, Bytes(&self.items), room).ok()?;
        Some([&[0, count], data.as_slice()].concat())
    }
}

impl Subscriptions {
    /// No number of a job that runs.
    pub fn is_free(&self, id: u8) -> bool {
        self.0.iter().all(|job| job.id != id)
    }

    /// Begins job `id`: the first values. `Err`: the error word.
    pub fn subscribe(
        &mut self,
        plc: &dyn Plc,
        pdu: u16,
        (id, function): (u8, u8),
        payload: &[u8],
        now: Instant,
    ) -> Result<Vec<u8>, u16> {
        let &[0, count, unit, factor, ref items @ ..] = payload else { return Err(WRONG_ADDRESS) };
        let unit = UNITS_MS.get(usize::from(unit)).filter(|_| factor != 0).ok_or(WRONG_TIME)?;
        if self.0.len() >= SUBSCRIPTIONS_MAX || usize::from(count) > SUBSCRIBED_ITEMS_MAX {
            return Err(TOO_MANY);
        }
        let period = Duration::from_millis(unit * u64::from(factor));
        let items = [&[count], items].concat();
        let mut job = Subscription { id, function, items, period, due: now + period, last: Vec::new() };
        let values = job.read(plc, pdu).ok_or(WRONG_ADDRESS)?;
        job.last.clone_from(&values);
        self.0.push(job);
        Ok(values)
    }

    /// Ends a job, or all. `Err`: the error word.
    pub fn unsubscribe(&mut self, payload: &[u8]) -> Result<(), u16> {
        let &[function, id] = payload else { return Err(NO_SUCH_JOB) };
        let before = self.0.len();
        self.0.retain(|job| function != ALL && job.id != id);
        if function == ALL || self.0.len() < before { Ok(()) } else { Err(NO_SUCH_JOB) }
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// When the next values are due.
    pub fn due(&self) -> Option<Instant> {
        self.0.iter().map(|job| job.due).min()
    }

    /// The PDUs that are due. A period in which the client was too slow is left out.
    pub fn indications(&mut self, plc: &dyn Plc, pdu: u16, now: Instant) -> Vec<Vec<u8>> {
        let mut out = Vec::new();
        for job in self.0.iter_mut().filter(|job| job.due <= now) {
            job.due = now + job.period;
            let Some(values) = job.read(plc, pdu) else { continue };
            if job.function == ON_CHANGE && job.last == values {
                continue;
            }
            let parameter = [0, 1, 0x12, 8, 0x12, GROUP, job.function, job.id, 0, 0, 0, 0];
            let mut data = vec![0xFF, 9];
            put16(&mut data, values.len() as u16);
            data.extend(&values);
            out.push(userdata_pdu([0, 0], &parameter, &data));
            job.last = values;
        }
        out
    }
}
