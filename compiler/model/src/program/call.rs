//! Calls of blocks, and what they pass.

use plcc_diag::Span;

use super::{BlockKey, ElementIndex, Number, Place};

/// A call with parameters.
#[derive(Clone, Debug)]
pub struct Call {
    pub target: BlockKey,
    pub instance: Option<Instance>,
    /// One for each parameter that is supplied, in the order of the interface.
    pub arguments: Vec<Argument>,
}

/// Instance memory of an FB call.
#[derive(Clone, Debug, PartialEq)]
pub enum Instance {
    /// `CALL FB 1, DB 1`.
    Db(u16),
    /// `CALL #mi`: at `byte` of this FB's instance.
    Multi { byte: u32 },
    /// `CALL "Data".timer`: at `byte` of a data block with other data.
    Inner { db: u16, byte: u32 },
}

/// An actual parameter.
#[derive(Clone, Debug)]
pub struct Argument {
    /// Index into the parameters of the callee.
    pub parameter: usize,
    pub actual: Actual,
    pub span: Span,
}

/// The passed value.
#[derive(Clone, Debug, PartialEq)]
pub enum Actual {
    /// A constant: its bytes as in memory; a BOOL is one byte, 0 or 1.
    Const(Vec<u8>),
    /// A variable of the width (elementary) or size (complex) of the formal.
    Place(Place),
    /// TIMER, COUNTER, BLOCK_x.
    Number(Number),
    /// POINTER and ANY formals: the bytes are known.
    PointerBytes(Vec<u8>),
    /// POINTER and ANY formals: points at `place`. For an ANY, `type_code` and `count` are its bytes 1 to 3.
    PointerTo { place: Place, type_code: u8, count: u16 },
    /// POINTER and ANY formals: the structure itself is at `place` (a TEMP variable of type ANY, a formal of the same type).
    PointerCopy(Place),
    /// VARIANT formals: an ANY, and what it points at.
    Variant(Box<Actual>, Pointed),
}

impl Actual {
    /// The ANY of a VARIANT; otherwise the actual itself.
    pub fn pointer(&self) -> &Actual {
        match self {
            Actual::Variant(any, _) => any,
            other => other,
        }
    }

    /// The variable indices of what is passed or pointed at.
    pub fn indices(&self) -> &[ElementIndex] {
        match self.pointer() {
            Actual::Place(place) | Actual::PointerTo { place, .. } | Actual::PointerCopy(place) => place.indices(),
            Actual::Const(_) | Actual::Number(_) | Actual::PointerBytes(_) | Actual::Variant(..) => &[],
        }
    }
}

/// The contents of a VARIANT after its ANY.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pointed {
    /// Number of elements, 0 if it is not an array; [`crate::layout::type_number`] of them.
    Known { elements: u32, ty: u32 },
    /// As many elements as the ARRAY[*] that the ANY points at; [`crate::layout::type_number`] of them.
    Counted { ty: u32 },
    /// The contents of the VARIANT that the ANY is a copy of.
    Copied,
}
