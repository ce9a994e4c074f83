//! Time-of-day interrupts: which moment is next, and what happens when the wall clock is set.

use super::TimeOfDay;
use crate::cpu::Cpu;
use crate::datetime::{self, Period};
use crate::events::{self, Event, StartInfo};

impl Cpu {
    /// Time-of-day interrupts from plc.toml.
    pub(crate) fn set_configured_times(&self) {
        for entry in &self.image.config.time_of_day {
            let (Some(time), Some(start), Some(period)) =
                (self.schedule.time_of_day(entry.ob), datetime::parse(&entry.start), Period::from_code(entry.period))
            else {
                continue;
            };
            time.set.set(true);
            time.start.set(start);
            time.period.set(period);
            time.period_code.set(entry.period);
            self.activate_time_of_day(time);
        }
    }

    /// Activates a time-of-day interrupt that is set; false: it is once only and in the past.
    pub(crate) fn activate_time_of_day(&self, time: &TimeOfDay) -> bool {
        let now = self.clock.wall();
        match time.period.get().next_after(time.start.get(), now.saturating_sub(1)) {
            Some((next, _)) => {
                time.next.set(next);
                time.active.set(true);
                self.rearm();
                true
            }
            None => false,
        }
    }

    pub(super) fn time_of_day_event(&self, time: &TimeOfDay) -> Event {
        let ob = time.ob;
        let info = StartInfo::new(0x11, events::cause(0x11, 10, ob), ob).word(6, time.period_code.get());
        Event { ob, info }
    }

    /// The next moment after `wall`; a single one is done.
    pub(super) fn step_time_of_day(&self, time: &TimeOfDay, wall: i64) {
        match time.period.get().next_after(time.start.get(), wall) {
            Some((next, _)) => time.next.set(next),
            None => time.active.set(false),
        }
    }

    /// The wall clock was set. Skipped time-of-day interrupts are a time error, and each runs once, unless OB 80 cancels it; those that
    /// are in the future again run again.
    ///
    /// Source: System and standard functions, OB 10 and OB 80: bits 0 to 7 of the error information show which ones.
    pub(crate) fn wall_clock_was_set(&self) {
        let wall = self.clock.wall();
        let mut skipped = Vec::new();
        for time in &self.schedule.times_of_day {
            if !time.active.get() {
                continue;
            }
            if time.next.get() < wall {
                let event = self.time_of_day_event(time);
                self.step_time_of_day(time, wall.saturating_sub(1));
                skipped.push(event);
            } else if time.period.get() != Period::Once {
                self.step_time_of_day(time, wall.saturating_sub(1));
            }
        }
        self.times_skipped(&skipped);
        skipped.into_iter().for_each(|event| self.request_timed(event));
        self.rearm();
    }
}
