//! The traces of the reference, H.1 and H.2, compared with the model.

use super::chart::{Action, Area, Bit, Chart, Condition, Order, Row, Step, Time, Transition};
use super::memory::{Inputs, Memory};
use super::model::Model;

fn bit(area: Area, byte: u8, bit: u8) -> Bit {
    Bit { area, byte, bit }
}

fn i(byte: u8, number: u8) -> Condition {
    Condition::Bit(bit(Area::I, byte, number))
}

fn not(condition: Condition) -> Condition {
    Condition::Not(Box::new(condition))
}

fn row(action: Action) -> Row {
    Row { event: None, interlock: false, action }
}

fn n(byte: u8, number: u8) -> Row {
    row(Action::N(bit(Area::Q, byte, number)))
}

fn step(number: i16, interlock: Option<Condition>, rows: Vec<Row>) -> Step {
    Step { name: format!("Step_{number}"), number, initial: number == 1, interlock, supervision: None, rows }
}

/// By numbers of steps.
fn transition(number: i16, from: &[usize], to: &[usize], condition: Condition) -> Transition {
    let index = |list: &[usize]| list.iter().map(|number| number - 1).collect();
    Transition { name: format!("Trans_{number}"), number, from: index(from), to: index(to), condition: Some(condition) }
}

fn star_delta() -> Chart {
    let star_time = || row(Action::D(bit(Area::M, 0, 0), Time::Constant(5000)));
    let delta = || Row { event: None, interlock: true, action: Action::D(bit(Area::Q, 0, 3), Time::Constant(100)) };
    let star_open = || Some(not(Condition::Bit(bit(Area::Q, 0, 4))));
    let stop = || Condition::Or(vec![not(i(0, 0)), not(i(0, 5))]);
    let elapsed = || Condition::Bit(bit(Area::M, 0, 0));
    let start = |pressed: u8, other: u8, contactor: u8| {
        let contactor = Condition::Bit(bit(Area::Q, 0, contactor));
        Condition::And(vec![i(0, pressed), not(i(0, other)), i(0, 0), i(0, 5), not(contactor)])
    };
    Chart {
        steps: vec![
            step(1, None, Vec::new()),
            step(2, None, vec![n(0, 1), n(0, 4), n(0, 5), star_time()]),
            step(3, star_open(), vec![n(0, 1), n(0, 5), delta()]),
            step(4, None, vec![n(0, 2), n(0, 4), n(0, 6), star_time()]),
            step(5, star_open(), vec![n(0, 2), n(0, 6), delta()]),
        ],
        transitions: vec![
            transition(8, &[5], &[1], stop()),
            transition(7, &[4], &[5], elapsed()),
            transition(6, &[4], &[1], stop()),
            transition(5, &[1], &[4], start(2, 1, 1)),
            transition(4, &[3], &[1], stop()),
            transition(3, &[2], &[3], elapsed()),
            transition(2, &[2], &[1], stop()),
            transition(1, &[1], &[2], start(1, 2, 2)),
        ],
        ..Chart::default()
    }
}

/// A line of a trace: time, inputs that change as (byte, bit, value), transitions that switch, active steps with the time of
/// the first, output byte, M 0.0.
type Line<'a> = (i64, &'a [(u8, u8, bool)], &'a [i16], &'a [i16], Option<i64>, u8, bool);

/// Plays a trace with a call each `scan` milliseconds, where calls not listed repeat the state before.
fn play(chart: &Chart, scan: i64, output: usize, start: &[(u8, u8)], lines: &[Line]) {
    let mut model = Model::new(chart);
    let mut memory = Memory::new();
    for &(byte, number) in start {
        memory.set(bit(Area::I, byte, number), true);
    }
    let end = lines.last().expect("a trace has lines").0;
    let mut expected = lines[0];
    for now in (0..=end).step_by(scan as usize) {
        let line = lines.iter().find(|line| line.0 == now);
        expected = line.copied().unwrap_or(expected);
        for &(byte, number, value) in line.map_or(&[][..], |line| line.1) {
            memory.set(bit(Area::I, byte, number), value);
        }
        model.call(&Inputs::new(), &mut memory, now);
        let fired: Vec<i16> = (0..chart.transitions.len())
            .filter(|&t| model.transitions[t].ts)
            .map(|t| chart.transitions[t].number)
            .collect();
        let active: Vec<i16> =
            (0..chart.steps.len()).filter(|&s| model.steps[s].x).map(|s| chart.steps[s].number).collect();
        assert_eq!(fired, line.map_or(&[][..], |line| line.2), "transitions that switch at {now} ms");
        assert_eq!(active, expected.3, "active steps at {now} ms");
        if let Some((_, _, _, _, Some(time), _, _)) = line {
            assert_eq!(model.steps[model.order[0]].t, *time, "T at {now} ms");
        }
        assert_eq!(memory.outputs[output], expected.5, "outputs at {now} ms: {:07b}", memory.outputs[output]);
        assert_eq!(memory.bit(bit(Area::M, 0, 0)), expected.6, "M 0.0 at {now} ms");
    }
}

