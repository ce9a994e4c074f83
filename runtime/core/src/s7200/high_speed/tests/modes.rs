//! The counting of each mode, tested with single edges.

use plcc_abi::s7200::error;
use plcc_abi::s7200::image::CpuRow;

use super::super::bank::edge_inputs;
use super::super::modes::inputs_of;
use super::{Bench, cpu_226};

/// I0.6, I0.7, I1.0, I1.1: clock, second clock, reset, start of HSC1.
const CLOCK: u8 = 6;
const SECOND: u8 = 7;
const RESET: u8 = 8;
const START: u8 = 9;

/// Enable, load both values, up.
const UP: u8 = 0xF8;
/// The same down.
const DOWN: u8 = 0xF0;

#[test]
fn counters_have_their_modes() {
    let modes = |counter: u32, cpu: &CpuRow| -> Vec<u32> {
        (0..=13).filter(|&mode| inputs_of(counter, mode, cpu).is_some()).collect()
    };
    let all = cpu_226();
    assert_eq!(modes(0, &all), [0, 1, 3, 4, 6, 7, 9, 10, 12]);
    assert_eq!(modes(1, &all), (0..=11).collect::<Vec<u32>>());
    assert_eq!(modes(2, &all), (0..=11).collect::<Vec<u32>>());
    assert_eq!(modes(3, &all), [0, 12]);
    assert_eq!(modes(4, &all), [0, 1, 3, 4, 6, 7, 9, 10]);
    assert_eq!(modes(5, &all), [0]);
    assert!(modes(6, &all).is_empty());
    let cpu_214 = CpuRow { old: true, high_speed_counters: 7, ..CpuRow::default() };
    assert_eq!((modes(0, &cpu_214), modes(3, &cpu_214)), (vec![0], Vec::new()));
}

#[test]
fn inputs_of_modes() {
    let pins = |counter: u32, mode: u32| {
        let (_, inputs) = inputs_of(counter, mode, &cpu_226()).unwrap();
        [inputs.clock, inputs.second, inputs.reset, inputs.start]
    };
    assert_eq!(pins(1, 0), [Some(6), None, None, None]);
    assert_eq!(pins(1, 4), [Some(6), Some(7), Some(8), None]);
    assert_eq!(pins(2, 11), [Some(10), Some(11), Some(12), Some(13)]);
    assert_eq!(pins(0, 1), [Some(0), None, Some(2), None]);
    assert_eq!(pins(4, 10), [Some(3), Some(4), Some(5), None]);
    assert_eq!(pins(0, 12), [None; 4]);
}

#[test]
fn direction_by_the_control_byte() {
    let mut bench = Bench::counter(1, 0, UP, 5, 7);
    assert_eq!(bench.status(1), 0x20, "up, below the preset");
    assert!(bench.pulse(CLOCK).is_empty());
    assert_eq!(bench.pulse(CLOCK), [13]);
    assert_eq!((bench.current(1), bench.status(1)), (7, 0x60));
    assert!(bench.pulse(CLOCK).is_empty());
    assert_eq!(bench.status(1), 0xA0);
    bench.control(1, 0x90, 0, 0);
    assert_eq!(bench.pulse(CLOCK), [13], "down to the preset, and no event of a direction");
    assert_eq!((bench.current(1), bench.status(1)), (7, 0x40));
    // Loads make no event.
    bench.control(1, 0xC0, 100, 0);
    bench.control(1, 0xA0, 0, 100);
    assert!(bench.set(&[]).is_empty());
    assert_eq!(bench.current(1), 100);
    bench.control(1, 0, 0, 0);
    assert!(bench.pulse(CLOCK).is_empty());
    assert_eq!(bench.current(1), 100, "disabled");
    // The direction of bit 3 needs bit 4.
    bench.control(1, 0x88, 0, 0);
    bench.pulse(CLOCK);
    assert_eq!(bench.current(1), 99);
}

#[test]
fn counting_wraps() {
    let mut bench = Bench::counter(1, 0, UP, i32::MAX, i32::MIN);
    assert_eq!(bench.pulse(CLOCK), [13]);
    assert_eq!(bench.current(1), i32::MIN);
}

