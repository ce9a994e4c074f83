//! Trains of pulses: counting at any moment, the moment of an event, long trains.

use super::super::inputs::Train;
use super::super::modes::bit;
use super::Bench;

const MS: u64 = 1_000_000;
const DAY: u64 = 86_400_000 * MS;

impl Bench {
    fn train(&mut self, pin: u8, period: u64, count: u64) {
        self.levels &= !bit(pin);
        self.bank.wires.remove(bit(pin));
        self.events();
        self.bank.wires.begin(pin, Train::single(self.time, period, count));
    }

    fn pair(&mut self, pins: (u8, u8), period: u64, count: u64, backward: bool) {
        let (a, b) = Train::pair(self.time, period, count, backward);
        self.bank.wires.begin(pins.0, a);
        self.bank.wires.begin(pins.1, b);
    }

    fn at(&mut self, time: u64) -> Vec<u8> {
        self.time = time;
        self.events()
    }

    fn due(&self) -> Option<u64> {
        self.bank.due(&[7; 6], 0)
    }
}

#[test]
fn a_train_is_a_function_of_time() {
    let train = Train::single(10, 100, 2);
    let mut bench = Bench::new();
    bench.time = 10;
    bench.bank.wires.begin(0, train);
    let level = |time: u64| bench.bank.wires.levels(1, time) != 0;
    let levels: Vec<bool> = [10, 109, 110, 159, 160, 209, 210, 259, 260, 310].into_iter().map(level).collect();
    assert_eq!(levels, [false, false, true, true, false, false, true, true, false, false]);
    let mut edges = Vec::new();
    let mut time = 10;
    while let Some(edge) = bench.bank.wires.next(1, time) {
        edges.push(edge);
        time = edge;
    }
    assert_eq!(edges, [110, 160, 210, 260]);
}

#[test]
fn preset_is_reached_at_its_time() {
    // 1100 pulses of 10 kHz from -100 on: the last one makes 1000.
    let mut bench = Bench::counter(1, 0, 0xF8, -100, 1000);
    bench.train(6, MS / 10, 2000);
    assert_eq!(bench.due(), Some(110 * MS));
    assert!(bench.at(50 * MS).is_empty());
    assert_eq!((bench.current(1), bench.due()), (400, Some(110 * MS)));
    assert!(bench.at(110 * MS - 1).is_empty());
    assert_eq!(bench.at(110 * MS), [13]);
    assert_eq!((bench.current(1), bench.status(1)), (1000, 0x60));
    bench.control(1, 0xA0, 0, 2000);
    assert_eq!(bench.due(), None, "the train ends at 1900");
    assert!(bench.at(DAY).is_empty());
    assert_eq!(bench.current(1), 1900);
}

#[test]
fn levels_and_trains_together() {
    // Direction by a level: 10 pulses up, 4 down.
    let mut bench = Bench::counter(1, 3, 0xF8, 0, 100);
    bench.levels = 1 << 7;
    bench.events();
    bench.train(6, MS, 14);
    bench.at(10 * MS);
    bench.levels = 0;
    assert_eq!(bench.events(), [14]);
    assert_eq!(bench.current(1), 10);
    bench.at(DAY);
    assert_eq!(bench.current(1), 6);
}

#[test]
fn quadrature_trains() {
    for (control, counts) in [(0xF8, 4), (0xFC, 1)] {
        let mut bench = Bench::counter(2, 9, control, 0, 40 * counts);
        bench.pair((10, 11), MS, 100, false);
        // 4 times: count 160 is the last edge of period 40. Once: count 40 is the rising edge of A in it, at a quarter.
        let wanted = if counts == 4 { 40 * MS } else { 39 * MS + MS / 4 };
        assert_eq!(bench.due(), Some(wanted));
        assert_eq!(bench.at(wanted), [16]);
        bench.at(200 * MS);
        assert_eq!(bench.current(2), 100 * counts);
        bench.pair((10, 11), MS, 30, true);
        assert_eq!(bench.at(DAY), [17]);
        assert_eq!(bench.current(2), 70 * counts);
    }
}

