//! Bound SCL: a typed tree. Every name and address is settled, every expression has its final type, and implicit conversions are
//! separate nodes.

pub mod walk;

use plcc_diag::Span;
use plcc_syntax::Elementary;

use super::{Assert, BlockKey, LabelId, Number, Place, PlaceArea, Pointed, Width};
use crate::types::DataType;

/// Code of a block in SCL.
#[derive(Clone, Debug, Default)]
pub struct SclBody {
    pub statements: Vec<Statement>,
    /// Overflows, failed conversions and similar errors clear the block's OK/ENO bit; otherwise only assignments change it.
    pub sets_flag: bool,
    /// A call ANDs the callee's ENO into the bit, if `sets_flag` (TIA); otherwise it does not change the bit (classic).
    pub calls_set_flag: bool,
    /// STRING and WSTRING variables in VAR_TEMP, also inside of structures and arrays: their headers are set when the block begins.
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
    /// In the frame.
    pub byte: u32,
    /// In characters.
    pub maximum: u16,
    pub wide: bool,
}

#[derive(Clone, Debug)]
pub struct Statement {
    pub kind: StatementKind,
    /// The text for messages at run time and debuggers: for compound statements the first line.
    pub span: Span,
}

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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnaryOp {
    /// Integers and TIME wrap, floats change sign.
    Negate,
    /// All bits of the type.
    Not,
    /// The smallest integer stays; floats lose their sign.
    Abs,
}

/// Integers wrap; a division by 0 yields 0. The SCL reference, operators, lists what clears the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BinaryOp {
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    /// REAL or LREAL.
    Power,
    And,
    Or,
    Xor,
    ShiftLeft,
    /// Fills with the sign if the type is signed.
    ShiftRight,
    RotateLeft,
    RotateRight,
    /// Like Add and Subtract, for a TIME_OF_DAY and milliseconds: modulo 24 hours, which clears the bit. The same for LTOD in nanoseconds.
    AddDay,
    SubtractDay,
    /// The smaller or the greater; NaN yields NaN.
    Min,
    Max,
}

/// Floats: every comparison with NaN is FALSE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CompareOp {
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

impl CompareOp {
    /// The comparison with its sides exchanged.
    pub const fn turned(self) -> CompareOp {
        match self {
            CompareOp::Equal => CompareOp::Equal,
            CompareOp::NotEqual => CompareOp::NotEqual,
            CompareOp::Less => CompareOp::Greater,
            CompareOp::LessEqual => CompareOp::GreaterEqual,
            CompareOp::Greater => CompareOp::Less,
            CompareOp::GreaterEqual => CompareOp::LessEqual,
        }
    }
}

/// How a value is converted to another type. The SCL reference, explicit conversions, lists what clears the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Conversion {
    /// By value: integer to integer (low bits), integer to float, float to float, float to integer (to nearest, ties to even), TIME to
    /// integer and back. Float to integer out of range: see [`Overflow`].
    Value(Overflow),
    /// Like `Value` from a float, towards zero, up, down.
    Truncate(Overflow),
    Ceil(Overflow),
    Floor(Overflow),
    /// The bits: zero-extended from a bit string, sign-extended from a signed integer, truncated to the target. `checked`: lost bits clear the
    /// bit.
    Bits {
        checked: bool,
    },
    /// Anything to BOOL: bit 0; other bits that are 1 clear the bit.
    ToBool,
    /// WORD or DWORD in BCD to INT or DINT; a bad digit is OB 121 16#21 if `fault`, otherwise 0 and the bit cleared.
    FromBcd {
        fault: bool,
    },
    /// INT or DINT to BCD; out of range leaves the pattern and clears the bit.
    ToBcd,
    /// S5TIME to TIME.
    FromS5Time,
    /// TIME to S5TIME: truncated to the time base; out of range clears the bit.
    ToS5Time,
    /// TIME to LTIME, TIME_OF_DAY to LTOD and back: milliseconds and nanoseconds.
    MillisToNanos,
    NanosToMillis,
    /// The pattern stays; out of 0..=`max` clears the bit (DATE, TIME_OF_DAY, LTOD, LDT).
    Ranged {
        max: i64,
    },
}

/// Result of a float to integer conversion that is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Overflow {
    /// S7-300/400: the REAL's own bit pattern, low bits.
    Pattern,
    /// S7-1200/1500: low bits of the rounded value; NaN and infinity 0.
    LowBits,
}

