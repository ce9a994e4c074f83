//! The bound program: every name, type and address is settled.
//!
//! All languages bind to these blocks and interfaces; bodies differ by language until they are lowered.

use plcc_abi::image::{
    AssertCondition, AssertConstant, AssertKind, AssertOp, AssertType, BlockKind, Config, Kept, Profile,
};
use plcc_abi::ob::StartInput;
use plcc_abi::s7200::image::CpuRow;
use plcc_diag::Span;
pub use plcc_syntax::ast::{AddressRegister, AssertRegister, CellKind, SpecialRegister, StatusOperand, Width};
use plcc_syntax::stl::StlInsn;

use crate::layout;
use crate::types::{DataType, Elementary, Member, ParameterType};
use crate::{s7200, scl};

/// A whole program.
#[derive(Clone, Debug)]
pub struct Program {
    pub name: String,
    pub profile: Profile,
    pub config: Config,
    /// Blocks with code, including the blocks of the standard library that are used; sorted by kind and number.
    pub blocks: Vec<CodeBlock>,
    /// Sorted by number.
    pub dbs: Vec<DataBlock>,
    /// Named addresses, for the flags of the executable.
    pub symbols: Vec<Symbol>,
    /// `//@ test cycles=N`, `//@ test expect=fail` and `//@ cpu`, found in the sources.
    pub test: TestSettings,
    /// Lines that every run of the program prints at its start: that it is not the same as its sources.
    pub notices: Vec<String>,
    /// Limits of the CPU, if it is an S7-200.
    pub s7200: Option<CpuRow>,
    /// The stand-ins for missing parts, and the parts that are left out for lack of them: one line each.
    pub partial: Vec<String>,
}

impl Program {
    pub fn block(&self, key: BlockKey) -> Option<&CodeBlock> {
        self.blocks.binary_search_by_key(&key, CodeBlock::key).ok().map(|index| &self.blocks[index])
    }

    pub fn db(&self, number: u16) -> Option<&DataBlock> {
        self.dbs.binary_search_by_key(&number, |db| db.number).ok().map(|index| &self.dbs[index])
    }
}

/// A named address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    pub name: String,
    /// In international spelling: `Q4.0`, `DB10`.
    pub address: String,
    /// The declared type of a value in memory.
    pub ty: Option<DataType>,
}

/// The settings in the pragmas of a test file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TestSettings {
    pub cycles: Option<u32>,
    /// The program must be rejected, or go to STOP, with this code (`P0203`, `16#2521`, `0011`); empty: with any.
    pub expect_fail: Option<String>,
}

/// Names a block with code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BlockKey {
    pub kind: BlockKind,
    pub number: u16,
}

impl std::fmt::Display for BlockKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.kind.prefix(), self.number)
    }
}

/// A block with code.
#[derive(Clone, Debug)]
pub struct CodeBlock {
    pub kind: BlockKind,
    pub number: u16,
    /// Symbol without quotes; empty if none.
    pub name: String,
    /// The block's header.
    pub span: Span,
    /// A block of the standard library: its statements have no source of their own.
    pub library: bool,
    pub interface: Interface,
    /// Declared TEMP variables, in bytes, even.
    pub temp_bytes: u32,
    /// STL: data blocks whose numbers are passed to a DB_ANY, and where: for cross references.
    pub named_dbs: Vec<(u16, Span)>,
    pub body: Body,
}

impl CodeBlock {
    pub fn key(&self) -> BlockKey {
        BlockKey { kind: self.kind, number: self.number }
    }

    /// True if this bit of the instance is a BOOL of a block of the library that shares its byte with nothing: the other bits mean nothing.
    pub fn is_alone(&self, byte: u32, bit: u8) -> bool {
        let mut there = self.interface.instance.iter().filter(|member| member.byte == byte);
        let is_bool = |member: &Member| matches!(member.ty, DataType::Elementary(Elementary::Bool));
        self.library && bit == 0 && there.next().is_some_and(is_bool) && there.next().is_none()
    }
}

