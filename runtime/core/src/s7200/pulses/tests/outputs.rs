//! One output: trains, waiting trains, profiles, PWM, errors.

use plcc_abi::s7200::error;

use super::super::output::{ABORTED, DELTA_ERROR, Edge, IDLE, OVERFLOW, Output, Registers};
use super::super::train::Segment;

const US: u64 = 1000;
const MS: u64 = 1_000_000;

/// PLS; the image register is 0.
fn pls(output: &mut Output, now: u64, control: u8, values: (u16, u16, u32)) -> Result<(), u16> {
    profile(output, now, control, values, &[])
}

fn profile(
    output: &mut Output,
    now: u64,
    control: u8,
    (cycle, width, count): (u16, u16, u32),
    segments: &[Segment],
) -> Result<(), u16> {
    output.control(now, false, &Registers { control, cycle, width, count }, || Ok(segments.to_vec()))
}

fn segment(first: u16, delta: i16, count: u32) -> Segment {
    Segment { first, delta, count }
}

#[test]
fn single_train() {
    let mut output = Output::default();
    assert_eq!((output.status(0), output.level(0), output.due()), (IDLE, None, None));
    // 10 pulses of 250 ms.
    pls(&mut output, MS, 0x8D, (250, 0, 10)).unwrap();
    assert_eq!((output.status(IDLE), output.due()), (0, Some(2501 * MS)));
    assert_eq!(
        (output.level(MS), output.level(126 * MS - 1), output.level(126 * MS)),
        (Some(true), Some(true), Some(false))
    );
    assert_eq!([MS, 250 * MS, 251 * MS, 2500 * MS].map(|time| output.count(time)), [1, 1, 2, 10]);
    assert_eq!(output.advance(2501 * MS - 1, false), 0);
    assert_eq!(output.advance(2501 * MS, false), 1);
    assert_eq!((output.status(0), output.level(2501 * MS), output.count(9999 * MS)), (IDLE, None, 10));
    // Only the count is loaded: the cycle stays.
    pls(&mut output, 3000 * MS, 0x8C, (9, 9, 5)).unwrap();
    assert_eq!(output.due(), Some(4250 * MS));
    assert_eq!(output.advance(5000 * MS, false), 1);
    assert_eq!(output.count(5000 * MS), 15);
}

#[test]
fn values_that_are_too_small() {
    let mut output = Output::default();
    pls(&mut output, 0, 0x85, (1, 0, 0)).unwrap();
    assert_eq!(output.due(), Some(2 * US), "one pulse of two units");
}

#[test]
fn one_train_waits() {
    let mut output = Output::default();
    pls(&mut output, 0, 0x85, (100, 0, 10)).unwrap();
    pls(&mut output, 100 * US, 0x85, (50, 0, 4)).unwrap();
    assert_eq!(output.status(0), 0);
    pls(&mut output, 200 * US, 0x85, (70, 0, 7)).unwrap();
    assert_eq!(output.status(0), OVERFLOW);
    assert_eq!(pls(&mut output, 200 * US, 0x8D, (70, 0, 7)), Err(error::PTO_MODE), "another time base");
    assert_eq!(output.time_of_pulse(10), Some(900 * US));
    assert_eq!(output.time_of_pulse(12), Some(1000 * US), "the end of the first train tells more");
    // It follows without a gap.
    assert_eq!(output.advance(1040 * US, false), 1);
    assert_eq!(
        (output.count(1040 * US), output.level(1024 * US), output.level(1025 * US)),
        (11, Some(true), Some(false))
    );
    assert_eq!(output.time_of_pulse(12), Some(1050 * US));
    assert_eq!(output.due(), Some(1200 * US));
    assert_eq!(output.advance(5000 * US, false), 1);
    assert_eq!((output.count(5000 * US), output.status(0)), (14, IDLE));
}

#[test]
fn switched_off() {
    let mut output = Output::default();
    pls(&mut output, 0, 0x85, (100, 0, 10)).unwrap();
    output.advance(250 * US, false);
    pls(&mut output, 250 * US, 0, (0, 0, 0)).unwrap();
    assert_eq!((output.status(0), output.level(250 * US), output.due()), (IDLE | ABORTED, None, None));
    assert_eq!(output.count(MS), 3);
    // The bit is the program's to clear.
    assert_eq!((output.status(IDLE | ABORTED), output.status(IDLE)), (IDLE | ABORTED, IDLE));
    // Nothing runs: nothing is aborted.
    pls(&mut output, 300 * US, 0, (0, 0, 0)).unwrap();
    assert_eq!(output.status(0), IDLE);
}

#[test]
fn profile_of_three_segments() {
    let mut output = Output::default();
    let segments = [segment(600, -2, 200), segment(200, 0, 1000), segment(200, 1, 400)];
    profile(&mut output, 0, 0xA0, (0, 0, 0), &segments).unwrap();
    // 600 + 598 + ... + 202 = 200 * 401; 200 * 1000; 200 + ... + 599 = 400 * 399.5
    let ends = [80_200 * US, 280_200 * US, 440_000 * US];
    for (end, number) in ends.into_iter().zip(1..) {
        assert_eq!((output.due(), output.segment()), (Some(end), number));
        assert_eq!(output.advance(end - 1, false), 0);
        assert_eq!(output.segment(), number);
        assert_eq!(output.advance(end, false), u32::from(number == 3));
    }
    assert_eq!((output.segment(), output.count(ends[2]), output.status(0)), (0, 1600, IDLE));
    // In one look.
    profile(&mut output, 500 * MS, 0xA0, (0, 0, 0), &segments).unwrap();
    assert_eq!(output.advance(9000 * MS, false), 1);
    assert_eq!(output.count(9000 * MS), 3200);
}

