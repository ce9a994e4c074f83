//! The lexer: characters to raw tokens, regardless of where they are.
//!
//! Typed constants are one token (`T#2h_1m`, `P#DB11.DBX 20.0 INT 10`), and so are addresses with a point (`I0.0`, `%DB1.DBX1.0`).
//! Line ends, blanks and REGION lines are not tokens. Comments are in a separate list, by position.

use logos::{Lexer, Logos};

use super::keyword::Keyword;
use crate::front::frame_words::{self, Seen, Shape};
use crate::front::{self, Comment, CommentForm, Kind, Role, extent};

/// What a raw token is.
#[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
#[logos(extras = Past)]
#[logos(skip r"[ \t\r\f\x0B\x1A\u{A0}\u{FEFF}]+")]
pub enum RawKind {
    #[token("\n")]
    Newline,
    #[regex(r"//[^\n]*", allow_greedy = true)]
    Comment,
    /// `(* … *)`, nested, and `(/* … */)`.
    #[token("(*", block_comment)]
    #[token("(/*", multilingual_comment)]
    BlockComment,
    /// `/* … */`
    #[token("/*", slash_comment)]
    SlashComment,
    /// A comment that is not closed.
    UnterminatedComment,

    #[regex(r"[\p{XID_Start}_][\p{XID_Continue}]*", word)]
    Word,
    /// A constant with `#`.
    Literal,
    /// `I0.0`, `DX1.7`, `%MW10`, `%DB1.DBX1.0`, `%IW4:P`.
    #[regex(r"%[A-Za-z]+[0-9]*", percent)]
    Absolute,
    /// `%X3`, `%B1`, `%W0`, `%D0`.
    Slice,
    /// `TITLE = text`, with the rest of its line; only in the head of a block.
    Title,
    /// `REGION name`
    Region,
    /// `END_REGION`, `END_REGION name`
    EndRegion,
    #[regex(r"[0-9][0-9_]*", number)]
    Number,
    #[regex(r"[0-9][0-9_]*\.[0-9][0-9_]*([eE][+-]?[0-9]+)?")]
    #[regex(r"[0-9][0-9_]*[eE][+-]?[0-9]+")]
    Real,
    #[regex("\"[^\"\n]*\"", quoted)]
    Quoted,
    #[regex("\"[^\"\n]*")]
    UnterminatedQuoted,
    /// `#name`, `#"name"`
    #[regex(r"#[\p{XID_Continue}]+")]
    #[regex("#\"[^\"\n]*\"")]
    Local,
    #[token("'", text)]
    Text,
    UnterminatedText,
    /// `@@NAME@@`, `{{name}}`
    #[regex(r"@@[^@\n]*@@")]
    #[regex(r"\{\{[^{}\n]*\}\}")]
    Marker,

    #[token(":")]
    Colon,
    #[token(":=")]
    Assign,
    #[token("+=")]
    AddAssign,
    #[token("-=")]
    SubtractAssign,
    #[token("*=")]
    MultiplyAssign,
    #[token("/=")]
    DivideAssign,
    #[token("?=")]
    AttemptAssign,
    #[token("=>")]
    Arrow,
    #[token("**")]
    Power,
    #[token(";")]
    Semicolon,
    #[token(",")]
    Comma,
    #[token(".")]
    Dot,
    #[token("..")]
    DotDot,
    #[token("...")]
    Ellipsis,
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
    #[token("^")]
    Caret,
    #[token("#")]
    Hash,
    /// A part that has been reported, in place of an expression.
    Reported,
    /// A character that no statement contains.
    Stray,
}

/// What the lexer knows about the text that it has read.
#[derive(Default)]
pub struct Past {
    /// The name of a block has been read, but no declaration yet: `TITLE` includes its line.
    head: bool,
    /// A comment was not closed when those inside it were counted: comments of this file do not nest.
    flat_comments: bool,
    /// Structured text of IEC 61131-3.
    iec: bool,
    /// Names of the regions that are open.
    regions: Vec<String>,
}

/// Structured text of IEC 61131-3, which shares the grammar of SCL, but not all of its words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Iec {
    /// A comment inside a comment counts.
    pub nested_comments: bool,
}

