//! `plcc test`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use plcc_coverage::data::Sums;
use plcc_runtime::AssertFailure;
use serde_json::json;

use crate::cli::{FormArg, TestArgs};
use crate::command::exit;
use crate::inputs::{self, TestInput};
use crate::pipeline::Settings;
use crate::report;
use crate::testing::{self, Form, Outcome, Plan, Variant, coverage, find, junit, watch};

/// Runs all tests, once or after each change of a source.
pub fn test(args: &TestArgs) -> u8 {
    let paths = match inputs::or_here(&args.inputs) {
        Ok(paths) => paths,
        Err(code) => return code,
    };
    if !args.watch {
        return once(args, &paths);
    }
    loop {
        let seen = watch::look(&paths);
        once(args, &paths);
        report::say("waiting for a change; end with Ctrl+C");
        watch::wait(&paths, seen);
    }
}

/// Whether a name is that of a file for coverage, which would become the name of a folder.
fn is_for_a_file(output: &Path) -> bool {
    let ends_in = |ending: &str| output.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending));
    !output.is_dir() && ["info", "html", "xml", "json"].into_iter().any(ends_in)
}

/// Runs all tests and prints what failed, then `N passed, M failed`; or all of it as JSON.
fn once(args: &TestArgs, paths: &[PathBuf]) -> u8 {
    tested(args, paths).unwrap_or_else(|message| {
        report::say(&message);
        exit::USAGE
    })
}

/// As [`once`]. `Err`: why no test runs, or what cannot be written.
fn tested(args: &TestArgs, paths: &[PathBuf]) -> Result<u8, String> {
    check_coverage(args)?;
    let plan = plan(args);
    let mut text = String::new();
    let tests = found(args, paths, &mut text)?;
    let (outcomes, counted) = testing::run_counted(&tests, &plan);
    if let Some(file) = &args.junit {
        let written = std::fs::write(file, junit::report(&outcomes));
        written.map_err(|error| format!("cannot write `{}`: {error}", file.display()))?;
    }
    if let Some(folder) = &args.coverage {
        coverage::write(&counted, folder)?;
    }
    if outcomes.is_empty() {
        return Err(match paths.iter().find_map(|path| inputs::project_above(path)) {
            Some(folder) => {
                format!("no source in the given folders, which belong to a project: write `plcc test {folder}`")
            }
            None => "no source in the given folders".to_string(),
        });
    }
    for outcome in &outcomes {
        eprint!("{}", outcome.messages);
        text.push_str(&outcome.failures);
        for file in &outcome.untested {
            let _ = writeln!(text, "no assertions: {file}");
        }
    }
    let sum = |count: fn(&Outcome) -> u64| outcomes.iter().map(count).sum::<u64>();
    let failed = sum(|outcome| outcome.failed);
    if let Some(folder) = &args.coverage {
        let _ = writeln!(text, "coverage in {}: {}", folder.display(), counted.sums());
    }
    let _ = writeln!(text, "{} passed, {failed} failed", sum(|outcome| outcome.passed));
    if args.json {
        text = json(&outcomes, plan.coverage.then(|| counted.sums()));
    }
    if let Err(code) = report::print(&text) {
        return Ok(code);
    }
    Ok(if outcomes.iter().any(|outcome| outcome.unreadable) {
        exit::USAGE
    } else if outcomes.iter().any(|outcome| outcome.rejected) {
        exit::COMPILE
    } else if failed > 0 {
        exit::FAILED
    } else {
        exit::OK
    })
}

/// `Err`: why there can be no coverage as asked.
fn check_coverage(args: &TestArgs) -> Result<(), String> {
    let Some(output) = args.coverage.as_deref() else { return Ok(()) };
    if args.form == FormArg::Exe {
        let why = "executables do not count what they run; use --coverage with `--form jit`, `interp` or `all`";
        return Err(why.to_string());
    }
    if is_for_a_file(output) {
        let output = output.display();
        return Err(format!(
            "--coverage {output}: this is a file; name a folder, which gets `lcov.info` and `index.html`"
        ));
    }
    Ok(())
}

/// How the tests are compiled and run.
fn plan(args: &TestArgs) -> Plan {
    let forms: &[Form] = match args.form {
        FormArg::Interp => &[Form::Interp],
        FormArg::Jit => &[Form::Jit],
        FormArg::Exe => &[Form::Exe],
        FormArg::All => &[Form::Interp, Form::Jit, Form::Exe],
    };
    let optimization = args.optimization.optimization();
    Plan {
        settings: Settings::new(&args.compile),
        variants: forms.iter().map(|&form| Variant { form, optimization }).collect(),
        linker: args.linker.clone(),
        coverage: args.coverage.is_some(),
    }
}

/// The tests below `paths` that the filter takes; `text` gets a line for each scenario that belongs to none. `Err`: the filter takes none.
fn found(args: &TestArgs, paths: &[PathBuf], text: &mut String) -> Result<Vec<TestInput>, String> {
    let mut tests = find::find_tests(paths);
    for scenario in find::lone_scenarios(paths, &tests) {
        let _ = writeln!(text, "no source next to the scenario: {}", scenario.display());
    }
    for scenario in find::strayed_scenarios(&tests) {
        let path = scenario.display();
        let _ = writeln!(text, "not played, because scenarios of a project are below its folder `tests`: {path}");
    }
    if let Some(part) = &args.filter {
        let found = tests.len();
        tests.retain(|test| testing::name_of(test).contains(part.as_str()));
        if tests.is_empty() && found > 0 {
            return Err(match found {
                1 => format!("the only test does not have `{part}` in its path"),
                _ => format!("none of the {found} tests has `{part}` in its path"),
            });
        }
    }
    Ok(tests)
}

/// One object: the sums, and each test with its failures.
fn json(outcomes: &[Outcome], coverage: Option<Sums>) -> String {
    let tests = outcomes.iter().map(|outcome| {
        json!({
            "name": outcome.name,
            "passed": outcome.passed,
            "failed": outcome.failed,
            "compiled": !outcome.rejected && !outcome.unreadable,
            "failures": outcome.details.iter().map(failure).collect::<Vec<_>>(),
            "text": outcome.failures,
            "messages": outcome.messages,
            "no_assertions": outcome.untested,
        })
    });
    let tests: Vec<_> = tests.collect();
    let sum = |count: fn(&Outcome) -> u64| outcomes.iter().map(count).sum::<u64>();
    let mut all = json!({
        "passed": sum(|outcome| outcome.passed),
        "failed": sum(|outcome| outcome.failed),
        "tests": tests,
    });
    if let Some(sums) = coverage {
        all["coverage"] = json!(sums);
    }
    format!("{all}\n")
}

fn failure(failure: &AssertFailure) -> serde_json::Value {
    let (cycle, time) = failure.when.unzip();
    let texts = || (failure.left.as_str().into(), failure.right.as_str().into());
    let (found, expected) = failure.values.clone().unwrap_or_else(texts);
    json!({
        "file": failure.file,
        "line": failure.line,
        "text": failure.text,
        "found": found,
        "expected": expected,
        "type": failure.ty,
        "cycle": cycle,
        "time_ms": time.map(|time: u64| time as f64 / 1e6),
        "beside": failure.beside,
    })
}
