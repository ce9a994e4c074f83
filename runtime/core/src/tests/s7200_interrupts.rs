//! Interrupt routines of an S7-200: order, queues, timed interrupts, what is saved, STOP.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::layout;
use plcc_abi::s7200::{Operation, error, result, system};

use super::helpers::{Block, operate, run, run_observed, s7200, s7200_with};
use crate::cpu::Cpu;
use crate::cycle::Observer;
use crate::diagnostics::NO_SITE;

type Log = Rc<RefCell<Vec<String>>>;

fn log(entries: &Log, text: &'static str) -> Block {
    let entries = entries.clone();
    Box::new(move |cpu, _| entries.borrow_mut().push(format!("{text}@{}", cpu.clock.now() / 1_000_000)))
}

fn special(cpu: &Cpu, byte: u32) -> u8 {
    cpu.memory.byte(layout::SYSTEM + byte)
}

fn set_special(cpu: &Cpu, byte: u32, value: u8) {
    cpu.memory.set_byte(layout::SYSTEM + byte, value);
}

fn attach(cpu: &Cpu, routine: u32, event: u32) -> u64 {
    operate(cpu, Operation::AttachInterrupt, [routine, event, 0, 0])
}

fn enable(cpu: &Cpu) -> u64 {
    operate(cpu, Operation::EnableInterrupts, [0; 4])
}

fn is_first(cpu: &Cpu) -> bool {
    special(cpu, 0) & 2 != 0
}

#[test]
fn groups_go_before_arrival_and_priority() {
    let entries = Log::default();
    let routines = [(0, "character"), (1, "pulses"), (2, "edge"), (3, "timed")];
    let routines = routines.map(|(number, text)| (number, log(&entries, text))).into_iter().collect();
    let main: Block = Box::new(|cpu, _| {
        for (routine, event) in [(0, 8), (1, 19), (2, 0), (3, 11)] {
            assert_eq!(attach(cpu, routine, event), result::ENO);
        }
        // Disabled: they wait. All of them are simultaneous.
        for event in [11, 0, 19, 8] {
            cpu.s7200_event(event, None);
        }
        cpu.safepoint(NO_SITE);
        enable(cpu);
        assert_eq!(special(cpu, 4) & 0x10, 0x10);
        assert_ne!(cpu.memory.attention().load(std::sync::atomic::Ordering::Relaxed), 0);
        cpu.safepoint(NO_SITE);
        operate(cpu, Operation::DisableInterrupts, [0; 4]);
        assert_eq!(special(cpu, 4) & 0x10, 0);
    });
    run(&s7200(main, routines), 1);
    assert_eq!(*entries.borrow(), ["character@0", "pulses@0", "edge@0", "timed@0"]);
}

#[test]
fn arrival_goes_before_priority_in_a_group() {
    let entries = Log::default();
    let main: Block = Box::new(|cpu, _| {
        attach(cpu, 0, 0);
        attach(cpu, 1, 19);
        cpu.s7200_event(0, None);
        cpu.pass_time(1_000_000, false);
        cpu.s7200_poll();
        cpu.s7200_event(19, None);
        enable(cpu);
        cpu.safepoint(NO_SITE);
    });
    run(&s7200(main, vec![(0, log(&entries, "edge")), (1, log(&entries, "pulses"))]), 1);
    assert_eq!(*entries.borrow(), ["edge@1", "pulses@1"]);
}

#[test]
fn a_routine_runs_to_its_end() {
    let entries = Log::default();
    let outer = entries.clone();
    let timed: Block = Box::new(move |cpu, _| {
        outer.borrow_mut().push("timed".to_string());
        cpu.s7200_event(8, None);
        cpu.safepoint(NO_SITE);
        assert!(cpu.s7200_in_interrupt());
        outer.borrow_mut().push("/timed".to_string());
    });
    let main: Block = Box::new(|cpu, _| {
        attach(cpu, 0, 8);
        attach(cpu, 1, 10);
        enable(cpu);
        cpu.s7200_event(10, None);
        cpu.safepoint(NO_SITE);
        assert!(!cpu.s7200_in_interrupt());
    });
    run(&s7200(main, vec![(0, log(&entries, "character")), (1, timed)]), 1);
    assert_eq!(*entries.borrow(), ["timed", "/timed", "character@0"]);
}

