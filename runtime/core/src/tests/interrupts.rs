//! Interrupts: order, preemption, delay, time of day, queue.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::layout;

use super::helpers::{Block, cpu, cpu_with, run};
use crate::cpu::Cpu;
use crate::diagnostics::NO_SITE;
use crate::events;

type Log = Rc<RefCell<Vec<String>>>;

/// A block that logs its text and the time in ms.
fn log(entries: &Log, text: &'static str) -> Block {
    let entries = entries.clone();
    Box::new(move |cpu, _| entries.borrow_mut().push(format!("{text}@{}", cpu.clock.now() / 1_000_000)))
}

/// Like `log`, then this many milliseconds of `//@ sleep`.
fn log_sleep(entries: &Log, text: &'static str, ms: u64) -> Block {
    let entries = entries.clone();
    Box::new(move |cpu, _| {
        entries.borrow_mut().push(format!("{text}@{}", cpu.clock.now() / 1_000_000));
        cpu.pass_time(ms * 1_000_000, false);
        entries.borrow_mut().push(format!("/{text}@{}", cpu.clock.now() / 1_000_000));
    })
}

fn request(cpu: &Cpu, ob: u16) {
    cpu.request(events::usual(ob, None).unwrap());
}

#[test]
fn cyclic_interrupts_run_at_their_due_times() {
    let entries = Log::default();
    let cpu = cpu_with(vec![(35, log(&entries, "35")), (38, log(&entries, "38"))], |image| {
        image.config.cyclic_period_ms = vec![(38, 40)];
        image.config.cyclic_phase_ms = vec![(35, 5)];
    });
    run(&cpu, 12);
    assert_eq!(*entries.borrow(), ["38@40", "38@80", "35@105", "38@120"]);
}

#[test]
fn sleep_is_interrupted_by_higher_priority_only() {
    let entries = Log::default();
    let outer = entries.clone();
    let ob40: Block = Box::new(move |cpu, lbase| {
        assert_eq!(lbase, layout::l_stack(16));
        outer.borrow_mut().push(format!("40@{}", cpu.clock.now() / 1_000_000));
        request(cpu, 20);
        request(cpu, 41);
        cpu.safepoint(NO_SITE);
        outer.borrow_mut().push("/40".to_string());
    });
    let blocks = vec![
        (1, log_sleep(&entries, "1", 100)),
        (20, log(&entries, "20")),
        (35, log(&entries, "35")),
        (40, ob40),
        (41, log(&entries, "41")),
    ];
    let cpu = cpu(blocks);
    request(&cpu, 40);
    run(&cpu, 1);
    assert_eq!(*entries.borrow(), ["40@0", "41@0", "/40", "20@0", "1@0", "35@100", "/1@100"]);
}

#[test]
fn registers_survive_an_interrupt() {
    let ob40: Block = Box::new(|cpu, _| {
        assert_eq!(cpu.memory.host32(layout::CpuRegister::Accu1.slot()), 0);
        cpu.memory.set_host32(layout::CpuRegister::Accu1.slot(), 99);
        cpu.memory.set_host64(layout::state::RETURN_VALUES, 99);
    });
    let ob1: Block = Box::new(|cpu, _| {
        cpu.memory.set_host32(layout::CpuRegister::Accu1.slot(), 7);
        cpu.memory.set_host64(layout::state::RETURN_VALUES, 8);
        cpu.memory.set_host32(layout::state::DEPTH, 5);
        request(cpu, 40);
        assert_eq!(cpu.memory.host32(layout::state::ATTENTION), 1);
        assert_eq!(cpu.safepoint(NO_SITE), 0);
        assert_eq!(cpu.memory.host32(layout::state::ATTENTION), 0);
        assert_eq!(cpu.memory.host32(layout::CpuRegister::Accu1.slot()), 7);
        assert_eq!(cpu.memory.host64(layout::state::RETURN_VALUES), 8);
        assert_eq!(cpu.memory.host32(layout::state::DEPTH), 5);
        assert_eq!(cpu.memory.host32(layout::state::L_END), layout::l_stack(1) + 32_768);
    });
    run(&cpu(vec![(1, ob1), (40, ob40)]), 1);
}

#[test]
fn missing_interrupt_ob() {
    let entries = Log::default();
    let with = cpu(vec![(85, log(&entries, "85"))]);
    request(&with, 40);
    run(&with, 1);
    assert_eq!(*entries.borrow(), ["85@0"]);
    let without = cpu(Vec::new());
    request(&without, 40);
    assert_eq!(without.stopped().unwrap().entry.event, 0x456D);
}

#[test]
fn missing_error_obs() {
    for (ob, stop) in [
        (80, Some(0x4568)),
        (81, None),
        (82, Some(0x456A)),
        (83, Some(0x456B)),
        (84, None),
        (85, Some(0x456D)),
        (86, Some(0x456F)),
        (87, Some(0x456E)),
        (88, Some(0x4570)),
    ] {
        let cpu = cpu(Vec::new());
        request(&cpu, ob);
        assert_eq!(cpu.stopped().map(|stop| stop.entry.event), stop, "OB {ob}");
    }
}

#[test]
fn errors_interrupt_the_startup_and_interrupts_wait() {
    let entries = Log::default();
    let outer = entries.clone();
    let ob100: Block = Box::new(move |cpu, _| {
        request(cpu, 40);
        request(cpu, 82);
        cpu.safepoint(NO_SITE);
        outer.borrow_mut().push("100".to_string());
    });
    run(&cpu(vec![(100, ob100), (40, log(&entries, "40")), (82, log(&entries, "82"))]), 1);
    assert_eq!(*entries.borrow(), ["82@0", "100", "40@0"]);
}

#[test]
fn cyclic_interrupt_that_is_still_waiting() {
    let entries = Log::default();
    let cpu = cpu(vec![(35, log(&entries, "35")), (40, log_sleep(&entries, "40", 250)), (80, log(&entries, "80"))]);
    request(&cpu, 40);
    run(&cpu, 1);
    assert_eq!(*entries.borrow(), ["40@0", "80@200", "/40@250", "35@250"]);
}

#[test]
fn full_queue_is_a_time_error() {
    let entries = Log::default();
    let cpu = cpu(vec![(40, log(&entries, "40")), (80, log(&entries, "80"))]);
    for _ in 0..65 {
        request(&cpu, 40);
    }
    run(&cpu, 1);
    let entries = entries.borrow();
    assert_eq!(entries[0], "80@0");
    assert_eq!(entries.len(), 64);
}

#[test]
fn cyclic_order_among_equal_due_times_is_by_priority() {
    let entries = Log::default();
    run(&cpu(vec![(33, log(&entries, "33")), (35, log(&entries, "35")), (34, log(&entries, "34"))]), 50);
    assert_eq!(entries.borrow()[6..], ["35@500", "33@500"].map(String::from)[..]);
}
