//! The two ways to run a program, and the border to generated code.

use std::rc::Rc;

use plcc_abi::RuntimeFn;
use plcc_abi::image::{
    AssertComparison, AssertCondition, AssertEntry, AssertKind, AssertOp, AssertSide, AssertType, BlockKind,
};
use plcc_abi::layout;

use super::helpers::{Block, Closures, cpu, image, run as run_cycles};
use crate::cpu::Cpu;
use crate::diagnostics::NO_SITE;
use crate::functions;
use crate::options::{ClockKind, Duration, RunOptions};
use crate::testing::{TestOptions, test};

fn code(blocks: Vec<Block>) -> Rc<Closures> {
    Rc::new(Closures(blocks))
}

fn assertion(line: u32, trap: bool) -> AssertEntry {
    let side = || AssertSide { ty: AssertType::Bits(32), constant: None };
    let comparison = AssertComparison { op: AssertOp::Eq, kind: AssertKind::Bits, left: side(), right: side() };
    let condition = AssertCondition::Compare(0);
    AssertEntry { file: 0, line, text: format!("assert {line}"), condition, comparisons: vec![comparison], trap }
}

#[test]
fn assertions_are_counted() {
    let ob1: Block = Box::new(|cpu, _| {
        let mem = cpu.memory.base();
        functions::call(RuntimeFn::Assert, mem, &[0, 0, 5, 5]);
        functions::call(RuntimeFn::Assert, mem, &[1, 0, 5, 6]);
        functions::call(RuntimeFn::Assert, mem, &[9, 0, 5, 6]);
    });
    let mut image = image(&[(BlockKind::Ob, 1)]);
    image.files.push("a.stl".to_string());
    image.asserts = vec![assertion(1, false), assertion(2, false), assertion(3, false), assertion(4, true)];
    let report = test(image, code(vec![ob1]), &TestOptions::default());
    assert_eq!((report.passed, report.failed(), report.cycles), (2, 2, 1));
    assert_eq!(report.failures[0].line, 2);
    assert_eq!(report.failures[0].left, "16#0000_0005 (5)");
    assert_eq!(report.not_reached[0].line, 3);
}

#[test]
fn expected_faults() {
    let options = TestOptions { expect_fail: Some("16#2521".to_string()), ..TestOptions::default() };
    let fault = || -> Vec<Block> {
        vec![Box::new(|cpu: &Cpu, _| {
            cpu.sync_error(0, 0x21, 0, 0);
        })]
    };
    let one = image(&[(BlockKind::Ob, 1)]);
    let expected = test(one.clone(), code(fault()), &options);
    assert_eq!((expected.passed, expected.failed()), (1, 0));
    assert!(expected.stopped.unwrap().starts_with("16#4562"));
    let other = TestOptions { expect_fail: Some("16#2522".to_string()), ..TestOptions::default() };
    let other = test(one.clone(), code(fault()), &other);
    assert_eq!((other.passed, other.failed()), (0, 1), "another fault than the expected one");
    let unexpected = test(one.clone(), code(fault()), &TestOptions::default());
    assert_eq!((unexpected.passed, unexpected.failed()), (0, 1));
    let missing = test(one, code(vec![Box::new(|_: &Cpu, _| ())]), &options);
    assert_eq!((missing.passed, missing.failed()), (0, 1));
}

#[test]
fn runs_until_the_program_stops_itself() {
    let ob1: Block = Box::new(|cpu, _| {
        let count = cpu.memory.word(layout::M) + 1;
        cpu.memory.set_word(layout::M, count);
        if count == 7 {
            cpu.stop_by(0x457F, 0, 0);
        }
    });
    let mut image = image(&[(BlockKind::Ob, 1)]);
    image.stops_itself = true;
    let report = test(image.clone(), code(vec![ob1]), &TestOptions::default());
    // It ran as it should, and asserted nothing.
    assert_eq!((report.passed, report.failed(), report.cycles), (0, 0, 7));
    let never = test(image, code(vec![Box::new(|_: &Cpu, _| ())]), &TestOptions::default());
    assert_eq!((never.failed(), never.cycles), (1, 100_000));
}

