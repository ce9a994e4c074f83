//! The layout of data blocks: components with their addresses.

use plcc_model::types::{DataType, Member};

use crate::book::Declaration;

/// Rows of a page: more components are left out, and the last row says so.
pub const ROWS_MAX: usize = 5_000;

/// Adds a row for each component. `db`: none for components of the elements of an array, whose addresses differ.
pub fn members(db: Option<u16>, list: &[Member], base: u32, depth: usize, rows: &mut Vec<Declaration>) {
    for member in list {
        if rows.len() == ROWS_MAX {
            rows.push(Declaration {
                name: "…".to_string(),
                comment: "more components".to_string(),
                ..Declaration::default()
            });
        }
        if rows.len() > ROWS_MAX {
            return;
        }
        let byte = base.saturating_add(member.byte);
        rows.push(Declaration {
            name: member.name.clone(),
            ty: type_text(&member.ty),
            address: db.map_or_else(String::new, |db| address(db, &member.ty, byte, member.bit)),
            depth,
            ..Declaration::default()
        });
        if let DataType::Struct(structure) = &member.ty {
            members(db, &structure.members, byte, depth + 1, rows);
        } else if let Some(list) = of_elements(&member.ty) {
            members(None, list, 0, depth + 1, rows);
        }
    }
}

/// The components of the elements of an array, if these have a structure without a name.
fn of_elements(ty: &DataType) -> Option<&[Member]> {
    let DataType::Array(array) = ty else { return None };
    match &array.element {
        DataType::Struct(structure) => structure.name.is_empty().then_some(structure.members.as_slice()),
        element => of_elements(element),
    }
}

/// `DB5.DBX2.0`, `DB5.DBW4`; of a structure its first byte.
pub fn address(db: u16, ty: &DataType, byte: u32, bit: u8) -> String {
    let bits = match ty {
        DataType::Elementary(elementary) => elementary.bits(),
        DataType::DateAndTime
        | DataType::String(_)
        | DataType::WideString(_)
        | DataType::Array(_)
        | DataType::Struct(_)
        | DataType::Parameter(_)
        | DataType::OpenArray(_)
        | DataType::Void => 0,
    };
    match bits {
        1 => format!("DB{db}.DBX{byte}.{bit}"),
        16 => format!("DB{db}.DBW{byte}"),
        32 => format!("DB{db}.DBD{byte}"),
        64 => format!("DB{db}.DBL{byte}"),
        _ => format!("DB{db}.DBB{byte}"),
    }
}

/// `INT`, `ARRAY[1..3] OF BOOL`, `"Motor"`.
fn type_text(ty: &DataType) -> String {
    match ty {
        DataType::Elementary(elementary) => elementary.name().to_string(),
        DataType::DateAndTime => "DATE_AND_TIME".to_string(),
        DataType::String(length) => format!("STRING[{length}]"),
        DataType::WideString(length) => format!("WSTRING[{length}]"),
        DataType::Array(array) => {
            let bounds: Vec<String> = array.bounds.iter().map(|(low, high)| format!("{low}..{high}")).collect();
            format!("ARRAY[{}] OF {}", bounds.join(","), type_text(&array.element))
        }
        DataType::Struct(structure) if structure.name.is_empty() => "STRUCT".to_string(),
        DataType::Struct(structure) => structure.name.clone(),
        DataType::Parameter(parameter) => format!("{parameter:?}").to_uppercase(),
        DataType::OpenArray(array) => format!("ARRAY[*] OF {}", type_text(&array.element)),
        DataType::Void => "VOID".to_string(),
    }
}
