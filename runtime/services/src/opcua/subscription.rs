//! Values as they change: monitored items are looked at together, in one cycle, and what has changed waits for a publish request.
//! Source: OPC 10000-4, sections 5.13 and 5.14.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plcc_abi::services::Right;

use super::Server;
use super::attributes::{self, Question, VALUE, Wanted};
use super::code::{DataValue, Reader, Scalar, Variant, Writer, now};
use super::events::{self, EVENT_FILTER, EVENT_NOTIFIER, EVENTS, EventItem, Filter};
use super::standard::SERVER;
use super::status::{self, Status};
use super::view::check_count;
use crate::limits::{
    OPCUA_EVENT_ITEMS_MAX, OPCUA_ITEMS_MAX, OPCUA_KEPT_MAX, OPCUA_NODES_MAX, OPCUA_PUBLISHES_MAX, OPCUA_QUEUE_MAX,
    OPCUA_SAMPLING_MIN, OPCUA_SUBSCRIPTIONS_MAX, OPCUA_UNACKNOWLEDGED_BYTES_MAX, OPCUA_UNACKNOWLEDGED_MAX,
};

/// Longest time between two looks or two publications.
const INTERVAL_MAX: Duration = Duration::from_secs(3600);
/// Publications without news until one is sent anyway, and without a request until the subscription ends.
const KEEP_ALIVE_MAX: u32 = 1000;
const LIFETIME_MAX: u32 = 3000;
/// Numbers of encodings.
const DATA_CHANGE_FILTER: u32 = 724;
const DATA_CHANGE: u32 = 811;
const STATUS_CHANGE: u32 = 820;

/// A variable that a client watches.
struct Item {
    handle: u32,
    /// What the client has asked for, and what that is in the program that runs.
    question: Question,
    wanted: Wanted,
    /// 0: not looked at; 1: looked at; 2: also reported.
    mode: u32,
    interval: Duration,
    due: Instant,
    queue: VecDeque<DataValue>,
    room: usize,
    discard_oldest: bool,
    /// A change of this size is one; with the trigger 0 only the status counts, with 2 also the time.
    deadband: f64,
    trigger: u32,
    times: u32,
    last: Option<DataValue>,
}

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
    /// Subscriptions that ended because nobody asked.
    ended: VecDeque<u32>,
}

