//! Counters of a CPU: special memory, driver, scenario.

use std::rc::Rc;

use plcc_abi::layout;
use plcc_abi::s7200::{Operation, S7200Image};

use super::super::{Operands, special};
use super::cpu_226;
use crate::address;
use crate::cpu::Cpu;
use crate::cycle::Observer;
use crate::scenario::{Player, Scenario};
use crate::tests::cpu_with;

const MS: u64 = 1_000_000;

fn cpu() -> Rc<Cpu> {
    let cpu = cpu_with(Vec::new(), |image| {
        image.s7200 = Some(S7200Image { cpu: cpu_226(), ..S7200Image::default() });
    });
    cpu.s7200_start_counters();
    cpu.s7200_start_pulses();
    cpu
}

fn operation(cpu: &Cpu, operation: Operation, a: u32, b: u32) -> bool {
    let result = cpu.s7200_operation(operation as u32, &Operands { a, b, ..Operands::default() });
    result & plcc_abi::s7200::result::ENO != 0
}

fn set(cpu: &Cpu, name: &str, value: u64) {
    cpu.write(&address::parse(name).unwrap(), value).unwrap();
}

#[test]
fn set_up_by_the_manual() {
    // HSC1 in mode 4: clock I0.6, direction I0.7, reset I1.0.
    let cpu = cpu();
    assert!(!operation(&cpu, Operation::ControlCounter, 1, 0), "HSC before HDEF");
    assert_eq!(cpu.s7200_counter(1), 0);
    cpu.memory.set_byte(special(47), 0xF8);
    assert!(operation(&cpu, Operation::DefineCounter, 1, 4));
    assert!(!operation(&cpu, Operation::DefineCounter, 1, 4), "HDEF repeated");
    cpu.memory.set_dword(special(48), -100i32 as u32);
    cpu.memory.set_dword(special(52), 1000);
    assert!(operation(&cpu, Operation::ControlCounter, 1, 0));
    assert_eq!(cpu.s7200_counter(1) as i32, -100);
    assert_eq!(cpu.memory.byte(special(46)), 0x20);
    let text = r#"
[[at]]
cycle = 1
set = { "I0.7" = 1 }
pulses = { "I0.6" = { count = 1100, frequency = 10000 } }
[[at]]
cycle = 2
set = { "I0.7" = 0 }
pulses = { "HSC1" = { count = 300, frequency = 10000 } }
[[at]]
cycle = 3
set = { "I1.0" = 1 }
[[at]]
cycle = 4
pulses = { "HSC1" = { count = 1, frequency = 10, backward = true } }
"#;
    let scenario = Scenario::parse("s.toml", text, &cpu.image).unwrap();
    let mut player = Player::new(scenario, &cpu).unwrap();
    player.before(&cpu, 1, 0);
    cpu.clock.move_to(110 * MS - 1);
    assert_eq!(cpu.s7200_counter(1), 999);
    cpu.clock.move_to(110 * MS);
    assert_eq!(cpu.s7200_counter(1), 1000);
    assert_eq!(cpu.memory.byte(special(46)), 0x60);
    // The program sees the level of the pulse.
    cpu.read_inputs();
    assert_eq!(cpu.memory.byte(layout::I), 0xC0);
    player.before(&cpu, 2, 110 * MS);
    cpu.clock.move_to(120 * MS);
    assert_eq!(cpu.s7200_counter(1), 900);
    assert_eq!(cpu.memory.byte(special(46)), 0, "down, below the preset");
    cpu.clock.move_to(200 * MS);
    player.before(&cpu, 3, 200 * MS);
    assert_eq!(cpu.s7200_counter(1), 0);
    assert!(player.failures().is_empty());
    player.before(&cpu, 4, 210 * MS);
    assert_eq!(player.failures().len(), 1);
}

