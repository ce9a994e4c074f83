//! Events, their queues, and interrupt routines. Source: S7-200 system manual, interrupt instructions.
//!
//! An event with a routine waits in the queue of its group. Routines run at safepoints, one to its end before the next begins:
//! communication before I/O before timed, in a group by arrival, simultaneous events by their priority in the group.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;

use plcc_abi::image::BlockKind;
use plcc_abi::layout;
use plcc_abi::s7200::event::{self, Group};
use plcc_abi::s7200::{EVENTS, error, system};

use super::{Operands, S7200, done, failed, set_special, special};
use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;
use crate::schedule::NEVER;

/// Data of an event for its routine: a character received in Freeport, and whether its parity was wrong.
pub type EventData = Option<(u8, bool)>;

/// Queues, one per group of events.
const GROUPS: usize = 3;

/// Inputs I0.0 to I0.3 raise events 0 to 7: rising and falling edge of each.
const EDGE_INPUTS: u8 = 4;
/// Events of the timed interrupts, whose periods are in SMB34 and SMB35.
const TIMED_EVENTS: [(u32, u32); 2] = [(10, 34), (11, 35)];
/// Shortest period on a CPU of the 21x generation, in ms.
const OLD_PERIOD_LEAST: u8 = 5;
/// Events of one timed interrupt that are raised at once after the host slept; no queue is deeper.
const CATCH_UP_MAX: u64 = 64;
/// Special memory of a received character and its parity error.
const CHARACTER: u32 = 2;
const PARITY: u32 = 3;
/// Overflow bits of the queues, and bit 4: interrupts are enabled.
const STATUS: u32 = 4;
const ENABLED_BIT: u8 = 4;
/// Priority class in which interrupt routines run.
const CLASS: u8 = 2;

/// An event that waits.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    event: u8,
    data: EventData,
    /// Events with the same stamp are simultaneous.
    stamp: u64,
}

/// A timed interrupt.
struct Timed {
    /// Nanoseconds, as it was when the routine was attached.
    period: Cell<u64>,
    due: Cell<u64>,
}

/// Attached routines and waiting events.
pub struct Interrupts {
    routines: [Cell<Option<u16>>; EVENTS as usize],
    queues: RefCell<[VecDeque<Waiting>; GROUPS]>,
    enabled: Cell<bool>,
    /// An interrupt routine runs.
    pub(super) running: Cell<bool>,
    /// It is to be left at once, because it has executed STOP.
    pub(super) leaving: Cell<bool>,
    stamp: Cell<u64>,
    timed: [Timed; 2],
    /// Levels of I0.0 to I0.3.
    levels: Cell<u8>,
}

impl Default for Interrupts {
    fn default() -> Interrupts {
        Interrupts {
            routines: std::array::from_fn(|_| Cell::new(None)),
            queues: RefCell::default(),
            enabled: Cell::new(false),
            running: Cell::new(false),
            leaving: Cell::new(false),
            stamp: Cell::new(0),
            timed: std::array::from_fn(|_| Timed { period: Cell::new(0), due: Cell::new(NEVER) }),
            levels: Cell::new(0),
        }
    }
}

impl Interrupts {
    fn routine(&self, event: u32) -> Option<&Cell<Option<u16>>> {
        self.routines.get(event as usize)
    }

    /// Puts an event into its queue. False: the queue is full.
    fn push(&self, event: u8, data: EventData, depth: usize) -> bool {
        let (group, priority) = group_of(event);
        let waiting = Waiting { event, data, stamp: self.stamp.get() };
        let mut queues = self.queues.borrow_mut();
        let Some(queue) = queues.get_mut(group).filter(|queue| queue.len() < depth) else { return false };
        let later = |other: &Waiting| other.stamp == waiting.stamp && group_of(other.event).1 > priority;
        let after = queue.iter().rev().take_while(|other| later(other)).count();
        queue.insert(queue.len().saturating_sub(after), waiting);
        true
    }

    fn take(&self) -> Option<Waiting> {
        self.queues.borrow_mut().iter_mut().find_map(VecDeque::pop_front)
    }

    fn drop_event(&self, event: u32) {
        self.queues.borrow_mut().iter_mut().for_each(|queue| queue.retain(|waiting| u32::from(waiting.event) != event));
    }

    /// No routine is attached to an event.
    fn forget(&self, event: u32) {
        self.drop_event(event);
        for (timed, _) in self.timed.iter().zip(TIMED_EVENTS).filter(|(_, timed)| timed.0 == event) {
            timed.due.set(NEVER);
        }
    }

    fn any_waiting(&self) -> bool {
        self.queues.borrow().iter().any(|queue| !queue.is_empty())
    }

    /// Drops waiting events and accepts no more.
    pub(super) fn abandon(&self) {
        self.enabled.set(false);
        self.queues.borrow_mut().iter_mut().for_each(VecDeque::clear);
    }
}

/// Number of the event's queue, and its priority there.
fn group_of(event: u8) -> (usize, u8) {
    let (group, priority) = event::TABLE
        .get(usize::from(event))
        .map_or((Group::InputOutput, u8::MAX), |event| (event.group, event.priority));
    (group as usize, priority)
}

