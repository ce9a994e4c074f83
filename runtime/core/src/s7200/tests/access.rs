//! Analog words.

use plcc_abi::layout;
use plcc_abi::s7200::{ANALOG_ADDRESS, Operation, system};

use super::{DONE, V, cpu, run};

const AI: u32 = layout::SYSTEM + system::AI;
const AQ: u32 = layout::SYSTEM + system::AQ;

#[test]
fn a_block_from_analog_inputs_asks_the_modules() {
    let cpu = cpu();
    cpu.driver.set_input(ANALOG_ADDRESS + 2, 2, 0x1234);
    cpu.driver.set_input(ANALOG_ADDRESS + 4, 2, 0x5678);
    assert_eq!(run(&cpu, Operation::CopyBlock, &[AI + 2, V, 2, 2]), DONE);
    assert_eq!(cpu.memory.dword(V), 0x1234_5678);
    // A word that nobody reads is not asked for.
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
