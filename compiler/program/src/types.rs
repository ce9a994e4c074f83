//! Data types with their layouts.

use std::rc::Rc;

/// Elementary types.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Elementary {
    Bool,
    Byte,
    Word,
    Dword,
    Char,
    Int,
    Dint,
    Real,
    S5Time,
    Time,
    Date,
    TimeOfDay,
}

impl Elementary {
    pub const ALL: [Elementary; 12] = [
        Elementary::Bool,
        Elementary::Byte,
        Elementary::Word,
        Elementary::Dword,
        Elementary::Char,
        Elementary::Int,
        Elementary::Dint,
        Elementary::Real,
        Elementary::S5Time,
        Elementary::Time,
        Elementary::Date,
        Elementary::TimeOfDay,
    ];

    /// Size in bits; 1 for BOOL.
    pub const fn bits(self) -> u32 {
        match self {
            Elementary::Bool => 1,
            Elementary::Byte | Elementary::Char => 8,
            Elementary::Word | Elementary::Int | Elementary::S5Time | Elementary::Date => 16,
            Elementary::Dword | Elementary::Dint | Elementary::Real | Elementary::Time | Elementary::TimeOfDay => 32,
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            Elementary::Bool => "BOOL",
            Elementary::Byte => "BYTE",
            Elementary::Word => "WORD",
            Elementary::Dword => "DWORD",
            Elementary::Char => "CHAR",
            Elementary::Int => "INT",
            Elementary::Dint => "DINT",
            Elementary::Real => "REAL",
            Elementary::S5Time => "S5TIME",
            Elementary::Time => "TIME",
            Elementary::Date => "DATE",
            Elementary::TimeOfDay => "TIME_OF_DAY",
        }
    }
}

/// Types that exist for parameters only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ParameterType {
    Timer,
    Counter,
    BlockFb,
    BlockFc,
    BlockDb,
    BlockSdb,
    /// 6 bytes.
    Pointer,
    /// 10 bytes.
    Any,
}

/// A data type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DataType {
    Elementary(Elementary),
    /// 8 bytes.
    DateAndTime,
    /// Largest length; 2 more bytes in memory.
    String(u8),
    Array(Rc<ArrayType>),
    Struct(Rc<StructType>),
    Parameter(ParameterType),
    /// VOID, the type of an FC without a result.
    Void,
}

/// An array. Bounds are inclusive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArrayType {
    pub bounds: Vec<(i32, i32)>,
    pub element: DataType,
    /// Bytes in memory, rounded up to even.
    pub bytes: u32,
}

/// A structure, a UDT, or the instance memory of an FB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructType {
    /// `UDT 5`, `FB 10`, a symbol; empty for an anonymous STRUCT.
    pub name: String,
    /// For an FB or SFB instance: its number and whether it is an SFB.
    pub instance_of: Option<(bool, u16)>,
    pub members: Vec<Member>,
    /// Rounded up to even.
    pub bytes: u32,
}

/// A component with its place, relative to the start of the structure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    pub name: String,
    pub ty: DataType,
    pub byte: u32,
    pub bit: u8,
}
