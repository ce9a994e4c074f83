//! Tokens of a network as the grammar sees them: rungs and parentheses are balanced, operands are one token each.

use super::pragma::Attribute;
use plcc_syntax::network::ast::Comparison;

/// A token of the grammar.
#[derive(Clone, Debug, PartialEq)]
pub enum Tok<'a> {
    /// `Label` at the start of a network.
    Label,
    Rung,
    EndRung,
    /// `wire#w1` in a rung: its name.
    Wire(&'a str),
    /// `NOT` in a rung.
    Not,
    /// `{ S7_Templates := "…" }` before an element.
    Pragma(Vec<Attribute>),
    /// An operand that leads a rung, in all its length.
    Operand,
    /// What stands before the parentheses of an element.
    Target,
    /// `{ SrcType := Int }` after the name of an element.
    Inline(Vec<Attribute>),
    /// The name of a pin before `:=` or `=>`.
    Pin,
    /// `GE` in `GE #limit => label`.
    Case(Comparison),
    /// An operand, constant or name at a pin, in all its length.
    Value,
    /// `wire#w1` at a pin: its name.
    Connected(&'a str),
    /// `NOT` at a pin.
    Negated,
    Assign,
    Arrow,
    Comma,
    LeftParen,
    RightParen,
    /// What no network holds.
    Stray,
}

/// A token with its bytes in the text.
pub type Spanned<'a> = (usize, Tok<'a>, usize);