#[test]
fn reset_clears_and_holds() {
    let mut bench = Bench::counter(1, 1, UP, 5, 0);
    assert_eq!(bench.set(&[(RESET, true)]), [15], "the preset 0 is not reached by counting");
    assert_eq!(bench.current(1), 0);
    assert!(bench.pulse(CLOCK).is_empty());
    assert_eq!(bench.current(1), 0);
    assert!(bench.set(&[(RESET, false)]).is_empty());
    bench.pulse(CLOCK);
    assert_eq!(bench.current(1), 1);
}

#[test]
fn reset_may_be_active_low() {
    let mut bench = Bench::new();
    bench.levels = 1 << RESET;
    bench.events();
    bench.define(1, 1, 1).unwrap();
    bench.control(1, UP, 5, 9);
    bench.pulse(CLOCK);
    assert_eq!(bench.current(1), 6);
    assert_eq!(bench.set(&[(RESET, false)]), [15]);
    assert_eq!(bench.current(1), 0);
}

#[test]
fn start_freezes() {
    let mut bench = Bench::counter(1, 2, UP, 5, 100);
    bench.pulse(CLOCK);
    assert_eq!(bench.current(1), 5, "start is not active");
    assert!(bench.pulse(RESET).is_empty());
    assert_eq!(bench.current(1), 5, "a reset meanwhile is ignored");
    bench.set(&[(START, true)]);
    bench.pulse(CLOCK);
    assert_eq!(bench.current(1), 6);
    bench.set(&[(START, false)]);
    assert!(bench.set(&[(RESET, true)]).is_empty());
    assert_eq!(bench.current(1), 6);
    assert_eq!(bench.set(&[(START, true)]), [15], "reset is still active");
    assert_eq!(bench.current(1), 0);
    // Start active low.
    let mut bench = Bench::counter(1, 2, UP | 2, 5, 100);
    bench.pulse(CLOCK);
    assert_eq!(bench.current(1), 6);
}

#[test]
fn direction_by_an_input() {
    let mut bench = Bench::counter(1, 3, UP, 0, 100);
    assert!(bench.set(&[(SECOND, true)]).is_empty(), "it is up as the control byte says");
    bench.pulse(CLOCK);
    bench.pulse(CLOCK);
    assert_eq!(bench.current(1), 2);
    assert_eq!(bench.set(&[(SECOND, false)]), [14]);
    assert_eq!(bench.status(1), 0);
    bench.pulse(CLOCK);
    assert_eq!(bench.current(1), 1);
    // The first clock shows that an input was low from the start.
    let mut bench = Bench::counter(1, 3, UP, 0, 100);
    assert_eq!(bench.pulse(CLOCK), [14]);
    assert_eq!(bench.current(1), -1);
}

#[test]
fn two_clocks() {
    let mut bench = Bench::counter(1, 6, UP, 0, 2);
    assert!(bench.pulse(CLOCK).is_empty());
    assert_eq!(bench.pulse(CLOCK), [13]);
    assert_eq!(bench.pulse(SECOND), [14]);
    assert_eq!(bench.current(1), 1);
    assert!(bench.pulse(SECOND).is_empty());
    assert_eq!((bench.current(1), bench.status(1)), (0, 0));
    // Both at once count nothing and change no direction.
    assert!(bench.set(&[(CLOCK, true), (SECOND, true)]).is_empty());
    assert_eq!((bench.current(1), bench.status(1)), (0, 0));
    // Simultaneous events are in the order of their numbers.
    bench.set(&[(CLOCK, false), (SECOND, false)]);
    bench.control(1, 0xA0, 0, 1);
    assert_eq!(bench.pulse(CLOCK), [13, 14]);
    // Modes 7 and 8 have the reset and the start, too.
    let mut bench = Bench::counter(1, 8, UP, 3, 9);
    bench.set(&[(START, true)]);
    bench.pulse(CLOCK);
    assert_eq!(bench.current(1), 4);
    assert_eq!(bench.pulse(RESET), [15]);
    assert_eq!(bench.current(1), 0);
}

