//! The lexer: characters to raw tokens, regardless of where they are.
//!
//! Literals with `#` are one token (`S5T#2h_1m`, `P#DB11.DBX 20.0 INT 10`), a `TITLE =` is one token with the rest of its line.
//! Line ends and blanks are not tokens: each token knows whether a line end is before it. Comments are in a separate
//! list, by position.

use std::ops::Range;

use crate::comment::{Comment, CommentForm};
use logos::{Lexer, Logos};

/// What a raw token is.
#[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
#[logos(skip r"[ \t\r\f\x00\x1A\u{A0}\u{FEFF}]+")]
pub enum RawKind {
    #[token("\n")]
    Newline,
    #[regex(r"//[^\n]*", allow_greedy = true)]
    Comment,
    #[token("(*", block_comment)]
    BlockComment,
    /// A `(*` without `*)`; the rest of the file.
    UnterminatedComment,

    #[regex(r"[\p{XID_Start}_][\p{XID_Continue}]*", word)]
    Word,
    /// A constant with `#`.
    Literal,
    /// `TITLE = text`.
    Title,
    #[regex(r"[0-9][0-9_]*", number)]
    Number,
    #[regex(r"[0-9][0-9_]*\.[0-9][0-9_]*([eE][+-]?[0-9]+)?")]
    #[regex(r"[0-9][0-9_]*[eE][+-]?[0-9]+")]
    Real,
    #[regex("\"[^\"\n]*\"")]
    Quoted,
    #[regex("\"[^\"\n]*")]
    UnterminatedQuoted,
    #[regex(r"'([^'$\n]|\$[^\n])*'")]
    Text,
    #[regex(r"'([^'$\n]|\$[^\n])*\$?")]
    UnterminatedText,
    /// `@@NAME@@`, `{{name}}`.
    #[regex(r"@@[^@\n]*@@")]
    #[regex(r"\{\{[^{}\n]*\}\}")]
    Marker,

    #[token(":")]
    Colon,
    #[token(":=")]
    Assign,
    #[token(";")]
    Semicolon,
    #[token(",")]
    Comma,
    #[token(".")]
    Dot,
    #[token("..")]
    DotDot,
    #[token("(")]
    LeftParen,
    #[token(")")]
    RightParen,
    #[token("[")]
    LeftBracket,
    #[token("]")]
    RightBracket,
    #[token("{")]
    LeftBrace,
    #[token("}")]
    RightBrace,
    #[token("=")]
    Equal,
    #[token("==")]
    EqualEqual,
    #[token("<>")]
    NotEqual,
    #[token(">")]
    Greater,
    #[token("<")]
    Less,
    #[token(">=")]
    GreaterEqual,
    #[token("<=")]
    LessEqual,
    #[token("+")]
    Plus,
    #[token("-")]
    Minus,
    #[token("*")]
    Star,
    #[token("/")]
    Slash,
    #[token("#")]
    Hash,
    #[token("%")]
    Percent,
    /// A character that no statement contains.
    Stray,
}

/// A raw token; `start..end` are bytes of the text.
#[derive(Clone, Copy, Debug)]
pub struct RawToken {
    pub kind: RawKind,
    pub start: u32,
    pub end: u32,
    /// There is a line end between this token and the one before, or it is the first one.
    pub first_on_line: bool,
}

