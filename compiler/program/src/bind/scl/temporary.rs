//! Texts in VAR_TEMP, whose headers are set when a block begins. Source: SCL reference, strings.

use crate::bind::declarations::path::Base;
use crate::bind::declarations::typed::BoundInterface;
use plcc_model::layout;
use plcc_model::scl::TemporaryText;
use plcc_model::types::DataType;

/// More elements are not checked: no local data has room for so many texts.
const ELEMENTS_MAX: u64 = 16_384;

/// All STRING and WSTRING variables in local data, also inside of structures and arrays, by address.
pub fn texts(bound: &BoundInterface) -> Vec<TemporaryText> {
    let mut found = Vec::new();
    for local in bound.locals.values().filter(|local| local.base == Base::L) {
        collect(&local.ty, local.byte, &mut found);
    }
    found.sort_unstable_by_key(|text| text.byte);
    // A view of a text shares its memory.
    found.dedup_by_key(|text| text.byte);
    found
}

fn collect(ty: &DataType, byte: u32, found: &mut Vec<TemporaryText>) {
    match ty {
        DataType::String(maximum) => found.push(TemporaryText { byte, maximum: u16::from(*maximum), wide: false }),
        DataType::WideString(maximum) => found.push(TemporaryText { byte, maximum: *maximum, wide: true }),
        DataType::Struct(structure) => {
            structure.members.iter().for_each(|member| collect(&member.ty, byte + member.byte, found));
        }
        DataType::Array(array) if may_hold_text(&array.element) => {
            let count = layout::element_count(&array.bounds).min(ELEMENTS_MAX);
            for index in 0..count {
                let (distance, _) = layout::element_place(array, index);
                collect(&array.element, byte + distance, found);
            }
        }
        DataType::Array(_)
        | DataType::Elementary(_)
        | DataType::DateAndTime
        | DataType::Parameter(_)
        | DataType::OpenArray(_)
        | DataType::Void => {}
    }
}

fn may_hold_text(ty: &DataType) -> bool {
    matches!(ty, DataType::String(_) | DataType::WideString(_) | DataType::Struct(_) | DataType::Array(_))
}
