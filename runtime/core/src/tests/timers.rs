//! S5 timers, instruction by instruction, in virtual time.

use plcc_abi::functions::TimerMode;
use plcc_abi::layout::{self, timer_cell};

use crate::clock::Clock;
use crate::memory::Memory;
use crate::timers;

const MS: u64 = 1_000_000;
/// 1 s in steps of 10 ms.
const SECOND: u32 = 0x0100;

struct Bench {
    memory: Memory,
    clock: Clock,
}

impl Bench {
    fn new() -> Bench {
        Bench { memory: Memory::new(layout::DB_DATA), clock: Clock::simulated() }
    }

    fn start(&self, mode: TimerMode, value: u32, rlo: u8) {
        timers::start(&self.memory, &self.clock, 5, mode, value, rlo != 0);
    }

    fn pass(&self, ms: u64) {
        self.clock.move_to(self.clock.now() + ms * MS);
    }

    fn q(&self) -> bool {
        timers::scan(&self.memory, &self.clock, 5)
    }

    fn value(&self) -> u32 {
        self.info() & 0xFFFF
    }

    /// Value and base.
    fn value_and_base(&self) -> (u32, u32) {
        (self.value(), self.info() >> timer_cell::BASE_SHIFT & 3)
    }

    fn info(&self) -> u32 {
        timers::settle(&self.memory, &self.clock, 5);
        self.memory.host32(layout::T + 5 * layout::TIMER_CELL_BYTES + timer_cell::INFO)
    }
}

#[test]
fn pulse_ends_by_time() {
    let bench = Bench::new();
    bench.start(TimerMode::Pulse, SECOND, 1);
    assert!(bench.q());
    bench.pass(999);
    bench.start(TimerMode::Pulse, SECOND, 1);
    assert!(bench.q());
    assert_eq!(bench.value(), 1);
    bench.pass(1);
    assert!(!bench.q());
    assert_eq!(bench.value(), 0);
}

#[test]
fn pulse_ends_by_rlo_and_keeps_the_value() {
    let bench = Bench::new();
    bench.start(TimerMode::Pulse, SECOND, 1);
    bench.pass(395);
    bench.start(TimerMode::Pulse, SECOND, 0);
    assert!(!bench.q());
    assert_eq!(bench.value(), 61);
    bench.pass(5000);
    assert_eq!(bench.value_and_base(), (61, 0));
}

#[test]
fn extended_pulse_runs_on_and_restarts() {
    let bench = Bench::new();
    bench.start(TimerMode::ExtendedPulse, SECOND, 1);
    bench.start(TimerMode::ExtendedPulse, SECOND, 0);
    bench.pass(600);
    assert!(bench.q());
    bench.start(TimerMode::ExtendedPulse, SECOND, 1);
    bench.pass(600);
    assert!(bench.q());
    bench.pass(400);
    assert!(!bench.q());
}

#[test]
fn on_delay_rises_after_its_time_while_rlo_stays() {
    let bench = Bench::new();
    bench.start(TimerMode::OnDelay, SECOND, 1);
    assert!(!bench.q());
    bench.pass(1000);
    assert!(bench.q());
    bench.start(TimerMode::OnDelay, SECOND, 0);
    assert!(!bench.q());
}

#[test]
fn on_delay_broken_off_freezes() {
    let bench = Bench::new();
    bench.start(TimerMode::OnDelay, 0x2010, 1);
    bench.pass(2500);
    bench.start(TimerMode::OnDelay, 0x2010, 0);
    bench.pass(100_000);
    assert!(!bench.q());
    assert_eq!(bench.value_and_base(), (8, 2));
    // As generated code leaves the cell, which recordings compare.
    assert_eq!(bench.info(), 8 | 2 << timer_cell::BASE_SHIFT);
}

#[test]
fn retentive_on_delay_stays() {
    let bench = Bench::new();
    bench.start(TimerMode::RetentiveOnDelay, SECOND, 1);
    bench.start(TimerMode::RetentiveOnDelay, SECOND, 0);
    bench.pass(500);
    bench.start(TimerMode::RetentiveOnDelay, SECOND, 1);
    bench.pass(999);
    assert!(!bench.q());
    bench.pass(1);
    assert!(bench.q());
    bench.start(TimerMode::RetentiveOnDelay, SECOND, 0);
    bench.start(TimerMode::RetentiveOnDelay, SECOND, 1);
    assert!(bench.q(), "a restart after expiry does not clear the status");
    assert_eq!(bench.value(), 100);
}

#[test]
fn off_delay_falls_after_its_time() {
    let bench = Bench::new();
    bench.start(TimerMode::OffDelay, SECOND, 0);
    assert!(!bench.q());
    bench.start(TimerMode::OffDelay, SECOND, 1);
    assert!(bench.q());
    bench.start(TimerMode::OffDelay, SECOND, 0);
    bench.pass(400);
    assert!(bench.q());
    bench.start(TimerMode::OffDelay, SECOND, 1);
    bench.pass(5000);
    assert!(bench.q(), "stopped by RLO 1, status stays 1");
    assert_eq!(bench.value(), 60);
    bench.start(TimerMode::OffDelay, SECOND, 0);
    assert_eq!(bench.value(), 100);
    bench.pass(1000);
    assert!(!bench.q());
}

#[test]
fn a_time_of_zero() {
    for (mode, rising, falling) in [
        (TimerMode::Pulse, false, false),
        (TimerMode::ExtendedPulse, false, false),
        (TimerMode::OnDelay, true, false),
        (TimerMode::RetentiveOnDelay, true, true),
        (TimerMode::OffDelay, true, false),
    ] {
        let bench = Bench::new();
        bench.start(mode, 0, 1);
        assert_eq!(bench.q(), rising, "{mode:?}");
        bench.start(mode, 0, 0);
        assert_eq!(bench.q(), falling, "{mode:?}");
    }
}

#[test]
fn bases_and_rounding_up() {
    for (base, ns) in [(0, 10 * MS), (1, 100 * MS), (2, 1000 * MS), (3, 10_000 * MS)] {
        let bench = Bench::new();
        bench.start(TimerMode::ExtendedPulse, base << 12 | 0x999, 1);
        assert_eq!(bench.value(), 999);
        bench.clock.move_to(ns - 1);
        assert_eq!(bench.value(), 999);
        bench.clock.move_to(ns);
        assert_eq!(bench.value(), 998);
        assert_eq!(bench.value_and_base(), (998, base));
    }
}

#[test]
fn numbers_outside_are_ignored() {
    let bench = Bench::new();
    timers::start(&bench.memory, &bench.clock, u32::MAX, TimerMode::Pulse, SECOND, true);
    assert!(!timers::scan(&bench.memory, &bench.clock, 4_000_000));
}
