//! Tests of the S7-200: a CPU 226 whose operations are called as generated code calls them.

mod access;
mod bits;
mod blocks;
mod calendar;
mod forced;
mod pid;
mod pointers;
mod strings;
mod tables;
mod text;

use std::rc::Rc;

use plcc_abi::ProgramImage;
use plcc_abi::image::{DbEntry, Family};
use plcc_abi::layout;
use plcc_abi::s7200::image::CpuRow;
use plcc_abi::s7200::{Operation, S7200Image, V_DB, result, system};

use super::Operands;
use crate::cpu::Cpu;
use crate::tests::cpu_with;

/// Where V memory begins.
pub const V: u32 = layout::DB_DATA;
pub const V_BYTES: u32 = 10_240;

/// It ran without error and without a value.
pub const DONE: u64 = result::ENO;
/// It failed.
pub const FAILED: u64 = 0;

/// It ran without error and returns a value.
pub fn gives(value: u32) -> u64 {
    u64::from(value) << 32 | result::ENO | result::VALUE
}

/// Ranges of a CPU 226.
pub fn cpu_226() -> CpuRow {
    CpuRow {
        old: false,
        v_bytes: V_BYTES,
        sm_bytes: 550,
        s_bytes: 32,
        analog_bytes: 64,
        high_speed_counters: 0b11_1111,
        ports: 2,
        pulse_outputs: 2,
        pid_loops: 8,
        subroutines: 128,
        interrupts: 128,
        labels: 256,
        events: 0x3_FFFF_FFFF,
        queues: [8, 16, 8],
        watchdog_ms: 500,
        id: 9,
        inputs: 24,
        outputs: 16,
    }
}

/// A CPU 226 with V memory of zeros, and without blocks.
pub fn cpu() -> Rc<Cpu> {
    changed_cpu(|_| {})
}

pub fn changed_cpu(change: impl FnOnce(&mut ProgramImage)) -> Rc<Cpu> {
    cpu_with(Vec::new(), |image| {
        image.profile.name = "s7-200".to_string();
        image.profile.family = Family::S7200;
        image.profile.inputs = 16;
        image.profile.outputs = 16;
        image.profile.bit_memory = 32;
        image.profile.timers = 256;
        image.profile.counters = 256;
        image.profile.local_data = 64;
        image.profile.db_bytes_max = V_BYTES;
        image.profile.block_depth = 8;
        image.dbs.push(DbEntry {
            number: V_DB,
            name: String::new(),
            address: V,
            data: vec![0; V_BYTES as usize],
            read_only: false,
            unlinked: false,
            optimized: false,
            kept: Default::default(),
            ty: None,
        });
        image.db_end = V + V_BYTES;
        image.s7200 = Some(S7200Image { cpu: cpu_226(), ..S7200Image::default() });
        change(image);
    })
}

/// Runs an operation with up to four operands.
pub fn run(cpu: &Cpu, operation: Operation, operands: &[u32]) -> u64 {
    let operand = |index: usize| operands.get(index).copied().unwrap_or(0);
    let operands = Operands { site: 0, a: operand(0), b: operand(1), c: operand(2), d: operand(3) };
    cpu.s7200_operation(operation as u32, &operands)
}

/// Bytes of V memory from `offset` on.
pub fn v_bytes(cpu: &Cpu, offset: u32, count: u32) -> Vec<u8> {
    (0..count).map(|index| cpu.memory.byte(V + offset + index)).collect()
}

pub fn load_v(cpu: &Cpu, offset: u32, bytes: &[u8]) {
    cpu.memory.load(V + offset, bytes);
}

/// Puts a string with its length.
pub fn put_string(cpu: &Cpu, offset: u32, text: &str) {
    cpu.memory.set_byte(V + offset, text.len() as u8);
    load_v(cpu, offset + 1, text.as_bytes());
}

/// The string at `offset`.
pub fn string(cpu: &Cpu, offset: u32) -> String {
    let length = cpu.memory.byte(V + offset);
    String::from_utf8(v_bytes(cpu, offset + 1, length.into())).unwrap()
}

/// A bit of special memory.
pub fn special_bit(cpu: &Cpu, byte: u32, bit: u8) -> bool {
    cpu.memory.bit(layout::SYSTEM + system::SM + byte, bit)
}
