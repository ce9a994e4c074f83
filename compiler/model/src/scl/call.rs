//! Calls: blocks with what they pass, timers and counters.

use plcc_diag::Span;

use super::{Access, Complex, Conversion, Expr};
use crate::{BlockKey, Number, Pointed};

/// A call of a block.
#[derive(Clone, Debug)]
pub struct Call {
    pub target: BlockKey,
    pub instance: Option<Instance>,
    /// In source order, each parameter at most once. RET_VAL is one of them, the last, only in a statement that assigns what a
    /// function of the library writes into its target itself.
    pub arguments: Vec<Argument>,
    /// `EN := e`: FALSE skips the arguments and the call; the value is 0.
    pub enable: Option<Expr>,
    /// `ENO => x`: a BOOL variable.
    pub eno: Option<Access>,
    /// An operator or a conversion that a block of the library carries out. In S7-SCL its error clears OK, and it is not the
    /// call that ENO is about.
    pub is_operation: bool,
    pub span: Span,
}

/// Instance memory of an FB call.
#[derive(Clone, Debug)]
pub enum Instance {
    Db(u16),
    /// A static variable, an element of an array of instances, an instance in a global DB, an IN_OUT of an FB type.
    Variable(Access),
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
#[derive(Clone, Debug)]
pub enum Actual {
    /// IN, elementary: a value of the formal's type.
    Value(Expr),
    /// OUT or IN_OUT, elementary. The variable may have a different type than the formal: then `back` converts the output; an IN_OUT
    /// has the formal's type (or width). Slices are copied in and back.
    Variable { access: Access, back: Option<Conversion> },
    /// IN, complex. A text may be longer or shorter than the formal; the rest has the formal's layout.
    Complex(Complex),
    /// OUT or IN_OUT, complex; also ARRAY[*].
    Reference(Access),
    /// TIMER, COUNTER, BLOCK_x.
    Number(Number),
    /// POINTER, ANY: the bytes are known.
    PointerBytes(Vec<u8>),
    /// POINTER, ANY: points at the variable. For an ANY, `type_code` and `count` are its bytes 1 to 3; of an ARRAY[*], `count` is that of
    /// one element.
    PointerTo { access: Access, type_code: u8, count: u16 },
    /// POINTER, ANY: the structure is at the place.
    PointerCopy(Access),
    /// ANY formal that receives a value: it is in the frame.
    PointerToValue { value: Expr, type_code: u8 },
    /// ANY formal that receives a constant or a result: it is in the frame.
    PointerToComplex { value: Complex, type_code: u8, count: u16 },
    /// VARIANT: an ANY, and what it points at.
    Variant(Box<Actual>, Pointed),
    /// OUT with an unused result (`o => `).
    Dropped,
}

impl Actual {
    /// The elementary value that is passed, itself or by a pointer to its copy.
    pub fn value(&self) -> Option<&Expr> {
        match self {
            Actual::Value(value) | Actual::PointerToValue { value, .. } => Some(value),
            _ => None,
        }
    }

    /// The structure, array or text whose value is passed, itself or by a pointer to its copy.
    pub fn complex(&self) -> Option<&Complex> {
        match self {
            Actual::Complex(value) | Actual::PointerToComplex { value, .. } => Some(value),
            _ => None,
        }
    }

    /// The ANY of a VARIANT; otherwise the actual itself.
    pub fn pointer(&self) -> &Actual {
        match self {
            Actual::Variant(any, _) => any,
            other => other,
        }
    }
}

/// The five timer functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TimerKind {
    Pulse,
    ExtendedPulse,
    OnDelay,
    RetentiveOnDelay,
    OffDelay,
}

/// A call of a timer function; a parameter that is not supplied is `None`.
#[derive(Clone, Debug)]
pub struct TimerCall {
    pub kind: TimerKind,
    pub timer: Number,
    /// BOOL.
    pub start: Option<Expr>,
    /// S5TIME or WORD: time base and BCD value.
    pub value: Option<Expr>,
    /// BOOL.
    pub reset: Option<Expr>,
    /// BOOL: the status.
    pub q: Option<Access>,
    /// WORD: the time left, binary.
    pub bi: Option<Access>,
}

/// A call of a counter function; a parameter that is not supplied is `None`.
#[derive(Clone, Debug)]
pub struct CounterCall {
    pub counter: Number,
    /// CU, CD, S and R take effect in this order; each is a BOOL.
    pub up: Option<Expr>,
    pub down: Option<Expr>,
    pub set: Option<Expr>,
    /// WORD in BCD.
    pub value: Option<Expr>,
    pub reset: Option<Expr>,
    /// BOOL: the count is not 0.
    pub q: Option<Access>,
    /// WORD: the count, binary.
    pub cv: Option<Access>,
}
