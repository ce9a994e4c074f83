//! Startup and the cycle. Source: Programming with STEP 7, operating modes and the cycle.
//!
//! Startup OB, then again and again: inputs are set, process image of inputs, interrupts, OB 1, outputs, time passes.
//!
//! Interrupts enter at safepoints of OB 1 and while time passes between cycles.

use std::cell::RefMut;

use plcc_abi::image;
use plcc_abi::layout::{self, state};
use plcc_abi::ob::{OB_FREE, ObClass};

use crate::clock::NS_PER_MS;
use crate::communication::Communication;
use crate::cpu::{Area, Cpu};
use crate::diagnostics::NO_SITE;
use crate::events::StartInfo;
use crate::family::Family;
use crate::records::Records;
use crate::restart::{COLD, HOT};
use crate::watch::Trigger;

/// Priority of the OBs of the program cycle.
const CYCLE_PRIORITY: u8 = 1;

/// Who looks at the CPU between the phases: scenario, trace.
pub trait Observer {
    /// Before `cycle` reads its inputs; cycle 0 is before the startup OB. `time` in nanoseconds.
    fn before(&mut self, cpu: &Cpu, cycle: u64, time: u64);
    /// The inputs of `cycle` are in the process image; the program has not begun.
    fn begin(&mut self, _cpu: &Cpu, _cycle: u64) {}
    /// The program of `cycle` has run; the outputs are not written yet.
    fn end(&mut self, _cpu: &Cpu, _cycle: u64) {}
    /// After the outputs of `cycle`; cycle 0 is after the startup OB.
    fn after(&mut self, cpu: &Cpu, cycle: u64, time: u64);
    /// True if it only needs to see the last cycle: it does nothing in the others.
    fn rests(&self) -> bool {
        false
    }
}

/// How to run.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Number of OB 1 cycles; `None`: until STOP or [`end_requested`](crate::run::end_requested).
    pub cycles: Option<u64>,
    /// Nanoseconds from one cycle start to the next; virtual time moves by it at the end of each cycle.
    pub cycle_time: u64,
    /// Nanoseconds of host time for a cycle under the virtual clock.
    pub hang_limit: u64,
}

/// Shortest, longest and last time from cycle start to cycle start, in milliseconds.
#[derive(Default)]
pub(crate) struct CycleTimes {
    /// The last one in nanoseconds: the same once more changes nothing.
    last_ns: Option<u64>,
    pub last: u16,
    pub shortest: Option<u16>,
    pub longest: u16,
}

impl CycleTimes {
    #[inline]
    fn add(&mut self, ns: u64) {
        if self.last_ns.replace(ns) == Some(ns) {
            return;
        }
        let ms = (ns / NS_PER_MS).min(0x7FFF) as u16;
        self.last = ms;
        self.shortest = Some(self.shortest.map_or(ms, |shortest| shortest.min(ms)));
        self.longest = self.longest.max(ms);
    }
}

/// A CPU that is past its startup: where it is between two cycles.
pub struct Course {
    pace: Pace,
    times: CycleTimes,
    /// Number of the last cycle, 0 before the first.
    cycle: u64,
    last_start: Option<u64>,
    /// When the next cycle starts.
    next: u64,
    /// A cycle has ended, and the time until the next one has not passed.
    pauses: bool,
}

impl Course {
    /// Number of the last cycle, 0 before the first.
    pub fn cycle(&self) -> u64 {
        self.cycle
    }
}

impl Cpu {
    /// Startup and cycles. Returns the number of OB 1 cycles that were begun.
    pub fn execute(&self, pace: &Pace, observer: &mut dyn Observer) -> u64 {
        let mut course = self.begin(pace, observer);
        self.go_on(&mut course, observer, &|| false);
        self.end();
        course.cycle
    }

