//! Watch tables: when values are modified, and what a table refuses.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::functions::TimerMode;
use plcc_abi::image::BlockKind;
use plcc_abi::layout;

use super::helpers::{Block, Closures, cpu, image, run_observed};
use crate::address;
use crate::cpu::Cpu;
use crate::cycle::Observer;
use crate::options::{ClockKind, RunOptions};
use crate::timers;
use crate::watch::{Table, Trigger};

struct Watched(Table);

impl Observer for Watched {
    fn before(&mut self, _: &Cpu, _: u64, _: u64) {}
    fn begin(&mut self, cpu: &Cpu, cycle: u64) {
        self.0.modify(cpu, cycle, Trigger::Begin);
    }
    fn end(&mut self, cpu: &Cpu, cycle: u64) {
        self.0.modify(cpu, cycle, Trigger::End);
    }
    fn after(&mut self, _: &Cpu, _: u64, _: u64) {}
}

#[test]
fn values_are_modified_at_their_triggers() {
    let seen: Rc<RefCell<Vec<(u8, u16)>>> = Rc::default();
    let keep = seen.clone();
    let ob1: Block = Box::new(move |cpu, _| {
        let memory = &cpu.memory;
        keep.borrow_mut().push((memory.byte(layout::I), memory.word(layout::M + 10)));
        memory.set_word(layout::M + 10, memory.word(layout::M + 10) + 1);
        memory.set_byte(layout::Q + 4, 7);
    });
    let cpu = cpu(vec![(1, ob1)]);
    let text = r#"
        [[row]]
        address = "I0.1"
        modify = "true"
        cycle = 2

        [[row]]
        address = "MW10"
        format = "dec"
        modify = "100"
        every-cycle = true
        cycle = 3

        [[row]]
        address = "QB4"
        format = "bin"
        modify = "1010"
        trigger = "end"
        every-cycle = true
        comment = "Lamps"
    "#;
    let table = Table::parse(text, &cpu).unwrap();
    let mut watched = Watched(table.clone());
    run_observed(&cpu, 4, &mut watched);
    assert_eq!(*seen.borrow(), [(0, 0), (2, 1), (0, 100), (0, 100)], "an input is modified for one cycle");
    assert_eq!(
        cpu.read(&address::parse("PQB4").unwrap()),
        0b1010,
        "the outputs get what the end of the cycle modified"
    );
    assert_eq!(
        table.text(&cpu),
        "I0.1  false        modified\nMW10  101          modified\nQB4   2#0000_1010  modified  Lamps\n"
    );
}

#[test]
fn a_row_whose_cycle_has_not_come_is_not_modified() {
    let cpu = cpu(vec![(1, Box::new(|_: &Cpu, _: u32| {}) as Block)]);
    let text = "[[row]]\naddress = \"MW10\"\nmodify = \"5\"\ncycle = 40\n";
    let table = Table::parse(text, &cpu).unwrap();
    run_observed(&cpu, 4, &mut Watched(table.clone()));
    assert_eq!(table.text(&cpu), "MW10  W#16#0000  cycle 40 has not come\n");
}

/// Source: Programming with STEP 7, 20.5: modifying a timer changes its time, a counter its count, and no edge.
#[test]
fn timers_and_counters_are_modified_by_their_values() {
    let cpu = cpu(Vec::new());
    let text = r#"
        [[row]]
        address = "T5.VALUE"
        modify = "S5T#2s"

        [[row]]
        address = "T6.VALUE"
        format = "s5time"
        modify = "137"

        [[row]]
        address = "C3.VALUE"
        modify = "C#20"

        [[row]]
        address = "C4.VALUE"
        format = "counter"
        modify = "120"

        [[row]]
        address = "Z5.VALUE"
        modify = "7"
    "#;
    let table = Table::parse(text, &cpu).unwrap();
    timers::start(&cpu.memory, &cpu.clock, 5, TimerMode::ExtendedPulse, 0x2100, true);
    table.modify(&cpu, 1, Trigger::Begin);
    assert_eq!(
        table.text(&cpu),
        "T5.VALUE  S5T#2s     modified\nT6.VALUE  S5T#130ms  modified\nC3.VALUE  20         modified\n\
         C4.VALUE  C#120      modified\nZ5.VALUE  7          modified\n"
    );
    cpu.clock.move_to(1_900_000_000);
    assert!(timers::scan(&cpu.memory, &cpu.clock, 5), "2 s instead of 100 s are left of the pulse");
    cpu.clock.move_to(2_000_000_000);
    assert!(!timers::scan(&cpu.memory, &cpu.clock, 5));
    let wrong = |row: &str| Table::parse(&format!("[[row]]\n{row}"), &cpu).expect_err(row).1;
    assert!(wrong("address = \"T5\"\nmodify = \"1\"").contains("T5.VALUE"));
    assert!(wrong("address = \"C5\"\nmodify = \"1\"").contains("C5.VALUE"));
    assert!(wrong("address = \"C5.VALUE\"\nmodify = \"1000\"").contains("0 to 999"));
    assert!(wrong("address = \"T5.VALUE\"\nmodify = \"16#4000\"").contains("S5TIME"));
}

