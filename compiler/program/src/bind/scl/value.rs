//! What an expression is before its context decides on its type.

use plcc_diag::Span;
use plcc_syntax::ast::{BlockPrefix, CellKind};

use plcc_binding::constant::Constant;
use plcc_model::Number;
use plcc_model::scl::{Access, Complex, Expr};
use plcc_model::types::DataType;

/// A bound expression.
#[derive(Clone, Debug)]
pub enum Value {
    /// Of an elementary type; it may still be converted.
    Elementary(Expr),
    /// A constant. An untyped one takes its type from its partner.
    Constant(Constant, Span),
    /// STRING, ARRAY, STRUCT, DATE_AND_TIME and other complex types.
    Complex { value: Complex, ty: DataType, span: Span },
    /// A variable of a type that only parameters have: POINTER, ANY, ARRAY[*].
    Parameter { access: Access, span: Span },
    /// A timer or counter, or a formal parameter that is one.
    Cell { kind: CellKind, number: Number, span: Span },
    /// A block, or a formal parameter of type BLOCK_x.
    Block { prefix: BlockPrefix, number: Number, span: Span },
    /// A call without a value, as a statement.
    Nothing(Box<plcc_model::scl::Call>),
    /// A function of the language that is a statement by itself, with its place: POKE, MOVE_BLK.
    Statements(Vec<plcc_model::scl::Statement>, Span),
}

impl Value {
    pub fn span(&self) -> Span {
        match self {
            Value::Elementary(expr) => expr.span,
            Value::Constant(_, span)
            | Value::Complex { span, .. }
            | Value::Parameter { span, .. }
            | Value::Cell { span, .. }
            | Value::Block { span, .. } => *span,
            Value::Nothing(call) => call.span,
            Value::Statements(_, span) => *span,
        }
    }
}
