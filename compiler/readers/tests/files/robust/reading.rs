//! What must hold for any text.

use std::time::Duration;

use plcc_diag::{Diagnostic, FileId};
use plcc_readers::{ReadOptions, parse, plcopen, tokens_text};
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::{Language, ast_text};
use rustix::time::{ClockId, clock_gettime};

/// Options for a source of a language, or of one that is found in the text.
pub fn of(language: Option<Language>) -> ReadOptions<'static> {
    ReadOptions { pragmas: true, language, ..ReadOptions::default() }
}

/// Reads a text as `language` with and without pragmas, and as what it looks like.
pub fn read(text: &str, language: Option<Language>) {
    read_with(text, &ReadOptions { pragmas: false, ..of(language) });
    read_with(text, &of(language));
    if language.is_some() {
        read_with(text, &of(None));
    }
}

/// Reads a text, prints what it is, and checks that messages and blocks have their places in the text.
pub fn read_with(text: &str, options: &ReadOptions) -> (SourceUnit, Vec<Diagnostic>) {
    let (unit, diagnostics) = parse(FileId(0), text, options);
    let project = plcopen::is_project(text);
    for diagnostic in &diagnostics {
        for label in std::iter::once(&diagnostic.primary).chain(&diagnostic.secondary) {
            assert!(text.get(label.span.range()).is_some(), "a message lies outside the text: {diagnostic:?}");
        }
        assert!(!diagnostic.title.is_empty(), "{diagnostic:?}");
        // Of a project in PLCopen XML, the title says it all.
        assert!(project || !diagnostic.primary.text.is_empty(), "{diagnostic:?}");
    }
    if let Some(overlay) = &unit.overlay {
        assert_eq!(overlay.len(), text.len());
        for block in &unit.blocks {
            assert!(text.get(block.span().range()).is_some());
        }
    }
    ast_text(&unit);
    tokens_text(text, options);
    (unit, diagnostics)
}

/// Reading the text must end in `limit`, of processor time: other work of the computer does not count.
pub fn soon(limit: Duration, text: &str, options: &ReadOptions) {
    let start = processor_time();
    parse(FileId(0), text, options);
    let needed = processor_time() - start;
    let head: String = text.chars().take(60).collect();
    assert!(needed < limit, "{needed:?} for {} bytes: {head}", text.len());
}

/// Processor time of this thread.
fn processor_time() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}
