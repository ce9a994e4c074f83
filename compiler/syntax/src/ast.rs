//! Syntax tree of block-framed sources (the statements are those of STL; frames, declarations and data blocks serve every textual language).
//!
//! Names are kept as written; nothing is looked up here. Text that could not be parsed is left out or becomes an `Error` node,
//! and a diagnostic reports it.

use plcc_diag::Span;

use crate::chart;
use crate::literal::Literal;
use crate::network;
use crate::s7200;
use crate::scl;
use crate::stl::{Mnemonics, StlInsn};

/// A source file.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct SourceUnit {
    pub mnemonics: Mnemonics,
    /// Statements without a block header form OB 1.
    pub blocks: Vec<Block>,
    /// `//@ cpu`, `//@ test` and other pragmas that apply to the file.
    pub pragmas: Vec<Pragma>,
    /// For files with their own notation of names and operands (XML): a text as long as the file, which has at each span what the
    /// span means, `#motor.speed`.
    pub overlay: Option<String>,
    /// Interfaces of other blocks, without code, as calls in the file describe them. They count only if no source defines the block.
    pub outlines: Vec<CodeBlock>,
    /// For sources of the S7-200, which have other blocks; `blocks` is empty then.
    pub s7200: Option<s7200::ast::Source>,
}

/// A block of a source.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    Code(CodeBlock),
    Data(DataBlock),
    Type(TypeBlock),
}

impl Block {
    /// From its keyword to its end.
    pub fn span(&self) -> Span {
        match self {
            Block::Code(block) => block.span,
            Block::Data(block) => block.span,
            Block::Type(block) => block.span,
        }
    }
}

/// Kind of a block with code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CodeKind {
    Ob,
    Fc,
    Fb,
    /// Only in sources of the standard library.
    Sfc,
    /// Only in sources of the standard library.
    Sfb,
}

/// How a source names a block: `FC 7`, `"Tank control"`, `TankControl`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BlockName {
    /// Prefix in international spelling and upper case: `FC`, `DB`, `UDT`.
    Numbered { prefix: BlockPrefix, number: u32, span: Span },
    /// Symbol without quotes.
    Symbol { name: String, span: Span },
}

impl BlockName {
    pub fn span(&self) -> Span {
        match self {
            BlockName::Numbered { span, .. } | BlockName::Symbol { span, .. } => *span,
        }
    }
}

/// Prefix of a block number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BlockPrefix {
    Ob,
    Fc,
    Fb,
    Sfc,
    Sfb,
    Db,
    Di,
    Udt,
    Vat,
}

impl BlockPrefix {
    /// As written in the international mnemonics, `"FC"`.
    pub const fn letters(self) -> &'static str {
        match self {
            BlockPrefix::Ob => "OB",
            BlockPrefix::Fc => "FC",
            BlockPrefix::Fb => "FB",
            BlockPrefix::Sfc => "SFC",
            BlockPrefix::Sfb => "SFB",
            BlockPrefix::Db => "DB",
            BlockPrefix::Di => "DI",
            BlockPrefix::Udt => "UDT",
            BlockPrefix::Vat => "VAT",
        }
    }
}

/// Title, attributes and author data of a block.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Header {
    pub title: Option<String>,
    /// Comment lines after the header, without `//`.
    pub comment: Vec<String>,
    /// `{ name := 'value' }`.
    pub attributes: Vec<(String, String)>,
    pub author: Option<String>,
    pub family: Option<String>,
    pub name: Option<String>,
    /// The number of a block that is written with its name.
    pub number: Option<u32>,
    /// The tool chose the number, and may choose another.
    pub auto_number: bool,
    pub version: Option<String>,
    pub know_how_protect: bool,
    pub standard: bool,
    pub code_version1: bool,
    pub unlinked: bool,
    pub read_only: bool,
    pub non_retain: bool,
    /// `RETAIN`: of a data block, all of it.
    pub retain: bool,
}

/// OB, FC, FB, SFC or SFB.
#[derive(Clone, Debug, PartialEq)]
pub struct CodeBlock {
    pub kind: CodeKind,
    pub name: BlockName,
    /// FC only; `None` for VOID or left out.
    pub return_type: Option<TypeRef>,
    pub header: Header,
    pub sections: Vec<Section>,
    /// `VAR CONSTANT` and `CONST`.
    pub constants: Vec<Constant>,
    pub code: Code,
    pub span: Span,
}

