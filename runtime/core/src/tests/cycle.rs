//! Order of the cycle, start information, process images, clock memory.

use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::time::Duration;

use plcc_abi::codes::stop;
use plcc_abi::image::{BlockKind, Module};
use plcc_abi::layout;
use plcc_abi::monitor::Probes;

use super::helpers::{Block, cpu, cpu_with, image, run, run_observed};
use crate::address::{self, Address};
use crate::clock::Clock;
use crate::code::Code;
use crate::cpu::Cpu;
use crate::cycle::Observer;
use crate::io::Simulated;
use crate::online::Service;

fn at(text: &str) -> Address {
    address::parse(text).unwrap()
}

fn log(entries: &Rc<RefCell<Vec<String>>>, text: &'static str) -> Block {
    let entries = entries.clone();
    Box::new(move |_, _| entries.borrow_mut().push(text.to_string()))
}

#[test]
fn startup_then_cycles() {
    let entries = Rc::default();
    let cpu = cpu(vec![(1, log(&entries, "OB1")), (100, log(&entries, "OB100")), (102, log(&entries, "OB102"))]);
    run(&cpu, 2);
    assert_eq!(*entries.borrow(), ["OB100", "OB1", "OB1"]);
    assert_eq!(cpu.clock.now(), 20_000_000);
}

#[test]
fn configured_startup() {
    let entries = Rc::default();
    let cpu = cpu_with(vec![(100, log(&entries, "OB100")), (102, log(&entries, "OB102"))], |image| {
        image.config.startup = 102;
    });
    run(&cpu, 1);
    assert_eq!(*entries.borrow(), ["OB102"]);
}

