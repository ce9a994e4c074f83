//! Networks as written: rungs and their parts. `graph` turns them into elements and nets.

use plcc_diag::Span;

use super::pragma::Attribute;
use plcc_syntax::network::ast::Comparison;

/// A part of a network.
#[derive(Debug)]
pub enum Part<'a> {
    /// `Label( name )`; its span covers all of it.
    Label(Vec<Argument<'a>>, Span),
    Rung(Rung<'a>),
}

/// `RUNG … END_RUNG wire#w1`
#[derive(Debug)]
pub struct Rung<'a> {
    pub items: Vec<Item<'a>>,
    pub end: Option<Wire<'a>>,
    /// Without `END_RUNG`, which was reported.
    pub is_open: bool,
    /// Of `RUNG`.
    pub span: Span,
}

/// A part of a rung.
#[derive(Debug)]
pub enum Item<'a> {
    Wire(Wire<'a>),
    Not(Span),
    /// The operand that begins a rung of FBD.
    Operand(Span),
    /// Belongs to the next element.
    Pragma(Vec<Attribute>, Span),
    Element(Node<'a>),
    /// Could not be parsed; reported.
    Error,
}

/// `wire#w1`
#[derive(Clone, Copy, Debug)]
pub struct Wire<'a> {
    pub name: &'a str,
    pub span: Span,
}

/// An element or call.
#[derive(Debug)]
pub struct Node<'a> {
    pub target: Span,
    /// The settings after its name (V20).
    pub inline: Option<Vec<Attribute>>,
    pub arguments: Vec<Argument<'a>>,
}

/// An argument; empty ones have neither a pin nor a value.
#[derive(Debug)]
pub struct Argument<'a> {
    pub pin: Pin,
    pub value: Option<Value<'a>>,
    pub span: Span,
}

/// Which pin an argument names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pin {
    /// None: by position.
    Unnamed,
    /// `name :=`
    Input(Span),
    /// `name =>`
    Output(Span),
    /// `GE #limit => label` of SWITCH: the value is the limit, the label is here.
    Case(Comparison, Span),
    /// Could not be parsed; reported.
    Error,
}

/// What is connected to a pin.
#[derive(Debug)]
pub struct Value<'a> {
    pub negated: bool,
    pub kind: ValueKind<'a>,
}

#[derive(Debug)]
pub enum ValueKind<'a> {
    Wire(Wire<'a>),
    Operand(Span),
}
