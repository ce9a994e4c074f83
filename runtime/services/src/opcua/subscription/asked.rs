//! What a client says about an item: how often, which changes, how many of them wait.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use plcc_abi::services::Right;

use super::super::Server;
use super::super::attributes::{Question, VALUE, Wanted};
use super::super::code::Reader;
use super::super::events::{EVENT_FILTER, EventItem, Filter};
use super::super::standard::SERVER;
use super::super::status::{self, Status};
use super::interval;
use super::item::Item;
use crate::limits::OPCUA_QUEUE_MAX;

/// Number of its encoding.
const DATA_CHANGE_FILTER: u32 = 724;

/// What a client wants of an item.
pub(super) struct Parameters {
    pub(super) handle: u32,
    interval: f64,
    filter: (u32, Vec<u8>),
    pub(super) room: u32,
    pub(super) discard_oldest: bool,
}

pub(super) fn parameters(reader: &mut Reader) -> Option<Parameters> {
    let (handle, interval) = (reader.u32()?, reader.f64()?);
    let (ty, body) = reader.object()?;
    Some(Parameters {
        handle,
        interval,
        filter: (ty, body.to_vec()),
        room: reader.u32()?,
        discard_oldest: reader.bool()?,
    })
}

impl Parameters {
    /// Negative: as often as is published.
    pub(super) fn interval(&self, publishing: Duration) -> Duration {
        if self.interval < 0.0 { publishing } else { interval(self.interval) }
    }

    pub(super) fn room(&self) -> usize {
        (self.room as usize).clamp(1, OPCUA_QUEUE_MAX)
    }

    /// Trigger and deadband of an item.
    pub(super) fn filter_of(&self, wanted: &Wanted) -> Result<(u32, f64), Status> {
        let (trigger, deadband) = self.filter()?;
        if deadband > 0.0 && !wanted.is_number() {
            return Err(status::FILTER_NOT_ALLOWED);
        }
        Ok((trigger, deadband))
    }

    fn filter(&self) -> Result<(u32, f64), Status> {
        match &self.filter {
            (0, _) => Ok((1, 0.0)),
            (DATA_CHANGE_FILTER, body) => {
                let mut reader = Reader(body);
                let read = (reader.u32(), reader.u32(), reader.f64());
                let (Some(trigger), Some(kind), Some(deadband)) = read else { return Err(status::DECODING) };
                match (trigger, kind) {
                    (0..=2, 0) => Ok((trigger, 0.0)),
                    (0..=2, 1) if deadband >= 0.0 => Ok((trigger, deadband)),
                    (0..=2, 1) => Err(status::DEADBAND_INVALID),
                    _ => Err(status::FILTER_UNSUPPORTED),
                }
            }
            _ => Err(status::FILTER_UNSUPPORTED),
        }
    }

    pub(super) fn event_filter(&self) -> Result<Filter, Status> {
        match &self.filter {
            (EVENT_FILTER, body) => Filter::read(body),
            _ => Err(status::EVENT_FILTER_INVALID),
        }
    }
}

/// An item that a client wants.
pub(super) struct NewItem {
    pub(super) question: Question,
    mode: u32,
    parameters: Parameters,
}

pub(super) fn new_item(reader: &mut Reader) -> Option<NewItem> {
    Some(NewItem { question: Question::read(reader)?, mode: reader.u32()?, parameters: parameters(reader)? })
}

impl NewItem {
    /// Events are those of the server itself.
    pub(super) fn event_item(&self, publishing: Duration) -> Result<EventItem, Status> {
        if self.question.node.standard() != Some(SERVER) {
            return Err(status::ATTRIBUTE_INVALID);
        }
        if self.mode > 2 {
            return Err(status::MODE_INVALID);
        }
        let Parameters { handle, room, discard_oldest, .. } = self.parameters;
        let mut item = EventItem::new(handle, self.parameters.event_filter()?, self.parameters.interval(publishing));
        item.set_room(room);
        item.discard_oldest = discard_oldest;
        item.mode = self.mode;
        Ok(item)
    }

    pub(super) fn item(&self, server: &Server, right: Right, times: u32, publishing: Duration) -> Result<Item, Status> {
        let wanted = self.question.wanted(server, right);
        if let Wanted::Wrong(status) = wanted {
            return Err(status);
        }
        if self.mode > 2 {
            return Err(status::MODE_INVALID);
        }
        let (trigger, deadband) = self.parameters.filter_of(&wanted)?;
        if self.question.attribute != VALUE && self.parameters.filter.0 != 0 {
            return Err(status::FILTER_NOT_ALLOWED);
        }
        let mut item = Item {
            handle: self.parameters.handle,
            question: self.question.clone(),
            wanted,
            mode: self.mode,
            interval: self.parameters.interval(publishing),
            due: Instant::now(),
            queue: VecDeque::new(),
            room: 1,
            discard_oldest: self.parameters.discard_oldest,
            deadband,
            trigger,
            times,
            last: None,
        };
        item.set_room(self.parameters.room());
        Ok(item)
    }
}