impl RawKind {
    /// `:=`, `+=`, `?=` and the like.
    pub fn assigns(self) -> bool {
        matches!(
            self,
            RawKind::Assign
                | RawKind::AddAssign
                | RawKind::SubtractAssign
                | RawKind::MultiplyAssign
                | RawKind::DivideAssign
                | RawKind::AttemptAssign
        )
    }
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

/// The keyword is that of a word which is not after a point.
pub type RawToken = front::RawToken<RawKind, Option<Keyword>>;

/// `REGION name`, or `END_REGION`.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    pub start: u32,
    pub end: u32,
    pub opens: bool,
    /// Number of tokens before it.
    pub token: u32,
}

/// A misspelt keyword.
#[derive(Clone, Copy, Debug)]
pub struct Slip {
    pub start: u32,
    pub end: u32,
    /// What is meant.
    pub keyword: &'static str,
}

/// The tokens, comments and regions of a text, each in its order.
#[derive(Default)]
pub struct RawText {
    pub tokens: Vec<RawToken>,
    pub comments: Vec<Comment>,
    pub regions: Vec<Region>,
    /// Misspelt keywords of frames, which count as what is meant.
    pub slips: Vec<Slip>,
    /// Structured text of IEC 61131-3: addresses have `%`, and words of SCL alone are names.
    pub iec: bool,
}

impl RawText {
    /// Shifts all positions to where the scanned part of a text begins.
    pub fn shift(&mut self, by: u32) {
        front::shift(&mut self.tokens, &mut self.comments, by);
        for region in &mut self.regions {
            region.start += by;
            region.end += by;
        }
        for slip in &mut self.slips {
            slip.start += by;
            slip.end += by;
        }
    }
}

/// Splits `text` into raw tokens. Never fails: text that is not a token becomes `Stray`.
pub fn scan(text: &str) -> RawText {
    let mut raw = tokens(text, Past::default());
    read_slips(text, &mut raw);
    raw
}

/// Takes misspelt keywords of frames as what is meant.
fn read_slips(text: &str, raw: &mut RawText) {
    let seen = |at: usize| {
        let token: RawToken = raw.tokens[at];
        Seen { shape: shape(token.kind), text: token.text(text), first_on_line: token.first_on_line }
    };
    let found = frame_words::find(raw.tokens.len(), seen);
    for meant in found.iter().rev() {
        let end = raw.tokens[meant.first + meant.count - 1].end;
        let token = &mut raw.tokens[meant.first];
        (token.end, token.keyword) = (end, Keyword::from_word(meant.keyword));
        raw.slips.push(Slip { start: token.start, end, keyword: meant.keyword });
        raw.tokens.drain(meant.first + 1..meant.first + meant.count);
        for region in &mut raw.regions {
            if region.token as usize > meant.first {
                region.token -= (meant.count - 1) as u32;
            }
        }
    }
    raw.slips.reverse();
}

fn shape(kind: RawKind) -> Shape {
    match kind {
        RawKind::Word => Shape::Word,
        RawKind::Quoted | RawKind::Local => Shape::Name,
        RawKind::Colon => Shape::Colon,
        RawKind::Comma => Shape::Comma,
        RawKind::LeftBrace => Shape::LeftBrace,
        RawKind::Semicolon => Shape::Semicolon,
        RawKind::Number => Shape::Number,
        RawKind::RightParen | RawKind::RightBracket | RawKind::RightBrace => Shape::Other,
        RawKind::Newline
        | RawKind::Comment
        | RawKind::BlockComment
        | RawKind::SlashComment
        | RawKind::UnterminatedComment
        | RawKind::Literal
        | RawKind::Absolute
        | RawKind::Slice
        | RawKind::Title
        | RawKind::Region
        | RawKind::EndRegion
        | RawKind::Real
        | RawKind::UnterminatedQuoted
        | RawKind::Text
        | RawKind::UnterminatedText
        | RawKind::Marker
        | RawKind::Reported
        | RawKind::Hash
        | RawKind::Stray => Shape::Other,
        RawKind::Assign
        | RawKind::AddAssign
        | RawKind::SubtractAssign
        | RawKind::MultiplyAssign
        | RawKind::DivideAssign
        | RawKind::AttemptAssign
        | RawKind::Arrow
        | RawKind::Power
        | RawKind::Dot
        | RawKind::DotDot
        | RawKind::Ellipsis
        | RawKind::LeftParen
        | RawKind::LeftBracket
        | RawKind::Equal
        | RawKind::NotEqual
        | RawKind::Greater
        | RawKind::Less
        | RawKind::GreaterEqual
        | RawKind::LessEqual
        | RawKind::Plus
        | RawKind::Minus
        | RawKind::Star
        | RawKind::Slash
        | RawKind::Ampersand
        | RawKind::Caret => Shape::Operator,
    }
}

