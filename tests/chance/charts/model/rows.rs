//! Phase 10 of a call: the rows of steps.

use super::Model;
use crate::charts::chart::{Action, Event, Row, Time};
use crate::charts::memory::Memory;

impl Model {
    /// Phase 10.
    pub(super) fn actions(&mut self, memory: &mut Memory) {
        for step in self.order.clone() {
            let state = self.steps[step].clone();
            for row in self.chart.steps[step].rows.clone() {
                let due = match row.event {
                    None => true,
                    Some(Event::S1) => state.s1,
                    // They ran when the step was left.
                    Some(Event::S0) => false,
                    Some(Event::V1) => state.v1,
                    Some(Event::V0) => state.v0,
                    Some(Event::L1) => state.l1,
                    Some(Event::L0) => state.l0,
                    Some(Event::A1) => state.a1,
                    Some(Event::R1) => state.r1,
                };
                if due {
                    self.execute(step, &row, memory);
                }
            }
        }
    }

    /// A row whose time has come. Source: GRAPH reference, D.6 to D.8.
    pub(super) fn execute(&mut self, step: usize, row: &Row, memory: &mut Memory) {
        let state = &self.steps[step];
        let interlock = !row.interlock || !state.la;
        let elapsed = state.t;
        let time = |memory: &Memory, time| match time {
            Time::Constant(ms) => ms,
            Time::Memory(byte) => memory.dword(byte),
        };
        match row.action {
            Action::N(bit) if row.event.is_none() => memory.set(bit, interlock && !self.zeroed),
            Action::D(bit, t) => {
                let value = elapsed >= time(memory, t) && interlock && !self.zeroed;
                memory.set(bit, value);
            }
            Action::L(bit, t) => {
                let value = elapsed < time(memory, t) && interlock && !self.zeroed;
                memory.set(bit, value);
            }
            Action::TimerOff(timer, ms) => memory.off_delay(timer, interlock, ms),
            Action::N(_)
            | Action::S(_)
            | Action::R(_)
            | Action::Add { .. }
            | Action::Call(_)
            | Action::On(_)
            | Action::Off(_)
            | Action::OffAll
            | Action::CounterSet(..)
            | Action::CounterUp(_)
            | Action::CounterDown(_)
            | Action::CounterClear(_)
            | Action::TimerPulse(..)
            | Action::TimerDelay(..)
            | Action::TimerStop(_)
                if !interlock => {}
            Action::N(bit) => {
                // choice: zeroed operands are 0 also in event N rows; other rows continue.
                memory.set(bit, !self.zeroed);
                self.pulses.push(bit);
            }
            Action::S(bit) => memory.set(bit, true),
            Action::R(bit) => memory.set(bit, false),
            Action::Add { target, source, constant } => {
                let value = memory.word(source).wrapping_add(constant);
                memory.set_word(target, value);
            }
            Action::Call(_) if self.zeroed => {}
            Action::Call(byte) => memory.set_word(byte, memory.word(byte).wrapping_add(1)),
            Action::On(other) => self.requests.on.push(other),
            Action::Off(other) => self.requests.off.push(other),
            Action::OffAll => {
                let all = (0..self.steps.len()).filter(|&other| other != step || row.event != Some(Event::S1));
                self.requests.off.extend(all);
            }
            Action::CounterSet(counter, value) => memory.counters[usize::from(counter)] = value,
            Action::CounterUp(counter) => {
                let value = &mut memory.counters[usize::from(counter)];
                *value = (*value + 1).min(999);
            }
            Action::CounterDown(counter) => {
                let value = &mut memory.counters[usize::from(counter)];
                *value = value.saturating_sub(1);
            }
            Action::CounterClear(counter) => memory.counters[usize::from(counter)] = 0,
            Action::TimerPulse(timer, ms) => memory.start(timer, true, ms, false),
            // A timer that is over keeps its status when it is started again, until it is stopped.
            Action::TimerDelay(timer, ms) => memory.start(timer, memory.timer(timer), ms, true),
            Action::TimerStop(timer) => memory.start(timer, false, 0, false),
        }
    }
}
