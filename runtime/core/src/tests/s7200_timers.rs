//! Timers of an S7-200: three kinds, three resolutions.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::layout;
use plcc_abi::s7200::{Operation, TimerKind, system};

use super::helpers::{Block, operate, run, s7200};
use crate::cpu::Cpu;

const TON: u32 = TimerKind::Ton as u32;
const TONR: u32 = TimerKind::Tonr as u32;
const TOF: u32 = TimerKind::Tof as u32;
const VALUES: u32 = layout::SYSTEM + system::TIMER_VALUES;
const BITS: u32 = layout::SYSTEM + system::TIMER_BITS;
const INPUTS: u32 = layout::SYSTEM + system::TIMER_INPUTS;

/// As code reads a timer bit.
fn bit(cpu: &Cpu, number: u32) -> bool {
    cpu.s7200_timer_sync(number);
    cpu.memory.byte(BITS + number) != 0
}

fn value(cpu: &Cpu, number: u32) -> i16 {
    cpu.s7200_timer_sync(number);
    cpu.memory.word(VALUES + 2 * number) as i16
}

fn reset(cpu: &Cpu, number: u32) {
    cpu.memory.set_word(VALUES + 2 * number, 0);
    cpu.memory.set_byte(BITS + number, 0);
    cpu.memory.set_byte(INPUTS + number, 0);
}

fn ms(cpu: &Cpu) -> u64 {
    cpu.clock.now() / 1_000_000
}

/// Runs `main` for this many scans of 10 ms and returns the scans in which it was true.
fn scans(count: u64, main: impl Fn(&Cpu) -> bool + 'static) -> Vec<u64> {
    let found = Rc::new(RefCell::new(Vec::new()));
    let seen = found.clone();
    let block: Block = Box::new(move |cpu, _| {
        if main(cpu) {
            seen.borrow_mut().push(ms(cpu) / 10 + 1);
        }
    });
    run(&s7200(block, Vec::new()), count);
    found.take()
}

/// The timer is reset by its own contact; its bit is used after the box.
fn by_own_contact(number: u32, preset: i16) -> Vec<u64> {
    scans(100, move |cpu| {
        let on = !bit(cpu, number);
        cpu.s7200_timer(number, TON, preset, on);
        bit(cpu, number)
    })
}

/// The timer is reset by the output that it drives.
fn by_output(number: u32, preset: i16) -> Vec<u64> {
    scans(100, move |cpu| {
        cpu.s7200_timer(number, TON, preset, !cpu.memory.bit(layout::Q, 2));
        let on = bit(cpu, number);
        cpu.memory.set_bit(layout::Q, 2, on);
        on
    })
}

#[test]
fn pulse_every_300_ms_by_the_contact_of_the_timer() {
    // 1 ms: the update falls between two scans, so network 1 resets the timer; 10 ms: as well.
    assert_eq!(by_own_contact(32, 300), [0; 0]);
    assert_eq!(by_own_contact(33, 30), [0; 0]);
    // 100 ms: the bit comes with the box.
    assert_eq!(by_own_contact(37, 3), [31, 61, 91]);
}

#[test]
fn pulse_every_300_ms_by_the_output() {
    // One scan with the output, one until the timer is on again.
    assert_eq!(by_output(32, 300), [31, 63, 95]);
    assert_eq!(by_output(33, 30), [31, 63, 95]);
    assert_eq!(by_output(37, 3), [31, 61, 91]);
}

/// I0.0 is on for 0.6 s, off for 0.4 s, on for 0.6 s. Result: milliseconds with T37, T5, T38.
fn trace() -> [Vec<u64>; 3] {
    let found = Rc::new(RefCell::new([const { Vec::new() }; 3]));
    let seen = found.clone();
    let block: Block = Box::new(move |cpu, _| {
        let now = ms(cpu);
        let on = (10..610).contains(&now) || (1010..1610).contains(&now);
        cpu.s7200_timer(37, TON, 10, on);
        cpu.s7200_timer(5, TONR, 10, on);
        cpu.s7200_timer(38, TOF, 5, on);
        for (list, number) in seen.borrow_mut().iter_mut().zip([37, 5, 38]) {
            if bit(cpu, number) {
                list.push(now);
            }
        }
        match now {
            600 => assert_eq!((value(cpu, 37), value(cpu, 5), value(cpu, 38)), (6, 6, 0)),
            1000 => assert_eq!((value(cpu, 37), value(cpu, 5), value(cpu, 38)), (0, 6, 4)),
            2000 => assert_eq!((value(cpu, 37), value(cpu, 5), value(cpu, 38)), (0, 12, 4)),
            2200 => assert_eq!((value(cpu, 37), value(cpu, 5), value(cpu, 38)), (0, 12, 5)),
            2300 => {
                reset(cpu, 5);
                assert!(!bit(cpu, 5));
            }
            _ => {}
        }
    });
    run(&s7200(block, Vec::new()), 250);
    found.take()
}

#[test]
fn ton_tonr_tof() {
    let [t37, t5, t38] = trace();
    assert!(t37.is_empty());
    assert_eq!((t5.first(), t5.last(), t5.len()), (Some(&1400), Some(&2300), 91));
    assert_eq!((t38.first(), t38.last(), t38.len()), (Some(&10), Some(&2090), 209));
}

