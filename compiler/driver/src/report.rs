//! Messages to standard error.

use std::io::{IsTerminal, Write};

use clap::ValueEnum;
use plcc_diag::{Diagnostic, Severity, SourceMap, drawing, json, sarif};

use crate::command::exit;

/// Format of the messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MessageFormat {
    /// Text with source lines, for people.
    #[default]
    Human,
    /// One JSON object per line.
    Json,
    /// One SARIF 2.1.0 document.
    Sarif,
}

/// Writes all messages, sorted by file and place.
pub fn messages(diagnostics: &mut [Diagnostic], sources: &SourceMap, format: MessageFormat) {
    plcc_diag::sort(diagnostics);
    let color = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let text = match format {
        MessageFormat::Human => drawing::draw(diagnostics, sources, color),
        MessageFormat::Json => json::lines(diagnostics, sources),
        MessageFormat::Sarif => sarif::document(diagnostics, sources),
    };
    line_free(&text);
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
