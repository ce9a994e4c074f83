//! The lexer: characters to raw tokens, regardless of where they are.
//!
//! A comment that begins with `$_` and a tag has a meaning and is a token; other comments stand in a separate list. Constants with `#`
//! are one token, and so are addresses with a point or a blank (`I0.0`, `I 0.0`, `MW 10`). Lines end with CR, LF or both.
//! Source: GRAPH reference A.1.

use logos::{Lexer, Logos};

use plcc_syntax::ast::Width;
use plcc_syntax::front::{self, CommentForm, Kind, Role, extent};
use plcc_syntax::scl::address;

/// What a raw token is.
#[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
#[logos(extras = Head)]
#[logos(skip r"[ \t\f\x0B\x1A\u{A0}\u{FEFF}]+")]
pub enum RawKind {
    #[regex(r"[\r\n]+")]
    Newline,
    #[regex(r"//[^\r\n]*", allow_greedy = true)]
    LineComment,
    /// `(* … *)`
    #[token("(*", comment)]
    BlockComment,
    /// `(*$_TAG … *)`
    Pragma,
    UnterminatedComment,

    /// Names may begin with a digit.
    #[regex(r"[\p{XID_Start}_0-9][\p{XID_Continue}]*", word)]
    Word,
    /// `15`
    Number,
    /// A constant that is not a whole number: `1.5`, `T#5S`, `16#FF`.
    Literal,
    /// `I0.0`, `I 0.0`, `DBX1.0` after a point, `%MW10`.
    #[regex(r"%[A-Za-z]+[0-9]*", percent)]
    Absolute,
    /// A line of the head: `TITLE = …`, `AUTHOR : …`, `KNOW_HOW_PROTECT`.
    Header,
    #[regex("\"[^\"\r\n]*\"")]
    Quoted,
    #[regex("\"[^\"\r\n]*")]
    UnterminatedQuoted,
    /// `#name`, `#"name"`
    #[regex(r"#[\p{XID_Continue}]+")]
    #[regex("#\"[^\"\r\n]*\"")]
    Local,
    #[token("'", text)]
    Text,
    UnterminatedText,

    #[token(":")]
    Colon,
    #[token(":=")]
    Assign,
    #[token("=>")]
    Arrow,
    #[token(";")]
    Semicolon,
    #[token(",")]
    Comma,
    #[token(".")]
    Dot,
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
    /// Also the form of STL, `==`.
    #[token("=")]
    #[token("==")]
    Equal,
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
    #[token("&")]
    Ampersand,
    /// A character that no block contains.
    Stray,
}

/// What may be inside of an address.
pub const BLANKS: [char; 2] = [' ', '\t'];

/// Whether the lexer is in the head of a block, where a field includes its line.
#[derive(Default)]
pub struct Head(bool);

impl Kind for RawKind {
    const STRAY: RawKind = RawKind::Stray;
    const BRACKETS: [RawKind; 4] =
        [RawKind::LeftParen, RawKind::RightParen, RawKind::LeftBracket, RawKind::RightBracket];
    const LINE_ENDS: &'static [char] = &['\n', '\r'];

    fn role(self) -> Role {
        match self {
            RawKind::Newline => Role::LineEnd,
            RawKind::LineComment => Role::Comment(CommentForm::Line),
            RawKind::BlockComment => Role::Comment(CommentForm::Block),
            RawKind::UnterminatedComment => Role::Comment(CommentForm::Unterminated),
            _ => Role::Token,
        }
    }
}

pub type RawToken = front::RawToken<RawKind>;
pub type RawText = front::RawText<RawKind>;

/// Splits `text` into raw tokens. Never fails: text that is not a token becomes `Stray`.
pub fn scan(text: &str) -> RawText {
    front::scan(RawKind::lexer(text), |_, _, _| Some(()))
}

/// Consumes up to the first `*)`.
fn comment(lexer: &mut Lexer<RawKind>) -> RawKind {
    let tag = lexer.remainder().strip_prefix("$_");
    let pragma = tag.is_some_and(|tag| tag.starts_with(|c: char| c.is_ascii_alphabetic()));
    match front::skip_through(lexer, "*)") {
        true if pragma => RawKind::Pragma,
        true => RawKind::BlockComment,
        false => RawKind::UnterminatedComment,
    }
}

