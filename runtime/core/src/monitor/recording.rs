//! Recordings: values of signals in the cycles in which they change, from before an event on.

use std::collections::VecDeque;

use crate::cpu::Cpu;
use crate::signal::Source;

/// Signals of a recording, and samples that it keeps at most.
pub const SIGNALS_MAX: usize = 16;
pub const SAMPLES_MAX: usize = 100_000;

/// A signal has another value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub cycle: u64,
    /// Nanoseconds since the CPU started.
    pub time: u64,
    /// Number of the signal.
    pub signal: u8,
    /// Bits are 0 or 1, durations seconds. A value that is not a number is NaN.
    pub value: f64,
}

/// What a recording waits for: a signal comes over a value, or goes below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigger {
    pub signal: usize,
    pub level: f64,
    /// From below the level to it or above; otherwise the other way round.
    pub rising: bool,
}

/// What is recorded.
#[derive(Clone, Debug)]
pub struct Plan {
    pub signals: Vec<Source>,
    /// Without a trigger it begins at once.
    pub trigger: Option<Trigger>,
    pub samples: usize,
    /// Samples before the trigger that are kept.
    pub before: usize,
}

/// A recording that runs.
pub(crate) struct Recording {
    client: u64,
    plan: Plan,
    last: Vec<f64>,
    /// The values before the first sample.
    base: Vec<f64>,
    samples: VecDeque<Sample>,
    /// Number of samples before the trigger; `None`: it has not come.
    triggered: Option<usize>,
    cycle: u64,
}

/// What a recording has that was not told yet.
pub struct Progress {
    pub samples: Vec<Sample>,
    /// Number of samples before the trigger; `None`: it has not come.
    pub triggered: Option<usize>,
    /// The values of the signals before the first sample.
    pub base: Vec<f64>,
    /// No more samples will come.
    pub is_full: bool,
    /// The last cycle that was looked at, and its time.
    pub now: (u64, u64),
}

impl Recording {
    pub(crate) fn new(client: u64, mut plan: Plan) -> Recording {
        plan.signals.truncate(SIGNALS_MAX);
        plan.samples = plan.samples.clamp(1, SAMPLES_MAX);
        plan.before = plan.before.min(plan.samples - 1);
        let triggered = if plan.trigger.is_none() { Some(0) } else { None };
        let last = vec![f64::NAN; plan.signals.len()];
        let base = last.clone();
        Recording { client, plan, last, base, samples: VecDeque::new(), triggered, cycle: 0 }
    }

    /// After a cycle.
    pub(crate) fn look(&mut self, cpu: &Cpu) {
        let (cycle, time) = (cpu.cycle_number(), cpu.clock.now());
        let is_first = self.cycle == 0;
        if cycle == self.cycle {
            return;
        }
        self.cycle = cycle;
        for (signal, source) in (0..).zip(&self.plan.signals) {
            let value = source.read(cpu, None).number().unwrap_or(f64::NAN);
            let before = std::mem::replace(&mut self.last[usize::from(signal)], value);
            let is_same = value == before || value.is_nan() && before.is_nan() && !is_first;
            let is_full = self.samples.len() >= self.plan.samples;
            if is_same || is_full && self.triggered.is_some() {
                continue;
            }
            if let (Some(trigger), None) = (self.plan.trigger, self.triggered)
                && trigger.signal == usize::from(signal)
                && trigger.is_met(before, value)
            {
                self.triggered = Some(self.samples.len());
            }
            self.samples.push_back(Sample { cycle, time, signal, value });
            if self.triggered.is_none()
                && self.samples.len() > self.plan.before
                && let Some(gone) = self.samples.pop_front()
            {
                self.base[usize::from(gone.signal)] = gone.value;
            }
        }
    }

    /// No more samples will come.
    pub(crate) fn is_full(&self) -> bool {
        self.triggered.is_some() && self.samples.len() >= self.plan.samples
    }

    /// What comes after the first `told` samples, `most` at most. Before the trigger there is nothing.
    pub(crate) fn progress(&self, cpu: &Cpu, told: usize, most: usize) -> Progress {
        let samples = match self.triggered {
            Some(_) => self.samples.iter().skip(told).take(most).copied().collect(),
            None => Vec::new(),
        };
        let is_full = self.is_full();
        let (triggered, base) = (self.triggered, self.base.clone());
        Progress { samples, triggered, base, is_full, now: (cpu.cycle_number(), cpu.clock.now()) }
    }
}

impl Trigger {
    fn is_met(&self, before: f64, value: f64) -> bool {
        match self.rising {
            true => before < self.level && value >= self.level,
            false => before > self.level && value <= self.level,
        }
    }
}

impl Cpu {
    /// Records what a plan says for `client`, in place of what was recorded for it.
    pub fn start_recording(&self, client: u64, plan: Plan) {
        self.stop_recording(client);
        self.monitor.recordings.borrow_mut().push(Recording::new(client, plan));
    }

    /// Ends the recording of `client`. False: there is none.
    pub fn stop_recording(&self, client: u64) -> bool {
        let mut recordings = self.monitor.recordings.borrow_mut();
        let before = recordings.len();
        recordings.retain(|recording| recording.client != client);
        recordings.len() < before
    }

    /// After a cycle: all recordings look at their signals.
    pub fn record(&self) {
        for recording in self.monitor.recordings.borrow_mut().iter_mut() {
            recording.look(self);
        }
    }

    /// What the recording of `client` has after its first `told` samples, `most` at most. `None`: there is none.
    pub fn recorded(&self, client: u64, told: usize, most: usize) -> Option<Progress> {
        let recordings = self.monitor.recordings.borrow();
        let found = recordings.iter().find(|recording| recording.client == client)?;
        Some(found.progress(self, told, most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_keeps_room_for_the_event() {
        let plan = Plan { signals: Vec::new(), trigger: None, samples: 0, before: 9 };
        let recording = Recording::new(0, plan);
        assert_eq!((recording.plan.samples, recording.plan.before), (1, 0));
    }

    #[test]
    fn a_trigger_is_a_crossing() {
        let rising = Trigger { signal: 0, level: 1.0, rising: true };
        assert!(rising.is_met(0.0, 1.0) && !rising.is_met(1.0, 2.0) && !rising.is_met(f64::NAN, 2.0));
        let falling = Trigger { rising: false, ..rising };
        assert!(falling.is_met(2.0, 1.0) && !falling.is_met(1.0, 0.0) && !falling.is_met(2.0, f64::NAN));
    }
}
