//! The history of a chart: which steps have become active while somebody looked, and when.

use std::collections::VecDeque;

use plcc_abi::monitor::Step;
use serde::Serialize;

use super::steps;
use crate::cpu::Cpu;

/// Activations that are kept; the oldest one makes room.
pub const KEPT_MAX: usize = 32;

const NS_PER_MS: u64 = 1_000_000;

/// A step that has become active.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Activation {
    pub step: String,
    /// The cycle, and the clock of the CPU in milliseconds since 1970.
    pub cycle: u64,
    pub clock_ms: i64,
    /// For how long it was active; `None`: it is.
    pub active_ms: Option<u64>,
}

/// What a chart has done in one instance, call by call.
#[derive(Default)]
pub(super) struct History {
    /// Which steps were active after the last call; empty before the first one.
    active: Vec<bool>,
    /// The newest one is the last.
    kept: VecDeque<Kept>,
}

struct Kept {
    /// Number of the step.
    step: usize,
    moment: Moment,
    active_ms: Option<u64>,
}

/// When a call ended.
#[derive(Clone, Copy)]
struct Moment {
    cycle: u64,
    clock_ms: i64,
    /// Nanoseconds since the CPU started: nobody sets this clock.
    now: u64,
}

impl History {
    /// After a call in the instance at this offset in memory.
    pub(super) fn call(&mut self, steps: &[Step], cpu: &Cpu, instance: u32) {
        let active = steps.iter().map(|step| steps::is_active(step, cpu, instance)).collect();
        let clock_ms = cpu.clock.wall().div_euclid(NS_PER_MS as i64);
        self.note(active, Moment { cycle: cpu.cycle_number(), clock_ms, now: cpu.clock.now() });
    }

    fn note(&mut self, active: Vec<bool>, moment: Moment) {
        // Since when a step is active that was so at the first look is not known.
        let before = std::mem::replace(&mut self.active, active);
        for (step, (was, is)) in before.into_iter().zip(&self.active).enumerate() {
            match (was, *is) {
                (false, true) => {
                    if self.kept.len() == KEPT_MAX {
                        self.kept.pop_front();
                    }
                    self.kept.push_back(Kept { step, moment, active_ms: None });
                }
                (true, false) => {
                    let last = self.kept.iter_mut().rev().find(|kept| kept.step == step);
                    if let Some(kept) = last {
                        kept.active_ms = Some(moment.now.saturating_sub(kept.moment.now) / NS_PER_MS);
                    }
                }
                (false, false) | (true, true) => {}
            }
        }
    }

    /// The activations, the newest one first.
    pub(super) fn list(&self, steps: &[Step]) -> Vec<Activation> {
        let of = |kept: &Kept| {
            Some(Activation {
                step: steps.get(kept.step)?.name.clone(),
                cycle: kept.moment.cycle,
                clock_ms: kept.moment.clock_ms,
                active_ms: kept.active_ms,
            })
        };
        self.kept.iter().rev().filter_map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(name: &str) -> Step {
        Step { name: name.to_string(), active: (0, 0), t: None, u: None, interlock: None, supervision: None }
    }

    fn at(cycle: u64) -> Moment {
        Moment { cycle, clock_ms: 1_000 + cycle as i64 * 10, now: cycle * 10 * NS_PER_MS }
    }

    #[test]
    fn steps_are_listed_with_the_time_in_which_they_were_active() {
        let steps = ["Wait", "Fill", "Stir"].map(step);
        let mut history = History::default();
        for (cycle, active) in [(1, [1, 0, 0]), (2, [1, 0, 0]), (5, [0, 1, 1]), (6, [0, 1, 1]), (9, [1, 0, 1])] {
            history.note(active.map(|bit| bit == 1).to_vec(), at(cycle));
        }
        let one = |step: &str, cycle: u64, active_ms| Activation {
            step: step.to_string(),
            cycle,
            clock_ms: 1_000 + cycle as i64 * 10,
            active_ms,
        };
        let expected = [one("Wait", 9, None), one("Stir", 5, None), one("Fill", 5, Some(40))];
        assert_eq!(history.list(&steps), expected);
    }

    #[test]
    fn the_oldest_activations_make_room() {
        let steps = [step("Odd"), step("Even")];
        let mut history = History::default();
        for cycle in 0..100 {
            history.note(vec![cycle % 2 == 1, cycle % 2 == 0], at(cycle));
        }
        let list = history.list(&steps);
        assert_eq!(list.len(), KEPT_MAX);
        assert_eq!((list[0].step.as_str(), list[0].cycle, list[0].active_ms), ("Odd", 99, None));
        assert_eq!((list[1].step.as_str(), list[1].cycle, list[1].active_ms), ("Even", 98, Some(10)));
    }
}
