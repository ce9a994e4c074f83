//! The overlay of a file: a text of the same length that has, at the position of each node, its meaning in SCL or STL.
//!
//! The parsers of these languages read it, so their spans are positions in the file.

use std::ops::Range;

/// The overlay of a file.
pub struct Overlay {
    text: String,
    used: Vec<bool>,
}

impl Overlay {
    /// Blanks, as long as `file`.
    pub fn new(file: &str) -> Overlay {
        Overlay { text: " ".repeat(file.len()), used: vec![false; file.len()] }
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    pub fn into_text(self) -> String {
        self.text
    }

    /// Writes `text` into `node`, at `wanted` if there is room, otherwise at its start, otherwise anywhere in the file where it fits.
    /// Returns the bytes that it uses, or none if it fits nowhere.
    pub fn place(&mut self, text: &str, wanted: usize, node: Range<usize>) -> Option<Range<usize>> {
        let fits = |overlay: &Overlay, at: usize| overlay.is_free(at..at + text.len());
        let inside = |at: usize| at >= node.start && at + text.len() <= node.end;
        let at = if inside(wanted) && fits(self, wanted) {
            wanted
        } else if inside(node.start) && fits(self, node.start) {
            node.start
        } else {
            self.gap(node, text.len()).or_else(|| self.gap(0..self.text.len(), text.len()))?
        };
        let range = at..at + text.len();
        self.text.replace_range(range.clone(), text);
        self.used[range.clone()].fill(true);
        Some(range)
    }

    /// As [`Overlay::place`], but only inside `node`: for texts whose order matters.
    pub fn place_inside(&mut self, text: &str, wanted: usize, node: Range<usize>) -> Option<Range<usize>> {
        let fits = |at: usize| at >= node.start && at + text.len() <= node.end && self.is_free(at..at + text.len());
        if !fits(wanted) && !fits(node.start) {
            self.gap(node.clone(), text.len())?;
        }
        self.place(text, wanted, node)
    }

    /// Whether nothing has been written there.
    fn is_free(&self, range: Range<usize>) -> bool {
        self.used.get(range).is_some_and(|used| !used.contains(&true))
    }

    /// The first `length` free bytes in a row.
    fn gap(&self, within: Range<usize>, length: usize) -> Option<usize> {
        let mut free = 0;
        for at in within {
            free = if self.used[at] { 0 } else { free + 1 };
            if free >= length {
                return Some(at + 1 - free);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_does_not_fit_finds_another_place() {
        let mut overlay = Overlay::new("<a/><b/>      ");
        assert_eq!(overlay.place("#a.b", 0, 0..4), Some(0..4));
        assert_eq!(overlay.place("#ä", 4, 4..8), Some(4..7));
        assert_eq!(overlay.place("#abcd", 4, 4..8), Some(7..12));
        assert_eq!(overlay.place("#abcd", 4, 4..8), None);
        assert_eq!(overlay.place_inside("##", 4, 4..8), None);
        assert_eq!(overlay.into_text(), "#a.b#ä#abcd  ");
    }
}