/// A, then B, go through a period.
const FORWARD: [(u8, bool); 4] = [(CLOCK, true), (SECOND, true), (CLOCK, false), (SECOND, false)];
const BACKWARD: [(u8, bool); 4] = [(SECOND, true), (CLOCK, true), (SECOND, false), (CLOCK, false)];

#[test]
fn quadrature_four_times() {
    let mut bench = Bench::counter(1, 9, UP, 0, 100);
    let mut counts = Vec::new();
    for edge in FORWARD {
        bench.set(&[edge]);
        counts.push(bench.current(1));
    }
    assert_eq!(counts, [1, 2, 3, 4]);
    assert_eq!(bench.set(&[BACKWARD[0]]), [14]);
    assert_eq!(bench.current(1), 3);
    BACKWARD[1..].iter().for_each(|&edge| assert!(bench.set(&[edge]).is_empty()));
    assert_eq!(bench.current(1), 0);
    // Both at once have no direction.
    bench.set(&[(CLOCK, true), (SECOND, true)]);
    assert_eq!(bench.current(1), 0);
}

#[test]
fn quadrature_once() {
    let mut bench = Bench::counter(1, 9, UP | 4, 0, 100);
    let mut counts = Vec::new();
    for edge in FORWARD.into_iter().chain(BACKWARD) {
        bench.set(&[edge]);
        counts.push(bench.current(1));
    }
    // Up with the rising edge of A, down with its falling edge.
    assert_eq!(counts, [1, 1, 1, 1, 1, 1, 1, 0]);
    // Swinging around one edge of A comes back to where it was.
    let mut bench = Bench::counter(1, 9, UP | 4, 0, 100);
    (0..3).for_each(|_| drop(bench.pulse(CLOCK)));
    assert_eq!(bench.current(1), 0);
    // Reset and start as in the other modes.
    let mut bench = Bench::counter(1, 11, DOWN, 7, 100);
    bench.set(&[(CLOCK, true)]);
    assert_eq!(bench.current(1), 7);
    bench.set(&[(START, true)]);
    bench.set(&[(SECOND, true)]);
    assert_eq!(bench.current(1), 8);
}

#[test]
fn pulses_of_an_output() {
    let mut bench = Bench::new();
    bench.pulses = [50, 3];
    bench.define(0, 12, 0).unwrap();
    bench.define(3, 12, 0).unwrap();
    bench.control(0, UP, 0, 10);
    bench.control(3, DOWN, 0, -1);
    assert_eq!(bench.bank.counter(0).unwrap().pulse_wanted(), Some(60));
    bench.pulses = [55, 3];
    assert!(bench.set(&[]).is_empty());
    assert_eq!(bench.current(0), 5);
    bench.pulses = [61, 4];
    assert_eq!(bench.set(&[]), [12, 32]);
    assert_eq!((bench.current(0), bench.current(3)), (11, -1));
}

#[test]
fn definitions_that_cannot_be() {
    let mut bench = Bench::new();
    assert_eq!(bench.define(0, 3, 0), Ok(()));
    assert_eq!(bench.define(0, 0, 0), Err(error::HDEF_REPEATED));
    assert_eq!(bench.define(3, 0, 0), Err(error::HSC_INPUT_TAKEN), "I0.1 is the direction of HSC0");
    assert_eq!(bench.define(5, 1, 0), Err(error::RANGE));
    assert_eq!(bench.define(4, 3, 0), Ok(()));
    assert_eq!(bench.define(5, 0, 0), Err(error::HSC_INPUT_TAKEN), "I0.4 is the direction of HSC4");
    assert_eq!(bench.bank.owned(), 0b1_1011);
    // Event 3, the falling edge of I0.1, is attached.
    let edges = edge_inputs(|event| event == 3);
    assert_eq!(edges, 0b10);
    let mut bench = Bench::new();
    let look = bench.look();
    assert_eq!(bench.bank.define((3, 0), 0, edges, &cpu_226(), &look), Err(error::HSC_INPUT_TAKEN));
    assert_eq!(bench.bank.define((0, 1), 0, edges, &cpu_226(), &look), Ok(()));
}