/// Functions that are computed in place. Arguments have the types of their signatures; results the type of the expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Function {
    Sqr,
    Sqrt,
    Exp,
    /// 10 to the x.
    Expd,
    Ln,
    /// To base 10.
    Log,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    /// x minus its integral part.
    Frac,
    /// `(MN, IN, MX)`; MN > MX: IN, and the bit cleared.
    Limit,
    /// `(G, IN0, IN1)`
    Select,
    /// `(K, IN0, …, INn)`; no input for K: the last argument if `has_else`, otherwise 0; both clear the bit.
    Mux {
        has_else: bool,
    },
    /// Bytes in reverse order.
    Swap,
    /// `(MIN, VALUE, MAX)`; the result is a float.
    NormX,
    /// `(MIN, VALUE, MAX)`; VALUE is a float, the rest of the type of the result.
    ScaleX,
    /// Number of the lowest 1; 0 and the bit cleared if there is none.
    Encode,
    /// 1 shifted left by the argument modulo the width.
    Decode,
    /// Number of bits that are 1: an INT.
    BitSum,
    /// Valid float: neither NaN nor infinite; a BOOL.
    IsValid,
}

/// A place in memory that code reads, writes or passes.
#[derive(Clone, Debug)]
pub struct Access {
    pub base: Base,
    /// Run-time indices, in source order. Their distances from the lowest elements add to the base.
    pub indices: Vec<Index>,
    /// The type there, before `part`.
    pub ty: DataType,
    /// A slice `.%X3` of it.
    pub part: Option<Part>,
    pub span: Span,
}

/// Where an access begins.
#[derive(Clone, Debug)]
pub enum Base {
    /// Never an open DB, never register-indirect.
    Place(Place),
    /// `MW[i]`, `M[b, i]`, `DB10.DW[i]`, PEEK, POKE.
    Indexed {
        area: IndexedArea,
        /// DINT: the byte address.
        byte: Box<Expr>,
        /// INT or DINT: bit number; others than 0..=7 are an error of OB 121. Only for a BOOL.
        bit: Option<Box<Expr>>,
    },
}

#[derive(Clone, Debug)]
pub enum IndexedArea {
    /// I, Q, M, PI, PQ.
    Memory(PlaceArea),
    Db(u16),
    /// WORD: the number of the DB, known at run time.
    DynamicDb(Box<Expr>),
    /// BYTE: the area in the code of PEEK (16#81 I, 16#82 Q, 16#83 M, 16#84 DB, 1 PI, 2 PQ), and WORD: the number of the DB.
    Coded {
        area: Box<Expr>,
        db: Box<Expr>,
    },
}

/// A run-time index of one dimension.
#[derive(Clone, Debug)]
pub struct Index {
    /// DINT.
    pub value: Expr,
    pub bounds: IndexBounds,
    /// Distance of adjacent elements, in bits.
    pub stride: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndexBounds {
    /// Inclusive.
    Known(i32, i32),
    /// A bound of the ARRAY[*] formal `parameter`, in its dimension. Distances of all but the last dimension are multiplied by the lengths of
    /// the later ones; `stride` is that of an element.
    Open { parameter: usize, dimension: u8 },
    /// Characters of a text, from 1 on. One that the text does not have reads 0 and is not written, without a fault. `length`: how many the
    /// declaration has; `in_head`: the head of the text, before its first character, may say fewer, as that of a formal.
    Characters { length: i32, in_head: bool },
}

impl IndexBounds {
    /// Inclusive; `None`: they are only known when the program runs.
    pub const fn known(self) -> Option<(i32, i32)> {
        match self {
            IndexBounds::Known(low, high) => Some((low, high)),
            IndexBounds::Open { .. } => None,
            IndexBounds::Characters { length, .. } => Some((1, length)),
        }
    }
}

/// A part of a bit string or integer, by value: 0 is the lowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    pub width: Width,
    pub index: u8,
}

impl Access {
    /// The elementary type that is read or written, including the slice: BOOL, BYTE, WORD, DWORD for slices. None if it is complex.
    pub fn elementary(&self) -> Option<Elementary> {
        match self.part {
            Some(part) => Some(match part.width {
                Width::Bit => Elementary::Bool,
                Width::Byte => Elementary::Byte,
                Width::Word => Elementary::Word,
                Width::Dword => Elementary::Dword,
                Width::Lword => Elementary::Lword,
            }),
            None => match self.ty {
                DataType::Elementary(ty) => Some(ty),
                _ => None,
            },
        }
    }
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
    /// OUT or IN_OUT, complex. also ARRAY[*].
    Reference(Access),
    /// TIMER, COUNTER, BLOCK_x.
    Number(Number),
    /// POINTER, ANY: the bytes are known.
    PointerBytes(Vec<u8>),
    /// POINTER, ANY: points at the variable; for an ANY, with bytes 1 to 3. Of an ARRAY[*], `count` is that of one element.
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

#[derive(Clone, Debug)]
pub struct CounterCall {
    pub counter: Number,
    /// Each a BOOL; CU, then CD, then S, then R.
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
