//! Scan of an S7-200: special memory, errors, STOP, watchdog, addresses.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::ProgramImage;
use plcc_abi::image::{BlockKind, Site};
use plcc_abi::layout;
use plcc_abi::s7200::image::AnalogModule;
use plcc_abi::s7200::{ANALOG_ADDRESS, Operation, TimerKind, error, fatal, result, system};

use super::helpers::{Block, Closures, operate, run, run_observed, s7200, s7200_image, s7200_with};
use crate::address;
use crate::diagnostics::NO_SITE;
use crate::options::{ClockKind, RunOptions};
use crate::scenario::{Player, Scenario};
use crate::signal::{Source, parse_value};

const SM: u32 = layout::SYSTEM;
const V: u32 = layout::DB_DATA;

fn nothing() -> Block {
    Box::new(|_, _| ())
}

/// Values of special memory byte `byte` under `mask` in the first `scans` scans of 10 ms.
fn bytes(scans: u64, byte: u32, mask: u8) -> Vec<u8> {
    let seen = Rc::new(RefCell::new(Vec::new()));
    let log = seen.clone();
    run(&s7200(Box::new(move |cpu, _| log.borrow_mut().push(cpu.memory.byte(SM + byte) & mask)), Vec::new()), scans);
    seen.take()
}

#[test]
fn bits_of_smb0() {
    // Always on, first scan, powered up, mode switch in RUN; the scan clock begins with 0.
    assert_eq!(bytes(3, 0, 0xFF), [0b1000_1011, 0b1100_0001, 0b1000_0001]);
    let second = bytes(151, 0, 0x20);
    assert_eq!((second[49], second[50], second[99], second[100], second[150]), (0, 0x20, 0x20, 0, 0x20));
    let minute = bytes(6001, 0, 0x10);
    assert_eq!((minute[2999], minute[3000], minute[5999], minute[6000]), (0, 0x10, 0x10, 0));
}

#[test]
fn special_memory_that_the_cpu_fills() {
    let main: Block = Box::new(|cpu, _| {
        let memory = &cpu.memory;
        assert_eq!(memory.byte(SM + 4), 0x60, "both transmitters are idle");
        assert_eq!(memory.byte(SM + 6), 0x90);
        // EM 235 with four inputs and an output, EM 231 with four inputs, then empty slots.
        assert_eq!(memory.bytes::<6>(SM + 8), [0x19, 0, 0x18, 0, 0x80, 0]);
        assert_eq!((memory.byte(SM + 20), memory.byte(SM + 21), memory.byte(SM + 22)), (0x80, 0, 0));
        assert_eq!((memory.byte(SM + 28), memory.byte(SM + 29)), (50, 200));
        assert_eq!(memory.byte(SM) & 0x80, 0, "mode switch in TERM");
        let scan_time = if memory.byte(SM) & 2 != 0 { 0 } else { 10 };
        assert_eq!([22, 24, 26].map(|word| memory.word(SM + word)), [scan_time; 3]);
    });
    let cpu = s7200_with(main, Vec::new(), |image| {
        let config = &mut image.config.s7200;
        config.analog = vec![analog("EM 235", 4, 1), analog("EM 231", 4, 0)];
        config.potentiometers = [50, 200];
        config.mode_switch_term = true;
    });
    run(&cpu, 3);
    assert_eq!(cpu.stopped(), None);
}

fn analog(name: &str, inputs: u8, outputs: u8) -> AnalogModule {
    let (low, high) = (0f64.to_bits(), 10f64.to_bits());
    AnalogModule { name: name.to_string(), inputs, outputs, low, high, unit: "V".to_string(), bipolar: false }
}

#[test]
fn edge_memories_and_retentive_values_when_run_begins() {
    let seen = Rc::new(RefCell::new([0; 4]));
    let log = seen.clone();
    let main: Block = Box::new(move |cpu, _| *log.borrow_mut() = cpu.memory.bytes(SM + system::EDGES));
    let cpu = s7200_with(main, Vec::new(), |image| {
        let own = image.s7200.as_mut().unwrap();
        (own.rising_edges, own.falling_edges) = (2, 1);
    });
    cpu.memory.set_bytes(SM + system::EDGES, [9; 4]);
    run(&cpu, 1);
    assert_eq!(*seen.borrow(), [1, 1, 0, 9]);
}

