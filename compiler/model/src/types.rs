//! Data types with their layouts.

use std::rc::Rc;

use plcc_abi::image::AssertType;
use plcc_abi::names::External;
pub use plcc_syntax::{Class, Elementary};

/// Types that only parameters have.
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
    /// An ANY followed by the number and type of its elements, 18 bytes. See [`crate::layout::VARIANT_ELEMENTS`].
    Variant,
}

/// Name of the structure for date and time of S7-1200/1500, 12 bytes.
pub const DTL: &str = "DTL";

/// A data type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DataType {
    Elementary(Elementary),
    /// 8 bytes.
    DateAndTime,
    /// Maximum length; 2 more bytes in memory.
    String(u8),
    /// Maximum length in characters of two bytes; 4 more bytes in memory, two words.
    WideString(u16),
    Array(Rc<ArrayType>),
    Struct(Rc<StructType>),
    Parameter(ParameterType),
    /// `ARRAY[*]`, a formal parameter that gets its bounds from the actual.
    OpenArray(Rc<OpenArrayType>),
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

/// An array with bounds that are known at run time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenArrayType {
    pub dimensions: u8,
    pub element: DataType,
}

/// A structure, a UDT, or the instance memory of an FB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructType {
    /// `UDT 5`, `FB 10`, a symbol; empty for an anonymous STRUCT.
    pub name: String,
    /// For an FB or SFB instance: its number and whether it is an SFB.
    pub instance_of: Option<(bool, u16)>,
    /// For a reference (REF_TO): the type of what it refers to.
    pub refers_to: Option<DataType>,
    pub members: Vec<Member>,
    /// Rounded up to even.
    pub bytes: u32,
}

/// A component with its address, relative to the start of the structure.
#[derive(Clone, Debug)]
pub struct Member {
    pub name: String,
    pub ty: DataType,
    pub byte: u32,
    pub bit: u8,
    pub external: External,
}

/// What clients may do does not make another type.
impl PartialEq for Member {
    fn eq(&self, other: &Member) -> bool {
        (&self.name, &self.ty, self.byte, self.bit) == (&other.name, &other.ty, other.byte, other.bit)
    }
}

impl Eq for Member {}

/// What values of an elementary type are at run time.
pub const fn value_type(ty: Elementary) -> AssertType {
    match ty {
        Elementary::Bool => AssertType::Bool,
        Elementary::Byte | Elementary::Word | Elementary::Dword | Elementary::Lword => {
            AssertType::Bits(ty.bits() as u8)
        }
        Elementary::Sint | Elementary::Int | Elementary::Dint | Elementary::Lint => AssertType::Signed(ty.bits() as u8),
        Elementary::Usint | Elementary::Uint | Elementary::Udint | Elementary::Ulint => {
            AssertType::Unsigned(ty.bits() as u8)
        }
        Elementary::Char => AssertType::Char,
        Elementary::Wchar => AssertType::Wchar,
        Elementary::Real => AssertType::Real,
        Elementary::Lreal => AssertType::Lreal,
        Elementary::S5Time => AssertType::S5Time,
        Elementary::Time => AssertType::Time,
        Elementary::Ltime => AssertType::Ltime,
        Elementary::Date => AssertType::Date,
        Elementary::TimeOfDay => AssertType::TimeOfDay,
        Elementary::Ltod => AssertType::Ltod,
        Elementary::Ldt => AssertType::Ldt,
    }
}
