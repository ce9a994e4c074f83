//! The lexer: characters to raw tokens, regardless of where they are.
//!
//! Literals with `#` are one token (`S5T#2h_1m`, `P#DB11.DBX 20.0 INT 10`), a `TITLE =` is one token with the rest of its line.
//! Line ends and blanks are not tokens: each token knows whether a line end is before it. Comments are in a separate
//! list, by position.

use logos::{Lexer, Logos};

use crate::front::frame_words::{self, Seen, Shape};
use crate::front::pointer::{self, Tail};
use crate::front::{self, CommentForm, Kind, Role, extent};

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
    /// `/* … */`
    #[token("/*", slash_comment)]
    SlashComment,
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

impl Kind for RawKind {
    const STRAY: RawKind = RawKind::Stray;
    const BRACKETS: [RawKind; 4] =
        [RawKind::LeftParen, RawKind::RightParen, RawKind::LeftBracket, RawKind::RightBracket];

    fn role(self) -> Role {
        match self {
            RawKind::Newline => Role::LineEnd,
            RawKind::Comment => Role::Comment(CommentForm::Line),
            RawKind::BlockComment => Role::Comment(CommentForm::Block),
            RawKind::SlashComment => Role::Comment(CommentForm::Slash),
            RawKind::UnterminatedComment => Role::Comment(CommentForm::Unterminated),
            _ => Role::Token,
        }
    }
}

/// A word may be a misspelt keyword of a frame: it has the keyword that is meant.
pub type RawToken = front::RawToken<RawKind, Option<&'static str>>;
pub type RawText = front::RawText<RawKind, Option<&'static str>>;

/// Splits `text` into raw tokens. Never fails: text that is not a token becomes `Stray`.
pub fn scan(text: &str) -> RawText {
    let mut raw: RawText = front::scan(RawKind::lexer(text), |_, _, _| Some(None));
    let seen = |at: usize| {
        let token: RawToken = raw.tokens[at];
        Seen { shape: shape(token.kind), text: token.text(text), first_on_line: token.first_on_line }
    };
    for meant in frame_words::find(raw.tokens.len(), seen).into_iter().rev() {
        let end = raw.tokens[meant.first + meant.count - 1].end;
        let token = &mut raw.tokens[meant.first];
        (token.end, token.keyword) = (end, Some(meant.keyword));
        raw.tokens.drain(meant.first + 1..meant.first + meant.count);
    }
    misspelt_networks(text, &mut raw.tokens);
    raw
}

/// `NETWROK` alone before a line with a title.
fn misspelt_networks(text: &str, tokens: &mut [RawToken]) {
    for at in 1..tokens.len() {
        let (word, title) = (tokens[at - 1], tokens[at]);
        if title.kind != RawKind::Title || !title.first_on_line || !word.first_on_line || word.kind != RawKind::Word {
            continue;
        }
        let own = word.text(text);
        let known = ["NETWORK", "NETZWERK"].iter().any(|known| known.eq_ignore_ascii_case(own));
        if !known && word.keyword.is_none() && frame_words::slip_of(own, ["NETWORK"]).is_some() {
            tokens[at - 1].keyword = Some("NETWORK");
        }
    }
}

fn shape(kind: RawKind) -> Shape {
    match kind {
        RawKind::Word => Shape::Word,
        RawKind::Quoted => Shape::Name,
        RawKind::Colon => Shape::Colon,
        RawKind::Comma => Shape::Comma,
        RawKind::LeftBrace => Shape::LeftBrace,
        RawKind::Semicolon => Shape::Semicolon,
        RawKind::Number => Shape::Number,
        RawKind::Assign | RawKind::Dot | RawKind::DotDot | RawKind::LeftParen | RawKind::LeftBracket => Shape::Operator,
        RawKind::Newline
        | RawKind::Comment
        | RawKind::BlockComment
        | RawKind::SlashComment
        | RawKind::UnterminatedComment
        | RawKind::Literal
        | RawKind::Title
        | RawKind::Real
        | RawKind::UnterminatedQuoted
        | RawKind::Text
        | RawKind::UnterminatedText
        | RawKind::Marker
        | RawKind::RightParen
        | RawKind::RightBracket
        | RawKind::RightBrace
        | RawKind::Equal
        | RawKind::EqualEqual
        | RawKind::NotEqual
        | RawKind::Greater
        | RawKind::Less
        | RawKind::GreaterEqual
        | RawKind::LessEqual
        | RawKind::Plus
        | RawKind::Minus
        | RawKind::Star
        | RawKind::Slash
        | RawKind::Hash
        | RawKind::Percent
        | RawKind::Stray => Shape::Other,
    }
}