#[test]
fn a_full_queue_loses_events_and_tells_the_routine() {
    let count = Rc::new(RefCell::new(Vec::new()));
    let seen = count.clone();
    let routine: Block = Box::new(move |cpu, _| seen.borrow_mut().push(special(cpu, 4) & 7));
    let main: Block = Box::new(|cpu, _| {
        attach(cpu, 0, 10);
        (0..8).for_each(|_| cpu.s7200_event(10, None));
        assert_eq!(special(cpu, 4) & 7, 0);
        (0..2).for_each(|_| cpu.s7200_event(10, None));
        assert_eq!(special(cpu, 4) & 7, 4);
        enable(cpu);
        cpu.safepoint(NO_SITE);
        assert_eq!(special(cpu, 4) & 7, 0);
    });
    run(&s7200(main, vec![(0, routine)]), 1);
    assert_eq!(*count.borrow(), [4; 8]);
}

#[test]
fn events_are_dropped_by_dtch_and_cevnt() {
    let entries = Log::default();
    let main: Block = Box::new(|cpu, _| {
        attach(cpu, 0, 0);
        attach(cpu, 1, 1);
        attach(cpu, 2, 2);
        (0..3).for_each(|event| cpu.s7200_event(event, None));
        assert_eq!(operate(cpu, Operation::DetachInterrupt, [0; 4]), result::ENO);
        assert_eq!(operate(cpu, Operation::ClearEvents, [1, 0, 0, 0]), result::ENO);
        enable(cpu);
        cpu.safepoint(NO_SITE);
        // Detached: nothing waits any more. Cleared: still attached.
        cpu.s7200_event(0, None);
        cpu.s7200_event(1, None);
        cpu.safepoint(NO_SITE);
    });
    let routines = vec![(0, log(&entries, "0")), (1, log(&entries, "1")), (2, log(&entries, "2"))];
    run(&s7200(main, routines), 1);
    assert_eq!(*entries.borrow(), ["2@0", "1@0"]);
}

#[test]
fn timed_interrupts_latch_their_period() {
    let entries = Log::default();
    let main: Block = Box::new(|cpu, _| {
        let ms = cpu.clock.now() / 1_000_000;
        match ms {
            0 => {
                set_special(cpu, 34, 25);
                set_special(cpu, 35, 0);
                attach(cpu, 0, 10);
                // A period of 0 is none.
                attach(cpu, 1, 11);
                enable(cpu);
            }
            // No effect until it is attached again.
            50 => set_special(cpu, 34, 10),
            80 => {
                attach(cpu, 0, 10);
            }
            _ => {}
        }
    });
    run(&s7200(main, vec![(0, log(&entries, "t")), (1, log(&entries, "never"))]), 10);
    assert_eq!(*entries.borrow(), ["t@25", "t@50", "t@75", "t@90", "t@100"]);
}

#[test]
fn ten_samples_in_a_second() {
    let routine: Block = Box::new(|cpu, _| {
        let at = layout::DB_DATA + 102;
        cpu.memory.set_word(at, cpu.memory.word(at) + 1);
    });
    let main: Block = Box::new(|cpu, _| {
        if is_first(cpu) {
            set_special(cpu, 34, 100);
            attach(cpu, 0, 10);
            enable(cpu);
        }
        // Disabled from 1 s to 2 s: eight events wait, two are lost.
        match cpu.clock.now() / 1_000_000 {
            1000 => {
                assert_eq!(cpu.memory.word(layout::DB_DATA + 102), 10);
                operate(cpu, Operation::DisableInterrupts, [0; 4]);
            }
            2000 => {
                assert_eq!((cpu.memory.word(layout::DB_DATA + 102), special(cpu, 4) & 7), (10, 4));
                enable(cpu);
                cpu.safepoint(NO_SITE);
                assert_eq!((cpu.memory.word(layout::DB_DATA + 102), special(cpu, 4) & 7), (18, 0));
            }
            _ => {}
        }
    });
    let cpu = s7200(main, vec![(0, routine)]);
    run(&cpu, 201);
    assert_eq!(cpu.stopped(), None);
}

