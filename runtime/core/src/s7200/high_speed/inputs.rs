//! Levels of the inputs of the CPU over time: from the driver, or a train of pulses.

use super::modes::{PINS, Pin, bit};

/// Pulses at equal distances, as a function of time in nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::s7200) struct Train {
    /// The first rising edge.
    pub first: u64,
    /// From one rising edge to the next.
    pub period: u64,
    /// How long a pulse is 1; above 0, below the period.
    pub high: u64,
    pub count: u64,
}

impl Train {
    /// Pulses at one input: the first rising edge comes one period after `start`.
    pub fn single(start: u64, period: u64, count: u64) -> Train {
        let period = period.max(4);
        Train { first: start.saturating_add(period), period, high: period / 2, count }
    }

    /// Pulses at clocks A and B a quarter of a period apart; A leads, or B if `backward`. Each period after `start` has all four edges.
    pub fn pair(start: u64, period: u64, count: u64, backward: bool) -> (Train, Train) {
        let period = period.max(4);
        let train = |offset: u64| Train { first: start.saturating_add(offset), period, high: period / 2, count };
        let (leading, following) = (train(period / 4), train(period / 2));
        if backward { (following, leading) } else { (leading, following) }
    }

    /// The pulse that has begun at or before `time`, and the time since then.
    fn pulse(&self, time: u64) -> Option<(u64, u64)> {
        let since = time.checked_sub(self.first)?;
        Some((since / self.period.max(1), since % self.period.max(1)))
    }

    /// When the pulse after the last one would begin.
    fn end(&self) -> u64 {
        self.first.saturating_add(self.count.saturating_mul(self.period))
    }

    fn level(&self, time: u64) -> bool {
        self.pulse(time).is_some_and(|(pulse, since)| pulse < self.count && since < self.high)
    }

    /// The next edge after `time`.
    fn next(&self, time: u64) -> Option<u64> {
        match self.pulse(time) {
            None => (self.count > 0).then_some(self.first),
            Some((pulse, _)) if pulse >= self.count => None,
            Some((_, since)) if since < self.high => Some(time.saturating_add(self.high - since)),
            Some((pulse, _)) if pulse + 1 >= self.count => None,
            Some((_, since)) => Some(time.saturating_add(self.period - since)),
        }
    }
}

/// All inputs that counters look at.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::s7200) struct Wires {
    /// Levels where no train is.
    levels: u16,
    trains: [Option<Train>; PINS],
}

impl Wires {
    fn trains(&self, mask: u16) -> impl Iterator<Item = (Pin, &Train)> {
        let trains = (0..).zip(&self.trains).filter_map(|(pin, train)| Some((pin, train.as_ref()?)));
        trains.filter(move |(pin, _)| bit(*pin) & mask != 0)
    }

    /// Levels of the inputs of `mask` at `time`.
    pub fn levels(&self, mask: u16, time: u64) -> u16 {
        self.trains(mask).fold(self.levels & mask, |levels, (pin, train)| match train.level(time) {
            true => levels | bit(pin),
            false => levels & !bit(pin),
        })
    }

    /// The next edge of a train at an input of `mask` after `time`.
    pub fn next(&self, mask: u16, time: u64) -> Option<u64> {
        self.trains(mask).filter_map(|(_, train)| train.next(time)).min()
    }

    /// Where levels at the inputs of `mask` repeat after `time`: their period, and how often; `None`: they do not.
    pub fn repeats(&self, mask: u16, time: u64) -> Option<(u64, u64)> {
        let mut found: Option<(u64, u64)> = None;
        for (_, train) in self.trains(mask).filter(|(_, train)| train.next(time).is_some()) {
            if time < train.first || found.is_some_and(|(period, _)| period != train.period) {
                return None;
            }
            let times = train.end().saturating_sub(1).saturating_sub(time) / train.period.max(1);
            found = Some((train.period, found.map_or(times, |(_, other)| times.min(other))));
        }
        found
    }

    /// Inputs with trains, one bit each.
    pub fn driven(&self) -> u16 {
        self.trains(u16::MAX).fold(0, |mask, (pin, _)| mask | bit(pin))
    }

    /// Takes trains off that are over. Result: which inputs had one.
    pub fn end_trains(&mut self, time: u64) -> u16 {
        let over = self.trains(u16::MAX).filter(|(_, train)| train.next(time).is_none() && !train.level(time));
        let over = over.fold(0, |mask, (pin, _)| mask | bit(pin));
        self.remove(over);
        over
    }

    /// Takes the trains off the inputs of `mask`; their levels are 0.
    pub fn remove(&mut self, mask: u16) {
        self.levels &= !mask;
        for (_, train) in (0..).zip(&mut self.trains).filter(|(pin, _)| bit(*pin) & mask != 0) {
            *train = None;
        }
    }

    /// A train begins at an input.
    pub fn begin(&mut self, pin: Pin, train: Train) {
        if let Some(place) = self.trains.get_mut(usize::from(pin)) {
            *place = Some(train);
        }
    }

    /// Levels from the driver, for inputs without trains.
    pub fn set_levels(&mut self, levels: u16) {
        self.levels = levels;
    }
}
