//! Segments in closed form.

use super::super::train::{Placed, Segment};

/// Cycles one by one.
fn cycles(segment: &Segment) -> Vec<u64> {
    let cycle = |pulse: i64| i64::from(segment.first) + i64::from(segment.delta) * pulse;
    (0..i64::from(segment.count))
        .map(cycle)
        .take_while(|cycle| (2..=65_535).contains(cycle))
        .map(|c| c as u64)
        .collect()
}

#[test]
fn beginnings_are_sums_of_cycles() {
    for (first, delta, count) in
        [(600, -2, 200), (200, 0, 1000), (200, 1, 400), (4, -1, 5), (65_000, 100, 9), (2, -1, 3)]
    {
        let segment = Segment { first, delta, count };
        let cycles = cycles(&segment);
        assert_eq!(segment.pulses(), cycles.len() as u64);
        assert_eq!(segment.fails(), cycles.len() < count as usize);
        let mut sum = 0;
        for (pulse, cycle) in (0u64..).zip(&cycles) {
            assert_eq!(segment.begin(pulse), sum);
            sum += cycle;
        }
        assert_eq!(segment.begin(segment.pulses()), sum);
    }
}

#[test]
fn levels_and_edges() {
    // Cycles 3 and 2 units of 1000 ns, from 10 on: an odd cycle has the longer part low.
    let placed = Placed { segment: Segment { first: 3, delta: -1, count: 2 }, start: 10, unit: 1000 };
    let edges: Vec<_> = placed.edges(0, u64::MAX).collect();
    assert_eq!(edges, [(10, true), (1010, false), (3010, true), (4010, false)]);
    assert_eq!(placed.edges(10, 3010).collect::<Vec<_>>(), [(1010, false), (3010, true)]);
    assert_eq!(placed.end(), 5010);
    let levels: Vec<bool> = [9, 10, 1009, 1010, 3009, 3010, 4009, 4010, 9999].map(|time| placed.level(time)).into();
    assert_eq!(levels, [false, true, true, false, false, true, true, false, false]);
    let begun = [9, 10, 3009, 3010, 9999].map(|time| placed.begun(time));
    assert_eq!(begun, [0, 1, 1, 2, 2]);
    assert_eq!((placed.begin(1), placed.begin(2)), (Some(3010), None));
}

#[test]
fn four_thousand_million_pulses() {
    let placed = Placed { segment: Segment { first: 65_535, delta: 0, count: u32::MAX }, start: 0, unit: 1000 };
    let cycle = 65_535_000;
    assert_eq!(placed.end(), cycle * 4_294_967_295);
    let time = cycle * 3_000_000_000;
    assert!(placed.level(time) && !placed.level(time - 1));
    assert_eq!((placed.begun(time - 1), placed.begun(time)), (3_000_000_000, 3_000_000_001));
    assert_eq!(placed.edges(time - 1, time + cycle / 2).count(), 2);
    // In milliseconds it ends after all clocks.
    let placed = Placed { unit: 1_000_000, ..placed };
    assert_eq!(placed.end(), u64::MAX);
}
