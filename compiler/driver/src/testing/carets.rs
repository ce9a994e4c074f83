//! Caret pragmas: `//@   ^^^^^ CODE` marks the message that is expected for the line above.
//!
//! A file with carets passes if it produces exactly the marked messages, at the marked spans; it is not run.

use plcc_diag::{Code, Diagnostic, FileId, SourceFile, SourceMap, Span};

/// A message in the form of a caret line. Columns are 1-based and count characters; `end` is the column after the last.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Mark {
    pub line: u32,
    pub start: u32,
    pub end: u32,
    pub code: Code,
}

impl std::fmt::Display for Mark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} at {}:{}-{}", self.code.name(), self.line, self.start, self.end)
    }
}

/// Columns that `//@` occupies on a caret line: these cannot be marked.
const PRAGMA_COLUMNS: u32 = 3;

/// True if `text` has a caret line.
pub fn has_carets(text: &str) -> bool {
    text.lines().any(|line| caret_text(line).is_some())
}

/// The part after `//@` on a caret line.
fn caret_text(line: &str) -> Option<&str> {
    line.trim_start().strip_prefix("//@").filter(|rest| rest.trim_start().starts_with('^'))
}

/// The marks of a file, and messages about caret lines that cannot be understood.
pub fn marks(file: FileId, source: &SourceFile) -> (Vec<Mark>, Vec<Diagnostic>) {
    let (mut marks, mut diagnostics) = (Vec::new(), Vec::new());
    let mut above = 0;
    for line in 1..=source.line_count() {
        let text = source.line_text(line);
        let Some(rest) = caret_text(text) else {
            above = line;
            continue;
        };
        let carets: String = rest.trim_start().chars().take_while(|&c| c == '^').collect();
        let name = rest.trim_start().trim_start_matches('^').trim();
        let start = text.chars().position(|c| c == '^').unwrap_or_default() as u32 + 1;
        match Code::from_name(name) {
            Some(code) if above > 0 => {
                marks.push(Mark { line: above, start, end: start + carets.len() as u32, code });
            }
            Some(_) | None => {
                let range = source.line_range(line);
                let span = Span::new(file, range.start..range.start + text.len());
                let message = Diagnostic::new(Code::Pragma, span, "a caret line without the code of a message");
                diagnostics.push(message.help("write `//@   ^^^^ P0203` below the line with the message"));
            }
        }
    }
    marks.sort();
    (marks, diagnostics)
}

/// A message as a mark; for a span over several lines, its first line.
pub fn mark_of(diagnostic: &Diagnostic, sources: &SourceMap) -> Mark {
    let span = diagnostic.primary.span;
    let file = sources.file(span.file);
    let (line, start) = file.line_column(span.start);
    let line_end = file.line_range(line).start + file.line_text(line).len();
    let (end_line, end) = file.line_column(span.end.min(line_end as u32).max(span.start));
    let end = if end_line == line { end } else { start };
    Mark { line, start, end: end.max(start + 1), code: diagnostic.code }
}

/// Compares the marks of a file with its messages. Returns the number of matched marks, and a line for each difference.
pub fn compare(marks: &[Mark], diagnostics: &[Diagnostic], sources: &SourceMap) -> (u32, Vec<String>) {
    let mut missing = marks.to_vec();
    let mut failures = Vec::new();
    let mut passed = 0;
    for diagnostic in diagnostics {
        let mark = mark_of(diagnostic, sources);
        if let Some(index) = missing.iter().position(|other| *other == mark) {
            missing.swap_remove(index);
            passed += 1;
        } else {
            failures.push(format!("not marked: {mark}: {}", diagnostic.title));
        }
    }
    missing.sort();
    failures.extend(missing.iter().map(|mark| format!("missing: {mark}")));
    (passed, failures)
}

/// `text` with its caret lines replaced by those for `marks`. Marks in the first three columns cannot be written.
pub fn rewrite(text: &str, marks: &[Mark]) -> String {
    let newline = if text.contains("\r\n") { "\r\n" } else { "\n" };
    let mut marks = marks.to_vec();
    marks.sort();
    let mut rewritten = String::new();
    for (index, line) in text.lines().enumerate() {
        if caret_text(line).is_some() {
            continue;
        }
        rewritten.push_str(line);
        rewritten.push_str(newline);
        // Line numbers count the old caret lines.
        for mark in marks.iter().filter(|mark| mark.line as usize == index + 1 && mark.start > PRAGMA_COLUMNS) {
            let blanks = " ".repeat((mark.start - PRAGMA_COLUMNS - 1) as usize);
            let carets = "^".repeat((mark.end - mark.start) as usize);
            rewritten.push_str(&format!("//@{blanks}{carets} {}{newline}", mark.code.name()));
        }
    }
    rewritten
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "      A     MW 10\n//@         ^^^^^ P0203\n      =     Q 4.0\n";

    #[test]
    fn a_caret_line_marks_the_line_above() {
        let source = SourceFile::new("x.stl", TEXT);
        let (marks, diagnostics) = marks(FileId(0), &source);
        assert_eq!(marks, [Mark { line: 1, start: 13, end: 18, code: Code::OperandKind }]);
        assert_eq!(diagnostics, []);
        assert!(has_carets(TEXT) && !has_carets("//@ assert 1 == 2 ^"));
    }

    #[test]
    fn messages_and_marks_must_be_the_same() {
        let mut sources = SourceMap::default();
        let file = sources.add(SourceFile::new("x.stl", TEXT));
        let (marks, _) = marks(file, sources.file(file));
        let message = |range| Diagnostic::new(Code::OperandKind, Span::new(file, range), "no");
        assert_eq!(compare(&marks, &[message(12..17)], &sources), (1, vec![]));
        assert_eq!(compare(&marks, &[message(12..16)], &sources).1.len(), 2);
        assert_eq!(compare(&marks, &[], &sources).1, ["missing: P0203 at 1:13-18"]);
        // An empty span, or one beyond the end of the line, is marked too.
        assert_eq!(mark_of(&message(17..17), &sources).end, 19);
        assert_eq!(mark_of(&message(12..60), &sources).end, 18);
    }

    #[test]
    fn rewriting_gives_what_was_there() {
        let source = SourceFile::new("x.stl", TEXT);
        let (marks, _) = marks(FileId(0), &source);
        assert_eq!(rewrite(TEXT, &marks), TEXT);
        assert_eq!(rewrite(TEXT, &[]), "      A     MW 10\n      =     Q 4.0\n");
    }

    #[test]
    fn a_caret_line_needs_a_code() {
        let source = SourceFile::new("x.stl", "      A     MW 10\n//@         ^^^^^\n");
        assert_eq!(marks(FileId(0), &source).1[0].code, Code::Pragma);
    }
}