/// K1 to K4, H1 and H2 as QB 0.
const STAR_CW: u8 = 0b011_0010;
const LINE_CW: u8 = 0b010_0010;
const DELTA_CW: u8 = 0b010_1010;
const STAR_CCW: u8 = 0b101_0100;

#[test]
fn star_delta_starter() {
    let lines: &[Line] = &[
        (0, &[], &[], &[1], Some(0), 0, false),
        (100, &[(0, 1, true)], &[1], &[2], Some(0), STAR_CW, false),
        (200, &[(0, 1, false)], &[], &[2], Some(100), STAR_CW, false),
        (1000, &[(0, 2, true)], &[], &[2], Some(900), STAR_CW, false),
        (1100, &[(0, 2, false)], &[], &[2], Some(1000), STAR_CW, false),
        (5100, &[], &[], &[2], Some(5000), STAR_CW, true),
        (5150, &[], &[3], &[3], Some(0), LINE_CW, false),
        (5250, &[], &[], &[3], Some(100), DELTA_CW, false),
        (7000, &[(0, 0, false)], &[4], &[1], Some(0), 0, false),
        (7050, &[(0, 2, true)], &[], &[1], Some(50), 0, false),
        (7200, &[(0, 0, true)], &[5], &[4], Some(0), STAR_CCW, false),
        (7300, &[(0, 2, false)], &[], &[4], Some(100), STAR_CCW, false),
        (9000, &[(0, 5, false)], &[6], &[1], Some(0), 0, false),
        (9100, &[(0, 5, true)], &[], &[1], Some(100), 0, false),
        (9500, &[(0, 1, true), (0, 2, true)], &[], &[1], Some(500), 0, false),
        (9600, &[(0, 2, false)], &[1], &[2], Some(0), STAR_CW, false),
        (9700, &[(0, 1, false)], &[], &[2], Some(100), STAR_CW, false),
        (14600, &[], &[], &[2], Some(5000), STAR_CW, true),
        (14650, &[], &[3], &[3], Some(0), LINE_CW, false),
        (14750, &[], &[], &[3], Some(100), DELTA_CW, false),
    ];
    play(&star_delta(), 50, 0, &[(0, 0), (0, 5)], lines);
}

#[test]
fn stop_outranks_delta() {
    let lines: &[Line] = &[
        (0, &[], &[], &[1], Some(0), 0, false),
        (100, &[(0, 1, true)], &[1], &[2], Some(0), STAR_CW, false),
        (200, &[(0, 1, false)], &[], &[2], Some(100), STAR_CW, false),
        (5100, &[], &[], &[2], Some(5000), STAR_CW, true),
        (5150, &[(0, 0, false)], &[2], &[1], Some(0), 0, false),
        (5300, &[], &[], &[1], Some(150), 0, false),
    ];
    play(&star_delta(), 50, 0, &[(0, 0), (0, 5)], lines);
}

#[test]
fn two_doses() {
    let mixed = Condition::Time { step: 5, undisturbed: false, order: Order::AtLeast, ms: 2000 };
    let chart = Chart {
        steps: vec![
            step(1, None, Vec::new()),
            step(2, None, vec![n(1, 0)]),
            step(3, None, vec![n(1, 1)]),
            step(4, None, Vec::new()),
            step(5, None, Vec::new()),
            step(6, None, vec![n(1, 2)]),
        ],
        transitions: vec![
            transition(5, &[6], &[1], mixed),
            transition(4, &[4, 5], &[6], Condition::Constant(true)),
            transition(3, &[3], &[5], i(1, 2)),
            transition(2, &[2], &[4], i(1, 1)),
            transition(1, &[1], &[2, 3], i(1, 0)),
        ],
        ..Chart::default()
    };
    let lines: &[Line] = &[
        (0, &[], &[], &[1], Some(0), 0, false),
        (100, &[(1, 0, true)], &[1], &[2, 3], Some(0), 0b011, false),
        (200, &[(1, 0, false)], &[], &[2, 3], Some(100), 0b011, false),
        (1000, &[(1, 1, true)], &[2], &[3, 4], None, 0b010, false),
        (1500, &[(1, 2, true)], &[3], &[4, 5], None, 0, false),
        (1600, &[(1, 1, false), (1, 2, false)], &[4], &[6], Some(0), 0b100, false),
        (3600, &[], &[5], &[1], Some(0), 0, false),
    ];
    play(&chart, 100, 1, &[], lines);
}
