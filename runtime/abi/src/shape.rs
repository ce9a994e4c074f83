//! What the data of a program looks like, for blocks that write it to files with its names.

use serde::{Deserialize, Serialize};

use crate::image::AssertType;

/// Numbers of the SFBs of the library that need the shapes of DBs: data logs and recipes.
pub const USERS: std::ops::RangeInclusive<u16> = 1700..=1708;

/// The components of a data block.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DbShape {
    pub number: u16,
    pub parts: Vec<Part>,
}

/// A component of a structure.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    pub name: String,
    /// From the start of the structure.
    pub byte: u32,
    pub bit: u8,
    pub shape: Shape,
}

/// The form of a variable.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shape {
    /// A value of so many bytes; of a BOOL one bit.
    Value {
        ty: AssertType,
        bytes: u32,
    },
    Array(ArrayShape),
    Struct {
        bytes: u32,
        parts: Vec<Part>,
    },
    /// Not a value: a parameter that points elsewhere.
    Other {
        bytes: u32,
    },
}

/// The form of an array.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArrayShape {
    /// Low bound and number of elements of each dimension; the last one runs fastest.
    pub dimensions: Vec<(i32, u32)>,
    pub bytes: u32,
    /// Elements that follow each other without a gap.
    pub row: u32,
    /// From one row to the next.
    pub row_bits: u32,
    /// From one element of a row to the next.
    pub element_bits: u32,
    pub element: Box<Shape>,
}

impl ArrayShape {
    pub fn count(&self) -> u32 {
        self.dimensions.iter().fold(1, |count: u32, (_, length)| count.saturating_mul(*length))
    }

    /// Bits from the start of the array to element `index`, counted from 0.
    pub fn place(&self, index: u32) -> u32 {
        let row = self.row.max(1);
        (index / row) * self.row_bits + (index % row) * self.element_bits
    }

    /// `[1,2]`
    pub fn index_text(&self, mut index: u32) -> String {
        let mut parts = Vec::new();
        for (low, length) in self.dimensions.iter().rev() {
            parts.push((i64::from(*low) + i64::from(index % (*length).max(1))).to_string());
            index /= (*length).max(1);
        }
        parts.reverse();
        format!("[{}]", parts.join(","))
    }
}

impl Shape {
    pub fn bytes(&self) -> u32 {
        match self {
            Shape::Value { bytes, .. } | Shape::Struct { bytes, .. } | Shape::Other { bytes } => *bytes,
            Shape::Array(array) => array.bytes,
        }
    }
}
