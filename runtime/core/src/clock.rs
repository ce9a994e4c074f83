//! The clock of a CPU: real (monotonic) or virtual (moves only on request).
//!
//! Time is a `u64` of nanoseconds since the CPU was made. The wall clock is that plus a base which SFC 0 sets.

use std::cell::Cell;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use plcc_abi::layout::state;

use crate::datetime;

pub const NS_PER_MS: u64 = 1_000_000;

/// See the module comment.
pub struct Clock {
    /// Set: the real clock.
    origin: Option<Instant>,
    /// Time of the virtual clock.
    now: Cell<u64>,
    /// Wall clock at time 0.
    wall_base: Cell<i64>,
    /// What the timers of the CPU had counted at time 0, in nanoseconds.
    counted_before: Cell<u64>,
    /// A full second of the wall clock and its DATE_AND_TIME.
    second: Cell<(i64, [u8; 8])>,
}

impl Clock {
    pub fn real() -> Clock {
        let wall = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as i64);
        Clock {
            origin: Some(Instant::now()),
            now: Cell::new(0),
            wall_base: Cell::new(wall),
            counted_before: Cell::new(0),
            second: no_second(),
        }
    }

    /// Starts at time 0 and 1994-01-01 00:00:00.
    pub fn simulated() -> Clock {
        Clock {
            origin: None,
            now: Cell::new(0),
            wall_base: Cell::new(datetime::VIRTUAL_START),
            counted_before: Cell::new(0),
            second: no_second(),
        }
    }

    pub fn is_virtual(&self) -> bool {
        self.origin.is_none()
    }

    /// Nanoseconds since the CPU was made.
    pub fn now(&self) -> u64 {
        match self.origin {
            Some(origin) => origin.elapsed().as_nanos() as u64,
            None => self.now.get(),
        }
    }

    /// Milliseconds that the CPU has counted, 0..=2147483647, then from 0 again: since the start, and before it if its memory is retentive.
    pub fn ticks(&self) -> u32 {
        ((self.counted() / NS_PER_MS) & 0x7FFF_FFFF) as u32
    }

    /// Nanoseconds that the CPU has counted for its timers.
    pub fn counted(&self) -> u64 {
        self.counted_before.get().wrapping_add(self.now())
    }

    /// The timers of the CPU go on from `counted`: times that began before a restart last as long as if there had been none.
    pub fn count_from(&self, counted: u64) {
        self.counted_before.set(counted.wrapping_sub(self.now()));
    }

    /// What generated code sees of the clock: the fields `COUNTDOWN` and `TICKS` of the CPU state.
    pub fn fields(&self) -> (u64, u32) {
        match self.origin {
            Some(_) => (state::ASK, 1 << 31),
            None => (u64::MAX - self.now.get(), self.ticks()),
        }
    }

    /// Moves the virtual clock forward to `time`; never back. The real clock moves itself.
    pub fn move_to(&self, time: u64) {
        self.now.set(time.max(self.now.get()));
    }

    /// Wall clock, see [`datetime`].
    pub fn wall(&self) -> i64 {
        self.wall_base.get().saturating_add(self.now() as i64)
    }

    /// The wall clock as DATE_AND_TIME. Every OB has it in its start information, so it is worth computing the date once a second only.
    pub fn wall_bytes(&self) -> [u8; 8] {
        let wall = self.wall();
        let (start, bytes) = self.second.get();
        let since = wall.wrapping_sub(start);
        if (0..datetime::NS_PER_S).contains(&since) {
            return datetime::with_milliseconds(bytes, (since as u64 / NS_PER_MS) as u32);
        }
        let start = wall.div_euclid(datetime::NS_PER_S) * datetime::NS_PER_S;
        self.second.set((start, datetime::encode(start)));
        datetime::encode(wall)
    }

    /// Sets the wall clock to `moment`; what is due by the other clock stays.
    pub fn set_wall(&self, moment: i64) {
        self.wall_base.set(moment.saturating_sub(self.now() as i64));
    }

    /// The time at which the wall clock shows `moment`; 0 if that is past.
    pub fn time_of(&self, moment: i64) -> u64 {
        u64::try_from(moment.saturating_sub(self.wall_base.get())).unwrap_or(0)
    }
}

/// A second that no clock shows.
fn no_second() -> Cell<(i64, [u8; 8])> {
    Cell::new((i64::MIN, [0; 8]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_the_wall_clock_are_those_of_its_moment() {
        let clock = Clock::simulated();
        for step in [0, 1, 999_999, 1_000_000, 10_500_000, 998_000_000, 999_999_999, 86_400_000_000_000] {
            clock.move_to(clock.now() + step);
            assert_eq!(clock.wall_bytes(), datetime::encode(clock.wall()), "{step}");
        }
        clock.set_wall(datetime::VIRTUAL_START - 12_345_678);
        assert_eq!(clock.wall_bytes(), datetime::encode(clock.wall()));
    }
}
