//! One pulse output: its behaviour between two polls, and the effect of PLS.
//!
//! ```text
//!          PLS, PTO              PLS, PTO: waits after it
//!   idle ------------> pto  <------------------------------
//!        <------------       end (event), bad cycle time, PLS off
//!        ------------> pwm   PLS, PWM: new times, at once or at the end of the cycle
//!        <------------       PLS off
//! ```
//!
//! Source: S7-200 system manual, pulse output instruction.

use plcc_abi::s7200::error;

use super::train::{CYCLE_MIN, Segment, Train};
use super::width::Pwm;
use crate::clock::NS_PER_MS;

/// Status bits that stay until the program clears them.
pub(super) const DELTA_ERROR: u8 = 1 << 4;
pub(super) const ABORTED: u8 = 1 << 5;
pub(super) const OVERFLOW: u8 = 1 << 6;
/// No train runs.
pub(super) const IDLE: u8 = 1 << 7;

/// Bits of the control byte.
mod control {
    pub const CYCLE: u8 = 1 << 0;
    pub const WIDTH: u8 = 1 << 1;
    pub const COUNT: u8 = 1 << 2;
    pub const MILLISECONDS: u8 = 1 << 3;
    pub const SYNCHRONOUS: u8 = 1 << 4;
    pub const PROFILE: u8 = 1 << 5;
    pub const PWM: u8 = 1 << 6;
    pub const ENABLE: u8 = 1 << 7;
}

/// Edges that are kept between two samples of a trace.
pub const EDGES_MAX: usize = 10_000;

/// An edge of a pulse output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// In nanoseconds.
    pub time: u64,
    pub level: bool,
}

/// The settings that PLS reads from special memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Registers {
    pub control: u8,
    pub cycle: u16,
    pub width: u16,
    pub count: u32,
}

impl Registers {
    /// It starts a profile.
    pub fn is_profile(&self) -> bool {
        self.control & (control::ENABLE | control::PWM | control::PROFILE) == control::ENABLE | control::PROFILE
    }
}

#[derive(Default)]
enum State {
    #[default]
    Idle,
    Pto {
        train: Train,
        /// Waits after it.
        next: Option<Train>,
    },
    Pwm {
        running: Pwm,
        /// From when on new times are valid.
        next: Option<(u64, Pwm)>,
    },
}

/// See the module comment.
#[derive(Default)]
pub(super) struct Output {
    state: State,
    /// As PLS has loaded them.
    loaded: Registers,
    /// Pulses before the segment or the times that run now.
    before: u64,
    /// Sticky status bits that are not in special memory yet.
    sticky: u8,
    edges: Edges,
}

/// Edges for a trace.
#[derive(Default)]
struct Edges {
    wanted: bool,
    list: Vec<Edge>,
    /// Up to when they are known.
    until: u64,
    /// The level after the last one, if a generator gave it.
    level: Option<bool>,
    /// There were more.
    cut: bool,
}

impl Edges {
    fn add(&mut self, edges: impl Iterator<Item = (u64, bool)>) {
        for (time, level) in edges {
            if self.level == Some(level) {
                continue;
            }
            if self.list.len() >= EDGES_MAX {
                self.cut = true;
                return;
            }
            self.list.push(Edge { time, level });
            self.level = Some(level);
        }
    }
}

impl Output {
    /// RUN begins: idle.
    pub fn start(&mut self, now: u64) {
        let wanted = self.edges.wanted;
        *self = Output { edges: Edges { wanted, until: now, ..Edges::default() }, ..Output::default() };
    }

    /// Records the edges of the running train, up to `time`.
    fn record(&mut self, time: u64) {
        let edges = &mut self.edges;
        if edges.wanted && time > edges.until {
            let from = std::mem::replace(&mut edges.until, time);
            match &self.state {
                State::Idle => {}
                State::Pto { train, .. } => edges.add(train.placed().into_iter().flat_map(|run| run.edges(from, time))),
                State::Pwm { running, .. } => edges.add(running.edges(from, time)),
            }
        }
    }

