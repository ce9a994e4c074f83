//! Looks at what is watched, and the messages about it.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

use super::super::Server;
use super::super::attributes::{self, Wanted};
use super::super::code::{DataValue, Reader, Writer, now};
use super::super::events::{self, EVENTS, EventItem};
use super::super::status::{self, Status};
use super::{Published, Subscription, Subscriptions, Waiting};
use crate::limits::{
    OPCUA_NODES_MAX, OPCUA_PUBLISHES_MAX, OPCUA_SUBSCRIPTIONS_MAX, OPCUA_UNACKNOWLEDGED_BYTES_MAX,
    OPCUA_UNACKNOWLEDGED_MAX,
};

/// Numbers of encodings.
const DATA_CHANGE: u32 = 811;
const STATUS_CHANGE: u32 = 820;

impl Subscriptions {
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

    pub(super) fn event_items(&mut self) -> impl Iterator<Item = &mut EventItem> {
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
                // No client asks: some day the subscription is of no use.
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
