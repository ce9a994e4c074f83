//! Pragmas of whole files.

use plcc_diag::{Code, Diagnostic, SourceMap, Span};
use plcc_model::{TestSettings, profile};
use plcc_syntax::ast::Pragma;

use crate::report::Report;
use crate::similar;

/// A pragma of the whole file.
pub fn file_pragma(report: &mut Report, pragma: &Pragma, settings: &mut TestSettings) {
    let (word, rest) = split(&pragma.text);
    match word {
        "cpu" => {
            let accumulators = rest.strip_prefix("accus=");
            let good = match accumulators {
                Some(count) => matches!(count, "2" | "4"),
                None => profile::lookup(rest).is_some(),
            };
            if !good {
                report.push(
                    Diagnostic::new(Code::UnknownCpu, pragma.span, "this CPU is not known")
                        .label(rest.to_string())
                        .help(profile::help(rest)),
                );
            }
        }
        "test" => {
            if let Some(code) = rest.strip_prefix("expect=fail").filter(|code| is_code(code)) {
                settings.expect_fail = Some(code.trim().to_ascii_uppercase());
            } else if let Some(Ok(cycles)) = rest.strip_prefix("cycles=").map(str::parse::<u32>) {
                settings.cycles = Some(cycles);
            } else if rest != "partial" {
                bad_pragma(
                    report,
                    pragma.span,
                    "`test` needs `cycles=N`, `expect=fail CODE` or `partial`",
                    "write `//@ test cycles=10`, `//@ test expect=fail 16#2521` or `//@ test partial`",
                );
            }
        }
        "assert" | "sleep" => bad_pragma(
            report,
            pragma.span,
            &format!("`{word}` must be between the statements of a block"),
            "move it after the statement that it checks",
        ),
        _ if word.starts_with('^') => {}
        _ => unknown_pragma(report, pragma),
    }
}

/// A code after `expect=fail`: of a message (`P0203`), of an event that stops the CPU (`16#2521`), of an S7-200 (`0011`); or nothing.
fn is_code(text: &str) -> bool {
    let code = text.trim();
    let hex = |digits: &str| digits.len() == 4 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    let known = hex(code)
        || code.strip_prefix("16#").is_some_and(hex)
        || code.len() == 5 && code.starts_with('P') && hex(&code[1..]);
    text.is_empty() || text.starts_with(char::is_whitespace) && known
}

/// A line `//@` that is not a pragma.
pub fn unknown_pragma(report: &mut Report, pragma: &Pragma) {
    bad_pragma(
        report,
        pragma.span,
        &format!("`{}` is not a pragma", split(&pragma.text).0),
        &match similar(split(&pragma.text).0, ["assert", "sleep", "test", "cpu"].into_iter()) {
            Some(meant) => format!("write `//@ {meant}`"),
            None => "the pragmas are assert, sleep, cpu and test; a plain comment begins with `//`".to_owned(),
        },
    );
}

/// A pragma with an invalid form.
pub fn bad_pragma(report: &mut Report, span: Span, title: &str, help: &str) {
    report.push(Diagnostic::new(Code::Pragma, span, title).label("not understood").help(help));
}

/// First word, and the rest without outer blanks.
pub fn split(text: &str) -> (&str, &str) {
    let text = text.trim();
    match text.split_once(char::is_whitespace) {
        Some((word, rest)) => (word, rest.trim()),
        None => (text, ""),
    }
}

/// True of an assignment that is overwritten, if an assertion between the two reads it. Only `plcc test` binds assertions.
pub fn is_asserted(message: &Diagnostic, sources: &SourceMap) -> bool {
    let second = message.primary.span;
    message.code == Code::DoubleCoil
        && message.secondary.iter().any(|first| {
            let first = first.span;
            first.file == second.file && has_assertion(sources, Span { start: first.end, end: second.start, ..second })
        })
}

/// True if a part of a source contains an assertion, also one that is not bound.
pub fn has_assertion(sources: &SourceMap, part: Span) -> bool {
    let text = sources.files().nth(part.file.0 as usize).map(|(_, file)| &file.text);
    let part = text.and_then(|text| text.get(part.start as usize..(part.end as usize).min(text.len())));
    part.is_some_and(|part| part.contains("@ assert"))
}
