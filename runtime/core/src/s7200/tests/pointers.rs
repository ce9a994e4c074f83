//! Pointers.

use plcc_abi::layout;
use plcc_abi::s7200::{ANALOG_ADDRESS, pointer, system};

use super::{V, V_BYTES, changed_cpu, cpu};

const SYSTEM: u32 = layout::SYSTEM;

/// A pointer to byte `offset` of an area.
fn to(tag: u8, offset: u32) -> u32 {
    u32::from(tag) << 24 | offset
}

#[test]
fn pointers_lead_into_their_areas() {
    let cpu = cpu();
    for (tag, start, length) in [
        (pointer::I, layout::I, 16),
        (pointer::Q, layout::Q, 16),
        (pointer::M, layout::M, 32),
        (pointer::V, V, V_BYTES),
        (pointer::S, SYSTEM + system::S, 32),
        (pointer::SM, SYSTEM + system::SM, 550),
    ] {
        for bytes in [1, 2, 4] {
            for write in [false, true] {
                // Any byte, also an odd one.
                assert_eq!(cpu.s7200_pointer(to(tag, length - bytes), bytes, write), start + length - bytes, "{tag}");
                assert_eq!(cpu.s7200_pointer(to(tag, length - bytes + 1), bytes, write), 0, "{tag}");
                assert_eq!(cpu.s7200_pointer(to(tag, 0xFF_FFFF), bytes, write), 0, "{tag}");
            }
            assert_eq!(cpu.s7200_pointer(to(tag, 3), bytes, false), start + 3, "{tag}");
        }
    }
    for tag in [0, 7, 0x0C, 0x80, 0x84, 0xFF] {
        assert_eq!(cpu.s7200_pointer(to(tag, 0), 1, false), 0, "{tag}");
    }
}

#[test]
fn words_of_timers_and_counters() {
    let cpu = cpu();
    for (tag, start) in [(pointer::T, SYSTEM + system::TIMER_VALUES), (pointer::C, SYSTEM + system::COUNTER_VALUES)] {
        assert_eq!(cpu.s7200_pointer(to(tag, 2 * 37), 2, false), start + 2 * 37);
        assert_eq!(cpu.s7200_pointer(to(tag, 2 * 255), 2, true), start + 2 * 255);
        assert_eq!(cpu.s7200_pointer(to(tag, 2 * 256), 2, false), 0);
        assert_eq!(cpu.s7200_pointer(to(tag, 1), 2, false), 0);
        assert_eq!(cpu.s7200_pointer(to(tag, 0), 1, false), 0);
        assert_eq!(cpu.s7200_pointer(to(tag, 0), 4, false), 0);
    }
}

#[test]
fn special_memory_below_30_is_only_read() {
    let cpu = cpu();
    assert_eq!(cpu.s7200_pointer(to(pointer::SM, 29), 1, false), SYSTEM + 29);
    assert_eq!(cpu.s7200_pointer(to(pointer::SM, 29), 1, true), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::SM, 28), 4, true), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::SM, 30), 1, true), SYSTEM + 30);
}

#[test]
fn analog_words() {
    let cpu = cpu();
    cpu.driver.set_input(ANALOG_ADDRESS + 62, 2, 0x0FA0);
    let address = cpu.s7200_pointer(to(pointer::AI, 62), 2, false);
    assert_eq!(address, SYSTEM + system::AI + 62);
    assert_eq!(cpu.memory.word(address), 0x0FA0);
    cpu.driver.set_input(ANALOG_ADDRESS + 62, 2, 0x0FA8);
    cpu.s7200_pointer(to(pointer::AI, 62), 2, false);
    assert_eq!(cpu.memory.word(address), 0x0FA8);
    assert_eq!(cpu.s7200_pointer(to(pointer::AI, 62), 2, true), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::AI, 61), 2, false), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::AI, 64), 2, false), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::AI, 60), 4, false), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::AQ, 4), 2, true), SYSTEM + system::AQ + 4);
    assert_eq!(cpu.s7200_pointer(to(pointer::AQ, 4), 1, true), 0);
}

#[test]
fn a_cpu_214_has_less() {
    let cpu = changed_cpu(|image| {
        image.profile.timers = 128;
        let Some(own) = &mut image.s7200 else { return };
        own.cpu.old = true;
        own.cpu.s_bytes = 16;
    });
    assert_eq!(cpu.s7200_pointer(to(pointer::SM, 40), 1, false), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::AI, 0), 2, false), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::AQ, 0), 2, true), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::S, 15), 2, false), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::T, 2 * 128), 2, false), 0);
    assert_eq!(cpu.s7200_pointer(to(pointer::T, 2 * 127), 2, false), SYSTEM + system::TIMER_VALUES + 2 * 127);
    assert_eq!(cpu.s7200_pointer(to(pointer::V, 0), 1, true), V);
}