fn interval(ms: f64) -> Duration {
    let seconds = if ms.is_finite() { (ms / 1000.0).clamp(0.0, INTERVAL_MAX.as_secs_f64()) } else { 0.0 };
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

    /// CreateMonitoredItems. The first values come with the next look.
    pub fn create_items(
        &mut self,
        server: &Server,
        right: Right,
        reader: &mut Reader,
        out: &mut Writer,
    ) -> Result<(), Status> {
        let read = |reader: &mut Reader| Some((reader.u32()?, reader.u32()?, reader.list(new_item)?));
        let (id, times, asked) = read(reader).ok_or(status::DECODING)?;
        check_count(asked.len())?;
        check_times(times)?;
        let (mut count, mut kept, mut events) = (self.items(), self.kept(), self.event_items().count());
        let subscription = self.list.get_mut(&id).ok_or(status::SUBSCRIPTION_INVALID)?;
        subscription.lonely = 0;
        out.u32(asked.len() as u32);
        for asked in asked {
            if asked.question.attribute == EVENT_NOTIFIER {
                let made = match events < OPCUA_EVENT_ITEMS_MAX {
                    true => asked.event_item(subscription.interval),
                    false => Err(status::TOO_MANY_ITEMS),
                };
                match made {
                    Ok(item) => {
                        events += 1;
                        self.last_item += 1;
                        out.u32(status::GOOD);
                        out.u32(self.last_item);
                        put_revised(out, item.interval, item.room);
                        subscription.events.insert(self.last_item, item);
                    }
                    Err(status) => put_refused(out, status, true),
                }
                continue;
            }
            let made = match count < OPCUA_ITEMS_MAX {
                true => asked.item(server, right, times, subscription.interval),
                false => Err(status::TOO_MANY_ITEMS),
            };
            let made = made.and_then(|item| {
                kept = Some(kept + item.kept()).filter(|kept| *kept <= OPCUA_KEPT_MAX).ok_or(status::TOO_MANY_ITEMS)?;
                Ok(item)
            });
            match made {
                Ok(item) => {
                    count += 1;
                    self.last_item += 1;
                    out.u32(status::GOOD);
                    out.u32(self.last_item);
                    put_revised(out, item.interval, item.room);
                    subscription.items.insert(self.last_item, item);
                }
                Err(status) => put_refused(out, status, true),
            }
        }
        out.null();
        Ok(())
    }

    /// ModifyMonitoredItems.
    pub fn modify_items(&mut self, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
        let one = |reader: &mut Reader| Some((reader.u32()?, parameters(reader)?));
        let read = |reader: &mut Reader| Some((reader.u32()?, reader.u32()?, reader.list(one)?));
        let (id, times, asked) = read(reader).ok_or(status::DECODING)?;
        check_count(asked.len())?;
        check_times(times)?;
        let subscription = self.list.get_mut(&id).ok_or(status::SUBSCRIPTION_INVALID)?;
        out.u32(asked.len() as u32);
        for (item, parameters) in asked {
            if let Some(item) = subscription.events.get_mut(&item) {
                match parameters.event_filter() {
                    Ok(filter) => {
                        (item.handle, item.filter) = (parameters.handle, filter);
                        item.interval = parameters.interval(subscription.interval);
                        item.set_room(parameters.room);
                        item.discard_oldest = parameters.discard_oldest;
                        out.u32(status::GOOD);
                        put_revised(out, item.interval, item.room);
                    }
                    Err(status) => put_refused(out, status, false),
                }
                continue;
            }
            let found = subscription.items.get_mut(&item).ok_or(status::ITEM_INVALID);
            match found.and_then(|item| Ok((parameters.filter()?, item))) {
                Ok((filter, item)) => {
                    item.handle = parameters.handle;
                    item.interval = parameters.interval(subscription.interval);
                    // An item does not get more room than it has: the room of all is limited.
                    item.set_room(parameters.room().min(item.room));
                    item.discard_oldest = parameters.discard_oldest;
                    (item.trigger, item.deadband) = filter;
                    item.times = times;
                    out.u32(status::GOOD);
                    put_revised(out, item.interval, item.room);
                }
                Err(status) => put_refused(out, status, false),
            }
        }
        out.null();
        Ok(())
    }

    /// SetMonitoringMode.
    pub fn set_mode(&mut self, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
        let read = |reader: &mut Reader| Some((reader.u32()?, reader.u32()?, reader.list(Reader::u32)?));
        let (id, mode, items) = read(reader).ok_or(status::DECODING)?;
        check_count(items.len())?;
        if mode > 2 {
            return Err(status::MODE_INVALID);
        }
        let subscription = self.list.get_mut(&id).ok_or(status::SUBSCRIPTION_INVALID)?;
        let set = |id: &u32| match (subscription.items.get_mut(id), subscription.events.get_mut(id)) {
            (Some(item), _) => {
                if mode == 0 {
                    item.queue.clear();
                    item.last = None;
                }
                item.mode = mode;
                item.due = Instant::now();
                status::GOOD
            }
            (None, Some(item)) => {
                item.set_mode(mode);
                status::GOOD
            }
            (None, None) => status::ITEM_INVALID,
        };
        out.statuses(&items.iter().map(set).collect::<Vec<_>>());
        Ok(())
    }

    /// DeleteMonitoredItems.
    pub fn delete_items(&mut self, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
        let read = |reader: &mut Reader| Some((reader.u32()?, reader.list(Reader::u32)?));
        let (id, items) = read(reader).ok_or(status::DECODING)?;
        check_count(items.len())?;
        let subscription = self.list.get_mut(&id).ok_or(status::SUBSCRIPTION_INVALID)?;
        let delete =
            |id: &u32| match subscription.items.remove(id).is_some() || subscription.events.remove(id).is_some() {
                true => status::GOOD,
                false => status::ITEM_INVALID,
            };
        out.statuses(&items.iter().map(delete).collect::<Vec<_>>());
        Ok(())
    }

    /// Publish: the request waits for news. Result: what is answered at once.
    pub fn publish(&mut self, request: u32, handle: u32, reader: &mut Reader) -> Result<Option<Published>, Status> {
        let acknowledged = reader.list(|reader| Some((reader.u32()?, reader.u32()?))).ok_or(status::DECODING)?;
        let mut done = |(id, number): &(u32, u32)| {
            let Some(subscription) = self.list.get_mut(id) else { return status::SUBSCRIPTION_INVALID };
            subscription.lonely = 0;
            match subscription.sent.iter().position(|(own, _)| own == number) {
                Some(at) => {
                    subscription.sent.remove(at);
                    status::GOOD
                }
                None => status::SEQUENCE_UNKNOWN,
            }
        };
        let results = acknowledged.iter().map(&mut done).collect();
        if acknowledged.len() > OPCUA_NODES_MAX {
            return Err(status::TOO_MANY_OPERATIONS);
        }
        if self.list.is_empty() && self.ended.is_empty() {
            return Err(status::NO_SUBSCRIPTION);
        }
        self.waiting.push_back(Waiting { request, handle, results });
        let is_full = self.waiting.len() > OPCUA_PUBLISHES_MAX;
        let oldest = if is_full { self.waiting.pop_front() } else { None };
        Ok(oldest.map(|waiting| (waiting.request, waiting.handle, Err(status::TOO_MANY_PUBLISHES))))
    }

    /// Republish.
    pub fn republish(&self, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
        let (Some(id), Some(number)) = (reader.u32(), reader.u32()) else { return Err(status::DECODING) };
        let subscription = self.list.get(&id).ok_or(status::SUBSCRIPTION_INVALID)?;
        let found = subscription.sent.iter().find(|(own, _)| *own == number).ok_or(status::MESSAGE_NOT_AVAILABLE)?;
        out.0.extend(&found.1);
        Ok(())
    }

    /// Looks at the items whose time has come, all in one cycle, and answers requests that wait. `None`: the CPU has ended.
    pub async fn tick(&mut self, server: &Server) -> Option<Vec<Published>> {
        let time = Instant::now();
        let due: Vec<(u32, u32, Wanted)> = self
            .list
            .iter()
            .flat_map(|(id, subscription)| {
                let items = subscription.items.iter().filter(|(_, item)| item.mode != 0 && item.due <= time);
                items.map(|(number, item)| (*id, *number, item.wanted.clone()))
            })
            .collect();
        if !due.is_empty() {
            let places: Vec<(u32, u32)> = due.iter().map(|(id, number, _)| (*id, *number)).collect();
            let values = attributes::read(server, due.into_iter().map(|(_, _, wanted)| wanted).collect()).await?;
            for ((id, number), value) in places.into_iter().zip(values) {
                if let Some(item) = self.list.get_mut(&id).and_then(|subscription| subscription.items.get_mut(&number))
                {
                    item.due = (item.due + item.interval).max(time);
                    item.take(value);
                }
            }
        }
        self.look_at_events(server, time).await?;
        let mut out = Vec::new();
        let ids: Vec<u32> = self.list.keys().copied().collect();
        for id in ids {
            self.publish_one(server, id, time, &mut out);
        }
        while let Some(id) = self.ended.front().copied().filter(|_| !self.waiting.is_empty()) {
            self.ended.pop_front();
            let mut message = Writer::default();
            message.u32(status::TIMEOUT);
            message.u8(0);
            if let Some(waiting) = self.waiting.pop_front() {
                let content = notification(1, Some((STATUS_CHANGE, &message.0)));
                out.push(answer(waiting, id, &[], false, &content));
            }
        }
        Some(out)
    }

    fn event_items(&mut self) -> impl Iterator<Item = &mut EventItem> {
        self.list.values_mut().flat_map(|subscription| subscription.events.values_mut())
    }

    /// Items that watch events have just been made: what is logged from now on is for them.
    pub fn has_new_events(&mut self) -> bool {
        self.event_items().any(|item| item.told.is_none())
    }

    /// So many entries were logged when new items began.
    pub fn begin_events(&mut self, count: u64) {
        self.event_items().for_each(|item| item.told = item.told.or(Some(count)));
    }

    /// Gives new entries of the diagnostic buffer to the items whose time has come. `None`: the CPU has ended.
    async fn look_at_events(&mut self, server: &Server, time: Instant) -> Option<()> {
        let due = self.event_items().filter(|item| item.mode != 0 && item.due <= time);
        let Some(told) = due.map(|item| item.told.unwrap_or(u64::MAX)).min() else { return Some(()) };
        let (count, found) = server.link.ask(move |cpu| events::since(cpu, told)).await?;
        let found: Vec<_> = found.into_iter().map(Arc::new).collect();
        for item in self.event_items().filter(|item| item.mode != 0 && item.due <= time) {
            item.due = (item.due + item.interval).max(time);
            item.take(count, &found, server.started);
        }
        Some(())
    }

    fn publish_one(&mut self, server: &Server, id: u32, time: Instant, out: &mut Vec<Published>) {
        let Some(subscription) = self.list.get_mut(&id).filter(|subscription| subscription.due <= time) else { return };
        subscription.due = (subscription.due + subscription.interval).max(time);
        subscription.silent = subscription.silent.saturating_add(1);
        loop {
            let has_news = subscription.enabled && (subscription.has_changes() || subscription.has_events());
            if !has_news && subscription.silent < subscription.keep_alive {
                return;
            }
            let Some(waiting) = self.waiting.pop_front() else {
                // Nobody asks: some day the subscription is of no use.
                subscription.lonely += 1;
                if subscription.lonely >= subscription.lifetime {
                    self.list.remove(&id);
                    self.ended.push_back(id);
                    let surplus = self.ended.len().saturating_sub(OPCUA_SUBSCRIPTIONS_MAX);
                    self.ended.drain(..surplus);
                }
                return;
            };
            subscription.lonely = 0;
            subscription.silent = 0;
            if !has_news {
                // The number of the next message, which is not used up.
                let numbers: Vec<u32> = subscription.sent.iter().map(|(number, _)| *number).collect();
                out.push(answer(waiting, id, &numbers, false, &notification(subscription.next, None)));
                return;
            }
            let (ty, content) = match subscription.has_changes() {
                true => (DATA_CHANGE, subscription.changes()),
                false => {
                    (EVENTS, events::notification(subscription.events.values_mut(), subscription.most, server.started))
                }
            };
            let more = subscription.has_changes() || subscription.has_events();
            let number = subscription.next;
            subscription.next = number.checked_add(1).unwrap_or(1);
            let message = notification(number, Some((ty, &content)));
            subscription.sent.push_back((number, message.clone()));
            subscription.forget();
            let numbers: Vec<u32> = subscription.sent.iter().map(|(number, _)| *number).collect();
            out.push(answer(waiting, id, &numbers, more, &message));
            if !more {
                return;
            }
        }
    }
}

