//! Messages to standard error, data to standard output.

use std::io::{IsTerminal, Write};

use clap::ValueEnum;
use plcc_diag::{Diagnostic, Severity, SourceMap, drawing, json, sarif};

use crate::command::exit;

/// Format of the messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MessageFormat {
    /// Text with source lines, for people, on standard error.
    #[default]
    Human,
    /// One JSON object per line, on standard output.
    Json,
    /// One SARIF 2.1.0 document, on standard output.
    Sarif,
}

/// Writes all messages for people, sorted by file and place.
pub fn messages(diagnostics: &mut [Diagnostic], sources: &SourceMap) {
    plcc_diag::sort(diagnostics);
    let color = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    line_free(&drawing::draw(diagnostics, sources, color));
}

/// Writes all messages in a format. `Err`: the exit code, where standard output cannot be written.
pub fn messages_as(diagnostics: &mut [Diagnostic], sources: &SourceMap, format: MessageFormat) -> Result<(), u8> {
    plcc_diag::sort(diagnostics);
    match format {
        MessageFormat::Human => {
            messages(diagnostics, sources);
            Ok(())
        }
        MessageFormat::Json => print(&json::lines(diagnostics, sources)),
        MessageFormat::Sarif => print(&sarif::document(diagnostics, sources)),
    }
}

/// `2 errors, 1 warning`; empty if there are none. The line does not begin with the word error.
pub fn summary(diagnostics: &[Diagnostic]) -> String {
    let count = |severity| diagnostics.iter().filter(|d| d.severity == severity).count();
    let plural = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
    match (count(Severity::Error), count(Severity::Warning)) {
        (0, 0) => String::new(),
        (0, warnings) => plural(warnings, "warning"),
        (errors, 0) => plural(errors, "error"),
        (errors, warnings) => format!("{}, {}", plural(errors, "error"), plural(warnings, "warning")),
    }
}

/// Writes a text to standard output. `Err`: the exit code, where it cannot be written; a closed pipe (`| head`) is not a fault.
pub fn print(text: &str) -> Result<(), u8> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            say(&format!("cannot write to standard output: {error}"));
            Err(exit::USAGE)
        }
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Writes another text to standard error, after the name of the program.
pub fn say(text: &str) {
    line_free(&format!("plcc: {}\n", plcc_runtime::files::without_numbers(text)));
}

/// Writes a text of a program that runs to standard error, as it is.
pub fn tell(text: &str) {
    line_free(&format!("{}\n", plcc_runtime::files::without_numbers(text)));
}

/// Writes to standard error; a failure cannot be reported.
fn line_free(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}
