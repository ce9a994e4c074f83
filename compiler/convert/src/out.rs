//! Lines of a source, indented.

use crate::trivia::Remark;

/// Text that grows line by line.
#[derive(Default)]
pub struct Out {
    text: String,
    depth: usize,
}

/// Blanks for each level.
const INDENT: usize = 4;

/// The column where comments after statements begin, if the statement is not longer.
const COMMENT_COLUMN: usize = 32;

impl Out {
    pub fn line(&mut self, text: impl AsRef<str>) {
        let text = text.as_ref().trim_end();
        if !text.is_empty() {
            self.text.push_str(&" ".repeat(self.depth * INDENT));
            self.text.push_str(text);
        }
        self.text.push('\n');
    }

    /// A blank line, unless one is there or nothing is.
    pub fn gap(&mut self) {
        if !self.text.is_empty() && !self.text.ends_with("\n\n") {
            self.text.push('\n');
        }
    }

    pub fn indent(&mut self) {
        self.depth += 1;
    }

    pub fn dedent(&mut self) {
        self.depth = self.depth.saturating_sub(1);
    }

    /// Comments: those with a line of their own on lines, others after the last line.
    pub fn remarks(&mut self, remarks: &[Remark]) {
        for remark in remarks {
            if remark.own_line || self.text.is_empty() || self.ends_in_comment() {
                self.own_lines(&remark.text);
            } else {
                self.trail(&remark.text);
            }
        }
    }

    /// A comment on lines of its own, its own indentation within.
    fn own_lines(&mut self, text: &str) {
        let mut lines = text.lines();
        self.line(lines.next().unwrap_or_default());
        for line in lines {
            self.text.push_str(line.trim_end());
            self.text.push('\n');
        }
    }

    /// Text after the last line.
    pub fn trail(&mut self, text: &str) {
        if self.text.ends_with('\n') {
            self.text.pop();
        }
        let start = self.text.rfind('\n').map_or(0, |at| at + 1);
        let width = self.text[start..].chars().count();
        self.text.push_str(&" ".repeat(COMMENT_COLUMN.saturating_sub(width).max(1)));
        self.text.push_str(text.trim_end());
        self.text.push('\n');
    }

    /// Takes back the `;` of the last line, which goes on.
    pub fn behind_nothing(&mut self) {
        if self.text.ends_with(";\n") {
            self.text.truncate(self.text.len() - 2);
            self.text.push('\n');
        }
    }

    /// Whether nothing can follow on the last line.
    fn ends_in_comment(&self) -> bool {
        let last = self.text.trim_end_matches('\n').rsplit('\n').next().unwrap_or_default();
        last.contains("//")
    }

    pub fn into_text(self) -> String {
        self.text
    }
}
