//! Tokens of a chart as the grammar sees them: parts and brackets are balanced, rows and conditions have an end.

use plcc_syntax::chart::ast::{Coil, Event, Qualifier};
use plcc_syntax::front::{self, Brackets};
use plcc_syntax::scl::ast::BinaryOp;

/// A token of the grammar. Texts are slices of the source.
#[derive(Clone, Debug, PartialEq)]
pub enum Tok<'a> {
    // Parts.
    /// `(*$_CMPSET …*)`, `(*$_SETTINGS …*)`: the text after the tag.
    Settings(&'a str),
    /// `(*$_COM …*)`: the text after the tag.
    Comment(&'a str),
    /// `PERM_CONDITION_AT_END` if true, else `PERM_CONDITION_AT_BEGIN`.
    Permanents(bool),
    /// `INITIAL_STEP` if true, else `STEP`.
    Step(bool),
    Transition,
    Interlock,
    Supervision,
    From,
    To,
    Condition,
    /// End of a part.
    End,
    /// End of a row, a condition or a list of steps.
    RowEnd,

    /// `(*$_NUM 3*)`; 0: reported.
    Number(u32),
    /// `(*$_JUMP*)`
    Jump,
    /// The parentheses after an action; none: reported.
    Qualifier(Option<Mark>),
    /// `(=)`, `(S)`, `(R)`; none: reported.
    Coil(Option<Coil>),
    Call,
    /// `S_ALL`
    All,

    // Operands.
    Word(&'a str),
    /// Without quotes.
    Quoted(&'a str),
    /// Without `#` and quotes.
    Local(&'a str),
    Absolute(&'a str),
    Literal(&'a str),
    /// A token that cannot begin an operand; reported.
    Bad,

    // Operators and signs.
    Or,
    Xor,
    And,
    Not,
    Compare(BinaryOp),
    Plus,
    Minus,
    Star,
    /// `/`, `DIV`, `MOD`
    Factor(BinaryOp),
    /// `SHL`, `SHR`, `ROL`, `ROR` between operands.
    Shift(&'a str),
    Assign,
    Comma,
    Dot,
    LeftParen,
    RightParen,
    LeftBracket,
    RightBracket,
}

/// Event, qualifier and the letter C of an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    pub event: Option<Event>,
    pub qualifier: Qualifier,
    pub interlock: bool,
}

impl Brackets for Tok<'_> {
    const BRACKETS: [Self; 4] = [Tok::LeftParen, Tok::RightParen, Tok::LeftBracket, Tok::RightBracket];
}

/// A token with its bytes in the text.
pub type Spanned<'a> = front::Spanned<Tok<'a>>;
