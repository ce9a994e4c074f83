//! The S7-200 as a family of CPUs: a scan with its main program, and interrupt routines without priorities.

use super::ENDLESS;
use super::scan::ScanTimes;
use crate::cpu::Cpu;
use crate::cycle::{Course, CycleTimes, Observer};
use crate::family::Family;
use crate::schedule::NEVER;

/// See the module comment. The state is in [`S7200`](super::S7200).
pub(crate) struct ScanCycle;

impl Family for ScanCycle {
    fn go_on_alone(&self, cpu: &Cpu, course: &mut Course, observer: &mut dyn Observer, is_wanted: &dyn Fn() -> bool) {
        cpu.go_through::<ScanCycle, true>(self, course, observer, is_wanted);
    }

    fn power_on(&self, cpu: &Cpu) {
        cpu.s7200_start();
    }

    fn start_hardware(&self, cpu: &Cpu) {
        cpu.s7200_start_hardware();
    }

    fn begin_cycle(&self, cpu: &Cpu, cycle: u64, times: &CycleTimes) {
        let CycleTimes { last, shortest, longest, .. } = *times;
        cpu.s7200_begin_scan(cycle, ScanTimes { last, shortest: shortest.unwrap_or(0), longest });
    }

    fn run_program(&self, cpu: &Cpu, _cycle: u64, _times: &CycleTimes) {
        cpu.s7200_main();
    }

    fn end_program(&self, cpu: &Cpu) {
        cpu.s7200_end_program();
    }

    fn write_outputs(&self, cpu: &Cpu) {
        cpu.s7200_write_outputs();
    }

    fn stop_outputs(&self, cpu: &Cpu) {
        cpu.s7200_stop_outputs();
    }

    fn finish(&self, cpu: &Cpu) {
        cpu.s7200_finish();
    }

    fn next_due(&self, cpu: &Cpu) -> u64 {
        if is_logic_only(cpu) { NEVER } else { cpu.s7200_due() }
    }

    fn is_timed_only(&self, cpu: &Cpu) -> bool {
        is_logic_only(cpu)
    }

    fn poll(&self, cpu: &Cpu) {
        cpu.s7200_poll();
    }

    fn dispatch(&self, cpu: &Cpu) {
        if !is_logic_only(cpu) {
            cpu.s7200_dispatch();
        }
    }

    fn is_leaving(&self, cpu: &Cpu) -> bool {
        cpu.s7200_is_leaving()
    }

    fn cycle_too_long(&self, cpu: &Cpu, ms: u32, site: u32) {
        cpu.s7200_watchdog(site, ms);
    }

    fn hang(&self, cpu: &Cpu, site: u32) {
        cpu.s7200_watchdog(site, ENDLESS);
    }

    fn before_input(&self, cpu: &Cpu) {
        cpu.s7200_poll_counters();
    }

    fn output_written(&self, cpu: &Cpu, address: u32, bytes: u32, value: u32) {
        cpu.s7200_analog_written(address, bytes, value);
    }
}

/// See [`S7200::logic_only`](super::S7200::logic_only).
fn is_logic_only(cpu: &Cpu) -> bool {
    cpu.s7200().is_some_and(|own| own.logic_only.get())
}