#[test]
fn long_trains_take_no_time() {
    // 4 294 967 295 pulses of 1 MHz, and the preset near the end.
    let mut bench = Bench::counter(1, 0, 0xF8, 0, -10);
    bench.train(6, 1000, 4_294_967_295);
    // -10 is 2^32 - 10 pulses away.
    assert_eq!(bench.due(), Some(4_294_967_286_000));
    assert_eq!(bench.at(DAY), [13]);
    assert_eq!(bench.current(1), -1);
    let mut bench = Bench::counter(1, 9, 0xF8, 0, 5);
    bench.pair((6, 7), 1000, u64::MAX, false);
    bench.bank.counter_mut(1).unwrap().preset = i32::MAX;
    assert_eq!(bench.due(), Some((1 << 29) * 1000 - 250));
    bench.at(1_000_000_000 * MS);
    // 4e12 counts modulo 2^32: 4e12 = 931 * 2^32 + 1_385_447_424.
    assert_eq!(bench.current(1), 1_385_447_424);
}

#[test]
fn up_and_down_at_the_same_rate() {
    let mut bench = Bench::counter(1, 6, 0xF8, 0, 3);
    bench.train(6, 1000, u64::MAX);
    bench.time = 500;
    bench.train(7, 1000, u64::MAX);
    assert_eq!(bench.due(), Some(1500), "the direction changes");
    let only_preset = [0, 1, 0, 0, 0, 0];
    assert!(bench.bank.due(&only_preset, 0).is_some_and(|due| due > DAY), "3 is never reached");
}

/// A small generator of numbers, the same ones every time.
fn random(state: &mut u64, below: u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) % below
}

#[test]
fn one_look_sees_what_many_looks_see() {
    let mut state = 7;
    for round in 0..200 {
        let mode = random(&mut state, 12) as u32;
        let control = 0xE0 | random(&mut state, 32) as u8;
        let preset = random(&mut state, 60) as i32 - 30;
        let mut once = Bench::counter(1, mode, control, 0, preset);
        once.levels = (random(&mut state, 16) as u16) << 6;
        once.events();
        let same = random(&mut state, 2) == 0;
        let period = 40 + random(&mut state, 200);
        for pin in 6..=9u8 {
            if random(&mut state, 3) != 0 && (pin < 8 || random(&mut state, 3) == 0) {
                let period = if same { period } else { 40 + random(&mut state, 200) };
                once.time = random(&mut state, 30);
                once.train(pin, period, random(&mut state, 60));
            }
        }
        let mut often = Bench::new();
        often.bank = Bench::counter(1, mode, control, 0, preset).bank;
        often.levels = once.levels;
        often.bank.wires = once.bank.wires;
        *often.bank.counter_mut(1).unwrap() = *once.bank.counter(1).unwrap();
        let mut seen = Vec::new();
        let first = once.due();
        let mut first_seen = None;
        for time in (30..20_000).step_by(3) {
            let events = often.at(time);
            if !events.is_empty() && first_seen.is_none() {
                first_seen = Some(time);
            }
            seen.extend(events);
        }
        let end = often.time;
        let events = once.at(end);
        assert_eq!(events[..events.len().min(200)], seen[..seen.len().min(200)], "round {round}, mode {mode}");
        assert_eq!(once.current(1), often.current(1), "round {round}, mode {mode}");
        assert_eq!(once.status(1), often.status(1), "round {round}, mode {mode}");
        if let (Some(due), Some(seen)) = (first, first_seen) {
            assert!(due <= seen, "round {round}, mode {mode}: due {due}, seen {seen}");
        }
        assert!(first.is_some() || first_seen.is_none(), "round {round}, mode {mode}");
    }
}
