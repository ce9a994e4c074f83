//! Bound SCL: a typed tree. Every name and address is settled, every expression has its final type, and implicit conversions are
//! separate nodes.
//!
//! "The bit" is OK of the block, which the TIA Portal calls ENO.
//!
//! - Here: statements, expressions, and values that are not elementary.
//! - `access`: places in memory; `operator`: operators, conversions and functions; `call`: calls. [`walk`] walks over the tree.

mod access;
mod call;
mod operator;
pub mod walk;

use plcc_diag::Span;
use plcc_syntax::Elementary;

use super::{Assert, LabelId, Number};

pub use access::{Access, Base, Index, IndexBounds, IndexedArea, Part};
pub use call::{Actual, Argument, Call, CounterCall, Instance, TimerCall, TimerKind};
pub use operator::{BinaryOp, CompareOp, Conversion, Function, Overflow, UnaryOp};

/// Code of a block in SCL.
#[derive(Clone, Debug, Default)]
pub struct SclBody {
    pub statements: Vec<Statement>,
    /// Overflows, failed conversions and similar errors clear the block's OK/ENO bit; otherwise only assignments change it.
    pub sets_flag: bool,
    /// A call ANDs the callee's ENO into the bit, if `sets_flag` (TIA); otherwise it does not change the bit (classic).
    pub calls_set_flag: bool,
    /// STRING and WSTRING variables in VAR_TEMP, also inside structures and arrays: their headers are set when the block begins.
    pub temporary_texts: Vec<TemporaryText>,
    /// For a block in LAD or FBD: where its networks begin in the source, in order.
    pub networks: Vec<u32>,
    /// LAD and FBD of S7-300/400: elementary inputs of FCs are the actual parameters, as in STL. Else they are copies.
    pub inputs_in_place: bool,
    /// Data blocks whose number is a value (`#any := "Recipe"` of a DB_ANY), and where: for cross references.
    pub named_dbs: Vec<(u16, Span)>,
}

impl SclBody {
    /// Number of the network at a position, 1 for the first; 0 if the block has none.
    pub fn network_at(&self, start: u32) -> u16 {
        self.networks.partition_point(|begin| *begin <= start) as u16
    }
}

/// A text in the frame of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TemporaryText {
    /// Address in the frame.
    pub byte: u32,
    /// In characters.
    pub maximum: u16,
    pub wide: bool,
}

/// A statement.
#[derive(Clone, Debug)]
pub struct Statement {
    pub kind: StatementKind,
    /// The text for messages at run time and for debuggers; of a compound statement the first line.
    pub span: Span,
}

/// What a statement does.
#[derive(Clone, Debug)]
pub enum StatementKind {
    /// Elementary; `value` has the type of `target`.
    Assign {
        target: Access,
        value: Expr,
    },
    /// STRING or WSTRING: text longer than the target's maximum is cut, which clears the bit.
    AssignText {
        target: Access,
        value: Complex,
    },
    /// ARRAY, STRUCT, DATE_AND_TIME, as if through a buffer: the layouts are the same.
    Copy {
        target: Access,
        source: Complex,
        bytes: u32,
    },
    /// `OK := e`, `ENO := e`.
    SetFlag(Expr),
    /// An instruction that is several statements has failed: clears the bit if operations of the block do ([`SclBody::sets_flag`]).
    Failed,
    /// From here to `Watch(false)` operations clear the bit, whatever the block says: a function has `ENO => x`.
    Watch(bool),
    /// A call whose value, if any, is not used.
    Call(Box<Call>),
    /// An expression for its effects: a timer or counter function.
    Evaluate(Expr),
    If {
        branches: Vec<(Expr, Vec<Statement>)>,
        otherwise: Vec<Statement>,
    },
    Case {
        /// Integer, bit string or character.
        selector: Expr,
        /// The first arm that contains the value runs.
        arms: Vec<Arm>,
        otherwise: Vec<Statement>,
    },
    For {
        /// Integer; evaluated once.
        variable: Access,
        /// All have the type of the variable.
        start: Expr,
        end: Expr,
        step: Expr,
        body: Vec<Statement>,
    },
    While {
        condition: Expr,
        body: Vec<Statement>,
    },
    Repeat {
        body: Vec<Statement>,
        until: Expr,
    },
    Exit,
    Continue,
    /// With a value: the bit is set to it first.
    Return(Option<Expr>),
    Goto(LabelId),
    Label(LabelId),
    Assert(Assert),
    /// `//@ sleep N`, in milliseconds.
    Sleep(u32),
    /// What follows, up to the end of the block, may be a function of its own. Only the code of charts has it.
    Apart,
    /// A statement of a network in STL.
    Stl(Box<super::StlStatement>),
}

/// An arm of CASE.
#[derive(Clone, Debug)]
pub struct Arm {
    /// Inclusive ranges of values of the selector's type: a bit string or unsigned type zero-extended, a signed one sign-extended.
    pub ranges: Vec<(i128, i128)>,
    pub body: Vec<Statement>,
}

/// A value of an elementary type.
#[derive(Clone, Debug)]
pub struct Expr {
    pub kind: ExprKind,
    pub ty: Elementary,
    pub span: Span,
}

/// How a value is computed.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// The value's bits, zero-extended from the width of the type.
    Const(u64),
    /// For a parameter of type BLOCK_DB: the number, a WORD.
    Load(Box<Access>),
    Unary {
        op: UnaryOp,
        operand: Box<Expr>,
    },
    /// Both operands have the type of the expression; for a shift or rotate the right one is an integer.
    Binary {
        op: BinaryOp,
        left: Box<Expr>,
        right: Box<Expr>,
    },
    /// Both operands have one type; the expression is a BOOL.
    Compare {
        op: CompareOp,
        left: Box<Expr>,
        right: Box<Expr>,
    },
    Convert {
        conversion: Conversion,
        operand: Box<Expr>,
    },
    /// An elementary result of an FC or system function.
    Call(Box<Call>),
    Function {
        function: Function,
        arguments: Vec<Expr>,
    },
    /// S_PULSE, S_PEXT, S_ODT, S_ODTS, S_OFFDT: an S5TIME, the time left.
    Timer(Box<TimerCall>),
    /// S_CU, S_CD, S_CUD: a WORD, the count in BCD.
    Counter(Box<CounterCall>),
    /// Status bit of a timer or counter, a BOOL.
    Cell {
        kind: super::CellKind,
        number: Number,
    },
    /// Bound of dimension `dimension` (0-based; a DINT expression, so it may be computed) of the ARRAY[*] formal `parameter`: a DINT, 0
    /// and the bit cleared if there is no such dimension.
    Bound {
        parameter: usize,
        dimension: Box<Expr>,
        upper: bool,
    },
    /// `OK`, in TIA `ENO`: this block's bit, a BOOL.
    Flag,
    /// Classic `ENO`: that of the last call in this block, TRUE before the first; a BOOL.
    LastEno,
}

/// A value that is not elementary.
#[derive(Clone, Debug)]
pub enum Complex {
    Variable(Access),
    /// Its bytes in memory; a STRING with its two length bytes.
    Const(Vec<u8>),
    /// Result of an FC: it is in the frame until the end of the statement.
    Call(Box<Call>),
    /// A CHAR or WCHAR as a text of one character.
    Character(Box<Expr>),
}
