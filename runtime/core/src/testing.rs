//! Running a program as a test: assertion pragmas and scenario expectations, under the virtual clock.

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;

use plcc_abi::ProgramImage;
use plcc_abi::image::{AssertEntry, AssertOp};
use serde::{Deserialize, Serialize};

use crate::clock::Clock;
use crate::code::Code;
use crate::cpu::Cpu;
use crate::cycle::Pace;
use crate::io::Simulated;
use crate::options::HANG_LIMIT_DEFAULT;
use crate::scenario::{Player, Scenario};

/// Cycles that a program which stops itself may take.
pub const CYCLES_UNTIL_STOP_MAX: u64 = 100_000;

/// What happened to each assertion; made before the first cycle.
pub(crate) struct Assertions {
    states: RefCell<Vec<AssertState>>,
}

#[derive(Clone, Copy, Default)]
struct AssertState {
    executed: bool,
    /// The values of the first failure.
    failed: Option<(u32, u32)>,
}

impl Assertions {
    pub(crate) fn new(count: usize) -> Assertions {
        Assertions { states: RefCell::new(vec![AssertState::default(); count]) }
    }

    pub(crate) fn check(&self, id: usize, entry: &AssertEntry, left: u32, right: u32) {
        if let Some(state) = self.states.borrow_mut().get_mut(id) {
            state.executed = true;
            let failed = entry.trap || !holds(entry.op, entry.real, left, right);
            if state.failed.is_none() && failed {
                state.failed = Some((left, right));
            }
        }
    }
}

/// Compares as unsigned 32-bit numbers, or in order as REAL; equality is always of the bits.
pub fn holds(op: AssertOp, real: bool, left: u32, right: u32) -> bool {
    let ordered = |float: fn(&f32, &f32) -> bool, int: fn(&u32, &u32) -> bool| {
        if real { float(&f32::from_bits(left), &f32::from_bits(right)) } else { int(&left, &right) }
    };
    match op {
        AssertOp::Eq => left == right,
        AssertOp::Ne => left != right,
        AssertOp::Lt => ordered(f32::lt, u32::lt),
        AssertOp::Le => ordered(f32::le, u32::le),
        AssertOp::Gt => ordered(f32::gt, u32::gt),
        AssertOp::Ge => ordered(f32::ge, u32::ge),
    }
}

/// Environment variable that makes an executable run as a test; its value is a [`TestJob`] as JSON. The report goes to standard
/// output as JSON.
pub const TEST_VARIABLE: &str = "PLCC_TEST";

/// What an executable is to test.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct TestJob {
    /// Which program, if several share the executable; else 0.
    pub program: usize,
    pub options: TestOptions,
}

/// How to test.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct TestOptions {
    /// From `//@ test cycles=N`.
    pub cycles: Option<u64>,
    /// From `//@ test expect=fail`: the CPU must go to STOP on a fault.
    pub expect_fail: bool,
    /// A scenario to play.
    pub scenario: Option<PathBuf>,
    /// Nanoseconds of a cycle; `None`: 10 ms.
    pub cycle_time: Option<u64>,
    /// Nanoseconds of host time for a cycle; `None`: 10 s.
    pub hang_limit: Option<u64>,
}

/// An assertion that failed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AssertFailure {
    pub file: String,
    pub line: u32,
    pub text: String,
    /// Both sides, ready to print.
    pub left: String,
    pub right: String,
}

/// An assertion that was never executed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NotReached {
    pub file: String,
    pub line: u32,
    pub text: String,
}

/// Result of a test.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TestReport {
    /// Assertions (and expectations of the scenario) that held whenever they were executed. A test without any
    /// counts as one, passed if it ended as it should.
    pub passed: u64,
    pub failures: Vec<AssertFailure>,
    pub not_reached: Vec<NotReached>,
    /// The fault that led to STOP, whether or not it was expected.
    pub stopped: Option<String>,
    /// What else makes the test fail: an unexpected fault, an expected one that did not come, no STOP within the
    /// largest number of cycles, a scenario that cannot be read.
    pub problems: Vec<String>,
    pub cycles: u64,
}

