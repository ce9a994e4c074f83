//! Pointers at run time.

use plcc_abi::layout;
use plcc_abi::s7200::{V_DB, pointer, system};

use super::access;
use crate::cpu::Cpu;

/// Bytes of special memory that the program only reads, SMB0 to SMB29. Source: S7-200 system manual, special memory.
const SPECIAL_READ_ONLY: u32 = 30;

impl Cpu {
    /// See [`RuntimeFn::S7200Pointer`](plcc_abi::RuntimeFn::S7200Pointer).
    ///
    /// Areas of words (T, C, AI, AQ) can be accessed only as a word at an even offset. Analog inputs and SMB0 to SMB29
    /// are not written. A 21x has no pointers to SM, AI and AQ. Source: S7-200 system manual, indirect addressing.
    pub(crate) fn s7200_pointer(&self, pointer: u32, bytes: u32, write: bool) -> u32 {
        let Some(own) = self.s7200() else { return 0 };
        let (cpu, profile) = (&own.image.cpu, &self.image.profile);
        let (tag, offset) = ((pointer >> 24) as u8, pointer & 0x00FF_FFFF);
        let analog_bytes = cpu.analog_bytes.min(system::ANALOG_BYTES);
        let (v, v_bytes) = self.memory.db(V_DB);
        let (start, length, words_only) = match tag {
            pointer::I => (layout::I, profile.inputs, false),
            pointer::Q => (layout::Q, profile.outputs, false),
            pointer::M => (layout::M, profile.bit_memory, false),
            pointer::SM if !cpu.old && (!write || offset >= SPECIAL_READ_ONLY) => {
                (layout::SYSTEM + system::SM, cpu.sm_bytes, false)
            }
            pointer::AI if !cpu.old && !write => (layout::SYSTEM + system::AI, analog_bytes, true),
            pointer::AQ if !cpu.old => (layout::SYSTEM + system::AQ, analog_bytes, true),
            pointer::V => (v, v_bytes, false),
            pointer::S => (layout::SYSTEM + system::S, cpu.s_bytes, false),
            pointer::T => {
                (layout::SYSTEM + system::TIMER_VALUES, 2 * profile.timers.min(plcc_abi::s7200::TIMERS), true)
            }
            pointer::C => {
                (layout::SYSTEM + system::COUNTER_VALUES, 2 * profile.counters.min(plcc_abi::s7200::COUNTERS), true)
            }
            pointer::CONSTANT if !write => {
                let (start, length) = self.memory.db(plcc_abi::s7200::CONSTANTS_DB);
                (start, length, false)
            }
            _ => return 0,
        };
        let inside = offset.checked_add(bytes.max(1)).is_some_and(|end| end <= length);
        if !inside || words_only && (bytes != 2 || offset % 2 != 0) {
            return 0;
        }
        if write && matches!(tag, pointer::SM | pointer::AQ) {
            self.s7200_look_always();
        }
        access::before(self, start + offset, bytes);
        start + offset
    }
}
