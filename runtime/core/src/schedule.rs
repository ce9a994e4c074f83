//! Interrupts: which are due, which wait, and which may run now.
//!
//! Sources of interrupts (cyclic, delay, time of day, cycle monitor) each know their next due time. `Cpu::poll` turns
//! due sources into events, `Cpu::dispatch` runs waiting events whose priority is above the running one, the highest
//! first and first come first served among equals. Under the virtual clock only `Cpu::advance` moves time, and it
//! stops at every due time; so the number of safepoints in the code changes nothing.

use std::cell::{Cell, RefCell};

use plcc_abi::ProgramImage;
use plcc_abi::image::{BlockEntry, BlockKind};
use plcc_abi::ob::ObClass;

use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;
use crate::datetime::{self, Period};
use crate::diagnostics::NO_SITE;
use crate::events::{self, Event, StartInfo};
use crate::ob_set::ObSet;

/// Events that can wait.
const QUEUE_MAX: usize = 64;

/// How often a startup under the real clock checks whether the process must end.
const STARTUP_LOOK: u64 = 100 * NS_PER_MS;

const NS_PER_US: u64 = 1000;

/// Never due.
pub(crate) const NEVER: u64 = u64::MAX;

/// A cyclic interrupt.
pub(crate) struct Cyclic {
    pub ob: u16,
    /// In nanoseconds; 0: it does not run.
    period: Cell<u64>,
    phase: Cell<u64>,
    due: Cell<u64>,
    /// Events that were lost since the OB last ran.
    lost: Cell<u16>,
}

