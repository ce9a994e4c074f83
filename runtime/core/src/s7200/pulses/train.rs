//! Pulses of a PTO as a function of time: segments whose cycle time changes evenly from pulse to pulse.
//!
//! Everything is computed in closed form, whole numbers only: a segment may have 4 294 967 295 pulses.
//! Source: S7-200 system manual, pulse output instruction.

/// Shortest and longest cycle, in units of the time base.
pub(super) const CYCLE_MIN: u16 = 2;
const CYCLE_MAX: u16 = u16::MAX;
/// Bytes of a segment in a profile table.
pub(super) const SEGMENT_BYTES: u32 = 8;

/// Pulses whose cycles change by the same number each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Segment {
    /// Cycle of the first pulse, in units of the time base.
    pub first: u16,
    pub delta: i16,
    pub count: u32,
}

impl Segment {
    /// Pulses until one would have an impossible cycle: all, or fewer.
    pub fn pulses(&self) -> u64 {
        let room = match self.delta {
            0 => return self.count.into(),
            delta if delta > 0 => CYCLE_MAX.saturating_sub(self.first),
            _ => self.first.saturating_sub(CYCLE_MIN),
        };
        u64::from(self.count).min(u64::from(room / self.delta.unsigned_abs()) + 1)
    }

    /// The cycle time leaves its range before the last pulse.
    pub fn fails(&self) -> bool {
        self.pulses() < u64::from(self.count)
    }

    /// Units from the beginning of the segment to that of `pulse`, 0 to [`pulses`](Segment::pulses).
    pub fn begin(&self, pulse: u64) -> u64 {
        let pulse = i128::from(pulse);
        let units = i128::from(self.first) * pulse + i128::from(self.delta) * (pulse * (pulse - 1) / 2);
        u64::try_from(units).unwrap_or(0)
    }

    /// Units that `pulse` is 1: half of its cycle, the shorter half.
    fn high(&self, pulse: u64) -> u64 {
        self.begin(pulse.saturating_add(1)).saturating_sub(self.begin(pulse)) / 2
    }

    /// The pulse at `units` after the beginning, [`pulses`](Segment::pulses) after the last one.
    fn pulse_at(&self, units: u64) -> u64 {
        let (mut low, mut high) = (0, self.pulses());
        // `low` has begun, or is 0.
        while low < high {
            let middle = low + (high - low).div_ceil(2);
            if self.begin(middle) <= units {
                low = middle;
            } else {
                high = middle - 1;
            }
        }
        low
    }
}

/// A segment at its place in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Placed {
    pub segment: Segment,
    /// In nanoseconds.
    pub start: u64,
    /// Nanoseconds of a unit.
    pub unit: u64,
}

impl Placed {
    fn at(&self, units: u64) -> u64 {
        self.start.saturating_add(units.saturating_mul(self.unit))
    }

    fn units(&self, time: u64) -> u64 {
        time.saturating_sub(self.start) / self.unit.max(1)
    }

    /// When the last pulse is over.
    pub fn end(&self) -> u64 {
        self.at(self.segment.begin(self.segment.pulses()))
    }

    /// Pulses that have begun at `time`.
    pub fn begun(&self, time: u64) -> u64 {
        if time < self.start {
            return 0;
        }
        self.segment.pulse_at(self.units(time)).saturating_add(1).min(self.segment.pulses())
    }

    /// When `pulse` begins; `None`: it does not have this pulse.
    pub fn begin(&self, pulse: u64) -> Option<u64> {
        (pulse < self.segment.pulses()).then(|| self.at(self.segment.begin(pulse)))
    }

    pub fn level(&self, time: u64) -> bool {
        let units = self.units(time);
        let pulse = self.segment.pulse_at(units);
        let since = units.saturating_sub(self.segment.begin(pulse));
        time >= self.start && pulse < self.segment.pulses() && since < self.segment.high(pulse)
    }

    /// Edges after `from`, up to `to`, in order.
    pub fn edges(&self, from: u64, to: u64) -> impl Iterator<Item = (u64, bool)> + use<> {
        let placed = *self;
        let first = placed.segment.pulse_at(placed.units(from));
        let edges = (first..placed.segment.pulses()).flat_map(move |pulse| {
            let begin = placed.segment.begin(pulse);
            let fall = begin.saturating_add(placed.segment.high(pulse));
            [(placed.at(begin), true), (placed.at(fall), false)]
        });
        edges.skip_while(move |&(time, _)| time <= from).take_while(move |&(time, _)| time <= to)
    }
}

/// A train of segments that runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Train {
    segments: Vec<Segment>,
    /// Place in `segments`, and when that one began.
    index: usize,
    start: u64,
    pub unit: u64,
    /// From a profile table.
    pub profile: bool,
}

impl Train {
    pub fn new(segments: Vec<Segment>, unit: u64, profile: bool, start: u64) -> Train {
        Train { segments, index: 0, start, unit, profile }
    }

    /// Begins at `start`.
    pub fn begin(self, start: u64) -> Train {
        Train { index: 0, start, ..self }
    }

    /// The running segment.
    pub fn placed(&self) -> Option<Placed> {
        let segment = self.segments.get(self.index)?;
        Some(Placed { segment: *segment, start: self.start, unit: self.unit })
    }

    /// Number of the running segment in its profile, 1 to 255; 0 without a profile.
    pub fn number(&self) -> u8 {
        if self.profile { u8::try_from(self.index + 1).unwrap_or(u8::MAX) } else { 0 }
    }

    /// Advances to the next segment, which begins at `start`. False: there is none.
    pub fn next(&mut self, start: u64) -> bool {
        self.index += 1;
        self.start = start;
        self.index < self.segments.len()
    }
}
