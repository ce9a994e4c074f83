//! Forced inputs, outputs and memory, by family.

use std::rc::Rc;

use plcc_abi::image::Family;
use plcc_abi::layout;

use super::helpers::{Block, cpu_with, run};
use crate::cpu::Cpu;
use crate::force::Table;

/// OB 1 copies IB 0 to MB 0 and PIB 0 to MB 1, reads back QB 0 to MB 2, writes 16#0F to QB 0, and 16#AA to PQB 4.
fn cpu(family: Family) -> Rc<Cpu> {
    let ob1: Block = Box::new(|cpu, _| {
        let memory = &cpu.memory;
        memory.set_byte(layout::M, memory.byte(layout::I));
        memory.set_byte(layout::M + 1, cpu.peripheral_read(0, 1) as u8);
        memory.set_byte(layout::M + 2, memory.byte(layout::Q));
        memory.set_byte(layout::Q, 0x0F);
        assert!(!cpu.peripheral_write(4, 1, 0xAA));
    });
    let cpu = cpu_with(vec![(1, ob1)], |image| {
        image.profile.family = family;
        image.outputs_used = 1;
    });
    cpu.driver.set_input(0, 1, 0b0000_0011);
    cpu
}

/// IB 0 and PIB 0 as the program sees them, QB 0 as it reads it back and in the image, modules QB 0, PQB 4 and QB 9.
fn seen(cpu: &Cpu) -> [u32; 7] {
    let memory = &cpu.memory;
    let byte = |offset: u32| u32::from(memory.byte(offset));
    [
        byte(layout::M),
        byte(layout::M + 1),
        byte(layout::M + 2),
        byte(layout::Q),
        cpu.driver.output(0, 1),
        cpu.driver.output(4, 1),
        cpu.driver.output(9, 1),
    ]
}

fn forced(family: Family) -> Rc<Cpu> {
    let cpu = cpu(family);
    for (name, value) in
        [("I0.0", "0"), ("I0.7", "1"), ("Q0.7", "1"), ("Q0.1", "false"), ("QB4", "16#55"), ("QB9", "16#77")]
    {
        assert_eq!(cpu.force(name, value), Ok(()), "{name}");
    }
    run(&cpu, 3);
    cpu
}

#[test]
fn without_forced_values_modules_and_program_decide() {
    let cpu = cpu(Family::S71500);
    run(&cpu, 3);
    assert_eq!(seen(&cpu), [0x03, 0x03, 0x0F, 0x0F, 0x0F, 0xAA, 0]);
}

/// Direct access is to the module.
#[test]
fn a_300_forces_the_process_image() {
    assert_eq!(seen(&forced(Family::S7300)), [0x82, 0x03, 0x8D, 0x8D, 0x8D, 0x55, 0x77]);
    let cpu = cpu(Family::S7300);
    let message = cpu.force("PIB0", "1").unwrap_err();
    assert!(message.contains("of the process image"), "{message}");
}

#[test]
fn a_400_forces_direct_access_too() {
    assert_eq!(seen(&forced(Family::S7400)), [0x82, 0x82, 0x8D, 0x8D, 0x8D, 0x55, 0x77]);
}

/// The image of outputs keeps what the program has written.
#[test]
fn a_1500_forces_at_the_module() {
    assert_eq!(seen(&forced(Family::S71500)), [0x82, 0x82, 0x0F, 0x0F, 0x8D, 0x55, 0x77]);
    assert_eq!(seen(&forced(Family::S71200)), [0x82, 0x82, 0x0F, 0x0F, 0x8D, 0x55, 0x77]);
}

/// What is no longer forced has the value of its module and of the program.
#[test]
fn forcing_ends() {
    let cpu = forced(Family::S71500);
    assert_eq!(cpu.unforce(Some("I0.0")), Ok(()));
    assert_eq!(cpu.unforce(Some("I0.0")), Err("I0.0 is not forced".to_string()));
    let empty = cpu.unforce(Some(" ")).expect_err("nothing has this name");
    assert!(empty.starts_with("the name is empty"), "{empty}");
    run(&cpu, 1);
    assert_eq!(seen(&cpu)[..2], [0x83, 0x83]);
    assert_eq!(cpu.unforce(None), Ok(()));
    assert!(!cpu.is_forcing());
    run(&cpu, 1);
    assert_eq!(seen(&cpu), [0x03, 0x03, 0x0F, 0x0F, 0x0F, 0xAA, 0]);
    let entries: Vec<(u16, u32)> =
        cpu.diagnostics.newest_first().iter().map(|entry| (entry.event, entry.info)).collect();
    assert!(entries.contains(&(0xC032, 6)) && entries.contains(&(0xC033, 0)), "{entries:x?}");
}

#[test]
fn what_cannot_be_forced_is_refused() {
    let cpu = cpu(Family::S7300);
    let refused = |name: &str, value: &str| cpu.force(name, value).unwrap_err();
    assert!(refused("MB0", "1").contains("neither an input nor an output"));
    assert_eq!(cpu.force("IW0", "16#1234"), Ok(()));
    assert!(refused("I1.0", "1").contains("overlaps IW0"));
    assert_eq!(cpu.force("QB1", "1"), Ok(()), "another area");
    assert!(refused("I9999.0", "1").contains("9999"));
    assert!(!refused("I5.0", "7").is_empty());
    for number in 2..10 {
        assert_eq!(cpu.force(&format!("QB{number}"), "1"), Ok(()));
    }
    assert!(refused("QB11", "1").contains("10 values"));
    assert_eq!(cpu.force("QB9", "16#22"), Ok(()), "a new value for what is forced");
    assert!(self::cpu(Family::S7400).force("T1", "1").is_err());
}