    /// Cycles until the end of the run or STOP, or, between two of them, until `is_wanted` says so. Then it may be called again.
    pub(crate) fn go_on(&self, course: &mut Course, observer: &mut dyn Observer, is_wanted: &dyn Fn() -> bool) {
        if !self.is_alone(observer) {
            return self.go_through::<dyn Family, false>(self.family, course, observer, is_wanted);
        }
        let before = course.cycle;
        self.family.go_on_alone(self, course, observer, is_wanted);
        if let Some(start) = course.last_start.filter(|_| course.cycle > before) {
            observer.after(self, course.cycle, start);
        }
    }

    /// Only the program takes part in the cycles, and nothing can join until they end: no scenario or trace, client, recording,
    /// retentive file, forced value, fast counter or hardware interrupt, under the virtual clock.
    fn is_alone(&self, observer: &dyn Observer) -> bool {
        self.clock.is_virtual()
            && observer.rests()
            && self.driver.is_still()
            && self.technology.is_unused()
            && self.tape.get().is_none()
            && self.retention.get().is_none()
            && !self.is_served.get()
            && !self.partners.is_attached()
            && !self.is_interfered()
    }

    /// [`go_on`](Cpu::go_on). `ALONE`: [`is_alone`](Cpu::is_alone); the cycles do not ask for others.
    #[inline]
    pub(crate) fn go_through<F: Family + ?Sized, const ALONE: bool>(
        &self,
        family: &F,
        course: &mut Course,
        observer: &mut dyn Observer,
        is_wanted: &dyn Fn() -> bool,
    ) {
        loop {
            if course.pauses && !self.is_stopped() {
                course.pauses = false;
                self.advance(course.next, false);
            }
            let has_more = course.pace.cycles.is_none_or(|cycles| course.cycle < cycles);
            if self.is_stopped() || !has_more || crate::run::end_requested() {
                return;
            }
            self.step::<F, ALONE>(family, course, observer);
            course.pauses = true;
            if let Some(tape) = self.tape.get().filter(|_| !ALONE) {
                match tape.end_cycle(self, course.next) {
                    Some(next) => course.next = next,
                    None => return,
                }
            }
            if is_wanted() {
                return;
            }
        }
    }

    /// Startup. After it [`go_on`](Cpu::go_on) or [`run_until`](Cpu::run_until), and at last [`end`](Cpu::end).
    pub fn begin(&self, pace: &Pace, observer: &mut dyn Observer) -> Course {
        self.schedule.hang_limit.set(pace.hang_limit);
        if self.clock.is_virtual() {
            self.watchdog.watch_beats(pace.hang_limit);
        }
        self.start_up(observer);
        Course {
            pace: *pace,
            times: CycleTimes::default(),
            cycle: 0,
            last_start: None,
            next: self.clock.now(),
            pauses: false,
        }
    }

    /// Under the virtual clock: everything that is due before `end`, and the clock is at `end` then. What is due at `end` itself sees what
    /// is set until the next call. In between no time passes.
    pub fn run_until(&self, course: &mut Course, end: u64, observer: &mut dyn Observer) {
        // However long the pause was.
        self.arm_hang();
        while !self.is_stopped() && course.next < end {
            if course.cycle > 0 {
                self.advance(course.next, false);
            }
            if !self.is_stopped() {
                self.step::<dyn Family, false>(self.family, course, observer);
            }
        }
        if !self.is_stopped() && self.clock.now() < end {
            self.advance(end - 1, false);
        }
        if self.is_stopped() {
            self.stop_outputs();
        }
        self.clock.move_to(end);
    }

    /// The end of the run.
    pub fn end(&self) {
        self.partners.exchange(true);
        self.watchdog.set(u64::MAX);
        self.watchdog.watch_beats(u64::MAX);
        if self.is_stopped() {
            // Also if an interrupt between two cycles was the cause.
            self.stop_outputs();
        }
        self.family.finish(self);
        self.keep_retentive(true);
    }

