//! Statements of STL: networks, calls, operands and the paths in them.

use plcc_diag::Span;

use super::{BlockName, BlockPrefix, Bound, Pragma};
use crate::literal::Literal;
use crate::stl::{Mnemonics, StlInsn};

/// `NETWORK` with its statements. Statements before the first NETWORK form a separate network.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Network {
    pub title: Option<String>,
    pub comment: Vec<String>,
    pub statements: Vec<Statement>,
}

/// A statement, with the label before it. What few statements have is boxed: a program can have a million of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    pub label: Option<Box<Label>>,
    pub kind: StatementKind,
    pub span: Span,
}

/// A jump label, in the letter case of the source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    pub name: String,
    pub span: Span,
}

/// Forms of statements.
#[derive(Clone, Debug, PartialEq)]
pub enum StatementKind {
    /// A label alone, or `;`.
    Empty,
    Instruction {
        insn: StlInsn,
        mnemonic_span: Span,
        operand: Option<Operand>,
    },
    Call(Box<Call>),
    Pragma(Pragma),
    /// Could not be parsed; reported.
    Error,
}

/// `CALL target {type := name}, instance ( name := actual, ... )`.
#[derive(Clone, Debug, PartialEq)]
pub struct Call {
    pub target: Operand,
    /// The data types for which an instruction is called.
    pub types: Vec<CallType>,
    pub instance: Option<Operand>,
    pub parameters: Vec<Parameter>,
}

/// `src_type := Int`.
#[derive(Clone, Debug, PartialEq)]
pub struct CallType {
    pub name: String,
    /// The name of the data type, as written.
    pub ty: String,
}

/// `name := actual`; `None`: left empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    pub name: String,
    pub name_span: Span,
    pub actual: Option<Operand>,
}

/// An operand of a mnemonic, or an actual parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Operand {
    pub kind: OperandKind,
    pub span: Span,
}

/// Memory areas that operands name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Area {
    I,
    Q,
    M,
    /// Peripheral input.
    Pi,
    /// Peripheral output.
    Pq,
    L,
    /// Open shared DB.
    Db,
    /// Open instance DB.
    Di,
}

impl Area {
    /// As written in the international mnemonics, `"PI"`.
    pub const fn letters(self) -> &'static str {
        match self {
            Area::I => "I",
            Area::Q => "Q",
            Area::M => "M",
            Area::Pi => "PI",
            Area::Pq => "PQ",
            Area::L => "L",
            Area::Db => "DB",
            Area::Di => "DI",
        }
    }
}

/// Width of an access.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Width {
    Bit,
    Byte,
    Word,
    Dword,
    /// 64 bits; no operand of STL has this width.
    Lword,
}

impl Width {
    /// In bits.
    pub const fn bits(self) -> u32 {
        match self {
            Width::Bit => 1,
            Width::Byte => 8,
            Width::Word => 16,
            Width::Dword => 32,
            Width::Lword => 64,
        }
    }

    /// In memory, in bytes.
    pub const fn bytes(self) -> u32 {
        self.bits().div_ceil(8)
    }

    /// Its letter in slices and in addresses of data blocks: `%X3`, `DBW 4`.
    pub const fn letter(self) -> &'static str {
        match self {
            Width::Bit => "X",
            Width::Byte => "B",
            Width::Word => "W",
            Width::Dword => "D",
            Width::Lword => "L",
        }
    }
}

/// `T n`, `C n`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CellKind {
    Timer,
    Counter,
}

/// The address registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AddressRegister {
    Ar1,
    Ar2,
}

/// Status bits and results as bit operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StatusOperand {
    Br,
    Ov,
    Os,
    /// CC1 and CC0 both 1.
    Uo,
    Eq0,
    Ne0,
    Gt0,
    Lt0,
    Ge0,
    Le0,
}

