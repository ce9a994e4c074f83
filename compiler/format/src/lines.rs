//! Lines with their indentation, and the text that they are.

/// A line of the result.
#[derive(Clone, Debug, Default)]
pub struct Line {
    /// Number of blanks before it.
    pub indent: usize,
    pub code: String,
    /// A `//` comment after the code.
    pub comment: String,
    /// There is an empty line before it.
    pub apart: bool,
    /// Comments after code are aligned only among lines of one kind.
    pub kind: Kind,
}

/// What a line is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    #[default]
    Frame,
    Declaration,
    Statement,
    /// A comment alone.
    Comment,
}

/// Comments after code begin at a multiple of this column.
const COMMENT_STEP: usize = 8;

/// Longer lines do not move the comments of the lines around them.
const WIDTH_MAX: usize = 72;

/// The text of all lines.
pub fn text(mut lines: Vec<Line>) -> String {
    for line in &mut lines {
        line.code.truncate(line.code.trim_end_matches([' ', '\t']).len());
    }
    let mut out = String::new();
    for group in lines.chunk_by(|one, next| !next.apart && one.kind == next.kind) {
        let width = |line: &Line| line.indent + width_of(&line.code);
        let counted = group.iter().filter(|line| !line.comment.is_empty() && !line.code.is_empty());
        let longest = counted.map(width).filter(|width| *width <= WIDTH_MAX).max().unwrap_or(0);
        let column = (longest + 2).next_multiple_of(COMMENT_STEP);
        for line in group {
            if line.apart && !out.is_empty() {
                out.push('\n');
            }
            if !line.code.is_empty() || !line.comment.is_empty() {
                out.extend(std::iter::repeat_n(' ', line.indent));
            }
            out.push_str(&line.code);
            if !line.comment.is_empty() {
                if !line.code.is_empty() {
                    let blanks = column.saturating_sub(width(line)).max(1);
                    out.extend(std::iter::repeat_n(' ', blanks));
                }
                out.push_str(&line.comment);
            }
            out.push('\n');
        }
    }
    out
}

/// Columns that the last line of a code takes.
fn width_of(code: &str) -> usize {
    code.rsplit('\n').next().unwrap_or(code).chars().count()
}
