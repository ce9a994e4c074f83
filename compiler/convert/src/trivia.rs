//! Comments of a source, which syntax trees do not hold, for the places where they belong.

use plcc_syntax::front::{Comment, CommentForm};

use crate::frames::bare;

/// The comments of a file, taken one after the other as the tree is written.
pub struct Trivia<'a> {
    source: &'a str,
    comments: Vec<Comment>,
    next: usize,
    /// The new notation has only `//`.
    only_lines: bool,
    /// The new notation has regions.
    regions: bool,
}

/// A comment as it stands in the source.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    pub text: String,
    /// It has a line of its own.
    pub own_line: bool,
}

impl<'a> Trivia<'a> {
    /// `only_lines`: comments in brackets become lines with `//`, and lines of regions too.
    pub fn new(source: &'a str, comments: Vec<Comment>, only_lines: bool) -> Trivia<'a> {
        Trivia { source, comments, next: 0, only_lines, regions: !only_lines }
    }

    /// Lines of regions become comments, since the new notation has no regions.
    pub fn without_regions(self) -> Trivia<'a> {
        Trivia { regions: false, ..self }
    }

    /// A source whose comments are all in its tree.
    pub fn none() -> Trivia<'a> {
        Trivia::new("", Vec::new(), false)
    }

    /// The text in which the comments are; empty for a source whose comments are all in its tree.
    pub fn source(&self) -> &'a str {
        self.source
    }

    /// The next comments that begin before byte `at`.
    pub fn before(&mut self, at: u32) -> Vec<Remark> {
        let mut found = Vec::new();
        while let Some(comment) = self.comments.get(self.next).filter(|comment| comment.start < at) {
            found.push(self.remark(comment));
            self.next += 1;
        }
        found
    }

    /// The next comments that begin on the line that byte `at` is on, or before it.
    pub fn on_line(&mut self, at: u32) -> Vec<Remark> {
        let rest = self.source.get(at as usize..).unwrap_or_default();
        let end = rest.find('\n').unwrap_or(rest.len());
        self.before(at + end as u32)
    }

    /// Goes on with the comments from byte `at` on: the blocks of a project are not in the order of its text.
    pub fn seek(&mut self, at: u32) {
        self.next = self.comments.partition_point(|comment| comment.start < at);
    }

    /// Whether the next comment begins before byte `at`.
    pub fn has_before(&self, at: u32) -> bool {
        self.comments.get(self.next).is_some_and(|comment| comment.start < at)
    }

    /// Whether one of the next comments, before byte `at`, is an assertion.
    pub fn asserts_before(&self, at: u32) -> bool {
        let next = self.comments[self.next..].iter().take_while(|comment| comment.start < at);
        next.map(|comment| self.source.get(comment.range()).unwrap_or_default()).any(|own| own.starts_with("//@"))
    }

    /// Whether one of the next comments, before byte `at`, has this text.
    pub fn has_text(&self, text: &str, at: u32) -> bool {
        let next = self.comments[self.next..].iter().take_while(|comment| comment.start < at);
        next.map(|comment| self.source.get(comment.range()).unwrap_or_default()).any(|own| bare(own) == text)
    }

    /// Where a word begins between two places, outside of comments.
    pub fn word(&self, word: &str, from: u32, to: u32) -> Option<u32> {
        let mut at = from as usize;
        let first = self.comments.partition_point(|comment| comment.end <= from);
        let comments = self.comments[first..].iter().map(|comment| comment.range());
        let end = to as usize;
        for comment in comments.take_while(|comment| comment.start < end).chain(std::iter::once(end..end)) {
            let gap = self.source.get(at..comment.start).unwrap_or_default();
            if let Some(found) = word_in(gap, word) {
                return u32::try_from(at + found).ok();
            }
            at = at.max(comment.end);
        }
        None
    }

    /// Where a word begins after a place, outside of comments.
    pub fn next_word(&self, word: &str, from: u32) -> Option<u32> {
        self.word(word, from, u32::try_from(self.source.len()).ok()?)
    }

    /// Takes out `//@ cpu` and `//@ test`, which mean the whole file: their texts.
    pub fn take_pragmas_of_file(&mut self) -> Vec<String> {
        let source = self.source;
        let mut found = Vec::new();
        self.comments.retain(|comment| {
            let text = source.get(comment.range()).and_then(|text| text.strip_prefix("//@")).map(str::trim);
            let text = text.filter(|text| matches!(text.split_whitespace().next(), Some("cpu" | "test")));
            found.extend(text.map(str::to_string));
            text.is_none()
        });
        found
    }

    fn remark(&self, comment: &Comment) -> Remark {
        let text = self.source.get(comment.range()).unwrap_or_default().trim_end();
        let remark = Remark { text: text.to_string(), own_line: comment.own_line };
        match comment.form {
            CommentForm::Line if !self.regions && !text.starts_with("//") => {
                Remark { text: format!("// {text}"), ..remark }
            }
            CommentForm::Line => remark,
            CommentForm::Block | CommentForm::Slash | CommentForm::Unterminated if self.only_lines => {
                Remark { text: as_lines(text), ..remark }
            }
            CommentForm::Block | CommentForm::Slash | CommentForm::Unterminated => remark,
        }
    }
}

/// Where a word begins in a text, in either letter case.
fn word_in(text: &str, word: &str) -> Option<usize> {
    let mut at = 0;
    for part in text.split(|c: char| !c.is_alphanumeric() && c != '_') {
        if part.eq_ignore_ascii_case(word) {
            return Some(at);
        }
        at += part.len();
        at += text.get(at..).and_then(|rest| rest.chars().next()).map_or(0, char::len_utf8);
    }
    None
}

/// A comment in brackets as `//` comments.
fn as_lines(text: &str) -> String {
    let inner = ["(/*", "(*", "/*"].iter().find_map(|sign| text.strip_prefix(sign)).unwrap_or(text);
    let inner = ["*/)", "*)", "*/"].iter().find_map(|sign| inner.strip_suffix(sign)).unwrap_or(inner);
    let lines: Vec<String> = inner.lines().map(|line| format!("// {}", line.trim()).trim_end().to_string()).collect();
    lines.join("\n")
}
