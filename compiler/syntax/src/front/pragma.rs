//! Pragmas: comment lines `//@ …`, and how the front ends come by them.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use plcc_literal::duration::{self, Fraction, Smallest};

use super::comment::{Comment, CommentForm};
use super::cursor::Cursor;
use crate::ast::Pragma;
use crate::stl;

/// Whether the comment is a pragma. Lines of carets mark expected messages; the compiler ignores them.
pub fn is_pragma(comment: &str) -> bool {
    comment.strip_prefix("//@").is_some_and(|text| !text.trim_start().starts_with('^'))
}

/// Whether the pragma applies to the file: `cpu`, `test`.
pub fn is_for_file(pragma: &Pragma) -> bool {
    matches!(pragma.text.split_ascii_whitespace().next(), Some("cpu" | "test"))
}

/// The warning about a comment that would be a pragma without a blank, `// @assert Q0.0 == 1`, or on a line of its own: an assertion that
/// nobody checks is a test that cannot fail.
pub fn nearly(file: FileId, source: &str, comment: Comment) -> Option<Diagnostic> {
    let start = comment.start as usize;
    let written = source.get(comment.range())?.trim_end();
    let text = written.strip_prefix("//")?.trim_start().strip_prefix('@')?.trim_start();
    let (word, rest) = text.split_once(char::is_whitespace)?;
    let is_meant = match word {
        "assert" => rest.contains(['=', '<', '>']),
        "sleep" => rest.trim_start().starts_with(|c: char| c.is_ascii_digit()),
        "test" => ["cycles=", "expect=", "partial"].iter().any(|form| rest.trim_start().starts_with(form)),
        "cpu" => rest.split_whitespace().count() == 1,
        _ => false,
    };
    if comment.form != CommentForm::Line || !is_meant || comment.own_line && is_pragma(written) {
        return None;
    }
    let end = start + written.len() - rest.len();
    let shown = source[start..end].trim_end();
    let help = match word {
        "sleep" => sleep_help(rest),
        _ => format!("write `//@ {word} {}`", rest.trim()),
    };
    let place = if comment.own_line { "" } else { " on a line of its own" };
    let span = Span::new(file, start..start + shown.len());
    let mut message = Diagnostic::new(Code::Pragma, span, format!("`{shown}` is only a comment"))
        .label("`plcc test` does not read it")
        .help(format!("{help}{place}"));
    message.severity = Severity::Warning;
    Some(message)
}

/// What to write for `//@ sleep 5s`, `5 s`, `5,0 sec`.
pub fn sleep_help(time: &str) -> String {
    let time: String = time.split_whitespace().collect::<String>().replace(',', ".");
    let ms = time.parse::<u32>().ok().or_else(|| {
        let written = duration::nanoseconds(&time, Smallest::Nanosecond, Fraction::Anywhere).ok();
        let ns = written.or_else(|| duration::span(&duration::meant_span(&time)?).map(i128::from))?;
        u32::try_from(ns / 1_000_000).ok().filter(|ms| *ms > 0)
    });
    match ms {
        Some(ms) => format!("write `//@ sleep {ms}`"),
        None => "write `//@ sleep` and a number of milliseconds".to_owned(),
    }
}

/// The first comment line `//@` from number `next` on that begins before byte `before`; `next` is then its number.
pub fn next(source: &str, comments: &[Comment], next: &mut usize, before: u32) -> Option<Comment> {
    while let Some(comment) = comments.get(*next).copied() {
        if comment.start >= before {
            return None;
        }
        if comment.own_line && comment.form == CommentForm::Line && is_pragma(&source[comment.range()]) {
            return Some(comment);
        }
        *next += 1;
    }
    None
}

/// The pragma in the comment at `range` of the source. If it is an assertion, also the bytes of what it asserts.
pub fn read(file: FileId, source: &str, range: Range<usize>) -> (Pragma, Option<Range<usize>>) {
    let start = range.start;
    let comment = source[range].trim_end();
    let end = start + comment.len();
    let text = comment.strip_prefix("//@").unwrap_or(comment).trim();
    let pragma = Pragma { text: text.to_owned(), span: Span::new(file, start..end), assert: None };
    let sides = text
        .strip_prefix("assert")
        .filter(|sides| !sides.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        .map(|sides| end - sides.len()..end);
    (pragma, sides)
}

/// The message for an assertion at `span` that does not parse. `label`: what is expected there.
pub fn unreadable(span: Span, label: &str, help: &str) -> Diagnostic {
    Diagnostic::new(Code::Pragma, span, "plcc cannot read this assertion").label(label).help(help)
}

/// The label of an assertion that is not a comparison.
pub const FORM: &str = "an assertion is: operand, comparison, operand";

/// A message about a side of an assertion as a message about the assertion.
pub fn about_side(found: Diagnostic, help: &str) -> Diagnostic {
    Diagnostic::new(Code::Pragma, found.primary.span, found.title)
        .label(found.primary.text)
        .help(found.help.unwrap_or_else(|| help.to_owned()))
}

impl<K: Copy + PartialEq, W: Copy, T> Cursor<'_, '_, K, W, T> {
    /// The next comment line `//@` before byte `before`, if pragmas are read.
    pub fn next_pragma(&mut self, before: u32) -> Option<Comment> {
        next(self.text, self.comments, &mut self.next_comment, before)
    }

    /// Reads the comment that [`Cursor::next_pragma`] found. Operands of assertions are those of STL, whatever the notation.
    pub fn read_pragma(&mut self, comment: Comment) -> Pragma {
        self.skip_pragma();
        stl::pragma::parse(self.file, self.text, comment.range(), &mut self.diagnostics)
    }

    /// Advances after the comment that [`Cursor::next_pragma`] found.
    pub fn skip_pragma(&mut self) {
        self.next_comment += 1;
    }

    /// Pragmas before byte `before` that are outside code belong to the file.
    pub fn file_pragmas(&mut self, before: u32) {
        while let Some(comment) = self.next_pragma(before) {
            let pragma = self.read_pragma(comment);
            self.pragmas.push(pragma);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_are_told_in_milliseconds() {
        for (time, ms) in [("100", "100"), ("5s", "5000"), ("5 s", "5000"), ("2,5 sec", "2500"), ("T#1s", "1000")] {
            assert_eq!(sleep_help(time), format!("write `//@ sleep {ms}`"), "{time}");
        }
        for time in ["", "0s", "soon", "5 cycles", "100000d"] {
            assert_eq!(sleep_help(time), "write `//@ sleep` and a number of milliseconds", "{time}");
        }
    }

    #[test]
    fn comments_that_are_nearly_pragmas() {
        let help = |comment: &str| {
            let range = Comment { start: 0, end: comment.len() as u32, form: CommentForm::Line, own_line: true };
            nearly(FileId(0), comment, range).and_then(|message| message.help)
        };
        assert_eq!(help("// @sleep 5 s").as_deref(), Some("write `//@ sleep 5000`"));
        assert_eq!(help("// @assert Q0.0 == 1").as_deref(), Some("write `//@ assert Q0.0 == 1`"));
        assert_eq!(help("// @author 5 s"), None);
    }
}
