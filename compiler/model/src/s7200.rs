//! Bound blocks of an S7-200: statements whose operands are settled.

use plcc_diag::Span;
pub use plcc_syntax::ast::Width;
pub use plcc_syntax::s7200::{Compare, CompareKind, Contact, Insn, Relation};

use crate::types::Elementary;

/// Code of a block.
#[derive(Clone, Debug, Default)]
pub struct S7200Body {
    /// Formal parameters, in the order of the local variable table: IN, IN_OUT, OUT.
    pub parameters: Vec<Parameter>,
    pub statements: Vec<Statement>,
}

/// A formal parameter, with its address in local data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    pub name: String,
    pub direction: Direction,
    /// A string is a pointer, a double word.
    pub width: Width,
    /// As it is declared; of a CHAR and of a pointer the bits.
    pub ty: Elementary,
    pub byte: u32,
    pub bit: u8,
}

/// Direction of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    In,
    InOut,
    Out,
}

/// A statement.
#[derive(Clone, Debug)]
pub struct Statement {
    pub span: Span,
    /// 1-based; 0 before the first network.
    pub network: u16,
    pub kind: StatementKind,
    /// The operands whose addresses it takes, as constants in `kind`: `&VB100`, a text in V memory for a STRING parameter.
    pub addresses: Vec<Operand>,
}

/// Forms of statements. Labels, jumps, loops and sequence steps are instructions; they are known to be paired.
#[derive(Clone, Debug)]
pub enum StatementKind {
    /// Any but `CALL`.
    Instruction {
        insn: Insn,
        operands: Vec<Operand>,
    },
    /// `CALL`: with an argument for each parameter of subroutine `number`.
    Call {
        number: u16,
        arguments: Vec<Operand>,
    },
    Assert(Assert),
    /// `//@ sleep N`, in milliseconds.
    Sleep(u32),
}

/// An operand.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    /// A constant of the width that the instruction needs: its bits. Also label numbers, interrupt routines, events and addresses of
    /// operands (`&VB100`: a pointer).
    Const(u32),
    /// A string constant, without its length byte.
    Text(Vec<u8>),
    /// A place in I, Q, V, M, SM, S or L.
    Memory {
        area: Area,
        byte: u32,
        bit: u8,
        width: Width,
    },
    /// Bit (width Bit) or current value (width Word) of a timer.
    Timer {
        number: u8,
        width: Width,
    },
    /// Bit or current value of a counter.
    Counter {
        number: u8,
        width: Width,
    },
    HighSpeedCounter(u8),
    /// The low part of this width.
    Accumulator {
        number: u8,
        width: Width,
    },
    AnalogInput {
        byte: u32,
    },
    AnalogOutput {
        byte: u32,
    },
    /// `*VD200`: the target of the pointer at the place `pointer` (width Dword).
    Indirect {
        pointer: Box<Operand>,
        width: Width,
    },
}

/// Memory areas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Area {
    I,
    Q,
    V,
    M,
    Sm,
    S,
    L,
}

impl Area {
    /// In the international set.
    pub const fn letters(self) -> &'static str {
        match self {
            Area::I => "I",
            Area::Q => "Q",
            Area::V => "V",
            Area::M => "M",
            Area::Sm => "SM",
            Area::S => "S",
            Area::L => "L",
        }
    }
}

/// An assertion pragma.
pub type Assert = super::Assert<AssertSide>;

/// One side of an assertion.
#[derive(Clone, Debug)]
pub enum AssertSide {
    /// Value zero-extended to 32 bits.
    Operand(Operand),
    /// A level of the logic stack, 0 to 8.
    Stack(u8),
    Eno,
}
