//! The results of tests as a JUnit report, which CI services read.

use std::fmt::Write;
use std::path::Path;

use super::Outcome;

/// One suite with a case for each test; `assertions` counts what it checked.
pub fn report(outcomes: &[Outcome]) -> String {
    let failed = outcomes.iter().filter(|outcome| outcome.failed > 0 && is_compiled(outcome)).count();
    let errors = outcomes.iter().filter(|outcome| !is_compiled(outcome)).count();
    let counts = format!("tests=\"{}\" failures=\"{failed}\" errors=\"{errors}\"", outcomes.len());
    let mut out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned();
    let _ = writeln!(out, "<testsuites name=\"plcc\" {counts}>\n  <testsuite name=\"plcc\" {counts}>");
    for outcome in outcomes {
        let name = escaped(&name_of(outcome));
        let assertions = outcome.passed + outcome.failed;
        let _ = write!(out, "    <testcase classname=\"plcc\" name=\"{name}\" assertions=\"{assertions}\"");
        let element = match (is_compiled(outcome), outcome.failed) {
            (true, 0) => {
                out.push_str("/>\n");
                continue;
            }
            (true, _) => "failure",
            (false, _) => "error",
        };
        let text = escaped(&format!("{}{}", outcome.failures, outcome.messages));
        let first = escaped(outcome.failures.lines().next().unwrap_or_default());
        let _ = writeln!(out, ">\n      <{element} message=\"{first}\">{text}</{element}>\n    </testcase>");
    }
    out.push_str("  </testsuite>\n</testsuites>\n");
    out
}

/// The path of a test. That of the project in this folder, `.`, says nothing outside: the folder has a name.
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
}
