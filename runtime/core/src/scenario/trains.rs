//! Trains of pulses that an entry begins.

use super::{Pulses, PulsesAt};
use crate::cpu::Cpu;
use crate::testing::AssertFailure;

/// Trains for counters of an S7-200 that the program has not defined yet: which inputs they are for depends on the mode.
#[derive(Default)]
pub(super) struct Trains {
    /// With the time at which each begins.
    waiting: Vec<(Pulses, u64)>,
}

impl Trains {
    /// A train begins at `time`. Result: why it cannot.
    pub fn begin(&mut self, cpu: &Cpu, pulses: &Pulses, time: u64, file: &str) -> Option<AssertFailure> {
        let Pulses { at, count, period, backward, .. } = *pulses;
        let begun = match at {
            PulsesAt::Counter(index) => {
                cpu.begin_pulses(index, period, count, backward);
                Ok(true)
            }
            PulsesAt::S7200(input) => cpu.s7200_begin_pulses(input, time, period, count, backward),
        };
        match begun {
            Ok(true) => None,
            Ok(false) => {
                self.waiting.push((pulses.clone(), time));
                None
            }
            Err(message) => Some(failure(pulses, file, message)),
        }
    }

    /// Begins those that wait, if they can begin now.
    pub fn retry(&mut self, cpu: &Cpu, file: &str) -> Vec<AssertFailure> {
        let waiting = std::mem::take(&mut self.waiting);
        waiting.iter().filter_map(|(pulses, time)| self.begin(cpu, pulses, *time, file)).collect()
    }

    /// Those that still wait at the end.
    pub fn never_begun(&self, file: &str) -> impl Iterator<Item = AssertFailure> {
        self.waiting.iter().map(move |(pulses, _)| failure(pulses, file, "(the counter is not defined)".to_string()))
    }
}

fn failure(pulses: &Pulses, file: &str, message: String) -> AssertFailure {
    AssertFailure {
        text: format!("pulses at {}", pulses.name),
        left: message,
        right: format!("{} pulses", pulses.count),
        ..AssertFailure::at(file, pulses.line)
    }
}
