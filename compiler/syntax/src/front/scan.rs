//! From characters to raw tokens, regardless of where they are: the loop around a lexer, and parts of its callbacks.

use std::ops::Range;

use logos::{Lexer, Logos};

use super::comment::{Comment, CommentForm};
use super::extent;

/// The raw tokens of a notation.
pub trait Kind: Copy + PartialEq {
    /// A character that the notation has no use for.
    const STRAY: Self;
    /// The characters that end a line.
    const LINE_ENDS: &'static [char] = &['\n'];

    /// The brackets of expressions, in the order of [`Bracket::ALL`].
    const BRACKETS: [Self; 4];

    /// What becomes of it.
    fn role(self) -> Role;

    /// The bracket that it is.
    fn bracket(self) -> Option<Bracket> {
        let index = Self::BRACKETS.iter().position(|bracket| *bracket == self)?;
        Some(Bracket::ALL[index])
    }
}

/// What becomes of a raw token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    LineEnd,
    Comment(CommentForm),
    Token,
}

/// A bracket that expressions contain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bracket {
    LeftParen,
    RightParen,
    LeftBracket,
    RightBracket,
}

impl Bracket {
    /// All of them.
    pub const ALL: [Bracket; 4] =
        [Bracket::LeftParen, Bracket::RightParen, Bracket::LeftBracket, Bracket::RightBracket];

    /// The one that closes it; itself if it closes.
    pub const fn closing(self) -> Bracket {
        match self {
            Bracket::LeftParen | Bracket::RightParen => Bracket::RightParen,
            Bracket::LeftBracket | Bracket::RightBracket => Bracket::RightBracket,
        }
    }
}

/// A raw token; `start..end` are bytes of the text.
#[derive(Clone, Copy, Debug)]
pub struct RawToken<K, W = ()> {
    pub kind: K,
    pub start: u32,
    pub end: u32,
    /// There is a line end between this token and the one before, or it is the first one.
    pub first_on_line: bool,
    /// What the lexer knows about a word.
    pub keyword: W,
}

impl<K, W> RawToken<K, W> {
    pub fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// Its text; `source` is what was scanned.
    pub fn text<'s>(&self, source: &'s str) -> &'s str {
        source.get(self.range()).unwrap_or_default()
    }
}

/// The tokens and comments of a text, each in its order.
#[derive(Clone, Debug)]
pub struct RawText<K, W = ()> {
    pub tokens: Vec<RawToken<K, W>>,
    pub comments: Vec<Comment>,
}

/// Runs a lexer over its text. Never fails: text that is not a token becomes [`Kind::STRAY`].
///
/// `keyword` says what is known about a token, given those before it; none: the notation keeps it elsewhere.
pub fn scan<'s, K, W>(
    mut lexer: Lexer<'s, K>,
    mut keyword: impl FnMut(&mut Lexer<'s, K>, K, &[RawToken<K, W>]) -> Option<W>,
) -> RawText<K, W>
where
    K: Kind + Logos<'s, Source = str>,
{
    let mut out = RawText { tokens: Vec::with_capacity(lexer.source().len() / 4), comments: Vec::new() };
    let mut first_on_line = true;
    while let Some(kind) = lexer.next() {
        let kind = kind.unwrap_or(K::STRAY);
        let (start, end) = (lexer.span().start as u32, lexer.span().end as u32);
        match kind.role() {
            Role::LineEnd => first_on_line = true,
            Role::Comment(form) => {
                out.comments.push(Comment { start, end, own_line: first_on_line, form });
                first_on_line |= form != CommentForm::Line && lexer.slice().contains(K::LINE_ENDS);
            }
            Role::Token => {
                if kind == K::STRAY
                    && !first_on_line
                    && let Some(before) = out.tokens.last_mut()
                    && before.kind == K::STRAY
                    && before.end == start
                {
                    before.end = end;
                } else if let Some(keyword) = keyword(&mut lexer, kind, &out.tokens) {
                    out.tokens.push(RawToken { kind, start, end, first_on_line, keyword });
                    first_on_line = false;
                }
            }
        }
    }
    out
}

impl<K, W> RawText<K, W> {
    /// Bytes of the tokens and comments, in the order of the text.
    pub fn pieces(&self) -> Vec<Range<usize>> {
        let tokens = self.tokens.iter().map(RawToken::range);
        let mut pieces: Vec<Range<usize>> = tokens.chain(self.comments.iter().map(Comment::range)).collect();
        pieces.sort_by_key(|piece| piece.start);
        pieces
    }
}

/// Shifts positions to where the scanned part of a text begins.
pub fn shift<K, W>(tokens: &mut [RawToken<K, W>], comments: &mut [Comment], by: u32) {
    for token in tokens {
        token.start += by;
        token.end += by;
    }
    for comment in comments {
        comment.start += by;
        comment.end += by;
    }
}

/// Consumes up to and including the first `end`; false: there is none, and all of the text is consumed.
pub fn skip_through<'s, K: Logos<'s, Source = str>>(lexer: &mut Lexer<'s, K>, end: &str) -> bool {
    let found = lexer.remainder().find(end);
    lexer.bump(found.map_or(lexer.remainder().len(), |at| at + end.len()));
    found.is_some()
}

/// Consumes a text after its opening quote; false: it is not closed.
pub fn skip_text<'s, K: Logos<'s, Source = str>>(lexer: &mut Lexer<'s, K>) -> bool {
    let (length, closed) = extent::text(lexer.remainder());
    lexer.bump(length);
    closed
}

/// Whether a point is directly before the current token.
pub fn after_point<'s, K: Logos<'s, Source = str>>(lexer: &Lexer<'s, K>) -> bool {
    lexer.source().as_bytes()[..lexer.span().start].last() == Some(&b'.')
}
