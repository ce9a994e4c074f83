//! A model of a GRAPH function block in each call, written only from the reference, phase by phase. Source: GRAPH reference D and E.
//!
//! Where the reference leaves a choice, a comment `choice:` says which one is made here.
//!
//! `switch`: which transitions switch, and which steps are left and entered; `rows`: the rows of steps; here: all other phases.

mod rows;
mod switch;

use super::chart::{Bit, Chart, Coil, Condition, Input, Permanent};
use super::memory::{Inputs, Memory};
use super::state::{Mode, Outputs, StepState, TransitionState};

/// Requests of ON and OFF rows, until phase 7 of the next call.
#[derive(Clone, Debug, Default)]
struct Requests {
    /// In the order of the requesting rows.
    on: Vec<usize>,
    off: Vec<usize>,
}

/// An instance.
#[derive(Clone, Debug)]
pub struct Model {
    chart: Chart,
    pub steps: Vec<StepState>,
    pub transitions: Vec<TransitionState>,
    /// Active steps in the order of their activation.
    pub order: Vec<usize>,
    pub outputs: Outputs,
    previous: [bool; Input::ALL.len()],
    fresh: bool,
    last_call: i64,
    mode: Mode,
    halted: bool,
    times_halted: bool,
    zeroed: bool,
    interlocks: bool,
    supervisions: bool,
    acknowledge: bool,
    skip: bool,
    requests: Requests,
    /// Operands of event N rows that are 1 for this call.
    pulses: Vec<Bit>,
    /// The step in `S_NO`, and whether it was paged to.
    shown: Option<usize>,
    paged: bool,
    s_sel_old: i16,
    /// The transition in `T_NO`.
    shown_transition: Option<usize>,
}

impl Model {
    pub fn new(chart: &Chart) -> Model {
        Model {
            steps: vec![StepState::default(); chart.steps.len()],
            transitions: vec![TransitionState::default(); chart.transitions.len()],
            order: Vec::new(),
            outputs: Outputs::default(),
            previous: [false; Input::ALL.len()],
            fresh: true,
            last_call: 0,
            mode: Mode::Auto,
            halted: false,
            times_halted: false,
            zeroed: false,
            interlocks: true,
            supervisions: true,
            acknowledge: chart.acknowledge,
            skip: chart.skip,
            requests: Requests::default(),
            pulses: Vec::new(),
            shown: None,
            paged: false,
            s_sel_old: 0,
            shown_transition: None,
            chart: chart.clone(),
        }
    }

    /// One call at `now`, in milliseconds.
    pub fn call(&mut self, inputs: &Inputs, memory: &mut Memory, now: i64) {
        let fresh = std::mem::take(&mut self.fresh);
        let dt = if fresh { 0 } else { now - self.last_call };
        self.last_call = now;
        // 1 Inputs
        let mut edges = [false; Input::ALL.len()];
        for (index, edge) in edges.iter_mut().enumerate() {
            *edge = inputs.bits[index] && !self.previous[index];
        }
        self.previous = inputs.bits;
        let edge = |input: Input| edges[input as usize];
        self.switch(&edge);
        self.display(&edge, inputs.s_sel);
        // 2 Pre
        self.permanent(true, memory);
        // 3 Time
        self.time(dt, memory);
        // 4 Start/stop
        let requests = std::mem::take(&mut self.requests);
        let off = edge(Input::OffSq);
        let init = (edge(Input::InitSq) || fresh) && !off;
        if off || init {
            // choice: OFF and INIT go over everything else, so that requests of the last call, S_ON, S_OFF, T_PUSH, acknowledgements and
            // registrations are dropped.
            self.shown_transition = None;
            for step in self.order.clone() {
                self.leave(step, memory);
            }
            if init {
                let initial = (0..self.steps.len()).filter(|&step| self.chart.steps[step].initial).collect();
                self.enter_all(initial, self.may_switch(&edge), memory);
            }
        } else {
            // 5 Conditions
            self.conditions(memory);
            // 6 Monitoring
            self.monitor(&edge, memory);
            // 7 Selection, 8 Leave, 9 Enter
            self.switch_steps(&edge, &requests, memory);
        }
        // 10 Actions
        self.actions(memory);
        // 11 Post
        self.permanent(false, memory);
        // 12 Outputs
        self.output();
    }

