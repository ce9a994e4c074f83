//! A model of a GRAPH function block in each call, written only from the reference, phase by phase. Source: GRAPH reference D and E.
//!
//! Where the reference leaves a choice, a comment `choice:` says which one is made here.

use super::chart::{
    Action, Area, Bit, Chart, Coil, Condition, Event, Input, Interface, Permanent, Row, StepBit, Time, Transition,
    TransitionBit,
};

/// Memory that charts work on.
#[derive(Clone, Debug)]
pub struct Memory {
    pub inputs: [u8; 8],
    pub outputs: [u8; 8],
    pub bit_memory: [u8; 256],
    /// Static variables of the block.
    pub statics: [u8; 1],
    pub counters: [u16; 16],
    timers: [Timer; 16],
    /// Time of the cycle in milliseconds.
    pub now: i64,
}

/// A timer. Source: Statement List (STL), chapter 12.
#[derive(Clone, Copy, Debug, Default)]
struct Timer {
    /// Status until `deadline`, and from then on.
    during: bool,
    after: bool,
    deadline: i64,
    /// The last value of an off-delay.
    rlo: bool,
}

impl Memory {
    pub fn new() -> Memory {
        Memory {
            inputs: [0; 8],
            outputs: [0; 8],
            bit_memory: [0; 256],
            statics: [0; 1],
            counters: [0; 16],
            timers: [Timer::default(); 16],
            now: 0,
        }
    }

    /// Status of a timer.
    pub fn timer(&self, number: u8) -> bool {
        let timer = &self.timers[usize::from(number)];
        if self.now < timer.deadline { timer.during } else { timer.after }
    }

    /// The status is `during` for so long, then `after`.
    fn start(&mut self, number: u8, during: bool, ms: i64, after: bool) {
        let timer = &mut self.timers[usize::from(number)];
        (timer.during, timer.after, timer.deadline) = (during, after, self.now + ms);
    }

    /// An off-delay sees whether its row is on.
    fn off_delay(&mut self, number: u8, rlo: bool, ms: i64) {
        let was = std::mem::replace(&mut self.timers[usize::from(number)].rlo, rlo);
        match (was, rlo) {
            (false, true) => self.start(number, true, 0, true),
            (true, false) => self.start(number, true, ms, false),
            (true, true) | (false, false) => {}
        }
    }

    fn byte(&mut self, area: Area, byte: u8) -> &mut u8 {
        let byte = usize::from(byte);
        match area {
            Area::I => &mut self.inputs[byte],
            Area::Q => &mut self.outputs[byte],
            Area::M => &mut self.bit_memory[byte],
            Area::Static => &mut self.statics[byte],
        }
    }

    pub fn bit(&self, bit: Bit) -> bool {
        let bytes: &[u8] = match bit.area {
            Area::I => &self.inputs,
            Area::Q => &self.outputs,
            Area::M => &self.bit_memory,
            Area::Static => &self.statics,
        };
        bytes[usize::from(bit.byte)] >> bit.bit & 1 != 0
    }

    pub fn set(&mut self, bit: Bit, value: bool) {
        let mask = 1 << bit.bit;
        let byte = self.byte(bit.area, bit.byte);
        *byte = if value { *byte | mask } else { *byte & !mask };
    }

    pub fn word(&self, byte: u8) -> i16 {
        let at = usize::from(byte);
        i16::from_be_bytes([self.bit_memory[at], self.bit_memory[at + 1]])
    }

    pub fn set_word(&mut self, byte: u8, value: i16) {
        let at = usize::from(byte);
        self.bit_memory[at..at + 2].copy_from_slice(&value.to_be_bytes());
    }

    fn dword(&self, byte: u8) -> i64 {
        let at = usize::from(byte);
        let bytes = self.bit_memory[at..at + 4].try_into().expect("four bytes");
        i64::from(i32::from_be_bytes(bytes))
    }
}

/// The inputs from the caller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inputs {
    /// By the order of [`Input::ALL`].
    pub bits: [bool; Input::ALL.len()],
    pub s_sel: i16,
}

impl Inputs {
    pub fn new() -> Inputs {
        Inputs { bits: [false; Input::ALL.len()], s_sel: 0 }
    }
}

/// State of a step. Source: GRAPH reference, D.5.
#[derive(Clone, Debug, Default)]
pub struct StepState {
    pub x: bool,
    pub s1: bool,
    pub s0: bool,
    pub l1: bool,
    pub l0: bool,
    pub v1: bool,
    pub v0: bool,
    pub a1: bool,
    pub r1: bool,
    pub la: bool,
    pub ls: bool,
    pub va: bool,
    pub vs: bool,
    pub t: i64,
    pub u: i64,
    /// An acknowledgement was given while the supervision was still faulty.
    acknowledged: bool,
}

impl StepState {
    pub fn bit(&self, member: StepBit) -> bool {
        match member {
            StepBit::X => self.x,
            StepBit::S1 => self.s1,
            StepBit::S0 => self.s0,
            StepBit::L1 => self.l1,
            StepBit::L0 => self.l0,
            StepBit::V1 => self.v1,
            StepBit::V0 => self.v0,
            StepBit::A1 => self.a1,
            StepBit::R1 => self.r1,
            StepBit::LA => self.la,
            StepBit::LS => self.ls,
            StepBit::VA => self.va,
            StepBit::VS => self.vs,
        }
    }
}

/// State of a transition.
#[derive(Clone, Debug, Default)]
pub struct TransitionState {
    pub tv: bool,
    pub tt: bool,
    pub ts: bool,
}

impl TransitionState {
    pub fn bit(&self, member: TransitionBit) -> bool {
        match member {
            TransitionBit::TV => self.tv,
            TransitionBit::TT => self.tt,
            TransitionBit::TS => self.ts,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    Auto,
    Manual,
    Tap,
    Top,
}

/// Outputs of the block.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outputs {
    pub s_no: i16,
    pub s_active: bool,
    pub s_time: i64,
    pub s_timeok: i64,
    pub t_no: i16,
    pub error: bool,
    pub fault: bool,
    pub err_flt: bool,
    pub sq_isoff: bool,
    pub sq_halted: bool,
    pub tm_halted: bool,
    pub op_zeroed: bool,
    pub il_enabled: bool,
    pub sv_enabled: bool,
    pub ackreq_enabled: bool,
    pub sskip_enabled: bool,
    pub auto_on: bool,
    pub tap_on: bool,
    pub top_on: bool,
    pub man_on: bool,
}

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

    /// Phases 7 to 9.
    fn switch_steps(&mut self, edge: &dyn Fn(Input) -> bool, requests: &Requests, memory: &mut Memory) {
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
    fn may_switch(&self, edge: &dyn Fn(Input) -> bool) -> bool {
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
    fn enter_all(&mut self, steps: Vec<usize>, may_skip: bool, memory: &Memory) {
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
    fn by_owners(&self) -> Vec<usize> {
        let place = |index: &usize| {
            let owner = self.chart.transitions[*index].from.iter().copied().min();
            self.order.iter().position(|&step| Some(step) == owner).unwrap_or(usize::MAX)
        };
        let mut list: Vec<usize> = (0..self.chart.transitions.len()).rev().collect();
        list.sort_by_key(place);
        list
    }

    /// Phase 8.
    fn leave(&mut self, step: usize, memory: &mut Memory) {
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

    /// Phase 10.
    fn actions(&mut self, memory: &mut Memory) {
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
    fn execute(&mut self, step: usize, row: &Row, memory: &mut Memory) {
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
