//! Counters, Statement List (STL), chapter 4.

use plcc_abi::layout;

use crate::counters;
use crate::memory::Memory;

#[test]
fn counts_edges_between_0_and_999() {
    let memory = Memory::new(layout::DB_DATA);
    counters::down(&memory, 1, true);
    assert_eq!(counters::value(&memory, 1), 0);
    assert!(!counters::set(&memory, 1, 0xF998, true));
    assert_eq!(counters::value(&memory, 1), 998, "bits 12-15 are ignored");
    for _ in 0..3 {
        counters::up(&memory, 1, true);
        counters::up(&memory, 1, true);
        counters::up(&memory, 1, false);
    }
    assert_eq!(counters::value(&memory, 1), 999);
    counters::down(&memory, 1, false);
    counters::down(&memory, 1, true);
    assert_eq!(counters::value(&memory, 1), 998);
    counters::reset(&memory, 1);
    assert_eq!(counters::value(&memory, 1), 0);
}

#[test]
fn set_takes_an_edge() {
    let memory = Memory::new(layout::DB_DATA);
    counters::set(&memory, 1, 0x20, true);
    counters::set(&memory, 1, 0x30, true);
    assert_eq!(counters::value(&memory, 1), 20);
    counters::set(&memory, 1, 0x30, false);
    assert!(counters::set(&memory, 1, 0x0A, true));
    assert!(counters::set(&memory, 1, 0x0A, true), "nothing done: the edge is still to come");
    assert!(!counters::set(&memory, 1, 0x30, true));
    assert_eq!(counters::value(&memory, 1), 30);
}

#[test]
fn enable_lets_all_act_again() {
    let memory = Memory::new(layout::DB_DATA);
    let (up, down) = (|| counters::up(&memory, 1, true), || counters::down(&memory, 1, true));
    counters::set(&memory, 1, 0x10, true);
    up();
    down();
    counters::enable(&memory, 1, true);
    up();
    up();
    assert_eq!(counters::value(&memory, 1), 11);
    down();
    assert_eq!(counters::value(&memory, 1), 10);
    counters::set(&memory, 1, 0x50, true);
    assert_eq!(counters::value(&memory, 1), 50);
    counters::enable(&memory, 1, true);
    up();
    assert_eq!(counters::value(&memory, 1), 50, "no edge at FR");
}
