//! Running a program as a test: assertion pragmas and scenario expectations, under the virtual clock.

use std::path::PathBuf;
use std::rc::Rc;

use plcc_abi::ProgramImage;
use serde::{Deserialize, Serialize};

use crate::assertion::Failed;
use crate::clock::{Clock, NS_PER_MS};
use crate::code::Code;
use crate::cpu::Cpu;
use crate::cycle::{Observer, Pace};
use crate::io::Simulated;
use crate::options::HANG_LIMIT_DEFAULT;
use crate::probe::Watcher;
use crate::scenario::{Player, Scenario};

/// Maximum cycles of a program that must stop itself.
pub const CYCLES_UNTIL_STOP_MAX: u64 = 100_000;

/// Environment variable that makes an executable run as a test; its value is a [`TestJob`] as JSON. The report goes to standard
/// output as JSON.
pub const TEST_VARIABLE: &str = "PLCC_TEST";

/// The test that an executable runs.
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
    /// From `//@ test expect=fail CODE`: the CPU must go to STOP on a fault with this event or error; empty: on any.
    pub expect_fail: Option<String>,
    /// A scenario to play.
    pub scenario: Option<PathBuf>,
    /// Nanoseconds of a cycle; `None`: 10 ms.
    pub cycle_time: Option<u64>,
    /// Nanoseconds of host time for a cycle; `None`: 10 s.
    pub hang_limit: Option<u64>,
    /// Look at each cycle, as a trace does: the way of a CPU that is not alone, though nothing else takes part.
    pub observed: bool,
}

/// What an expectation found whose cycle did not come.
pub const NOT_REACHED: &str = "(not reached)";

/// An assertion that failed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AssertFailure {
    pub file: String,
    pub line: u32,
    pub text: String,
    /// Both sides, ready to print.
    pub left: String,
    pub right: String,
    /// Cycle and time in nanoseconds, where it happened in one.
    pub when: Option<(u64, u64)>,
    /// Type of an expected value; empty if it has none.
    pub ty: String,
    /// The value that came and the one that was expected, as JSON; of an expectation.
    pub values: Option<(serde_json::Value, serde_json::Value)>,
    /// Values next to the one that was expected, ready to print.
    pub beside: Vec<String>,
}

impl AssertFailure {
    /// One without a text.
    pub fn at(file: &str, line: u32) -> AssertFailure {
        AssertFailure { file: file.to_string(), line, ..AssertFailure::default() }
    }

    /// `in cycle 7, at 60 ms`, if it happened in one.
    pub fn place(&self) -> Option<String> {
        let (cycle, time) = self.when?;
        Some(format!("in cycle {cycle}, at {} ms", time as f64 / NS_PER_MS as f64))
    }
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
    /// Assertions (and expectations of the scenario) that held whenever they were executed; 0 without a failure: nothing was tested. To
    /// go to STOP where that is expected counts as one, if there are no others.
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

/// Runs a program as a test.
pub fn test(image: ProgramImage, code: Rc<dyn Code>, options: &TestOptions) -> TestReport {
    test_watched(image, code, options, None)
}

/// Runs a program with probes as a test.
pub fn test_watched(
    image: ProgramImage,
    code: Rc<dyn Code>,
    options: &TestOptions,
    watcher: Option<Rc<dyn Watcher>>,
) -> TestReport {
    let mut report = TestReport::default();
    let mut image = image;
    // A test begins the same every time, and leaves nothing behind.
    image.config.retain.file = None;
    let driver = Box::new(Simulated::new(image.config.modules.clone()));
    let cpu = Cpu::new(image, code, Clock::simulated(), driver);
    if let Some(watcher) = watcher {
        cpu.set_watcher(watcher);
    }
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
    report.cycles = match options.observed {
        true => cpu.execute(&pace, &mut Looking(&mut player)),
        false => cpu.execute(&pace, &mut player),
    };
    judge(&cpu, options, until_stop, &player, &mut report);
    report
}

/// A player that never [rests](Observer::rests).
struct Looking<'a>(&'a mut Player);

impl Observer for Looking<'_> {
    fn before(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        self.0.before(cpu, cycle, time);
    }

    fn after(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        self.0.after(cpu, cycle, time);
    }
}

fn judge(cpu: &Cpu, options: &TestOptions, until_stop: bool, player: &Player, report: &mut TestReport) {
    let image = &cpu.image;
    let file = |index: u32| image.files.get(index as usize).cloned().unwrap_or_default();
    for (id, entry) in image.asserts.iter().enumerate() {
        let (file, line, text) = (file(entry.file), entry.line, entry.text.clone());
        match cpu.assertions.failure(id) {
            Some(Failed { left, right, when }) => {
                report.failures.push(AssertFailure {
                    text,
                    left,
                    right,
                    when: Some(when),
                    ..AssertFailure::at(&file, line)
                });
            }
            None if cpu.assertions.is_executed(id) || entry.trap => report.passed += 1,
            // A program that is to fail ends where it fails.
            None if options.expect_fail.is_some() => {}
            None => report.not_reached.push(NotReached { file, line, text }),
        }
    }
    report.passed += player.expectations_met();
    report.failures.extend(player.failures());
    let fault = cpu.stopped().filter(|stop| !stop.asked).map(|stop| cpu.stop_text(&stop));
    match (&fault, options.expect_fail.as_deref()) {
        (Some(text), None) => report.problems.push(format!("the CPU went to STOP: {text}{}", player.stopper())),
        (None, Some(_)) => {
            report.problems.push("the CPU was expected to go to STOP on a fault, but it did not".to_string())
        }
        (None, None) if until_stop && !cpu.is_stopped() => report
            .problems
            .push(format!("the program did not stop itself (SFC 46, STP) within {CYCLES_UNTIL_STOP_MAX} cycles")),
        (Some(text), Some(code)) if !names(text, code) => {
            report.problems.push(format!("the CPU was expected to go to STOP with {code}: {text}"));
        }
        (None, None) | (Some(_), Some(_)) => {}
    }
    report.stopped = fault;
    // A test like this asserts that the CPU goes to STOP as expected.
    if options.expect_fail.is_some() && report.stopped.is_some() && report.passed == 0 && report.failed() == 0 {
        report.passed = 1;
    }
}

/// The text of a fault, before its place, has the event or error `code`; an empty one is any.
fn names(fault: &str, code: &str) -> bool {
    let event = fault.split(';').next().unwrap_or_default();
    code.is_empty() || event.split(|c: char| !c.is_ascii_alphanumeric() && c != '#').any(|word| word == code)
}