    /// The train from `time` on begins with this level.
    fn record_level(&mut self, time: u64, image: bool) {
        let level = self.level(time).unwrap_or(image);
        self.edges.until = self.edges.until.max(time);
        if self.edges.wanted {
            self.edges.add(std::iter::once((time, level)));
        }
        if matches!(self.state, State::Idle) {
            // From here on the level is the program's.
            self.edges.level = None;
        }
    }

    /// Advances to `now`; `image` is the level of the output without a generator. Result: trains that have ended.
    pub fn advance(&mut self, now: u64, image: bool) -> u32 {
        let mut ended = 0;
        while let Some(time) = self.due().filter(|&time| time <= now) {
            self.record(time.saturating_sub(1));
            self.before = self.count_before(time);
            match &mut self.state {
                State::Idle => {}
                State::Pto { train, next } => {
                    let failed = train.placed().is_some_and(|run| run.segment.fails());
                    if failed {
                        self.sticky |= DELTA_ERROR;
                        self.state = State::Idle;
                    } else if !train.next(time) {
                        ended += 1;
                        self.state = match next.take() {
                            Some(next) => State::Pto { train: next.begin(time), next: None },
                            None => State::Idle,
                        };
                    }
                }
                State::Pwm { running, next } => {
                    if let Some((_, new)) = next.take() {
                        *running = new.begin_at(time);
                    }
                }
            }
            self.record_level(time, image);
        }
        self.record(now);
        ended
    }

    /// When the next change is due.
    pub fn due(&self) -> Option<u64> {
        match &self.state {
            State::Idle => None,
            State::Pto { train, .. } => train.placed().map(|run| run.end()),
            State::Pwm { next, .. } => next.as_ref().map(|&(time, _)| time),
        }
    }

    /// Pulses that have begun up to `now`.
    pub fn count(&self, now: u64) -> u64 {
        let running = match &self.state {
            State::Idle => 0,
            State::Pto { train, .. } => train.placed().map_or(0, |run| run.begun(now)),
            State::Pwm { running, .. } => running.begun(now),
        };
        self.before.saturating_add(running)
    }

    /// Pulses that have begun before `time`, at which something else begins.
    fn count_before(&self, time: u64) -> u64 {
        match time.checked_sub(1) {
            Some(last) => self.count(last),
            None => self.before,
        }
    }

    /// When pulse `number` begins, counted from 1 since RUN began; or an earlier time at which more is known.
    pub fn time_of_pulse(&self, number: u64) -> Option<u64> {
        let pulse = number.checked_sub(self.before)?.checked_sub(1)?;
        match &self.state {
            State::Idle => None,
            State::Pto { train, .. } => train.placed().map(|run| run.begin(pulse).unwrap_or_else(|| run.end())),
            State::Pwm { running, next } => {
                running.begin(pulse).into_iter().chain(next.as_ref().map(|&(time, _)| time)).min()
            }
        }
    }

    /// The level, if the generator owns the output.
    pub fn level(&self, now: u64) -> Option<bool> {
        match &self.state {
            State::Idle => None,
            State::Pto { train, .. } => train.placed().map(|run| run.level(now)),
            State::Pwm { running, .. } => Some(running.level(now)),
        }
    }

    /// Number of the running segment of a profile, else 0.
    pub fn segment(&self) -> u8 {
        match &self.state {
            State::Pto { train, .. } => train.number(),
            State::Idle | State::Pwm { .. } => 0,
        }
    }

    /// The status byte, from what special memory has: sticky bits are the program's to clear.
    pub fn status(&mut self, old: u8) -> u8 {
        let sticky = old & (DELTA_ERROR | ABORTED | OVERFLOW) | std::mem::take(&mut self.sticky);
        let running = matches!(self.state, State::Pto { .. });
        sticky | if running { 0 } else { IDLE }
    }