/// Parameters and static data of a block.
#[derive(Clone, Debug, Default)]
pub struct Interface {
    /// IN, OUT, IN_OUT in this order, each as declared; the result of an FC is the OUT parameter RET_VAL after the other
    /// OUTs (before them for system functions, as documented).
    pub parameters: Vec<Parameter>,
    /// FB, SFB: whole instance memory, rounded up to even. FC, SFC: the parameters laid out like a structure (the form in
    /// which system functions get them).
    pub bytes: u32,
    /// FB, SFB: parameters and STAT with their addresses in the instance.
    pub instance: Vec<Member>,
    /// OB: bytes at the head of its local data that the CPU writes when it starts: start information, then the input parameters.
    pub start_bytes: u32,
    /// OB: its input parameters and their addresses in its local data.
    pub start_inputs: Vec<StartInput>,
    /// FB: `CODE_VERSION1`, no multi-instance is possible.
    pub code_version1: bool,
    /// TEMP variables with their addresses in the local data, in the order of these.
    pub temporaries: Vec<Member>,
    /// `VAR CONSTANT` and CONST, those with a single value, in the order of the source: for the debugger.
    pub constants: Vec<BlockConstant>,
}

/// A constant of a block.
#[derive(Clone, Debug)]
pub struct BlockConstant {
    pub name: String,
    pub ty: Elementary,
    /// Zero-extended from the width of the type.
    pub bits: u64,
}

/// Direction of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    Input,
    Output,
    InOut,
}

/// A formal parameter.
#[derive(Clone, Debug)]
pub struct Parameter {
    pub name: String,
    pub direction: Direction,
    pub ty: DataType,
    /// FB, SFB: address in the instance. FC, SFC: address in the structure of parameters.
    pub byte: u32,
    pub bit: u8,
    pub passing: Passing,
}

/// How a parameter is passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Passing {
    /// Elementary. FC: reference to the actual. FB: copy in the instance. SFC: copy in the structure of parameters.
    Elementary(Width),
    /// Complex. FC: a POINTER in the caller's frame. FB IN, OUT: copy with this many bytes. FB IN_OUT: a POINTER in the instance.
    Complex {
        bytes: u32,
    },
    /// TIMER, COUNTER, BLOCK_x: the number.
    Number,
    Pointer,
    Any,
    /// Like an ANY, with more data after it.
    Variant,
    /// ARRAY[*]. FC: reference to the actual, then low and high bound of each dimension. FB IN_OUT: a POINTER in the instance, then the
    /// bounds, each a DINT.
    OpenArray {
        dimensions: u8,
    },
}

impl Passing {
    /// Bytes of the pointer that a block gets; 0 if it gets none.
    pub const fn pointer_bytes(self) -> u32 {
        match self {
            Passing::Pointer => 6,
            Passing::Any => layout::ANY_BYTES,
            Passing::Variant => layout::parameter_bytes(ParameterType::Variant),
            Passing::Elementary(_) | Passing::Complex { .. } | Passing::Number | Passing::OpenArray { .. } => 0,
        }
    }
}

/// Code of a block.
#[derive(Clone, Debug)]
pub enum Body {
    Stl(Vec<StlStatement>),
    Scl(scl::SclBody),
    /// STL of an S7-200.
    S7200(s7200::S7200Body),
    /// A system function that the runtime implements, under its own number.
    Runtime,
}

/// A data block.
#[derive(Clone, Debug)]
pub struct DataBlock {
    pub number: u16,
    pub name: String,
    pub span: Span,
    /// Current values as loaded; its length is the DB's, even.
    pub data: Vec<u8>,
    /// Components, for names at run time and in messages.
    pub members: Vec<Member>,
    /// The FB or SFB whose instance it is.
    pub instance_of: Option<BlockKey>,
    /// The PLC data type that it has; empty for an instance, and without one.
    pub data_type: String,
    pub read_only: bool,
    pub unlinked: bool,
    /// Optimised access: clients cannot reach it by addresses.
    pub optimized: bool,
    /// What of it is retentive.
    pub kept: Kept,
}

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