fn with_site(image: &mut ProgramImage) {
    image.files.push("pump.awl".to_string());
    image.sites.push(Site { file: 0, line: 12, block: BlockKind::Sbr, block_number: 3, network: 2 });
}

#[test]
fn non_fatal_errors_are_noted() {
    let main: Block = Box::new(|cpu, _| {
        assert!(!cpu.memory.bit(SM + 4, 3), "a new scan clears it");
        cpu.s7200_error(0, error::INDIRECT_ADDRESS);
        assert!(cpu.memory.bit(SM + 4, 3));
        if cpu.clock.now() > 0 {
            cpu.s7200_error(NO_SITE, error::RANGE);
        }
    });
    let cpu = s7200_with(main, Vec::new(), with_site);
    run(&cpu, 3);
    assert_eq!(cpu.stopped(), None);
    let report = cpu.s7200_error_report();
    assert_eq!(report.len(), 2);
    assert!(report[0].starts_with("first of 5 non-fatal errors: 1994-01-01"), "{report:?}");
    assert!(
        report[0].ends_with("non-fatal error 0006: indirect addressing error; SBR 3, network 2, pump.awl:12"),
        "{report:?}"
    );
    assert!(report[1].ends_with("non-fatal error 0091: operand out of range; OB 1"), "{report:?}");
    // The buffer contains each place once.
    let errors = cpu.diagnostics.newest_first().iter().filter(|entry| entry.event >> 8 == 0xFB).count();
    assert_eq!(errors, 2);
}

#[test]
fn a_non_fatal_error_can_stop() {
    let main: Block = Box::new(|cpu, _| {
        cpu.s7200_error(0, error::INDIRECT_ADDRESS);
        assert_eq!(cpu.safepoint(0), 1);
    });
    let cpu = s7200_with(main, Vec::new(), |image| {
        with_site(image);
        image.config.s7200.stop_on_error = true;
    });
    run(&cpu, 3);
    let stop = cpu.stopped().unwrap();
    assert!(!stop.asked);
    assert_eq!(
        cpu.stop_text(&stop),
        "non-fatal error 0006: indirect addressing error; SBR 3, network 2, pump.awl:12 (scan 1)"
    );
}

#[test]
fn fatal_errors() {
    let main: Block = Box::new(|cpu, _| {
        cpu.memory.set_byte(layout::Q, 0xFF);
        if cpu.clock.now() > 0 {
            cpu.stop_by(0xFA00 + fatal::COMPARE_ADDRESS, 0, 0);
        }
    });
    let cpu = s7200_with(main, Vec::new(), with_site);
    run(&cpu, 9);
    let stop = cpu.stopped().unwrap();
    assert!(!stop.asked);
    let text = "fatal error 0011: compare contact: bad indirect address; SBR 3, network 2, pump.awl:12 (scan 2)";
    assert_eq!(cpu.stop_text(&stop), text);
    assert_eq!((cpu.driver.output(0, 1), cpu.memory.byte(layout::Q)), (0, 0xFF));
}

#[test]
fn stop_in_the_main_program() {
    let main: Block = Box::new(|cpu, _| {
        if cpu.clock.now() > 0 {
            assert_eq!(operate(cpu, Operation::StopMode, [0; 4]), result::STOP);
        }
    });
    let cpu = s7200(main, Vec::new());
    run(&cpu, 9);
    assert!(cpu.stopped().unwrap().asked);
    assert_eq!(cpu.s7200_scan_number(), Some(2));
}

#[test]
fn an_endless_loop_is_found() {
    let main: Block = Box::new(|cpu, _| {
        let flag = cpu.memory.attention();
        while flag.load(std::sync::atomic::Ordering::Relaxed) == 0 || cpu.safepoint(NO_SITE) == 0 {}
    });
    let cpu = s7200(main, Vec::new());
    run(&cpu, 2);
    let text = cpu.stop_text(&cpu.stopped().unwrap());
    assert!(text.starts_with("fatal error 0003: endless loop"), "{text}");
}

/// Runs `main` under the real clock for a scan with a watchdog of this many milliseconds. Result: exit code.
fn watched(main: Block, watchdog_ms: u16) -> u8 {
    let mut image = s7200_image(&[(BlockKind::Ob, 1)]);
    image.config.s7200.watchdog_ms = Some(watchdog_ms);
    let options = RunOptions { cycles: Some(1), quiet: true, ..RunOptions::default() };
    crate::run(image, Rc::new(Closures(vec![main])), &options)
}