impl CodeBlock {
    /// Networks of a block in STL; none of other languages.
    pub fn networks(&self) -> &[Network] {
        match &self.code {
            Code::Stl(networks) => networks,
            Code::Scl(_) | Code::Graphic(_) | Code::Chart(_) => &[],
        }
    }
}

/// Statements of a block, by language.
#[derive(Clone, Debug, PartialEq)]
pub enum Code {
    Stl(Vec<Network>),
    Scl(scl::ast::Body),
    /// Networks of LAD, FBD and other languages.
    Graphic(network::ast::Body),
    /// GRAPH.
    Chart(chart::ast::Body),
}

/// A named constant of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    pub name: String,
    pub name_span: Span,
    /// None in a classic CONST section: the type of the value.
    pub ty: Option<TypeRef>,
    /// None: the value that variables of the type start with.
    pub value: Option<scl::ast::Expr>,
    /// The start value of an array or a structure.
    pub initial: Option<InitialValue>,
}

/// `DATA_BLOCK … END_DATA_BLOCK`.
#[derive(Clone, Debug, PartialEq)]
pub struct DataBlock {
    pub name: BlockName,
    pub header: Header,
    pub content: DataContent,
    /// Assignments after BEGIN.
    pub values: Vec<ValueAssignment>,
    /// Names of the components that are declared as retentive one by one.
    pub retained: Vec<String>,
    pub span: Span,
}

/// What a data block consists of.
#[derive(Clone, Debug, PartialEq)]
pub enum DataContent {
    Struct(Vec<Variable>),
    /// A UDT, FB or SFB.
    OfType(TypeRef),
    /// `ARRAY[..] OF type`, with its initial value.
    Array(TypeRef, Option<InitialValue>),
    /// Nothing was declared.
    Empty,
}

/// `s.f[2] := TRUE`.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueAssignment {
    pub target: Path,
    pub value: InitialValue,
    pub span: Span,
}

/// `TYPE … END_TYPE`: a UDT.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeBlock {
    pub name: BlockName,
    pub header: Header,
    pub members: Vec<Variable>,
    /// `TYPE "x" : ARRAY[1..3] OF INT`: the type itself, if it is not a STRUCT; `members` is empty then.
    pub alias: Option<TypeRef>,
    pub span: Span,
}

/// Which declarations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SectionKind {
    Input,
    Output,
    InOut,
    Static,
    Temp,
}

/// `VAR_INPUT … END_VAR` and other sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    pub kind: SectionKind,
    pub retain: Retain,
    pub variables: Vec<Variable>,
    pub span: Span,
}

/// Whether a section keeps its values when the power fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Retain {
    #[default]
    Unsaid,
    Retain,
    NonRetain,
    /// Each instance DB may choose.
    DbSpecific,
}

impl Section {
    /// Names of the variables in sections that say RETAIN.
    pub fn retained(sections: &[Section]) -> Vec<String> {
        let retentive = sections.iter().filter(|section| section.retain == Retain::Retain);
        retentive.flat_map(|section| &section.variables).map(|variable| variable.name.clone()).collect()
    }
}

/// A declared variable or component; `a, b : BOOL` makes two.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub name: String,
    pub name_span: Span,
    pub attributes: Vec<(String, String)>,
    /// `b AT a : TYPE`: the name of the variable that this one overlays.
    pub at: Option<(String, Span)>,
    pub ty: TypeRef,
    pub initial: Option<InitialValue>,
    pub comment: Option<String>,
}

/// A data type as written.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeRef {
    pub kind: TypeKind,
    pub span: Span,
}

/// Forms of data types.
#[derive(Clone, Debug, PartialEq)]
pub enum TypeKind {
    /// A type name that is a word: `INT`, `Date_And_Time`, `ANY`, `TIMER`, `BLOCK_DB`, `TON`; upper case.
    Named(String),
    /// `STRING [20]`; 254 without length.
    String(Option<Bound>),
    /// `WSTRING [20]`; 254 without length.
    WideString(Option<Bound>),
    /// Lower and upper bound of each dimension.
    Array {
        bounds: Vec<(Bound, Bound)>,
        element: Box<TypeRef>,
    },
    /// `ARRAY[*, *] OF INT`: the actual parameter has the bounds.
    OpenArray {
        dimensions: u8,
        element: Box<TypeRef>,
    },
    /// `REF_TO INT`.
    Reference(Box<TypeRef>),
    Struct(Vec<Variable>),
    /// `UDT 5`, `FB 10`, `SFB 4`, `"MotorType"`.
    Block(BlockName),
    /// A type that has been reported.
    Error,
}

