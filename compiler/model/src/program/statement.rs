//! Statements of STL and their operands.

use plcc_abi::image::BlockKind;
use plcc_diag::Span;
use plcc_syntax::ast::{AddressRegister, CellKind, SpecialRegister, StatusOperand, Width};
use plcc_syntax::stl::StlInsn;

use super::{Assert, Call, Place};

/// A statement of an STL block.
#[derive(Clone, Debug)]
pub struct StlStatement {
    pub span: Span,
    /// From 1; 0 before the first network.
    pub network: u16,
    pub kind: StlStatementKind,
}

/// Names a label of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LabelId(pub u32);

/// What a statement of an STL block is.
#[derive(Clone, Debug)]
pub enum StlStatementKind {
    /// The next statement can be jumped to.
    Label(LabelId),
    Instruction {
        insn: StlInsn,
        operand: Operand,
    },
    /// `JL`: `targets` are the labels of the list; the JU statements of the list are not among the statements.
    JumpList {
        targets: Vec<LabelId>,
        default: LabelId,
    },
    Call(Call),
    Assert(Box<Assert>),
    /// `//@ sleep N`, in milliseconds.
    Sleep(u32),
}

/// An operand that is settled.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    None,
    /// The value that `L` loads; also counts, pointer constants and the operands of `+`. `+ -5` is 16#0000_FFFB with `wide` false.
    Const {
        value: u32,
        wide: bool,
    },
    /// A place in memory, with the width of the access.
    Memory {
        place: Place,
        width: Width,
    },
    /// A timer or counter.
    Cell {
        kind: CellKind,
        number: Number,
    },
    /// A block to call: FC, FB, SFC, SFB. `kind` is the table of `number`.
    Block {
        kind: BlockKind,
        number: Number,
    },
    /// A data block to open; `di`: in the DI register.
    Db {
        di: bool,
        number: Number,
    },
    Status(StatusOperand),
    Special(SpecialRegister),
    Register(AddressRegister),
    Label(LabelId),
    /// `L P##p` of a parameter of an FC: for a complex, POINTER or ANY one a V pointer to what the caller passes, for an elementary one
    /// the area pointer of the actual.
    ParameterPointer {
        parameter: usize,
    },
}

/// A number, known or read at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum Number {
    Known(u16),
    /// The word at a place: `T [MW 2]`.
    Word(Box<Place>),
    /// The parameter `parameter` of this FC, passed as a number.
    Parameter(usize),
}