impl S7200 {
    /// Whether this CPU has the event.
    fn has_event(&self, event: u32) -> bool {
        event < EVENTS && self.image.cpu.events >> event & 1 != 0
    }

    fn depth(&self, group: usize) -> usize {
        self.image.cpu.queues.get(group).map_or(1, |&depth| usize::from(depth.max(1)))
    }
}

impl Cpu {
    /// An event happened. It waits in the queue of its group until its routine can run, if one is attached.
    pub(crate) fn s7200_event(&self, event: u8, data: EventData) {
        let Some(own) = self.s7200() else { return };
        let interrupts = &own.interrupts;
        if !self.s7200_is_attached(event) {
            self.show_character(data);
            return;
        }
        if own.scan.stop_site.get().is_some() {
            return;
        }
        let (group, _) = group_of(event);
        if !interrupts.push(event, data, own.depth(group)) {
            set_special(&self.memory, STATUS, group as u8, true);
        }
        if interrupts.enabled.get() && !interrupts.running.get() {
            self.memory.raise_attention();
        }
    }

    fn show_character(&self, data: EventData) {
        if let Some((character, parity_error)) = data {
            self.memory.set_byte(special(CHARACTER), character);
            set_special(&self.memory, PARITY, 0, parity_error);
        }
    }

    /// True while an interrupt routine runs: some instructions are not allowed there (error 0004).
    pub(crate) fn s7200_in_interrupt(&self) -> bool {
        self.s7200().is_some_and(|own| own.interrupts.running.get())
    }

    /// Whether an interrupt routine is attached to an event.
    pub(crate) fn s7200_is_attached(&self, event: u8) -> bool {
        let routine = self.s7200().and_then(|own| own.interrupts.routine(event.into()));
        routine.is_some_and(|routine| routine.get().is_some())
    }

    /// The program was changed: detaches routines that it does not have. Result: which, a line each.
    pub(super) fn s7200_detach_missing(&self) -> Vec<String> {
        let Some(own) = self.s7200() else { return Vec::new() };
        let mut lines = Vec::new();
        for (event, place) in (0u32..).zip(&own.interrupts.routines) {
            if let Some(routine) = place.get().filter(|&routine| self.block(BlockKind::Int, routine).is_none()) {
                place.set(None);
                own.interrupts.forget(event);
                lines.push(format!("INT {routine} is gone: event {event} is detached from it"));
            }
        }
        lines
    }

    /// RUN begins: interrupts are disabled, nothing is attached.
    pub(super) fn s7200_start_interrupts(&self) {
        let Some(own) = self.s7200() else { return };
        let interrupts = &own.interrupts;
        interrupts.routines.iter().for_each(|routine| routine.set(None));
        interrupts.timed.iter().for_each(|timed| timed.due.set(NEVER));
        interrupts.abandon();
        interrupts.levels.set(self.edge_levels());
    }

    fn edge_levels(&self) -> u8 {
        self.driver.read(0, 1).unwrap_or(0) as u8 & ((1 << EDGE_INPUTS) - 1)
    }

    /// Events from now until the next call are simultaneous.
    pub(super) fn s7200_stamp_events(&self) {
        if let Some(own) = self.s7200() {
            own.interrupts.stamp.set(self.clock.now());
        }
    }

    /// Raises events for edges of I0.0 to I0.3 since the last look.
    pub(super) fn s7200_look_at_inputs(&self) {
        let Some(own) = self.s7200() else { return };
        let levels = self.edge_levels();
        let changed = own.interrupts.levels.replace(levels) ^ levels;
        for bit in (0..EDGE_INPUTS).filter(|bit| changed >> bit & 1 != 0) {
            if !self.s7200_counter_owns_input(bit) {
                let rising = levels >> bit & 1 != 0;
                self.s7200_event(2 * bit + u8::from(!rising), None);
            }
        }
    }

    /// When the next timed interrupt is due.
    pub(super) fn s7200_timed_due(&self) -> u64 {
        let due = |own: &S7200| own.interrupts.timed.iter().map(|timed| timed.due.get()).min();
        self.s7200().and_then(due).unwrap_or(NEVER)
    }

    /// Raises timed interrupts that are due, one for each period that has passed.
    pub(super) fn s7200_poll_timed(&self) {
        let Some(own) = self.s7200() else { return };
        let now = self.clock.now();
        for (timed, (event, _)) in own.interrupts.timed.iter().zip(TIMED_EVENTS) {
            let Some(late) = now.checked_sub(timed.due.get()) else { continue };
            let periods = late / timed.period.get().max(1) + 1;
            timed.due.set(timed.due.get().saturating_add(periods.saturating_mul(timed.period.get().max(1))));
            (0..periods.min(CATCH_UP_MAX)).for_each(|_| self.s7200_event(event as u8, None));
        }
    }

