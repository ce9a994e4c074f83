//! A fast counter: it counts trains of pulses from a scenario.
//!
//! Nothing happens at a pulse: the number of pulses up to a moment is computed when somebody looks. The moment at which the counter
//! reaches its reference is computed, too, so that its interrupt comes at its time.
//! Source: LAD/FBD reference for S7-1200, interrupts, pulses, fast counters.

use std::cell::{Cell, RefCell};

use plcc_abi::technology::{CountMode, FastCounter};

use crate::clock::NS_PER_MS;

/// Pulses at equal distances: the first one period after `start`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Train {
    /// In nanoseconds, on the clock of the CPU.
    pub start: u64,
    pub period: u64,
    pub count: u64,
    /// The inputs say down.
    pub backward: bool,
}

impl Train {
    fn pulses(&self, now: u64) -> u64 {
        (now.saturating_sub(self.start) / self.period.max(1)).min(self.count)
    }
}

/// The point from which counting continues: pulses and value at that moment.
#[derive(Clone, Copy, Default)]
struct Base {
    pulses: i64,
    value: i32,
}

/// What has happened to a count since CTRL_HSC_EXT last asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passed {
    /// The inputs changed the direction.
    pub turned: bool,
    /// The count reached its references.
    pub reference: bool,
    pub second_reference: bool,
    /// It went on from one end of a DINT at the other.
    pub below: bool,
    pub above: bool,
}

/// See the module comment.
pub struct Counter {
    pub config: FastCounter,
    /// In the order of time; all but the last are over.
    trains: RefCell<Vec<Train>>,
    base: Cell<Base>,
    down: Cell<bool>,
    reference: Cell<i32>,
    second_reference: Cell<Option<i32>>,
    /// Value after a reset.
    start_value: Cell<i32>,
    period_ms: Cell<u16>,
    /// Pulses count.
    enabled: Cell<bool>,
    /// The input for the reset has an effect.
    resets: Cell<bool>,
    /// A reset sets the count to the start value.
    reset_sets: Cell<bool>,
    passed: Cell<Passed>,
    /// Pulses at the last look for the reference.
    seen: Cell<i64>,
    /// Level of the input for the reset.
    pub(super) reset_level: Cell<bool>,
}

impl Counter {
    pub fn new(config: &FastCounter) -> Counter {
        Counter {
            trains: RefCell::new(Vec::new()),
            base: Cell::new(Base { pulses: 0, value: config.initial }),
            down: Cell::new(config.down),
            reference: Cell::new(config.reference),
            second_reference: Cell::new(None),
            start_value: Cell::new(config.initial),
            enabled: Cell::new(true),
            resets: Cell::new(true),
            reset_sets: Cell::new(true),
            passed: Cell::default(),
            period_ms: Cell::new(config.period_ms.max(1)),
            seen: Cell::new(0),
            reset_level: Cell::new(false),
            config: config.clone(),
        }
    }

    /// Pulses up to `now`, those backward taken off.
    fn pulses(&self, now: u64) -> i64 {
        let signed = |train: &Train| {
            let pulses = train.pulses(now) as i64;
            if train.backward { -pulses } else { pulses }
        };
        self.trains.borrow().iter().map(signed).sum()
    }

    /// Value for each pulse forward.
    fn step(&self) -> i64 {
        let counts = self.config.mode.counts();
        if self.config.mode == CountMode::Single && self.down.get() { -counts } else { counts }
    }

    /// The count.
    pub fn count(&self, now: u64) -> i32 {
        let base = self.base.get();
        if !self.enabled.get() {
            return base.value;
        }
        base.value.wrapping_add(((self.pulses(now) - base.pulses).wrapping_mul(self.step())) as i32)
    }

    /// The value at the input address: the count, or the frequency in hertz of the last period that is over; 0 in mode `Period`.
    pub fn value(&self, now: u64) -> i32 {
        match self.config.mode {
            CountMode::Single | CountMode::SingleExternal | CountMode::TwoPhase | CountMode::Quadrature(_) => {
                return self.count(now);
            }
            CountMode::Period => return 0,
            CountMode::Frequency if !self.enabled.get() => return 0,
            CountMode::Frequency => {}
        }
        let (begin, end) = self.last_period(now);
        let pulses = self.pulses(end) - self.pulses(begin);
        (pulses.unsigned_abs().saturating_mul(1000) / u64::from(self.period_ms.get())) as i32
    }

    /// Beginning and end of the last period that is over.
    fn last_period(&self, now: u64) -> (u64, u64) {
        let period = u64::from(self.period_ms.get()) * NS_PER_MS;
        let end = now - now % period;
        (end.saturating_sub(period), end)
    }

