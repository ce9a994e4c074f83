//! Random charts of sequences, alternative and simultaneous branches, jumps and several sequencers, and calls of them.
//!
//! A simultaneous branch has its own join and nothing leads into or out of one of its paths, so that no step is entered twice.

use std::ops::Range;

use plcc_tests::random::Random;

use super::chart::{
    Action, Area, Bit, Chart, Coil, Condition, Event, Input, Interface, Order, Permanent, Row, Step, StepBit, Time,
    Transition, TransitionBit,
};
use super::memory::Inputs;
use super::text::{COUNTERS, TIMERS};

/// One cycle of OB 1.
#[derive(Clone, Debug)]
pub struct Call {
    /// Milliseconds since the cycle before.
    pub after: i64,
    /// IB 0 to IB 3.
    pub process: [u8; 4],
    pub inputs: Inputs,
    /// OB 1 does not call the block.
    pub paused: bool,
}

/// The contents of a chart and its calls. Smaller charts show errors more clearly.
#[derive(Clone, Debug)]
struct Features {
    monitoring: bool,
    events: bool,
    requests: bool,
    arithmetic: bool,
    timers: bool,
    permanent: bool,
    modes: bool,
    toggles: bool,
    starts: bool,
    paging: bool,
    pauses: bool,
}

/// A chart with its calls.
#[derive(Clone, Debug)]
pub struct Case {
    pub chart: Chart,
    pub calls: Vec<Call>,
}

pub fn case(seed: u64) -> Case {
    let mut random = Random::new(seed);
    let mut flag = || random.percent(50);
    let features = Features {
        monitoring: flag(),
        events: flag(),
        requests: flag() && flag(),
        arithmetic: flag(),
        timers: flag(),
        permanent: flag(),
        modes: flag() && flag(),
        toggles: flag() && flag(),
        starts: flag(),
        paging: flag() && flag(),
        pauses: flag(),
    };
    let mut maker = Maker { random, features, chart: Chart::default(), budget: 0, off_timers: 2..TIMERS };
    maker.chart();
    let calls = maker.calls();
    Case { chart: maker.chart, calls }
}

/// Steps that a jump of a path may lead to: those of the path.
type Targets = Vec<usize>;

struct Maker {
    random: Random,
    features: Features,
    chart: Chart,
    /// Steps that may still come.
    budget: usize,
    /// Timers that no TF has yet.
    off_timers: Range<u8>,
}

impl Maker {
    fn chart(&mut self) {
        self.chart.interface = match self.random.below(4) {
            0 => Interface::Minimum,
            1 => Interface::Standard,
            _ => Interface::Maximum,
        };
        self.chart.acknowledge = self.random.percent(50);
        self.chart.skip = self.features.toggles && !self.features.requests && self.random.percent(20);
        let size = match self.random.below(20) {
            0 => 66 + self.random.below(30),
            1..8 => 2 + self.random.below(4),
            _ => 4 + self.random.below(27),
        };
        let sequencers = 1 + self.random.below(size.min(9)) / 3;
        for _ in 0..sequencers {
            self.budget = (size / sequencers).max(1);
            self.sequencer();
        }
        self.number();
        for step in 0..self.chart.steps.len() {
            self.fill(step);
        }
        for transition in 0..self.chart.transitions.len() {
            let condition = self.transition_condition(transition);
            self.chart.transitions[transition].condition = condition;
        }
        if self.features.permanent {
            for _ in 0..1 + self.random.below(3) {
                let permanent = self.permanent();
                self.chart.before.push(permanent);
                let permanent = self.permanent();
                self.chart.after.push(permanent);
            }
        }
    }

    fn step(&mut self) -> usize {
        self.budget = self.budget.saturating_sub(1);
        self.chart.steps.push(Step {
            name: String::new(),
            number: 0,
            initial: false,
            interlock: None,
            supervision: None,
            rows: Vec::new(),
        });
        self.chart.steps.len() - 1
    }

    fn transition(&mut self, from: &[usize], to: &[usize]) {
        self.chart.transitions.push(Transition {
            name: String::new(),
            number: 0,
            from: from.to_vec(),
            to: to.to_vec(),
            condition: None,
        });
    }

    /// A sequencer: it goes round, or ends.
    fn sequencer(&mut self) {
        let first = self.step();
        let mut targets = vec![first];
        let before = self.chart.steps.len();
        let last = self.chain(first, 0, &mut targets);
        let branch = self.random.percent(10).then(|| self.opening(before)).flatten();
        match branch {
            // Some sequencers begin within their paths, and go round to the first step.
            Some(paths) => {
                paths.iter().for_each(|&step| self.chart.steps[step].initial = true);
                self.transition(&[last], &[first]);
            }
            None => {
                self.chart.steps[first].initial = true;
                if self.random.percent(85) {
                    let target = if self.random.percent(70) { first } else { self.random.of(&targets) };
                    self.transition(&[last], &[target]);
                } else if self.random.percent(80) {
                    self.transition(&[last], &[]);
                }
            }
        }
    }

