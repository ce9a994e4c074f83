//! Syntax tree of SCL statements and expressions. Frames and declarations are those of [`crate::ast`].
//!
//! Names are kept as written; nothing is looked up here.

use plcc_diag::Span;

use crate::ast::{OperandKind, Pragma, Width};
use crate::elementary::Elementary;

/// The form of SCL that a file shows. It selects defaults only; there is one grammar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Dialect {
    /// No feature of either form.
    #[default]
    Either,
    /// S7-SCL of STEP 7 V5.
    Classic,
    /// SCL of the TIA Portal. A file with features of both forms counts as this one.
    Tia,
}

/// Statements of a block.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Body {
    pub dialect: Dialect,
    /// Names of the LABEL section.
    pub labels: Vec<Name>,
    pub statements: Vec<Statement>,
}

/// A name and how it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// Without `#` and quotes, outer blanks removed.
    pub text: String,
    pub form: NameForm,
    pub span: Span,
}

/// How a name was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NameForm {
    /// `level`: local if declared, else global.
    Bare,
    /// `#level`, `#"level"`: local.
    Local,
    /// `"level"`: global; in classic sources also local.
    Quoted,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    pub kind: StatementKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // FOR, whose expressions would only be found one step further.
pub enum StatementKind {
    /// `;`
    Empty,
    /// `name:` before a statement.
    Label(Name),
    /// A call, or an expression whose value is not used.
    Expression(Expr),
    /// `a := b += e`: targets from left to right, each with the operator after it.
    Assign {
        targets: Vec<(Expr, AssignOp)>,
        value: Expr,
    },
    If {
        /// IF and each ELSIF.
        branches: Vec<(Expr, Vec<Statement>)>,
        otherwise: Vec<Statement>,
    },
    Case {
        selector: Expr,
        arms: Vec<Arm>,
        otherwise: Vec<Statement>,
    },
    For {
        variable: Expr,
        start: Expr,
        end: Expr,
        step: Option<Expr>,
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
    /// `RETURN`, `RETURN e` (sets ENO).
    Return(Option<Expr>),
    Goto(Name),
    Pragma(Pragma),
    /// Could not be parsed; reported.
    Error,
}

impl StatementKind {
    /// The lists of statements inside, in the order of the source.
    pub fn bodies(&self) -> Vec<&[Statement]> {
        match self {
            StatementKind::If { branches, otherwise } => {
                branches.iter().map(|(_, body)| body.as_slice()).chain([otherwise.as_slice()]).collect()
            }
            StatementKind::Case { arms, otherwise, .. } => {
                arms.iter().map(|arm| arm.body.as_slice()).chain([otherwise.as_slice()]).collect()
            }
            StatementKind::For { body, .. }
            | StatementKind::While { body, .. }
            | StatementKind::Repeat { body, .. } => {
                vec![body]
            }
            StatementKind::Empty
            | StatementKind::Label(_)
            | StatementKind::Expression(_)
            | StatementKind::Assign { .. }
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return(_)
            | StatementKind::Goto(_)
            | StatementKind::Pragma(_)
            | StatementKind::Error => Vec::new(),
        }
    }
}

/// Operators of assignments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AssignOp {
    /// `:=`
    Set,
    /// `+=`
    Add,
    /// `-=`
    Subtract,
    /// `*=`
    Multiply,
    /// `/=`
    Divide,
    /// `?=`
    Attempt,
}

impl AssignOp {
    /// As SCL writes it.
    pub const fn sign(self) -> &'static str {
        match self {
            AssignOp::Set => ":=",
            AssignOp::Add => "+=",
            AssignOp::Subtract => "-=",
            AssignOp::Multiply => "*=",
            AssignOp::Divide => "/=",
            AssignOp::Attempt => "?=",
        }
    }
}

/// An arm of CASE.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    pub values: Vec<CaseValue>,
    pub body: Vec<Statement>,
    pub span: Span,
}