    /// Runs the routines of waiting events, if interrupts are enabled and none runs.
    #[inline(never)]
    pub(crate) fn s7200_dispatch(&self) {
        let Some(own) = self.s7200() else { return };
        let interrupts = &own.interrupts;
        if interrupts.running.get() {
            return;
        }
        while interrupts.enabled.get() && self.schedule.in_run.get() && !self.is_stopped() {
            let Some(waiting) = interrupts.take() else { break };
            self.run_interrupt(own, waiting);
        }
        // The main program continues: overflow bits of empty queues are 0 again.
        let empty = |queue: &VecDeque<Waiting>| queue.is_empty();
        for (group, _) in (0u8..).zip(interrupts.queues.borrow().iter()).filter(|(_, queue)| empty(queue)) {
            set_special(&self.memory, STATUS, group, false);
        }
        self.s7200_stop_between_scans();
    }

    fn run_interrupt(&self, own: &S7200, waiting: Waiting) {
        let interrupts = &own.interrupts;
        let routine = interrupts.routine(waiting.event.into()).and_then(Cell::get);
        let Some(block) = routine.and_then(|routine| self.block(BlockKind::Int, routine)) else { return };
        let monitor = &self.schedule.monitor;
        // Between scans a routine has its own monitoring, which finds an endless one.
        let between_scans = monitor.deadline.get() == NEVER && !own.scan.is_running.get();
        if between_scans {
            monitor.begin(self.clock.now());
            self.arm_hang();
            self.rearm();
        }
        let memory = &self.memory;
        let (flags, accumulators, depth) =
            (special(1), layout::SYSTEM + system::ACCUMULATORS, layout::SYSTEM + system::CALL_DEPTH);
        let saved = (memory.byte(flags), memory.bytes::<16>(accumulators), memory.dword(depth));
        memory.set_dword(depth, 0);
        self.show_character(waiting.data);
        interrupts.running.set(true);
        self.run_s7200_block(block, CLASS);
        interrupts.running.set(false);
        interrupts.leaving.set(false);
        memory.set_byte(flags, saved.0);
        memory.set_bytes(accumulators, saved.1);
        memory.set_dword(depth, saved.2);
        if between_scans {
            monitor.end();
        }
    }
}

pub(super) fn attach(cpu: &Cpu, operands: &Operands) -> u64 {
    let Some(own) = cpu.s7200() else { return 0 };
    let (routine, event) = (operands.a, operands.b);
    let known = u16::try_from(routine).ok().filter(|&number| cpu.block(BlockKind::Int, number).is_some());
    let (Some(number), Some(place), true) = (known, own.interrupts.routine(event), own.has_event(event)) else {
        return failed(cpu, operands, error::RANGE);
    };
    let input = (event / 2) as u8;
    if input < EDGE_INPUTS && cpu.s7200_counter_owns_input(input) {
        return failed(cpu, operands, error::EVENT_INPUT_IS_HSC);
    }
    // A preset that was reached before is not an event.
    match event {
        21 => cpu.s7200_timer_sync(32),
        22 => cpu.s7200_timer_sync(96),
        _ => {}
    }
    place.set(Some(number));
    for (timed, (_, byte)) in own.interrupts.timed.iter().zip(TIMED_EVENTS).filter(|(_, timed)| timed.0 == event) {
        let period = cpu.memory.byte(special(byte));
        let least = if own.image.cpu.old { OLD_PERIOD_LEAST } else { 1 };
        timed.period.set(u64::from(period) * NS_PER_MS);
        timed.due.set(if period < least { NEVER } else { cpu.clock.now().saturating_add(timed.period.get()) });
    }
    cpu.rearm();
    done()
}

pub(super) fn detach(cpu: &Cpu, operands: &Operands) -> u64 {
    let Some(own) = cpu.s7200() else { return 0 };
    let event = operands.a;
    let (Some(place), true) = (own.interrupts.routine(event), own.has_event(event)) else {
        return failed(cpu, operands, error::RANGE);
    };
    place.set(None);
    own.interrupts.forget(event);
    done()
}

pub(super) fn clear(cpu: &Cpu, operands: &Operands) -> u64 {
    match cpu.s7200() {
        Some(own) if own.has_event(operands.a) => {
            own.interrupts.drop_event(operands.a);
            done()
        }
        Some(_) => failed(cpu, operands, error::RANGE),
        None => 0,
    }
}

pub(super) fn enable(cpu: &Cpu, operands: &Operands) -> u64 {
    allow(cpu, operands, true)
}

pub(super) fn disable(cpu: &Cpu, operands: &Operands) -> u64 {
    allow(cpu, operands, false)
}

fn allow(cpu: &Cpu, operands: &Operands, on: bool) -> u64 {
    let Some(own) = cpu.s7200() else { return 0 };
    if own.interrupts.running.get() {
        return failed(cpu, operands, error::NOT_IN_INTERRUPT);
    }
    // A STOP of an interrupt routine has ended interrupts until the scan ends.
    let on = on && own.scan.stop_site.get().is_none();
    own.interrupts.enabled.set(on);
    set_special(&cpu.memory, STATUS, ENABLED_BIT, on);
    if on && own.interrupts.any_waiting() {
        cpu.memory.raise_attention();
    }
    done()
}
