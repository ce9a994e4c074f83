//! Entries of the diagnostic buffer as events of the object `Server`: what a client selects of them, and which it wants.
//! Source: OPC 10000-4, sections 5.13 and 7.22; OPC 10000-5, BaseEventType.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plcc_runtime::cpu::Cpu;
use plcc_runtime::diagnostics;

use super::code::{NodeId, Reader, Scalar, Variant, Writer, now, time_of};
use super::space::DATA;
use super::standard::{EVENT_QUEUE_OVERFLOW, SYSTEM_EVENT_TYPE, is_kind_of};
use super::status::{self, Status};
use crate::limits::{OPCUA_EVENT_FIELDS_MAX, OPCUA_EVENT_OPERANDS_MAX, OPCUA_EVENTS_MAX, OPCUA_QUEUE_MAX};

/// The attribute of an object that has events.
pub const EVENT_NOTIFIER: u32 = 12;
/// Numbers of encodings.
pub const EVENT_FILTER: u32 = 727;
pub const EVENTS: u32 = 916;
const ELEMENT_OPERAND: u32 = 594;
const LITERAL_OPERAND: u32 = 597;
const SIMPLE_ATTRIBUTE_OPERAND: u32 = 603;

/// Severities, from 1 to 1000.
const NEWS: u16 = 100;
const FAULT: u16 = 700;
const STOP: u16 = 900;

/// An event.
#[derive(Debug)]
pub struct Event {
    /// The entry of the diagnostic buffer, counted from the first one.
    number: u64,
    ty: u32,
    /// 100 ns since 1601.
    time: i64,
    severity: u16,
    message: String,
}

/// What was logged after so many entries, oldest first, and how many entries there are now.
pub fn since(cpu: &Cpu, told: u64) -> (u64, Vec<Event>) {
    let count = cpu.diagnostics.count();
    let entries = cpu.diagnostics.newest_first();
    let fresh = usize::try_from(count.saturating_sub(told)).unwrap_or(usize::MAX).min(entries.len());
    let event = |(number, entry): (u64, &diagnostics::Entry)| {
        let place = diagnostics::place_text(&cpu.image, entry);
        let separator = if place.is_empty() { "" } else { "; " };
        Event {
            number,
            ty: SYSTEM_EVENT_TYPE,
            time: time_of(entry.wall),
            severity: match (entry.event >> 8, diagnostics::is_fault(entry.event)) {
                (0x45, true) => STOP,
                (_, true) => FAULT,
                (_, false) => NEWS,
            },
            message: format!("{}{separator}{place}", diagnostics::event_text(&cpu.image, entry)),
        }
    };
    let numbers = count - fresh as u64..count;
    (count, numbers.zip(entries[..fresh].iter().rev()).map(event).collect())
}

impl Event {
    /// A field of it; `Empty`: it has none with this name.
    fn field(&self, name: &str, started: i64) -> Variant {
        Variant::One(match name {
            "EventId" => Scalar::Bytes([started.to_be_bytes(), self.number.to_be_bytes()].concat()),
            "EventType" => Scalar::Node(NodeId::number(0, self.ty)),
            "SourceNode" => Scalar::Node(NodeId::text(DATA, "PLC")),
            "SourceName" => Scalar::Text("PLC".to_string()),
            "Time" | "ReceiveTime" => Scalar::Time(self.time),
            "Message" => Scalar::Localized(self.message.clone()),
            "Severity" => Scalar::UInt16(self.severity),
            _ => return Variant::Empty,
        })
    }
}

/// A value that a condition looks at.
#[derive(Clone, Debug)]
enum Operand {
    /// The result of a condition further down the list.
    Element(usize),
    Literal(Variant),
    /// A field by its name.
    Field(String),
}

#[derive(Clone, Debug)]
struct Condition {
    operator: u32,
    operands: Vec<Operand>,
}