    /// The entries of the paths of an outer simultaneous branch, if the first branch after `first` is one.
    fn opening(&self, first: usize) -> Option<Vec<usize>> {
        let from = first.checked_sub(1)?;
        let mut outgoing = self.chart.transitions.iter().filter(|transition| transition.from == [from]);
        let only = outgoing.next().filter(|transition| transition.to.len() > 1)?;
        outgoing.next().is_none().then(|| only.to.clone())
    }

    /// Continues from `from`; returns the last step.
    fn chain(&mut self, from: usize, depth: usize, targets: &mut Targets) -> usize {
        let mut at = from;
        let length = self.random.below(6);
        for _ in 0..length {
            if self.budget == 0 {
                break;
            }
            at = match self.random.below(6) {
                0 | 1 if depth < 3 => self.alternative(at, depth, targets),
                2 if depth < 3 => self.simultaneous(at, depth),
                _ => {
                    let next = self.step();
                    self.transition(&[at], &[next]);
                    next
                }
            };
            targets.push(at);
        }
        at
    }

    /// An alternative branch: its paths meet in one step, jump, or end where the sequencer is not parallel.
    fn alternative(&mut self, at: usize, depth: usize, targets: &mut Targets) -> usize {
        let paths = 2 + self.random.below(2);
        let join = self.step();
        for path in 0..paths {
            let last = match self.random.below(4) {
                0 => at,
                _ => {
                    let first = self.step();
                    self.transition(&[at], &[first]);
                    let mut inner = targets.clone();
                    inner.push(first);
                    self.chain(first, depth + 1, &mut inner)
                }
            };
            if path > 0 && self.random.percent(25) {
                let target = self.random.of(targets);
                self.transition(&[last], &[target]);
            } else {
                self.transition(&[last], &[join]);
            }
        }
        join
    }

    /// A simultaneous branch with its join.
    fn simultaneous(&mut self, at: usize, depth: usize) -> usize {
        let paths = 2 + self.random.below(2);
        let firsts: Vec<usize> = (0..paths).map(|_| self.step()).collect();
        self.transition(&[at], &firsts);
        let mut lasts = Vec::new();
        for first in firsts {
            let mut targets = vec![first];
            let last = self.chain(first, depth + 1, &mut targets);
            if self.random.percent(20) {
                // A way back, next to the join.
                let target = self.random.of(&targets);
                self.transition(&[last], &[target]);
            }
            lasts.push(last);
        }
        let next = self.step();
        self.transition(&lasts, &[next]);
        if self.random.percent(20) {
            // A second way out of all paths.
            self.transition(&lasts, &[next]);
        }
        next
    }

    /// Names, numbers and the order of transitions.
    fn number(&mut self) {
        let shuffle = |random: &mut Random, count: usize| {
            let mut numbers: Vec<i16> = (1..=count as i16 * 3).collect();
            for index in 0..count {
                let other = index + random.below(numbers.len() - index);
                numbers.swap(index, other);
            }
            numbers
        };
        let numbers = shuffle(&mut self.random, self.chart.steps.len());
        for (step, number) in self.chart.steps.iter_mut().zip(numbers) {
            step.number = number;
            step.name = format!("Step_{number}");
        }
        if self.random.percent(70) {
            for index in 1..self.chart.transitions.len() {
                let other = self.random.below(index + 1);
                self.chart.transitions.swap(index, other);
            }
        }
        let numbers = shuffle(&mut self.random, self.chart.transitions.len());
        for (transition, number) in self.chart.transitions.iter_mut().zip(numbers) {
            transition.number = number;
            transition.name = format!("Trans_{number}");
        }
    }

    fn input(&mut self) -> Bit {
        Bit { area: Area::I, byte: self.random.below(4) as u8, bit: self.random.below(8) as u8 }
    }

    /// A bit that rows write.
    fn output(&mut self) -> Bit {
        let bit = self.random.below(8) as u8;
        match self.random.below(7) {
            0 => Bit { area: Area::Static, byte: 0, bit },
            1 | 2 => Bit { area: Area::M, byte: 10 + self.random.below(2) as u8, bit },
            _ => Bit { area: Area::Q, byte: self.random.below(4) as u8, bit },
        }
    }

    fn any_step(&mut self) -> usize {
        self.random.below(self.chart.steps.len())
    }

