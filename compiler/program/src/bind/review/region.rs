//! Fixed parts of memory, in bits.

use plcc_model::layout;
use plcc_model::scl::{Access, Base};
use plcc_model::types::DataType;
use plcc_model::{Place, PlaceArea};

/// A memory that shares no bit with another one, as far as a block knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Region {
    I,
    Q,
    M,
    PeripheralInput,
    PeripheralOutput,
    L,
    OpenDb,
    OpenDi,
    Db(u16),
    Instance,
    Parameter(usize),
    ThroughPointer(u32),
}

/// Bits of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Bits {
    pub region: Region,
    pub first: u64,
    /// After the last one.
    pub end: u64,
}

impl Bits {
    /// Of an element, all that its indices can choose. `None`: the address is only known at run time.
    pub fn at(place: &Place, bits: u64) -> Option<Bits> {
        let (region, byte, bit) = match place {
            Place::I { byte, bit } => (Region::I, byte, bit),
            Place::Q { byte, bit } => (Region::Q, byte, bit),
            Place::M { byte, bit } => (Region::M, byte, bit),
            Place::Pi { byte, bit } => (Region::PeripheralInput, byte, bit),
            Place::Pq { byte, bit } => (Region::PeripheralOutput, byte, bit),
            Place::L { byte, bit } => (Region::L, byte, bit),
            Place::OpenDb { byte, bit } => (Region::OpenDb, byte, bit),
            Place::OpenDi { byte, bit } => (Region::OpenDi, byte, bit),
            Place::Db { number, byte, bit } => (Region::Db(*number), byte, bit),
            Place::Instance { byte, bit } => (Region::Instance, byte, bit),
            Place::Parameter { parameter, byte, bit } => (Region::Parameter(*parameter), byte, bit),
            Place::ThroughPointer { pointer, byte, bit } => (Region::ThroughPointer(*pointer), byte, bit),
            Place::Element { base, indices } => {
                let reach: u64 = indices.iter().map(|index| u64::from(index.reach())).sum();
                return Bits::at(base, bits.saturating_add(reach));
            }
            Place::Indirect { .. } | Place::Register { .. } => return None,
        };
        let first = u64::from(*byte) * 8 + u64::from(*bit);
        Some(Bits { region, first, end: first.saturating_add(bits) })
    }

    /// All that an access may touch; `None`: the address is only known at run time.
    pub fn of(access: &Access) -> Option<Bits> {
        let Base::Place(place) = &access.base else { return None };
        let own = match &access.ty {
            DataType::Elementary(ty) => u64::from(ty.bits()),
            ty => u64::from(layout::bytes(ty)) * 8,
        };
        let mut bits = own.max(1);
        for index in &access.indices {
            match index.bounds.known() {
                Some((low, high)) => {
                    let steps = i64::from(high).saturating_sub(low.into()).max(0) as u64;
                    bits = bits.saturating_add(steps.saturating_mul(index.stride.into()));
                }
                None => bits = u64::MAX,
            }
        }
        Bits::at(place, bits)
    }

    /// To the end of its region.
    pub fn on(self) -> Bits {
        Bits { end: u64::MAX, ..self }
    }
}

/// True of a place that may be anywhere in an area.
pub fn may_be_in(place: &Place, wanted: PlaceArea) -> bool {
    match place {
        Place::Indirect { area, .. } => *area == wanted,
        Place::Register { area, .. } => area.is_none_or(|area| area == wanted),
        _ => false,
    }
}