    /// A cycle, and what happens at its end.
    #[inline]
    fn step<F: Family + ?Sized, const ALONE: bool>(
        &self,
        family: &F,
        course: &mut Course,
        observer: &mut dyn Observer,
    ) {
        course.cycle += 1;
        let start = self.clock.now();
        let period = course.last_start.replace(start).map(|last| start.saturating_sub(last));
        if let Some(period) = period {
            course.times.add(period);
        }
        if !ALONE {
            self.exchange();
        }
        self.run_cycle::<F, ALONE>(family, course.cycle, start, &course.times, observer);
        if !ALONE || self.has_jobs.get() {
            self.communicate();
        }
        if !ALONE {
            self.serve_clients(&course.pace, start, period);
        }
        if self.has_jobs.get() {
            self.records.borrow_mut().work(self);
        }
        if !ALONE && self.retention.get().is_some() && !self.is_stopped() {
            self.keep_retentive(false);
        }
        // Under the real clock this is the time between cycle starts. Virtual time moves by it, in addition to the time
        // that passed within the cycle.
        let from = if self.clock.is_virtual() { self.clock.now() } else { start };
        course.next = from.saturating_add(course.pace.cycle_time);
    }

    fn start_up(&self, observer: &mut dyn Observer) {
        self.log(0x4301, NO_SITE, 0);
        self.arm_hang();
        self.rearm();
        self.family.power_on(self);
        self.meters.iter().for_each(|meter| meter.go_on(self.clock.now()));
        let ob = self.startup.get();
        observer.before(self, 0, self.clock.now());
        if ob != HOT {
            self.family.clear_inputs(self);
        }
        self.update_clock_memory();
        self.update_system_memory(false);
        self.set_configured_times();
        self.start_technology();
        self.family.start_hardware(self);
        // With retentive memory it is power that comes back, an automatic restart, unless a client asked for it.
        let automatic = self.retention.get().is_some() && !self.is_restarted;
        let cause = u8::from(automatic)
            + match ob {
                HOT => 0x83,
                COLD => 0x85,
                _ => 0x81,
            };
        let further = self.obs_of(ObClass::Startup).filter(|&other| other >= OB_FREE);
        for ob in std::iter::once(ob).filter(|&ob| self.has_ob(ob)).chain(further) {
            if !self.is_stopped() {
                let info = self.family.startup_info(self, StartInfo::new(0x13, cause, ob), automatic);
                self.run_ob(ob, self.priority_of(ob), info);
            }
        }
        if !self.is_stopped() {
            self.dispatch();
        }
        // From here on every OB has its first call.
        self.running.called.clear();
        if !self.is_stopped() {
            self.log(0x4302, NO_SITE, 0);
            self.start_interrupts(self.clock.now());
        }
        if self.is_stopped() {
            self.stop_outputs();
        }
        observer.after(self, 0, self.clock.now());
    }

    #[inline]
    fn run_cycle<F: Family + ?Sized, const ALONE: bool>(
        &self,
        family: &F,
        cycle: u64,
        start: u64,
        times: &CycleTimes,
        observer: &mut dyn Observer,
    ) {
        self.arm_hang();
        self.cycle.set(cycle);
        if !ALONE {
            observer.before(self, cycle, start);
        }
        self.update_clock_memory();
        self.update_system_memory(cycle == 1);
        if !ALONE || !self.driver.is_still() {
            self.read_inputs();
        }
        if !ALONE {
            observer.begin(self, cycle);
            if self.is_interfered() {
                self.interfere(Trigger::Begin);
            }
        }
        self.schedule.monitor.begin(start);
        if !ALONE {
            self.arm_watchdog();
        }
        family.begin_cycle(self, cycle, times);
        self.look_at_inputs();
        self.poll();
        family.dispatch(self);
        family.run_program(self, cycle, times);
        self.schedule.monitor.end();
        family.end_program(self);
        if !ALONE {
            observer.end(self, cycle);
        }
        if self.is_stopped() {
            self.stop_outputs();
        } else {
            if !ALONE && self.is_interfered() {
                self.interfere(Trigger::End);
            }
            if !ALONE && self.is_forcing() {
                self.force_memory();
            }
            family.write_outputs(self);
        }
        if !ALONE {
            observer.after(self, cycle, start);
        }
    }

