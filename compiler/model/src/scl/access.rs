//! Places that code reads, writes or passes, and their run-time indices.

use plcc_diag::Span;
use plcc_syntax::Elementary;

use super::Expr;
use crate::types::DataType;
use crate::{Place, PlaceArea, Width};

/// A place in memory that code reads, writes or passes.
#[derive(Clone, Debug)]
pub struct Access {
    pub base: Base,
    /// Run-time indices, in source order. Their distances from the lowest elements add to the base.
    pub indices: Vec<Index>,
    /// The type there, before `part`.
    pub ty: DataType,
    /// A slice `.%X3` of it.
    pub part: Option<Part>,
    pub span: Span,
}

impl Access {
    /// The elementary type that is read or written, including the slice: BOOL, BYTE, WORD, DWORD for slices. None if it is complex.
    pub fn elementary(&self) -> Option<Elementary> {
        match self.part {
            Some(part) => Some(match part.width {
                Width::Bit => Elementary::Bool,
                Width::Byte => Elementary::Byte,
                Width::Word => Elementary::Word,
                Width::Dword => Elementary::Dword,
                Width::Lword => Elementary::Lword,
            }),
            None => match self.ty {
                DataType::Elementary(ty) => Some(ty),
                _ => None,
            },
        }
    }
}

/// Where an access begins.
#[derive(Clone, Debug)]
pub enum Base {
    /// Never an open DB, never register-indirect.
    Place(Place),
    /// `MW[i]`, `M[b, i]`, `DB10.DW[i]`, PEEK, POKE.
    Indexed {
        area: IndexedArea,
        /// DINT: the byte address.
        byte: Box<Expr>,
        /// INT or DINT: bit number; others than 0..=7 are an error of OB 121. Only for a BOOL.
        bit: Option<Box<Expr>>,
    },
}

/// The memory in which an address is computed.
#[derive(Clone, Debug)]
pub enum IndexedArea {
    /// I, Q, M, PI, PQ.
    Memory(PlaceArea),
    Db(u16),
    /// WORD: the number of the DB, known at run time.
    DynamicDb(Box<Expr>),
    /// BYTE: the area in the code of PEEK (16#81 I, 16#82 Q, 16#83 M, 16#84 DB, 1 PI, 2 PQ), and WORD: the number of the DB.
    Coded {
        area: Box<Expr>,
        db: Box<Expr>,
    },
}

/// A run-time index of one dimension.
#[derive(Clone, Debug)]
pub struct Index {
    /// DINT.
    pub value: Expr,
    pub bounds: IndexBounds,
    /// Distance of adjacent elements, in bits.
    pub stride: u32,
}

/// The values that an index may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndexBounds {
    /// Inclusive.
    Known(i32, i32),
    /// A bound of the ARRAY[*] formal `parameter`, in its dimension. Distances of all but the last dimension are multiplied by the lengths of
    /// the later ones; `stride` is that of an element.
    Open { parameter: usize, dimension: u8 },
    /// Characters of a text, from 1 on. One beyond its end reads 0 and is not written, without a fault. `length`: how many characters the
    /// text is declared with; `in_head`: its head, before the first character, may say fewer, as for a formal parameter.
    Characters { length: i32, in_head: bool },
}

impl IndexBounds {
    /// Inclusive; `None`: they are only known when the program runs.
    pub const fn known(self) -> Option<(i32, i32)> {
        match self {
            IndexBounds::Known(low, high) => Some((low, high)),
            IndexBounds::Open { .. } => None,
            IndexBounds::Characters { length, .. } => Some((1, length)),
        }
    }
}

/// A part of a bit string or integer, by value: 0 is the lowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    pub width: Width,
    pub index: u8,
}
