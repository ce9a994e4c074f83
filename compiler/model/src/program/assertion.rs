//! Assertions of tests.

use plcc_abi::image::{AssertCondition, AssertConstant, AssertKind, AssertOp, AssertType};
use plcc_syntax::ast::{AssertRegister, CellKind};

use super::{Number, Operand, Place};

/// An assertion pragma, with sides `S`.
#[derive(Clone, Debug)]
pub struct Assert<S = AssertSide> {
    pub condition: AssertCondition,
    /// At least one.
    pub comparisons: Vec<Comparison<S>>,
    /// One comparison of two different constants.
    pub trap: bool,
    /// The source line, trimmed.
    pub text: String,
}

/// A comparison with settled types.
#[derive(Clone, Debug)]
pub struct Comparison<S> {
    pub op: AssertOp,
    pub kind: AssertKind,
    pub left: Compared<S>,
    pub right: Compared<S>,
}

/// A side of a comparison with the type that it has there.
#[derive(Clone, Debug)]
pub struct Compared<S> {
    pub ty: AssertType,
    pub value: ComparedValue<S>,
}

/// Where the value of a side comes from.
#[derive(Clone, Debug)]
pub enum ComparedValue<S> {
    Constant(AssertConstant),
    Code(S),
}

impl<S> Assert<S> {
    /// The values that code supplies for the sides, in source order.
    pub fn sides(&self) -> impl Iterator<Item = &S> {
        self.comparisons.iter().flat_map(|comparison| [&comparison.left, &comparison.right]).filter_map(|side| {
            match &side.value {
                ComparedValue::Code(side) => Some(side),
                ComparedValue::Constant(_) => None,
            }
        })
    }
}

/// What code supplies for a side.
#[derive(Clone, Debug)]
pub enum AssertSide {
    /// Value zero-extended.
    Operand(Operand),
    /// Time left of a timer, an S5TIME, or count of a counter, an INT.
    CellValue {
        kind: CellKind,
        number: Number,
    },
    /// A text or a DTL: where it is.
    Memory(Place),
    Register(AssertRegister),
}
