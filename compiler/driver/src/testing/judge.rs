//! From the reports of all forms of a test to one outcome.

use plcc_diag::{Code, Diagnostic, SourceMap, Span, drawing};
use plcc_runtime::{AssertFailure, NOT_REACHED, TestReport};

use super::prepare::{Prepared, TestProgram, VariantState};
use super::{Outcome, Played, Variant};

/// Judges a test whose programs have all run.
pub fn judge(prepared: Prepared) -> Outcome {
    let Prepared { mut outcome, programs, coverage: _ } = prepared;
    let mut played = vec![Played::default(); programs.len()];
    let mut reports = Vec::new();
    for (at, program) in programs.iter().enumerate() {
        if let Some(report) = added(&mut outcome, &mut played[at], |outcome| agreed_report(program, outcome)) {
            reports.push((at, program, report));
        }
    }
    for (at, program, report) in &reports {
        // With several scenarios an assertion must be reached in one of them.
        let reached_elsewhere = |line: &(String, u32)| {
            reports.iter().any(|(.., other)| !other.not_reached.iter().any(|n| (&n.file, n.line) == (&line.0, line.1)))
        };
        added(&mut outcome, &mut played[*at], |outcome| add_report(program, report, reached_elsewhere, outcome));
    }
    let scenarios = programs.iter().zip(played).filter_map(|(program, played)| {
        let file = program.options.scenario.as_ref()?.display().to_string();
        Some(Played { file, ..played })
    });
    outcome.scenarios = scenarios.collect();
    outcome
}

/// Does a part of the work on an outcome; what that adds to it goes to a scenario, too.
fn added<T>(outcome: &mut Outcome, played: &mut Played, work: impl FnOnce(&mut Outcome) -> T) -> T {
    let (passed, failed, length) = (outcome.passed, outcome.failed, outcome.failures.len());
    let result = work(outcome);
    played.passed += outcome.passed - passed;
    played.failed += outcome.failed - failed;
    played.failures.push_str(&outcome.failures[length..]);
    result
}

/// The report of the first form, if all forms agree.
fn agreed_report<'a>(program: &'a TestProgram, outcome: &mut Outcome) -> Option<&'a TestReport> {
    let mut first: Option<(Variant, &TestReport)> = None;
    for (variant, state) in &program.variants {
        match state {
            VariantState::Done(report) => match first {
                None => first = Some((*variant, report)),
                Some((_, agreed)) if agreed == report => {}
                Some((other, agreed)) => {
                    let text = format!("{}: {variant} and {other} do not agree\n", outcome.name);
                    outcome.fail(&format!("{text}  {other}: {}\n  {variant}: {}", brief(agreed), brief(report)));
                }
            },
            VariantState::Broken(message) => {
                outcome.fail(&format!("{}: {variant}: internal fault, please report it: {message}", outcome.name));
            }
            VariantState::Object { .. } => {
                outcome.fail(&format!("{}: {variant}: internal fault: the object was not linked", outcome.name));
            }
        }
    }
    first.map(|(_, report)| report)
}

/// A report in one line, for a comparison.
fn brief(report: &TestReport) -> String {
    let failures = report.failures.iter().map(|f| format!("line {}: {} against {}", f.line, f.left, f.right));
    let not_reached = report.not_reached.iter().map(|n| format!("line {} not reached", n.line));
    let mut parts = vec![format!("{} passed, {} cycles", report.passed, report.cycles)];
    parts.extend(failures.chain(not_reached).chain(report.problems.iter().cloned()).chain(report.stopped.clone()));
    parts.join("; ")
}

fn add_report(
    program: &TestProgram,
    report: &TestReport,
    reached_elsewhere: impl Fn(&(String, u32)) -> bool,
    outcome: &mut Outcome,
) {
    outcome.passed += report.passed;
    if report.passed == 0 && report.failed() == 0 {
        let scenario = program.options.scenario.as_ref().map(|path| path.display().to_string());
        outcome.untested.push(scenario.unwrap_or_else(|| outcome.name.clone()));
    }
    // What came after a fault that stopped the CPU follows from it.
    let stopped = report.stopped.is_some() && !report.problems.is_empty();
    let follows = |failure: &&AssertFailure| stopped && failure.left == NOT_REACHED;
    for failure in &report.failures {
        outcome.details.push(failure.clone());
        if !follows(&failure) {
            outcome.fail(&described(failure));
        }
    }
    let unreached = report.not_reached.iter().filter(|place| !reached_elsewhere(&(place.file.clone(), place.line)));
    let unreached: Vec<_> = unreached.collect();
    for place in unreached.iter().filter(|_| !stopped) {
        outcome.fail(&format!("{}:{}: {}\n       was never executed", place.file, place.line, place.text));
        if let Some(message) = not_reached(&program.sources, &place.file, place.line) {
            outcome.messages.push_str(&drawing::draw(&[message], &program.sources, false));
        }
    }
    for problem in &report.problems {
        let scenario = program.options.scenario.as_ref().map(|path| format!(" ({})", path.display()));
        let after = unjudged(report.failures.iter().filter(follows).count(), if stopped { unreached.len() } else { 0 });
        outcome.fail(&format!("{}{}: {problem}{after}", outcome.name, scenario.unwrap_or_default()));
    }
}

/// What was not checked because a fault stopped the CPU.
fn unjudged(expectations: usize, assertions: usize) -> String {
    let line = |count: usize, what: &str| match count {
        0 => String::new(),
        1 => format!("\n       1 {what} was not reached"),
        count => format!("\n       {count} {what}s were not reached"),
    };
    line(expectations, "expectation") + &line(assertions, "assertion")
}

/// An assertion or expectation that failed: what was expected, what came, when, and what is beside it.
fn described(failure: &AssertFailure) -> String {
    let AssertFailure { file, line, text, left, right, .. } = failure;
    let mut lines = vec![format!("{file}:{line}: {text}")];
    if failure.ty.is_empty() {
        lines.extend([format!("left  {left}"), format!("right {right}")]);
    } else {
        // An address that does not exist has no value of the type.
        let is_absent = failure.when.is_some() && failure.values.is_none();
        let ty = if is_absent { String::new() } else { format!(" ({})", failure.ty) };
        lines.extend([format!("expected {right}"), format!("found    {left}{ty}")]);
    }
    if let Some(place) = failure.place() {
        lines.push(place);
    }
    if !failure.beside.is_empty() {
        lines.push(format!("other values: {}", failure.beside.join(", ")));
    }
    lines.join("\n       ")
}

/// The message about an assertion that no cycle reached.
fn not_reached(sources: &SourceMap, name: &str, line: u32) -> Option<Diagnostic> {
    let (id, file) = sources.files().find(|(_, file)| file.name == name)?;
    if line == 0 || line > file.line_count() {
        return None;
    }
    let text = file.line_text(line);
    let start = file.line_range(line).start;
    let indent = text.len() - text.trim_start().len();
    let span = Span::new(id, start + indent..start + text.trim_end().len());
    let message = Diagnostic::new(Code::AssertionNotReached, span, "this assertion was never executed");
    Some(message.help("make the program reach it, with more cycles (`//@ test cycles=N`) or other inputs"))
}