    /// Phase 1: modes and toggles.
    ///
    /// choice: they change also in a call with an edge at OFF_SQ or INIT_SQ.
    fn switch(&mut self, edge: &dyn Fn(Input) -> bool) {
        let modes = [
            (Input::SwAuto, Mode::Auto),
            (Input::SwMan, Mode::Manual),
            (Input::SwTap, Mode::Tap),
            (Input::SwTop, Mode::Top),
        ];
        if let Some((_, mode)) = modes.into_iter().find(|&(input, _)| edge(input)) {
            self.mode = mode;
        }
        self.halted ^= edge(Input::HaltSq);
        self.times_halted ^= edge(Input::HaltTm);
        self.zeroed ^= edge(Input::ZeroOp);
        self.interlocks ^= edge(Input::EnIl);
        self.supervisions ^= edge(Input::EnSv);
        self.acknowledge ^= edge(Input::EnAckreq);
        self.skip ^= edge(Input::EnSskip);
    }

    /// Phase 1: the step that is shown.
    fn display(&mut self, edge: &dyn Fn(Input) -> bool, s_sel: i16) {
        let manual = self.mode == Mode::Manual;
        // choice: a change of S_SEL outside manual mode is not a change later.
        let changed = std::mem::replace(&mut self.s_sel_old, s_sel) != s_sel;
        if manual && changed {
            // choice: a number that no step has changes nothing.
            self.shown = self.numbered(s_sel).or(self.shown);
        }
        // choice: manual mode pages over all steps, the others over active ones; after the last one nothing changes. S_NEXT
        // goes over S_PREV.
        let number = self.shown.map_or(0, |step| self.chart.steps[step].number);
        let candidates = (0..self.steps.len()).filter(|&step| manual || self.steps[step].x);
        let numbers = candidates.map(|step| self.chart.steps[step].number);
        let previous = numbers.clone().filter(|&other| other < number).max();
        let next = numbers.filter(|&other| other > number).min();
        let paged = if edge(Input::SNext) { next } else { previous.filter(|_| edge(Input::SPrev)) };
        if let Some(number) = paged {
            self.shown = self.numbered(number);
            self.paged = !manual;
        }
    }

    fn numbered(&self, number: i16) -> Option<usize> {
        self.chart.steps.iter().position(|step| step.number == number)
    }

    fn permanent(&mut self, before: bool, memory: &mut Memory) {
        let list = if before { &self.chart.before } else { &self.chart.after };
        for Permanent { coil, operand, value } in list {
            let value = self.holds(value, memory);
            match coil {
                Coil::Assign => memory.set(*operand, value),
                Coil::Set if value => memory.set(*operand, true),
                Coil::Reset if value => memory.set(*operand, false),
                Coil::Set | Coil::Reset => {}
            }
        }
    }

    /// Phase 3: events of the last call end, times continue.
    fn time(&mut self, dt: i64, memory: &mut Memory) {
        // choice: TS holds for its call; TV and TT of a transition hold until its owner, the first of its FROM steps, has been left.
        for (transition, state) in self.chart.transitions.iter().zip(&mut self.transitions) {
            let owner = transition.from.iter().copied().min();
            if owner.is_none_or(|owner| self.steps[owner].s0 || !self.steps[owner].x) {
                *state = TransitionState::default();
            }
            state.ts = false;
        }
        for step in &mut self.steps {
            for event in
                [&mut step.s1, &mut step.s0, &mut step.l1, &mut step.l0, &mut step.v1, &mut step.v0, &mut step.a1]
            {
                *event = false;
            }
            step.r1 = false;
            if step.x && !self.times_halted {
                step.t += dt;
                if !step.la && !step.va {
                    step.u += dt;
                }
            }
        }
        // choice: an operand of an event N row becomes 0 together with the events.
        for bit in std::mem::take(&mut self.pulses) {
            memory.set(bit, false);
        }
    }

    /// Phase 5.
    fn conditions(&mut self, memory: &Memory) {
        for (index, transition) in self.chart.transitions.iter().enumerate() {
            let tv = transition.from.iter().all(|&step| self.steps[step].x);
            let tt = tv && self.satisfied(index, memory);
            self.transitions[index].tv = tv;
            self.transitions[index].tt = tt;
        }
        // choice: T_NO shows a transition as long as it is valid, then the first of the step that is active longest.
        let valid = |transition: &usize| self.transitions[*transition].tv;
        self.shown_transition =
            self.shown_transition.filter(valid).or_else(|| self.by_owners().into_iter().find(valid));
    }

    fn satisfied(&self, transition: usize, memory: &Memory) -> bool {
        self.chart.transitions[transition].condition.as_ref().is_none_or(|condition| self.holds(condition, memory))
    }