    /// The last pulse up to `now`, none: 0.
    fn last_pulse(&self, now: u64) -> u64 {
        let last = |train: &Train| {
            let pulses = train.pulses(now);
            (pulses > 0).then(|| train.start.saturating_add(pulses.saturating_mul(train.period)))
        };
        self.trains.borrow().iter().rev().find_map(last).unwrap_or(0)
    }

    /// Mode `Period`: time in nanoseconds from the last pulse before the last period that is over to its last pulse, or without a pulse
    /// in it to its end; and the number of pulses in it. A time that is too long is `u32::MAX`.
    pub fn measured(&self, now: u64) -> (u32, u32) {
        const LONGEST: u64 = 0xFFFF_FFF0;
        if !self.enabled.get() {
            return (0, 0);
        }
        let (begin, end) = self.last_period(now);
        let edges: u64 = self.trains.borrow().iter().map(|train| train.pulses(end) - train.pulses(begin)).sum();
        let until = if edges > 0 { self.last_pulse(end) } else { end };
        let time = until.saturating_sub(self.last_pulse(begin));
        let time = if time > LONGEST { u32::MAX } else { time as u32 };
        (time, u32::try_from(edges).unwrap_or(u32::MAX))
    }

    /// Counting continues from `value`.
    pub fn set_count(&self, now: u64, value: i32) {
        let pulses = self.pulses(now);
        self.base.set(Base { pulses, value });
        self.seen.set(pulses);
    }

    pub fn set_down(&self, now: u64, down: bool) {
        self.set_count(now, self.count(now));
        self.down.set(down);
    }

    pub fn set_reference(&self, reference: i32) {
        self.reference.set(reference);
    }

    pub fn set_second_reference(&self, reference: i32) {
        self.second_reference.set(Some(reference));
    }

    pub fn set_start_value(&self, value: i32) {
        self.start_value.set(value);
    }

    /// Pulses count from now on, or no longer.
    pub fn set_enabled(&self, now: u64, enabled: bool) {
        if self.enabled.get() != enabled {
            self.set_count(now, self.count(now));
            self.enabled.set(enabled);
        }
    }

    /// Whether the input for the reset has an effect.
    pub fn set_resets(&self, resets: bool) {
        self.resets.set(resets);
    }

    /// Whether a reset sets the count.
    pub fn set_reset_sets(&self, sets: bool) {
        self.reset_sets.set(sets);
    }

    /// The input for the reset rises. Result: it has an effect.
    pub fn reset(&self, now: u64) -> bool {
        if self.resets.get() && self.reset_sets.get() {
            self.set_count(now, self.start_value.get());
        }
        self.resets.get()
    }

    /// Level of the input for the reset at the last look.
    pub fn is_reset(&self) -> bool {
        self.reset_level.get()
    }

    /// What has happened since the last call.
    pub fn take_passed(&self) -> Passed {
        self.passed.take()
    }

    pub fn set_period(&self, ms: u16) {
        self.period_ms.set(ms.max(1));
    }

    /// A train begins; the one before it ends. Result: the direction given by the inputs changed.
    pub fn begin(&self, train: Train) -> bool {
        let mut trains = self.trains.borrow_mut();
        let mut changed = false;
        if let Some(last) = trains.last_mut() {
            last.count = last.pulses(train.start);
            changed = last.backward != train.backward;
        } else if train.backward {
            changed = true;
        }
        trains.push(train);
        let turned = changed && self.config.mode.is_external();
        if turned {
            self.passed.set(Passed { turned, ..self.passed.get() });
        }
        turned
    }

    /// When the count reaches the reference, if the pulses continue.
    pub fn due(&self, now: u64) -> Option<u64> {
        if !self.enabled.get() {
            return None;
        }
        let trains = self.trains.borrow();
        let train = trains.last()?;
        let step = if train.backward { -self.step() } else { self.step() };
        let distance = i64::from(self.reference.get()) - i64::from(self.count(now));
        if distance == 0 || (distance < 0) != (step < 0) {
            return None;
        }
        let wanted = train.pulses(now) + distance.unsigned_abs().div_ceil(step.unsigned_abs());
        (wanted <= train.count).then(|| train.start.saturating_add(wanted.saturating_mul(train.period)))
    }

