//! Tokens as the grammar sees them: each token says what it means where it is.

use crate::ast::{Pragma, Width};
use crate::front;
use crate::s7200::Insn;
use crate::s7200::ast::{Assert, BlockKind, Direct, Section, SymbolForm};

/// A token of the grammar. Texts are slices of the source.
#[derive(Clone, Debug, PartialEq)]
pub enum Tok<'a> {
    // Frames.
    Header(BlockKind),
    EndBlock(BlockKind),
    DataHeader,
    EndData,
    /// The name of a block, without quotes.
    Name(&'a str),
    /// Text after `TITLE=`.
    Title(&'a str),
    Section(Section),
    EndVar,
    Begin,
    Network,
    /// `SBR 3`, `INT 0` of a flat list.
    Marker(BlockKind),
    /// Text after `//`.
    Comment(&'a str),
    /// The end of a line.
    End,

    // Beginnings of lines.
    /// A line with declarations begins.
    Declaration,
    /// A line of a data block begins; the flag: with an address.
    Data(bool),
    Insn(Insn),
    Pragma(Box<Pragma>, Option<Box<Assert>>),
    /// A part that has been reported, in place of a line.
    BadLine,

    // Operands.
    /// A symbol with the colon after it; the address or the block that it stands for follows.
    Shown(&'a str, SymbolForm),
    Direct(Direct),
    Block(BlockKind, u32),
    /// A name as written.
    Bare(&'a str),
    /// Without `#`.
    Local(&'a str),
    /// Without quotes.
    Quoted(&'a str),
    Bool(bool),
    Integer(i64),
    Bits(u32, Option<Width>),
    Real(f32),
    Characters(Vec<u8>),
    Text(Vec<u8>),
    /// A part that has been reported, in place of an operand.
    BadOperand,
    Star,
    Ampersand,
    Plus,
    Minus,

    // Assertions.
    /// `S0` to `S8`.
    Stack(u8),
    Eno,

    // Signs.
    Colon,
    Assign,
    Semicolon,
    Comma,
    /// A token that fits no line; the grammar reports it.
    Stray,
}

/// A token with its bytes in the text.
pub type Spanned<'a> = front::Spanned<Tok<'a>>;
