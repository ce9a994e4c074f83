//! Syntax tree of block-framed sources (the statements are those of STL; frames, declarations and data blocks serve every textual language).
//!
//! Names are kept as written; nothing is looked up here. Text that could not be parsed is left out or becomes an `Error` node,
//! and a diagnostic reports it.

mod assertion;
mod statement;

use plcc_diag::Span;

pub use assertion::{
    AssertLiteral, AssertOp, AssertRegister, AssertSide, Assertion, Comparison, Condition, Pragma, Side,
};
pub use statement::{
    AddressRegister, Area, Call, CallType, CellKind, Label, Network, Operand, OperandKind, Parameter, Path, PathPart,
    PathRoot, SpecialRegister, Statement, StatementKind, StatusOperand, Width,
};

use crate::chart;
use crate::literal::Literal;
use crate::network;
use crate::s7200;
use crate::scl;
use crate::stl::Mnemonics;

/// A source file.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct SourceUnit {
    pub mnemonics: Mnemonics,
    /// Whether words of STL in the file show its set. `None`: the set was given, or the file has no STL.
    pub shows_mnemonics: Option<bool>,
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

impl Variable {
    /// A variable that nobody has written: without value, attributes and comment.
    pub fn new(name: impl Into<String>, ty: TypeRef, span: Span) -> Variable {
        Variable {
            name: name.into(),
            name_span: span,
            attributes: Vec::new(),
            at: None,
            ty,
            initial: None,
            comment: None,
        }
    }
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
