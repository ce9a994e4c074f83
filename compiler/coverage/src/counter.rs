//! Counts what the probes of a running program tell.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_lower::probe::Place;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::probe::Watcher;

use crate::chart::ChartCounts;

/// How often each probe has shown 0, and another value.
pub type Counts = Vec<[u64; 2]>;

/// See the module comment.
pub struct Counter {
    places: Rc<[Place]>,
    state: RefCell<State>,
}

struct State {
    counts: Counts,
    charts: Vec<ChartCounts>,
    /// Instances of the blocks that run.
    running: Vec<u32>,
}

impl Counter {
    pub fn new(places: Rc<[Place]>, charts: Vec<ChartCounts>) -> Counter {
        let counts = vec![[0; 2]; places.len()];
        Counter { places, state: RefCell::new(State { counts, charts, running: Vec::new() }) }
    }

    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// What has been counted so far.
    pub fn counted(&self) -> (Counts, Vec<ChartCounts>) {
        let state = self.state.borrow();
        (state.counts.clone(), state.charts.clone())
    }

    fn count(&self, place: u32, value: bool) {
        if let Some(count) = self.state.borrow_mut().counts.get_mut(place as usize) {
            count[usize::from(value)] += 1;
        }
    }
}

impl Watcher for Counter {
    fn enter(&self, _cpu: &Cpu, place: u32, instance: u32) {
        self.count(place, true);
        self.state.borrow_mut().running.push(instance);
    }

    fn leave(&self, cpu: &Cpu, place: u32) {
        let state = &mut *self.state.borrow_mut();
        let instance = state.running.pop().unwrap_or(0);
        let Some(block) = self.places.get(place as usize).map(|place| place.block) else { return };
        if let Some(chart) = state.charts.iter_mut().find(|chart| chart.block == block) {
            chart.look(cpu, instance);
        }
    }

    fn value(&self, _cpu: &Cpu, place: u32, value: u64) {
        self.count(place, value != 0);
    }
}