/// Consumes up to `*)`.
fn block_comment(lexer: &mut Lexer<RawKind>) -> RawKind {
    if front::skip_through(lexer, "*)") { RawKind::BlockComment } else { RawKind::UnterminatedComment }
}

fn slash_comment(lexer: &mut Lexer<RawKind>) -> RawKind {
    if front::skip_through(lexer, "*/") { RawKind::SlashComment } else { RawKind::UnterminatedComment }
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
        lexer.bump(1 + extent::word(digits));
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

/// Prefixes of constants that only declarations have: no instruction loads one.
const LONG_PREFIXES: [&str; 10] =
    ["LT", "LTIME", "LTOD", "LTIME_OF_DAY", "LDT", "DATE_AND_LTIME", "DTL", "LWORD", "WCHAR", "WSTRING"];

/// Whether a constant is of a type that only declarations have: `LT#5us`, `WSTRING#'a'`.
pub fn is_long(constant: &str) -> bool {
    constant
        .split_once('#')
        .is_some_and(|(prefix, _)| LONG_PREFIXES.iter().any(|known| known.eq_ignore_ascii_case(prefix)))
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
        ("SINT", LiteralForm::Number),
        ("USINT", LiteralForm::Number),
        ("INT", LiteralForm::Number),
        ("UINT", LiteralForm::Number),
        ("DINT", LiteralForm::Number),
        ("UDINT", LiteralForm::Number),
        ("LINT", LiteralForm::Number),
        ("ULINT", LiteralForm::Number),
        ("REAL", LiteralForm::Number),
        ("LREAL", LiteralForm::Number),
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
        ("LT", LiteralForm::Duration),
        ("LTIME", LiteralForm::Duration),
        ("LTOD", LiteralForm::Date),
        ("LTIME_OF_DAY", LiteralForm::Date),
        ("LDT", LiteralForm::Date),
        ("DATE_AND_LTIME", LiteralForm::Date),
        ("DTL", LiteralForm::Date),
        ("LWORD", LiteralForm::Number),
        ("WCHAR", LiteralForm::Text),
        ("WSTRING", LiteralForm::Text),
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
                .find(|c: char| !extent::is_word(c) && !matches!(c, ',' | ' ' | '\t' | '-'))
                .unwrap_or(rest.len() - open);
            let closed = rest[open + list..].starts_with(')');
            Some(open + list + usize::from(closed))
        }
        LiteralForm::Byte => Some(number_length(rest)),
        LiteralForm::Duration => {
            let sign = rest.len() - rest.trim_start_matches(['-', '+']).len();
            let digits = rest[sign..].find(|c: char| !extent::is_word(c) && c != '.').unwrap_or(rest.len() - sign);
            let length = sign + digits;
            Some(length + extent::decimal_comma(&rest[..length], &rest[length..]))
        }
        LiteralForm::Date => Some(date_length(rest)),
        LiteralForm::Pointer => pointer::length(rest, Tail::Included),
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

/// `16#FF`, `-7`, `1.5e+3`, `TRUE`.
fn number_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let mut at = rest.len() - rest.trim_start_matches(['-', '+']).len();
    at += extent::word(&rest[at..]);
    if bytes.get(at) == Some(&b'#') {
        at += 1;
        at += extent::word(&rest[at..]);
    }
    if bytes.get(at) == Some(&b'.') && bytes.get(at + 1).is_some_and(u8::is_ascii_digit) {
        at += 1;
        at += extent::word(&rest[at..]);
    }
    if at > 0 && matches!(bytes[at - 1], b'e' | b'E') && matches!(bytes.get(at), Some(b'+' | b'-')) {
        at += 1;
        at += extent::word(&rest[at..]);
    }
    at
}

/// `1999-12-8`, `1999 - 12 - 8`, `1:10:3.3`; `1999/12/8` has signs of other places, and is wrong as a whole.
fn date_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let mut end = extent::word(rest);
    loop {
        let mut at = end;
        while matches!(bytes.get(at), Some(b' ' | b'\t')) {
            at += 1;
        }
        let blanks = at > end;
        match bytes.get(at) {
            Some(b'-') => at += 1,
            Some(b':' | b'.' | b'/') if !blanks => at += 1,
            _ => return end,
        }
        while matches!(bytes.get(at), Some(b' ' | b'\t')) {
            at += 1;
        }
        if !bytes.get(at).is_some_and(u8::is_ascii_digit) {
            return end;
        }
        end = at + extent::word(&rest[at..]);
    }
}