    fn order(&mut self) -> Order {
        self.random.of(&[Order::Less, Order::AtMost, Order::More, Order::AtLeast, Order::Equal, Order::Unequal])
    }

    fn milliseconds(&mut self) -> i64 {
        self.random.of(&[0, 10, 50, 100, 100, 200, 300, 500])
    }

    fn leaf(&mut self, own: Option<usize>) -> Condition {
        match self.random.below(12) {
            0 => Condition::Constant(self.random.percent(50)),
            1 | 2 => Condition::Bit(self.output()),
            3 => Condition::Step(self.any_step(), StepBit::X),
            4 | 5 => {
                let step = own.filter(|_| self.random.percent(70)).unwrap_or_else(|| self.any_step());
                let order = self.random.of(&[Order::More, Order::AtLeast, Order::AtLeast, Order::Less, Order::AtMost]);
                Condition::Time { step, undisturbed: self.random.percent(25), order, ms: self.milliseconds() }
            }
            6 if self.features.arithmetic => Condition::Word {
                byte: 20 + 2 * self.random.below(4) as u8,
                order: self.order(),
                value: self.random.below(12) as i16,
            },
            7 if self.features.timers => match self.random.percent(50) {
                true => Condition::Timer(self.random.below(TIMERS.into()) as u8),
                false => Condition::Counter(self.random.below(COUNTERS.into()) as u8),
            },
            _ => Condition::Bit(self.input()),
        }
    }

    fn condition(&mut self, own: Option<usize>, depth: usize) -> Condition {
        if depth == 0 || self.random.percent(50) {
            return self.leaf(own);
        }
        let parts = |maker: &mut Maker| {
            let count = 2 + maker.random.below(2);
            (0..count).map(|_| maker.condition(own, depth - 1)).collect()
        };
        match self.random.below(5) {
            0 | 1 => Condition::And(parts(self)),
            2 => Condition::Or(parts(self)),
            3 => Condition::Xor(parts(self)),
            _ => Condition::Not(Box::new(self.condition(own, depth - 1))),
        }
    }

    fn transition_condition(&mut self, transition: usize) -> Option<Condition> {
        let own = self.chart.transitions[transition].from.first().copied();
        (!self.random.percent(10)).then(|| self.condition(own, 2))
    }

    fn supervision(&mut self, step: usize) -> Condition {
        let limit = Condition::Time { step, undisturbed: true, order: Order::More, ms: self.milliseconds() };
        let own: Vec<usize> =
            (0..self.chart.transitions.len()).filter(|&t| self.chart.transitions[t].from.contains(&step)).collect();
        match self.random.below(3) {
            0 if !own.is_empty() => {
                let transition = Condition::Transition(self.random.of(&own), TransitionBit::TT);
                Condition::And(vec![limit, Condition::Not(Box::new(transition))])
            }
            1 => Condition::And(vec![self.condition(Some(step), 1), Condition::Bit(self.input())]),
            _ => self.condition(Some(step), 2),
        }
    }

    fn fill(&mut self, step: usize) {
        if self.features.monitoring {
            if self.random.percent(40) {
                self.chart.steps[step].interlock = Some(self.condition(Some(step), 1));
            }
            if self.random.percent(30) {
                self.chart.steps[step].supervision = Some(self.supervision(step));
            }
        }
        for _ in 0..self.random.below(5) {
            let row = self.row();
            self.chart.steps[step].rows.push(row);
        }
    }

    fn event(&mut self) -> Event {
        use Event::{A1, L0, L1, R1, S0, S1, V0, V1};
        self.random.of(&[S1, S1, S1, S0, S0, L1, L0, V1, V0, A1, R1])
    }

