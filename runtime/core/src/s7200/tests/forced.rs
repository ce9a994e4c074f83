//! Forced values. Source: S7-200 system manual, forcing values.

use plcc_abi::layout;
use plcc_abi::s7200::{ANALOG_ADDRESS, Operation, system};

use super::{DONE, V, cpu, run, special_bit};
use crate::address::{self, Address};
use crate::cpu::Cpu;
use crate::cycle::{Observer, Pace};
use crate::s7200::access::{after_write, before};

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

fn resolve(cpu: &Cpu, name: &str) -> Address {
    address::resolve(name, &cpu.image).unwrap_or_else(|error| panic!("{name}: {error}"))
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
    for name in ["MB0", "AIW0", "AQW2"] {
        assert!(cpu.force(name, "1").unwrap_err().contains("16 values of M, V, AI and AQ"), "{name}");
    }
    assert_eq!(cpu.force("Q0.0", "1"), Ok(()), "any number of outputs");
    assert!(cpu.force("T33", "1").is_err());
    assert!(cpu.force("SMB28", "1").unwrap_err().contains("forces I, Q, M, V, AI and AQ"));
}

/// The program reads AIW4 directly and through a pointer, and writes AQW0 directly and AQW2 through a pointer; nothing writes AQW4.
#[test]
fn analog_words_are_forced() {
    let cpu = cpu();
    cpu.driver.set_input(ANALOG_ADDRESS + 4, 2, 111);
    for (name, value) in [("AIW4", "16#3E80"), ("AQW0", "16#01F4"), ("AQW2", "16#0258"), ("AQW4", "16#02BC")] {
        assert_eq!(cpu.force(name, value), Ok(()), "{name}");
    }
    assert!(cpu.force("AIW5", "1").is_err(), "words have even addresses");
    let scan = |value: u16| {
        assert_eq!(cpu.peripheral_read(ANALOG_ADDRESS + 4, 2), u64::from(cpu.read(&resolve(&cpu, "AIW4")) as u16));
        before(&cpu, layout::SYSTEM + system::AI + 4, 2);
        assert!(!cpu.peripheral_write(ANALOG_ADDRESS, 2, value.into()));
        cpu.memory.set_word(layout::SYSTEM + system::AQ + 2, value);
        after_write(&cpu, layout::SYSTEM + system::AQ + 2, 2);
        cpu.write_outputs();
        let modules = [0, 2, 4].map(|byte| cpu.driver.output(ANALOG_ADDRESS + byte, 2));
        (cpu.memory.word(layout::SYSTEM + system::AI + 4), modules)
    };
    let copies = || [0, 2, 4].map(|byte| cpu.memory.word(layout::SYSTEM + system::AQ + byte));
    assert_eq!(scan(42), (16_000, [500, 600, 700]));
    assert_eq!(copies(), [42, 42, 0], "what the program has written");
    assert_eq!(cpu.unforce(Some("AQW0")), Ok(()));
    assert_eq!(cpu.driver.output(ANALOG_ADDRESS, 2), 42, "at once, for the program may write it once only");
    assert_eq!(cpu.unforce(None), Ok(()));
    assert_eq!(scan(43), (111, [43, 43, 0]));
}
