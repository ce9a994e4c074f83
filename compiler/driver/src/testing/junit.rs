//! The results of tests as a JUnit report, which CI services read.

use std::fmt::Write;
use std::path::Path;

use super::{Outcome, Played};

/// A case of the report.
struct Case<'o> {
    class: String,
    name: String,
    assertions: u64,
    failed: bool,
    failures: &'o str,
    /// Of the compiler.
    messages: &'o str,
    is_compiled: bool,
}

/// One suite with a case for each test, or for each scenario of a test that has several; `assertions` counts what it checked.
pub fn report(outcomes: &[Outcome]) -> String {
    let cases: Vec<Case> = outcomes.iter().flat_map(cases).collect();
    let failed = cases.iter().filter(|case| case.failed && case.is_compiled).count();
    let errors = cases.iter().filter(|case| !case.is_compiled).count();
    let counts = format!("tests=\"{}\" failures=\"{failed}\" errors=\"{errors}\"", cases.len());
    let mut out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned();
    let _ = writeln!(out, "<testsuites name=\"plcc\" {counts}>\n  <testsuite name=\"plcc\" {counts}>");
    for case in &cases {
        let (class, name) = (escaped(&case.class), escaped(&case.name));
        let assertions = case.assertions;
        let _ = write!(out, "    <testcase classname=\"{class}\" name=\"{name}\" assertions=\"{assertions}\"");
        let element = match (case.is_compiled, case.failed) {
            (true, false) => {
                out.push_str("/>\n");
                continue;
            }
            (true, true) => "failure",
            (false, _) => "error",
        };
        let text = escaped(&format!("{}{}", case.failures, case.messages));
        let first = escaped(case.failures.lines().next().unwrap_or_default());
        let _ = writeln!(out, ">\n      <{element} message=\"{first}\">{text}</{element}>\n    </testcase>");
    }
    out.push_str("  </testsuite>\n</testsuites>\n");
    out
}

/// The cases of a test: itself, or its scenarios, whose class it is.
fn cases(outcome: &Outcome) -> Vec<Case<'_>> {
    let is_compiled = is_compiled(outcome);
    if !is_compiled || outcome.scenarios.len() < 2 {
        return vec![Case {
            class: "plcc".to_owned(),
            name: name_of(outcome),
            assertions: outcome.passed + outcome.failed,
            failed: outcome.failed > 0,
            failures: &outcome.failures,
            messages: &outcome.messages,
            is_compiled,
        }];
    }
    let class = name_of(outcome);
    let case = |played| scenario_case(outcome, &class, played);
    outcome.scenarios.iter().map(case).collect()
}

fn scenario_case<'o>(outcome: &'o Outcome, class: &str, played: &'o Played) -> Case<'o> {
    let file = Path::new(&played.file);
    let inside = file.strip_prefix(&outcome.name).unwrap_or(file);
    Case {
        class: class.to_owned(),
        name: inside.display().to_string(),
        assertions: played.passed + played.failed,
        failed: played.failed > 0,
        failures: &played.failures,
        messages: &outcome.messages,
        is_compiled: true,
    }
}

/// The path of a test. For the project in this folder it is the name of the folder, since `.` means nothing in another one.
fn name_of(outcome: &Outcome) -> String {
    let path = Path::new(&outcome.name);
    let folder = if path.file_name().is_none() { path.canonicalize().ok() } else { None };
    let name = folder.as_ref().and_then(|folder| folder.file_name());
    name.map_or_else(|| outcome.name.clone(), |name| name.to_string_lossy().into_owned())
}

fn is_compiled(outcome: &Outcome) -> bool {
    !outcome.rejected && !outcome.unreadable
}

/// A text inside XML; characters that XML cannot hold become `?`.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' => out.push(c),
            '\u{FFFE}' | '\u{FFFF}' => out.push('?'),
            c if c < ' ' => out.push('?'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_and_errors_are_told_apart() {
        let passed = Outcome { name: "a.stl".to_owned(), passed: 3, ..Outcome::default() };
        let mut failed = Outcome { name: "<b>.stl".to_owned(), ..Outcome::default() };
        failed.fail("b.stl:3: ACCU1 < 5 & \"x\"\u{1}");
        let mut broken = Outcome { name: "c.stl".to_owned(), rejected: true, ..Outcome::default() };
        broken.fail("c.stl: 1 error");
        let text = report(&[passed, failed, broken]);
        assert!(text.contains("tests=\"3\" failures=\"1\" errors=\"1\""), "{text}");
        assert!(text.contains("name=\"a.stl\" assertions=\"3\"/>"), "{text}");
        assert!(text.contains("name=\"&lt;b&gt;.stl\""), "{text}");
        assert!(text.contains("FAILED b.stl:3: ACCU1 &lt; 5 &amp; &quot;x&quot;?"), "{text}");
        assert!(text.contains("<error message=\"FAILED c.stl: 1 error\">"), "{text}");
    }

    #[test]
    fn each_of_several_scenarios_is_a_case() {
        let good = Played { file: "line/tests/good.toml".to_owned(), passed: 3, ..Played::default() };
        let failures = "FAILED line/tests/bad.toml:4: Q0.0\n".to_owned();
        let bad = Played { file: "line/tests/bad.toml".to_owned(), passed: 1, failed: 1, failures: failures.clone() };
        let sums = Outcome { name: "line".to_owned(), passed: 4, failed: 1, failures, ..Outcome::default() };
        let text = report(&[Outcome { scenarios: vec![good, bad], ..sums }]);
        assert!(text.contains("tests=\"2\" failures=\"1\" errors=\"0\""), "{text}");
        assert!(text.contains("<testcase classname=\"line\" name=\"tests/good.toml\" assertions=\"3\"/>"), "{text}");
        assert!(
            text.contains("name=\"tests/bad.toml\" assertions=\"2\">\n      <failure message=\"FAILED line"),
            "{text}"
        );
    }
}
