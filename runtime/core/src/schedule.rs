//! Interrupts: which are due, which wait, and which may run now.
//!
//! Sources of interrupts (cyclic, delay, time of day, cycle monitor) each know their next due time. `Cpu::poll` turns
//! due sources into events, `Cpu::dispatch` runs waiting events whose priority is above the running one, the highest
//! first and first come first served among equals. Under the virtual clock only `Cpu::advance` moves time, and it
//! stops at every due time; so the number of safepoints in the code changes nothing.

mod passing;
mod sources;
mod time_of_day;

use std::cell::{Cell, RefCell};

use plcc_abi::ProgramImage;
use plcc_abi::image::{BlockEntry, BlockKind};
use plcc_abi::ob::ObClass;

use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;
use crate::datetime::Period;
use crate::diagnostics::NO_SITE;
use crate::events::{self, Event, StartInfo};
use crate::ob_set::ObSet;

pub(crate) use sources::{Cyclic, Delay, Monitor, TimeOfDay};

/// Events that can wait.
const QUEUE_MAX: usize = 64;

/// Never due.
pub(crate) const NEVER: u64 = u64::MAX;

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
                limit: sources::cycle_limit(image),
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
}
