//! Types of named values: by them flags and scenarios find `"Station_DB".D1.Starts` and read it.

use serde::{Deserialize, Serialize};

use crate::image::AssertType;

/// Number of a type in [`ProgramImage::types`](crate::ProgramImage::types). A type has a larger number than those that it contains.
pub type TypeNumber = u32;

/// A type of named values.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum NamedType {
    /// A value without components.
    Value(AssertType),
    /// STRING or WSTRING, with the characters that it holds at most.
    Text {
        wide: bool,
        length: u16,
    },
    Array {
        dimensions: Vec<Dimension>,
        element: TypeNumber,
    },
    Struct(NamedStruct),
    /// Without a value that can be shown: a pointer, a parameter.
    Other {
        name: String,
    },
}

/// A dimension of an array.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Dimension {
    pub low: i32,
    pub high: i32,
    /// Bits from one element to the next.
    pub distance: u32,
}

/// A structure, a data type of the program, a DB or an instance in another one.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct NamedStruct {
    /// Of the data type or the FB; empty if it has none.
    pub name: String,
    /// The PLC data type of a data block as a whole; empty if it has none.
    pub data_type: String,
    pub members: Vec<NamedMember>,
    /// It is a DTL, which is also a value.
    pub is_dtl: bool,
}

/// What clients may do with a component that they name, by the attributes of its declaration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum External {
    /// `ExternalAccessible := 'False'`
    Hidden,
    /// `ExternalWritable := 'False'`
    Read,
    #[default]
    Write,
}

/// A component, relative to the start of its structure.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct NamedMember {
    pub name: String,
    pub ty: TypeNumber,
    pub byte: u32,
    pub bit: u8,
    pub external: External,
}

/// A place that code of the program names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct UsedPlace {
    pub area: UsedArea,
    /// Of a timer or counter its number.
    pub byte: u32,
    pub bit: u8,
    /// 1, 8, 16, 32 or 64.
    pub bits: u8,
}

/// Where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum UsedArea {
    Input,
    Output,
    BitMemory,
    Timer,
    Counter,
    Db(u16),
    PeripheralInput,
    PeripheralOutput,
    /// Of an S7-200.
    AnalogInput,
    AnalogOutput,
    SpecialMemory,
    Relays,
    HighSpeedCounter,
}

/// Marks the number of a structure or an array in a VARIANT.
const STRUCTURE: u32 = 1 << 31;

/// The number by which a VARIANT knows a structure or function block of this name, in any letter case.
pub fn structure_number(name: &str) -> u32 {
    let letters: Vec<u32> = name.chars().flat_map(char::to_uppercase).map(u32::from).collect();
    compound_number(0x8002, &letters)
}

/// The number by which a VARIANT knows a type that consists of others: `kind` and what makes it different, by FNV-1a.
pub fn compound_number(kind: u32, words: &[u32]) -> u32 {
    let step = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    let bytes = std::iter::once(&kind).chain(words).flat_map(|word| word.to_be_bytes());
    bytes.fold(0x811C_9DC5, step) | STRUCTURE
}
