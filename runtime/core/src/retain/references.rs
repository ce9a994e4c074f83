//! References to variables (REF_TO) among retentive data of an S7-1200/1500. They name a data block by its number, which the compiler gives, so
//! another version of the program may have another block with this number. Such a reference begins with its initial value, as after a change
//! of the running program.

use plcc_abi::image::DbEntry;
use plcc_abi::names::{NamedType, TypeNumber};

use super::places::places;

/// How the names of their types begin.
const REFERENCE: &str = "REF_TO ";
/// Bytes of a reference; the first two are the number of the data block, 0 without one.
const BYTES: usize = 8;

/// A reference in a data block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Reference {
    /// Offset from the memory base.
    pub at: u32,
    /// What it begins with.
    pub initial: Vec<u8>,
}

/// Those of a data block.
pub(super) fn references(db: &DbEntry, types: &[NamedType]) -> Vec<Reference> {
    let is_reference = |ty: &NamedType| match ty {
        NamedType::Struct(structure) => structure.name.starts_with(REFERENCE),
        NamedType::Other { name } => name.starts_with(REFERENCE),
        NamedType::Value(_) | NamedType::Text { .. } | NamedType::Array { .. } => false,
    };
    let found = db.ty.map_or_else(Vec::new, |ty| places(types, ty, &is_reference));
    let reference = |(bit, _): (u64, TypeNumber)| {
        let at = (bit / 8) as usize;
        let initial = db.data.get(at..at + BYTES)?.to_vec();
        Some(Reference { at: db.address + at as u32, initial })
    };
    found.into_iter().filter_map(reference).collect()
}
