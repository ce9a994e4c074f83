//! Jobs of clients that modify values in the cycle, and the memory reset.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::image::Family;
use plcc_abi::layout;

use super::helpers::{Block, cpu, cpu_with, run};
use crate::cpu::Cpu;
use crate::modify::{ROWS_MAX, Row};
use crate::options::Restart;
use crate::watch::format::Format;
use crate::watch::{Settled, Trigger};

fn row(cpu: &Cpu, name: &str, value: &str, trigger: Trigger, every_cycle: bool) -> Row {
    let settled = Settled::find(name, value, Some(Format::Dec).filter(|_| name.contains('W')), &cpu.image).unwrap();
    Row { settled, trigger, every_cycle }
}

/// IB 0 and MW 10 as OB 1 sees them in each cycle; it counts MW 10 and writes 7 to QB 4.
type Cycles = Rc<RefCell<Vec<(u8, u16)>>>;

fn counting() -> (Rc<Cpu>, Cycles) {
    let seen = Cycles::default();
    let keep = seen.clone();
    let ob1: Block = Box::new(move |cpu, _| {
        let memory = &cpu.memory;
        keep.borrow_mut().push((memory.byte(layout::I), memory.word(layout::M + 10)));
        memory.set_word(layout::M + 10, memory.word(layout::M + 10) + 1);
        memory.set_byte(layout::Q + 4, 7);
    });
    (cpu(vec![(1, ob1)]), seen)
}

#[test]
fn a_job_writes_at_the_beginning_and_the_end_of_cycles() {
    let (cpu, seen) = counting();
    let rows = vec![
        row(&cpu, "I0.1", "1", Trigger::Begin, false),
        row(&cpu, "MW10", "100", Trigger::Begin, true),
        row(&cpu, "QB4", "16#0A", Trigger::End, true),
    ];
    assert_eq!(cpu.begin_job(1, rows), Ok(()));
    assert_eq!(cpu.job_rows(1), 3);
    run(&cpu, 3);
    assert_eq!(*seen.borrow(), [(2, 100), (0, 100), (0, 100)], "the input comes from its module again");
    assert_eq!(cpu.driver.output(4, 1), 10, "after what the program wrote");
    assert_eq!((cpu.job_rows(1), cpu.job_rows(2)), (2, 0));
    assert_eq!(cpu.begin_job(2, vec![row(&cpu, "MW10", "5", Trigger::Begin, false)]), Ok(()));
    assert_eq!(cpu.begin_job(1, Vec::new()), Ok(()));
    run(&cpu, 2);
    assert_eq!(seen.borrow()[3..], [(0, 5), (0, 6)]);
    assert_eq!((cpu.job_rows(2), cpu.driver.output(4, 1)), (0, 7));
}

#[test]
fn forced_values_win_over_jobs() {
    let (cpu, seen) = counting();
    assert_eq!(cpu.force("I0.1", "0"), Ok(()));
    assert_eq!(cpu.force("Q4.0", "1"), Ok(()));
    let rows = vec![row(&cpu, "IB0", "16#FF", Trigger::Begin, true), row(&cpu, "QB4", "0", Trigger::End, true)];
    assert_eq!(cpu.begin_job(1, rows), Ok(()));
    run(&cpu, 1);
    assert_eq!(seen.borrow()[0].0, 0xFD);
    assert_eq!(cpu.driver.output(4, 1), 1);
    assert_eq!(cpu.unforce(None), Ok(()));
    run(&cpu, 1);
    assert_eq!((seen.borrow()[1].0, cpu.driver.output(4, 1)), (0xFF, 0), "the job goes on");
}

/// As SFC 26 and SFC 27 do, in the middle of the program.
#[test]
fn images_that_the_program_updates_are_not_the_beginning_of_a_cycle() {
    let ob1: Block = Box::new(|cpu, _| {
        cpu.memory.set_word(layout::M + 12, cpu.memory.word(layout::M + 10));
        cpu.memory.set_word(layout::M + 10, 1);
        cpu.memory.set_byte(layout::Q + 4, 7);
        cpu.read_inputs();
        cpu.write_outputs();
        cpu.memory.set_word(layout::M + 14, cpu.memory.word(layout::M + 10));
        cpu.memory.set_byte(layout::M + 16, cpu.driver.output(4, 1) as u8);
    });
    let cpu = cpu(vec![(1, ob1)]);
    let rows = vec![row(&cpu, "MW10", "100", Trigger::Begin, true), row(&cpu, "QB4", "16#0A", Trigger::End, true)];
    assert_eq!(cpu.begin_job(1, rows), Ok(()));
    run(&cpu, 1);
    let word = |offset: u32| cpu.memory.word(layout::M + offset);
    assert_eq!((word(12), word(14), cpu.memory.byte(layout::M + 16)), (100, 1, 7));
    assert_eq!(cpu.driver.output(4, 1), 10);
}

#[test]
fn what_a_job_cannot_write_is_refused() {
    let (cpu, _) = counting();
    let job = |name: &str| cpu.begin_job(1, vec![row(&cpu, name, "1", Trigger::Begin, true)]).unwrap_err();
    assert!(job("MW65000").contains("outside of the bit memory"));
    assert!(job("DB9.DBX0.0").contains("DB 9 is not loaded"));
    assert!(Settled::find("T5", "1", None, &cpu.image).unwrap_err().contains("T5.VALUE"));
    let many = vec![row(&cpu, "M0.0", "1", Trigger::Begin, true); ROWS_MAX + 1];
    assert!(cpu.begin_job(1, many).unwrap_err().contains("200"));
    cpu.stop_by_request();
    assert!(job("M0.0").contains("STOP"));
}

/// Data, bit memory and retentive memory begin again; a clock that goes on and the diagnostic buffer stay.
#[test]
fn a_memory_reset_is_possible_in_stop_and_leaves_the_cpu_there() {
    for (family, forced) in [(Family::S7300, false), (Family::S71500, true)] {
        let ob1: Block = Box::new(|cpu, _| cpu.memory.set_word(layout::M + 10, cpu.memory.word(layout::M + 10) + 1));
        let cpu = cpu_with(vec![(1, ob1)], |image| image.profile.family = family);
        assert_eq!(cpu.force("I0.0", "1"), Ok(()));
        run(&cpu, 3);
        assert!(cpu.request_memory_reset().unwrap_err().contains("RUN"));
        cpu.stop_by_request();
        assert_eq!(cpu.request_memory_reset(), Ok(()));
        assert_eq!(cpu.restart_requested.take(), Some(Restart::Reset));
        let before = cpu.diagnostics.newest_first().len();
        let cpu = Cpu::after_reset(cpu);
        assert!(cpu.is_stopped());
        assert_eq!(cpu.memory.word(layout::M + 10), 0);
        assert_eq!(cpu.is_forcing(), forced);
        let entries = cpu.diagnostics.newest_first();
        assert_eq!(entries.first().map(|entry| entry.event), Some(crate::diagnostics::MEMORY_RESET));
        assert!(entries.len() > before);
        // A warm restart finds what the reset has left.
        let cpu = Cpu::restarted(cpu, Restart::Warm);
        run(&cpu, 1);
        assert_eq!(cpu.memory.word(layout::M + 10), 1);
    }
    let cpu = cpu_with(vec![], |image| image.profile.family = Family::S7200);
    cpu.stop_by_request();
    assert!(cpu.request_memory_reset().unwrap_err().contains("S7-200"));
}
