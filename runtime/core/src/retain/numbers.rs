//! The numbers of steps and transitions among the data of a block. A chart counts its steps by their places, so what is kept of it means other
//! steps when the numbers stand at other places: they belong to the layout as names do, which an array of steps does not have.
//!
//! Source: GRAPH reference, chapter F, data of steps and transitions.

use plcc_abi::image::DbEntry;
use plcc_abi::names::{NamedMember, NamedType, TypeNumber};

use super::places::places;

/// The members with the number of a step and of a transition, and what these have besides.
const NUMBERS: [(&str, &str); 2] = [("SNO", "LA"), ("TNO", "TV")];

/// The numbers with which a block begins, in the order of its data.
pub(super) fn numbers(db: &DbEntry, types: &[NamedType]) -> Vec<u16> {
    let found = db.ty.map_or_else(Vec::new, |ty| places(types, ty, &|ty| number_of(ty).is_some()));
    let value = |(bit, ty): (u64, TypeNumber)| {
        let at = (bit / 8) as usize + number_of(types.get(ty as usize)?)?.byte as usize;
        db.data.get(at..at + 2).map(|bytes| u16::from_be_bytes([bytes[0], bytes[1]]))
    };
    found.into_iter().filter_map(value).collect()
}

/// The number of a step or a transition, if the type is one.
fn number_of(ty: &NamedType) -> Option<&NamedMember> {
    let NamedType::Struct(structure) = ty else { return None };
    let member = |name: &str| structure.members.iter().find(|member| member.name == name);
    NUMBERS.iter().find_map(|(number, other)| member(other).and_then(|_| member(number)))
}

#[cfg(test)]
mod tests {
    use plcc_abi::image::{AssertType, Kept};
    use plcc_abi::names::{Dimension, External, NamedStruct};

    use super::*;

    #[test]
    fn numbers_of_charts_are_found_in_arrays_and_structures() {
        let external = External::default();
        let member = |name: &str, ty, byte| NamedMember { name: name.to_string(), ty, byte, bit: 0, external };
        let structure = |members| {
            NamedType::Struct(NamedStruct { name: String::new(), data_type: String::new(), members, is_dtl: false })
        };
        let dimension = Dimension { low: 1, high: 2, distance: 32 };
        let types = [
            NamedType::Value(AssertType::Signed(16)),
            structure(vec![member("LA", 0, 0), member("SNO", 0, 2)]),
            NamedType::Array { dimensions: vec![dimension], element: 1 },
            // Of a user, without the rest of a step.
            structure(vec![member("SNO", 0, 0)]),
            structure(vec![member("G7S", 2, 0), member("own", 3, 8), member("one", 1, 10)]),
        ];
        let db = DbEntry {
            number: 1,
            name: String::new(),
            address: 0,
            data: vec![0, 0, 0, 30, 0, 0, 0, 10, 0, 99, 0, 0, 0, 20],
            read_only: false,
            unlinked: false,
            optimized: false,
            kept: Kept::Everything,
            ty: Some(4),
        };
        assert_eq!(numbers(&db, &types), [30, 10, 20]);
    }
}