#[derive(Clone, Debug)]
pub enum StlStatementKind {
    /// The next statement can be jumped to.
    Label(LabelId),
    Instruction {
        insn: StlInsn,
        operand: Operand,
    },
    /// `JL`: `targets` are the labels of the list; the JU statements of the list are no longer separate statements.
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

/// A place in memory.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    I {
        byte: u32,
        bit: u8,
    },
    Q {
        byte: u32,
        bit: u8,
    },
    M {
        byte: u32,
        bit: u8,
    },
    /// Peripheral input and output; a bit is read out of its byte.
    Pi {
        byte: u32,
        bit: u8,
    },
    Pq {
        byte: u32,
        bit: u8,
    },
    /// Local data; also declared TEMP variables.
    L {
        byte: u32,
        bit: u8,
    },
    /// In the open DB.
    OpenDb {
        byte: u32,
        bit: u8,
    },
    /// In the open DI.
    OpenDi {
        byte: u32,
        bit: u8,
    },
    /// Fully qualified: the access opens the DB first.
    Db {
        number: u16,
        byte: u32,
        bit: u8,
    },
    /// FB: in the instance, at AR2 + byte.bit of the DI.
    Instance {
        byte: u32,
        bit: u8,
    },
    /// FC: `byte`.`bit` after the start of what the parameter refers to; both 0 for an elementary one.
    Parameter {
        parameter: usize,
        byte: u32,
        bit: u8,
    },
    /// FB: complex IN_OUT parameter, reached through the POINTER at `pointer` of the instance.
    ThroughPointer {
        pointer: u32,
        byte: u32,
        bit: u8,
    },
    /// `MW [MD 4]`: `area` with the address in the double word at `pointer`.
    Indirect {
        area: PlaceArea,
        pointer: Box<Place>,
    },
    /// `MW [AR1,P#4.3]`; without an area the register contains it. `offset` in bits.
    Register {
        area: Option<PlaceArea>,
        register: AddressRegister,
        offset: u32,
    },
    /// `"Data".list[#i].speed`, on an S7-1500: at `base` with the lowest indices. At least one index is a variable.
    Element {
        base: Box<Place>,
        indices: Vec<ElementIndex>,
    },
}

impl Place {
    /// Byte and bit from the start of the area, data block or parameter in which the place is. `None`: they are only known when the program
    /// runs, or it is a direct access to a module.
    pub fn position_mut(&mut self) -> Option<(&mut u32, &mut u8)> {
        match self {
            Place::I { byte, bit }
            | Place::Q { byte, bit }
            | Place::M { byte, bit }
            | Place::L { byte, bit }
            | Place::OpenDb { byte, bit }
            | Place::OpenDi { byte, bit }
            | Place::Db { byte, bit, .. }
            | Place::Instance { byte, bit }
            | Place::Parameter { byte, bit, .. }
            | Place::ThroughPointer { byte, bit, .. } => Some((byte, bit)),
            Place::Pi { .. }
            | Place::Pq { .. }
            | Place::Indirect { .. }
            | Place::Register { .. }
            | Place::Element { .. } => None,
        }
    }

    /// The place itself, or an element after it.
    pub fn with_indices(self, indices: Vec<ElementIndex>) -> Place {
        if indices.is_empty() { self } else { Place::Element { base: Box::new(self), indices } }
    }

    /// The variable indices of an element.
    pub fn indices(&self) -> &[ElementIndex] {
        if let Place::Element { indices, .. } = self { indices } else { &[] }
    }

    /// Where an element is with the lowest indices; otherwise the place itself.
    pub fn root(&self) -> &Place {
        if let Place::Element { base, .. } = self { base } else { self }
    }
}

/// An index of an array that is read when its element is accessed.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementIndex {
    pub place: Place,
    /// An integer or a bit string of up to 32 bits.
    pub ty: Elementary,
    pub low: i32,
    pub high: i32,
    /// Distance of elements, in bits.
    pub stride: u32,
}

impl ElementIndex {
    /// Distance of the first and the last element, in bits.
    pub fn reach(&self) -> u32 {
        let steps = u32::try_from(i64::from(self.high) - i64::from(self.low)).unwrap_or(0);
        steps.saturating_mul(self.stride)
    }
}

pub use plcc_syntax::ast::Area as PlaceArea;

