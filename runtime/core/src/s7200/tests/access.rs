//! Analog words; operands that make no sense.

use plcc_abi::layout::{self, state};
use plcc_abi::s7200::{ANALOG_ADDRESS, Operation, system};

use super::{DONE, V, V_BYTES, cpu, run};

const AI: u32 = layout::SYSTEM + system::AI;
const AQ: u32 = layout::SYSTEM + system::AQ;

#[test]
fn a_block_from_analog_inputs_asks_the_modules() {
    let cpu = cpu();
    cpu.driver.set_input(ANALOG_ADDRESS + 2, 2, 0x1234);
    cpu.driver.set_input(ANALOG_ADDRESS + 4, 2, 0x5678);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[AI + 2, V, 2, 2]), DONE);
    assert_eq!(cpu.memory.dword(V), 0x1234_5678);
    // A word is not requested if nothing reads it.
    cpu.driver.set_input(ANALOG_ADDRESS + 6, 2, 7);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[AI + 2, V, 2, 2]), DONE);
    assert_eq!(cpu.memory.word(AI + 6), 0);
}

#[test]
fn a_block_to_analog_outputs_goes_to_the_modules() {
    let cpu = cpu();
    cpu.memory.set_dword(V, 0x1111_2222);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[V, AQ + 4, 2, 2]), DONE);
    assert_eq!(cpu.driver.output(ANALOG_ADDRESS + 4, 4), 0x1111_2222);
    assert_eq!(run(&cpu, Operation::Fill, &[0x3333, AQ + 62, 1]), DONE);
    assert_eq!(cpu.driver.output(ANALOG_ADDRESS + 62, 2), 0x3333);
    assert_eq!(cpu.driver.output(ANALOG_ADDRESS + 8, 2), 0);
}

#[test]
fn whole_words_go_out() {
    let cpu = cpu();
    cpu.memory.set_dword(AQ, 0x0102_0304);
    cpu.s7200_analog_out(1, 1);
    assert_eq!(cpu.driver.output(ANALOG_ADDRESS, 4), 0x0102_0000);
    cpu.s7200_analog_out(62, 100);
    cpu.s7200_analog_out(u32::MAX, u32::MAX);
}

#[test]
fn senseless_operands_do_no_harm() {
    let cpu = cpu();
    let bits = |address: u32| address.wrapping_mul(8);
    let operands = [
        0,
        1,
        255,
        0xFFFF,
        state::CPU,
        bits(state::CPU),
        V,
        V + V_BYTES - 1,
        V + V_BYTES,
        bits(V + V_BYTES - 1) + 7,
        layout::L - 1,
        layout::L + 63,
        layout::SYSTEM + system::TIMER_VALUES + 511,
        AQ + 63,
        layout::SCRATCH,
        0x8000_0000,
        u32::MAX,
    ];
    let last = Operation::SetClockExtended as usize;
    let own = cpu.memory.host64(state::CPU);
    for &operation in &Operation::ALL[..=last] {
        for a in operands {
            for b in operands {
                for c in [0, 1, 8, 0x73, 255, 256, 0xFFFF_FFFF] {
                    for d in [0, 1, 255, V, u32::MAX] {
                        run(&cpu, operation, &[a, b, c, d]);
                    }
                }
            }
        }
        assert_eq!(cpu.memory.host64(state::CPU), own, "{operation:?}");
        assert_eq!(cpu.memory.db(1), (V, V_BYTES), "{operation:?}");
        // The byte after V memory is of no area.
        assert_eq!(cpu.memory.byte(V + V_BYTES), 0, "{operation:?}");
    }
}
