//! How time passes: until the next event under the virtual clock, asleep under the real one, and what is too long.

use super::NEVER;
use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;
use crate::diagnostics::NO_SITE;

/// How often a startup under the real clock checks whether the process must end.
const STARTUP_LOOK: u64 = 100 * NS_PER_MS;

impl Cpu {
    /// Sets the time at which the watchdog raises the attention flag. Under the virtual clock it watches beats instead.
    pub(crate) fn arm_watchdog(&self) {
        let schedule = &self.schedule;
        if self.clock.is_virtual() {
            return;
        }
        let now = self.clock.now();
        // Startup has no time limit; it only checks whether the process must end.
        let due = if schedule.in_run.get() { self.next_due() } else { now.saturating_add(STARTUP_LOOK) };
        let due = due.min(schedule.monitor.deadline.get());
        let left = due.saturating_sub(now);
        self.watchdog.set(if due == NEVER { NEVER } else { self.watchdog.host_now().saturating_add(left) });
    }

    pub(super) fn check_cycle_time(&self, site: u32) {
        let monitor = &self.schedule.monitor;
        let now = self.clock.now();
        if now >= monitor.deadline.get() {
            let ms = (now.saturating_sub(monitor.since.get()) / NS_PER_MS) as u32;
            self.family.cycle_too_long(self, ms, site);
        }
    }

    pub(super) fn check_hang(&self, site: u32) {
        if !self.is_stopped() && self.watchdog.is_overdue() {
            self.family.hang(self, site);
        }
    }

    /// An endless loop under the virtual clock: OB 80 once, then STOP.
    pub(crate) fn hang_limit_exceeded(&self, site: u32) {
        let schedule = &self.schedule;
        let ms = (schedule.hang_limit.get() / NS_PER_MS) as u32;
        let cause = self.log(0x3501, site, ms);
        let in_time_error = self.running.active.contains(80);
        if self.has_ob(80) && !in_time_error {
            self.arm_hang();
            let info = self.overrun_info(ms);
            self.run_ob(80, self.priority_of(80).max(self.running.priority.get()), info);
        }
        self.stop_because(0x4568, site, crate::faults::TIME_ERROR_HANG, Some(cause));
    }

    /// Starts the hang limit again.
    #[inline]
    pub(crate) fn arm_hang(&self) {
        self.watchdog.beat();
    }

    /// Lets time pass until `target`. Interrupts run at their due times. `monitored`: the cycle monitor
    /// counts this time.
    #[inline]
    pub(crate) fn advance(&self, target: u64, monitored: bool) {
        if !self.clock.is_virtual() {
            self.wait_until(target, monitored);
            return;
        }
        self.dispatch();
        if monitored || self.schedule.in_run.get() && self.next_due() <= target {
            self.advance_by_events(target, monitored);
        }
        self.clock.move_to(target);
        self.update_clock_memory();
    }

    /// Time under the virtual clock until the last event that is due at `target` or before.
    #[inline(never)]
    fn advance_by_events(&self, target: u64, monitored: bool) {
        while !self.is_stopped() {
            let due = if self.schedule.in_run.get() { self.next_due() } else { NEVER };
            let late = if monitored { self.schedule.monitor.deadline.get() } else { NEVER };
            let next = due.min(late);
            if next > target {
                break;
            }
            self.clock.move_to(next);
            self.update_clock_memory();
            self.poll();
            if monitored {
                self.check_cycle_time(NO_SITE);
            }
            self.dispatch();
            self.check_hang(NO_SITE);
        }
    }

    /// Real time: sleeps until `target`, with interrupts.
    #[inline(never)]
    fn wait_until(&self, target: u64, monitored: bool) {
        /// Longest sleep, so that signals are seen soon.
        const SLICE: u64 = 20 * NS_PER_MS;
        while !self.is_stopped() && !self.schedule_ended() {
            self.poll();
            if monitored {
                self.check_cycle_time(NO_SITE);
            }
            self.dispatch();
            self.update_clock_memory();
            let now = self.clock.now();
            if now >= target {
                break;
            }
            let due = if self.schedule.in_run.get() { self.next_due() } else { NEVER };
            let until = target.min(due).min(now + SLICE);
            if until > now {
                std::thread::sleep(std::time::Duration::from_nanos(until - now));
            }
        }
        self.rearm();
    }

    /// SFC 47 and `//@ sleep`: `ns` nanoseconds pass. Result for generated code.
    pub(crate) fn pass_time(&self, ns: u64, monitored: bool) -> u32 {
        let monitor = &self.schedule.monitor;
        if !monitored && monitor.deadline.get() != NEVER {
            monitor.deadline.set(monitor.deadline.get().saturating_add(ns));
            monitor.since.set(monitor.since.get().saturating_add(ns));
        }
        self.advance(self.clock.now().saturating_add(ns), monitored);
        self.show_clock();
        self.stop_result()
    }
}
