//! Looks at the probes of the running program, and keeps what the chosen call sees.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use plcc_abi::monitor::Step;
use plcc_lower::probe::{Place, Probe};
use plcc_model::{CellKind, Program};
use plcc_runtime::cpu::Cpu;
use plcc_runtime::monitor::steps::{self, StepSeen};
use plcc_runtime::monitor::{address_of, text_of};
use plcc_runtime::probe::{Registers, Watcher};

use crate::choice::Choice;
use crate::graph;

/// What a probe has shown last.
#[derive(Clone, Debug)]
pub enum Seen {
    /// The registers, and the timer or counter of the statement as a text.
    Registers(Registers, Option<String>),
    /// A value, zero-extended.
    Value(u64),
    /// A logic stack with ENO, and the operands of the statement with their values.
    Stack(u64, Vec<(String, String)>),
}

/// What the chosen call has seen.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// By place.
    pub seen: HashMap<u32, Seen>,
    /// The blocks on the way to the call, by the places of their probes, the block itself last.
    pub path: Vec<u32>,
    /// The DB of its instance.
    pub instance: Option<u16>,
    /// Steps of a chart at the end of the call.
    pub steps: Vec<StepSeen>,
    /// Nanoseconds since the CPU started.
    pub time: u64,
}

/// See the module comment.
pub struct Recorder {
    places: Rc<[Place]>,
    choice: Choice,
    steps: Vec<Step>,
    state: RefCell<State>,
}

#[derive(Default)]
struct State {
    /// The blocks that run now: places of their probes, and their instances.
    running: Vec<(u32, u32)>,
    /// Number of calls that fit so far.
    calls: u32,
    /// Number of blocks that run when the chosen one runs.
    depth: Option<usize>,
    recorded: Option<Recorded>,
    /// Calls of the block in this cycle that were not the chosen one.
    others: Vec<Other>,
}

/// A call that was not the chosen one: the blocks on the way to it, by the places of their probes, and the DB of its instance.
pub type Other = (Vec<u32>, Option<u16>);

/// So many of them are kept.
const OTHERS_MAX: usize = 10;

impl Recorder {
    pub fn new(program: &Program, places: Rc<[Place]>, choice: Choice) -> Recorder {
        let steps = graph::steps(program, choice.block);
        Recorder { places, choice, steps, state: RefCell::default() }
    }

    /// What the call has seen; `None`: there was no such call.
    pub fn recorded(&self) -> Option<Recorded> {
        self.state.borrow().recorded.clone()
    }

    /// Calls of the block in the cycle before the chosen one, at most as many as a message can name.
    pub fn others(&self) -> Vec<Other> {
        self.state.borrow().others.clone()
    }

    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// Whether the call that has just begun fits all but its number.
    fn fits(&self, running: &[(u32, u32)], instance: Option<u16>) -> bool {
        let block = |&(place, _): &(u32, u32)| self.places.get(place as usize).map(|place| place.block);
        let Some((last, callers)) = running.split_last() else { return false };
        let wanted = &self.choice.call;
        let mut path = callers.iter().rev().map(block);
        block(last) == Some(self.choice.block)
            && wanted.instance.is_none_or(|db| instance == Some(db))
            && wanted.path.iter().rev().all(|key| path.next().flatten() == Some(*key))
    }

    /// Keeps what a probe of the chosen call tells.
    fn keep(&self, place: u32, seen: impl FnOnce(&Place) -> Seen) {
        let mut state = self.state.borrow_mut();
        if state.depth.is_none_or(|depth| depth != state.running.len()) {
            return;
        }
        let Some(at) = self.places.get(place as usize).filter(|at| at.block == self.choice.block) else { return };
        if let Some(recorded) = &mut state.recorded {
            recorded.seen.insert(place, seen(at));
        }
    }
}

impl Watcher for Recorder {
    fn enter(&self, cpu: &Cpu, place: u32, instance: u32) {
        let mut state = self.state.borrow_mut();
        state.running.push((place, instance));
        if cpu.cycle_number() != self.choice.cycle || state.recorded.is_some() {
            return;
        }
        let db = cpu.db_at(instance).map(|(db, _)| db.number);
        let path: Vec<u32> = state.running.iter().map(|(place, _)| *place).collect();
        if self.fits(&state.running, db) {
            state.calls += 1;
            if state.calls == self.choice.call.number.max(1) {
                state.depth = Some(state.running.len());
                state.recorded = Some(Recorded { path, instance: db, time: cpu.clock.now(), ..Recorded::default() });
                return;
            }
        }
        let is_block = self.places.get(place as usize).is_some_and(|place| place.block == self.choice.block);
        if is_block && state.others.len() < OTHERS_MAX {
            state.others.push((path, db));
        }
    }

    fn leave(&self, cpu: &Cpu, _place: u32) {
        let mut state = self.state.borrow_mut();
        if state.depth == Some(state.running.len()) {
            state.depth = None;
            let instance = state.running.last().map_or(0, |(_, instance)| *instance);
            if let Some(recorded) = &mut state.recorded {
                recorded.steps = steps::seen(&self.steps, cpu, instance);
            }
        }
        state.running.pop();
    }

    fn registers(&self, cpu: &Cpu, place: u32, registers: Registers) {
        self.keep(place, |at| {
            let cell = match at.probe {
                Probe::Registers(Some((CellKind::Timer, number))) => text_of(cpu, &format!("T{number}")),
                Probe::Registers(Some((CellKind::Counter, number))) => text_of(cpu, &format!("C{number}")),
                _ => None,
            };
            Seen::Registers(registers, cell)
        });
    }

    fn value(&self, cpu: &Cpu, place: u32, value: u64) {
        self.keep(place, |at| match &at.probe {
            Probe::Stack(operands) => {
                let named =
                    operands.iter().filter_map(|name| Some((address_of(name).to_string(), text_of(cpu, name)?)));
                Seen::Stack(value, named.collect())
            }
            _ => Seen::Value(value),
        });
    }
}
