//! Comments of a source, which syntax trees do not hold, for the places where they belong.

use plcc_syntax::front::{Comment, CommentForm};

/// The comments of a file, taken one after the other as the tree is written.
pub struct Trivia<'a> {
    source: &'a str,
    comments: Vec<Comment>,
    next: usize,
    /// The new notation has only `//`.
    only_lines: bool,
}

/// A comment as it stands in the source.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    pub text: String,
    /// It has a line of its own.
    pub own_line: bool,
}

impl<'a> Trivia<'a> {
    /// `only_lines`: comments in brackets become lines with `//`.
    pub fn new(source: &'a str, comments: Vec<Comment>, only_lines: bool) -> Trivia<'a> {
        Trivia { source, comments, next: 0, only_lines }
    }

    /// A source whose comments are all in its tree.
    pub fn none() -> Trivia<'a> {
        Trivia { source: "", comments: Vec::new(), next: 0, only_lines: false }
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

    /// Skips the comments before byte `at`, which belong to something that is written by itself.
    pub fn skip_to(&mut self, at: u32) {
        self.before(at);
    }

    fn remark(&self, comment: &Comment) -> Remark {
        let text = self.source.get(comment.range()).unwrap_or_default().trim_end();
        let remark = Remark { text: text.to_string(), own_line: comment.own_line };
        match comment.form {
            CommentForm::Line => remark,
            CommentForm::Block | CommentForm::Slash | CommentForm::Unterminated if self.only_lines => {
                Remark { text: as_lines(text), ..remark }
            }
            CommentForm::Block | CommentForm::Slash | CommentForm::Unterminated => remark,
        }
    }
}

/// A comment in brackets as `//` comments.
fn as_lines(text: &str) -> String {
    let inner = ["(/*", "(*", "/*"].iter().find_map(|sign| text.strip_prefix(sign)).unwrap_or(text);
    let inner = ["*/)", "*)", "*/"].iter().find_map(|sign| inner.strip_suffix(sign)).unwrap_or(inner);
    let lines: Vec<String> = inner.lines().map(|line| format!("// {}", line.trim()).trim_end().to_string()).collect();
    lines.join("\n")
}
