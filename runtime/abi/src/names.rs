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
    pub members: Vec<NamedMember>,
    /// It is a DTL, which is also a value.
    pub is_dtl: bool,
}

/// A component, relative to the start of its structure.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct NamedMember {
    pub name: String,
    pub ty: TypeNumber,
    pub byte: u32,
    pub bit: u8,
}

/// A place that code of the program names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct UsedPlace {
    pub area: UsedArea,
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
    Db(u16),
}
