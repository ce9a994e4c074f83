//! Where parts of a type are.

use plcc_abi::names::{NamedMember, NamedType, TypeNumber};

/// The parts of a type that are wanted: their places in bits from its beginning and their types, in the order of its data. Nothing is looked
/// for within one of them.
pub(super) fn places(
    types: &[NamedType],
    ty: TypeNumber,
    is_wanted: &dyn Fn(&NamedType) -> bool,
) -> Vec<(u64, TypeNumber)> {
    let mut found = Vec::new();
    if has(types, ty, is_wanted) {
        collect(types, (0, ty), is_wanted, &mut found);
    }
    found
}

/// A type has a larger number than those that it contains.
fn has(types: &[NamedType], ty: TypeNumber, is_wanted: &dyn Fn(&NamedType) -> bool) -> bool {
    let is_within = |inner: TypeNumber| inner < ty && has(types, inner, is_wanted);
    types.get(ty as usize).is_some_and(|own| {
        is_wanted(own)
            || match own {
                NamedType::Struct(all) => all.members.iter().any(|member| is_within(member.ty)),
                NamedType::Array { element, .. } => is_within(*element),
                NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. } => false,
            }
    })
}

/// Those of a type that has some, which begins at `bit`.
fn collect(
    types: &[NamedType],
    (bit, ty): (u64, TypeNumber),
    is_wanted: &dyn Fn(&NamedType) -> bool,
    found: &mut Vec<(u64, TypeNumber)>,
) {
    match types.get(ty as usize) {
        Some(own) if is_wanted(own) => found.push((bit, ty)),
        Some(NamedType::Struct(all)) => {
            let has_some = |member: &&NamedMember| member.ty < ty && has(types, member.ty, is_wanted);
            for member in all.members.iter().filter(has_some) {
                collect(types, (bit + 8 * u64::from(member.byte), member.ty), is_wanted, found);
            }
        }
        Some(NamedType::Array { dimensions, element }) => {
            let mut starts = vec![bit];
            for dimension in dimensions {
                let count = (i64::from(dimension.high) - i64::from(dimension.low) + 1).max(0) as u64;
                let row = |start: &u64| {
                    let start = *start;
                    (0..count).map(move |index| start + index * u64::from(dimension.distance))
                };
                starts = starts.iter().flat_map(row).collect();
            }
            starts.into_iter().for_each(|start| collect(types, (start, *element), is_wanted, found));
        }
        Some(NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. }) | None => {}
    }
}
