//! Syntax tree of Micro/WIN sources. Names are kept as written; nothing is looked up here.

use plcc_diag::Span;

use crate::ast::{Pragma, Width};
use crate::s7200::Insn;

/// The contents of a source in STL for the S7-200, in the order of the text.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Source {
    /// Statements without a header form the main program, or the subroutine that the file is named after (`is_bare`).
    pub blocks: Vec<Block>,
    /// Lines of data blocks.
    pub data: Vec<DataLine>,
}

/// Kind of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BlockKind {
    /// OB1.
    Main,
    Subroutine,
    Interrupt,
}

impl BlockKind {
    /// The word that begins a block.
    pub const fn keyword(self) -> &'static str {
        match self {
            BlockKind::Main => "ORGANIZATION_BLOCK",
            BlockKind::Subroutine => "SUBROUTINE_BLOCK",
            BlockKind::Interrupt => "INTERRUPT_BLOCK",
        }
    }

    /// The word that ends a block.
    pub const fn end_keyword(self) -> &'static str {
        match self {
            BlockKind::Main => "END_ORGANIZATION_BLOCK",
            BlockKind::Subroutine => "END_SUBROUTINE_BLOCK",
            BlockKind::Interrupt => "END_INTERRUPT_BLOCK",
        }
    }
}

/// A program block.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    pub kind: BlockKind,
    /// Symbolic name, with its position; `None`: only a number, or no header.
    pub name: Option<(String, Span)>,
    /// Number of `SBR3`, `INT0`, `OB1`; `None`: not given.
    pub number: Option<(u32, Span)>,
    /// It has no header: a file of statements, or a section of a flat list.
    pub is_bare: bool,
    pub title: String,
    /// Comment lines after the header, without `//`.
    pub comment: Vec<String>,
    pub declarations: Vec<Declaration>,
    pub networks: Vec<Network>,
    /// From the header to the end.
    pub span: Span,
}

/// Which variables are declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Section {
    Input,
    InOut,
    Output,
    /// `VAR`.
    Temp,
}

/// A local variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Declaration {
    pub section: Section,
    pub name: String,
    pub name_span: Span,
    /// In capital letters: `BOOL`.
    pub ty: String,
    pub ty_span: Span,
    pub initial: Option<Operand>,
    pub comment: Option<String>,
}

/// `Network 1 // title`, with its statements. Statements before the first one form a separate network.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// As written, decoration only.
    pub number: Option<u32>,
    pub title: String,
    pub comment: Vec<String>,
    pub statements: Vec<Statement>,
    /// Of the `NETWORK` line; without one, of the first statement.
    pub span: Span,
}

/// A statement, or a pragma between statements.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    pub kind: StatementKind,
    /// Without its comment.
    pub span: Span,
    pub comment: Option<String>,
}

/// Forms of statements.
#[derive(Clone, Debug, PartialEq)]
pub enum StatementKind {
    Instruction {
        insn: Insn,
        mnemonic_span: Span,
        operands: Vec<Operand>,
    },
    Pragma {
        pragma: Pragma,
        assert: Option<Box<Assert>>,
    },
    /// Could not be parsed; reported.
    Error,
}

/// What an assertion checks.
pub type Assert = crate::ast::Assertion<AssertSide>;

/// One side of an assertion.
#[derive(Clone, Debug, PartialEq)]
pub enum AssertSide {
    /// An address, a symbol, a constant or an accumulator. `T5` is the bit; `TW5` and `CW5` are the current values.
    Operand(Operand),
    /// `S0` to `S8`: a level of the logic stack.
    Stack(u8),
    /// `ENO`.
    Eno,
}

/// An operand.
#[derive(Clone, Debug, PartialEq)]
pub struct Operand {
    pub kind: OperandKind,
    /// Of `Start:I0.0`, as an editor shows symbols with their addresses: the symbol; `kind` is then the address or the block.
    pub shown: Option<Shown>,
    pub span: Span,
}

/// A symbol before its address.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    pub name: String,
    pub form: SymbolForm,
}

/// Forms of operands.
#[derive(Clone, Debug, PartialEq)]
pub enum OperandKind {
    /// `I0.0`, `VW100`, `T37`, `AC1`, `AIW4`.
    Direct(Direct),
    /// `*VD200`, `*LD4`, `*AC1`, `*#pointer`.
    Indirect(Box<Operand>),
    /// `&VB100`, `&#buffer`.
    AddressOf(Box<Operand>),
    Constant(Constant),
    /// `#Raw`, `Raw`, `"Raw"`; also names of blocks.
    Symbol {
        name: String,
        form: SymbolForm,
    },
    /// `SBR3`, `INT0`, `OB1`.
    Block {
        kind: BlockKind,
        number: u32,
    },
    /// Could not be parsed; reported.
    Error,
}

/// How a symbol is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SymbolForm {
    /// `#Raw`: local.
    Local,
    /// `"Raw"`: global, but a string constant where one is allowed.
    Quoted,
    /// `Raw`: local, else global.
    Bare,
}

/// Areas that direct addresses name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Area {
    I,
    Q,
    V,
    M,
    Sm,
    S,
    L,
    /// Timers: `T37` is the bit or the current value.
    T,
    /// Counters.
    C,
    /// High-speed counters.
    Hc,
    Ac,
    Ai,
    Aq,
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
            Area::T => "T",
            Area::C => "C",
            Area::Hc => "HC",
            Area::Ac => "AC",
            Area::Ai => "AI",
            Area::Aq => "AQ",
        }
    }
}

/// A direct address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direct {
    pub area: Area,
    /// As written: `VW100`, `ACB0`, `V100.5`; `None`: the instruction decides (`T37`, `AC0`, `HC1`).
    pub width: Option<Width>,
    /// Byte, or number of the timer, counter or accumulator.
    pub number: u32,
    /// With width Bit only.
    pub bit: u8,
}

/// A constant as written.
#[derive(Clone, Debug, PartialEq)]
pub enum Constant {
    /// `100`, `+20`, `-5`.
    Integer(i64),
    /// `16#7FFF`, `2#1010`, `B#16#FF`; with its width if one is written.
    Bits {
        value: u32,
        width: Option<Width>,
    },
    Real(f32),
    /// `TRUE`, `FALSE`, `ON`, `OFF`.
    Bool(bool),
    /// `'ABCD'`: bytes of the text, escapes expanded.
    Characters(Vec<u8>),
    /// A string constant in double quotes with a character that no symbol has: `"12 kg"`. Where only a symbol is possible, the name is `text`.
    Text(Vec<u8>),
}

/// A line of a data block: `VW10 -5, 300`.
#[derive(Clone, Debug, PartialEq)]
pub struct DataLine {
    /// `None`: the values follow those of the previous line.
    pub address: Option<Operand>,
    pub values: Vec<Operand>,
    pub span: Span,
}
