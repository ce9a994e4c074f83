//! Pulse outputs of a CPU: special memory, profile table, counters of mode 12, signals, traces.

use std::rc::Rc;

use plcc_abi::image::DbEntry;
use plcc_abi::layout;
use plcc_abi::s7200::image::CpuRow;
use plcc_abi::s7200::{Operation, S7200Image, V_DB, result};

use super::super::{Operands, special};
use crate::cpu::Cpu;
use crate::signal::{Signal, Source, Value};
use crate::tests::cpu_with;
use crate::trace::Recorder;

const MS: u64 = 1_000_000;
const V_BYTES: usize = 600;

fn cpu() -> Rc<Cpu> {
    let row = CpuRow { high_speed_counters: 0x3F, pulse_outputs: 2, ..CpuRow::default() };
    cpu_of(row)
}

fn cpu_of(row: CpuRow) -> Rc<Cpu> {
    let cpu = cpu_with(Vec::new(), |image| {
        image.s7200 = Some(S7200Image { cpu: row, ..S7200Image::default() });
        let data = vec![0; V_BYTES];
        let (number, address) = (V_DB, layout::DB_DATA);
        image.dbs = vec![DbEntry {
            number,
            name: "V".to_string(),
            address,
            data,
            read_only: false,
            unlinked: false,
            optimized: false,
            kept: Default::default(),
            ty: None,
        }];
        image.db_end = layout::DB_DATA + 1024;
    });
    cpu.s7200_start_counters();
    cpu.s7200_start_pulses();
    cpu
}

fn pls(cpu: &Cpu, number: u32) -> bool {
    operation(cpu, Operation::ControlPulses, number, 0)
}

fn operation(cpu: &Cpu, operation: Operation, a: u32, b: u32) -> bool {
    cpu.s7200_operation(operation as u32, &Operands { a, b, ..Operands::default() }) & result::ENO != 0
}

fn to(cpu: &Cpu, time: u64) {
    cpu.clock.move_to(time);
    cpu.s7200_poll_pulses();
}

#[test]
fn burst_by_the_manual() {
    let cpu = cpu();
    assert_eq!((cpu.memory.byte(special(66)), cpu.s7200_pulse_level(0)), (0x80, None));
    cpu.memory.set_byte(special(67), 0x8D);
    cpu.memory.set_word(special(68), 250);
    cpu.memory.set_dword(special(72), 10);
    assert!(pls(&cpu, 0));
    assert_eq!((cpu.memory.byte(special(66)), cpu.s7200_pulse_level(0)), (0, Some(true)));
    assert_eq!(cpu.s7200_pulses_due(), 2500 * MS);
    to(&cpu, 2500 * MS);
    assert_eq!(cpu.memory.byte(special(66)), 0x80);
    // Its event starts the other burst at once.
    cpu.memory.set_byte(special(67), 0x8C);
    cpu.memory.set_dword(special(72), 5);
    assert!(pls(&cpu, 0));
    assert_eq!(cpu.s7200_pulses_due(), 3750 * MS);
    to(&cpu, 2600 * MS);
    assert_eq!((cpu.s7200_pulse_count(0), cpu.s7200_pulse_level(0), cpu.s7200_pulse_level(1)), (11, Some(true), None));
    // PWM at the other one.
    cpu.memory.set_byte(special(77), 0xDB);
    cpu.memory.set_word(special(78), 1000);
    cpu.memory.set_word(special(80), 250);
    assert!(pls(&cpu, 1));
    to(&cpu, 2849 * MS);
    assert_eq!(cpu.s7200_pulse_level(1), Some(true));
    to(&cpu, 2850 * MS);
    assert_eq!(cpu.s7200_pulse_level(1), Some(false));
    assert!(!pls(&cpu, 2));
    // A new RUN.
    cpu.s7200_start_pulses();
    assert_eq!((cpu.s7200_pulse_level(0), cpu.s7200_pulse_count(0)), (None, 0));
}

