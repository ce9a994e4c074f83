//! The services for what a subscription watches.

use std::time::{Duration, Instant};

use plcc_abi::services::Right;

use super::super::Server;
use super::super::code::{Reader, Writer};
use super::super::events::EVENT_NOTIFIER;
use super::super::status::{self, Status};
use super::super::view::check_count;
use super::asked::{new_item, parameters};
use super::{Subscriptions, milliseconds};
use crate::limits::{OPCUA_EVENT_ITEMS_MAX, OPCUA_ITEMS_MAX, OPCUA_KEPT_MAX};

impl Subscriptions {
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
        let mut kept = self.kept();
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
            match found.and_then(|item| Ok((parameters.filter_of(&item.wanted)?, item))) {
                Ok((filter, item)) => {
                    item.handle = parameters.handle;
                    item.interval = parameters.interval(subscription.interval);
                    let (room, others) = (item.room, kept - item.kept());
                    item.set_room(parameters.room());
                    // All items together have limited room: if there is not enough, the item keeps the room it had.
                    if others + item.kept() > OPCUA_KEPT_MAX {
                        item.set_room(room);
                    }
                    kept = others + item.kept();
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
}

fn check_times(times: u32) -> Result<(), Status> {
    if times > 3 { Err(status::TIMESTAMPS_INVALID) } else { Ok(()) }
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
