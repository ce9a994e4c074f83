//! Phases 7 to 9 of a call: which transitions switch, and which steps are left and entered.

use super::{Model, Requests};
use crate::charts::chart::{Action, Event, Input, Interface, Transition};
use crate::charts::memory::Memory;
use crate::charts::state::Mode;

impl Model {
    /// Phases 7 to 9.
    pub(super) fn switch_steps(&mut self, edge: &dyn Fn(Input) -> bool, requests: &Requests, memory: &mut Memory) {
        // choice: in a halted sequencer ON and OFF wait, S_ON and S_OFF do nothing.
        if self.halted {
            self.requests = requests.clone();
            return;
        }
        let (mut on, mut off) = (requests.on.clone(), requests.off.clone());
        if let (Mode::Manual, Some(shown)) = (self.mode, self.shown) {
            if edge(Input::SOn) {
                on.push(shown);
            }
            if edge(Input::SOff) {
                off.push(shown);
            }
        }
        let active: Vec<bool> = self.steps.iter().map(|step| step.x).collect();
        let mut left = vec![false; self.steps.len()];
        for &step in &off {
            left[step] |= active[step];
        }
        // choice: OFF goes before transitions: those of a step that is switched off do not fire, but others may enter it.
        let mut entered = Vec::new();
        for transition in self.select(edge, &left) {
            self.transitions[transition].ts = true;
            for &step in &self.chart.transitions[transition].from {
                left[step] = true;
            }
            entered.extend(&self.chart.transitions[transition].to);
        }
        // choice: what is active before the switch is an "already active step", even if it is left in this call.
        entered.extend(on.into_iter().filter(|&step| !active[step] && !off.contains(&step)));
        // choice: steps are left in the order of their activation.
        for step in self.order.clone() {
            if left[step] {
                self.leave(step, memory);
            }
        }
        self.enter_all(entered, self.may_switch(edge), memory);
    }

    /// Whether satisfied transitions fire. Source: GRAPH reference, D.11.
    pub(super) fn may_switch(&self, edge: &dyn Fn(Input) -> bool) -> bool {
        match self.mode {
            Mode::Auto | Mode::Top => !self.halted,
            Mode::Tap => !self.halted && edge(Input::TPush),
            Mode::Manual => false,
        }
    }

    /// Phase 9: enters steps, or those that come instead of them, once each. Source: GRAPH reference, D.9, skip steps.
    ///
    /// choice: steps are skipped however they would be entered, where transitions may fire. The time of this step begins with 0. The
    /// first satisfied transition by priority counts; its TS stays 0, and its steps come in place of that one.
    pub(super) fn enter_all(&mut self, steps: Vec<usize>, may_skip: bool, memory: &Memory) {
        let mut met = vec![false; self.steps.len()];
        for step in steps {
            self.enter_or_skip(step, self.skip && may_skip, &mut met, &mut Vec::new(), memory);
        }
    }

    /// choice: a step that is met again on the way is entered, where it was met before it is not looked at again.
    fn enter_or_skip(&mut self, step: usize, skip: bool, met: &mut [bool], way: &mut Vec<usize>, memory: &Memory) {
        if way.contains(&step) {
            self.enter(step, memory);
            return;
        }
        if std::mem::replace(&mut met[step], true) {
            return;
        }
        let mut next = None;
        if skip {
            (self.steps[step].t, self.steps[step].u) = (0, 0);
            next = self.way_on(step, memory);
        }
        match next {
            None => self.enter(step, memory),
            Some(transition) => {
                way.push(step);
                for next in self.chart.transitions[transition].to.clone() {
                    self.enter_or_skip(next, skip, met, way, memory);
                }
                way.pop();
            }
        }
    }

    /// The first satisfied transition that leaves this step alone.
    fn way_on(&self, step: usize, memory: &Memory) -> Option<usize> {
        let outgoing = |index: &usize| self.chart.transitions[*index].from == [step];
        (0..self.chart.transitions.len()).rev().filter(outgoing).find(|&index| self.satisfied(index, memory))
    }

