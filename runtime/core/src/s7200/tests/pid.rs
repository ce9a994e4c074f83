//! The PID instruction.

use plcc_abi::s7200::Operation;

use super::{DONE, FAILED, V, V_BYTES, cpu, run, special_bit};
use crate::cpu::Cpu;

/// PV, SP, output, gain, Ts, Ti, Td, bias, last PV.
fn put(cpu: &Cpu, table: [f32; 9]) {
    (0u32..).zip(table).for_each(|(index, value)| cpu.memory.set_dword(V + 4 * index, value.to_bits()));
}

fn field(cpu: &Cpu, offset: u32) -> f32 {
    f32::from_bits(cpu.memory.dword(V + offset))
}

/// Output, bias, last process variable.
fn results(cpu: &Cpu) -> [f32; 3] {
    [8, 28, 32].map(|offset| field(cpu, offset))
}

fn execute(cpu: &Cpu, enable: u32) -> u64 {
    run(cpu, Operation::Pid, &[V, 0, enable])
}

#[test]
fn three_terms() {
    let cpu = cpu();
    // e = 0.25; MP = 0.5; MI = 2 × (6 / 60) × 0.25 + 0.0625; MD = 2 × (3 / 6) × (0.5625 - 0.5).
    put(&cpu, [0.5, 0.75, 0.0, 2.0, 6.0, 1.0, 0.05, 0.0625, 0.5625]);
    assert_eq!(execute(&cpu, 1), DONE);
    let [output, bias, last] = results(&cpu);
    assert!((output - 0.675).abs() < 1e-6, "{output}");
    assert!((bias - 0.1125).abs() < 1e-6, "{bias}");
    assert_eq!(last, 0.5);
    assert_eq!(field(&cpu, 4), 0.75);
    assert!(!special_bit(&cpu, 1, 1));
}

#[test]
fn output_and_bias_are_limited() {
    let cpu = cpu();
    // MP = 4 × 0.25, no derivative: Mn = 1 + MI, the bias becomes 1 - MP.
    put(&cpu, [0.5, 0.75, 0.0, 4.0, 1.0, 1.0, 0.0, 0.5, 0.5]);
    assert_eq!(execute(&cpu, 1), DONE);
    assert_eq!(results(&cpu), [1.0, 0.0, 0.5]);
    // MP = 2 × -0.25: the bias becomes 0.5.
    put(&cpu, [0.75, 0.5, 0.0, 2.0, 60.0, 1.0, 0.0, 0.5, 0.75]);
    assert_eq!(execute(&cpu, 1), DONE);
    assert_eq!(results(&cpu), [0.0, 0.5, 0.75]);
    // MP = 8 × -0.25: the bias would be 2.
    put(&cpu, [0.75, 0.5, 0.0, 8.0, 60.0, 1.0, 0.0, 0.5, 0.75]);
    assert_eq!(execute(&cpu, 1), DONE);
    assert_eq!(results(&cpu), [0.0, 1.0, 0.75]);
}

#[test]
fn without_integral_or_gain() {
    let cpu = cpu();
    put(&cpu, [0.5, 0.75, 0.0, 1.0, 1.0, f32::INFINITY, 0.0, 0.25, 0.5]);
    assert_eq!(execute(&cpu, 1), DONE);
    assert_eq!(results(&cpu), [0.5, 0.25, 0.5]);
    // Gain 0: the integral term has gain 1. 60 / 120 × 0.25 + 0.25.
    put(&cpu, [0.5, 0.75, 0.0, 0.0, 60.0, 2.0, 0.0, 0.25, 0.5]);
    assert_eq!(execute(&cpu, 1), DONE);
    assert_eq!(results(&cpu), [0.375, 0.375, 0.5]);
}

#[test]
fn the_change_to_automatic_is_bumpless() {
    let cpu = cpu();
    let table = [0.5, 0.75, 0.25, 1.0, 1.0, 1.0, 0.0, 0.0, 0.125];
    // In the first scan the loop continues as if it had run.
    put(&cpu, table);
    assert_eq!(execute(&cpu, 1), DONE);
    assert_eq!(field(&cpu, 4), 0.75);
    put(&cpu, table);
    assert_eq!(execute(&cpu, 0), FAILED);
    assert_eq!(results(&cpu), [0.25, 0.0, 0.125]);
    assert_eq!(execute(&cpu, 1), DONE);
    assert_eq!(field(&cpu, 4), 0.5);
    assert_eq!(results(&cpu), [0.25, 0.25, 0.5]);
    // Then the setpoint counts again.
    cpu.memory.set_dword(V + 4, 0.75f32.to_bits());
    assert_eq!(execute(&cpu, 1), DONE);
    assert_eq!(field(&cpu, 4), 0.75);
    // Other loops have their own history.
    assert_eq!(run(&cpu, Operation::Pid, &[V, 7, 0]), FAILED);
    assert_eq!(execute(&cpu, 1), DONE);
    assert_eq!(field(&cpu, 4), 0.75);
}

#[test]
fn faults() {
    let cpu = cpu();
    for table in [
        [f32::NAN, 0.75, 0.125, 1.0, 1.0, 1.0, 0.0, 0.25, 0.5],
        [0.5, 0.75, 0.125, f32::INFINITY, 1.0, 1.0, 0.0, 0.25, 0.5],
        [0.5, 0.75, 0.125, 1.0, 0.0, 1.0, 0.0, 0.25, 0.5],
        [0.5, 0.75, 0.125, 1.0, 1.0, 0.0, 0.0, 0.25, 0.5],
    ] {
        put(&cpu, table);
        assert_eq!(execute(&cpu, 1), FAILED);
        assert_eq!(results(&cpu), [0.125, 0.25, 0.5]);
        assert!(special_bit(&cpu, 1, 1));
    }
    put(&cpu, [0.5, 0.5, 0.0, 1.0, 1.0, 1.0, 0.0, 0.25, 0.5]);
    assert_eq!(execute(&cpu, 1), DONE);
    assert!(!special_bit(&cpu, 1, 1));
    assert_eq!(run(&cpu, Operation::Pid, &[V, 8, 1]), FAILED);
    assert_eq!(run(&cpu, Operation::Pid, &[V, u32::MAX, 0]), FAILED);
    assert_eq!(run(&cpu, Operation::Pid, &[V + V_BYTES - 35, 0, 1]), FAILED);
}