    fn row(&mut self) -> Row {
        let event = (self.features.events && self.random.percent(40)).then(|| self.event());
        let time = if self.random.percent(80) {
            Time::Constant(self.milliseconds())
        } else {
            Time::Memory(40 + 4 * self.random.below(2) as u8)
        };
        let counter = self.random.below(COUNTERS.into()) as u8;
        let bit = self.output();
        if self.features.timers && self.random.percent(20) {
            let ms = self.random.of(&[10, 50, 100, 200, 500]);
            let action = match event {
                None => self.off_timers.next().map(|timer| Action::TimerOff(timer, ms)),
                Some(_) => Some(match self.random.below(5) {
                    0 | 1 => Action::TimerPulse(0, ms),
                    2 | 3 => Action::TimerDelay(1, ms),
                    _ => Action::TimerStop(self.random.below(2) as u8),
                }),
            };
            if let Some(action) = action {
                return Row { event, interlock: event.is_none() && self.random.percent(30), action };
            }
        }
        let action = match (event, self.random.below(10)) {
            (Some(_), 0 | 1) if self.features.requests => Action::On(self.any_step()),
            (Some(_), 2) if self.features.requests => Action::Off(self.any_step()),
            (Some(_), 3) if self.features.requests && self.random.percent(30) => Action::OffAll,
            (Some(_), 4) => Action::CounterSet(counter, self.random.of(&[0, 3, 998, 999])),
            (Some(_), 5) => Action::CounterUp(counter),
            (Some(_), 6) => Action::CounterDown(counter),
            (Some(_), 7) => Action::CounterClear(counter),
            (None, 0 | 1) => Action::D(bit, time),
            (None, 2 | 3) => Action::L(bit, time),
            (_, 8) if self.features.arithmetic => Action::Add {
                target: 20 + 2 * self.random.below(4) as u8,
                source: 20 + 2 * self.random.below(4) as u8,
                constant: self.random.of(&[1, 1, 2, 100]),
            },
            (_, 7) if self.features.arithmetic => Action::Call(20 + 2 * self.random.below(4) as u8),
            (_, 9 | 0) => Action::S(bit),
            (_, 1) => Action::R(bit),
            _ => Action::N(bit),
        };
        let allowed = !matches!(event, Some(Event::S0 | Event::L1 | Event::L0 | Event::V0));
        Row { event, interlock: allowed && self.random.percent(30), action }
    }

    fn permanent(&mut self) -> Permanent {
        let operand = Bit { area: Area::M, byte: 12, bit: self.random.below(8) as u8 };
        let coil = self.random.of(&[Coil::Assign, Coil::Assign, Coil::Set, Coil::Reset]);
        let value = match self.random.below(4) {
            0 => {
                use StepBit::{A1, L0, L1, LA, S0, S1, V0, V1, VA, X};
                let member = self.random.of(&[X, S1, S0, L1, L0, V1, V0, A1, LA, VA]);
                Condition::Step(self.any_step(), member)
            }
            1 if !self.chart.transitions.is_empty() => {
                let transition = self.random.below(self.chart.transitions.len());
                Condition::Transition(
                    transition,
                    self.random.of(&[TransitionBit::TV, TransitionBit::TT, TransitionBit::TS]),
                )
            }
            _ => self.condition(None, 1),
        };
        Permanent { coil, operand, value }
    }

    fn calls(&mut self) -> Vec<Call> {
        let count = 30 + self.random.below(51);
        let mut calls: Vec<Call> = Vec::with_capacity(count);
        let mut process = [0; 4];
        let mut inputs = Inputs::new();
        for _ in 0..count {
            for byte in &mut process {
                let change = self.random.bits() as u8 & self.random.bits() as u8;
                *byte ^= change;
            }
            for input in self.chart.interface.inputs() {
                let chance = self.chance(input);
                let bit = &mut inputs.bits[input as usize];
                if *bit {
                    *bit = self.random.percent(40);
                } else {
                    *bit = self.random.percent(chance);
                }
            }
            let pages = [Input::SPrev, Input::SNext].iter().any(|&input| inputs.bits[input as usize]);
            if self.features.paging && !pages && self.random.percent(20) {
                let step = self.any_step();
                inputs.s_sel = if self.random.percent(90) { self.chart.steps[step].number } else { 999 };
            }
            calls.push(Call {
                after: self.random.of(&[10, 10, 50, 50, 50, 100, 100, 20, 1, 7, 500]),
                process,
                inputs: inputs.clone(),
                paused: self.features.pauses && self.random.percent(8),
            });
        }
        calls
    }

    /// Of a rising edge, in percent of the calls.
    fn chance(&self, input: Input) -> usize {
        let Features { monitoring, requests, modes, toggles, starts, paging, .. } = self.features;
        let (wanted, chance) = match input {
            Input::OffSq => (starts, 2),
            Input::InitSq => (starts, 5),
            Input::AckEf | Input::AckS => (monitoring, 15),
            Input::RegEf | Input::RegS => (monitoring, 5),
            Input::HaltSq | Input::HaltTm | Input::ZeroOp | Input::EnIl | Input::EnSv => (toggles, 6),
            Input::EnAckreq => (toggles, 4),
            // With requests several ways may lead to one step that is skipped; the reference does not define that case.
            Input::EnSskip => (toggles && !requests, 4),
            Input::SPrev | Input::SNext => (paging, 12),
            Input::SwAuto => (modes, 8),
            Input::SwTap | Input::SwTop | Input::SwMan => (modes, 5),
            Input::SOn | Input::SOff => (modes, 20),
            Input::TPush => (modes, 30),
        };
        if wanted { chance } else { 0 }
    }
}
