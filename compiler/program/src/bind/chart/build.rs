//! Small pieces of the typed tree.

use plcc_diag::Span;
use plcc_syntax::Elementary;

use crate::bind::declarations::path::Variable;
use crate::bind::scl::expression::constant_expr;
use crate::bind::scl::place::Spot;
use plcc_model::layout;
use plcc_model::scl::{Access, Expr, ExprKind, Index, IndexBounds, Statement, StatementKind};
use plcc_model::types::DataType;

/// The value of an elementary variable.
pub fn load(variable: &Variable, span: Span) -> Expr {
    let DataType::Elementary(ty) = variable.ty else { unreachable!("the engine only reads elementary variables") };
    let access = Spot::fixed(variable.clone()).access(span);
    Expr { kind: ExprKind::Load(Box::new(access)), ty, span }
}

/// `variable := value`, of one type.
pub fn assign(variable: &Variable, value: Expr, span: Span) -> Statement {
    let target = Spot::fixed(variable.clone()).access(span);
    Statement { kind: StatementKind::Assign { target, value }, span }
}

/// A constant.
pub fn number(value: u64, ty: Elementary, span: Span) -> Expr {
    constant_expr(value, ty, span)
}

/// `IF condition THEN … ELSE … END_IF`
pub fn if_then(condition: Expr, then: Vec<Statement>, otherwise: Vec<Statement>, span: Span) -> Statement {
    Statement { kind: StatementKind::If { branches: vec![(condition, then)], otherwise }, span }
}

/// An element of an array at a DINT.
pub fn element(array: &Variable, index: Expr, span: Span) -> Access {
    at_index(array, 0, None, index, span)
}

/// An elementary value at a byte of an element of an array, at a DINT.
pub fn part_of_element(array: &Variable, byte: u32, ty: Elementary, index: Expr, span: Span) -> Access {
    at_index(array, byte, Some(DataType::Elementary(ty)), index, span)
}

fn at_index(array: &Variable, byte: u32, part: Option<DataType>, value: Expr, span: Span) -> Access {
    let DataType::Array(ty) = &array.ty else { unreachable!("lists of the engine are arrays") };
    let (low, high) = ty.bounds[0];
    let index = Index { value, bounds: IndexBounds::Known(low, high), stride: layout::distance(ty, 0) };
    let part = part.unwrap_or_else(|| ty.element.clone());
    let mut spot = Spot::fixed(Variable { ty: part, byte: array.byte + byte, ..array.clone() });
    spot.indices.push(index);
    spot.access(span)
}