/// What a client wants of events.
#[derive(Clone, Debug)]
pub struct Filter {
    /// Names of the fields; an empty one is a field that no event here has.
    fields: Vec<String>,
    conditions: Vec<Condition>,
}

/// A field by its type, path, attribute and range: its name.
fn field(reader: &mut Reader) -> Option<String> {
    const VALUE: u32 = 13;
    let _type = reader.node()?;
    let mut path = reader.list(Reader::name)?;
    let (attribute, range) = (reader.u32()?, reader.text()?);
    let name = path.pop().filter(|_| path.is_empty() && attribute == VALUE && range.is_empty());
    Some(name.filter(|(namespace, _)| *namespace == 0).map(|(_, name)| name).unwrap_or_default())
}

fn operand(reader: &mut Reader) -> Option<Result<Operand, Status>> {
    let (ty, body) = reader.object()?;
    let mut body = Reader(body);
    Some(Ok(match ty {
        ELEMENT_OPERAND => Operand::Element(body.u32()? as usize),
        LITERAL_OPERAND => Operand::Literal(body.variant()?),
        SIMPLE_ATTRIBUTE_OPERAND => Operand::Field(field(&mut body)?),
        _ => return Some(Err(status::EVENT_FILTER_INVALID)),
    }))
}

impl Filter {
    /// Reads an EventFilter.
    pub fn read(body: &[u8]) -> Result<Filter, Status> {
        let mut reader = Reader(body);
        let fields = reader.list(field).ok_or(status::DECODING)?;
        let condition = |reader: &mut Reader| Some((reader.u32()?, reader.list(operand)?));
        let read = reader.list(condition).ok_or(status::DECODING)?;
        let count = read.iter().map(|(_, operands)| 1 + operands.len()).sum::<usize>();
        if fields.len() > OPCUA_EVENT_FIELDS_MAX || count > OPCUA_EVENT_OPERANDS_MAX {
            return Err(status::TOO_MANY_OPERATIONS);
        }
        let mut conditions = Vec::new();
        for (index, (operator, operands)) in read.into_iter().enumerate() {
            let operands = operands.into_iter().collect::<Result<Vec<_>, _>>()?;
            let (least, most) = operands_of(operator).ok_or(status::FILTER_OPERATOR_UNSUPPORTED)?;
            // Only what comes after it, so no condition depends on itself.
            let is_forward = |operand: &Operand| !matches!(operand, Operand::Element(at) if *at <= index);
            if !(least..=most).contains(&operands.len()) || !operands.iter().all(is_forward) {
                return Err(status::EVENT_FILTER_INVALID);
            }
            conditions.push(Condition { operator, operands });
        }
        Ok(Filter { fields, conditions })
    }

    /// The first condition decides. Each is found once, the last one first.
    fn wants(&self, event: &Event, started: i64) -> bool {
        let mut results = vec![false; self.conditions.len()];
        for (index, condition) in self.conditions.iter().enumerate().rev() {
            let value = |operand: &Operand| match operand {
                Operand::Element(at) => Variant::One(Scalar::Bool(results.get(*at).copied().unwrap_or(false))),
                Operand::Literal(value) => value.clone(),
                Operand::Field(name) => event.field(name, started),
            };
            let values: Vec<Variant> = condition.operands.iter().map(value).collect();
            results[index] = holds(condition.operator, &values, event.ty);
        }
        results.first().copied().unwrap_or(true)
    }
}

/// How many operands an operator has. `None`: it is not supported.
fn operands_of(operator: u32) -> Option<(usize, usize)> {
    Some(match operator {
        operator::EQUALS
        | operator::GREATER
        | operator::LESS
        | operator::GREATER_OR_EQUAL
        | operator::LESS_OR_EQUAL
        | operator::AND
        | operator::OR => (2, 2),
        operator::IS_NULL | operator::NOT | operator::OF_TYPE => (1, 1),
        operator::IN_LIST => (2, usize::MAX),
        _ => return None,
    })
}