    /// PLS at `now`, up to which the output has advanced; `profile` returns the segments if it starts a profile. `Err`: the non-fatal error.
    pub fn control(
        &mut self,
        now: u64,
        image: bool,
        registers: &Registers,
        profile: impl FnOnce() -> Result<Vec<Segment>, u16>,
    ) -> Result<(), u16> {
        let asked = registers.control;
        let unit = if asked & control::MILLISECONDS != 0 { NS_PER_MS } else { 1000 };
        if asked & control::ENABLE == 0 {
            self.switch_off(now, image);
            return Ok(());
        }
        match &self.state {
            State::Pto { .. } if asked & control::PWM != 0 => return Err(error::PULSE_OUTPUT_ACTIVE),
            State::Pwm { .. } if asked & control::PWM == 0 => return Err(error::PULSE_OUTPUT_ACTIVE),
            // Only single trains wait, and with one time base.
            State::Pto { train, .. } if train.profile || registers.is_profile() || train.unit != unit => {
                return Err(error::PTO_MODE);
            }
            State::Pto { next: Some(_), .. } => {
                self.sticky |= OVERFLOW;
                return Ok(());
            }
            State::Idle | State::Pto { .. } | State::Pwm { .. } => {}
        }
        let is_profile = registers.is_profile();
        let profile = if is_profile { profile()? } else { Vec::new() };
        self.load(registers);
        if asked & control::PWM != 0 {
            let new = Pwm::new(self.loaded.cycle, self.loaded.width, unit, now);
            self.update_width(now, image, new, asked & control::SYNCHRONOUS != 0);
        } else {
            let segments = if is_profile { profile } else { vec![self.single()] };
            self.queue(now, image, Train::new(segments, unit, is_profile, now));
        }
        Ok(())
    }

    fn load(&mut self, registers: &Registers) {
        if registers.control & control::CYCLE != 0 {
            self.loaded.cycle = registers.cycle;
        }
        if registers.control & control::WIDTH != 0 {
            self.loaded.width = registers.width;
        }
        if registers.control & control::COUNT != 0 {
            self.loaded.count = registers.count;
        }
    }

    /// The train that is loaded; times and counts that are too small are the smallest ones.
    fn single(&self) -> Segment {
        Segment { first: self.loaded.cycle.max(CYCLE_MIN), delta: 0, count: self.loaded.count.max(1) }
    }

    /// The image register has the output again.
    pub fn switch_off(&mut self, now: u64, image: bool) {
        self.before = self.count(now);
        match std::mem::take(&mut self.state) {
            State::Idle => return,
            State::Pto { .. } => self.sticky |= ABORTED,
            State::Pwm { .. } => {}
        }
        self.record_level(now, image);
    }

    fn queue(&mut self, now: u64, image: bool, train: Train) {
        if let State::Pto { next, .. } = &mut self.state {
            *next = Some(train);
            return;
        }
        self.state = State::Pto { train, next: None };
        self.record_level(now, image);
    }

    fn update_width(&mut self, now: u64, image: bool, new: Pwm, synchronous: bool) {
        if let State::Pwm { running, next } = &mut self.state
            && synchronous
            && running.unit() == new.unit()
        {
            *next = Some((running.cycle_end(now), new));
            return;
        }
        self.before = self.count_before(now);
        self.state = State::Pwm { running: new, next: None };
        self.record_level(now, image);
    }

    /// Edges are noted for a trace, from `now` on.
    pub fn record_edges(&mut self, now: u64) {
        if !self.edges.wanted {
            self.edges = Edges { wanted: true, until: now, ..Edges::default() };
        }
    }

    /// Takes the noted edges up to `time`; and whether there were more than are kept.
    pub fn take_edges(&mut self, time: u64) -> (Vec<Edge>, bool) {
        let split = self.edges.list.partition_point(|edge| edge.time <= time);
        let later = self.edges.list.split_off(split);
        (std::mem::replace(&mut self.edges.list, later), std::mem::take(&mut self.edges.cut))
    }

    /// The next edge that was noted and not taken.
    pub fn noted_edge(&self) -> Option<Edge> {
        self.edges.list.first().copied()
    }
}