impl TestReport {
    /// Number of failures of all kinds, for `N passed, M failed`.
    pub fn failed(&self) -> u64 {
        (self.failures.len() + self.not_reached.len() + self.problems.len()) as u64
    }
}

/// A value as in messages: `16#0000_0005 (5)`; with `real` its number too.
fn value_text(bits: u32, real: bool) -> String {
    let hex = format!("16#{:04X}_{:04X}", bits >> 16, bits & 0xFFFF);
    if real { format!("{hex} ({:?})", f32::from_bits(bits)) } else { format!("{hex} ({bits})") }
}

/// Runs a program as a test.
pub fn test(image: ProgramImage, code: Rc<dyn Code>, options: &TestOptions) -> TestReport {
    let mut report = TestReport::default();
    let mut image = image;
    // A test begins the same every time, and leaves nothing behind.
    image.config.s7200.retentive_file = None;
    let driver = Box::new(Simulated::new(image.config.modules.clone()));
    let cpu = Cpu::new(image, code, Clock::simulated(), driver);
    let scenario = match options.scenario.as_deref().map(|path| Scenario::read(path, &cpu.image)).transpose() {
        Ok(scenario) => scenario.unwrap_or_default(),
        Err(message) => {
            report.problems.push(message);
            return report;
        }
    };
    let cycle_time = options.cycle_time.unwrap_or_else(|| cpu.cycle_time());
    let until_stop = options.cycles.is_none() && cpu.image.stops_itself && scenario.entries.is_empty();
    let cycles = match options.cycles {
        Some(cycles) => cycles,
        None if until_stop => CYCLES_UNTIL_STOP_MAX,
        None => scenario.last_cycle(cycle_time).unwrap_or(1).max(1),
    };
    let pace =
        Pace { cycles: Some(cycles), cycle_time, hang_limit: options.hang_limit.unwrap_or(HANG_LIMIT_DEFAULT.0) };
    let mut player = match Player::new(scenario, &cpu) {
        Ok(player) => player,
        Err(message) => {
            report.problems.push(message);
            return report;
        }
    };
    report.cycles = cpu.execute(&pace, &mut player);
    judge(&cpu, options, until_stop, &player, &mut report);
    report
}

fn judge(cpu: &Cpu, options: &TestOptions, until_stop: bool, player: &Player, report: &mut TestReport) {
    let image = &cpu.image;
    let file = |index: u32| image.files.get(index as usize).cloned().unwrap_or_default();
    for (entry, state) in image.asserts.iter().zip(cpu.assertions.states.borrow().iter()) {
        let (file, line, text) = (file(entry.file), entry.line, entry.text.clone());
        match state.failed {
            Some((left, right)) => {
                let (left, right) = (value_text(left, entry.real), value_text(right, entry.real));
                report.failures.push(AssertFailure { file, line, text, left, right });
            }
            None if state.executed || entry.trap => report.passed += 1,
            // A program that is to fail ends where it fails.
            None if options.expect_fail => {}
            None => report.not_reached.push(NotReached { file, line, text }),
        }
    }
    report.passed += player.expectations_met();
    report.failures.extend(player.failures());
    let fault = cpu.stopped().filter(|stop| !stop.asked).map(|stop| cpu.stop_text(&stop));
    match (&fault, options.expect_fail) {
        (Some(text), false) => report.problems.push(format!("the CPU went to STOP: {text}")),
        (None, true) => report.problems.push("the CPU was expected to go to STOP on a fault, and did not".to_string()),
        (None, false) if until_stop && !cpu.is_stopped() => report
            .problems
            .push(format!("the program did not stop itself (SFC 46, STP) within {CYCLES_UNTIL_STOP_MAX} cycles")),
        (None, false) | (Some(_), true) => {}
    }
    report.stopped = fault;
    if report.passed == 0 && report.failed() == 0 {
        report.passed = 1;
    }
}