/// Numbers of operators. Source: OPC 10000-4, FilterOperator.
mod operator {
    pub const EQUALS: u32 = 0;
    pub const IS_NULL: u32 = 1;
    pub const GREATER: u32 = 2;
    pub const LESS: u32 = 3;
    pub const GREATER_OR_EQUAL: u32 = 4;
    pub const LESS_OR_EQUAL: u32 = 5;
    pub const NOT: u32 = 7;
    pub const IN_LIST: u32 = 9;
    pub const AND: u32 = 10;
    pub const OR: u32 = 11;
    pub const OF_TYPE: u32 = 14;
}

fn holds(operator: u32, values: &[Variant], ty: u32) -> bool {
    let is_true = |value: &Variant| *value == Variant::One(Scalar::Bool(true));
    let Some((first, rest)) = values.split_first() else { return false };
    let second = rest.first().unwrap_or(&Variant::Empty);
    match operator {
        operator::EQUALS | operator::IN_LIST => rest.iter().any(|other| is_equal(first, other)),
        operator::IS_NULL => *first == Variant::Empty,
        operator::GREATER => numbers(first, second).is_some_and(|(a, b)| a > b),
        operator::LESS => numbers(first, second).is_some_and(|(a, b)| a < b),
        operator::GREATER_OR_EQUAL => numbers(first, second).is_some_and(|(a, b)| a >= b),
        operator::LESS_OR_EQUAL => numbers(first, second).is_some_and(|(a, b)| a <= b),
        operator::NOT => !is_true(first),
        operator::AND => is_true(first) && is_true(second),
        operator::OR => is_true(first) || is_true(second),
        operator::OF_TYPE => match first {
            Variant::One(Scalar::Node(node)) => node.standard().is_some_and(|wanted| is_kind_of(ty, wanted, true)),
            _ => false,
        },
        _ => false,
    }
}

/// Numbers, or times, as numbers.
fn numbers(a: &Variant, b: &Variant) -> Option<(f64, f64)> {
    let number = |value: &Variant| match value {
        Variant::One(Scalar::Time(time)) => Some(*time as f64),
        Variant::One(value) => value.number(),
        Variant::Empty | Variant::Many { .. } => None,
    };
    Some((number(a)?, number(b)?))
}

fn is_equal(a: &Variant, b: &Variant) -> bool {
    match (a, b) {
        (Variant::One(Scalar::Localized(a)), Variant::One(Scalar::Text(b) | Scalar::Localized(b)))
        | (Variant::One(Scalar::Text(a)), Variant::One(Scalar::Localized(b))) => a == b,
        _ => a == b && *a != Variant::Empty || numbers(a, b).is_some_and(|(a, b)| a == b),
    }
}

/// Events that a client watches.
pub struct EventItem {
    pub handle: u32,
    pub filter: Filter,
    /// 0: not looked at; 1: looked at; 2: also reported.
    pub mode: u32,
    pub interval: Duration,
    pub due: Instant,
    pub room: usize,
    pub discard_oldest: bool,
    /// Entries that were looked at; `None`: it has just been made.
    pub told: Option<u64>,
    queue: VecDeque<Arc<Event>>,
    /// Some were lost because there was no room.
    has_lost: bool,
}

impl EventItem {
    pub fn new(handle: u32, filter: Filter, interval: Duration) -> EventItem {
        EventItem {
            handle,
            filter,
            mode: 0,
            interval,
            due: Instant::now(),
            room: OPCUA_QUEUE_MAX,
            discard_oldest: true,
            told: None,
            queue: VecDeque::new(),
            has_lost: false,
        }
    }

    /// As many as there may be, unless a client says how many. Source: OPC 10000-4, queue of events.
    pub fn set_room(&mut self, asked: u32) {
        self.room = if asked <= 1 { OPCUA_QUEUE_MAX } else { OPCUA_QUEUE_MAX.min(asked as usize) };
    }

