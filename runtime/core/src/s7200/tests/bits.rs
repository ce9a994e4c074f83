//! S, R, SI, RI.

use plcc_abi::layout;
use plcc_abi::s7200::{Operation, system};

use super::{DONE, FAILED, V, V_BYTES, cpu, run, v_bytes};

const SYSTEM: u32 = layout::SYSTEM;

#[test]
fn bits_are_set_and_reset() {
    let cpu = cpu();
    // S V100.3, 18: V100.3 to V102.4.
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (V + 100) + 3, 18, 1]), DONE);
    assert_eq!(v_bytes(&cpu, 99, 5), [0, 0xF8, 0xFF, 0x1F, 0]);
    // R V100.4, 2.
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (V + 100) + 4, 2, 0]), DONE);
    assert_eq!(v_bytes(&cpu, 100, 1), [0xC8]);
    // A run that ends with its byte, and one of a whole byte.
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (V + 200) + 6, 2, 1]), DONE);
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (V + 201), 8, 1]), DONE);
    assert_eq!(v_bytes(&cpu, 200, 3), [0xC0, 0xFF, 0]);
    // 255 bits: 31 bytes and 7 bits.
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (V + 300), 255, 1]), DONE);
    assert_eq!(v_bytes(&cpu, 300, 31), [0xFF; 31]);
    assert_eq!(v_bytes(&cpu, 331, 2), [0x7F, 0]);
}

#[test]
fn a_run_stays_in_its_area() {
    let cpu = cpu();
    let last = 8 * (V + V_BYTES - 1);
    assert_eq!(run(&cpu, Operation::WriteBits, &[last + 4, 4, 1]), DONE);
    assert_eq!(run(&cpu, Operation::WriteBits, &[last, 9, 1]), FAILED);
    assert_eq!(run(&cpu, Operation::WriteBits, &[last, 0, 1]), FAILED);
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * V, 256, 1]), FAILED);
    assert_eq!(cpu.memory.byte(V + V_BYTES - 1), 0xF0);
    // M ends with M31.7, though there is memory after it.
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (layout::M + 31) + 7, 1, 1]), DONE);
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (layout::M + 31) + 7, 2, 1]), FAILED);
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (SYSTEM + system::S + 31), 8, 1]), DONE);
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (SYSTEM + system::S + 31), 9, 1]), FAILED);
    // Local data: 64 bytes a block.
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (layout::L + 64 + 63), 8, 1]), DONE);
    assert_eq!(run(&cpu, Operation::WriteBits, &[8 * (layout::L + 64 + 63), 9, 1]), FAILED);
    assert_eq!(run(&cpu, Operation::WriteBits, &[u32::MAX, u32::MAX, 1]), FAILED);
}

#[test]
fn immediate_outputs_are_written_to_image_and_module() {
    let cpu = cpu();
    // SI Q0.6, 4.
    assert_eq!(run(&cpu, Operation::WriteOutputsNow, &[6, 4, 1]), DONE);
    assert_eq!(cpu.memory.word(layout::Q), 0xC003);
    assert_eq!(cpu.driver.output(0, 2), 0xC003);
    // RI Q0.7, 2. The image has a bit more than the module.
    cpu.memory.set_bit(layout::Q, 0, true);
    assert_eq!(run(&cpu, Operation::WriteOutputsNow, &[7, 2, 0]), DONE);
    assert_eq!(cpu.memory.word(layout::Q), 0x4102);
    assert_eq!(cpu.driver.output(0, 2), 0x4002);
    for (first, count) in [(0, 0), (0, 129), (127, 2), (128, 1), (u32::MAX, 1)] {
        assert_eq!(run(&cpu, Operation::WriteOutputsNow, &[first, count, 1]), FAILED, "{first} {count}");
    }
    assert_eq!(run(&cpu, Operation::WriteOutputsNow, &[0, 128, 1]), DONE);
    assert_eq!(cpu.driver.output(12, 4), u32::MAX);
}

#[test]
fn timers_are_reset_with_their_values() {
    let cpu = cpu();
    let memory = &cpu.memory;
    for number in 36..40 {
        memory.set_word(SYSTEM + system::TIMER_VALUES + 2 * number, 500);
        memory.set_byte(SYSTEM + system::TIMER_BITS + number, 1);
        memory.set_byte(SYSTEM + system::TIMER_INPUTS + number, 1);
    }
    assert_eq!(run(&cpu, Operation::ResetTimers, &[37, 2]), DONE);
    let state = |number: u32| {
        let value = memory.word(SYSTEM + system::TIMER_VALUES + 2 * number);
        (value, memory.byte(SYSTEM + system::TIMER_BITS + number), memory.byte(SYSTEM + system::TIMER_INPUTS + number))
    };
    assert_eq!([36, 37, 38, 39].map(state), [(500, 1, 1), (0, 0, 0), (0, 0, 0), (500, 1, 1)]);
    assert_eq!(run(&cpu, Operation::SetTimers, &[38, 1]), DONE);
    assert_eq!(state(38), (0, 1, 0));
    for operation in [Operation::ResetTimers, Operation::SetTimers, Operation::ResetCounters, Operation::SetCounters] {
        for (first, count) in [(255, 2), (0, 0), (0, 256), (256, 1), (u32::MAX, 1)] {
            assert_eq!(run(&cpu, operation, &[first, count]), FAILED, "{first} {count}");
        }
        assert_eq!(run(&cpu, operation, &[1, 255]), DONE);
    }
}

#[test]
fn counters_are_reset_with_their_values() {
    let cpu = cpu();
    let memory = &cpu.memory;
    memory.set_word(SYSTEM + system::COUNTER_VALUES + 2 * 255, 9);
    assert_eq!(run(&cpu, Operation::SetCounters, &[254, 2]), DONE);
    assert_eq!(memory.byte(SYSTEM + system::COUNTER_BITS + 253), 0);
    assert_eq!(memory.byte(SYSTEM + system::COUNTER_BITS + 254), 1);
    assert_eq!(memory.word(SYSTEM + system::COUNTER_VALUES + 2 * 255), 9);
    assert_eq!(run(&cpu, Operation::ResetCounters, &[255, 1]), DONE);
    assert_eq!(memory.word(SYSTEM + system::COUNTER_VALUES + 2 * 255), 0);
    assert_eq!(memory.byte(SYSTEM + system::COUNTER_BITS + 255), 0);
    assert_eq!(memory.byte(SYSTEM + system::COUNTER_BITS + 254), 1);
}