#[test]
fn levels_set_from_outside_count() {
    let cpu = cpu();
    cpu.memory.set_byte(special(37), 0xF8);
    assert!(operation(&cpu, Operation::DefineCounter, 0, 0));
    assert!(operation(&cpu, Operation::ControlCounter, 0, 0));
    for _ in 0..3 {
        set(&cpu, "I0.0", 1);
        cpu.s7200_poll_counters();
        set(&cpu, "I0.0", 0);
        cpu.s7200_poll_counters();
    }
    assert_eq!(cpu.s7200_counter(0), 3);
    assert!(cpu.s7200_counter_owns_input(0) && !cpu.s7200_counter_owns_input(1));
    cpu.s7200_start_counters();
    assert_eq!(cpu.s7200_counter(0), 0, "not defined in a new RUN");
    assert!(!cpu.s7200_counter_owns_input(0));
}

#[test]
fn another_input_of_the_byte_is_set() {
    let cpu = cpu();
    cpu.memory.set_byte(special(47), 0xF8);
    assert!(operation(&cpu, Operation::DefineCounter, 1, 0));
    assert!(operation(&cpu, Operation::ControlCounter, 1, 0));
    let text = r#"
[[at]]
cycle = 1
pulses = { "HSC1" = { count = 2, frequency = 1000 } }
[[at]]
cycle = 2
set = { "I0.0" = 1 }
"#;
    let scenario = Scenario::parse("s.toml", text, &cpu.image).unwrap();
    let mut player = Player::new(scenario, &cpu).unwrap();
    player.before(&cpu, 1, 0);
    cpu.clock.move_to(2 * MS);
    cpu.s7200_poll_counters();
    cpu.read_inputs();
    assert_eq!(cpu.memory.byte(layout::I), 0x40);
    cpu.clock.move_to(10 * MS);
    player.before(&cpu, 2, 10 * MS);
    cpu.read_inputs();
    assert_eq!((cpu.s7200_counter(1), cpu.memory.byte(layout::I)), (2, 1));
}

#[test]
fn pulses_wait_for_their_counter() {
    let cpu = cpu();
    let text = r#"
[[at]]
cycle = 1
pulses = { HSC2 = { count = 10, frequency = 1000, backward = true }, HSC4 = { count = 1, frequency = 1000 } }
"#;
    let scenario = Scenario::parse("s.toml", text, &cpu.image).unwrap();
    let mut player = Player::new(scenario, &cpu).unwrap();
    player.before(&cpu, 1, 0);
    assert_eq!(player.failures().len(), 2);
    // The program of the first scan.
    cpu.memory.set_byte(special(57), 0xF8);
    assert!(operation(&cpu, Operation::DefineCounter, 2, 9));
    assert!(operation(&cpu, Operation::ControlCounter, 2, 0));
    player.after(&cpu, 1, 0);
    cpu.clock.move_to(10 * MS);
    assert_eq!(cpu.s7200_counter(2) as i32, -40);
    assert_eq!(cpu.memory.byte(special(56)), 0);
    let failures: Vec<_> = player.failures().into_iter().map(|failure| (failure.line, failure.text)).collect();
    assert_eq!(failures, [(4, "pulses at HSC4".to_string())]);
}

#[test]
fn pulses_that_cannot_be() {
    let cpu = cpu();
    let message = |pulses: &str| {
        let text = format!("[[at]]\ncycle = 1\npulses = {{ {pulses} }}\n");
        Scenario::parse("s.toml", &text, &cpu.image).unwrap_err()
    };
    assert!(message("\"I2.0\" = { count = 1, frequency = 10 }").starts_with("s.toml:3: `I2.0` takes no pulses"));
    assert!(message("HSC6 = { count = 1, frequency = 10 }").starts_with("s.toml:3: `HSC6` takes no pulses"));
    assert!(message("HSC1 = { count = 1, frequency = 0 }").contains("is not a frequency"));
    assert!(message("\"I0.0\" = { count = 1, frequency = 1, backward = true }").contains("no direction"));
}
