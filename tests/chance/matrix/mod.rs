//! Each kind of variable of a block, with each type, in each use, in every language: a case that binds compiles, and interpreter and machine
//! code move a value from one end to the other; a case that does not bind is also refused by the tools of Siemens.
//!
//! A case is a small program. Its block has a variable of a section (input, output, in-out, static, temp) in a form (whole, element,
//! member of a structure), which holds a sample; the use brings the sample to a place where the main program compares it. A case that is
//! refused must be in the table of its language, with the code of the message; one that is there must be refused.
//!
//! `PLCC_MATRIX=all` runs all cases, `PLCC_MATRIX=N` one in N. Left out, each language runs as many as its share of time allows.
//! `PLCC_MATRIX_FAILURES=FILE` writes all failures with their sources to a file.

use std::collections::BTreeMap;

use plcc_diag::SourceFile;
use plcc_driver::cli::Level;
use plcc_driver::code;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Compiled, Settings};
use plcc_driver::testing::{Form, Variant};
use plcc_runtime::TestOptions;
use plcc_tests::plan;

mod network;
mod parameters;
mod portal;
mod s7200;
mod scl;
mod stl;

/// Between a source and one in STL that belongs to the same program.
const NEXT_FILE: &str = "//=== STL\n";

/// One program of the matrix.
struct Case {
    /// Section and kind of the block, and form of the variable.
    kind: String,
    ty: &'static str,
    using: &'static str,
    /// The other choices, for messages: CPU, place of the actual parameter.
    variant: String,
    ending: &'static str,
    cpu: &'static str,
    source: Box<dyn Fn() -> String>,
}

impl Case {
    fn name(&self) -> String {
        format!("{}, {}, {}, {}", self.kind, self.ty, self.using, self.variant)
    }
}

/// Cases that the tools of Siemens refuse. `*` means any text; of several words each means itself.
struct Refusal {
    kinds: &'static [&'static str],
    types: &'static [&'static str],
    uses: &'static [&'static str],
    /// One of these codes must come.
    code: &'static str,
}

const fn refusal(
    kinds: &'static [&'static str],
    types: &'static [&'static str],
    uses: &'static [&'static str],
    code: &'static str,
) -> Refusal {
    Refusal { kinds, types, uses, code }
}

impl Refusal {
    fn covers(&self, case: &Case) -> bool {
        let any = |patterns: &[&str], text: &str| patterns.iter().any(|pattern| matches(pattern, text));
        any(self.kinds, &case.kind) && any(self.types, case.ty) && any(self.uses, case.using)
    }
}

/// True if `text` is like `pattern`, in which `*` is any text.
fn matches(pattern: &str, text: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == text,
        Some((head, rest)) => text.strip_prefix(head).is_some_and(|tail| {
            (0..=tail.len()).filter(|&at| tail.is_char_boundary(at)).any(|at| matches(rest, &tail[at..]))
        }),
    }
}

/// The outcome of a case.
enum Outcome {
    /// Codes of the errors, and the messages.
    Refused(Vec<String>, String),
    Passed,
    Failed(String),
}

fn run(ending: &str, cpu: &str, source: String) -> Outcome {
    let mut read = Read { name: "matrix".to_string(), ..Read::default() };
    let mut names = [format!("matrix.{ending}"), "matrix.stl".to_string()].into_iter();
    for text in source.split(NEXT_FILE) {
        let name = names.next().expect("there are two files at most");
        read.units.push(read.sources.add(SourceFile::new(name, text)));
    }
    let settings = Settings { pragmas: true, require_main: true, cpu: Some(cpu.to_string()), ..Settings::default() };
    let bound = pipeline::front(read, &settings);
    if bound.has_errors() {
        let codes = bound.diagnostics.iter().filter(|message| message.is_error()).map(|m| m.code.name().to_string());
        return Outcome::Refused(codes.collect(), plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false));
    }
    let plain = pipeline::back(&bound, Level::O0);
    if let Err(errors) = plcc_ir::verify::verify(&plain.module) {
        return Outcome::Failed(format!("after lowering: {}", errors[0]));
    }
    let optimised = pipeline::back(&bound, Level::O2);
    if let Err(errors) = plcc_ir::verify::verify(&optimised.module) {
        return Outcome::Failed(format!("after the passes: {}", errors[0]));
    }
    let test = |compiled: &Compiled, code| {
        plcc_runtime::test(compiled.image.clone(), code, &TestOptions { cycles: Some(1), ..TestOptions::default() })
    };
    let mut reports = vec![("interpreter", test(&plain, code::interpreter(&plain)))];
    for (name, compiled) in [("-O0", &plain), ("-O2", &optimised)] {
        match code::jit(compiled) {
            Ok(code) => reports.push((name, test(compiled, code))),
            Err(error) => return Outcome::Failed(error.to_string()),
        }
    }
    for (name, report) in reports {
        if report.failed() > 0 || report.stopped.is_some() {
            return Outcome::Failed(format!("{name}: {report:?}"));
        }
    }
    Outcome::Passed
}