    /// OB 1. On an S7-1200/1500, then the other OBs of the program cycle in the order of their numbers.
    #[inline]
    pub(crate) fn run_program_cycle(&self, cycle: u64, times: &CycleTimes) {
        for ob in &self.cycle_obs {
            if !self.is_stopped() {
                self.run_in_cycle(ob, CYCLE_PRIORITY, &self.cycle_info(ob.number, cycle, times));
            }
        }
    }

    fn cycle_info(&self, ob: u16, cycle: u64, times: &CycleTimes) -> StartInfo {
        let scan = match (cycle, self.startup.get()) {
            (1, 101) => 2,
            (1, 102) => 4,
            (1, _) => 1,
            (_, _) => 3,
        };
        StartInfo::of_cycle(scan, CYCLE_PRIORITY, ob, [times.last, times.shortest.unwrap_or(0), times.longest])
    }

    /// Connections for a block of the program.
    pub(crate) fn connections(&self) -> RefMut<'_, Communication> {
        self.has_jobs.set(true);
        self.communication.borrow_mut()
    }

    /// Data logs, recipes and files for a block of the program.
    pub(crate) fn record_jobs(&self) -> RefMut<'_, Records> {
        self.has_jobs.set(true);
        self.records.borrow_mut()
    }

    /// Moves connections on, or ends them in STOP. Without a real clock the partner gets some time here if a block waits for it.
    fn communicate(&self) {
        self.partners.exchange(self.is_stopped());
        let mut communication = self.communication.borrow_mut();
        if self.is_stopped() {
            communication.close_all();
            return;
        }
        if communication.is_open() {
            communication.work(self.clock.now());
        }
        if communication.take_waiting() && self.clock.is_virtual() {
            std::thread::sleep(crate::communication::PATIENCE);
        }
    }

    /// Copies the named inputs into the process image.
    pub(crate) fn read_inputs(&self) {
        self.show_counters();
        let (base, length) = self.area(Area::Inputs);
        self.driver.named(length, &mut |address, value| self.memory.set_byte(base + address, value));
        if self.is_forcing() {
            self.force_inputs();
            self.force_memory();
        }
    }

    /// What clients modify, once in a cycle, and over it and over what a watch table has modified what is forced.
    #[cold]
    fn interfere(&self, trigger: Trigger) {
        if self.is_modifying() {
            self.carry_out_jobs(trigger);
        }
        if self.is_forcing() {
            if trigger == Trigger::Begin {
                self.force_inputs();
            }
            self.force_memory();
        }
    }

    /// Outputs of the modules in STOP.
    pub(crate) fn stop_outputs(&self) {
        self.driver.stop();
        self.family.stop_outputs(self);
    }

    /// Copies the process image of outputs to the modules.
    pub(crate) fn write_outputs(&self) {
        if self.is_forcing() {
            self.force_memory();
        }
        self.family.write_outputs(self);
    }

    /// Copies the process image of outputs to the modules as it is.
    #[inline]
    pub(crate) fn write_output_image(&self) {
        let (base, length) = self.changed_outputs();
        if self.is_forcing() {
            return self.write_forced_image(base, length);
        }
        if length > 0 {
            self.memory.view(base, length, |image| self.driver.write_image(image));
        }
    }

    /// Where the process image of outputs is, and the bytes of it that can have changed: those that the program uses,
    /// and up to where something else may have written.
    #[inline]
    pub(crate) fn changed_outputs(&self) -> (u32, u32) {
        let (base, length) = self.area(Area::Outputs);
        if self.memory.state32::<{ state::OUTPUTS_WRITTEN }>() != 0 {
            self.memory.set_state::<{ state::OUTPUTS_WRITTEN }, 4>([0; 4]);
            self.note_outputs(u32::MAX);
        }
        (base, length.min(self.image.outputs_used.max(self.outputs_changed.take())))
    }

    /// Something besides the code of the program may change outputs before byte `end` in the process image.
    pub fn note_outputs(&self, end: u32) {
        self.outputs_changed.set(self.outputs_changed.get().max(end));
    }

    /// The clock memory byte: bits 0-7 have periods of 0.1, 0.2, 0.4, 0.5, 0.8, 1, 1.6 and 2 s, half of each 0, then 1.
    #[inline]
    pub(crate) fn update_clock_memory(&self) {
        if let Some(byte) = self.image.config.clock_memory_byte {
            self.write_clock_memory(byte);
        }
    }

    #[inline(never)]
    fn write_clock_memory(&self, byte: u16) {
        const HALF_PERIOD_MS: [u64; 8] = [50, 100, 200, 250, 400, 500, 800, 1000];
        let ms = self.clock.now() / NS_PER_MS;
        let value = (0u32..).zip(HALF_PERIOD_MS).fold(0, |bits, (bit, half)| bits | ((ms / half) as u8 & 1) << bit);
        if u32::from(byte) < self.area(Area::BitMemory).1 {
            self.memory.set_byte(layout::M + u32::from(byte), value);
        }
    }

    /// The system memory byte: bit 0 in the first cycle, 1 in a cycle after a change of diagnostics, 2 always, 3 never.
    /// Source: LAD/FBD reference for S7-1200, memory areas and scan.
    fn update_system_memory(&self, first: bool) {
        let Some(byte) = self.image.config.system_memory_byte else { return };
        let changed = self.diagnostics_changed.replace(false);
        let value = u8::from(first) | u8::from(changed) << 1 | 1 << 2;
        if u32::from(byte) < self.area(Area::BitMemory).1 {
            self.memory.set_byte(layout::M + u32::from(byte), value);
        }
    }

    /// Reads a peripheral input; bit 32 of the result: no module there.
    pub(crate) fn peripheral_read(&self, address: u32, bytes: u32) -> u64 {
        const MISSING: u64 = 1 << 32;
        match bytes {
            1 | 2 | 4 => {
                self.family.before_input(self);
                let counter = self.read_counter(address, bytes);
                let value = counter.or_else(|| self.driver.read(address, bytes));
                value.map_or(MISSING, |value| self.forced_input(address, bytes, value).into())
            }
            _ => MISSING,
        }
    }

    /// Writes a peripheral output, and the process image where it covers the address. True: no module there.
    pub fn peripheral_write(&self, address: u32, bytes: u32, value: u32) -> bool {
        if !matches!(bytes, 1 | 2 | 4) {
            return true;
        }
        let forced = self.forced_output(address, bytes, value);
        if !self.driver.write(address, bytes, self.at_module(address, bytes, forced)) {
            return true;
        }
        let value = if self.image.profile.family == image::Family::S7400 { forced } else { value };
        self.family.output_written(self, address, bytes, value);
        let (base, length) = self.area(Area::Outputs);
        for index in 0..bytes {
            let byte = address.saturating_add(index);
            if byte < length {
                self.memory.set_byte(base + byte, (value >> (8 * (bytes - 1 - index))) as u8);
            }
        }
        false
    }

    /// Writes one bit of a peripheral output byte, and of the process image where it covers the byte. True: no module there.
    pub(crate) fn peripheral_write_bit(&self, address: u32, bit: u32, value: bool) -> bool {
        let mask = 1u8 << (bit & 7);
        let with_bit = |byte: u8| if value { byte | mask } else { byte & !mask };
        let module = u32::from(with_bit(self.driver.output(address, 1) as u8));
        let module = self.forced_output(address, 1, module);
        if !self.driver.write(address, 1, self.at_module(address, 1, module)) {
            return true;
        }
        let (base, length) = self.area(Area::Outputs);
        if address < length {
            self.memory.set_byte(base + address, with_bit(self.memory.byte(base + address)));
        }
        false
    }

    /// Ends waiting between cycles when the process must end.
    pub(crate) fn schedule_ended(&self) -> bool {
        self.running.priority.get() == 0 && crate::run::end_requested()
    }
}
