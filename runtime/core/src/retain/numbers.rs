//! The numbers of steps and transitions among the data of a block. A chart counts its steps by their places, so what is kept of it means other
//! steps when the numbers stand at other places: they belong to the layout as names do, which an array of steps does not have.
//!
//! Source: GRAPH reference, chapter F, data of steps and transitions.

use plcc_abi::image::DbEntry;
use plcc_abi::names::{NamedMember, NamedStruct, NamedType, TypeNumber};

/// The members with the number of a step and of a transition, and what these have besides.
const NUMBERS: [(&str, &str); 2] = [("SNO", "LA"), ("TNO", "TV")];

/// The numbers with which a block begins, in the order of its data.
pub(super) fn numbers(db: &DbEntry, types: &[NamedType]) -> Vec<u16> {
    let mut found = Vec::new();
    if let Some(ty) = db.ty.filter(|ty| has_numbers(*ty, types)) {
        collect(&db.data, types, ty, 0, &mut found);
    }
    found
}

/// The number of a step or a transition, if the structure is one.
fn number_of(structure: &NamedStruct) -> Option<&NamedMember> {
    let member = |name: &str| structure.members.iter().find(|member| member.name == name);
    NUMBERS.iter().find_map(|(number, other)| member(other).and_then(|_| member(number)))
}

/// A type has a larger number than those that it contains.
fn has_numbers(ty: TypeNumber, types: &[NamedType]) -> bool {
    match types.get(ty as usize) {
        Some(NamedType::Struct(all)) => {
            let is_within = |member: &NamedMember| member.ty < ty && has_numbers(member.ty, types);
            number_of(all).is_some() || all.members.iter().any(is_within)
        }
        Some(NamedType::Array { element, .. }) => *element < ty && has_numbers(*element, types),
        Some(NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. }) | None => false,
    }
}

/// Those of a type with numbers, `bit` bits from the beginning of the block.
fn collect(data: &[u8], types: &[NamedType], ty: TypeNumber, bit: u64, found: &mut Vec<u16>) {
    match types.get(ty as usize) {
        Some(NamedType::Struct(all)) => {
            if let Some(number) = number_of(all) {
                let at = (bit / 8) as usize + number.byte as usize;
                found.extend(data.get(at..at + 2).map(|bytes| u16::from_be_bytes([bytes[0], bytes[1]])));
            }
            for member in all.members.iter().filter(|member| member.ty < ty && has_numbers(member.ty, types)) {
                collect(data, types, member.ty, bit + 8 * u64::from(member.byte), found);
            }
        }
        Some(NamedType::Array { dimensions, element }) if *element < ty => {
            let mut starts = vec![bit];
            for dimension in dimensions {
                let count = (i64::from(dimension.high) - i64::from(dimension.low) + 1).max(0) as u64;
                let row = |start: &u64| {
                    let start = *start;
                    (0..count).map(move |index| start + index * u64::from(dimension.distance))
                };
                starts = starts.iter().flat_map(row).collect();
            }
            starts.into_iter().for_each(|start| collect(data, types, *element, start, found));
        }
        Some(NamedType::Array { .. } | NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. })
        | None => {}
    }
}

#[cfg(test)]
mod tests {
    use plcc_abi::image::{AssertType, Kept};
    use plcc_abi::names::Dimension;

    use super::*;

    #[test]
    fn numbers_of_charts_are_found_in_arrays_and_structures() {
        let member = |name: &str, ty, byte| NamedMember { name: name.to_string(), ty, byte, bit: 0 };
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
