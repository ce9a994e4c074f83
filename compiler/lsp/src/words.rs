//! The words of a text: what stands at a byte, and what is around it.

use std::ops::Range;

use plcc_readers::{parts, pieces};
use plcc_syntax::Language;

/// Indices of a path are not longer than so many pieces.
const INDEX_PIECES_MAX: usize = 1000;

/// The words, signs, constants and comments of a text.
pub struct Words<'t> {
    pub text: &'t str,
    pub pieces: Vec<(Range<usize>, Language)>,
}

impl<'t> Words<'t> {
    pub fn new(text: &'t str, hint: Option<Language>) -> Words<'t> {
        let mut all = Vec::new();
        for (range, language) in parts(text, hint) {
            let ranges = pieces(&text[range.clone()], language);
            all.extend(ranges.into_iter().map(|piece| (piece.start + range.start..piece.end + range.start, language)));
        }
        Words { text, pieces: all }
    }

    /// The words of assertions, which are in comments.
    pub fn asserted(&self) -> Words<'t> {
        let mut all = Vec::new();
        for at in (0..self.pieces.len()).filter(|&at| self.first_on_line(at)) {
            let text = self.word(at).strip_prefix("//@").and_then(|text| text.trim_start().strip_prefix("assert"));
            let is_end = |text: &&str| !text.starts_with(|c: char| c.is_alphanumeric() || c == '_');
            let Some(text) = text.filter(is_end) else { continue };
            let (start, language) = (self.range(at).end - text.len(), self.language(at));
            let ranges = pieces(text, language).into_iter();
            all.extend(ranges.map(|piece| (piece.start + start..piece.end + start, language)));
        }
        Words { text: self.text, pieces: all }
    }

    /// Index of the piece at a byte, or which ends there.
    pub fn at(&self, byte: usize) -> Option<usize> {
        let first = self.pieces.partition_point(|(range, _)| range.end < byte);
        let touching = (first..self.pieces.len()).take(2).filter(|&at| {
            let range = &self.pieces[at].0;
            range.start <= byte && byte <= range.end
        });
        // Between two pieces the word counts.
        let found: Vec<usize> = touching.collect();
        found.iter().copied().find(|&at| is_name(self.word(at))).or(found.last().copied())
    }

    /// Number of pieces that begin before a byte.
    pub fn before(&self, byte: usize) -> usize {
        self.pieces.partition_point(|(range, _)| range.start < byte)
    }

    pub fn word(&self, at: usize) -> &'t str {
        self.pieces.get(at).map_or("", |(range, _)| &self.text[range.clone()])
    }

    pub fn range(&self, at: usize) -> Range<usize> {
        self.pieces.get(at).map_or(0..0, |(range, _)| range.clone())
    }

    pub fn language(&self, at: usize) -> Language {
        self.pieces.get(at).map_or(Language::Stl, |(_, language)| *language)
    }

    /// Whether nothing is between a piece and the one before.
    pub fn glued(&self, at: usize) -> bool {
        at > 0 && self.range(at - 1).end == self.range(at).start
    }

    /// Whether a piece is the first one of its line.
    pub fn first_on_line(&self, at: usize) -> bool {
        let start = self.range(at).start;
        let end = if at == 0 { 0 } else { self.range(at - 1).end };
        at == 0 || self.text.get(end..start).is_some_and(|gap| gap.contains(['\n', '\r']))
    }

    /// The names of the path that ends with a piece, from its first piece on: `#m.n` is `#m`, `n`.
    pub fn path(&self, at: usize) -> (usize, Vec<&'t str>) {
        let mut names = vec![self.word(at)];
        let mut first = at;
        loop {
            let mut before = first;
            if before > 0 && self.word(before - 1) == "#" {
                before -= 1;
            }
            if before >= 2 && self.word(before - 1) == "." {
                let Some(owner) = self.before_indices(before - 2) else { return (before, names) };
                if !is_name(self.word(owner)) && !self.word(owner).starts_with(|c: char| c.is_ascii_digit()) {
                    return (before, names);
                }
                names.insert(0, self.word(owner));
                first = owner;
            } else {
                return (before, names);
            }
        }
    }

    /// The piece that the indices and `^` which end with a piece belong to: `a` of `a[i[1]]`. The piece itself if it is neither.
    pub fn before_indices(&self, end: usize) -> Option<usize> {
        let mut at = end;
        loop {
            match self.word(at) {
                "^" => at = at.checked_sub(1)?,
                "]" => at = self.opening(at)?.checked_sub(1)?,
                _ => return Some(at),
            }
        }
    }

    /// The `[` of a `]`.
    fn opening(&self, close: usize) -> Option<usize> {
        let mut depth = 0usize;
        for at in (0..close).rev().take(INDEX_PIECES_MAX) {
            match self.word(at) {
                "]" => depth += 1,
                "[" if depth == 0 => return Some(at),
                "[" => depth -= 1,
                _ => {}
            }
        }
        None
    }

    /// Whether a piece is on a line of test pragmas.
    pub fn is_asserted(&self, at: usize) -> bool {
        let text = self.text.get(..self.range(at).start).unwrap_or_default();
        text.rsplit('\n').next().unwrap_or_default().trim_start().starts_with("//@")
    }
}

/// Whether a piece is a name: a word, `#local`, `"symbol"`.
pub fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || matches!(c, '_' | '"' | '#')) && word != "#"
}

/// A name without its `#` and quotes.
pub fn bare(word: &str) -> &str {
    word.trim_start_matches('#').trim_matches('"')
}