/// Loops for this many milliseconds, with or without WDR.
fn looping(ms: u64, restart: bool) -> Block {
    Box::new(move |cpu, _| {
        let flag = cpu.memory.attention();
        let end = cpu.clock.now() + ms * 1_000_000;
        while cpu.clock.now() < end {
            if restart {
                operate(cpu, Operation::RestartWatchdog, [0; 4]);
            }
            if flag.load(std::sync::atomic::Ordering::Relaxed) != 0 && cpu.safepoint(NO_SITE) != 0 {
                return;
            }
        }
    })
}

#[test]
fn scan_watchdog() {
    assert_eq!(watched(looping(5000, false), 30), 1);
    assert_eq!(watched(looping(300, true), 100), 0);
    assert_eq!(watched(looping(90, false), 0), 0, "it is off");
}

/// What clients are told.
#[test]
fn the_limit_of_a_cycle_is_that_of_the_family() {
    let mut image = s7200_image(&[(BlockKind::Ob, 1)]);
    assert_eq!(image.cycle_limit_ms(), Some(500));
    image.config.s7200.watchdog_ms = Some(0);
    assert_eq!(image.cycle_limit_ms(), None);
    assert_eq!(super::helpers::image(&[]).cycle_limit_ms(), Some(150));
}

#[test]
fn values_from_outside() {
    let cpu = s7200_with(nothing(), Vec::new(), |image| {
        image.config.s7200.analog = vec![analog("EM 235", 4, 1)];
    });
    let resolve = |name: &str| address::resolve(name, &cpu.image).unwrap();
    let set = |name: &str, text: &str| {
        let address = resolve(name);
        let value = parse_value(text, &address, &cpu.image)?;
        cpu.write(&address, value)
    };
    let read = |name: &str| cpu.read(&resolve(name));
    for (name, text) in
        [("VW100", "-2"), ("SMB28", "7"), ("S0.3", "1"), ("AC1", "16#12345678"), ("MB31", "5"), ("EB0", "3")]
    {
        assert_eq!(set(name, text), Ok(()), "{name}");
    }
    assert_eq!((read("VW100"), read("DB1.DBB101"), cpu.memory.word(V + 100)), (0xFFFE, 0xFE, 0xFFFE));
    assert_eq!((read("SMB28"), read("SB0"), read("AC1"), read("M31.2")), (7, 8, 0x1234_5678, 1));
    assert_eq!((read("I0.1"), cpu.driver.read(0, 1)), (1, Some(3)));
    // The module masks; 5 V of 10 V are 16000.
    assert_eq!(set("AIW0", "16003"), Ok(()));
    assert_eq!((read("AI0"), cpu.driver.read(ANALOG_ADDRESS, 2)), (16_000, Some(16_000)));
    assert_eq!(set("AIW2", "5.0 V"), Ok(()));
    assert_eq!(read("AIW2"), 16_000);
    assert!(set("AIW8", "5.0 V").unwrap_err().contains("analog module"));
    assert!(set("AIW2", "5.0 mA").unwrap_err().contains("0 to 10 V"));
    // Timers and counters are set by their values.
    cpu.memory.set_word(SM + system::TIMER_VALUES + 74, 12);
    cpu.memory.set_byte(SM + system::TIMER_BITS + 37, 1);
    cpu.memory.set_word(SM + system::COUNTER_VALUES + 100, 50);
    assert_eq!((read("T37"), read("T37.VALUE"), read("C50"), read("Z50.VALUE")), (1, 12, 0, 50));
    for name in ["T37", "C50", "HC0", "SM0.1", "SMW26"] {
        assert!(set(name, "0").unwrap_err().contains("set"), "{name}");
    }
    assert_eq!((set("T37.VALUE", "20"), set("C50.VALUE", "-3")), (Ok(()), Ok(())));
    assert_eq!((read("T37.VALUE"), read("Z50.VALUE")), (20, 0xFFFD));
    // The value of an output, raw and in its unit.
    assert!(!cpu.peripheral_write(ANALOG_ADDRESS, 2, 16_000));
    assert_eq!((read("AQW0"), cpu.memory.word(SM + system::AQ)), (16_000, 16_000));
    let volts = Source::find("AQW0 in V", &cpu.image, None).unwrap();
    assert_eq!(volts.read(&cpu, None).text(), "5");
    for name in ["V10240.0", "VD10237", "SMB550", "SB32", "T256", "C256", "AIW64", "HC6", "AC4", "IB16"] {
        assert!(cpu.check_address(&resolve(name)).is_err(), "{name}");
    }
    assert!(address::resolve("V100.5", &super::image(&[])).is_err());
}

