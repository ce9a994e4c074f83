//! Watch tables: when values are modified, and what a table refuses.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::layout;

use super::helpers::{Block, cpu, run_observed};
use crate::address;
use crate::cpu::Cpu;
use crate::cycle::Observer;
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
fn what_a_table_refuses() {
    let cpu = cpu(Vec::new());
    let wrong = |text: &str| Table::parse(text, &cpu).expect_err(text).1;
    assert!(wrong("[[row]]\naddress = \"MX1\"").contains("MX1"));
    assert!(wrong("[[row]]\naddress = \"MW10\"\nformat = \"real\"").contains("16 bits"));
    assert!(wrong("[[row]]\naddress = \"MB10\"\nmodify = \"256\"\nformat = \"dec\"").contains("does not fit"));
    assert!(wrong("[[row]]\naddress = \"MB10\"\nformt = \"dec\"").contains("formt"));
    assert!(wrong("[[row]]\naddress = \"T5\"\nmodify = \"1\"").contains("timers"));
}