#[test]
fn ten_milliseconds_count_when_the_scan_begins() {
    // TOF with 3 ticks: off in scan 3, so its bit is 0 from the start of scan 6 on, and it is at 3.
    let on = scans(8, |cpu| {
        let before = bit(cpu, 33);
        cpu.s7200_timer(33, TOF, 3, ms(cpu) < 20);
        if ms(cpu) >= 50 {
            assert_eq!(value(cpu, 33), 3);
        }
        assert!(ms(cpu) == 0 || before == bit(cpu, 33));
        bit(cpu, 33)
    });
    assert_eq!(on, [1, 2, 3, 4, 5]);
}

#[test]
fn ten_milliseconds_count_without_the_box() {
    // The box is executed in the first scan only.
    let on = scans(8, |cpu| {
        if ms(cpu) == 0 {
            cpu.s7200_timer(97, TON, 4, true);
        }
        bit(cpu, 97)
    });
    assert_eq!(on, [5, 6, 7, 8]);
}

#[test]
fn a_hundred_milliseconds_need_the_box() {
    // Executed in scans that begin at 0, 100, 300, 400 ms: the tick at 200 ms is lost; twice in the last one counts twice.
    run(
        &s7200(
            Box::new(|cpu, _| {
                if [0, 100, 300, 400].contains(&ms(cpu)) {
                    cpu.s7200_timer(101, TON, 9, true);
                }
                if ms(cpu) == 400 {
                    assert_eq!(value(cpu, 101), 3);
                    cpu.s7200_timer(101, TON, 9, true);
                    assert_eq!(value(cpu, 101), 4);
                }
            }),
            Vec::new(),
        ),
        42,
    );
}

#[test]
fn a_preset_of_0_is_reached_at_once() {
    for number in [32, 33, 37] {
        assert_eq!(
            scans(2, move |cpu| {
                cpu.s7200_timer(number, TON, 0, true);
                bit(cpu, number)
            }),
            [1, 2],
            "T{number}"
        );
        assert_eq!(
            scans(3, move |cpu| {
                cpu.s7200_timer(number, TOF, 0, ms(cpu) == 0);
                bit(cpu, number)
            }),
            [1],
            "T{number}"
        );
    }
}

#[test]
fn values_end_at_32767() {
    for (number, scans_later) in [(0, 1), (1, 1), (5, 10)] {
        scans(15, move |cpu| {
            cpu.s7200_timer(number, TONR, i16::MAX, true);
            if ms(cpu) == 0 {
                cpu.memory.set_word(VALUES + 2 * number, 32_766);
            } else if ms(cpu) >= 10 * scans_later {
                assert_eq!(value(cpu, number), i16::MAX);
                assert!(bit(cpu, number));
            }
            false
        });
    }
}

#[test]
fn a_reset_timer_starts_again_with_its_box() {
    scans(8, |cpu| {
        cpu.s7200_timer(34, TON, 100, true);
        cpu.s7200_timer(36, TOF, 3, ms(cpu) == 0);
        match ms(cpu) {
            20 => {
                assert_eq!((value(cpu, 34), bit(cpu, 36)), (2, true));
                reset(cpu, 34);
                reset(cpu, 36);
            }
            // Enabled by the box of this scan.
            30 => assert_eq!(value(cpu, 34), 0),
            // TOF needs its input on again.
            50 => assert_eq!((value(cpu, 34), value(cpu, 36), bit(cpu, 36)), (2, 0, false)),
            _ => {}
        }
        false
    });
}

#[test]
fn one_millisecond_counts_between_two_statements() {
    run(
        &s7200(
            Box::new(|cpu, _| {
                cpu.s7200_timer(96, TON, 5, true);
                cpu.s7200_timer(64, TONR, 5, true);
                assert!(!bit(cpu, 96));
                cpu.pass_time(4_000_000, false);
                assert_eq!((bit(cpu, 96), value(cpu, 96)), (false, 4));
                cpu.pass_time(3_000_000, false);
                assert_eq!((bit(cpu, 96), value(cpu, 96)), (true, 7));
                cpu.s7200_timer(96, TON, 5, false);
                cpu.s7200_timer(64, TONR, 5, false);
                cpu.pass_time(1_000_000, false);
                assert_eq!((bit(cpu, 96), value(cpu, 96)), (false, 0));
                assert_eq!((bit(cpu, 64), value(cpu, 64)), (true, 7));
            }),
            Vec::new(),
        ),
        1,
    );
}

#[test]
fn events_of_t32_and_t96_come_to_the_millisecond() {
    let seen = Rc::new(RefCell::new(Vec::new()));
    let log = |text: &'static str| -> Block {
        let seen = seen.clone();
        Box::new(move |cpu, _| seen.borrow_mut().push(format!("{text}@{}", ms(cpu))))
    };
    let main: Block = Box::new(|cpu, _| {
        if ms(cpu) == 0 {
            operate(cpu, Operation::AttachInterrupt, [0, 21, 0, 0]);
            operate(cpu, Operation::AttachInterrupt, [1, 22, 0, 0]);
            operate(cpu, Operation::EnableInterrupts, [0; 4]);
        }
        cpu.s7200_timer(32, TON, 13, true);
        cpu.s7200_timer(96, TOF, 25, ms(cpu) == 0);
    });
    // T96 begins to count in the second scan.
    run(&s7200(main, vec![(0, log("T32")), (1, log("T96"))]), 10);
    assert_eq!(*seen.borrow(), ["T32@13", "T96@35"]);
}