/// Interval, lifetime and keep-alive that a client asks for, within the limits.
fn times(reader: &mut Reader) -> Option<(Duration, u32, u32)> {
    let interval = interval(reader.f64()?);
    let (lifetime, keep_alive) = (reader.u32()?, reader.u32()?);
    let keep_alive = keep_alive.clamp(1, KEEP_ALIVE_MAX);
    Some((interval, lifetime.clamp(3 * keep_alive, LIFETIME_MAX.max(3 * keep_alive)), keep_alive))
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

fn check_times(times: u32) -> Result<(), Status> {
    if times > 3 { Err(status::TIMESTAMPS_INVALID) } else { Ok(()) }
}

/// NotificationMessage.
fn notification(number: u32, content: Option<(u32, &[u8])>) -> Vec<u8> {
    let mut out = Writer::default();
    out.u32(number);
    out.i64(now());
    match content {
        Some((ty, body)) => {
            out.u32(1);
            out.object(ty, body);
        }
        None => out.null(),
    }
    out.0
}

fn answer(waiting: Waiting, id: u32, numbers: &[u32], more: bool, message: &[u8]) -> Published {
    let mut out = Writer::default();
    out.u32(id);
    out.list(numbers, |out, number| out.u32(*number));
    out.bool(more);
    out.0.extend(message);
    out.statuses(&waiting.results);
    (waiting.request, waiting.handle, Ok(out.0))
}

impl Subscription {
    /// Messages that are not acknowledged are not kept for ever.
    fn forget(&mut self) {
        let bytes = |sent: &VecDeque<(u32, Vec<u8>)>| sent.iter().map(|(_, message)| message.len()).sum::<usize>();
        while self.sent.len() > OPCUA_UNACKNOWLEDGED_MAX
            || self.sent.len() > 1 && bytes(&self.sent) > OPCUA_UNACKNOWLEDGED_BYTES_MAX
        {
            self.sent.pop_front();
        }
    }

    fn has_changes(&self) -> bool {
        self.items.values().any(|item| item.mode == 2 && !item.queue.is_empty())
    }

    fn has_events(&self) -> bool {
        self.events.values().any(EventItem::has_news)
    }

    /// DataChangeNotification.
    fn changes(&mut self) -> Vec<u8> {
        let mut changes: Vec<(u32, u32, DataValue)> = Vec::new();
        for item in self.items.values_mut().filter(|item| item.mode == 2) {
            let count = item.queue.len().min(self.most - changes.len());
            changes.extend(item.queue.drain(..count).map(|value| (item.handle, item.times, value)));
        }
        let mut out = Writer::default();
        out.list(&changes, |out, (handle, times, value)| {
            out.u32(*handle);
            out.data_value(value, *times);
        });
        out.null();
        out.0
    }
}

impl Item {
    /// Elements that it keeps at most: what waits, and the last value.
    fn kept(&self) -> u32 {
        self.wanted.cost().saturating_mul(self.room as u32 + 1)
    }

    /// How many values may wait: of long arrays fewer.
    fn set_room(&mut self, room: usize) {
        self.room = room;
        while self.room > 1 && self.kept() > OPCUA_KEPT_MAX / 8 {
            self.room /= 2;
        }
        let surplus = self.queue.len().saturating_sub(self.room);
        self.queue.drain(..surplus);
    }

    /// A value that was read: it waits to be reported if it is a change.
    fn take(&mut self, value: DataValue) {
        let is_same = self.last.as_ref().is_some_and(|last| {
            last.status == value.status
                && match self.trigger {
                    0 => true,
                    1 => !differ(&last.value, &value.value, self.deadband),
                    _ => last.time == value.time && !differ(&last.value, &value.value, self.deadband),
                }
        });
        if is_same {
            return;
        }
        self.last = Some(value.clone());
        if self.queue.len() < self.room {
            return self.queue.push_back(value);
        }
        if self.discard_oldest {
            self.queue.pop_front();
        } else {
            self.queue.pop_back();
        }
        self.queue.push_back(value);
        let marked = if self.discard_oldest { self.queue.front_mut() } else { self.queue.back_mut() };
        if let Some(marked) = marked.filter(|marked| self.room > 1 && marked.status == status::GOOD) {
            marked.status = status::OVERFLOW;
        }
    }
}

/// Whether values differ by more than the deadband. All NaN are alike.
fn differ(a: &Variant, b: &Variant, deadband: f64) -> bool {
    let one = |a: &Scalar, b: &Scalar| match (a.number(), b.number()) {
        (Some(a), Some(b)) if a.is_nan() || b.is_nan() => a.is_nan() != b.is_nan(),
        (Some(x), Some(y)) if deadband > 0.0 => (x - y).abs() > deadband,
        _ => a != b,
    };
    match (a, b) {
        (Variant::One(a), Variant::One(b)) => one(a, b),
        (Variant::Many { values: a, .. }, Variant::Many { values: b, .. }) if a.len() == b.len() => {
            a.iter().zip(b).any(|(a, b)| one(a, b))
        }
        _ => a != b,
    }
}

/// What a client wants of an item.
struct Parameters {
    handle: u32,
    interval: f64,
    filter: (u32, Vec<u8>),
    room: u32,
    discard_oldest: bool,
}

fn parameters(reader: &mut Reader) -> Option<Parameters> {
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
    fn interval(&self, publishing: Duration) -> Duration {
        if self.interval < 0.0 { publishing } else { interval(self.interval) }
    }

    fn room(&self) -> usize {
        (self.room as usize).clamp(1, OPCUA_QUEUE_MAX)
    }

    /// Trigger and deadband.
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

    fn event_filter(&self) -> Result<Filter, Status> {
        match &self.filter {
            (EVENT_FILTER, body) => Filter::read(body),
            _ => Err(status::EVENT_FILTER_INVALID),
        }
    }
}

/// An item that a client wants.
struct NewItem {
    question: Question,
    mode: u32,
    parameters: Parameters,
}

fn new_item(reader: &mut Reader) -> Option<NewItem> {
    Some(NewItem { question: Question::read(reader)?, mode: reader.u32()?, parameters: parameters(reader)? })
}

impl NewItem {
    /// Events are those of the server itself.
    fn event_item(&self, publishing: Duration) -> Result<EventItem, Status> {
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

    fn item(&self, server: &Server, right: Right, times: u32, publishing: Duration) -> Result<Item, Status> {
        let wanted = self.question.wanted(server, right);
        if let Wanted::Wrong(status) = wanted {
            return Err(status);
        }
        if self.mode > 2 {
            return Err(status::MODE_INVALID);
        }
        let (trigger, deadband) = self.parameters.filter()?;
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

fn put_revised(out: &mut Writer, interval: Duration, room: usize) {
    out.f64(milliseconds(interval));
    out.u32(room as u32);
    out.object(0, &[]);
}

fn put_refused(out: &mut Writer, status: Status, with_id: bool) {
    out.u32(status);
    if with_id {
        out.u32(0);
    }
    out.f64(0.0);
    out.u32(0);
    out.object(0, &[]);
}