/// Passed programs of a language that become executables.
const EXECUTABLES: usize = 8;

/// Runs one in `stride` of the cases, and compares the refused ones with `refusals`.
fn campaign(cases: Vec<Case>, stride: usize, refusals: &[Refusal]) {
    let wish = std::env::var("PLCC_MATRIX").ok();
    let stride = match wish.as_deref() {
        Some("all") => 1,
        Some(number) => number.parse().expect("PLCC_MATRIX is `all` or a number"),
        None => stride,
    };
    let chosen: Vec<Case> = cases.into_iter().step_by(stride).collect();
    let mut counts: BTreeMap<&str, (u32, u32)> = BTreeMap::new();
    let mut failures = Vec::new();
    let mut passed = Vec::new();
    let count = chosen.len();
    for case in chosen {
        let source = (case.source)();
        let expected: Vec<&str> =
            refusals.iter().filter(|refusal| refusal.covers(&case)).map(|refusal| refusal.code).collect();
        let (ending, cpu, text) = (case.ending, case.cpu, source.clone());
        let outcome = plcc_driver::on_large_stack(move || run(ending, cpu, text)).unwrap_or_else(Outcome::Failed);
        let name = case.name();
        let counted = counts.entry(case.using).or_default();
        match outcome {
            Outcome::Passed if !expected.is_empty() => {
                failures.push(format!("{name}: is accepted, but the table says {expected:?}\n{source}"));
            }
            Outcome::Passed => {
                counted.0 += 1;
                passed.push((case, source));
            }
            Outcome::Refused(codes, messages) => {
                counted.1 += 1;
                if !expected.iter().any(|code| codes.iter().any(|found| found == code)) {
                    failures.push(format!("{name}: refused with {codes:?}\n{messages}\n{source}"));
                }
            }
            Outcome::Failed(error) => failures.push(format!("{name}: failed: {error}\n{source}")),
        }
    }
    println!("{count} cases, passed and refused: {counts:?}");
    if let Ok(path) = std::env::var("PLCC_MATRIX_FAILURES") {
        std::fs::write(path, failures.join("\n=====\n")).expect("the file can be written");
    }
    assert!(failures.is_empty(), "{} of {count} failed; the first:\n{}", failures.len(), first(&failures));
    executables(&passed);
}

/// Some of the programs as executables.
fn executables(passed: &[(Case, String)]) {
    let folder = tempfile::tempdir().expect("there is a folder for files that stay for a while");
    let mut inputs = Vec::new();
    // A test in one file.
    let passed: Vec<_> = passed.iter().filter(|(_, source)| !source.contains(NEXT_FILE)).collect();
    for (index, (case, source)) in passed.iter().step_by(passed.len().div_ceil(EXECUTABLES).max(1)).enumerate() {
        let path = folder.path().join(format!("case{index}.{}", case.ending));
        std::fs::write(&path, format!("//@ cpu {}\n{source}", case.cpu)).expect("the file can be written");
        inputs.push(plcc_driver::inputs::TestInput::File(path));
    }
    let variants = [Level::O0, Level::O2].map(|level| Variant { form: Form::Exe, optimization: level.into() }).to_vec();
    for outcome in plcc_driver::testing::run(&inputs, &plan(variants)) {
        assert!(outcome.failed == 0 && !outcome.unreadable, "{}{}", outcome.messages, outcome.failures);
    }
}

/// The names of all, and the first with its source.
fn first(failures: &[String]) -> String {
    let mut text: String =
        failures.iter().filter_map(|failure| failure.lines().next()).fold(String::new(), |all, line| all + line + "\n");
    text.push_str(&failures[0]);
    text
}
