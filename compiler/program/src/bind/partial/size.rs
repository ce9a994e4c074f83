//! How large stand-ins are: an array whose indices are found at run time has as many elements as a data block has room for.

use super::evidence::{Elements, Shape};
use super::types::{elementary_of, has_components, text_of};
use plcc_model::layout;
use plcc_model::types::DataType;

/// Last index of an array whose indices are all found at run time.
const OPEN_INDEX: i64 = 99;

/// Bytes that the elements of such an array may need, if none of them was seen: a data block has 64 KB.
const OPEN_BYTES: u64 = 28_000;

/// Bytes for an instance of another block.
const INSTANCE_BYTES: u64 = 64;

/// The bounds of an array, and the bytes that it needs.
pub fn array(elements: &Elements) -> (Vec<(i64, i64)>, u64) {
    let element = bytes(&elements.shape).max(1);
    let lowest = if elements.open { 0 } else { 1 };
    let mut bounds: Vec<(i64, i64)> = elements.bounds.iter().map(|(low, high)| ((*low).min(lowest), *high)).collect();
    if elements.open {
        let dimensions = u32::try_from(bounds.len()).unwrap_or(u32::MAX);
        let fitting = (OPEN_BYTES / element).max(1);
        let lowest = bounds.iter().map(|(low, _)| *low).min().unwrap_or(0);
        let wanted = OPEN_INDEX.abs_diff(lowest).saturating_add(1).min(fitting);
        let count = (1..=wanted).rev().find(|count| count.saturating_pow(dimensions) <= fitting).unwrap_or(1);
        for (low, high) in &mut bounds {
            *high = (*high).max(low.saturating_add_unsigned(count - 1).min(OPEN_INDEX));
        }
    }
    let counts = bounds.iter().map(|(low, high)| high.abs_diff(*low).saturating_add(1));
    let total = counts.fold(element, u64::saturating_mul);
    (bounds, total.saturating_add(total & 1))
}

/// Bytes that a stand-in needs, or a few more.
pub fn bytes(shape: &Shape) -> u64 {
    if shape.of.is_some() {
        return INSTANCE_BYTES;
    }
    if !shape.members.is_empty() && !has_components(shape) {
        let members = shape.members.iter().map(|(_, member)| bytes(member));
        return members.fold(0, |sum: u64, bytes| sum.saturating_add(bytes).saturating_add(bytes & 1));
    }
    let of_type = |ty: &DataType| u64::from(layout::bytes(ty));
    match (&shape.elements, &shape.ty) {
        (_, Some(ty @ (DataType::Array(_) | DataType::String(_) | DataType::WideString(_)))) => of_type(ty),
        (Some(elements), ty) => match text_of(shape, elements).filter(|_| ty.is_none()) {
            Some(text) => of_type(text),
            None => array(elements).1,
        },
        (None, Some(ty)) => of_type(ty),
        (None, None) => match (elementary_of(shape), &shape.literal) {
            (Some(ty), _) => u64::from(ty.bits().div_ceil(8)),
            (None, Some(ty)) => of_type(ty),
            (None, None) => 2,
        },
    }
}
