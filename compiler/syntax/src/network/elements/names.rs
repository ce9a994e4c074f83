//! Elements by their names in the file formats.

use super::{Kind, Row, elements};

/// The element of that name in SIMATIC SD. `negated`: the name says that the operand is negated (`I_Contact`).
pub fn find_sd(name: &str) -> Option<(&'static Row, bool)> {
    let is = |known: &str| known.eq_ignore_ascii_case(name);
    if let Some((_, row)) = NEGATED_SD.iter().find(|(negated, _)| is(negated)) {
        return elements().find(|known| known.name == *row).map(|row| (row, true));
    }
    elements().find(|row| is(row.name) || row.sd.iter().any(|known| is(known))).map(|row| (row, false))
}

/// The name in SIMATIC SD that `name` is probably meant to be.
pub fn nearest_sd(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let limit = if name.len() < 4 { 1 } else { 2 };
    let names = || {
        let negated = NEGATED_SD.iter().map(|(negated, _)| *negated);
        elements().flat_map(|row| row.sd.iter().copied().chain([row.name])).chain(negated)
    };
    // `SCoil` is `S_Coil` rather than `Coil`.
    if let Some(known) = names().find(|known| known.replace('_', "").eq_ignore_ascii_case(&name)) {
        return Some(known);
    }
    // What is before these words says what the element does: `NCContact` is not `N_Contact`.
    let before = ["contact", "coil"].into_iter().find_map(|word| name.strip_suffix(word));
    if before.is_some_and(|before| !before.is_empty()) {
        return None;
    }
    names()
        .map(|known| (crate::distance::between(&name, &known.to_lowercase()), known))
        .filter(|(distance, _)| *distance <= limit)
        // `Mov` is `Move` rather than `Mod`.
        .min_by_key(|(distance, known)| (*distance, !known.to_lowercase().starts_with(&name)))
        .map(|(_, known)| known)
}

/// The element of that name in SimaticML.
pub fn find_xml(name: &str) -> Option<&'static Row> {
    let find = |of: fn(&'static Row) -> &'static [&'static str]| {
        elements().find(|row| of(row).iter().any(|known| known.eq_ignore_ascii_case(name)))
    };
    let instance = || find(|row| row.open).filter(|row| matches!(row.kind, Kind::Instance(_)));
    // Versions of the TIA Portal differ in spelling; many names are those of SIMATIC SD. `SCALE` is a block of a library, so letter case matters.
    let sd = || elements().find(|row| row.name == name || row.sd.contains(&name));
    find(|row| row.xml).or_else(instance).or_else(sd)
}

/// The element of that name in PLCopen XML: a standard function or function block.
pub fn find_open(name: &str) -> Option<&'static Row> {
    elements().find(|row| row.open.iter().any(|known| known.eq_ignore_ascii_case(name)))
}

/// Names in SIMATIC SD that mean an element with a negated operand.
const NEGATED_SD: &[(&str, &str)] = &[("I_Contact", "Contact"), ("I_Coil", "Coil")];
