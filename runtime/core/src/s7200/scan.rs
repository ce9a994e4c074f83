//! Start of RUN, scan, STOP. Source: S7-200 system manual, scan cycle.

use std::cell::{Cell, RefCell};

use plcc_abi::image::BlockKind;
use plcc_abi::layout;
use plcc_abi::s7200::{ANALOG_ADDRESS, COUNTERS, result, system};

use super::errors::{LED_CHANGED, STOP_INSTRUCTION, WATCHDOG_EXPIRED};
use super::{Operands, done};
use crate::cpu::{Area, Cpu};

/// Where the scan is.
pub struct Scan {
    /// Number of the scan, 1 for the first one.
    pub(super) number: Cell<u64>,
    /// Between the start of a scan and its end.
    pub(super) is_running: Cell<bool>,
    /// An interrupt routine has executed STOP at this site: the CPU goes to STOP when the scan ends.
    pub(super) stop_site: Cell<Option<u32>>,
    /// Value of DLED.
    led: Cell<bool>,
    /// Analog outputs as the modules have them.
    analog: RefCell<[u8; system::ANALOG_BYTES as usize]>,
}

impl Default for Scan {
    fn default() -> Scan {
        Scan {
            number: Cell::new(0),
            is_running: Cell::new(false),
            stop_site: Cell::new(None),
            led: Cell::new(false),
            analog: RefCell::new([0; system::ANALOG_BYTES as usize]),
        }
    }
}

/// Last, shortest and longest scan in milliseconds.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScanTimes {
    pub last: u16,
    pub shortest: u16,
    pub longest: u16,
}

impl Cpu {
    /// The CPU is switched on and RUN begins: retentive memory, first-scan state of special memory, timers, counters, edges.
    pub(crate) fn s7200_start(&self) {
        let Some(own) = self.s7200() else { return };
        let memory = &self.memory;
        own.retain.found(self.power_on_retentive());
        self.s7200_start_special();
        self.s7200_start_timers();
        memory.clear(layout::SYSTEM + system::COUNTER_BITS, COUNTERS);
        let (rising, falling) = (own.image.rising_edges, own.image.falling_edges);
        let count = rising.saturating_add(falling).min(system::EDGES_MAX);
        for edge in 0..count {
            memory.set_byte(layout::SYSTEM + system::EDGES + edge, u8::from(edge < rising));
        }
        own.scan.number.set(0);
        own.scan.stop_site.set(None);
    }

    /// Something besides the program touches special memory or hardware.
    pub(crate) fn s7200_look_always(&self) {
        if let Some(own) = self.s7200() {
            own.logic_only.set(false);
            self.rearm();
        }
    }

    /// RUN begins, and the inputs have their first values: interrupts and hardware.
    pub(crate) fn s7200_start_hardware(&self) {
        self.s7200_start_interrupts();
        self.s7200_start_counters();
        self.s7200_start_pulses();
        self.s7200_start_ports();
        self.s7200_start_network();
        self.s7200_note_ports();
    }

    /// When the next event of an S7-200 is due. The network waits for the end of the scan.
    pub(crate) fn s7200_due(&self) -> u64 {
        let network = if self.s7200_is_scanning() { crate::schedule::NEVER } else { self.s7200_network_due() };
        let sources = [
            self.s7200_timed_due(),
            self.s7200_timers_due(),
            self.s7200_counters_due(),
            self.s7200_pulses_due(),
            self.s7200_ports_due(),
        ];
        sources.into_iter().fold(network, u64::min)
    }

    /// Handles everything that is due.
    pub(crate) fn s7200_poll(&self) {
        self.s7200_stamp_events();
        self.s7200_poll_counters();
        self.s7200_look_at_inputs();
        self.s7200_poll_pulses();
        self.s7200_poll_ports();
        self.s7200_poll_timed();
        self.s7200_poll_timers();
        if !self.s7200_is_scanning() {
            self.s7200_poll_network();
        }
    }