    /// Transitions that switch.
    fn select(&self, edge: &dyn Fn(Input) -> bool, off: &[bool]) -> Vec<usize> {
        if self.mode == Mode::Manual {
            return Vec::new();
        }
        let push = edge(Input::TPush);
        let permitted = self.may_switch(edge);
        // choice: T_PUSH does not force a step that has a fault; ACK_EF lifts the fault, not the mode. Without T_NO the leftmost
        // is the first that has no fault, of the step that is active longest.
        let blocked = |index: usize| {
            let mut from = self.chart.transitions[index].from.iter();
            !edge(Input::AckEf) && from.any(|&step| self.steps[step].va)
        };
        let free = |index: &usize| self.transitions[*index].tv && !blocked(*index);
        let forced = match self.chart.interface {
            _ if self.mode != Mode::Top || !push => None,
            Interface::Maximum => self.shown_transition,
            Interface::Standard | Interface::Minimum => self.walk().into_iter().find(free),
        };
        let mut consumed = off.to_vec();
        let mut fired = Vec::new();
        for index in self.walk() {
            let from = &self.chart.transitions[index].from;
            let state = &self.transitions[index];
            let satisfied = state.tt && permitted || forced == Some(index);
            if state.tv && satisfied && !blocked(index) && !from.iter().any(|&step| consumed[step]) {
                from.iter().for_each(|&step| consumed[step] = true);
                fired.push(index);
            }
        }
        fired
    }

    /// Transitions in the order in which they are checked. It matters where they share no FROM step.
    ///
    /// choice: as their owners were activated; after them joins with a rival, and their rivals.
    fn walk(&self) -> Vec<usize> {
        let transitions = &self.chart.transitions;
        let rivals = |a: &Transition, b: &Transition| {
            (a.from.len() > 1 || b.from.len() > 1) && a.from.iter().any(|step| b.from.contains(step))
        };
        let late = |index: &usize| {
            (0..transitions.len()).any(|other| other != *index && rivals(&transitions[*index], &transitions[other]))
        };
        let mut walk = self.by_owners();
        walk.retain(|index| !late(index));
        walk.extend((0..transitions.len()).rev().filter(late));
        walk
    }

    /// Transitions in the order in which their owners were activated; those of one owner by priority.
    pub(super) fn by_owners(&self) -> Vec<usize> {
        let place = |index: &usize| {
            let owner = self.chart.transitions[*index].from.iter().copied().min();
            self.order.iter().position(|&step| Some(step) == owner).unwrap_or(usize::MAX)
        };
        let mut list: Vec<usize> = (0..self.chart.transitions.len()).rev().collect();
        list.sort_by_key(place);
        list
    }

    /// Phase 8.
    pub(super) fn leave(&mut self, step: usize, memory: &mut Memory) {
        let state = &mut self.steps[step];
        state.x = false;
        state.s0 = true;
        self.order.retain(|&other| other != step);
        let rows = self.chart.steps[step].rows.clone();
        for row in rows.iter().filter(|row| row.event == Some(Event::S0)) {
            self.execute(step, row, memory);
        }
        for row in rows.iter().filter(|row| row.event.is_none()) {
            if let Action::N(bit) | Action::D(bit, _) | Action::L(bit, _) = row.action {
                memory.set(bit, false);
            }
            if let Action::TimerOff(timer, ms) = row.action {
                memory.off_delay(timer, false, ms);
            }
        }
        let state = &mut self.steps[step];
        // choice: the raw results LS and VS stay as they were.
        (state.la, state.va) = (false, false);
        state.acknowledged = false;
    }

    /// Phase 9.
    ///
    /// choice: a step that is active and not left in this call is entered again, and is the last in the order of activation.
    fn enter(&mut self, step: usize, memory: &Memory) {
        self.order.retain(|&other| other != step);
        self.order.push(step);
        let state = &mut self.steps[step];
        state.x = true;
        state.s1 = true;
        state.t = 0;
        state.u = 0;
        self.watch(step, memory);
    }
}