/// As [`scan`], of structured text as IEC 61131-3 has it.
pub fn scan_iec(text: &str, rules: Iec) -> RawText {
    let mut raw = tokens(text, Past { iec: true, flat_comments: !rules.nested_comments, ..Past::default() });
    raw.iec = true;
    // `JMP label;`
    for at in 0..raw.tokens.len().saturating_sub(2) {
        let is = |at: usize, kind| raw.tokens[at].kind == kind;
        if is(at, RawKind::Word)
            && is(at + 1, RawKind::Word)
            && is(at + 2, RawKind::Semicolon)
            && text[raw.tokens[at].range()].eq_ignore_ascii_case("JMP")
        {
            raw.tokens[at].keyword = Some(Keyword::Goto);
        }
    }
    raw
}

fn tokens(text: &str, past: Past) -> RawText {
    let iec = past.iec;
    let mut regions = Vec::new();
    let raw = front::scan(RawKind::lexer_with_extras(text, past), |lexer, kind, tokens: &[RawToken]| {
        if matches!(kind, RawKind::Region | RawKind::EndRegion) {
            let (start, end) = (lexer.span().start as u32, lexer.span().end as u32);
            regions.push(Region { start, end, opens: kind == RawKind::Region, token: tokens.len() as u32 });
            return None;
        }
        let member = tokens.last().is_some_and(|before| before.kind == RawKind::Dot);
        let keyword = if kind == RawKind::Word && !member { Keyword::from_word(lexer.slice()) } else { None };
        let keyword = keyword.filter(|keyword| !iec || keyword.is_iec());
        if let Some(keyword) = keyword {
            let head = &mut lexer.extras.head;
            *head = keyword.begins_block() || *head && !leaves_head(keyword);
        }
        Some(keyword)
    });
    RawText { tokens: raw.tokens, comments: raw.comments, regions, ..RawText::default() }
}

fn leaves_head(keyword: Keyword) -> bool {
    keyword.begins_section()
        || keyword.ends_block()
        || keyword.begins_statement()
        || matches!(keyword, Keyword::Begin | Keyword::Struct | Keyword::Array)
}

/// Consumes up to the `*)` that belongs to the opening. If inner comments use it up, the first `*)` ends the comment, which counts as not
/// closed.
fn block_comment(lexer: &mut Lexer<RawKind>) -> RawKind {
    let rest = lexer.remainder();
    let (mut at, mut depth) = (0, 1);
    while !lexer.extras.flat_comments
        && let Some(found) = rest[at..].find(['*', '('])
    {
        at += found;
        if rest[at..].starts_with("*)") {
            at += 2;
            depth -= 1;
            if depth == 0 {
                lexer.bump(at);
                return RawKind::BlockComment;
            }
        } else if rest[at..].starts_with("(*") {
            at += 2;
            // `(*)` inside is a parenthesis around a star.
            if rest[at..].starts_with(')') {
                at += 1;
            } else {
                depth += 1;
            }
        } else {
            at += 1;
        }
    }
    let end = rest.find("*)");
    lexer.bump(end.map_or(rest.len(), |end| end + 2));
    let nests = !std::mem::replace(&mut lexer.extras.flat_comments, true) && !lexer.extras.iec;
    if nests || end.is_none() { RawKind::UnterminatedComment } else { RawKind::BlockComment }
}

fn multilingual_comment(lexer: &mut Lexer<RawKind>) -> RawKind {
    if front::skip_through(lexer, "*/)") { RawKind::BlockComment } else { RawKind::UnterminatedComment }
}

fn slash_comment(lexer: &mut Lexer<RawKind>) -> RawKind {
    if front::skip_through(lexer, "*/") { RawKind::SlashComment } else { RawKind::UnterminatedComment }
}