/// A call with parameters.
#[derive(Clone, Debug)]
pub struct Call {
    pub target: BlockKey,
    pub instance: Option<Instance>,
    /// One for each parameter that is supplied, in the order of the interface.
    pub arguments: Vec<Argument>,
}

/// Instance memory of an FB call.
#[derive(Clone, Debug, PartialEq)]
pub enum Instance {
    /// `CALL FB 1, DB 1`.
    Db(u16),
    /// `CALL #mi`: at `byte` of this FB's instance.
    Multi { byte: u32 },
    /// `CALL "Data".timer`: at `byte` of a data block with other data.
    Inner { db: u16, byte: u32 },
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
#[derive(Clone, Debug, PartialEq)]
pub enum Actual {
    /// A constant: its bytes as in memory; a BOOL is one byte, 0 or 1.
    Const(Vec<u8>),
    /// A variable of the width (elementary) or size (complex) of the formal.
    Place(Place),
    /// TIMER, COUNTER, BLOCK_x.
    Number(Number),
    /// POINTER and ANY formals: the bytes are known.
    PointerBytes(Vec<u8>),
    /// POINTER and ANY formals: points at `place`. For an ANY, `type_code` and `count` are its bytes 1 to 3.
    PointerTo { place: Place, type_code: u8, count: u16 },
    /// POINTER and ANY formals: the structure itself is at `place` (a TEMP variable of type ANY, a formal of the same type).
    PointerCopy(Place),
    /// VARIANT formals: an ANY, and what it points at.
    Variant(Box<Actual>, Pointed),
}

impl Actual {
    /// The ANY of a VARIANT; otherwise the actual itself.
    pub fn pointer(&self) -> &Actual {
        match self {
            Actual::Variant(any, _) => any,
            other => other,
        }
    }

    /// The variable indices of what is passed or pointed at.
    pub fn indices(&self) -> &[ElementIndex] {
        match self.pointer() {
            Actual::Place(place) | Actual::PointerTo { place, .. } | Actual::PointerCopy(place) => place.indices(),
            Actual::Const(_) | Actual::Number(_) | Actual::PointerBytes(_) | Actual::Variant(..) => &[],
        }
    }
}

/// The contents of a VARIANT after its ANY.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pointed {
    /// Number of elements, 0 if it is not an array; [`crate::layout::type_number`] of them.
    Known { elements: u32, ty: u32 },
    /// As many elements as the ARRAY[*] that the ANY points at; [`crate::layout::type_number`] of them.
    Counted { ty: u32 },
    /// The contents of the VARIANT that the ANY is a copy of.
    Copied,
}

/// An assertion pragma, with sides `S`.
#[derive(Clone, Debug)]
pub struct Assert<S = AssertSide> {
    pub condition: AssertCondition,
    /// At least one.
    pub comparisons: Vec<Comparison<S>>,
    /// One comparison of two different constants.
    pub trap: bool,
    /// The source line, trimmed.
    pub text: String,
}

/// A comparison with settled types.
#[derive(Clone, Debug)]
pub struct Comparison<S> {
    pub op: AssertOp,
    pub kind: AssertKind,
    pub left: Compared<S>,
    pub right: Compared<S>,
}

/// A side of a comparison with the type that it has there.
#[derive(Clone, Debug)]
pub struct Compared<S> {
    pub ty: AssertType,
    pub value: ComparedValue<S>,
}

#[derive(Clone, Debug)]
pub enum ComparedValue<S> {
    Constant(AssertConstant),
    Code(S),
}

impl<S> Assert<S> {
    /// The values that code supplies for the sides, in source order.
    pub fn sides(&self) -> impl Iterator<Item = &S> {
        self.comparisons.iter().flat_map(|comparison| [&comparison.left, &comparison.right]).filter_map(|side| {
            match &side.value {
                ComparedValue::Code(side) => Some(side),
                ComparedValue::Constant(_) => None,
            }
        })
    }
}

#[derive(Clone, Debug)]
pub enum AssertSide {
    /// Value zero-extended.
    Operand(Operand),
    /// Time left of a timer, an S5TIME, or count of a counter, an INT.
    CellValue {
        kind: CellKind,
        number: Number,
    },
    /// A text or a DTL: where it is.
    Memory(Place),
    Register(AssertRegister),
}
