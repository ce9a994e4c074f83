//! Comments of a source: what the lexers of all languages find, and who reads them.

use std::ops::Range;

/// How a comment is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommentForm {
    /// `//`
    Line,
    /// `(* *)`, `(/* */)`
    Block,
    /// `/* */`
    Slash,
    /// Never closed.
    Unterminated,
}

/// A comment.
#[derive(Clone, Copy, Debug)]
pub struct Comment {
    pub start: u32,
    pub end: u32,
    /// There are only blanks before it on its line.
    pub own_line: bool,
    pub form: CommentForm,
}

impl Comment {
    pub fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// Its text without `//`; none for a pragma.
    fn text(&self, source: &str) -> Option<String> {
        let text = &source[self.start as usize + 2..self.end as usize];
        if text.starts_with('@') { None } else { Some(text.trim().to_owned()) }
    }
}

/// Comments between the bytes that have their own line, without `//` and without pragmas.
pub fn lines(source: &str, comments: &[Comment], range: Range<usize>) -> Vec<String> {
    let first = comments.partition_point(|comment| (comment.start as usize) < range.start);
    comments[first..]
        .iter()
        .take_while(|comment| (comment.end as usize) <= range.end)
        .filter(|comment| comment.own_line && comment.form == CommentForm::Line)
        .filter_map(|comment| comment.text(source))
        .collect()
}

/// The comment on the line that byte `end` is on, if there are only blanks between.
pub fn after(source: &str, comments: &[Comment], end: usize) -> Option<String> {
    let first = comments.partition_point(|comment| (comment.start as usize) < end);
    let comment = comments.get(first)?;
    let between = &source[end..comment.start as usize];
    if comment.form != CommentForm::Line || !between.bytes().all(|byte| matches!(byte, b' ' | b'\t')) {
        return None;
    }
    comment.text(source)
}
