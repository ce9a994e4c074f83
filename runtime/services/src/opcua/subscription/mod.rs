//! Values as they change: monitored items are looked at together, in one cycle, and what has changed waits for a publish request.
//! Source: OPC 10000-4, sections 5.13 and 5.14.
//!
//! Here are subscriptions as a whole. [`items`] has the services for what they watch, [`asked`] what clients say about it, [`item`] a variable that
//! is watched, [`publishing`] the looks and the messages.

mod asked;
mod item;
mod items;
mod publishing;

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

use plcc_abi::services::Right;

use super::Server;
use super::attributes::Wanted;
use super::code::{Reader, Writer};
use super::events::EventItem;
use super::status::{self, Status};
use super::view::check_count;
use crate::limits::{
    OPCUA_INTERVAL_MAX, OPCUA_ITEMS_MAX, OPCUA_KEEP_ALIVE_MAX, OPCUA_KEPT_MAX, OPCUA_LIFETIME_MAX, OPCUA_SAMPLING_MIN,
    OPCUA_SUBSCRIPTIONS_MAX,
};
use item::Item;

struct Subscription {
    interval: Duration,
    due: Instant,
    lifetime: u32,
    keep_alive: u32,
    enabled: bool,
    most: usize,
    items: BTreeMap<u32, Item>,
    events: BTreeMap<u32, EventItem>,
    /// Number of the next message.
    next: u32,
    /// Messages that the client has not acknowledged.
    sent: VecDeque<(u32, Vec<u8>)>,
    /// Intervals without a message, and without a request.
    silent: u32,
    lonely: u32,
}

/// A request that waits for news.
struct Waiting {
    request: u32,
    handle: u32,
    results: Vec<Status>,
}

/// A response to a publish request: the number of the request, its handle, and the service result or the body.
pub type Published = (u32, u32, Result<Vec<u8>, Status>);

/// All subscriptions of a session.
#[derive(Default)]
pub struct Subscriptions {
    list: BTreeMap<u32, Subscription>,
    waiting: VecDeque<Waiting>,
    last_id: u32,
    last_item: u32,
    /// Subscriptions that ended because no client asked.
    ended: VecDeque<u32>,
}

fn interval(ms: f64) -> Duration {
    let seconds = if ms.is_finite() { (ms / 1000.0).clamp(0.0, OPCUA_INTERVAL_MAX.as_secs_f64()) } else { 0.0 };
    Duration::from_secs_f64(seconds).max(OPCUA_SAMPLING_MIN)
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1000.0
}

impl Subscriptions {
    /// When there is something to do.
    pub fn due(&self) -> Option<Instant> {
        let all = self.list.values();
        all.flat_map(|subscription| {
            let items = subscription.items.values().filter(|item| item.mode != 0).map(|item| item.due);
            let events = subscription.events.values().filter(|item| item.mode != 0).map(|item| item.due);
            items.chain(events).chain([subscription.due])
        })
        .min()
    }

    fn items(&self) -> usize {
        self.list.values().map(|subscription| subscription.items.len()).sum()
    }

    /// Elements that wait in all items at most.
    fn kept(&self) -> u32 {
        self.list.values().flat_map(|subscription| subscription.items.values()).map(Item::kept).sum()
    }

    /// Finds all items again after a change of the program. Those that it does not have are reported with the status.
    pub fn renew(&mut self, server: &Server, right: Right) {
        let mut kept = 0;
        for item in self.list.values_mut().flat_map(|subscription| subscription.items.values_mut()) {
            item.wanted = item.question.wanted(server, right);
            item.set_room(item.room);
            if kept + item.kept() > OPCUA_KEPT_MAX {
                item.wanted = Wanted::Wrong(status::TOO_MANY_ITEMS);
            }
            kept += item.kept();
        }
    }

    /// CreateSubscription.
    pub fn create(&mut self, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
        let asked = times(reader).ok_or(status::DECODING)?;
        let rest = (reader.u32(), reader.bool(), reader.u8());
        let (Some(most), Some(enabled), Some(_)) = rest else { return Err(status::DECODING) };
        if self.list.len() >= OPCUA_SUBSCRIPTIONS_MAX {
            return Err(status::TOO_MANY_SUBSCRIPTIONS);
        }
        self.last_id += 1;
        let (interval, lifetime, keep_alive) = asked;
        out.u32(self.last_id);
        put_times(out, asked);
        let subscription = Subscription {
            interval,
            due: Instant::now() + interval,
            lifetime,
            keep_alive,
            enabled,
            most: message_size(most),
            items: BTreeMap::new(),
            events: BTreeMap::new(),
            next: 1,
            sent: VecDeque::new(),
            // The first message comes at once.
            silent: keep_alive,
            lonely: 0,
        };
        self.list.insert(self.last_id, subscription);
        Ok(())
    }

    /// ModifySubscription.
    pub fn modify(&mut self, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
        let id = reader.u32().ok_or(status::DECODING)?;
        let asked = times(reader).ok_or(status::DECODING)?;
        let most = reader.u32().ok_or(status::DECODING)?;
        let subscription = self.list.get_mut(&id).ok_or(status::SUBSCRIPTION_INVALID)?;
        (subscription.interval, subscription.lifetime, subscription.keep_alive) = asked;
        subscription.most = message_size(most);
        subscription.lonely = 0;
        put_times(out, asked);
        Ok(())
    }

    /// SetPublishingMode.
    pub fn set_publishing(&mut self, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
        let read = |reader: &mut Reader| Some((reader.bool()?, reader.list(Reader::u32)?));
        let (enabled, ids) = read(reader).ok_or(status::DECODING)?;
        check_count(ids.len())?;
        let set = |id: &u32| match self.list.get_mut(id) {
            Some(subscription) => {
                subscription.enabled = enabled;
                status::GOOD
            }
            None => status::SUBSCRIPTION_INVALID,
        };
        out.statuses(&ids.iter().map(set).collect::<Vec<_>>());
        Ok(())
    }

    /// DeleteSubscriptions.
    pub fn delete(&mut self, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
        let ids = reader.list(Reader::u32).ok_or(status::DECODING)?;
        check_count(ids.len())?;
        let delete = |id: &u32| match self.list.remove(id) {
            Some(_) => status::GOOD,
            None => status::SUBSCRIPTION_INVALID,
        };
        out.statuses(&ids.iter().map(delete).collect::<Vec<_>>());
        Ok(())
    }
}

/// Interval, lifetime and keep-alive that a client asks for, within the limits.
fn times(reader: &mut Reader) -> Option<(Duration, u32, u32)> {
    let interval = interval(reader.f64()?);
    let (lifetime, keep_alive) = (reader.u32()?, reader.u32()?);
    let keep_alive = keep_alive.clamp(1, OPCUA_KEEP_ALIVE_MAX);
    Some((interval, lifetime.clamp(3 * keep_alive, OPCUA_LIFETIME_MAX.max(3 * keep_alive)), keep_alive))
}

fn put_times(out: &mut Writer, (interval, lifetime, keep_alive): (Duration, u32, u32)) {
    out.f64(milliseconds(interval));
    out.u32(lifetime);
    out.u32(keep_alive);
}

/// Values of one message; 0: as many as there may be.
fn message_size(most: u32) -> usize {
    if most == 0 { OPCUA_ITEMS_MAX } else { OPCUA_ITEMS_MAX.min(most as usize) }
}
