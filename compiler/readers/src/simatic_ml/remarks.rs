//! Comments of statements, which have no meaning: the overlay of an export with them, for those who write the statements in another notation.

use std::ops::Range;

use roxmltree::Node;

use super::reader::first_text;
use crate::xml::{is, raw_text_of};
use plcc_syntax::front::{Comment, CommentForm};
use plcc_syntax::scl;

/// Comments in their places.
#[derive(Clone, Debug)]
pub struct Remarks {
    /// The overlay with comments: positions are those of the file. Code begins on a line of its own, networks in SCL end with `END_NETWORK`.
    pub text: String,
    /// Comments, pragmas of the file and lines of regions, in the order of the text.
    pub comments: Vec<Comment>,
}

/// The comments of an export. `overlay`: what its reader made of it.
pub fn remarks(file: &str, overlay: &str) -> Remarks {
    let mut found = Remarks { text: overlay.to_string(), comments: Vec::new() };
    let Ok(document) = crate::xml::parse(file) else { return found };
    let mut line = Line { overlay, at: 0, is_blank: true };
    for node in document.root().descendants() {
        if is_code(node) || is_constant(node) {
            // What is declared before it is not on its line.
            put(&mut found.text, "\n", node.range().start);
        }
        if is_code(node) {
            line = Line { overlay, at: node.range().start, is_blank: true };
        }
        if is(node, "StructuredText") {
            regions(&mut found, overlay, node.range());
            let end = node.range().end;
            put(&mut found.text, "END_NETWORK", end.saturating_sub("</StructuredText>".len()));
        }
        let Some((text, form)) = comment(node) else { continue };
        let start = node.range().start;
        let own_line = line.is_blank_before(start) && !is_of_constant(node);
        if text.len() <= node.range().len()
            && let Some(range) = put(&mut found.text, &text, start)
        {
            found.comments.push(Comment { start: range.start as u32, end: range.end as u32, own_line, form });
        }
    }
    found.comments.sort_by_key(|comment| comment.start);
    found
}

/// Adds the lines of the regions of statements.
fn regions(found: &mut Remarks, overlay: &str, range: Range<usize>) {
    for region in scl::regions(overlay.get(range.clone()).unwrap_or_default()) {
        let (start, end) = (range.start + region.start, range.start + region.end);
        // The name is at its place in the file, far from the word before it.
        let whole = found.text.get(start..end).unwrap_or_default();
        let line = whole.split_whitespace().collect::<Vec<_>>().join(" ");
        let blanks = " ".repeat(whole.len() - line.len());
        put(&mut found.text, &format!("{line}{blanks}"), start);
        let (start, end) = (start as u32, (start + line.len()) as u32);
        found.comments.push(Comment { start, end, own_line: true, form: CommentForm::Line });
    }
}

fn is_code(node: Node) -> bool {
    is(node, "StructuredText") || is(node, "StatementList")
}

fn is_constant(node: Node) -> bool {
    let is_constants = |outer: Node| is(outer, "Section") && outer.attribute("Name") == Some("Constant");
    is(node, "Member") && node.ancestors().any(is_constants)
}

/// Whether a node is the comment of a constant, which has none in the tree.
fn is_of_constant(node: Node) -> bool {
    is(node, "Comment") && node.parent().is_some_and(is_constant)
}

/// A comment between statements or of a constant, or a pragma of the file.
fn comment(node: Node) -> Option<(String, CommentForm)> {
    if node.is_comment() {
        let text = node.text()?.trim().strip_prefix('@')?.trim();
        return Some((format!("//@ {text}"), CommentForm::Line));
    }
    // Statements have comments in one language, and in several.
    let is_line = is(node, "LineComment");
    let is_comment = is_line || is(node, "Comment");
    if !is_comment || !(node.ancestors().any(is_code) || is_of_constant(node)) {
        return None;
    }
    let text = if is_line { raw_text_of(node) } else { first_text(node)? };
    let text = text.trim();
    if text.contains('\n') && !text.contains("*)") {
        return Some((format!("(*{text}*)"), CommentForm::Block));
    }
    let sign = match text {
        _ if text.starts_with("//") => "",
        _ if text.starts_with('@') && is_line => "//",
        _ => "// ",
    };
    Some((format!("{sign}{}", text.replace(['\n', '\r'], " ")), CommentForm::Line))
}

/// Writes a text over what is there; none if that would cut a letter.
fn put(text: &mut String, part: &str, start: usize) -> Option<Range<usize>> {
    let range = start..start + part.len();
    text.get(range.clone())?;
    text.replace_range(range.clone(), part);
    Some(range)
}

/// A line of the overlay, up to a place.
struct Line<'a> {
    overlay: &'a str,
    at: usize,
    is_blank: bool,
}

impl Line<'_> {
    /// Whether nothing stands before a place on its line. Ask for places in the order of the file.
    fn is_blank_before(&mut self, place: usize) -> bool {
        for byte in self.overlay.as_bytes().get(self.at..place).unwrap_or_default() {
            self.is_blank = *byte == b'\n' || self.is_blank && byte.is_ascii_whitespace();
        }
        self.at = self.at.max(place);
        self.is_blank
    }
}