/// `3` or `3..5`.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseValue {
    pub low: Expr,
    pub high: Option<Expr>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    Literal(Literal),
    Name(Name),
    /// An operand in one token: `I0.0`, `%MW10`, `%IW4:P`, `%DB1.DBX1.0`, `%T5`. Bare `MW10`, `T5`, `DB10` are names: see
    /// [`absolute`](super::absolute).
    Absolute(OperandKind),
    /// `base.name`. Of classic `DB10.DW4` the member is the name `DW4`: see [`db_address`](super::db_address).
    Member {
        base: Box<Expr>,
        name: Name,
    },
    /// `"Db".%DBX0.0`, `DB10.DX0.0`, `blk.DD10`: an address in the data block `base`, in one token.
    MemberAbsolute {
        base: Box<Expr>,
        width: Width,
        byte: u32,
        bit: u8,
    },
    /// `.%X3`, `.%B1`, `.%W0`, `.%D0`: part `index` of that width, counted from the least significant end.
    Slice {
        base: Box<Expr>,
        width: Width,
        index: u32,
    },
    Index {
        base: Box<Expr>,
        indices: Vec<Expr>,
    },
    Call {
        callee: Box<Expr>,
        arguments: Vec<Argument>,
    },
    /// `r^`
    Dereference(Box<Expr>),
    /// `REF(x)`
    Reference(Box<Expr>),
    Unary {
        op: UnaryOp,
        operand: Box<Expr>,
    },
    Binary {
        op: BinaryOp,
        left: Box<Expr>,
        right: Box<Expr>,
        op_span: Span,
    },
    /// Could not be parsed; reported.
    Error,
}

/// An argument of a call.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// The formal; none for a positional argument.
    pub name: Option<Name>,
    /// `=>` is between formal and actual.
    pub output: bool,
    /// None: left empty.
    pub value: Option<Expr>,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnaryOp {
    Plus,
    Minus,
    Not,
}

/// Binary operators, in the order of their precedence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BinaryOp {
    Power,
    Multiply,
    Divide,
    /// `DIV`
    DivideInteger,
    Modulo,
    Add,
    Subtract,
    Less,
    Greater,
    LessEqual,
    GreaterEqual,
    Equal,
    NotEqual,
    And,
    Xor,
    Or,
}

/// How tightly NOT and signs bind, as [`BinaryOp::precedence`].
pub const UNARY: u8 = 8;

impl BinaryOp {
    /// How tightly it binds: less than [`UNARY`], except a power.
    pub const fn precedence(self) -> u8 {
        match self {
            BinaryOp::Or => 1,
            BinaryOp::Xor => 2,
            BinaryOp::And => 3,
            BinaryOp::Equal | BinaryOp::NotEqual => 4,
            BinaryOp::Less | BinaryOp::Greater | BinaryOp::LessEqual | BinaryOp::GreaterEqual => 5,
            BinaryOp::Add | BinaryOp::Subtract => 6,
            BinaryOp::Multiply | BinaryOp::Divide | BinaryOp::DivideInteger | BinaryOp::Modulo => 7,
            BinaryOp::Power => 9,
        }
    }

    /// As SCL writes it.
    pub const fn sign(self) -> &'static str {
        match self {
            BinaryOp::Power => "**",
            BinaryOp::Multiply => "*",
            BinaryOp::Divide => "/",
            BinaryOp::DivideInteger => "DIV",
            BinaryOp::Modulo => "MOD",
            BinaryOp::Add => "+",
            BinaryOp::Subtract => "-",
            BinaryOp::Less => "<",
            BinaryOp::Greater => ">",
            BinaryOp::LessEqual => "<=",
            BinaryOp::GreaterEqual => ">=",
            BinaryOp::Equal => "=",
            BinaryOp::NotEqual => "<>",
            BinaryOp::And => "AND",
            BinaryOp::Xor => "XOR",
            BinaryOp::Or => "OR",
        }
    }
}

/// A constant. Signs are operators and not part of it, except after a type prefix.
#[derive(Clone, Debug, PartialEq)]
pub enum Literal {
    /// `15`, `16#FF`: an integer without a type; `based` if it was written with a base.
    Integer { value: u64, based: bool },
    /// `1.5`, without a type.
    Real(f64),
    /// `TRUE`, `INT#-5`, `T#1s`, `CHAR#'A'`, `C#20` (a WORD): the value's bits, zero-extended from the width of the type.
    Typed { ty: Elementary, bits: u64 },
    /// `'text'`, `STRING#'text'` (`typed`), in Windows-1252. One character may be a CHAR.
    Text { bytes: Vec<u8>, typed: bool },
    /// `WSTRING#'text'`, in UTF-16.
    WideText(Vec<u16>),
    /// `DT#…`: eight BCD bytes.
    DateAndTime([u8; 8]),
    /// `DTL#…`: the twelve bytes of the structure.
    Dtl([u8; 12]),
    /// `P#M10.0`, `P#DB5.DBX0.0`: DB number, 0 for none, and area pointer.
    Pointer { db: u16, pointer: u32 },
    /// `P#DB5.DBX0.0 BYTE 12`: the ten bytes of an ANY.
    Any([u8; 10]),
    /// ANY that points nowhere.
    Nil,
    /// Reference that points nowhere.
    Null,
}