impl Cyclic {
    /// RUN begins at `now`, or period and phase are new.
    fn start(&self, now: u64) {
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
    limit: u64,
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

/// See the module comment.
pub struct Schedule {
    queue: RefCell<Vec<Event>>,
    pub(crate) cyclic: Vec<Cyclic>,
    /// OB 20-23 and others that are loaded.
    pub(crate) delays: Vec<Delay>,
    /// OB 10-17 and others that are loaded.
    pub(crate) times_of_day: Vec<TimeOfDay>,
    pub(crate) monitor: Monitor,
    /// OBs whose events are lost (SFC 39).
    pub(crate) disabled: ObSet,
    /// True in RUN: only then interrupts other than errors are served.
    pub(crate) in_run: Cell<bool>,
    /// Host time that a cycle may take under the virtual clock; set by the cycle.
    pub(crate) hang_limit: Cell<u64>,
    /// Nothing is due before this time; see [`Cpu::rearm`].
    quiet_until: Cell<u64>,
}

/// Nanoseconds that a cycle may take. The scan watchdog of an S7-200 can be off.
fn cycle_limit(image: &ProgramImage) -> u64 {
    match &image.s7200 {
        Some(own) => match image.config.s7200.watchdog_ms.unwrap_or(own.cpu.watchdog_ms) {
            0 => NEVER,
            ms => u64::from(ms) * NS_PER_MS,
        },
        None => u64::from(image.config.cycle_time_max_ms.max(1)) * NS_PER_MS,
    }
}

impl Schedule {
    pub(crate) fn new(image: &ProgramImage, blocks: &[BlockEntry]) -> Schedule {
        let config = &image.config;
        let of = |table: &[(u16, u32)], ob: u16| table.iter().find(|(number, _)| *number == ob).map(|(_, ms)| *ms);
        let loaded = |class: ObClass| {
            let obs = blocks.iter().filter(|block| block.kind == BlockKind::Ob).map(|block| block.number);
            obs.filter(move |&ob| config.class_of(ob) == Some(class))
        };
        let cyclic = loaded(ObClass::Cyclic)
            .map(|ob| Cyclic {
                ob,
                period: Cell::new(
                    u64::from(of(&config.cyclic_period_ms, ob).unwrap_or(events::default_period_ms(ob)).max(1))
                        * NS_PER_MS,
                ),
                phase: Cell::new(u64::from(of(&config.cyclic_phase_ms, ob).unwrap_or(0)) * NS_PER_MS),
                due: Cell::new(NEVER),
                lost: Cell::new(0),
            })
            .collect();
        let with_fixed = |class: ObClass| {
            let (first, last) = class.row().numbers;
            (first..=last).chain(loaded(class).filter(move |ob| !(first..=last).contains(ob)))
        };
        let times_of_day = with_fixed(ObClass::TimeOfDay).map(|ob| TimeOfDay {
            ob,
            set: Cell::new(false),
            active: Cell::new(false),
            start: Cell::new(0),
            period: Cell::new(Period::Once),
            period_code: Cell::new(0),
            next: Cell::new(i64::MAX),
        });
        let delays = with_fixed(ObClass::TimeDelay).map(|ob| Delay {
            ob,
            due: Cell::new(NEVER),
            delay_ms: Cell::new(0),
            sign: Cell::new(0),
        });
        Schedule {
            queue: RefCell::new(Vec::with_capacity(QUEUE_MAX)),
            cyclic,
            delays: delays.collect(),
            times_of_day: times_of_day.collect(),
            monitor: Monitor {
                limit: cycle_limit(image),
                deadline: Cell::new(NEVER),
                since: Cell::new(0),
                overruns: Cell::new(0),
            },
            disabled: ObSet::default(),
            in_run: Cell::new(false),
            hang_limit: Cell::new(NEVER),
            quiet_until: Cell::new(0),
        }
    }

    pub(crate) fn is_disabled(&self, ob: u16) -> bool {
        self.disabled.contains(ob)
    }

    pub(crate) fn delay(&self, ob: u16) -> Option<&Delay> {
        self.delays.iter().find(|delay| delay.ob == ob)
    }

    pub(crate) fn cyclic_of(&self, ob: u16) -> Option<&Cyclic> {
        self.cyclic.iter().find(|cyclic| cyclic.ob == ob)
    }

    pub(crate) fn time_of_day(&self, ob: u16) -> Option<&TimeOfDay> {
        self.times_of_day.iter().find(|time| time.ob == ob)
    }

    /// Drops the waiting events of an OB.
    pub(crate) fn forget(&self, ob: u16) {
        self.queue.borrow_mut().retain(|event| event.ob != ob);
    }

    /// No event waits.
    pub(crate) fn is_queue_empty(&self) -> bool {
        self.queue.borrow().is_empty()
    }

    /// Goes on where another schedule of a changed program is: interrupts that both have keep their times, new ones begin `now`.
    pub(crate) fn take_over(&mut self, before: &mut Schedule, now: u64) {
        let in_run = before.in_run.get();
        for own in &mut self.cyclic {
            match before.cyclic.iter_mut().find(|other| other.ob == own.ob) {
                Some(other) => std::mem::swap(own, other),
                None if in_run => own.start(now),
                None => {}
            }
        }
        for own in &mut self.delays {
            let other = before.delays.iter_mut().find(|other| other.ob == own.ob);
            other.into_iter().for_each(|other| std::mem::swap(own, other));
        }
        for own in &mut self.times_of_day {
            let other = before.times_of_day.iter_mut().find(|other| other.ob == own.ob);
            other.into_iter().for_each(|other| std::mem::swap(own, other));
        }
        std::mem::swap(&mut self.queue, &mut before.queue);
        std::mem::swap(&mut self.monitor, &mut before.monitor);
        std::mem::swap(&mut self.disabled, &mut before.disabled);
        std::mem::swap(&mut self.hang_limit, &mut before.hang_limit);
        self.in_run.set(in_run);
    }

    fn is_waiting(&self, ob: u16) -> bool {
        self.queue.borrow().iter().any(|event| event.ob == ob)
    }
}

impl Cpu {
    pub(crate) fn priority_of(&self, ob: u16) -> u8 {
        events::priority(ob, &self.image.profile, &self.image.config)
    }

    /// Puts an event whose OB exists into the queue.
    pub(crate) fn queue(&self, event: Event) {
        let full = {
            let mut queue = self.schedule.queue.borrow_mut();
            let full = queue.len() >= QUEUE_MAX;
            if !full {
                queue.push(event);
            }
            full
        };
        if full && event.ob == 80 {
            self.stop_by(0x4568, NO_SITE, crate::faults::TIME_ERROR_TWICE);
        } else if full {
            // Make room for OB 80: the newest waiting event is lost, too.
            self.schedule.queue.borrow_mut().pop();
            self.time_error(0x07, event);
        }
        if self.priority_of(event.ob) > self.running.priority.get() {
            self.memory.raise_attention();
        }
    }

    /// A timed interrupt is due. One that is still active or waiting is a time error.
    fn request_timed(&self, event: Event) {
        let busy = self.running.active.contains(event.ob);
        if (busy || self.schedule.is_waiting(event.ob)) && !self.schedule.is_disabled(event.ob) {
            if let Some(cyclic) = self.schedule.cyclic.iter().find(|cyclic| cyclic.ob == event.ob) {
                cyclic.lost.set(cyclic.lost.get().saturating_add(1));
            }
            self.time_error(0x02, event);
        } else {
            self.request(event);
        }
    }

    /// RUN begins at `now`: cyclic interrupts count from here.
    pub(crate) fn start_interrupts(&self, now: u64) {
        self.schedule.in_run.set(true);
        for cyclic in &self.schedule.cyclic {
            cyclic.start(now);
        }
        self.rearm();
    }

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

    /// When the next timed interrupt is due.
    #[inline]
    fn next_due(&self) -> u64 {
        match self.schedule.quiet_until.get() {
            0 => self.find_next_due(),
            time => time,
        }
    }

    fn find_next_due(&self) -> u64 {
        let schedule = &self.schedule;
        let cyclic = schedule.cyclic.iter().map(|cyclic| cyclic.due.get());
        let delays = schedule.delays.iter().map(|delay| delay.due.get());
        let times = schedule.times_of_day.iter().filter(|time| time.active.get());
        let times = times.map(|time| self.clock.time_of(time.next.get()));
        let other = self.family.next_due(self);
        cyclic.chain(delays).chain(times).chain(self.next_counter_due()).fold(other, u64::min)
    }

    /// Turns everything that is due now into events.
    #[inline]
    pub(crate) fn poll(&self) {
        if self.schedule.in_run.get() && self.clock.now() >= self.schedule.quiet_until.get() {
            self.serve_due();
        }
    }

    // Apart, as what rarely happens in a cycle is everywhere: each cycle would save the registers that it needs.
    #[inline(never)]
    fn serve_due(&self) {
        let now = self.clock.now();
        self.poll_counters();
        self.family.poll(self);
        for cyclic in self.schedule.cyclic.iter().filter(|cyclic| cyclic.due.get() <= now) {
            // Periods that the host slept through are not made up for.
            let period = cyclic.period.get().max(1);
            let missed = (now - cyclic.due.get()) / period;
            cyclic.due.set(cyclic.due.get() + (missed + 1) * period);
            // On an S7-1200/1500 word 8 has the number of lost events.
            let portal = self.image.profile.family.is_portal();
            let lost = if portal { cyclic.lost.replace(0) } else { 0 };
            let info = StartInfo::new(0x11, events::cause(0x31, 30, cyclic.ob), cyclic.ob)
                .word(6, (cyclic.phase.get() / NS_PER_MS) as u16)
                .word(8, lost)
                .word(10, (period / NS_PER_MS) as u16);
            self.request_timed(Event { ob: cyclic.ob, info });
        }
        for delay in &self.schedule.delays {
            if delay.due.get() <= now {
                let ob = delay.ob;
                delay.due.set(NEVER);
                let info = StartInfo::new(0x11, events::cause(0x21, 20, ob), ob)
                    .word(6, delay.sign.get())
                    .dword(8, delay.delay_ms.get());
                self.request_timed(Event { ob, info });
            }
        }
        let wall = self.clock.wall();
        for time in &self.schedule.times_of_day {
            if time.active.get() && time.next.get() <= wall {
                let event = self.time_of_day_event(time);
                self.step_time_of_day(time, wall);
                self.request_timed(event);
            }
        }
        self.find_quiet_time();
    }

    fn time_of_day_event(&self, time: &TimeOfDay) -> Event {
        let ob = time.ob;
        let info = StartInfo::new(0x11, events::cause(0x11, 10, ob), ob).word(6, time.period_code.get());
        Event { ob, info }
    }

    /// The next moment after `wall`; a single one is done.
    fn step_time_of_day(&self, time: &TimeOfDay, wall: i64) {
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

    /// Something that is due at a certain time was added, moved or taken out: finds the next time at which to look again.
    pub(crate) fn rearm(&self) {
        self.find_quiet_time();
        self.arm_watchdog();
    }

    /// What has no due time (inputs that are looked at, events of other sources) leaves 0: always look.
    fn find_quiet_time(&self) {
        let quiet = self.schedule.in_run.get() && self.technology.is_unused() && self.family.is_timed_only(self);
        self.schedule.quiet_until.set(if quiet { self.find_next_due() } else { 0 });
    }

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

    /// Runs the waiting interrupts that may run now.
    pub(crate) fn dispatch(&self) {
        self.family.dispatch(self);
    }

    /// Runs waiting events of higher priority than the running one.
    #[inline(never)]
    pub(crate) fn dispatch_by_priority(&self) {
        while !self.is_stopped() && self.running.delayed.get() == 0 {
            let Some((event, priority)) = self.take_next() else { return };
            // Between cycles an interrupt has its own monitoring, which finds an endless one.
            let between_cycles = self.running.priority.get() == 0 && self.schedule.monitor.deadline.get() == NEVER;
            if between_cycles {
                self.schedule.monitor.begin(self.clock.now());
                self.arm_hang();
                self.arm_watchdog();
            }
            self.run_ob(event.ob, priority, event.info);
            if between_cycles {
                self.schedule.monitor.end();
            }
        }
    }

    /// The waiting event that may run now.
    fn take_next(&self) -> Option<(Event, u8)> {
        let running = self.running.priority.get();
        let in_run = self.schedule.in_run.get();
        let mut queue = self.schedule.queue.borrow_mut();
        let mut best: Option<(usize, u8)> = None;
        for (index, event) in queue.iter().enumerate() {
            let error = matches!(event.ob, 80..=88);
            // In startup OB 80 has priority 28, and the other errors also interrupt; interrupts wait for RUN.
            let (priority, allowed) = match (in_run, error) {
                (true, _) => (self.priority_of(event.ob), self.priority_of(event.ob) > running),
                (false, true) => (28, running < 28),
                (false, false) => (0, false),
            };
            if allowed && best.is_none_or(|(_, highest)| priority > highest) {
                best = Some((index, priority));
            }
        }
        best.map(|(index, priority)| (queue.remove(index), priority))
    }

    /// Safepoint of generated code at `site`: something may be due. Result for generated code.
    pub(crate) fn safepoint(&self, site: u32) -> u32 {
        self.memory.attention().store(0, std::sync::atomic::Ordering::Relaxed);
        if !self.is_stopped() {
            if self.clock.is_virtual() {
                self.check_hang(site);
            } else {
                if !self.schedule.in_run.get() && crate::run::end_requested() {
                    self.stop_by(crate::faults::STOP_BY_REQUEST, site, 0);
                }
                self.poll();
                self.check_cycle_time(site);
                self.arm_watchdog();
            }
            self.dispatch();
        }
        let leaving = self.family.is_leaving(self);
        if self.is_stopped() || leaving {
            self.memory.raise_attention();
        }
        self.stop_result() | u32::from(leaving)
    }

    fn check_cycle_time(&self, site: u32) {
        let monitor = &self.schedule.monitor;
        let now = self.clock.now();
        if now >= monitor.deadline.get() {
            let ms = (now.saturating_sub(monitor.since.get()) / NS_PER_MS) as u32;
            self.family.cycle_too_long(self, ms, site);
        }
    }

    fn check_hang(&self, site: u32) {
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