#[test]
fn each_address_has_a_table() {
    let cpu = cpu(Vec::new());
    let message = Table::parse("\"I0.0\" = 1\n", &cpu).expect_err("no row").1;
    let help = "write `[[row]]`, and below it `address = \"I0.0\"` and `modify = \"1\"`";
    assert!(message.ends_with(help), "{message}");
}

#[test]
fn forced_values_win_over_the_table() {
    let seen: Rc<RefCell<Vec<u8>>> = Rc::default();
    let keep = seen.clone();
    let cpu =
        cpu(vec![(1, Box::new(move |cpu: &Cpu, _: u32| keep.borrow_mut().push(cpu.memory.byte(layout::I))) as Block)]);
    assert_eq!(cpu.force("I0.1", "0"), Ok(()));
    let text = "[[row]]\naddress = \"IB0\"\nmodify = \"FF\"\nevery-cycle = true\n";
    run_observed(&cpu, 2, &mut Watched(Table::parse(text, &cpu).unwrap()));
    assert_eq!(*seen.borrow(), [0xFD, 0xFD]);
}

/// MW 10 counts cycles; the trace begins when it comes to 5, with two samples from before that.
#[test]
fn a_trace_waits_for_its_trigger() {
    let path = |suffix: &str| std::env::temp_dir().join(format!("plcc-watch-trace-{}.{suffix}", std::process::id()));
    let traced = |suffix: &str, more: &str| {
        let ob1: Block = Box::new(|cpu, _| {
            let count = cpu.memory.word(layout::M + 10) + 1;
            cpu.memory.set_word(layout::M + 10, count);
            cpu.memory.set_bit(layout::Q + 4, 1, count >= 6);
        });
        let file = path(suffix);
        let table = std::env::temp_dir().join(format!("plcc-watch-table-{}-{suffix}.toml", std::process::id()));
        let text = format!("[trace]\nfile = \"{}\"\nsignals = [\"MW10\", \"Q4.1\"]\n{more}", file.display());
        std::fs::write(&table, text).unwrap();
        let options = RunOptions {
            clock: ClockKind::Virtual,
            cycles: Some(20),
            watch_table: Some(table.clone()),
            quiet: true,
            ..RunOptions::default()
        };
        let exit = crate::run(image(&[(BlockKind::Ob, 1)]), Rc::new(Closures(vec![ob1])), &options);
        std::fs::remove_file(table).unwrap();
        let written = std::fs::read_to_string(&file).ok();
        let _ = std::fs::remove_file(&file);
        (exit, written)
    };
    let trigger = "trigger = \"MW10\"\nlevel = 5\nsamples = 6\nbefore = 2\n";
    let expected =
        "cycle,time_ms,MW10,Q4.1\n3,20,16#0003,0\n4,30,16#0004,0\n5,40,16#0005,0\n6,50,16#0006,1\n7,60,16#0007,1\n";
    assert_eq!(traced("csv", trigger), (0, Some(expected.to_string())));
    let (_, vcd) = traced("vcd", trigger);
    assert!(vcd.is_some_and(|vcd| vcd.contains("#20000\n") && vcd.contains("#50000\n") && !vcd.contains("#10000\n")));
    assert_eq!(traced("csv", "trigger = \"Q4.1\"\nedge = \"falling\"\n"), (0, None), "it has not come");
    let (_, all) = traced("csv", "");
    assert_eq!(all.map(|all| all.lines().count()), Some(21), "without a trigger it begins at once");
    assert_eq!(traced("csv", "before = 3\n"), (2, None));
    // A folder is where the file should be, which shows when all samples are there, or at the end.
    for more in ["samples = 1\n", ""] {
        std::fs::create_dir(path("folder.csv")).unwrap();
        assert_eq!(traced("folder.csv", more), (2, None));
        std::fs::remove_dir(path("folder.csv")).unwrap();
    }
}