#[test]
fn start_information_of_ob1() {
    let seen: Rc<RefCell<Vec<[u8; 20]>>> = Rc::default();
    let keep = seen.clone();
    let ob1: Block = Box::new(move |cpu, lbase| {
        assert_eq!(lbase, layout::l_stack(1));
        assert_eq!(cpu.memory.dword(lbase + 20), 0, "TEMP reads 0");
        cpu.memory.set_dword(lbase + 20, 1);
        keep.borrow_mut().push(cpu.memory.bytes(lbase));
    });
    let cpu = cpu(vec![(1, ob1)]);
    run(&cpu, 3);
    let seen = seen.borrow();
    assert_eq!(seen[0][..12], [0x11, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(seen[2][..12], [0x11, 3, 1, 1, 0, 0, 0, 10, 0, 10, 0, 10]);
    assert_eq!(seen[2][12..], [0x94, 1, 1, 0, 0, 0, 0x02, 0x07], "20 ms after the start, a Saturday");
}

#[test]
fn only_named_inputs_are_copied() {
    let ob1: Block = Box::new(|cpu, _| {
        let memory = &cpu.memory;
        memory.set_byte(layout::I + 1, memory.byte(layout::I + 1) + 1);
        memory.set_byte(layout::I, memory.byte(layout::I) + 1);
        memory.set_byte(layout::Q + 4, memory.byte(layout::I));
    });
    let cpu = cpu(vec![(1, ob1)]);
    cpu.write(&at("IB0"), 7).unwrap();
    run(&cpu, 3);
    assert_eq!(cpu.read(&at("IB0")), 8, "read again in each cycle");
    assert_eq!(cpu.read(&at("IB1")), 3, "keeps what the program wrote");
    assert_eq!(cpu.read(&at("PQB4")), 8);
}

#[test]
fn peripheral_access() {
    let cpu = cpu_with(Vec::new(), |image| {
        image.config.modules = Some(vec![Module {
            name: "DI8/DO8".to_string(),
            input_start: 0,
            input_bytes: 1,
            output_start: 4,
            output_bytes: 2,
            station: None,
        }]);
    });
    assert_eq!(cpu.peripheral_read(0, 1), 0);
    assert_eq!(cpu.peripheral_read(0, 2), 1 << 32);
    assert!(!cpu.peripheral_write(4, 2, 0x1234));
    assert_eq!(cpu.read(&at("QW4")), 0x1234, "mirrored in the image");
    assert!(cpu.peripheral_write(5, 2, 0xFFFF));
    assert_eq!(cpu.read(&at("QW4")), 0x1234);
    assert_eq!(cpu.peripheral_read(u32::MAX, 4), 1 << 32);
}

#[test]
fn stop_by_the_program_is_no_fault() {
    let cpu = cpu(vec![(1, Box::new(|cpu: &Cpu, _| cpu.stop_by(stop::SFC_46, 0, 0)))]);
    run(&cpu, 5);
    assert!(cpu.stopped().unwrap().asked);
    assert_eq!(cpu.clock.now(), 0, "nothing runs after STOP");
}

#[test]
fn clock_memory() {
    let cpu = cpu_with(Vec::new(), |image| image.config.clock_memory_byte = Some(100));
    run(&cpu, 5);
    assert_eq!(cpu.read(&at("MB100")), 1, "50 ms: half of 0.1 s");
    run(&cpu, 95);
    assert_eq!(cpu.read(&at("MB100")), expected_clock(1000), "1 s");
}

fn expected_clock(ms: u64) -> u64 {
    [100u64, 200, 400, 500, 800, 1000, 1600, 2000]
        .iter()
        .enumerate()
        .map(|(bit, period)| u64::from(ms % period >= period / 2) << bit)
        .sum()
}

#[test]
fn observer_sees_the_phases() {
    #[derive(Default)]
    struct Phases(Vec<(char, u64, u64)>);
    impl Observer for Phases {
        fn before(&mut self, _: &Cpu, cycle: u64, time: u64) {
            self.0.push(('<', cycle, time));
        }
        fn after(&mut self, _: &Cpu, cycle: u64, time: u64) {
            self.0.push(('>', cycle, time));
        }
    }
    let mut phases = Phases::default();
    run_observed(&cpu(Vec::new()), 2, &mut phases);
    let ms10 = 10_000_000;
    assert_eq!(phases.0, [('<', 0, 0), ('>', 0, 0), ('<', 1, 0), ('>', 1, 0), ('<', 2, ms10), ('>', 2, ms10)]);
}

/// The cycle, OB 35 and OB 1 are in the same order whether or not somebody looks at each cycle.
#[test]
fn a_resting_observer_sees_the_last_cycle() {
    #[derive(Default)]
    struct Looker {
        rests: bool,
        seen: Vec<(u64, u64)>,
    }
    impl Observer for Looker {
        fn before(&mut self, _: &Cpu, _: u64, _: u64) {}
        fn after(&mut self, _: &Cpu, cycle: u64, time: u64) {
            self.seen.push((cycle, time));
        }
        fn rests(&self) -> bool {
            self.rests
        }
    }
    let of = |rests: bool| {
        let entries = Rc::default();
        let cpu = cpu_with(vec![(1, log(&entries, "OB1")), (35, log(&entries, "OB35"))], |image| {
            image.config.cyclic_period_ms = vec![(35, 15)];
        });
        let mut looker = Looker { rests, ..Looker::default() };
        run_observed(&cpu, 4, &mut looker);
        (entries.take(), cpu.clock.now(), looker.seen)
    };
    let ((busy, busy_end, all), (resting, end, last)) = (of(false), of(true));
    assert_eq!(busy, ["OB1", "OB1", "OB35", "OB1", "OB35", "OB1"]);
    assert_eq!((resting, end), (busy, busy_end));
    assert_eq!(all.last(), Some(&(4, 30_000_000)));
    assert_eq!(last, [(0, 0), (4, 30_000_000)]);
}

/// Code with one block, which tells whether it is the one with probes.
#[derive(Default)]
struct Teller {
    is_watched: Cell<bool>,
    entries: RefCell<Vec<&'static str>>,
}

impl Code for Teller {
    fn call(&self, _: u32, _: *mut u8, _: u32, _: u32) {
        self.entries.borrow_mut().push(if self.is_watched.get() { "probes" } else { "plain" });
    }

    fn watch(&self, is_watched: bool) {
        self.is_watched.set(is_watched);
    }
}

/// Watches the program from the second cycle control point on, until the fourth.
struct Onlooker;

impl Service for Onlooker {
    fn look(&self, cpu: &Cpu, _: u64, _: Option<u64>) -> bool {
        matches!(cpu.cycle_number(), 2 | 4)
    }

    fn serve(&mut self, cpu: &Cpu, _: Duration) {
        match cpu.cycle_number() {
            2 => cpu.watch_obs(1),
            _ => cpu.unwatch_block(1),
        }
    }
}

#[test]
fn code_changes_between_two_cycles() {
    let teller = Rc::<Teller>::default();
    let mut image = image(&[(BlockKind::Ob, 1)]);
    image.config.services.probes = Some(Probes::default());
    let cpu = Cpu::new(image, teller.clone(), Clock::simulated(), Box::new(Simulated::new(None)));
    cpu.attach(Box::new(Onlooker));
    run(&cpu, 6);
    assert_eq!(*teller.entries.borrow(), ["plain", "plain", "probes", "probes", "plain", "plain"]);
}

/// Source: System and standard functions, list xy22.
#[test]
fn clients_are_told_how_an_ob_began() {
    let nothing = || Box::new(|_: &Cpu, _: u32| {}) as Block;
    let cpu = cpu(vec![(1, nothing()), (80, nothing())]);
    cpu.is_served.set(true);
    run(&cpu, 2);
    let status = cpu.ob_status(1).unwrap();
    // Event of the second cycle, and the year of the virtual clock.
    assert_eq!((&status[..4], status[12]), (&[0x11, 3, 1, 1][..], 0x94));
    // Loaded; nothing would happen without it.
    assert_eq!(status[20..], [0, 0x10, 0, 8, 0, 0, 0, 0]);
    let not_run = cpu.ob_status(80).unwrap();
    assert_eq!((&not_run[..20], &not_run[20..]), (&[0; 20][..], &[0, 0x10, 0, 4, 0, 0, 0, 0][..]));
    assert_eq!(cpu.ob_status(82), None);
}
