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

/// See the module comment.
pub struct Counter {
    pub config: FastCounter,
    /// In the order of time; all but the last are over.
    trains: RefCell<Vec<Train>>,
    base: Cell<Base>,
    down: Cell<bool>,
    reference: Cell<i32>,
    period_ms: Cell<u16>,
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
        base.value.wrapping_add(((self.pulses(now) - base.pulses).wrapping_mul(self.step())) as i32)
    }

    /// The value at the input address: the count, or the frequency in hertz of the last period that is over.
    pub fn value(&self, now: u64) -> i32 {
        if self.config.mode != CountMode::Frequency {
            return self.count(now);
        }
        let period = u64::from(self.period_ms.get()) * NS_PER_MS;
        let end = now - now % period;
        let pulses = self.pulses(end) - self.pulses(end.saturating_sub(period));
        (pulses.unsigned_abs().saturating_mul(1000) / u64::from(self.period_ms.get())) as i32
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
        changed && self.config.mode.is_external()
    }

    /// When the count reaches the reference, if the pulses continue.
    pub fn due(&self, now: u64) -> Option<u64> {
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
        let moved = (after - before).wrapping_mul(self.step());
        // From where the count was to the reference.
        let distance = i64::from(self.reference.get()) - (i64::from(self.count(now)) - moved);
        distance != 0 && (distance < 0) == (moved < 0) && distance.abs() <= moved.abs()
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
    fn counting_wraps() {
        let counter = counter(CountMode::Single, 0);
        counter.set_count(0, i32::MAX);
        counter.begin(Train { start: 0, period: 1, count: 1, backward: false });
        assert_eq!(counter.count(5), i32::MIN);
    }
}