impl StatusOperand {
    /// As statement lists write it.
    pub const fn name(self, mnemonics: Mnemonics) -> &'static str {
        match (self, mnemonics) {
            (StatusOperand::Br, Mnemonics::De) => "BIE",
            (StatusOperand::Br, Mnemonics::En) => "BR",
            (StatusOperand::Ov, _) => "OV",
            (StatusOperand::Os, _) => "OS",
            (StatusOperand::Uo, _) => "UO",
            (StatusOperand::Eq0, _) => "==0",
            (StatusOperand::Ne0, _) => "<>0",
            (StatusOperand::Gt0, _) => ">0",
            (StatusOperand::Lt0, _) => "<0",
            (StatusOperand::Ge0, _) => ">=0",
            (StatusOperand::Le0, _) => "<=0",
        }
    }
}

/// Registers that `L` and `T` name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SpecialRegister {
    Stw,
    DbLength,
    DbNumber,
    DiLength,
    DiNumber,
}

impl SpecialRegister {
    /// As statement lists write it.
    pub const fn name(self) -> &'static str {
        match self {
            SpecialRegister::Stw => "STW",
            SpecialRegister::DbLength => "DBLG",
            SpecialRegister::DbNumber => "DBNO",
            SpecialRegister::DiLength => "DILG",
            SpecialRegister::DiNumber => "DINO",
        }
    }
}

/// Forms of operands, before names are settled.
#[derive(Clone, Debug, PartialEq)]
pub enum OperandKind {
    /// `I 0.0`, `MW 10`, `DBX 1.2`, `PIW 272`; `bit` only with width Bit.
    Absolute {
        area: Area,
        width: Width,
        byte: u32,
        bit: u8,
    },
    /// `T 5`, `C 5`.
    Cell {
        kind: CellKind,
        number: u32,
    },
    /// `DB5.DBW 2`, `"db".DBX 0.0`.
    DbAbsolute {
        db: BlockName,
        width: Width,
        byte: u32,
        bit: u8,
    },
    /// `MW [LD 10]`, `I [MD 4]`.
    MemoryIndirect {
        area: Area,
        width: Width,
        pointer: Box<Operand>,
    },
    /// `T [MW 2]`, `C [#n]`.
    CellIndirect {
        kind: CellKind,
        pointer: Box<Operand>,
    },
    /// `DB [MW 0]`, `FC [LW 10]`.
    BlockIndirect {
        prefix: BlockPrefix,
        pointer: Box<Operand>,
    },
    /// `MW [AR1,P#4.3]`, and area-crossing `W [AR1,P#0.0]` with no area; `offset` in bits.
    RegisterIndirect {
        area: Option<Area>,
        width: Width,
        register: AddressRegister,
        offset: u32,
    },
    /// `FC 7`, `DB 10`, `DI 3`, `SFB 4`.
    Block(BlockName),
    /// `"sym"`, `"db".a.b[3]`, `#loc.x`, a bare name, `DB10.member` (root is then the block).
    Path(Path),
    /// `"sym":P`: past the process image.
    Peripheral(Path),
    /// `P##loc.x`.
    AddressOf(Path),
    Literal(Literal),
    Status(StatusOperand),
    Special(SpecialRegister),
    /// `LAR1 AR2`, `TAR1 AR2`.
    Register(AddressRegister),
    /// Target of a jump.
    Label(String),
    /// Could not be parsed; reported.
    Error,
}

/// A name with components.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    pub root: PathRoot,
    pub parts: Vec<PathPart>,
    pub span: Span,
}

impl Path {
    /// The name alone, if nothing comes after it.
    pub fn name(&self) -> Option<&str> {
        match &self.root {
            PathRoot::Local { name, .. } | PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. } => {
                self.parts.is_empty().then_some(name)
            }
            PathRoot::Block(_) => None,
        }
    }
}

/// What a path begins with.
#[derive(Clone, Debug, PartialEq)]
pub enum PathRoot {
    /// `#name` or a component in a DB's value part.
    Local { name: String, span: Span },
    /// `"name"`: a symbol.
    Quoted { name: String, span: Span },
    /// A bare name: local if declared, else a symbol.
    Bare { name: String, span: Span },
    /// `DB10` in `DB10.member`.
    Block(BlockName),
}

/// A step into a structure or array.
#[derive(Clone, Debug, PartialEq)]
pub enum PathPart {
    Member {
        name: String,
        span: Span,
    },
    /// `[1,-2]`.
    Index {
        values: Vec<Bound>,
        span: Span,
    },
}
