//! Tokens as the grammar sees them: each token says what it means where it is.

use crate::ast::{AddressRegister, AssertRegister};
use crate::ast::{Area, BlockPrefix, CellKind, Pragma, SectionKind, SpecialRegister, StatusOperand, Width};
use crate::front;
use crate::literal::Literal;
use crate::scl;
use crate::stl::StlInsn;

/// Keyword that opens a block with code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CodeKeyword {
    OrganizationBlock,
    Function,
    FunctionBlock,
}

/// A header line with a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeaderField {
    Author,
    Family,
    Name,
    Version,
}

/// A header keyword without a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeaderFlag {
    KnowHowProtect,
    Standard,
    CodeVersion1,
    Unlinked,
    ReadOnly,
    NonRetain,
    Retain,
}

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
    Network,
    /// Text after `TITLE =`.
    Title(&'a str),
    HeaderText(HeaderField, &'a str),
    HeaderFlag(HeaderFlag),
    Section(SectionKind),
    /// `VAR CONSTANT`
    Constants,
    EndVar,

    // Declarations.
    Struct,
    EndStruct,
    Array,
    Of,
    /// The type `STRING`.
    StringType,
    WideStringType,
    At,
    /// `(` before the values of a structure, `(5, TRUE)`.
    Values,
    /// A value in an attribute list, without quotes.
    AttributeValue(&'a str),
    /// `;` in an attribute list.
    AttributeEnd,

    // Statements.
    /// `;`, or a line end that ends a statement.
    End,
    Label(&'a str),
    Insn(StlInsn),
    /// An instruction whose operand is a label.
    Jump(StlInsn),
    /// Operand of a jump.
    Target(&'a str),
    Call,
    /// `src_type := Int` in braces: both names.
    CallType(&'a str, &'a str),
    /// A line end before `name :=` of a call without parentheses.
    ParameterLine,
    Pragma(Box<Pragma>),
    /// A part that has been reported, in place of a statement.
    BadStatement,
    /// A part that has been reported, in place of an operand.
    BadOperand,

    // Operands.
    /// Area letters: `I`, `MW`, `DBX`.
    Area(Area, Width),
    /// `B`, `W`, `D` before a register.
    Width(Width),
    /// `T`, `C`.
    Cell(CellKind),
    /// `0.0` after area letters.
    BitAddress(u32, u8),
    /// `10` after area letters, `T` and `C`.
    Address(u32),
    /// `FC 7`.
    Block(BlockPrefix, u32),
    /// `FC` before `[`.
    BlockLetters(BlockPrefix),
    Register(AddressRegister),
    Status(StatusOperand),
    Special(SpecialRegister),
    /// `:P` after a name.
    Peripheral,
    /// `P##` before a name.
    PointerTo,
    /// `#name`, without `#`.
    Local(&'a str),
    /// `"name"`, without quotes.
    Quoted(&'a str),
    /// A name as written.
    Name(&'a str),
    Literal(Literal),
    /// A constant that only declarations have, `LT#5us`, `16#1_0000_0000`, and whether `-` is before it.
    LongLiteral(scl::ast::Literal, bool),

    // Assertions.
    AssertRegister(AssertRegister),

    // Signs.
    Colon,
    Assign,
    Semicolon,
    Comma,
    Dot,
    DotDot,
    LeftParen,
    RightParen,
    LeftBracket,
    RightBracket,
    LeftBrace,
    RightBrace,
}

/// A token with its bytes in the text.
pub type Spanned<'a> = front::Spanned<Tok<'a>>;
