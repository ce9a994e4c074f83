//! The bound program: every name, type and address is settled.
//!
//! All languages bind to these blocks and interfaces; bodies differ by language until they are lowered.
//!
//! - Here: blocks, their interfaces, and data blocks.
//! - `statement`: statements of STL and their operands; `place`: places in memory; `call`: what calls pass; `assertion`: assertions.

mod assertion;
mod call;
mod place;
mod statement;

use plcc_abi::image::{BlockKind, Config, Kept, Profile};
use plcc_abi::names::External;
use plcc_abi::ob::StartInput;
use plcc_abi::s7200::image::CpuRow;
use plcc_diag::Span;
pub use plcc_syntax::ast::{AddressRegister, AssertRegister, CellKind, SpecialRegister, StatusOperand, Width};

use crate::layout;
use crate::types::{DataType, Elementary, Member, ParameterType};
use crate::{s7200, scl};

pub use assertion::{Assert, AssertSide, Compared, ComparedValue, Comparison};
pub use call::{Actual, Argument, Call, Instance, Pointed};
pub use place::{ElementIndex, Place, PlaceArea};
pub use statement::{LabelId, Number, Operand, StlStatement, StlStatementKind};

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
    /// The block with code that `key` names; `None`: the program does not have it.
    pub fn block(&self, key: BlockKey) -> Option<&CodeBlock> {
        self.blocks.binary_search_by_key(&key, CodeBlock::key).ok().map(|index| &self.blocks[index])
    }

    /// Data block `number`; `None`: the program does not have it.
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
    /// What clients may do with it.
    pub external: External,
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
    /// Kind and number.
    pub fn key(&self) -> BlockKey {
        BlockKey { kind: self.kind, number: self.number }
    }

    /// True if this bit of the instance belongs to a library block and is a BOOL that has its byte to itself: the other bits mean nothing.
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
