//! Conditions of comparisons.

use plcc_ir::{FloatCc, FunctionBuilder, IntCc, Value};
use plcc_model::scl::CompareOp;

/// The condition for integers and bit strings.
pub const fn integer_condition(op: CompareOp, signed: bool) -> IntCc {
    match (op, signed) {
        (CompareOp::Equal, _) => IntCc::Eq,
        (CompareOp::NotEqual, _) => IntCc::Ne,
        (CompareOp::Less, true) => IntCc::Slt,
        (CompareOp::Less, false) => IntCc::Ult,
        (CompareOp::LessEqual, true) => IntCc::Sle,
        (CompareOp::LessEqual, false) => IntCc::Ule,
        (CompareOp::Greater, true) => IntCc::Sgt,
        (CompareOp::Greater, false) => IntCc::Ugt,
        (CompareOp::GreaterEqual, true) => IntCc::Sge,
        (CompareOp::GreaterEqual, false) => IntCc::Uge,
    }
}

/// The condition for floats; see [`floats`].
pub const fn float_condition(op: CompareOp) -> FloatCc {
    match op {
        CompareOp::Equal => FloatCc::Eq,
        CompareOp::NotEqual => FloatCc::Ne,
        CompareOp::Less => FloatCc::Lt,
        CompareOp::LessEqual => FloatCc::Le,
        CompareOp::Greater => FloatCc::Gt,
        CompareOp::GreaterEqual => FloatCc::Ge,
    }
}

/// i1: the comparison holds; with a NaN it does not, even `<>`.
pub fn floats(b: &mut FunctionBuilder, cc: FloatCc, x: Value, y: Value) -> Value {
    if cc == FloatCc::Ne {
        let (less, greater) = (b.fcmp(FloatCc::Lt, x, y), b.fcmp(FloatCc::Gt, x, y));
        return b.or(less, greater);
    }
    b.fcmp(cc, x, y)
}