#[test]
fn what_a_routine_finds_and_leaves() {
    const AC1: u32 = layout::SYSTEM + system::ACCUMULATORS + 4;
    const DEPTH: u32 = layout::SYSTEM + system::CALL_DEPTH;
    let routine: Block = Box::new(|cpu, lbase| {
        assert_ne!(lbase, layout::l_stack(1));
        assert_eq!((cpu.memory.byte(lbase), cpu.memory.dword(DEPTH)), (0, 0));
        // Values of the interrupted program are there, but what is written is not kept.
        assert_eq!(cpu.memory.dword(AC1), 7);
        cpu.memory.set_dword(AC1, 99);
        cpu.memory.set_dword(DEPTH, 1);
        cpu.memory.set_byte(lbase, 1);
        set_special(cpu, 1, 0xFF);
        cpu.memory.set_host32(layout::CpuRegister::Accu1.slot(), 99);
    });
    let main: Block = Box::new(|cpu, lbase| {
        assert_eq!((lbase, cpu.memory.byte(lbase), cpu.memory.dword(DEPTH)), (layout::l_stack(1), 0, 0));
        attach(cpu, 0, 0);
        enable(cpu);
        cpu.memory.set_byte(lbase, 5);
        cpu.memory.set_dword(AC1, 7);
        cpu.memory.set_dword(DEPTH, 3);
        set_special(cpu, 1, 2);
        cpu.memory.set_host32(layout::CpuRegister::Accu1.slot(), 8);
        cpu.s7200_event(0, None);
        cpu.safepoint(NO_SITE);
        assert_eq!((cpu.memory.dword(AC1), cpu.memory.dword(DEPTH), special(cpu, 1)), (7, 3, 2));
        assert_eq!((cpu.memory.byte(lbase), cpu.memory.host32(layout::CpuRegister::Accu1.slot())), (5, 8));
    });
    let cpu = s7200(main, vec![(0, routine)]);
    run(&cpu, 2);
    assert_eq!(cpu.stopped(), None);
}

#[test]
fn characters_come_with_their_events() {
    let seen = Rc::new(RefCell::new(Vec::new()));
    let log = seen.clone();
    let routine: Block = Box::new(move |cpu, _| log.borrow_mut().push((special(cpu, 2), special(cpu, 3))));
    let main: Block = Box::new(|cpu, _| {
        cpu.s7200_event(8, Some((b'x', true)));
        assert_eq!((special(cpu, 2), special(cpu, 3)), (b'x', 1));
        attach(cpu, 0, 8);
        cpu.s7200_event(8, Some((b'A', false)));
        cpu.s7200_event(8, Some((b'B', true)));
        assert_eq!(special(cpu, 2), b'x');
        enable(cpu);
        cpu.safepoint(NO_SITE);
    });
    run(&s7200(main, vec![(0, routine)]), 1);
    assert_eq!(*seen.borrow(), [(b'A', 0), (b'B', 1)]);
}

/// Sets I0.0 and I0.3 before some scans.
struct Inputs;

impl Observer for Inputs {
    fn before(&mut self, cpu: &Cpu, cycle: u64, _: u64) {
        let levels = [1, 1, 8, 9, 0].get(cycle as usize).copied().unwrap_or(0);
        cpu.driver.set_input(0, 1, levels);
    }
    fn after(&mut self, _: &Cpu, _: u64, _: u64) {}
}

#[test]
fn edges_of_inputs() {
    let entries = Log::default();
    let routines = [(0, "+0.0"), (1, "-0.0"), (6, "+0.3"), (7, "-0.3")];
    let routines = routines.map(|(number, text)| (number, log(&entries, text))).into_iter().collect();
    let main: Block = Box::new(|cpu, _| {
        if is_first(cpu) {
            [0, 1, 6, 7].into_iter().for_each(|event| assert_eq!(attach(cpu, event, event), result::ENO));
            enable(cpu);
        }
    });
    run_observed(&s7200(main, routines), 4, &mut Inputs);
    // Scan 2: I0.0 falls, I0.3 rises, which has the higher priority; scan 3: I0.0 rises; scan 4: both fall.
    assert_eq!(*entries.borrow(), ["+0.3@10", "-0.0@10", "+0.0@20", "-0.0@30", "-0.3@30"]);
}

