//! A high-speed counter: the effect of edges at its inputs.
//!
//! Nothing happens at a pulse of a train: somebody looks, and the counter counts from where it was to that moment. Where all levels
//! repeat, whole periods are counted at once. Source: S7-200 system manual, high-speed counter instructions.

use super::inputs::Wires;
use super::modes::{Inputs, Kind, Pin, bit};

/// An event of a counter; its place in [`Row::events`](super::modes::Row::events).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Happening {
    /// Counting has made the current value equal to the preset.
    Reached,
    /// The direction has changed.
    Turned,
    /// The reset input has become active.
    Reset,
}

impl Happening {
    /// Its bit in a set of them.
    pub fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// Maximum events reported by one poll; more do not fit in any event queue.
const TOLD_MAX: usize = 256;
/// Maximum edges in a search for the next event; then it returns how far it came.
const SEARCH_EDGES: u32 = 1000;
/// Counts that a period of all inputs makes at most.
const PERIOD_COUNTS: u64 = 4;

/// Requested events with their times.
pub(super) struct Log {
    /// [`Happening::bit`] of each.
    pub wanted: u8,
    pub told: Vec<(u64, Happening)>,
}

impl Log {
    pub fn new(wanted: u8) -> Log {
        Log { wanted, told: Vec::new() }
    }

    fn tell(&mut self, time: u64, happening: Happening) {
        if self.wanted & happening.bit() != 0 && self.told.len() < TOLD_MAX {
            self.told.push((time, happening));
        }
    }
}

/// Bits 0 to 2 of the control byte, latched by HDEF.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Latched {
    pub reset_low: bool,
    pub start_low: bool,
    /// Quadrature counts once a period, else four times.
    pub once: bool,
}

impl Latched {
    pub fn of(control: u8) -> Latched {
        Latched { reset_low: control & 1 != 0, start_low: control & 2 != 0, once: control & 4 != 0 }
    }
}

/// A defined counter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counter {
    pub kind: Kind,
    pub inputs: Inputs,
    latched: Latched,
    pub enabled: bool,
    pub up: bool,
    pub current: i32,
    pub preset: i32,
    /// Up to when it has counted.
    time: u64,
    /// Levels of its inputs then.
    levels: u16,
    /// Pulses of its pulse output then, in mode 12.
    pulses: u64,
}

impl Counter {
    /// HDEF at `time`, with the levels of inputs and the pulses of its output then.
    pub fn new(kind: Kind, inputs: Inputs, latched: Latched, time: u64, levels: u16, pulses: u64) -> Counter {
        let levels = levels & inputs.mask();
        Counter { kind, inputs, latched, enabled: false, up: false, current: 0, preset: 0, time, levels, pulses }
    }

    /// HSC: bits 3 to 7 of the control byte, with the values that they load.
    pub fn control(&mut self, control: u8, current: i32, preset: i32) {
        if control & 0x10 != 0 {
            self.up = control & 8 != 0;
        }
        if control & 0x20 != 0 {
            self.preset = preset;
        }
        if control & 0x40 != 0 {
            self.current = current;
        }
        self.enabled = control & 0x80 != 0;
        if self.enabled && self.is_started(self.levels) && self.is_reset(self.levels) {
            self.current = 0;
        }
    }

    /// The status byte.
    pub fn status(&self) -> u8 {
        u8::from(self.up) << 5 | u8::from(self.current == self.preset) << 6 | u8::from(self.current > self.preset) << 7
    }

    fn is_on(pin: Option<Pin>, levels: u16) -> bool {
        pin.is_some_and(|pin| bit(pin) & levels != 0)
    }

    fn is_started(&self, levels: u16) -> bool {
        self.inputs.start.is_none_or(|pin| (bit(pin) & levels != 0) != self.latched.start_low)
    }

    fn is_reset(&self, levels: u16) -> bool {
        self.inputs.reset.is_some_and(|pin| (bit(pin) & levels != 0) != self.latched.reset_low)
    }

    fn turn(&mut self, up: bool, log: &mut Log) {
        if self.up != up {
            self.up = up;
            log.tell(self.time, Happening::Turned);
        }
    }

    fn count(&mut self, log: &mut Log) {
        self.current = self.current.wrapping_add(if self.up { 1 } else { -1 });
        if self.current == self.preset {
            log.tell(self.time, Happening::Reached);
        }
    }