    /// There is something to tell.
    pub fn has_news(&self) -> bool {
        self.mode == 2 && (self.has_lost || !self.queue.is_empty())
    }

    /// As [`mode`](EventItem::mode); what is logged while it is not looked at is not for it.
    pub fn set_mode(&mut self, mode: u32) {
        if mode == 0 {
            self.queue.clear();
            self.has_lost = false;
        } else if self.mode == 0 {
            self.told = None;
        }
        self.mode = mode;
        self.due = Instant::now();
    }

    /// Takes the events that it wants and has not seen.
    pub fn take(&mut self, count: u64, events: &[Arc<Event>], started: i64) {
        let told = self.told.replace(count).unwrap_or(count);
        let first = events.first().map_or(count, |event| event.number);
        // The diagnostic buffer no longer has them.
        self.has_lost |= first > told && count > told;
        for event in events.iter().filter(|event| event.number >= told) {
            if !self.filter.wants(event, started) {
                continue;
            }
            if self.queue.len() >= self.room {
                self.has_lost = true;
                if !self.discard_oldest {
                    continue;
                }
                self.queue.pop_front();
            }
            self.queue.push_back(event.clone());
        }
    }
}

/// An EventNotificationList of what waits in the items, up to `most` events.
pub fn notification<'a>(items: impl Iterator<Item = &'a mut EventItem>, most: usize, started: i64) -> Vec<u8> {
    let most = most.min(OPCUA_EVENTS_MAX);
    let mut lists: Vec<(u32, Vec<Variant>)> = Vec::new();
    for item in items.filter(|item| item.has_news()) {
        if lists.len() >= most {
            break;
        }
        let select =
            |event: &Event| item.filter.fields.iter().map(|name| event.field(name, started)).collect::<Vec<_>>();
        if std::mem::take(&mut item.has_lost) {
            let message = "events were lost: the queue was full".to_string();
            let (number, severity) = (item.told.unwrap_or(0), FAULT);
            let lost = Event { number, ty: EVENT_QUEUE_OVERFLOW, time: now(), severity, message };
            lists.push((item.handle, select(&lost)));
        }
        let count = item.queue.len().min(most - lists.len());
        for event in item.queue.drain(..count) {
            lists.push((item.handle, select(event.as_ref())));
        }
    }
    let mut out = Writer::default();
    out.list(&lists, |out, (handle, fields)| {
        out.u32(*handle);
        out.list(fields, Writer::variant);
    });
    out.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::opcua::standard::BASE_EVENT_TYPE;

    fn event(number: u64, severity: u16) -> Arc<Event> {
        let message = format!("event {number}");
        Arc::new(Event { number, ty: SYSTEM_EVENT_TYPE, time: 7, severity, message })
    }

    fn put_field(out: &mut Writer, name: &str) {
        out.node(&NodeId::number(0, BASE_EVENT_TYPE));
        out.list(&[name], |out, name| out.name(0, name));
        out.u32(13);
        out.null();
    }

    /// An EventFilter of fields and conditions: each an operator and its operands.
    fn filter(fields: &[&str], conditions: &[(u32, Vec<Operand>)]) -> Result<Filter, Status> {
        let mut out = Writer::default();
        out.list(fields, |out, name| put_field(out, name));
        out.list(conditions, |out, (operator, operands)| {
            out.u32(*operator);
            out.list(operands, |out, operand| {
                let mut body = Writer::default();
                let ty = match operand {
                    Operand::Element(at) => {
                        body.u32(*at as u32);
                        ELEMENT_OPERAND
                    }
                    Operand::Literal(value) => {
                        body.variant(value);
                        LITERAL_OPERAND
                    }
                    Operand::Field(name) => {
                        put_field(&mut body, name);
                        SIMPLE_ATTRIBUTE_OPERAND
                    }
                };
                out.object(ty, &body.0);
            });
        });
        Filter::read(&out.0)
    }

    fn severity(operator: u32, than: u16) -> (u32, Vec<Operand>) {
        let field = Operand::Field("Severity".to_string());
        (operator, vec![field, Operand::Literal(Variant::One(Scalar::UInt16(than)))])
    }

    #[test]
    fn conditions_choose_events() {
        let wants = |conditions: &[(u32, Vec<Operand>)]| {
            let filter = filter(&["Message"], conditions).expect("it is a filter");
            [100, 700].map(|severity| filter.wants(&event(1, severity), 0))
        };
        assert_eq!(wants(&[]), [true, true]);
        assert_eq!(wants(&[severity(operator::GREATER_OR_EQUAL, 700)]), [false, true]);
        assert_eq!(
            wants(&[(operator::NOT, vec![Operand::Element(1)]), severity(operator::EQUALS, 700)]),
            [true, false]
        );
        let both = (operator::OR, vec![Operand::Element(1), Operand::Element(2)]);
        assert_eq!(wants(&[both, severity(operator::LESS, 100), severity(operator::GREATER, 600)]), [false, true]);
        let of = |operator, ty| {
            let mut operands = vec![Operand::Literal(Variant::One(Scalar::Node(NodeId::number(0, ty))))];
            if operator == operator::IN_LIST {
                operands.insert(0, Operand::Field("EventType".to_string()));
            }
            [(operator, operands)]
        };
        assert_eq!(wants(&of(operator::OF_TYPE, BASE_EVENT_TYPE)), [true, true]);
        assert_eq!(wants(&of(operator::OF_TYPE, EVENT_QUEUE_OVERFLOW)), [false, false]);
        assert_eq!(wants(&of(operator::IN_LIST, SYSTEM_EVENT_TYPE)), [true, true]);
        assert_eq!(wants(&of(operator::IN_LIST, BASE_EVENT_TYPE)), [false, false]);
    }

    #[test]
    fn wrong_filters_are_refused() {
        let status = |conditions: &[(u32, Vec<Operand>)]| filter(&[], conditions).err();
        assert_eq!(status(&[(operator::NOT, vec![Operand::Element(0)])]), Some(status::EVENT_FILTER_INVALID));
        assert_eq!(status(&[(operator::AND, vec![Operand::Element(1)])]), Some(status::EVENT_FILTER_INVALID));
        assert_eq!(status(&[(99, vec![])]), Some(status::FILTER_OPERATOR_UNSUPPORTED));
        let many = vec![severity(operator::EQUALS, 1); OPCUA_EVENT_OPERANDS_MAX];
        assert_eq!(status(&many), Some(status::TOO_MANY_OPERATIONS));
        assert_eq!(Filter::read(&[0xFF, 0xFF]).err(), Some(status::DECODING));
    }

    #[test]
    fn lost_events_are_told() {
        let filter = filter(&["Severity"], &[]).expect("it is a filter");
        let mut item = EventItem::new(5, filter, Duration::ZERO);
        item.mode = 2;
        item.set_room(2);
        item.take(10, &[], 0);
        assert!(!item.has_news(), "what was before it");
        item.take(13, &[event(10, 1), event(11, 2), event(12, 3)], 0);
        let told = |severities: &[u16]| {
            let mut out = Writer::default();
            out.list(severities, |out, severity| {
                out.u32(5);
                out.list(&[Variant::One(Scalar::UInt16(*severity))], Writer::variant);
            });
            out.0
        };
        assert_eq!(notification([&mut item].into_iter(), 9, 0), told(&[FAULT, 2, 3]));
        assert!(!item.has_news());
        // The buffer has only the last of three.
        item.take(16, &[event(15, 4)], 0);
        assert_eq!(notification([&mut item].into_iter(), 9, 0), told(&[FAULT, 4]));
    }
}