#[test]
fn a_scenario_with_its_addresses() {
    let main: Block = Box::new(|cpu, _| {
        cpu.s7200_timer(33, TimerKind::Ton as u32, 100, true);
        cpu.memory.set_word(V + 2, cpu.driver.read(ANALOG_ADDRESS, 2).unwrap_or(0) as u16);
    });
    let cpu = s7200_with(main, Vec::new(), |image| {
        image.config.s7200.analog = vec![analog("EM 235", 4, 1)];
    });
    let parse = |text: &str| Scenario::parse("s.toml", text, &cpu.image);
    let scenario = parse(
        "[[at]]\ncycle = 2\nset = { \"AIW0\" = \"2.5 V\", \"V0.3\" = 1 }\n\
         expect = { \"VW2\" = 8000, \"AEW0 in V\" = \"2.5 +- 0.01\", \"T33.VALUE as INT\" = 1, \"VB0\" = 8 }\n\
         [[at]]\ncycle = 4\nexpect = { \"T33.VALUE\" = 3, \"T33\" = 0, \"SM0.1\" = 0, \"AIW0\" = \"25 +- 1 %\" }\n",
    );
    let mut player = Player::new(scenario.unwrap(), &cpu).unwrap();
    run_observed(&cpu, 4, &mut player);
    assert_eq!((player.failures(), player.expectations_met()), (Vec::new(), 8));
    let message = |text: &str| parse(text).err().or_else(|| Player::new(parse(text).unwrap(), &cpu).err()).unwrap();
    assert!(message("[[at]]\ncycle = 1\nevent = \"OB40\"\n").starts_with("s.toml:3: no event starts"));
    assert!(message("[[at]]\ncycle = 1\nset = { \"C5\" = 1 }\n").contains("set C5.VALUE"));
    assert!(message("[[at]]\ncycle = 1\nset = { \"AIW8\" = 1 }\n").contains("no module"));
    assert!(message("[[at]]\ncycle = 1\nset = { \"VB10240\" = 1 }\n").contains("outside of the V memory"));
}

#[test]
fn analog_outputs_written_through_a_pointer() {
    let main: Block = Box::new(|cpu, _| cpu.memory.set_word(SM + system::AQ + 4, 320));
    let cpu = s7200(main, Vec::new());
    run(&cpu, 1);
    assert_eq!(cpu.driver.output(ANALOG_ADDRESS + 4, 2), 320);
}

#[test]
fn exit_codes() {
    let options = RunOptions { clock: ClockKind::Virtual, cycles: Some(2), quiet: true, ..RunOptions::default() };
    let exit = |main: Block, options: &RunOptions| {
        let mut image = s7200_image(&[(BlockKind::Ob, 1)]);
        with_site(&mut image);
        crate::run(image, Rc::new(Closures(vec![main])), options)
    };
    assert_eq!(exit(nothing(), &options), 0);
    let stop: Block = Box::new(|cpu, _| {
        operate(cpu, Operation::StopMode, [0; 4]);
    });
    assert_eq!(exit(stop, &options), 0);
    assert_eq!(exit(Box::new(|cpu, _| cpu.stop_by(0xFA14, 0, 0)), &options), 1);
    let bad = RunOptions { set: vec!["T37=1".to_string()], ..options.clone() };
    assert_eq!(exit(nothing(), &bad), 2);
    let good = RunOptions { set: vec!["VW0=5".to_string(), "AIW0=100".to_string()], ..options };
    let main: Block = Box::new(|cpu, _| {
        if cpu.memory.word(V) != 5 || cpu.driver.read(ANALOG_ADDRESS, 2) != Some(100) {
            cpu.stop_by(0xFA10, NO_SITE, 0);
        }
    });
    assert_eq!(exit(main, &good), 0);
}
