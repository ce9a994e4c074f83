//! Places in memory, and elements of arrays at them.

use plcc_syntax::ast::AddressRegister;
pub use plcc_syntax::ast::Area as PlaceArea;

use crate::types::Elementary;

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