#[test]
fn profile_table_in_v_memory() {
    let cpu = cpu();
    let v = cpu.memory.db(V_DB).0;
    cpu.memory.set_byte(special(67), 0xA0);
    cpu.memory.set_word(special(168), 500);
    assert!(!pls(&cpu, 0), "no segments");
    cpu.memory.set_byte(v + 500, 3);
    for (index, (first, delta, count)) in (0..).zip([(600u16, -2i16, 200u32), (200, 0, 1000), (200, 1, 400)]) {
        let at = v + 501 + 8 * index;
        cpu.memory.set_word(at, first);
        cpu.memory.set_word(at + 2, delta as u16);
        cpu.memory.set_dword(at + 4, count);
    }
    cpu.memory.set_word(special(168), 590);
    cpu.memory.set_byte(v + 590, 2);
    assert!(!pls(&cpu, 0), "17 bytes from VB590 leave V memory");
    cpu.memory.set_word(special(168), 65_535);
    assert!(!pls(&cpu, 0));
    cpu.memory.set_word(special(168), 500);
    assert!(pls(&cpu, 0));
    let mut shown = Vec::new();
    for time in [0, 80, 81, 280, 281, 439, 440] {
        to(&cpu, time * MS);
        shown.push(cpu.memory.byte(special(166)));
    }
    assert_eq!(shown, [1, 1, 2, 2, 3, 3, 0]);
    assert_eq!(Source::find("PLS0.COUNT", &cpu.image, None).unwrap().read(&cpu, None), Value::Number(1600.0));
    assert!(Source::find("PLS2.COUNT", &cpu.image, None).is_err());
}

#[test]
fn a_counter_counts_an_output() {
    let cpu = cpu();
    cpu.memory.set_byte(special(37), 0xF8);
    cpu.memory.set_dword(special(42), 7);
    assert!(operation(&cpu, Operation::DefineCounter, 0, 12));
    assert!(operation(&cpu, Operation::ControlCounter, 0, 0));
    cpu.memory.set_byte(special(67), 0x85);
    cpu.memory.set_word(special(68), 1000);
    cpu.memory.set_dword(special(72), 10);
    assert!(pls(&cpu, 0));
    cpu.clock.move_to(6 * MS - 1);
    assert_eq!((cpu.s7200_counter(0), cpu.memory.byte(special(36))), (6, 0x20));
    cpu.clock.move_to(6 * MS);
    assert_eq!((cpu.s7200_counter(0), cpu.memory.byte(special(36))), (7, 0x60));
    cpu.clock.move_to(99 * MS);
    assert_eq!((cpu.s7200_counter(0), cpu.memory.byte(special(36))), (10, 0xA0));
}

#[test]
fn a_21x_has_single_trains_only() {
    let cpu = cpu_of(CpuRow { old: true, pulse_outputs: 2, ..CpuRow::default() });
    cpu.memory.set_byte(special(67), 0xA5);
    cpu.memory.set_word(special(68), 1000);
    cpu.memory.set_dword(special(72), 3);
    assert!(pls(&cpu, 0));
    assert_eq!((cpu.s7200_pulses_due(), cpu.memory.byte(special(66))), (3 * MS, 0));
}

#[test]
fn a_trace_has_the_edges() {
    let cpu = cpu();
    let path = std::env::temp_dir().join(format!("plcc-pulses-{}.vcd", std::process::id()));
    let names = ["Q0.0", "Q0.1", "Q0.2"];
    let signals =
        names.map(|name| Signal { name: name.to_string(), source: Source::find(name, &cpu.image, None).unwrap() });
    let mut recorder = Recorder::create(&path, signals.to_vec(), 0).unwrap();
    recorder.sample(&cpu, None, 0, 0);
    cpu.clock.move_to(10 * MS);
    cpu.memory.set_byte(special(77), 0x8D);
    cpu.memory.set_word(special(78), 4);
    cpu.memory.set_dword(special(82), 2);
    assert!(pls(&cpu, 1));
    recorder.sample(&cpu, None, 1, 10 * MS);
    cpu.clock.move_to(20 * MS);
    cpu.memory.set_bit(layout::Q, 2, true);
    recorder.sample(&cpu, None, 2, 20 * MS);
    recorder.finish().unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    let changes = text.split("$enddefinitions $end\n").nth(1).unwrap();
    assert_eq!(changes, "#0\n0!\n0\"\n0#\n#10000\n1\"\n#12000\n0\"\n#14000\n1\"\n#16000\n0\"\n#20000\n1#\n");
}
