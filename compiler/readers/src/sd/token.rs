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
    /// A whole operand that begins a rung.
    Operand,
    /// The text before the parentheses of an element.
    Target,
    /// `{ SrcType := Int }` after the name of an element.
    Inline(Vec<Attribute>),
    /// The name of a pin before `:=` or `=>`.
    Pin,
    /// `GE` in `GE #limit => label`.
    Case(Comparison),
    /// A whole operand, constant or name at a pin.
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
    /// A token that no network contains.
    Stray,
}
