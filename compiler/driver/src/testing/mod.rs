//! `plcc test`: compiles test programs, runs them in every requested form, and judges the results.
//!
//! - [`find`]: from the arguments to the tests.
//! - [`prepare`]: from one test input to a finished outcome or to programs to run.
//! - [`carets`]: files that mark their expected messages.
//! - [`executables`]: many programs in few executables.
//! - [`coverage`]: which parts of the programs have run.
//! - [`junit`]: the results for CI services; [`progress`]: on a terminal; [`watch`]: when a source changes.
//! - [`judge`]: from the reports of the forms, which must agree, to one outcome.

pub mod carets;
pub mod coverage;
pub mod executables;
pub mod find;
pub mod judge;
pub mod junit;
pub mod prepare;
pub mod progress;
pub mod watch;

use plcc_coverage::Coverage;
use plcc_runtime::AssertFailure;

use crate::inputs::TestInput;
use crate::parallel;
use crate::pipeline::{Optimization, Settings};
use prepare::Prepared;
use progress::Progress;

/// How a program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// The IR in its interpreter.
    Interp,
    /// Machine code in memory.
    Jit,
    /// An executable.
    Exe,
}

/// A form, and how its code is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    pub form: Form,
    pub optimization: Optimization,
}

impl std::fmt::Display for Variant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let form = match self.form {
            Form::Interp => "interp",
            Form::Jit => "jit",
            Form::Exe => "exe",
        };
        write!(f, "{form} {}", self.optimization)
    }
}

/// Settings of a test run.
#[derive(Clone, Debug)]
pub struct Plan {
    pub settings: Settings,
    /// At least one.
    pub variants: Vec<Variant>,
    pub linker: Option<String>,
    /// Count what runs, in the first variant that is not an executable.
    pub coverage: bool,
}

/// The outcome of one test.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    pub name: String,
    /// Assertions.
    pub passed: u64,
    pub failed: u64,
    /// The sources have unexpected errors.
    pub rejected: bool,
    /// A file could not be read.
    pub unreadable: bool,
    /// Files whose run tested nothing: a source without an assertion, a scenario that expects nothing.
    pub untested: Vec<String>,
    /// Messages of the compiler as text.
    pub messages: String,
    /// What failed, a few lines each.
    pub failures: String,
    /// Assertions and expectations that failed.
    pub details: Vec<AssertFailure>,
    /// What came of each of its scenarios, as part of the sums and of `failures`.
    pub scenarios: Vec<Played>,
}

/// What came of a scenario.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Played {
    /// Path of its file.
    pub file: String,
    pub passed: u64,
    pub failed: u64,
    /// What failed, a few lines each.
    pub failures: String,
}

impl Outcome {
    /// Adds a failure, with the lines that describe it.
    pub fn fail(&mut self, text: &str) {
        self.failed += 1;
        self.failures.push_str(&format!("FAILED {text}\n"));
    }
}

/// Runs all tests; outcomes are in the order of `inputs`.
pub fn run(inputs: &[TestInput], plan: &Plan) -> Vec<Outcome> {
    run_counted(inputs, plan).0
}

/// As [`run`], with what the tests have run of the programs, which is nothing if the plan does not ask for it.
pub fn run_counted(inputs: &[TestInput], plan: &Plan) -> (Vec<Outcome>, Coverage) {
    let progress = Progress::new(inputs.len());
    let mut prepared = parallel::map(inputs, |input| {
        let prepared = guarded(&name_of(input), || prepare::prepare(input, plan)).unwrap_or_else(Prepared::finished);
        progress.step(&prepared.outcome.name);
        prepared
    });
    executables::run(&mut prepared, plan.linker.as_deref());
    let mut coverage = Coverage::default();
    for one in prepared.iter_mut().filter_map(|prepared| prepared.coverage.take()) {
        coverage.add(one);
    }
    (prepared.into_iter().map(judge::judge).collect(), coverage)
}

/// The path of a test, which is the name of its outcome.
pub fn name_of(input: &TestInput) -> String {
    match input {
        TestInput::File(path) | TestInput::Project(path) => path.display().to_string(),
        TestInput::Program(parts) => {
            let names: Vec<String> = parts.iter().map(|part| part.display().to_string()).collect();
            names.join(" ")
        }
    }
}

/// Runs `work`; a panic, which is a fault of plcc, becomes a failed outcome.
#[allow(clippy::result_large_err, reason = "an outcome is made once for each test")]
fn guarded<T>(name: &str, work: impl FnOnce() -> T) -> Result<T, Outcome> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).map_err(|panic| {
        let mut outcome = Outcome { name: name.to_string(), rejected: true, ..Outcome::default() };
        outcome.fail(&format!("{name}: internal fault, please report it: {}", crate::panic_text(panic.as_ref())));
        outcome
    })
}