#[test]
fn a_trace_is_of_numbers_and_has_limits() {
    let cpu = cpu(Vec::new());
    let wrong = |text: &str| Table::parse(&format!("[trace]\n{text}"), &cpu).expect_err(text).1;
    assert!(wrong("file = \"a.txt\"\nsignals = [\"MW10\"]").contains(".csv"));
    assert!(wrong("file = \"a.csv\"\nsignals = []").contains("at least one"));
    assert!(wrong("file = \"no/such/a.csv\"\nsignals = [\"MW10\"]").contains("there is no folder no/such"));
    assert!(wrong("file = \"a.csv\"\nsignals = [\"ML0\"]").contains("32 bits"));
    assert!(wrong("file = \"a.csv\"\nsignals = [\"MW1\"]\ntrigger = \"MW2\"").contains("one of the signals"));
    assert!(wrong("file = \"a.csv\"\nsignals = [\"MW1\"]\nsamples = 100001").contains("100000"));
    assert!(wrong("file = \"a.csv\"\nsignals = [\"MW1\", \"MB5\", \"MW1\"]").contains("MW1 is in the signals twice"));
    let level = |signal: &str, rest: &str| {
        format!("file = \"a.csv\"\nsignals = [\"{signal}\"]\ntrigger = \"{signal}\"\n{rest}")
    };
    assert_eq!(wrong(&level("MW1", "level = 65536")), "MW1 cannot rise to 65536: its values are 0 to 65535");
    assert_eq!(wrong(&level("MW1", "level = 0")), "MW1 cannot rise to 0: its values are 0 to 65535");
    assert_eq!(wrong(&level("M1.0", "edge = \"falling\"\nlevel = 1")), "M1.0 cannot fall to 1: its values are 0 to 1");
    let many: Vec<String> = (0..17).map(|byte| format!("\"MB{byte}\"")).collect();
    assert!(wrong(&format!("file = \"a.csv\"\nsignals = [{}]", many.join(", "))).contains("16 signals"));
}

#[test]
fn what_a_table_refuses() {
    let cpu = cpu(Vec::new());
    let wrong = |text: &str| Table::parse(text, &cpu).expect_err(text).1;
    assert!(wrong("[[row]]\naddress = \"MX1\"").contains("MX1"));
    let real = wrong("[[row]]\naddress = \"MW10\"\nformat = \"real\"");
    assert!(real.starts_with("MW10 has 16 bits, which this format does not show: write bin, hex, dec,"), "{real}");
    assert!(wrong("[[row]]\naddress = \"MB10\"\nmodify = \"256\"\nformat = \"dec\"").contains("does not fit"));
    assert!(wrong("[[row]]\naddress = \"MB10\"\nformt = \"dec\"").contains("formt"));
    assert!(wrong("[[row]]\naddress = \"T5\"\nmodify = \"1\"").contains("state of a timer"));
    let dtl = "[[row]]\naddress = \"IB10 as DTL\"\nmodify = \"DTL#2020-01-01-00:00:00\"";
    assert!(wrong(dtl).contains("a row cannot modify inputs as a value of type DTL"));
}

#[test]
fn texts_and_moments_are_modified() {
    let cpu = cpu(vec![(1, Box::new(|_: &Cpu, _: u32| {}) as Block)]);
    let text = r#"
        [[row]]
        address = "MB10 as DTL"
        modify = "DTL#2020-01-02-03:04:05"

        [[row]]
        address = "MB40 as STRING"
        modify = "'Tank'"
    "#;
    let table = Table::parse(text, &cpu).unwrap();
    run_observed(&cpu, 1, &mut Watched(table.clone()));
    let values: Vec<String> = table.shown(&cpu).into_iter().map(|row| row.value).collect();
    assert_eq!(values[1], "'Tank'");
    assert!(values[0].starts_with("DTL#2020-01-02-03:04:05"), "{values:?}");
    assert_eq!(cpu.read_bytes(&address::parse("MB40").unwrap(), 6), [254, 4, b'T', b'a', b'n', b'k']);
}