/// A word may be a number, or begin a constant (`T#`), an address with a point (`M10.0`) or a line of the head.
fn word(lexer: &mut Lexer<RawKind>) -> RawKind {
    let (slice, rest) = (lexer.slice(), lexer.remainder());
    let member = front::after_point(lexer);
    if let Some((kind, length)) = constant(slice, rest, member) {
        lexer.bump(length);
        return kind;
    }
    if let Some(length) = extent::bit_number(slice, rest, member) {
        lexer.bump(length);
        return RawKind::Absolute;
    }
    if let Some((kind, length)) = spaced_address(slice, rest, member) {
        lexer.bump(length);
        return kind;
    }
    if member {
        return RawKind::Word;
    }
    let is = |words: &[&str]| words.iter().any(|word| word.eq_ignore_ascii_case(slice));
    if is(&["FUNCTION_BLOCK"]) {
        lexer.extras.0 = true;
    } else if lexer.extras.0 && is_field(slice, rest) {
        let line = rest.find(['\n', '\r']).unwrap_or(rest.len());
        let line = rest[..line].find("(*$_").unwrap_or(line);
        lexer.bump(rest[..line].trim_end().len());
        return RawKind::Header;
    } else if lexer.extras.0 && is(&["KNOW_HOW_PROTECT", "CODE_VERSION1"]) && ends_line(rest) {
        return RawKind::Header;
    } else if is(&["END_FUNCTION_BLOCK", "INITIAL_STEP", "STEP", "TRANSITION", "SEQUENCE", "VAR"])
        || ["VAR_", "PERM_"]
            .iter()
            .any(|head| slice.get(..head.len()).is_some_and(|found| found.eq_ignore_ascii_case(head)))
    {
        lexer.extras.0 = false;
    }
    RawKind::Word
}

/// Whether a field of the head begins with the word `field`.
fn is_field(field: &str, rest: &str) -> bool {
    let next = rest.trim_start_matches(BLANKS).as_bytes();
    if field.eq_ignore_ascii_case("TITLE") {
        return next.first() == Some(&b'=');
    }
    ["AUTHOR", "FAMILY", "NAME", "VERSION"].iter().any(|known| known.eq_ignore_ascii_case(field))
        && next.first() == Some(&b':')
        && next.get(1) != Some(&b'=')
}

/// Whether nothing but a comment follows in the line.
fn ends_line(rest: &str) -> bool {
    let line = rest.trim_start_matches(BLANKS);
    line.is_empty() || ["\n", "\r", "//", "(*"].iter().any(|start| line.starts_with(start))
}

/// A constant that begins with the word: its kind, and the number of bytes after the word that belong to it.
fn constant(word: &str, rest: &str, member: bool) -> Option<(RawKind, usize)> {
    let number = word.bytes().all(|byte| byte.is_ascii_digit() || byte == b'_') && !word.starts_with('_');
    if let Some(value) = rest.strip_prefix('#') {
        let length = if number { Some(extent::word(value)) } else { extent::literal(word, value) };
        return length.map(|length| (RawKind::Literal, 1 + length));
    }
    if member {
        return None;
    }
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let exponent = |text: &str| match text.as_bytes() {
        [b'+' | b'-', b'0'..=b'9', ..] => 1 + digits(&text[1..]),
        _ => 0,
    };
    if number {
        let fraction = rest.strip_prefix('.').filter(|after| digits(after) > 0);
        let Some(fraction) = fraction else { return Some((RawKind::Number, 0)) };
        let length = extent::word(fraction);
        let scaled = fraction[..length].ends_with(['e', 'E']);
        let sign = if scaled { exponent(&fraction[length..]) } else { 0 };
        return Some((RawKind::Literal, 1 + length + sign));
    }
    let mantissa = digits(word);
    let scaled = mantissa > 0 && word[mantissa..].eq_ignore_ascii_case("e");
    match if scaled { exponent(rest) } else { 0 } {
        0 => None,
        length => Some((RawKind::Literal, length)),
    }
}

/// `I 0.0`, `MW 10`, `T 5`, `FB 1`, `DBX 1.0` after a point: blanks between prefix and number.
fn spaced_address(letters: &str, rest: &str, member: bool) -> Option<(RawKind, usize)> {
    let number = rest.trim_start_matches(BLANKS);
    let blanks = rest.len() - number.len();
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let byte = digits(number);
    if byte == 0 || blanks == 0 {
        return None;
    }
    let width =
        if member { address::db_area_word(letters) } else { address::area_word(letters).map(|(_, width)| width) };
    let (kind, length) = match width {
        Some(Width::Bit) => {
            let bit = digits(number[byte..].strip_prefix('.')?);
            if bit == 0 {
                return None;
            }
            (RawKind::Absolute, byte + 1 + bit)
        }
        Some(_) => (RawKind::Word, byte),
        None if member => return None,
        None => {
            let cell = ["T", "C", "Z"].iter().any(|cell| cell.eq_ignore_ascii_case(letters));
            if !cell && address::block_prefix(letters).is_none() {
                return None;
            }
            (RawKind::Word, byte)
        }
    };
    // `T 5_name` is not an address.
    (extent::word(&number[length..]) == 0).then_some((kind, blanks + length))
}

/// `%MW10`, `%I0.0`
fn percent(lexer: &mut Lexer<RawKind>) -> RawKind {
    let slice = &lexer.slice()[1..];
    let letters = slice.trim_end_matches(|c: char| c.is_ascii_digit());
    lexer.bump(extent::absolute(letters, letters.len() < slice.len(), lexer.remainder()));
    RawKind::Absolute
}

/// Consumes up to the closing quote.
fn text(lexer: &mut Lexer<RawKind>) -> RawKind {
    if front::skip_text(lexer) { RawKind::Text } else { RawKind::UnterminatedText }
}
