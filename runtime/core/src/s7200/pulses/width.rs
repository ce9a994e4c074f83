//! Pulses of a PWM: cycles of one length, with pulses of one width. Source: S7-200 system manual, pulse output instruction.

use super::train::CYCLE_MIN;

/// Times that are in force from `start` on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pwm {
    start: u64,
    cycle: u64,
    width: u64,
    unit: u64,
}

impl Pwm {
    /// Cycle and width, in units of this many nanoseconds.
    pub fn new(cycle: u16, width: u16, unit: u64, start: u64) -> Pwm {
        let unit = unit.max(1);
        let nanoseconds = |units: u16| u64::from(units).saturating_mul(unit);
        Pwm { start, cycle: nanoseconds(cycle.max(CYCLE_MIN)), width: nanoseconds(width), unit }
    }

    /// The same times, from `start` on.
    pub fn begin_at(self, start: u64) -> Pwm {
        Pwm { start, ..self }
    }

    pub fn unit(&self) -> u64 {
        self.unit
    }

    /// With a width of 0 the output is off, with one of the cycle or more it is on: there are no pulses.
    fn has_pulses(&self) -> bool {
        self.width > 0 && self.width < self.cycle
    }

    fn cycles(&self, time: u64) -> u64 {
        time.saturating_sub(self.start) / self.cycle
    }

    fn cycle_begin(&self, number: u64) -> u64 {
        self.start.saturating_add(number.saturating_mul(self.cycle))
    }

    /// When the cycle that runs at `time` is over.
    pub fn cycle_end(&self, time: u64) -> u64 {
        self.cycle_begin(self.cycles(time).saturating_add(1))
    }

    /// Pulses that have begun at `time`. A pulse that begins when new times end a cycle belongs to the new times.
    pub fn begun(&self, time: u64) -> u64 {
        if self.has_pulses() && time >= self.start { self.cycles(time).saturating_add(1) } else { 0 }
    }

    /// When `pulse` begins, counted from 0.
    pub fn begin(&self, pulse: u64) -> Option<u64> {
        self.has_pulses().then(|| self.cycle_begin(pulse))
    }

    pub fn level(&self, time: u64) -> bool {
        time.saturating_sub(self.start) % self.cycle < self.width
    }

    /// Edges after `from`, up to `to`, in order.
    pub fn edges(&self, from: u64, to: u64) -> impl Iterator<Item = (u64, bool)> + use<> {
        let pwm = *self;
        let last = if pwm.has_pulses() { pwm.cycles(to).saturating_add(1) } else { 0 };
        let edges = (pwm.cycles(from)..last).flat_map(move |cycle| {
            let begin = pwm.cycle_begin(cycle);
            [(begin, true), (begin.saturating_add(pwm.width), false)]
        });
        edges.skip_while(move |&(time, _)| time <= from).take_while(move |&(time, _)| time <= to)
    }
}
