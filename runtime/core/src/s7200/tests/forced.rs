//! Forced values. Source: S7-200 system manual, forcing values.

use plcc_abi::layout;
use plcc_abi::s7200::Operation;

use super::{DONE, V, cpu, run, special_bit};
use crate::cpu::Cpu;
use crate::cycle::{Observer, Pace};

/// The program, which writes Q0.0 to Q0.3, VW10 and MB2 in each scan; it keeps what it has found there.
#[derive(Default)]
struct Program(Vec<[u32; 4]>);

impl Observer for Program {
    fn before(&mut self, _: &Cpu, _: u64, _: u64) {}

    fn begin(&mut self, cpu: &Cpu, _: u64) {
        let memory = &cpu.memory;
        let byte = |offset: u32| u32::from(memory.byte(offset));
        self.0.push([byte(layout::I), byte(layout::Q), u32::from(memory.word(V + 10)), byte(layout::M + 2)]);
        memory.set_byte(layout::Q, 0x0F);
        memory.set_word(V + 10, 0xAAAA);
        memory.set_byte(layout::M + 2, 0);
        cpu.note_outputs(u32::MAX);
    }

    fn after(&mut self, _: &Cpu, _: u64, _: u64) {}
}

#[test]
fn inputs_outputs_and_memory_are_forced() {
    let cpu = cpu();
    cpu.driver.set_input(0, 1, 0b1000_0001);
    for (name, value) in
        [("I0.0", "0"), ("I0.1", "1"), ("Q0.1", "0"), ("Q0.7", "1"), ("VW10", "16#1234"), ("M2.5", "1")]
    {
        assert_eq!(cpu.force(name, value), Ok(()), "{name}");
    }
    let mut program = Program::default();
    cpu.execute(&Pace { cycles: Some(2), cycle_time: 1_000_000, hang_limit: u64::MAX / 4 }, &mut program);
    // The image of outputs keeps what the program has written.
    assert_eq!(program.0, [[0x82, 0, 0x1234, 0x20], [0x82, 0x0F, 0x1234, 0x20]]);
    assert_eq!((cpu.memory.word(V + 10), cpu.memory.byte(layout::M + 2)), (0x1234, 0x20), "after the program");
    assert_eq!(cpu.driver.output(0, 1), 0x8D);
    assert!(special_bit(&cpu, 4, 7), "SM4.7");
    // RI Q0.6, 2 and SI Q0.1, 1.
    assert_eq!(run(&cpu, Operation::WriteOutputsNow, &[6, 2, 0]), DONE);
    assert_eq!(run(&cpu, Operation::WriteOutputsNow, &[1, 1, 1]), DONE);
    assert_eq!(cpu.driver.output(0, 1), 0x8D);
    assert_eq!(cpu.peripheral_read(0, 1), 0x82, "immediate reading");
    assert_eq!(cpu.unforce(None), Ok(()));
    assert!(!special_bit(&cpu, 4, 7));
}

#[test]
fn sixteen_values_of_memory_are_forced() {
    let cpu = cpu();
    for byte in 0..16 {
        assert_eq!(cpu.force(&format!("VB{byte}"), "1"), Ok(()));
    }
    assert!(cpu.force("MB0", "1").unwrap_err().contains("16 values of M and V"));
    assert_eq!(cpu.force("Q0.0", "1"), Ok(()), "any number of outputs");
    assert!(cpu.force("T33", "1").is_err());
    assert!(cpu.force("AIW0", "1").unwrap_err().contains("forces I, Q, M and V"));
}