/// A bound or length: a number, or the name of a constant in languages that have them.
#[derive(Clone, Debug, PartialEq)]
pub enum Bound {
    Number(i64, Span),
    Name(String, Span),
    /// A constant expression.
    Expr(Box<scl::ast::Expr>),
    /// In code of STL: an index that may be a variable.
    Path(Box<Path>),
}

/// A value after `:=` in a declaration or after `BEGIN`.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialValue {
    pub kind: InitialKind,
    pub span: Span,
}

/// Forms of initial values.
#[derive(Clone, Debug, PartialEq)]
pub enum InitialKind {
    Literal(Literal),
    /// `1, 2, 6 (0), 3`: values of an array.
    List(Vec<InitialValue>),
    /// Values of single elements of an array, by their indices; the others keep their default.
    Elements(Vec<(Vec<i64>, InitialValue)>),
    /// `6 (0)`, `3 (1, 2)`.
    Repeat {
        count: Bound,
        values: Vec<InitialValue>,
    },
    /// A constant expression of SCL.
    Expr(Box<scl::ast::Expr>),
    /// `(a := 1, b := 2)`, `(1, 2)`, `()`: components of a structure, by name or in order.
    Fields(Vec<(Option<scl::ast::Name>, InitialValue)>),
    /// `T 5`, `DB 7`, `"Tank"`: the value of a parameter of type TIMER, COUNTER or BLOCK_x in an instance.
    Operand(OperandKind),
    /// Left empty between commas: the element keeps its default.
    Default,
}

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

/// A comment line `//@ ...`, as text; its meaning is found where names are known.
#[derive(Clone, Debug, PartialEq)]
pub struct Pragma {
    /// Without `//@` and outer blanks.
    pub text: String,
    /// Of the whole pragma, `//@` included.
    pub span: Span,
    /// For `assert`: its condition, with sides parsed by the grammar of operands.
    pub assert: Option<Box<Assertion>>,
}

/// Comparisons and how they are joined, with operands `S`.
#[derive(Clone, Debug, PartialEq)]
pub struct Assertion<S = AssertSide> {
    pub condition: Condition,
    /// In the order of the text.
    pub comparisons: Vec<Comparison<S>>,
}

/// How comparisons are joined.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// The comparison with this number.
    Compare(u32),
    Not(Box<Condition>),
    All(Vec<Condition>),
    Any(Vec<Condition>),
}

/// `LHS OP RHS`.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison<S> {
    pub left: Side<S>,
    pub op: AssertOp,
    pub right: Side<S>,
    pub span: Span,
}

/// A side of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Side<S> {
    pub value: S,
    /// `as TYPE`: the type as it is written.
    pub ty: Option<(String, Span)>,
    pub span: Span,
}

/// Comparison of an assertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssertOp {
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

impl AssertOp {
    /// As it is written.
    pub const fn sign(self) -> &'static str {
        match self {
            AssertOp::Eq => "==",
            AssertOp::Ne => "<>",
            AssertOp::Lt => "<",
            AssertOp::Le => "<=",
            AssertOp::Gt => ">",
            AssertOp::Ge => ">=",
        }
    }

    /// Neither `==` nor `<>`.
    pub const fn is_order(self) -> bool {
        !matches!(self, AssertOp::Eq | AssertOp::Ne)
    }
}

/// A side of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum AssertSide {
    Operand(Operand),
    /// `T1.VALUE`: the value of a timer or counter.
    CellValue(Operand),
    Register(AssertRegister),
    Literal(AssertLiteral),
}

/// A constant; the other side decides its type.
#[derive(Clone, Debug, PartialEq)]
pub struct AssertLiteral {
    /// As `L` loads it, if STL has this constant.
    pub loaded: Option<Literal>,
    /// As SCL reads it, without sign; none for constants that only STL has, such as `B#(1,8)`.
    pub exact: Option<crate::scl::ast::Literal>,
    pub negative: bool,
}

/// CPU registers that an assertion can check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssertRegister {
    /// ACCU1..ACCU4 as 1..=4.
    Accu(u8),
    Ar1,
    Ar2,
    Stw,
    Br,
    Cc1,
    Cc0,
    Ov,
    Os,
    Or,
    Sta,
    Rlo,
    Fc,
    DbNumber,
    DiNumber,
}
