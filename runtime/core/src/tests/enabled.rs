//! Outputs that a client enables in STOP.

use std::rc::Rc;

use plcc_abi::image::Family;
use plcc_abi::layout;
use plcc_abi::s7200::ANALOG_ADDRESS;

use super::helpers::{Block, cpu_with, run, s7200};
use crate::cpu::Cpu;
use crate::options::Restart;
use crate::watch::Settled;

/// OB 1 writes 16#0F to QB 4 once; then the CPU is in STOP.
fn stopped(family: Family) -> Rc<Cpu> {
    let ob1: Block = Box::new(|cpu, _| {
        cpu.memory.set_byte(layout::Q + 4, 0x0F);
        cpu.note_outputs(u32::MAX);
    });
    let cpu = cpu_with(vec![(1, ob1)], |image| image.profile.family = family);
    run(&cpu, 1);
    assert_eq!(cpu.driver.output(4, 1), 0x0F);
    cpu.stop_by_request();
    cpu
}

fn write(cpu: &Cpu, client: u64, name: &str, value: &str) -> Result<(), String> {
    let settled = Settled::find(name, value, None, &cpu.image).unwrap();
    cpu.for_client(client, || {
        cpu.check_modifiable(&settled)?;
        cpu.write(&settled.address, settled.bits)
    })
}

#[test]
fn outputs_are_written_by_the_client_that_enabled_them() {
    for family in [Family::S7300, Family::S7400, Family::S71200, Family::S71500] {
        let cpu = stopped(family);
        assert!(write(&cpu, 1, "PQB4", "5").unwrap_err().contains("outputs are disabled"));
        assert_eq!(cpu.enable_outputs(1), Ok(()));
        assert_eq!(cpu.driver.output(4, 1), 0, "nobody has written it");
        assert_eq!(write(&cpu, 1, "PQB4", "16#A5"), Ok(()));
        assert!(write(&cpu, 2, "PQB4", "5").unwrap_err().contains("outputs are disabled"));
        assert!(cpu.enable_outputs(2).unwrap_err().contains("another client"));
        assert_eq!(write(&cpu, 1, "QB5", "16#FF"), Ok(()), "the image, which nobody writes out");
        assert_eq!((cpu.driver.output(4, 1), cpu.driver.output(5, 1)), (0xA5, 0));
        cpu.disable_outputs(2);
        assert!(cpu.has_enabled_outputs());
        cpu.disable_outputs(1);
        assert!(!cpu.has_enabled_outputs());
        assert_eq!(cpu.driver.output(4, 1), 0);
        let events: Vec<u16> = cpu.diagnostics.newest_first().iter().map(|entry| entry.event).collect();
        assert_eq!(events[..2], [0xC036, 0xC035]);
    }
}

#[test]
fn a_restart_and_other_forced_values_disable_outputs() {
    let cpu = stopped(Family::S7300);
    assert_eq!(cpu.enable_outputs(1), Ok(()));
    assert_eq!(write(&cpu, 1, "PQB6", "7"), Ok(()));
    let cpu = Cpu::restarted(cpu, Restart::Warm);
    assert!(!cpu.has_enabled_outputs());
    assert_eq!(cpu.driver.output(6, 1), 0);
    assert!(cpu.enable_outputs(1).unwrap_err().contains("in RUN"));
    cpu.stop_by_request();
    assert_eq!(cpu.enable_outputs(1), Ok(()));
    assert_eq!(cpu.force("Q6.0", "1"), Ok(()));
    assert!(!cpu.has_enabled_outputs());
}

/// Source: Programming with STEP 7, 20.4: a force job becomes effective. An S7-1200/1500 refuses it.
#[test]
fn forced_outputs_have_their_values() {
    for (family, is_possible) in [(Family::S7300, true), (Family::S7400, true), (Family::S71500, false)] {
        let cpu = stopped(family);
        assert_eq!(cpu.force("Q4.7", "1"), Ok(()));
        assert_eq!(cpu.enable_outputs(1).is_ok(), is_possible, "{family:?}");
        assert_eq!(cpu.driver.output(4, 1), if is_possible { 0x80 } else { 0x0F });
    }
}

/// It has no peripheral outputs: those of the image are written, each alone.
#[test]
fn an_s7_200_writes_outputs_of_its_image() {
    let main: Block = Box::new(|cpu, _| {
        cpu.memory.set_byte(layout::Q, 0x0F);
        cpu.note_outputs(u32::MAX);
    });
    let cpu = s7200(main, vec![]);
    run(&cpu, 1);
    cpu.stop_by_request();
    cpu.stop_outputs();
    assert!(write(&cpu, 1, "AQW4", "16#0064").unwrap_err().contains("outputs are disabled"));
    assert_eq!(write(&cpu, 1, "Q0.7", "1"), Ok(()));
    assert_eq!(cpu.driver.output(0, 1), 0);
    assert_eq!(cpu.enable_outputs(1), Ok(()));
    assert_eq!(write(&cpu, 1, "Q0.6", "1"), Ok(()));
    assert_eq!(write(&cpu, 1, "QB1", "16#33"), Ok(()));
    assert_eq!(write(&cpu, 1, "AQW4", "16#0064"), Ok(()));
    assert_eq!((cpu.driver.output(0, 2), cpu.driver.output(ANALOG_ADDRESS + 4, 2)), (0x4033, 100));
    assert_eq!(cpu.memory.byte(layout::Q), 0xCF);
}
