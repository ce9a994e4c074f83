//! Block moves, FILL, SHRB.

use plcc_abi::layout;
use plcc_abi::s7200::{Operation, system};

use super::{DONE, FAILED, V, V_BYTES, cpu, load_v, run, special_bit, v_bytes};

#[test]
fn blocks_are_copied() {
    let cpu = cpu();
    load_v(&cpu, 0, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[V, V + 100, 1, 3]), DONE);
    assert_eq!(v_bytes(&cpu, 100, 4), [1, 2, 3, 0]);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[V, V + 200, 2, 3]), DONE);
    assert_eq!(v_bytes(&cpu, 200, 7), [1, 2, 3, 4, 5, 6, 0]);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[V, V + 300, 4, 3]), DONE);
    assert_eq!(v_bytes(&cpu, 300, 13), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0]);
    // Sides that overlap, both ways.
    assert_eq!(run(&cpu, Operation::CopyBlock, &[V, V + 1, 1, 4]), DONE);
    assert_eq!(v_bytes(&cpu, 0, 6), [1, 1, 2, 3, 4, 6]);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[V + 2, V, 1, 4]), DONE);
    assert_eq!(v_bytes(&cpu, 0, 6), [2, 3, 4, 6, 4, 6]);
}

#[test]
fn blocks_stay_in_their_areas() {
    let cpu = cpu();
    cpu.memory.set_byte(V, 7);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[V, V + V_BYTES - 255, 1, 255]), DONE);
    assert_eq!(cpu.memory.byte(V + V_BYTES - 255), 7);
    for operands in [
        [V, V + V_BYTES - 254, 1, 255],
        [V + V_BYTES - 254, V, 1, 255],
        [V, V + 100, 1, 0],
        [V, V + 100, 1, 256],
        [V, layout::M + 28, 4, 2],
        [V, layout::I + 16, 1, 1],
        [0, V, 4, 1],
        [V, u32::MAX, 4, 255],
        [u32::MAX, V, u32::MAX, u32::MAX],
    ] {
        assert_eq!(run(&cpu, Operation::CopyBlock, &operands), FAILED, "{operands:?}");
    }
    assert_eq!(cpu.memory.byte(V + 100), 0);
    // BMW with current values of timers and counters.
    let counters = layout::SYSTEM + system::COUNTER_VALUES;
    cpu.memory.set_word(counters + 2 * 255, 0x1234);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[counters + 2 * 254, V, 2, 2]), DONE);
    assert_eq!(cpu.memory.dword(V), 0x1234);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[counters + 2 * 254, V, 2, 3]), FAILED);
}

#[test]
fn words_are_filled() {
    let cpu = cpu();
    assert_eq!(run(&cpu, Operation::Fill, &[0xFFFF_ABCD, V + 1, 3]), DONE);
    assert_eq!(v_bytes(&cpu, 0, 8), [0, 0xAB, 0xCD, 0xAB, 0xCD, 0xAB, 0xCD, 0]);
    assert_eq!(run(&cpu, Operation::Fill, &[1, V + V_BYTES - 510, 255]), DONE);
    assert_eq!(cpu.memory.word(V + V_BYTES - 2), 1);
    assert_eq!(run(&cpu, Operation::Fill, &[2, V + V_BYTES - 509, 255]), FAILED);
    assert_eq!(run(&cpu, Operation::Fill, &[2, V, 0]), FAILED);
    assert_eq!(run(&cpu, Operation::Fill, &[2, V, 256]), FAILED);
    assert_eq!(cpu.memory.byte(V), 0);
}

/// SHRB with data, byte and bit of V memory, count.
fn shift(cpu: &crate::cpu::Cpu, data: u32, byte: u32, bit: u32, count: i32) -> u64 {
    run(cpu, Operation::ShiftRegister, &[data, 8 * (V + byte) + bit, count as u32])
}

#[test]
fn a_register_shifts_up() {
    let cpu = cpu();
    // The example of the manual: SHRB I0.2, V100.0, +4 with V100 = xxxx0101.
    load_v(&cpu, 100, &[0xF5]);
    assert_eq!(shift(&cpu, 1, 100, 0, 4), DONE);
    assert_eq!((v_bytes(&cpu, 100, 1), special_bit(&cpu, 1, 1)), (vec![0xFB], false));
    assert_eq!(shift(&cpu, 0, 100, 0, 4), DONE);
    assert_eq!((v_bytes(&cpu, 100, 1), special_bit(&cpu, 1, 1)), (vec![0xF6], true));
    // V33.4 with 14 bits ends at V35.1.
    load_v(&cpu, 33, &[0x0F, 0x80, 0xFD]);
    assert_eq!(shift(&cpu, 1, 33, 4, 14), DONE);
    assert_eq!((v_bytes(&cpu, 33, 3), special_bit(&cpu, 1, 1)), (vec![0x1F, 0x00, 0xFF], false));
}

#[test]
fn a_register_shifts_down() {
    let cpu = cpu();
    load_v(&cpu, 33, &[0x1F, 0x01, 0xFC]);
    assert_eq!(shift(&cpu, 1, 33, 4, -14), DONE);
    assert_eq!((v_bytes(&cpu, 33, 3), special_bit(&cpu, 1, 1)), (vec![0x8F, 0x00, 0xFE], true));
    // 64 bits that do not begin with a byte.
    load_v(&cpu, 200, &[0x0F, 0, 0, 0, 0, 0, 0, 0, 0xF0]);
    assert_eq!(shift(&cpu, 1, 200, 4, -64), DONE);
    assert_eq!(v_bytes(&cpu, 200, 9), [0x0F, 0, 0, 0, 0, 0, 0, 0, 0xF8]);
    assert!(!special_bit(&cpu, 1, 1));
    assert_eq!(shift(&cpu, 0, 200, 4, 64), DONE);
    assert_eq!(v_bytes(&cpu, 200, 9), [0x0F, 0, 0, 0, 0, 0, 0, 0, 0xF0]);
    assert!(special_bit(&cpu, 1, 1));
    // A register of one bit.
    assert_eq!(shift(&cpu, 1, 300, 7, -1), DONE);
    assert_eq!(v_bytes(&cpu, 300, 2), [0x80, 0]);
}

#[test]
fn a_register_has_64_bits_at_most() {
    let cpu = cpu();
    for count in [0, 65, -65, 127, i32::MIN, i32::MAX] {
        assert_eq!(shift(&cpu, 1, 0, 0, count), FAILED, "{count}");
    }
    assert_eq!(shift(&cpu, 1, V_BYTES - 8, 0, 64), DONE);
    assert_eq!(shift(&cpu, 1, V_BYTES - 8, 1, 64), FAILED);
    assert_eq!(shift(&cpu, 1, V_BYTES - 8, 0, 64), DONE);
    assert_eq!(cpu.memory.byte(V + V_BYTES - 8), 3);
}

#[test]
fn bits_of_counters_make_a_register() {
    let cpu = cpu();
    let bits = layout::SYSTEM + system::COUNTER_BITS;
    assert_eq!(run(&cpu, Operation::ShiftRegister, &[1, 8 * (bits + 253), 3]), DONE);
    assert_eq!(run(&cpu, Operation::ShiftRegister, &[0, 8 * (bits + 253), 3]), DONE);
    assert_eq!(cpu.memory.bytes::<3>(bits + 253), [0, 1, 0]);
    assert_eq!(run(&cpu, Operation::ShiftRegister, &[0, 8 * (bits + 253), 4]), FAILED);
}