    fn s7200_is_scanning(&self) -> bool {
        self.s7200().is_some_and(|own| own.scan.is_running.get())
    }

    /// A scan begins; inputs are in their image.
    pub(crate) fn s7200_begin_scan(&self, number: u64, times: ScanTimes) {
        let Some(own) = self.s7200() else { return };
        own.scan.number.set(number);
        own.scan.is_running.set(true);
        self.s7200_scan_special(number, times);
        self.s7200_scan_timers();
    }

    /// The main program, nesting from 0.
    pub(crate) fn s7200_main(&self) {
        let main = self.block(BlockKind::Ob, 1).filter(|_| !self.is_stopped());
        if let Some(block) = main {
            self.memory.set_dword(layout::SYSTEM + system::CALL_DEPTH, 0);
            self.run_s7200_block(block, 1);
        }
    }

    /// The main program has ended: applies writes through pointers, communication, and a STOP that an interrupt routine requested.
    pub(crate) fn s7200_end_program(&self) {
        let Some(own) = self.s7200() else { return };
        own.scan.is_running.set(false);
        if self.is_stopped() || own.logic_only.get() {
            return;
        }
        self.s7200_look_at_special();
        self.s7200_write_analog();
        self.s7200_poll_network();
        if let Some(site) = own.scan.stop_site.get() {
            self.stop_by(STOP_INSTRUCTION, site, 0);
        }
    }

    /// An interrupt routine between two scans has executed STOP: no scan is left to end.
    pub(super) fn s7200_stop_between_scans(&self) {
        if let Some(own) = self.s7200().filter(|own| !own.scan.is_running.get())
            && let Some(site) = own.scan.stop_site.get()
        {
            self.stop_by(STOP_INSTRUCTION, site, 0);
        }
    }

    /// True while an interrupt routine is to be left because it has executed STOP.
    pub(crate) fn s7200_is_leaving(&self) -> bool {
        self.s7200().is_some_and(|own| own.interrupts.leaving.get())
    }

    /// Number of the scan for messages; `None`: not an S7-200, or before the first scan.
    pub(crate) fn s7200_scan_number(&self) -> Option<u64> {
        self.s7200().map(|own| own.scan.number.get()).filter(|&number| number > 0)
    }

    /// The scan takes longer than the watchdog allows, or never ends.
    pub(crate) fn s7200_watchdog(&self, site: u32, ms: u32) {
        self.stop_by(WATCHDOG_EXPIRED, site, ms);
    }

    /// The bits of output byte 0 that pulse outputs own, and their levels.
    fn pulse_bits(&self) -> (u8, u8) {
        let none = (0, 0);
        if self.s7200.as_ref().is_none_or(|own| own.logic_only.get()) {
            return none;
        }
        let level = |number: u8| self.s7200_pulse_level(number).map(|on| (1 << number, u8::from(on) << number));
        (0..2).filter_map(level).fold(none, |(mask, levels), (bit, level)| (mask | bit, levels | level))
    }

    /// `value` for outputs of a module as it goes there: pulse outputs have the level of their generators.
    pub(crate) fn at_module(&self, address: u32, bytes: u32, value: u32) -> u32 {
        if address != 0 || !matches!(bytes, 1 | 2 | 4) {
            return value;
        }
        let ((mask, levels), shift) = (self.pulse_bits(), 8 * (bytes - 1));
        value & !(u32::from(mask) << shift) | u32::from(levels) << shift
    }

    /// The value of the output module: pulse outputs at this moment, all others as written.
    pub(crate) fn module_output(&self, address: u32, bytes: u32) -> u32 {
        let value = self.driver.output(address, bytes);
        if self.is_stopped() { value } else { self.at_module(address, bytes, value) }
    }