    /// Phase 6.
    fn monitor(&mut self, edge: &dyn Fn(Input) -> bool, memory: &Memory) {
        for step in self.order.clone() {
            let shown = self.shown == Some(step);
            self.watch(step, memory);
            if edge(Input::AckEf) || edge(Input::AckS) && shown {
                // choice: an acknowledgement in the call in which the fault comes counts.
                self.steps[step].acknowledged = self.steps[step].va && self.acknowledge;
            }
            let state = &mut self.steps[step];
            if state.va && state.acknowledged && !state.vs {
                state.va = false;
                state.v0 = true;
                state.a1 = true;
            }
            state.acknowledged &= state.va && self.acknowledge;
            if edge(Input::RegEf) || edge(Input::RegS) && shown {
                state.r1 = true;
            }
        }
    }

    /// Interlock and supervision of an active step, in phases 6 and 9.
    fn watch(&mut self, step: usize, memory: &Memory) {
        let Chart { steps, .. } = &self.chart;
        let interlock = steps[step].interlock.as_ref();
        let ls = !self.interlocks || interlock.is_none_or(|condition| self.holds(condition, memory));
        let state = &mut self.steps[step];
        state.ls = ls;
        state.l1 |= !ls && !state.la;
        state.l0 |= ls && state.la;
        state.la = !ls;
        let supervision = self.chart.steps[step].supervision.as_ref();
        let vs = self.supervisions && supervision.is_some_and(|condition| self.holds(condition, memory));
        let state = &mut self.steps[step];
        state.vs = vs;
        // choice: V1 comes with VA, not again while a fault waits for its acknowledgement.
        state.v1 |= vs && !state.va;
        if vs {
            state.va = true;
        } else if state.va && !self.acknowledge {
            state.va = false;
            state.v0 = true;
        }
    }

    /// Phase 12.
    fn output(&mut self) {
        self.show();
        let shown = self.shown.map(|step| (&self.chart.steps[step], &self.steps[step]));
        let error = self.steps.iter().any(|step| step.la);
        let fault = self.steps.iter().any(|step| step.va);
        self.outputs = Outputs {
            s_no: shown.map_or(0, |(step, _)| step.number),
            s_active: shown.is_some_and(|(_, state)| state.x),
            s_time: shown.map_or(0, |(_, state)| state.t),
            s_timeok: shown.map_or(0, |(_, state)| state.u),
            t_no: self.shown_transition.map_or(0, |transition| self.chart.transitions[transition].number),
            error,
            fault,
            err_flt: error || fault,
            sq_isoff: self.order.is_empty(),
            sq_halted: self.halted,
            tm_halted: self.times_halted,
            op_zeroed: self.zeroed,
            il_enabled: self.interlocks,
            sv_enabled: self.supervisions,
            ackreq_enabled: self.acknowledge,
            sskip_enabled: self.skip,
            auto_on: self.mode == Mode::Auto,
            tap_on: self.mode == Mode::Tap,
            top_on: self.mode == Mode::Top,
            man_on: self.mode == Mode::Manual,
        };
    }

    /// The step in `S_NO`. Source: GRAPH reference, E.2.
    fn show(&mut self) {
        let shows_active = self.shown.is_some_and(|step| self.steps[step].x);
        let lowest = self.order.iter().copied().min_by_key(|&step| self.chart.steps[step].number);
        // choice: manual mode keeps the step that it found, or none.
        self.paged &= self.mode != Mode::Manual;
        if self.mode != Mode::Manual && !(self.paged && shows_active) {
            self.paged = false;
            self.shown = lowest;
        }
    }

    fn holds(&self, condition: &Condition, memory: &Memory) -> bool {
        match condition {
            Condition::Constant(value) => *value,
            Condition::Bit(bit) => memory.bit(*bit),
            Condition::Step(step, member) => self.steps[*step].bit(*member),
            Condition::Transition(transition, member) => self.transitions[*transition].bit(*member),
            Condition::Time { step, undisturbed, order, ms } => {
                let state = &self.steps[*step];
                order.holds(if *undisturbed { state.u } else { state.t }, *ms)
            }
            Condition::Word { byte, order, value } => order.holds(memory.word(*byte).into(), (*value).into()),
            Condition::Timer(number) => memory.timer(*number),
            Condition::Counter(number) => memory.counters[usize::from(*number)] != 0,
            Condition::Not(inner) => !self.holds(inner, memory),
            Condition::And(list) => list.iter().all(|one| self.holds(one, memory)),
            Condition::Or(list) => list.iter().any(|one| self.holds(one, memory)),
            Condition::Xor(list) => list.iter().fold(false, |value, one| value ^ self.holds(one, memory)),
        }
    }
}