/// The program writes 16#0F to MB 5 in each cycle; before and after it the forced bits are there.
#[test]
fn a_400_forces_bit_memory() {
    let ob1: Block = Box::new(|cpu, _| {
        cpu.memory.set_byte(layout::M + 6, cpu.memory.byte(layout::M + 5));
        cpu.memory.set_byte(layout::M + 5, 0x0F);
    });
    let cpu = cpu_with(vec![(1, ob1)], |image| image.profile.family = Family::S7400);
    assert_eq!(cpu.force("M5.7", "1"), Ok(()));
    assert_eq!(cpu.force("M5.0", "0"), Ok(()));
    assert!(cpu.force("MW4", "0").unwrap_err().contains("overlaps M5.7"));
    run(&cpu, 2);
    assert_eq!((cpu.memory.byte(layout::M + 5), cpu.memory.byte(layout::M + 6)), (0x8E, 0x8E));
    assert_eq!(cpu.unforce(None), Ok(()));
    run(&cpu, 1);
    assert_eq!(cpu.memory.byte(layout::M + 5), 0x0F);
}

/// Of two rows one would be forced, and the user would not know which.
#[test]
fn an_address_has_one_row() {
    let path = std::env::temp_dir().join(format!("plcc-force-{}-rows.toml", std::process::id()));
    let row = |address: &str, value: &str| format!("[[force]]\naddress = \"{address}\"\nvalue = \"{value}\"\n");
    let forced = |text: &str| {
        std::fs::write(&path, text).unwrap();
        cpu(Family::S71500).force_from(&path, Table::Named).map_err(|message| {
            message.split_once(".toml:").map_or_else(|| message.clone(), |(_, rest)| rest.to_string())
        })
    };
    let twice = row("I0.0", "1") + &row("I0.0", "0");
    assert_eq!(forced(&twice), Err("5: I0.0 has two rows: which value is it forced to? Keep one of them".to_string()));
    let overlap = row("I0.0", "1") + &row("IB0", "0");
    assert_eq!(forced(&overlap), Err("5: IB0 overlaps I0.0, which is forced too: only one of them can be".to_string()));
    let far = forced(&row("IW60000", "1")).unwrap_err();
    assert!(far.starts_with("2: byte 60000 is outside of the inputs, which have "), "{far}");
    let _ = std::fs::remove_file(&path);
}

/// The table is kept in its file, and read again with the next start.
#[test]
fn a_file_keeps_what_is_forced() {
    let path = std::env::temp_dir().join(format!("plcc-force-{}-gate.toml", std::process::id()));
    let _ = std::fs::remove_file(&path);
    let before = cpu(Family::S71500);
    assert!(before.force_from(&path, Table::Named).is_err());
    assert_eq!(before.force_from(&path, Table::Kept), Ok(()));
    assert_eq!(before.force("I0.3:P", "1"), Ok(()));
    assert_eq!(before.force("QW6", "16#0102"), Ok(()));
    let after = cpu(Family::S71500);
    assert_eq!(after.force_from(&path, Table::Named), Ok(()));
    assert_eq!(after.forced(), before.forced());
    run(&after, 1);
    assert_eq!((seen(&after)[0], after.driver.output(6, 2)), (0x0B, 0x0102));
    std::fs::write(
        &path,
        "[[force]]\naddress = \"I0.0\"\nvalue = \"1\"\n[[force]]\naddress = \"M0.0\"\nvalue = \"1\"\n",
    )
    .unwrap();
    let message = cpu(Family::S71500).force_from(&path, Table::Named).unwrap_err();
    assert!(message.contains("gate.toml:5: M0.0 is neither"), "{message}");
    let _ = std::fs::remove_file(&path);
}

#[test]
fn each_forced_value_has_a_table() {
    let path = std::env::temp_dir().join(format!("plcc-force-{}-short.toml", std::process::id()));
    for text in ["\"I0.0\" = 1\n", "force = { \"I0.0\" = 1 }\n"] {
        std::fs::write(&path, text).unwrap();
        let message = cpu(Family::S71500).force_from(&path, Table::Named).unwrap_err();
        let help = "write `[[force]]`, and below it `address = \"I0.0\"` and `value = \"1\"`";
        assert!(message.ends_with(help), "{message}");
    }
    let _ = std::fs::remove_file(&path);
}

/// The run before was of another version of the program.
#[test]
fn what_the_program_does_not_have_any_more_is_left_out() {
    let path = std::env::temp_dir().join(format!("plcc-force-{}-stale.toml", std::process::id()));
    let row = |name: &str, value: &str| format!("[[force]]\naddress = \"{name}\"\nvalue = \"{value}\"\n");
    let text = [row("\\\"Gate\\\"", "1"), row("I0.2", "1"), row("M0.0", "1"), row("QB0", "16#55")].concat();
    std::fs::write(&path, text).unwrap();
    let cpu = cpu(Family::S71500);
    assert_eq!(cpu.force_from(&path, Table::Kept), Ok(()));
    let names: Vec<String> = cpu.forced().into_iter().map(|one| one.name).collect();
    assert_eq!(names, ["I0.2", "QB0"]);
    let entries: Vec<(u16, u32)> =
        cpu.diagnostics.newest_first().iter().map(|entry| (entry.event, entry.info)).collect();
    assert_eq!(entries, [(0xC032, 2), (0xC034, 2)]);
    // The table is renewed with the next change, and leaves nothing beside it.
    assert_eq!(cpu.unforce(Some("I0.2")), Ok(()));
    assert_eq!(std::fs::read_to_string(&path).unwrap().matches("address").count(), 1);
    let beside = std::env::temp_dir().join(format!("plcc-force-{}-stale.toml.new", std::process::id()));
    assert!(!beside.exists());
    let _ = std::fs::remove_file(&path);
}
