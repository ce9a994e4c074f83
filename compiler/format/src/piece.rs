//! The pieces of a text: words, signs, constants and comments, each with what was between it and the one before.

use std::ops::Range;

use plcc_syntax::Language;

/// What a piece of STL begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begins {
    Nothing,
    Label,
    Mnemonic,
    Operand,
    /// The name of a parameter of a CALL.
    Parameter,
}

/// A word, a sign, a constant or a comment.
#[derive(Clone, Debug)]
pub struct Piece<'t> {
    pub text: &'t str,
    pub start: usize,
    /// Number of line ends between it and the piece before.
    pub line_ends: usize,
    /// There are blanks, but no line end, between it and the piece before.
    pub spaced: bool,
    /// It begins a line at the left margin.
    pub at_margin: bool,
    pub begins: Begins,
}

impl Piece<'_> {
    pub fn is_comment(&self) -> bool {
        self.text.starts_with("//")
            || self.text.starts_with("/*")
            || self.text.starts_with("(*") && !self.text.starts_with("(*$_")
            || self.text.starts_with("(/*")
    }

    /// A comment that ends with its line.
    pub fn is_line_comment(&self) -> bool {
        self.text.starts_with("//")
    }

    pub fn is(&self, word: &str) -> bool {
        self.text.eq_ignore_ascii_case(word)
    }

    pub fn is_any(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.is(word))
    }
}

/// A part of a source in one language.
pub struct Part<'t> {
    pub language: Language,
    pub pieces: Vec<Piece<'t>>,
}

/// The pieces of each part of a text.
pub fn read(text: &str, parts: Vec<(Range<usize>, Language)>) -> Vec<Part<'_>> {
    parts
        .into_iter()
        .map(|(range, language)| {
            let part = &text[range.clone()];
            let ranges = plcc_readers::pieces(part, language);
            let ranges = ranges.into_iter().map(|piece| piece.start + range.start..piece.end + range.start);
            Part { language, pieces: pieces(text, range.clone(), ranges) }
        })
        .collect()
}

/// The pieces inside `range`; text between them that is not blank is a piece of its own for each line.
fn pieces(text: &str, range: Range<usize>, ranges: impl Iterator<Item = Range<usize>>) -> Vec<Piece<'_>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    let mut at = range.start;
    let between = |from: usize, to: usize, all: &mut Vec<Range<usize>>| {
        let mut start = from;
        for line in text[from..to].split('\n') {
            let trimmed = line.trim_matches(blank);
            if !trimmed.is_empty() {
                let first = start + (line.len() - line.trim_start_matches(blank).len());
                all.push(first..first + trimmed.len());
            }
            start += line.len() + 1;
        }
    };
    for piece in ranges {
        if piece.start < at {
            continue;
        }
        between(at, piece.start, &mut all);
        at = piece.end;
        // The lexer of STL gives the `%` of `%MW10` apart from its address.
        match all.last_mut() {
            Some(last) if last.end == piece.start && &text[last.clone()] == "%" => last.end = piece.end,
            _ => all.push(piece),
        }
    }
    between(at, range.end, &mut all);
    let mut before = range.start;
    let mut out = Vec::with_capacity(all.len());
    for piece in all {
        let gap = &text[before..piece.start];
        let line_ends = gap.bytes().filter(|byte| *byte == b'\n').count();
        before = piece.end;
        out.push(Piece {
            text: text[piece.clone()].trim_end_matches(blank),
            start: piece.start,
            line_ends,
            spaced: line_ends == 0 && !gap.is_empty(),
            at_margin: gap.is_empty() || gap.ends_with('\n'),
            begins: Begins::Nothing,
        });
    }
    out
}

/// What separates pieces. The lexers skip all of these.
pub fn blank(c: char) -> bool {
    c.is_whitespace() || matches!(c, '\0' | '\u{1A}' | '\u{FEFF}')
}
