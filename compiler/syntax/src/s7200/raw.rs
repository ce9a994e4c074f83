//! The lexer: characters to raw tokens, regardless of where they are.
//!
//! Names may contain any character beyond ASCII, as in Micro/WIN; an address with a point is one token. Lines end with CR, LF or both.
//! Source: S7-200 system manual, conventions and concepts of programming.

use logos::Logos;

use crate::front;

/// What a raw token is.
#[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
#[logos(skip r"[ \t\x0B\x0C\x1A\u{A0}\u{3000}\u{FEFF}]+")]
pub enum RawKind {
    #[regex(r"\r\n|\n|\r")]
    Newline,
    #[regex(r"//[^\r\n]*", allow_greedy = true)]
    Comment,
    /// `LD`, `Motor`, `I0.0`, `DB1.DBW100`.
    #[regex(r"[A-Za-z_\u{80}-\u{9F}\u{A1}-\u{2FFF}\u{3001}-\u{FEFE}\u{FF00}-\u{10FFFF}][0-9A-Za-z_\u{80}-\u{9F}\u{A1}-\u{2FFF}\u{3001}-\u{FEFE}\u{FF00}-\u{10FFFF}]*(\.[0-9A-Za-z_]+)*")]
    Word,
    /// `%I0.0`
    #[regex(r"%[0-9A-Za-z_.]*")]
    Percent,
    /// `#Raw`
    #[regex(r"#[0-9A-Za-z_\u{80}-\u{9F}\u{A1}-\u{2FFF}\u{3001}-\u{FEFE}\u{FF00}-\u{10FFFF}]*")]
    Local,
    #[regex(r"[0-9][0-9_]*")]
    Integer,
    #[regex(r"[0-9][0-9_]*\.[0-9]+([eE][+-]?[0-9]+)?")]
    #[regex(r"[0-9]+[eE][+-]?[0-9]+")]
    Real,
    /// `16#FF`, `W#16#10`, `BYTE#3`.
    #[regex(r"[0-9]+#[0-9A-Za-z_.]*")]
    #[regex(r"[A-Za-z][0-9A-Za-z]*#[+-]?[0-9A-Za-z_.#]*")]
    Based,
    /// Begins like a number: `10ms`.
    #[regex(r"[0-9]+[A-Za-z_][0-9A-Za-z_.]*", priority = 1)]
    BadNumber,
    #[regex(r#""([^"$\r\n]|\$[^\r\n])*""#)]
    Quoted,
    #[regex(r"'([^'$\r\n]|\$[^\r\n])*'")]
    Characters,
    #[regex(r#""([^"$\r\n]|\$[^\r\n])*\$?"#)]
    #[regex(r"'([^'$\r\n]|\$[^\r\n])*\$?")]
    Unterminated,

    #[token(":")]
    Colon,
    #[token(":=")]
    Assign,
    #[token(";")]
    Semicolon,
    #[token(",")]
    Comma,
    /// A relation or `=`.
    #[token("=")]
    #[token("==")]
    #[token("<>")]
    #[token(">=")]
    #[token("<=")]
    #[token(">")]
    #[token("<")]
    Relation,
    #[token("+")]
    Plus,
    #[token("-")]
    Minus,
    #[token("*")]
    Star,
    #[token("/")]
    Slash,
    #[token("&")]
    Ampersand,
    /// A character that no statement contains.
    #[regex(r".", priority = 0)]
    Stray,
}

pub type RawToken = front::RawToken<RawKind>;

/// The tokens of a text, line by line, each line without its end.
pub fn lines(text: &str) -> Vec<Vec<RawToken>> {
    each_line(text).collect()
}

/// As [`lines`]; a line is read when it is asked for.
pub fn each_line(text: &str) -> impl Iterator<Item = Vec<RawToken>> {
    let mut tokens = Some(RawKind::lexer(text).spanned());
    std::iter::from_fn(move || {
        let mut line: Vec<RawToken> = Vec::new();
        loop {
            let Some((kind, range)) = tokens.as_mut()?.next() else {
                tokens = None;
                return Some(line);
            };
            let kind = kind.unwrap_or(RawKind::Stray);
            if kind == RawKind::Newline {
                return Some(line);
            }
            let (start, end, first_on_line) = (range.start as u32, range.end as u32, line.is_empty());
            line.push(RawToken { kind, start, end, first_on_line, keyword: () });
        }
    })
}

/// The tokens of one line, or of a part of it, which begins at byte `offset` of the text.
pub fn part(text: &str, offset: usize) -> Vec<RawToken> {
    let mut tokens: Vec<RawToken> = lines(text).into_iter().flatten().collect();
    front::shift(&mut tokens, &mut [], offset as u32);
    tokens
}

/// Index of the token that opens a comment of other languages, `(* … *)` or `/* … */`.
pub fn block_comment(text: &str, line: &[RawToken]) -> Option<usize> {
    line.windows(2).position(|pair| {
        let adjacent = pair[0].range().end == pair[1].range().start;
        matches!(pair[0].text(text), "(" | "/") && pair[1].kind == RawKind::Star && adjacent
    })
}