impl RawToken {
    pub fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// The tokens and comments of a text, both in its order.
pub struct RawText {
    pub tokens: Vec<RawToken>,
    pub comments: Vec<Comment>,
    /// Where a `(*` begins that is never closed.
    pub unterminated_comment: Option<u32>,
}

impl RawText {
    /// Shifts all positions to where the scanned part of a text begins.
    pub fn shift(&mut self, by: u32) {
        for token in &mut self.tokens {
            token.start += by;
            token.end += by;
        }
        for comment in &mut self.comments {
            comment.start += by;
            comment.end += by;
        }
        if let Some(start) = &mut self.unterminated_comment {
            *start += by;
        }
    }
}

/// Splits `text` into raw tokens. Never fails: text that is not a token becomes `Stray`.
pub fn scan(text: &str) -> RawText {
    let mut tokens: Vec<RawToken> = Vec::with_capacity(text.len() / 4);
    let mut comments = Vec::new();
    let mut unterminated_comment = None;
    let mut first_on_line = true;
    let mut lexer = RawKind::lexer(text);
    while let Some(kind) = lexer.next() {
        let (start, end) = (lexer.span().start as u32, lexer.span().end as u32);
        match kind.unwrap_or(RawKind::Stray) {
            RawKind::Newline => first_on_line = true,
            RawKind::Comment => comments.push(Comment { start, end, own_line: first_on_line, form: CommentForm::Line }),
            kind @ (RawKind::BlockComment | RawKind::UnterminatedComment) => {
                if kind == RawKind::UnterminatedComment {
                    unterminated_comment = Some(start);
                }
                comments.push(Comment { start, end, own_line: first_on_line, form: CommentForm::Block });
                first_on_line |= lexer.slice().contains('\n');
            }
            RawKind::Stray
                if let Some(before) = tokens.last_mut()
                    && before.kind == RawKind::Stray
                    && before.end == start
                    && !first_on_line =>
            {
                before.end = end;
            }
            kind => {
                tokens.push(RawToken { kind, start, end, first_on_line });
                first_on_line = false;
            }
        }
    }
    RawText { tokens, comments, unterminated_comment }
}

/// Consumes up to `*)`.
fn block_comment(lexer: &mut Lexer<RawKind>) -> RawKind {
    match lexer.remainder().find("*)") {
        Some(at) => {
            lexer.bump(at + 2);
            RawKind::BlockComment
        }
        None => {
            lexer.bump(lexer.remainder().len());
            RawKind::UnterminatedComment
        }
    }
}

/// A word may begin a constant (`S5T#`), or a title.
fn word(lexer: &mut Lexer<RawKind>) -> RawKind {
    let rest = lexer.remainder();
    if rest.starts_with('#')
        && let Some(form) = literal_form(lexer.slice())
        && let Some(length) = literal_length(form, &rest[1..])
    {
        lexer.bump(1 + length);
        return RawKind::Literal;
    }
    if lexer.slice().eq_ignore_ascii_case("title") {
        let before = lexer.source().as_bytes()[..lexer.span().start].last();
        let blanks = rest.len() - rest.trim_start_matches([' ', '\t']).len();
        if !matches!(before, Some(b'#' | b'.')) && rest[blanks..].starts_with('=') {
            let line = rest.find('\n').unwrap_or(rest.len());
            lexer.bump(rest[..line].trim_end().len());
            return RawKind::Title;
        }
    }
    RawKind::Word
}

/// A number may be the base of a constant: `16#`, `2#`.
fn number(lexer: &mut Lexer<RawKind>) -> RawKind {
    let rest = lexer.remainder();
    if let Some(digits) = rest.strip_prefix('#') {
        lexer.bump(1 + word_length(digits));
        return RawKind::Literal;
    }
    RawKind::Number
}

/// How the text after the `#` of a constant is built.
#[derive(Clone, Copy)]
enum LiteralForm {
    /// `W#16#3A2F`, `C#20`, `L#-7`, `INT#5`, `REAL#1.5`.
    Number,
    /// `B#16#1E`, `B#(1,8)`.
    Byte,
    /// `T#1h_2m`, `S5T#2s`.
    Duration,
    /// `D#2000-6-20`, `DT#2000-6-20-12:0:0.5`, `TOD#5:45:00`.
    Date,
    /// `P#M 10.0`.
    Pointer,
    /// `CHAR#'a'`.
    Text,
}

fn literal_form(prefix: &str) -> Option<LiteralForm> {
    const FORMS: &[(&str, LiteralForm)] = &[
        ("W", LiteralForm::Number),
        ("WORD", LiteralForm::Number),
        ("DW", LiteralForm::Number),
        ("DWORD", LiteralForm::Number),
        ("L", LiteralForm::Number),
        ("C", LiteralForm::Number),
        ("Z", LiteralForm::Number),
        ("INT", LiteralForm::Number),
        ("DINT", LiteralForm::Number),
        ("REAL", LiteralForm::Number),
        ("BOOL", LiteralForm::Number),
        ("B", LiteralForm::Byte),
        ("BYTE", LiteralForm::Byte),
        ("S5T", LiteralForm::Duration),
        ("S5TIME", LiteralForm::Duration),
        ("T", LiteralForm::Duration),
        ("TIME", LiteralForm::Duration),
        ("D", LiteralForm::Date),
        ("DATE", LiteralForm::Date),
        ("TOD", LiteralForm::Date),
        ("TIME_OF_DAY", LiteralForm::Date),
        ("DT", LiteralForm::Date),
        ("DATE_AND_TIME", LiteralForm::Date),
        ("P", LiteralForm::Pointer),
        ("CHAR", LiteralForm::Text),
        ("STRING", LiteralForm::Text),
    ];
    FORMS.iter().find(|(name, _)| name.eq_ignore_ascii_case(prefix)).map(|(_, form)| *form)
}

/// Bytes of the constant after `#`; `None` if the `#` does not make a constant (`P##name`).
fn literal_length(form: LiteralForm, rest: &str) -> Option<usize> {
    match form {
        LiteralForm::Number => Some(number_length(rest)),
        LiteralForm::Byte if rest.trim_start_matches([' ', '\t']).starts_with('(') => {
            let open = rest.find('(').map_or(0, |at| at + 1);
            let list = rest[open..]
                .find(|c: char| !is_word(c) && !matches!(c, ',' | ' ' | '\t' | '-'))
                .unwrap_or(rest.len() - open);
            let closed = rest[open + list..].starts_with(')');
            Some(open + list + usize::from(closed))
        }
        LiteralForm::Byte => Some(number_length(rest)),
        LiteralForm::Duration => {
            let sign = rest.len() - rest.trim_start_matches(['-', '+']).len();
            Some(sign + rest[sign..].find(|c: char| !is_word(c) && c != '.').unwrap_or(rest.len() - sign))
        }
        LiteralForm::Date => Some(date_length(rest)),
        LiteralForm::Pointer => pointer_length(rest),
        LiteralForm::Text => {
            let line = &rest[..rest.find('\n').unwrap_or(rest.len())];
            let inner = line.strip_prefix('\'')?;
            let mut escaped = false;
            for (at, c) in inner.char_indices() {
                match c {
                    '$' if !escaped => escaped = true,
                    '\'' if !escaped => return Some(at + 2),
                    _ => escaped = false,
                }
            }
            Some(line.trim_end().len())
        }
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn word_length(rest: &str) -> usize {
    rest.find(|c: char| !is_word(c)).unwrap_or(rest.len())
}

/// `16#FF`, `-7`, `1.5e+3`, `TRUE`.
fn number_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let mut at = rest.len() - rest.trim_start_matches(['-', '+']).len();
    at += word_length(&rest[at..]);
    if bytes.get(at) == Some(&b'#') {
        at += 1;
        at += word_length(&rest[at..]);
    }
    if bytes.get(at) == Some(&b'.') && bytes.get(at + 1).is_some_and(u8::is_ascii_digit) {
        at += 1;
        at += word_length(&rest[at..]);
    }
    if at > 0 && matches!(bytes[at - 1], b'e' | b'E') && matches!(bytes.get(at), Some(b'+' | b'-')) {
        at += 1;
        at += word_length(&rest[at..]);
    }
    at
}

/// `1999-12-8`, `1999 - 12 - 8`, `1:10:3.3`.
fn date_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let mut end = word_length(rest);
    loop {
        let mut at = end;
        while matches!(bytes.get(at), Some(b' ' | b'\t')) {
            at += 1;
        }
        let blanks = at > end;
        match bytes.get(at) {
            Some(b'-') => at += 1,
            Some(b':' | b'.') if !blanks => at += 1,
            _ => return end,
        }
        while matches!(bytes.get(at), Some(b' ' | b'\t')) {
            at += 1;
        }
        if !bytes.get(at).is_some_and(u8::is_ascii_digit) {
            return end;
        }
        end = at + word_length(&rest[at..]);
    }
}

/// `10.3`, `M 10.0`, `DBX0.0`, `DB11.DBX 20.0 INT 10`; not `#name` and `"name"`.
fn pointer_length(rest: &str) -> Option<usize> {
    if rest.starts_with(['#', '"']) {
        return None;
    }
    let blanks = |at: usize| at + rest[at..].len() - rest[at..].trim_start_matches([' ', '\t']).len();
    let digits = |at: usize| at + rest[at..].len() - rest[at..].trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let letters =
        |at: usize| at + rest[at..].len() - rest[at..].trim_start_matches(|c: char| c.is_ascii_alphabetic()).len();
    let word = |at: usize| at + word_length(&rest[at..]);
    let mut at = letters(0);
    let area = &rest[..at];
    if area.eq_ignore_ascii_case("DB") || area.eq_ignore_ascii_case("DI") {
        let number = blanks(at);
        let end = digits(number);
        if end > number && rest[blanks(end)..].starts_with('.') {
            at = letters(blanks(blanks(end) + 1));
        }
    } else if at == 0 && !rest.starts_with(|c: char| c.is_ascii_digit()) {
        return Some(word(0));
    }
    let number = blanks(at);
    if digits(number) == number {
        return Some(word(at));
    }
    at = digits(number);
    if rest[at..].starts_with('.') && digits(at + 1) > at + 1 {
        at = digits(at + 1);
    }
    at = word(at);
    // Data type and repetition factor of an ANY.
    let name = blanks(at);
    let name_end = word(name);
    let count = blanks(name_end);
    let count_end = digits(count);
    let named = name > at && rest[name..].starts_with(|c: char| c.is_ascii_alphabetic());
    if named && count > name_end && count_end > count && any_type(&rest[name..name_end]) {
        at = word(count_end);
    }
    Some(at)
}

/// Whether `name` is a data type that an ANY pointer can name.
fn any_type(name: &str) -> bool {
    crate::literal::ANY_TYPES.iter().any(|(known, _)| known.eq_ignore_ascii_case(name))
}
