//! Changes to the text of a source, for tests that any text can be read.

use proptest::sample::Index;

/// `text` after all edits: each replaces some bytes at a place with a piece.
pub fn mutated(text: &str, edits: Vec<(Index, usize, usize)>, pieces: &[&str]) -> String {
    let mut text = text.to_owned();
    for (place, removed, piece) in edits {
        let mut start = place.index(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let mut end = (start + removed).min(text.len());
        while !text.is_char_boundary(end) {
            end += 1;
        }
        text.replace_range(start..end, pieces[piece]);
    }
    text
}

/// The two parts of `text` before and after a position.
pub fn cut(text: &str, place: Index) -> (&str, &str) {
    let mut end = place.index(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    text.split_at(end)
}