#[test]
fn cycle_time_leaves_its_range() {
    let mut output = Output::default();
    // Cycles 4, 3, 2, and the next would be 1.
    profile(&mut output, 0, 0xA8, (0, 0, 0), &[segment(4, -1, 5), segment(9, 0, 9)]).unwrap();
    assert_eq!(output.due(), Some(9 * MS));
    assert_eq!(output.advance(9 * MS, false), 0, "no event");
    assert_eq!((output.status(0), output.level(9 * MS), output.count(MS * 99)), (IDLE | DELTA_ERROR, None, 3));
}

#[test]
fn commands_that_do_not_fit() {
    let mut output = Output::default();
    pls(&mut output, 0, 0x85, (100, 0, 10)).unwrap();
    assert_eq!(pls(&mut output, 1, 0xD3, (100, 50, 0)), Err(error::PULSE_OUTPUT_ACTIVE));
    assert_eq!(profile(&mut output, 1, 0xA0, (0, 0, 0), &[segment(5, 0, 5)]), Err(error::PTO_MODE));
    let mut output = Output::default();
    pls(&mut output, 0, 0xD3, (100, 50, 0)).unwrap();
    assert_eq!(pls(&mut output, 1, 0x85, (100, 0, 10)), Err(error::PULSE_OUTPUT_ACTIVE));
    assert_eq!(profile(&mut output, 1, 0xA0, (0, 0, 0), &[segment(5, 0, 5)]), Err(error::PULSE_OUTPUT_ACTIVE));
    let mut output = Output::default();
    profile(&mut output, 0, 0xA0, (0, 0, 0), &[segment(500, 0, 5)]).unwrap();
    assert_eq!(pls(&mut output, 1, 0x85, (100, 0, 10)), Err(error::PTO_MODE));
    assert_eq!(profile(&mut output, 1, 0xA0, (0, 0, 0), &[segment(5, 0, 5)]), Err(error::PTO_MODE));
}

#[test]
fn width() {
    let mut output = Output::default();
    // 250 ms of 1000 ms.
    pls(&mut output, 0, 0xDB, (1000, 250, 0)).unwrap();
    let levels = |output: &Output| [0, 249, 250, 999, 1000, 1249, 1250].map(|ms| output.level(ms * MS).unwrap());
    assert_eq!(levels(&output), [true, true, false, false, true, true, false]);
    assert_eq!((output.status(0), output.due(), output.count(2500 * MS)), (IDLE, None, 3));
    // At the end of the cycle.
    output.advance(1100 * MS, false);
    pls(&mut output, 1100 * MS, 0xDA, (0, 500, 0)).unwrap();
    assert_eq!((output.due(), output.level(1300 * MS)), (Some(2000 * MS), Some(false)));
    output.advance(2000 * MS, false);
    assert_eq!((output.level(2499 * MS), output.level(2500 * MS)), (Some(true), Some(false)));
    assert_eq!(output.count(2999 * MS), 3);
    // At once: a new cycle begins.
    output.advance(2700 * MS, false);
    pls(&mut output, 2700 * MS, 0xC9, (800, 0, 0)).unwrap();
    assert_eq!(
        (output.level(2700 * MS), output.level(3200 * MS), output.level(3500 * MS)),
        (Some(true), Some(false), Some(true))
    );
    assert_eq!(output.count(2700 * MS), 4);
    // Off, on.
    for (width, level) in [(0, false), (800, true), (801, true)] {
        pls(&mut output, 2700 * MS, 0xCA, (0, width, 0)).unwrap();
        assert_eq!([2700, 3100, 3499, 3500].map(|ms| output.level(ms * MS)), [Some(level); 4]);
    }
    pls(&mut output, 2800 * MS, 0, (0, 0, 0)).unwrap();
    assert_eq!((output.level(2800 * MS), output.status(0)), (None, IDLE));
}

#[test]
fn edges_for_a_trace() {
    let edge = |time: u64, level: bool| Edge { time: time * US, level };
    let mut output = Output::default();
    output.record_edges(0);
    pls(&mut output, 0, 0x85, (100, 0, 2)).unwrap();
    pls(&mut output, 0, 0x85, (60, 0, 1)).unwrap();
    output.advance(120 * US, false);
    assert_eq!(output.take_edges(100 * US).0, [edge(0, true), edge(50, false), edge(100, true)]);
    assert_eq!(output.noted_edge(), None);
    output.advance(500 * US, false);
    let (edges, cut) = output.take_edges(500 * US);
    assert_eq!(edges, [edge(150, false), edge(200, true), edge(230, false)]);
    assert!(!cut);
    // Synchronous update of the width, then off with the image register on.
    pls(&mut output, 500 * US, 0xD3, (100, 20, 0)).unwrap();
    output.advance(530 * US, false);
    pls(&mut output, 530 * US, 0xD2, (0, 70, 0)).unwrap();
    output.advance(690 * US, true);
    output.switch_off(690 * US, true);
    let wanted = [edge(500, true), edge(520, false), edge(600, true), edge(670, false), edge(690, true)];
    assert_eq!(output.take_edges(MS).0, wanted);
    // Too many.
    let mut output = Output::default();
    output.record_edges(0);
    pls(&mut output, 0, 0x85, (2, 0, u32::MAX)).unwrap();
    output.advance(100 * 1000 * MS, false);
    let (edges, cut) = output.take_edges(u64::MAX);
    assert_eq!((edges.len(), cut), (10_000, true));
    output.advance(100 * 1000 * MS + 3 * US, false);
    assert_eq!(
        output.take_edges(u64::MAX),
        (
            vec![
                Edge { time: 100 * 1000 * MS + 2 * US, level: true },
                Edge { time: 100 * 1000 * MS + 3 * US, level: false }
            ],
            false
        )
    );
}