    /// True if the count has reached the reference since the last look.
    pub fn reached(&self, now: u64) -> bool {
        let (before, after) = (self.seen.get(), self.pulses(now));
        self.seen.set(after);
        if !self.enabled.get() {
            return false;
        }
        let moved = (after - before).wrapping_mul(self.step());
        let from = i64::from(self.count(now)) - moved;
        let reaches = |reference: i32| {
            // From where the count was to the reference.
            let distance = i64::from(reference) - from;
            distance != 0 && (distance < 0) == (moved < 0) && distance.abs() <= moved.abs()
        };
        let reached = reaches(self.reference.get());
        let mut passed = self.passed.get();
        passed.reference |= reached;
        passed.second_reference |= self.second_reference.get().is_some_and(reaches);
        // The count is where it would be without an end, less all values of a DINT.
        passed.above |= from < i64::from(i32::MIN);
        passed.below |= from > i64::from(i32::MAX);
        self.passed.set(passed);
        reached
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counter(mode: CountMode, reference: i32) -> Counter {
        let config = FastCounter { number: 1, mode, down: false, initial: 0, reference, reset: None, period_ms: 100 };
        Counter::new(&config)
    }

    const KHZ: u64 = 1_000_000;

    #[test]
    fn counts_and_finds_the_moment_of_the_reference() {
        let counter = counter(CountMode::Single, 5);
        assert!(!counter.begin(Train { start: 10 * KHZ, period: KHZ, count: 8, backward: false }));
        assert_eq!((counter.count(10 * KHZ), counter.count(12 * KHZ), counter.count(99 * KHZ)), (0, 2, 8));
        assert_eq!(counter.due(10 * KHZ), Some(15 * KHZ));
        assert!(!counter.reached(14 * KHZ) && counter.reached(15 * KHZ) && !counter.reached(16 * KHZ));
        assert_eq!(counter.due(16 * KHZ), None);
        counter.set_down(16 * KHZ, true);
        assert_eq!(counter.due(16 * KHZ), Some(17 * KHZ));
        assert!(counter.reached(18 * KHZ));
        assert_eq!(counter.count(18 * KHZ), 4);
    }

    #[test]
    fn quadrature_counts_four_and_back() {
        let counter = counter(CountMode::Quadrature(4), 10);
        counter.begin(Train { start: 0, period: KHZ, count: 100, backward: false });
        // The tenth count is inside the third pulse.
        assert_eq!(counter.due(0), Some(3 * KHZ));
        assert!(counter.begin(Train { start: 5 * KHZ, period: KHZ, count: 2, backward: true }));
        assert_eq!((counter.count(5 * KHZ), counter.count(50 * KHZ)), (20, 12));
    }

    #[test]
    fn frequency_of_the_last_period() {
        let counter = counter(CountMode::Frequency, 0);
        counter.begin(Train { start: 0, period: KHZ, count: 1_000_000, backward: false });
        assert_eq!((counter.value(99 * KHZ), counter.value(100 * KHZ), counter.value(250 * KHZ)), (0, 1000, 1000));
    }

    #[test]
    fn period_from_pulse_to_pulse() {
        let counter = counter(CountMode::Period, 0);
        counter.begin(Train { start: 0, period: 40 * KHZ, count: 6, backward: false });
        // Pulses at 40, 80 ms, then at 120, 160, 200 ms, and at 240 ms.
        assert_eq!(counter.measured(99 * KHZ), (0, 0));
        assert_eq!(counter.measured(100 * KHZ), (80_000_000, 2));
        assert_eq!(counter.measured(250 * KHZ), (120_000_000, 3));
        assert_eq!(counter.measured(300 * KHZ), (40_000_000, 1));
        // Without a pulse: the time since the last one.
        assert_eq!(counter.measured(599 * KHZ), (260_000_000, 0));
        assert_eq!(counter.measured(9_000 * KHZ), (u32::MAX, 0));
        assert_eq!(counter.value(250 * KHZ), 0);
    }

    #[test]
    fn disabled_counters_keep_their_count() {
        let counter = counter(CountMode::Single, 12);
        counter.set_second_reference(3);
        counter.begin(Train { start: 0, period: KHZ, count: 100, backward: false });
        assert!(!counter.reached(5 * KHZ));
        counter.set_enabled(5 * KHZ, false);
        assert_eq!((counter.count(20 * KHZ), counter.due(20 * KHZ)), (5, None));
        assert!(!counter.reached(20 * KHZ));
        counter.set_enabled(30 * KHZ, true);
        assert_eq!((counter.count(32 * KHZ), counter.due(32 * KHZ)), (7, Some(37 * KHZ)));
        assert_eq!(counter.take_passed(), Passed { second_reference: true, ..Passed::default() });
        assert!(counter.reached(37 * KHZ));
        assert_eq!(counter.take_passed(), Passed { reference: true, ..Passed::default() });
        assert_eq!(counter.take_passed(), Passed::default());
    }

    #[test]
    fn counting_wraps() {
        let counter = counter(CountMode::Single, 0);
        counter.set_count(0, i32::MAX);
        counter.begin(Train { start: 0, period: 1, count: 1, backward: false });
        assert_eq!(counter.count(5), i32::MIN);
        assert!(!counter.reached(5));
        assert_eq!(counter.take_passed(), Passed { above: true, ..Passed::default() });
        counter.set_down(5, true);
        counter.begin(Train { start: 5, period: 1, count: 1, backward: false });
        assert!(!counter.reached(6));
        assert_eq!((counter.count(6), counter.take_passed()), (i32::MAX, Passed { below: true, ..Passed::default() }));
    }
}