#[test]
fn what_is_not_allowed() {
    let routine: Block = Box::new(|cpu, _| {
        assert_eq!(enable(cpu), 0);
        assert_eq!(operate(cpu, Operation::DisableInterrupts, [0; 4]), 0);
        assert_eq!(attach(cpu, 0, 1), result::ENO);
    });
    let main: Block = Box::new(|cpu, _| {
        assert_eq!(attach(cpu, 5, 0), 0, "no such routine");
        assert_eq!(attach(cpu, 0, 33), 0, "not an event of this CPU");
        assert_eq!(attach(cpu, 0, 99), 0);
        assert_eq!(operate(cpu, Operation::DetachInterrupt, [34, 0, 0, 0]), 0);
        assert_eq!(operate(cpu, Operation::ClearEvents, [33, 0, 0, 0]), 0);
        attach(cpu, 0, 0);
        enable(cpu);
        cpu.s7200_event(0, None);
        cpu.safepoint(NO_SITE);
        assert_eq!(special(cpu, 4) & 0x18, 0x18);
    });
    let cpu = s7200_with(main, vec![(0, routine)], |image| {
        image.s7200.as_mut().unwrap().cpu.events = 0xFF;
    });
    run(&cpu, 1);
    let report = cpu.s7200_error_report();
    assert!(report[0].contains(&format!("non-fatal error {:04X}", error::RANGE)), "{report:?}");
    assert!(report[1].contains(&format!("non-fatal error {:04X}", error::NOT_IN_INTERRUPT)), "{report:?}");
}

#[test]
fn stop_in_a_routine_ends_the_scan_first() {
    let entries = Log::default();
    let inner = entries.clone();
    let routine: Block = Box::new(move |cpu, _| {
        inner.borrow_mut().push("stop".to_string());
        assert_eq!(operate(cpu, Operation::StopMode, [0; 4]), result::STOP);
        // A subroutine that it called is left, too.
        assert_eq!(cpu.safepoint(NO_SITE), 1);
    });
    let main: Block = Box::new(|cpu, _| {
        attach(cpu, 0, 0);
        attach(cpu, 1, 1);
        enable(cpu);
        cpu.s7200_event(0, None);
        cpu.s7200_event(1, None);
        assert_eq!(cpu.safepoint(NO_SITE), 0);
        cpu.s7200_event(1, None);
        assert_eq!(cpu.safepoint(NO_SITE), 0);
        cpu.memory.set_byte(layout::Q, 0x55);
        cpu.memory.set_byte(layout::DB_DATA, 9);
    });
    let cpu = s7200(main, vec![(0, routine), (1, log(&entries, "dropped"))]);
    run(&cpu, 5);
    assert_eq!(*entries.borrow(), ["stop"]);
    let stop = cpu.stopped().unwrap();
    assert!(stop.asked);
    assert_eq!(cpu.stop_text(&stop), "STOP by the STOP instruction (scan 1)");
    // The scan went on to its end; then the outputs took their STOP values.
    assert_eq!((cpu.memory.byte(layout::DB_DATA), cpu.memory.byte(layout::Q), cpu.driver.output(0, 1)), (9, 0x55, 0));
}

#[test]
fn stop_in_a_routine_between_two_scans() {
    let routine: Block = Box::new(|cpu, _| {
        operate(cpu, Operation::StopMode, [0; 4]);
    });
    let main: Block = Box::new(|cpu, _| {
        if is_first(cpu) {
            set_special(cpu, 34, 15);
            attach(cpu, 0, 10);
            enable(cpu);
        }
    });
    let cpu = s7200(main, vec![(0, routine)]);
    run(&cpu, 5);
    assert!(cpu.stopped().unwrap().asked);
    assert_eq!(cpu.s7200_scan_number(), Some(2));
}
