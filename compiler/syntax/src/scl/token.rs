//! Tokens as the grammar sees them: frames and structured statements are balanced, each token says what it means where it is.

use crate::ast::{BlockPrefix, OperandKind, Pragma, Retain, SectionKind, Width};
use crate::front::{self, Brackets};
use crate::scl::ast::{AssignOp, BinaryOp, Literal};

pub use crate::stl::token::{CodeKeyword, HeaderField, HeaderFlag};

/// A token of the grammar. Texts are slices of the source.
#[derive(Clone, Debug, PartialEq)]
pub enum Tok<'a> {
    // Frames.
    Code(CodeKeyword),
    /// Statements without a header follow.
    ImpliedOb,
    DataBlock,
    Type,
    EndBlock,
    Begin,
    Title(&'a str),
    HeaderText(HeaderField, &'a str),
    HeaderFlag(HeaderFlag),
    Attribute(&'a str, &'a str),
    Section(SectionKind, Retain),
    /// `VAR CONSTANT`, `CONST`
    Constants,
    Labels,
    EndVar,

    // Declarations.
    /// The contents of a data block or a type follow.
    Content,
    Struct,
    EndStruct,
    Array,
    Of,
    StringType,
    WideStringType,
    RefTo,
    At,

    // Statements.
    /// `;`, or the place where it is left out.
    End,
    /// `;` alone.
    Empty,
    Label(&'a str),
    /// Values of CASE follow.
    Arm,
    If,
    Then,
    Elsif,
    Else,
    EndIf,
    Case,
    EndCase,
    For,
    To,
    By,
    Do,
    EndFor,
    While,
    EndWhile,
    Repeat,
    Until,
    EndRepeat,
    Exit,
    Continue,
    Return,
    Goto,
    Pragma(Box<Pragma>),
    /// A part that has been reported, in place of an expression.
    Bad,

    // Operands.
    Name(&'a str),
    /// `#name`, without `#`.
    Local(&'a str),
    /// `"name"`, without quotes.
    Quoted(&'a str),
    /// `FC 7`, `DB10`
    Block(BlockPrefix, u32),
    Literal(Literal),
    Absolute(OperandKind),
    Slice(Width, u32),
    Ref,

    // Operators.
    Or,
    Xor,
    And,
    Not,
    /// `=`, `<>`
    Equality(BinaryOp),
    /// `<`, `>`, `<=`, `>=`
    Relation(BinaryOp),
    Plus,
    Minus,
    Star,
    /// `/`, `DIV`, `MOD`
    Factor(BinaryOp),
    Power,
    Caret,

    // Signs.
    Colon,
    /// `:=`
    Assign,
    /// `+=` and others.
    Combine(AssignOp),
    Arrow,
    Comma,
    Dot,
    DotDot,
    LeftParen,
    RightParen,
    LeftBracket,
    RightBracket,
}

impl Brackets for Tok<'_> {
    const BRACKETS: [Self; 4] = [Tok::LeftParen, Tok::RightParen, Tok::LeftBracket, Tok::RightBracket];
}

/// A token with its bytes in the text.
pub type Spanned<'a> = front::Spanned<Tok<'a>>;
