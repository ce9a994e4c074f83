//! Pragmas, `//@ ...`, and the conditions of assertions among them. Other languages have operands of their own in the same form.

use plcc_diag::Span;

use super::Operand;
use crate::literal::Literal;

/// A comment line `//@ ...`, as text; its meaning is found where names are known.
#[derive(Clone, Debug, PartialEq)]
pub struct Pragma {
    /// Without `//@` and outer blanks.
    pub text: String,
    /// Of the whole pragma, `//@` included.
    pub span: Span,
    /// For `assert`: its condition, with sides parsed by the grammar of operands.
    pub assert: Option<Box<Assertion>>,
}

/// Comparisons and how they are joined, with operands `S`.
#[derive(Clone, Debug, PartialEq)]
pub struct Assertion<S = AssertSide> {
    pub condition: Condition,
    /// In the order of the text.
    pub comparisons: Vec<Comparison<S>>,
}

/// How comparisons are joined.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// The comparison with this number.
    Compare(u32),
    Not(Box<Condition>),
    All(Vec<Condition>),
    Any(Vec<Condition>),
}

/// `LHS OP RHS`.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison<S> {
    pub left: Side<S>,
    pub op: AssertOp,
    pub right: Side<S>,
    pub span: Span,
}

/// A side of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Side<S> {
    pub value: S,
    /// `as TYPE`: the type as it is written.
    pub ty: Option<(String, Span)>,
    pub span: Span,
}

/// Comparison of an assertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssertOp {
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

impl AssertOp {
    /// As it is written.
    pub const fn sign(self) -> &'static str {
        match self {
            AssertOp::Eq => "==",
            AssertOp::Ne => "<>",
            AssertOp::Lt => "<",
            AssertOp::Le => "<=",
            AssertOp::Gt => ">",
            AssertOp::Ge => ">=",
        }
    }

    /// Neither `==` nor `<>`.
    pub const fn is_order(self) -> bool {
        !matches!(self, AssertOp::Eq | AssertOp::Ne)
    }
}

/// A side of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum AssertSide {
    Operand(Operand),
    /// `T1.VALUE`: the value of a timer or counter.
    CellValue(Operand),
    Register(AssertRegister),
    Literal(AssertLiteral),
}

/// A constant; the other side decides its type.
#[derive(Clone, Debug, PartialEq)]
pub struct AssertLiteral {
    /// As `L` loads it, if STL has this constant.
    pub loaded: Option<Literal>,
    /// As SCL reads it, without sign; none for constants that only STL has, such as `B#(1,8)`.
    pub exact: Option<crate::scl::ast::Literal>,
    pub negative: bool,
}

/// CPU registers that an assertion can check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssertRegister {
    /// ACCU1..ACCU4 as 1..=4.
    Accu(u8),
    Ar1,
    Ar2,
    Stw,
    Br,
    Cc1,
    Cc0,
    Ov,
    Os,
    Or,
    Sta,
    Rlo,
    Fc,
    DbNumber,
    DiNumber,
}
