//! A variable that a client watches: which values of it are changes, and how many of them wait.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::super::attributes::{Question, Wanted};
use super::super::code::{DataValue, Scalar, Variant};
use super::super::status;
use crate::limits::OPCUA_KEPT_MAX;

/// A variable that a client watches.
pub(super) struct Item {
    pub(super) handle: u32,
    /// What the client has asked for, and what that is in the program that runs.
    pub(super) question: Question,
    pub(super) wanted: Wanted,
    /// 0: not looked at; 1: looked at; 2: also reported.
    pub(super) mode: u32,
    pub(super) interval: Duration,
    pub(super) due: Instant,
    pub(super) queue: VecDeque<DataValue>,
    pub(super) room: usize,
    pub(super) discard_oldest: bool,
    /// A change of this size is one; with the trigger 0 only the status counts, with 2 also the time.
    pub(super) deadband: f64,
    pub(super) trigger: u32,
    pub(super) times: u32,
    pub(super) last: Option<DataValue>,
}

impl Item {
    /// Elements that it keeps at most: what waits, and the last value.
    pub(super) fn kept(&self) -> u32 {
        self.wanted.cost().saturating_mul(self.room as u32 + 1)
    }

    /// How many values may wait: of long arrays fewer.
    pub(super) fn set_room(&mut self, room: usize) {
        self.room = room;
        while self.room > 1 && self.kept() > OPCUA_KEPT_MAX / 8 {
            self.room /= 2;
        }
        let surplus = self.queue.len().saturating_sub(self.room);
        self.queue.drain(..surplus);
    }

    /// A value that was read: it waits to be reported if it is a change.
    pub(super) fn take(&mut self, value: DataValue) {
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
