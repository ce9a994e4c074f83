//! Special memory that the CPU writes or applies. Source: S7-200 system manual, special memory bits.

use std::cell::Cell;

use plcc_abi::s7200::image::AnalogModule;

use super::scan::ScanTimes;
use super::{set_special, special};
use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;

/// Bits of SMB0 that depend on nothing but the scan.
const ALWAYS_ON: u8 = 1 << 0;
const FIRST_SCAN: u8 = 1 << 1;
const RETENTIVE_LOST: u8 = 1 << 2;
const POWERED_UP: u8 = 1 << 3;
const MINUTE_CLOCK: u8 = 1 << 4;
const SECOND_CLOCK: u8 = 1 << 5;
const SCAN_CLOCK: u8 = 1 << 6;
const MODE_SWITCH_RUN: u8 = 1 << 7;

/// Half of a minute and of a second, in ms: clocks begin with the half that is off.
const HALF_MINUTE: u64 = 30_000;
const HALF_SECOND: u64 = 500;

/// SM4.3: a programming error in this scan. SM4.5, SM4.6: the transmitters of ports 0 and 1 are idle.
const STATUS: u32 = 4;
const ERROR_BIT: u8 = 3;
const IDLE_BITS: [u8; 2] = [5, 6];

const CPU_ID: u32 = 6;
/// Identification and error byte of modules 0 to 6.
const MODULES: u32 = 8;
const MODULES_MAX: usize = 7;
const ABSENT: u8 = 0x80;
const ANALOG: u8 = 0x10;
const SCAN_TIMES: u32 = 22;
/// The analog potentiometers, of which there are two.
pub(super) const POTENTIOMETERS: u32 = 28;
/// Control bytes of the ports.
const PORT_CONTROLS: [u32; 2] = [30, 130];
/// Control of saving to permanent memory, and the offset in V.
const SAVE_CONTROL: u32 = 31;
const SAVE_OFFSET: u32 = 32;
const SAVE_BIT: u8 = 7;

/// Remembered values of bytes that have an effect.
#[derive(Default)]
pub struct Special {
    /// Control bytes of the ports as they were last applied.
    ports: [Cell<u8>; 2],
}

/// Identification byte of an analog module: number of inputs and outputs as 0, 2, 4, 8.
fn module_id(module: &AnalogModule) -> u8 {
    let code = |channels: u8| match channels {
        0 => 0,
        1 | 2 => 1,
        3 | 4 => 2,
        _ => 3,
    };
    ANALOG | code(module.inputs) << 2 | code(module.outputs)
}

impl Cpu {
    /// The CPU is switched on.
    pub(super) fn s7200_start_special(&self) {
        let Some(own) = self.s7200() else { return };
        let memory = &self.memory;
        IDLE_BITS.iter().for_each(|&bit| set_special(memory, STATUS, bit, true));
        memory.set_byte(special(CPU_ID), own.image.cpu.id << 4);
        let ids = own.config.analog.iter().map(module_id).chain(std::iter::repeat(ABSENT)).take(MODULES_MAX);
        for (slot, id) in (0u32..).zip(ids) {
            memory.set_byte(special(MODULES + 2 * slot), id);
        }
        memory.set_bytes(special(POTENTIOMETERS), own.config.potentiometers);
        // Before the first scan constants are right, too.
        let switch = if own.config.mode_switch_term { 0 } else { MODE_SWITCH_RUN };
        memory.set_byte(special(0), ALWAYS_ON | switch);
        self.s7200_show_forced();
    }

    /// SM4.7: something is forced.
    pub(crate) fn s7200_show_forced(&self) {
        if self.s7200.is_some() {
            set_special(&self.memory, 4, 7, self.is_forcing());
        }
    }

    /// A scan begins.
    pub(super) fn s7200_scan_special(&self, number: u64, times: ScanTimes) {
        let Some(own) = self.s7200() else { return };
        let ms = self.clock.now() / NS_PER_MS;
        let bit = |on: bool, mask: u8| if on { mask } else { 0 };
        let first = number == 1;
        let status = ALWAYS_ON
            | bit(first, FIRST_SCAN | POWERED_UP)
            | bit(first && own.retain.is_lost(), RETENTIVE_LOST)
            | bit(ms / HALF_MINUTE % 2 == 1, MINUTE_CLOCK)
            | bit(ms / HALF_SECOND % 2 == 1, SECOND_CLOCK)
            | bit(number.is_multiple_of(2), SCAN_CLOCK)
            | bit(!own.config.mode_switch_term, MODE_SWITCH_RUN);
        self.memory.set_byte(special(0), status);
        set_special(&self.memory, STATUS, ERROR_BIT, false);
        let [[a, b], [c, d], [e, f]] = [times.last, times.shortest, times.longest].map(u16::to_be_bytes);
        self.memory.set_bytes(special(SCAN_TIMES), [a, b, c, d, e, f]);
    }

    /// See [`RuntimeFn::S7200SpecialWritten`](plcc_abi::RuntimeFn::S7200SpecialWritten).
    pub(crate) fn s7200_special_written(&self, byte: u32) {
        let Some(own) = self.s7200() else { return };
        for (port, (last, _)) in
            (0u8..).zip(own.special.ports.iter().zip(PORT_CONTROLS)).filter(|(_, (_, control))| *control == byte)
        {
            last.set(self.memory.byte(special(byte)));
            self.s7200_port_control_written(port);
        }
        if byte == SAVE_CONTROL && self.memory.bit(special(SAVE_CONTROL), SAVE_BIT) {
            self.save_to_permanent_memory();
        }
    }

    /// The ports have started with the current values of their control bytes.
    pub(super) fn s7200_note_ports(&self) {
        let Some(own) = self.s7200() else { return };
        for (last, control) in own.special.ports.iter().zip(PORT_CONTROLS) {
            last.set(self.memory.byte(special(control)));
        }
    }

    /// A scan ends: applies bytes that were written through pointers or from outside.
    pub(super) fn s7200_look_at_special(&self) {
        let Some(own) = self.s7200() else { return };
        for (last, control) in own.special.ports.iter().zip(PORT_CONTROLS) {
            if last.get() != self.memory.byte(special(control)) {
                self.s7200_special_written(control);
            }
        }
        self.s7200_special_written(SAVE_CONTROL);
    }

    /// SM31.7: the V byte, word or double word at SMW32 goes to permanent memory.
    fn save_to_permanent_memory(&self) {
        let bytes = match self.memory.byte(special(SAVE_CONTROL)) & 3 {
            0 | 1 => 1,
            2 => 2,
            _ => 4,
        };
        let offset = self.memory.word(special(SAVE_OFFSET));
        set_special(&self.memory, SAVE_CONTROL, SAVE_BIT, false);
        self.s7200_save_permanent(offset, bytes);
    }
}