/// A word may begin a constant (`T#`), an address with a point (`M10.0`), a title or a region.
fn word(lexer: &mut Lexer<RawKind>) -> RawKind {
    let (slice, rest) = (lexer.slice(), lexer.remainder());
    if rest.starts_with('#')
        && let Some(length) = extent::literal(slice, &rest[1..])
    {
        lexer.bump(1 + length);
        return RawKind::Literal;
    }
    if lexer.extras.iec {
        return RawKind::Word;
    }
    let member = front::after_point(lexer);
    if let Some(length) = extent::bit_number(slice, rest, member) {
        lexer.bump(length);
        return RawKind::Absolute;
    }
    if member {
        // `"tag".component:P`; not the label `1..MAX:` before a variable P.
        let is_range = lexer.source()[..lexer.span().start].ends_with("..");
        if extent::peripheral(rest) && !is_range {
            lexer.bump(2);
        }
        return RawKind::Word;
    }
    let blanks = rest.len() - rest.trim_start_matches([' ', '\t']).len();
    let next = rest[blanks..].chars().next();
    if lexer.extras.head && slice.eq_ignore_ascii_case("title") && !matches!(next, Some(':' | ',' | '.' | '(' | '[')) {
        let line = rest.find('\n').unwrap_or(rest.len());
        lexer.bump(rest[..line].trim_end().len());
        return RawKind::Title;
    }
    if slice.eq_ignore_ascii_case("region") && next != Some(':') {
        let line = rest.find('\n').unwrap_or(rest.len());
        let line = rest[..line].find("//").unwrap_or(line);
        lexer.extras.regions.push(rest[..line].trim().to_owned());
        lexer.bump(line);
        return RawKind::Region;
    }
    if slice.eq_ignore_ascii_case("end_region") {
        let opened = lexer.extras.regions.pop().unwrap_or_default();
        if next == Some(';') {
            lexer.bump(blanks + 1);
        } else {
            lexer.bump(repeated_name(rest, &opened));
        }
        return RawKind::EndRegion;
    }
    RawKind::Word
}

/// The length of the name that a region repeats at its end: `END_REGION Outputs`. `rest`: the text after the keyword, `opened`: the name.
///
/// A line that may be a statement repeats no name.
fn repeated_name(rest: &str, opened: &str) -> usize {
    let line = rest.split('\n').next().unwrap_or_default();
    let line = line.split("//").next().unwrap_or_default();
    let line = line.split("(*").next().unwrap_or_default().trim_end();
    let name = line.trim_start_matches([' ', '\t']);
    let first = name.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
    let is_text = (!first.is_empty() || name.starts_with('"'))
        && Keyword::from_word(first).is_none()
        && !matches!(first.to_ascii_uppercase().as_str(), "REGION" | "END_REGION")
        && !name.contains([':', ';', '=', '(', '[', '{']);
    let is_repeated = !name.is_empty() && name.eq_ignore_ascii_case(opened);
    if name.len() < line.len() && (is_repeated || is_text) { line.len() } else { 0 }
}

/// `%` and letters: an address or a part of a value.
fn percent(lexer: &mut Lexer<RawKind>) -> RawKind {
    let slice = &lexer.slice()[1..];
    let letters = slice.trim_end_matches(|c: char| c.is_ascii_digit());
    if lexer.extras.iec && !front::after_point(lexer) {
        lexer.bump(extent::directly_represented(lexer.remainder()));
        return RawKind::Absolute;
    }
    if matches!(letters, "X" | "B" | "W" | "D" | "x" | "b" | "w" | "d") && letters.len() < slice.len() {
        return RawKind::Slice;
    }
    lexer.bump(extent::absolute(letters, letters.len() < slice.len(), lexer.remainder()));
    RawKind::Absolute
}

/// A number may be the base of a constant: `16#`, `2#`.
fn number(lexer: &mut Lexer<RawKind>) -> RawKind {
    match lexer.remainder().strip_prefix('#') {
        Some(digits) => {
            lexer.bump(1 + extent::word(digits));
            RawKind::Literal
        }
        None => RawKind::Number,
    }
}

/// `"tag":P` is one token.
fn quoted(lexer: &mut Lexer<RawKind>) {
    if extent::peripheral(lexer.remainder()) {
        lexer.bump(2);
    }
}

/// Consumes up to the closing quote.
fn text(lexer: &mut Lexer<RawKind>) -> RawKind {
    if front::skip_text(lexer) { RawKind::Text } else { RawKind::UnterminatedText }
}
