//! What interrupts by time: cyclic, time-delay and time-of-day interrupts, and the monitor of the cycle time.

use std::cell::Cell;

use plcc_abi::ProgramImage;

use super::NEVER;
use crate::clock::NS_PER_MS;
use crate::datetime::Period;

const NS_PER_US: u64 = 1000;

/// A cyclic interrupt.
pub(crate) struct Cyclic {
    pub ob: u16,
    /// In nanoseconds; 0: it does not run.
    pub(super) period: Cell<u64>,
    pub(super) phase: Cell<u64>,
    pub(super) due: Cell<u64>,
    /// Events that were lost since the OB last ran.
    pub(super) lost: Cell<u16>,
}

impl Cyclic {
    /// RUN begins at `now`, or period and phase are new.
    pub(super) fn start(&self, now: u64) {
        self.due.set(match self.period.get() {
            0 => NEVER,
            period => now.saturating_add(period).saturating_add(self.phase.get()),
        });
    }

    /// New period and phase in microseconds, SET_CINT.
    pub fn set(&self, now: u64, period_us: u32, phase_us: u32, in_run: bool) {
        self.period.set(u64::from(period_us) * NS_PER_US);
        self.phase.set(u64::from(phase_us) * NS_PER_US);
        if in_run {
            self.start(now);
        }
    }

    /// Period and phase in microseconds.
    pub fn times_us(&self) -> (u32, u32) {
        ((self.period.get() / NS_PER_US) as u32, (self.phase.get() / NS_PER_US) as u32)
    }
}

/// A time-delay interrupt.
pub(crate) struct Delay {
    pub ob: u16,
    pub due: Cell<u64>,
    pub delay_ms: Cell<u32>,
    pub sign: Cell<u16>,
}

/// A time-of-day interrupt. Moments are of the wall clock.
pub(crate) struct TimeOfDay {
    pub ob: u16,
    pub set: Cell<bool>,
    pub active: Cell<bool>,
    pub start: Cell<i64>,
    pub period: Cell<Period>,
    pub period_code: Cell<u16>,
    pub next: Cell<i64>,
}

/// Cycle-time monitoring.
pub(crate) struct Monitor {
    pub(super) limit: u64,
    /// When the cycle is too long; [`NEVER`] outside cycles.
    pub deadline: Cell<u64>,
    /// Since when it counts.
    pub since: Cell<u64>,
    pub overruns: Cell<u32>,
}

impl Monitor {
    /// Counts from `now` again, as SFC 43.
    pub fn restart(&self, now: u64) {
        if self.deadline.get() != NEVER {
            self.since.set(now);
            self.deadline.set(now.saturating_add(self.limit));
        }
    }

    /// A new cycle.
    pub fn begin(&self, now: u64) {
        self.overruns.set(0);
        self.since.set(now);
        self.deadline.set(now.saturating_add(self.limit));
    }

    pub fn end(&self) {
        self.deadline.set(NEVER);
    }
}

/// Nanoseconds that a cycle may take.
pub(super) fn cycle_limit(image: &ProgramImage) -> u64 {
    image.cycle_limit_ms().map_or(NEVER, |ms| u64::from(ms) * NS_PER_MS)
}