    /// Copies the process image of outputs to the modules.
    pub(crate) fn s7200_write_outputs(&self) {
        let (base, changed) = self.changed_outputs();
        let (mask, levels) = self.pulse_bits();
        if mask == 0 && !self.is_forcing() {
            if changed > 0 {
                self.memory.view(base, changed, |image| self.driver.write_image(image));
            }
            return;
        }
        // When pulses and forcing end, the modules get the image again.
        self.note_outputs(u32::MAX);
        let (base, length) = self.area(Area::Outputs);
        self.memory.view(base, length, |image| {
            let mut bytes = image.to_vec();
            self.force_image(&mut bytes);
            self.write_forced_analog();
            if let Some(first) = bytes.first_mut() {
                *first = *first & !mask | levels;
            }
            self.driver.write_image(&bytes);
        });
    }

    /// An analog output was written directly: a read through a pointer sees it.
    pub(crate) fn s7200_analog_written(&self, address: u32, bytes: u32, value: u32) {
        let (Some(own), Some(offset), 2) = (self.s7200(), address.checked_sub(ANALOG_ADDRESS), bytes) else { return };
        let mut analog = own.scan.analog.borrow_mut();
        let at = offset as usize;
        if let Some(word) = at.checked_add(2).and_then(|end| analog.get_mut(at..end)) {
            let bytes = (value as u16).to_be_bytes();
            word.copy_from_slice(&bytes);
            self.memory.set_bytes(layout::SYSTEM + system::AQ + offset, bytes);
        }
    }

    /// Analog outputs that were written through a pointer go to their modules.
    fn s7200_write_analog(&self) {
        let Some(own) = self.s7200() else { return };
        let now = self.memory.bytes::<{ system::ANALOG_BYTES as usize }>(layout::SYSTEM + system::AQ);
        let mut analog = own.scan.analog.borrow_mut();
        if *analog == now {
            return;
        }
        for (number, (new, old)) in (0u32..).zip(now.chunks(2).zip(analog.chunks(2))) {
            if let (true, &[high, low]) = (new != old, new) {
                let (address, word) = (ANALOG_ADDRESS + 2 * number, u32::from(u16::from_be_bytes([high, low])));
                self.driver.write(address, 2, self.forced_output(address, 2, word));
            }
        }
        *analog = now;
    }

    /// STOP: outputs of the modules are 0, their image stays.
    pub(crate) fn s7200_stop_outputs(&self) {
        let (_, length) = self.area(Area::Outputs);
        self.driver.write_image(&vec![0; length as usize]);
        for address in (ANALOG_ADDRESS..ANALOG_ADDRESS + system::ANALOG_BYTES).step_by(2) {
            self.driver.write(address, 2, 0);
        }
    }

    /// The run ends.
    pub(crate) fn s7200_finish(&self) {
        if self.is_stopped() {
            self.s7200_stop_outputs();
        }
    }
}

pub(super) fn restart_watchdog(cpu: &Cpu, _operands: &Operands) -> u64 {
    cpu.schedule.monitor.restart(cpu.clock.now());
    cpu.arm_hang();
    cpu.rearm();
    done()
}

pub(super) fn diagnostic_led(cpu: &Cpu, operands: &Operands) -> u64 {
    let on = operands.a as u8 != 0;
    if cpu.s7200().is_some_and(|own| own.scan.led.replace(on) != on) {
        cpu.log(LED_CHANGED, operands.site, on.into());
    }
    done()
}

pub(super) fn stop_mode(cpu: &Cpu, operands: &Operands) -> u64 {
    let Some(own) = cpu.s7200() else { return result::STOP };
    if own.interrupts.running.get() {
        own.scan.stop_site.set(Some(operands.site));
        own.interrupts.abandon();
        own.interrupts.leaving.set(true);
        super::set_special(&cpu.memory, 4, 4, false);
        // Subroutines of the routine are left, too.
        cpu.memory.raise_attention();
    } else {
        cpu.stop_by(STOP_INSTRUCTION, operands.site, 0);
    }
    result::STOP
}