#[test]
fn exit_codes() {
    let options = RunOptions { clock: ClockKind::Virtual, cycles: Some(2), quiet: true, ..RunOptions::default() };
    let image = image(&[(BlockKind::Ob, 1)]);
    let nothing = || -> Vec<Block> { vec![Box::new(|_: &Cpu, _| ())] };
    assert_eq!(crate::run(image.clone(), code(nothing()), &options), 0);
    let fault: Block = Box::new(|cpu, _| cpu.stop_by(0x4576, 0, 0));
    assert_eq!(crate::run(image.clone(), code(vec![fault]), &options), 1);
    let stop: Block = Box::new(|cpu, _| cpu.stop_by(0x457F, 0, 0));
    assert_eq!(crate::run(image.clone(), code(vec![stop]), &options), 0);
    let bad = RunOptions { set: vec!["X1=1".to_string()], ..options.clone() };
    assert_eq!(crate::run(image.clone(), code(nothing()), &bad), 2);
    let bad = RunOptions { print: vec!["MW99999".to_string()], ..options };
    assert_eq!(crate::run(image, code(nothing()), &bad), 2);
}

#[test]
fn real_clock_interrupts_a_running_block() {
    let ob1: Block = Box::new(|cpu, _| {
        let flag = cpu.memory.attention();
        while cpu.memory.byte(layout::M) == 0 {
            if flag.load(std::sync::atomic::Ordering::Relaxed) != 0 && cpu.safepoint(NO_SITE) != 0 {
                return;
            }
        }
    });
    let ob38: Block = Box::new(|cpu, _| cpu.memory.set_byte(layout::M, 1));
    let options = RunOptions {
        cycles: Some(1),
        cycle_time: Some(Duration(0)),
        set: vec!["M0.1=0".to_string()],
        quiet: true,
        ..RunOptions::default()
    };
    let mut image = image(&[(BlockKind::Ob, 1), (BlockKind::Ob, 38)]);
    image.config.cycle_time_max_ms = 6000;
    assert_eq!(crate::run(image, code(vec![ob1, ob38]), &options), 0);
}

#[test]
fn real_clock_monitors_the_cycle() {
    let ob1: Block = Box::new(|cpu, _| {
        let flag = cpu.memory.attention();
        while flag.load(std::sync::atomic::Ordering::Relaxed) == 0 || cpu.safepoint(NO_SITE) == 0 {}
    });
    let options = RunOptions { quiet: true, ..RunOptions::default() };
    let mut image = image(&[(BlockKind::Ob, 1)]);
    image.config.cycle_time_max_ms = 20;
    assert_eq!(crate::run(image, code(vec![ob1]), &options), 1);
}

#[test]
fn the_dynamic_form_agrees_with_the_table() {
    let cpu = cpu(Vec::new());
    run_cycles(&cpu, 0);
    let mem = cpu.memory.base();
    for &function in RuntimeFn::ALL {
        assert!(!functions::address(function).is_null(), "{}", function.name());
    }
    let one = u64::from(1f32.to_bits());
    assert_eq!(functions::call(RuntimeFn::Ln, mem, &[one]), 0);
    assert_eq!(functions::call(RuntimeFn::Ln, mem, &[0]), 0xFFFF_FFFF);
    assert_eq!(functions::call(RuntimeFn::Asin, mem, &[u64::from(2f32.to_bits())]), 0xFFFF_FFFF);
    assert_eq!(functions::call(RuntimeFn::PeripheralWrite, mem, &[4, 1, 0x42]), 0);
    assert_eq!(cpu.driver.output(4, 1), 0x42);
    assert_eq!(functions::call(RuntimeFn::PeripheralRead, mem, &[70_000, 1]), 1 << 32);
}