    /// The inputs have these levels at `time`. Order of simultaneous changes: direction, start and reset first, then clocks.
    pub fn step(&mut self, time: u64, levels: u16, log: &mut Log) {
        let levels = levels & self.inputs.mask();
        let old = std::mem::replace(&mut self.levels, levels);
        self.time = time;
        if !self.enabled || old == levels {
            return;
        }
        let Inputs { clock, second, .. } = self.inputs;
        let (first_on, second_on) = (Self::is_on(clock, levels), Self::is_on(second, levels));
        let (first_was, second_was) = (Self::is_on(clock, old), Self::is_on(second, old));
        if self.kind == Kind::External && second_on != second_was {
            self.turn(second_on, log);
        }
        let reset = self.is_started(levels) && self.is_reset(levels);
        if reset && !(self.is_started(old) && self.is_reset(old)) {
            self.current = 0;
            log.tell(time, Happening::Reset);
        }
        if reset || !self.is_started(levels) {
            return;
        }
        let (first_rose, second_rose) = (first_on && !first_was, second_on && !second_was);
        let direction = match self.kind {
            Kind::Internal => first_rose.then_some(self.up),
            Kind::External => first_rose.then_some(second_on),
            // Both at once count nothing.
            Kind::TwoClocks => (first_rose != second_rose).then_some(first_rose),
            Kind::Quadrature => match (first_on != first_was, second_on != second_was) {
                (true, false) if !self.latched.once => Some(first_on != second_on),
                (true, false) => (!second_on).then_some(first_on),
                (false, true) if !self.latched.once => Some(first_on == second_on),
                (_, _) => None,
            },
            Kind::Output => None,
        };
        if let Some(up) = direction {
            self.turn(up, log);
            self.count(log);
        }
    }

    /// Counts up to `to`; in mode 12 this is a number of pulses.
    pub fn run(&mut self, wires: &Wires, to: u64, pulses: u64, log: &mut Log) {
        self.run_pulses(to, pulses, log);
        let mask = self.inputs.mask();
        while self.enabled
            && let Some(edge) = wires.next(mask, self.time).filter(|&edge| edge <= to)
        {
            if !self.skip(wires, to, log) {
                self.step(edge, wires.levels(mask, edge), log);
            }
        }
        if !self.enabled {
            self.levels = wires.levels(mask, to);
        }
        self.time = to.max(self.time);
    }

    /// Counts from the current value until it is `preset` if counting continues in this direction: 1 to 2^32.
    fn distance(&self, up: bool) -> u64 {
        let (from, to) = if up { (self.current, self.preset) } else { (self.preset, self.current) };
        match to.wrapping_sub(from) as u32 {
            0 => 1 << 32,
            distance => u64::from(distance),
        }
    }

    fn run_pulses(&mut self, to: u64, pulses: u64, log: &mut Log) {
        if self.kind != Kind::Output {
            return;
        }
        let count = pulses.saturating_sub(std::mem::replace(&mut self.pulses, pulses));
        if !self.enabled || count == 0 {
            return;
        }
        if self.distance(self.up) <= count {
            log.tell(to, Happening::Reached);
        }
        let change = count as i32;
        self.current = self.current.wrapping_add(if self.up { change } else { change.wrapping_neg() });
    }

    /// In mode 12: the pulse of its output with which the preset is reached.
    pub fn pulse_wanted(&self) -> Option<u64> {
        let counting = self.kind == Kind::Output && self.enabled;
        counting.then(|| self.pulses.saturating_add(self.distance(self.up)))
    }

    /// Counts whole periods at once, if all levels repeat and no requested event is due in them. False: there are none.
    fn skip(&mut self, wires: &Wires, to: u64, log: &Log) -> bool {
        let mask = self.inputs.mask();
        let held = [self.inputs.reset, self.inputs.start].into_iter().flatten().fold(0, |mask, pin| mask | bit(pin));
        if wires.next(held, self.time).is_some() {
            return false;
        }
        let Some((period, times)) = wires.repeats(mask, self.time) else { return false };
        let times = times.min(to.saturating_sub(self.time) / period.max(1));
        if times < 2 {
            return false;
        }
        // One period shows the effect of each.
        let mut trial = *self;
        let mut trial_log = Log::new(log.wanted);
        let end = self.time.saturating_add(period);
        while let Some(edge) = wires.next(mask, trial.time).filter(|&edge| edge <= end) {
            trial.step(edge, wires.levels(mask, edge), &mut trial_log);
        }
        if !trial_log.told.is_empty() || trial.levels != self.levels || trial.up != self.up {
            return false;
        }
        let change = trial.current.wrapping_sub(self.current);
        let limit = match u64::from(change.unsigned_abs()) {
            0 => u64::MAX,
            _ if log.wanted & Happening::Reached.bit() == 0 => u64::MAX,
            counts => self.distance(change > 0).saturating_sub(PERIOD_COUNTS + 1) / counts,
        };
        let times = times.min(limit);
        if times == 0 {
            return false;
        }
        self.current = self.current.wrapping_add((times as i32).wrapping_mul(change));
        self.time = self.time.saturating_add(times.saturating_mul(period));
        true
    }

    /// When the next event of `wanted` is due, if the inputs continue as they are. It may be too early; then no event is due at that time.
    pub fn due(&self, wires: &Wires, wanted: u8) -> Option<u64> {
        if !self.enabled || wanted == 0 || self.kind == Kind::Output {
            return None;
        }
        let mask = self.inputs.mask();
        let mut trial = *self;
        let mut log = Log::new(wanted);
        for _ in 0..SEARCH_EDGES {
            let edge = wires.next(mask, trial.time)?;
            if !trial.skip(wires, u64::MAX, &log) {
                trial.step(edge, wires.levels(mask, edge), &mut log);
            }
            if let Some(&(time, _)) = log.told.first() {
                return Some(time);
            }
        }
        Some(trial.time)
    }
}
