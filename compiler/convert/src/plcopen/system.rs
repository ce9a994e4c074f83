//! Function blocks and functions of the system with a counterpart in IEC 61131-3.

use plcc_syntax::Elementary;
use plcc_syntax::ast::Width;

/// The standard function block of a type of instances.
pub fn block(word: &str) -> Option<&'static str> {
    const BLOCKS: &[(&str, &str)] = &[
        ("TON", "TON"),
        ("TON_TIME", "TON"),
        ("TOF", "TOF"),
        ("TOF_TIME", "TOF"),
        ("TP", "TP"),
        ("TP_TIME", "TP"),
        ("TON_IEC", "TON"),
        ("TOF_IEC", "TOF"),
        ("TP_IEC", "TP"),
        ("R_TRIG", "R_TRIG"),
        ("F_TRIG", "F_TRIG"),
        ("IEC_F_TRIG", "F_TRIG"),
        ("CTU", "CTU"),
        ("CTU_INT", "CTU"),
        ("CTD", "CTD"),
        ("CTD_INT", "CTD"),
        ("CTUD", "CTUD"),
        ("CTUD_INT", "CTUD"),
        ("CTU_DINT", "CTU_DINT"),
        ("CTD_DINT", "CTD_DINT"),
        ("CTUD_DINT", "CTUD_DINT"),
        ("CTU_UDINT", "CTU_UDINT"),
        ("CTD_UDINT", "CTD_UDINT"),
        ("CTUD_UDINT", "CTUD_UDINT"),
        ("IEC_CTU", "CTU"),
        ("IEC_CTU_INT", "CTU"),
        ("IEC_CTD_INT", "CTD"),
        ("IEC_CTUD", "CTUD"),
        ("IEC_CTUD_INT", "CTUD"),
        ("IEC_CTU_DINT", "CTU_DINT"),
        ("IEC_CTD_DINT", "CTD_DINT"),
        ("IEC_CTUD_DINT", "CTUD_DINT"),
        ("IEC_CTU_UDINT", "CTU_UDINT"),
        ("IEC_CTD_UDINT", "CTD_UDINT"),
        ("IEC_CTUD_UDINT", "CTUD_UDINT"),
    ];
    BLOCKS.iter().find(|(known, _)| known.eq_ignore_ascii_case(word)).map(|(_, block)| *block)
}

/// The name of a timer or counter after its data: `t` of `t.TON(…)`.
pub fn call_on_data(word: &str) -> Option<&'static str> {
    ["TON", "TOF", "TP", "CTU", "CTD", "CTUD"].into_iter().find(|known| known.eq_ignore_ascii_case(word))
}

/// The standard function block for data that any timer or any counter can have.
pub fn of_data_type(word: &str, call: &'static str) -> Option<&'static str> {
    let is_timer = matches!(call, "TON" | "TOF" | "TP");
    match word.to_ascii_uppercase().as_str() {
        "IEC_TIMER" if is_timer => Some(call),
        "IEC_COUNTER" if !is_timer => Some(call),
        "IEC_DCOUNTER" if !is_timer => block(&format!("{call}_DINT")),
        "IEC_UDCOUNTER" if !is_timer => block(&format!("{call}_UDINT")),
        _ => None,
    }
}

/// Whether a type is one of the system with a counterpart.
pub fn has_type(word: &str) -> bool {
    block(word).is_some() || ["TON", "CTU"].into_iter().any(|call| of_data_type(word, call).is_some())
}

/// The element of PLCopen XML for an elementary type.
pub fn type_element(ty: Elementary) -> Option<&'static str> {
    Some(match ty {
        Elementary::Bool => "BOOL",
        Elementary::Byte => "BYTE",
        Elementary::Word => "WORD",
        Elementary::Dword => "DWORD",
        Elementary::Lword => "LWORD",
        Elementary::Sint => "SINT",
        Elementary::Int => "INT",
        Elementary::Dint => "DINT",
        Elementary::Lint => "LINT",
        Elementary::Usint => "USINT",
        Elementary::Uint => "UINT",
        Elementary::Udint => "UDINT",
        Elementary::Ulint => "ULINT",
        Elementary::Real => "REAL",
        Elementary::Lreal => "LREAL",
        Elementary::Time => "TIME",
        Elementary::TimeOfDay => "TOD",
        Elementary::Char
        | Elementary::Wchar
        | Elementary::S5Time
        | Elementary::Date
        | Elementary::Ltime
        | Elementary::Ltod
        | Elementary::Ldt => return None,
    })
}

/// Functions with the same name, parameters and result.
const SAME: &[&str] = &[
    "ABS", "SQRT", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "EXP", "LN", "SEL", "MIN", "MAX", "LIMIT", "SHL",
    "SHR", "ROL", "ROR", "LEN", "LEFT", "RIGHT", "MID", "CONCAT", "INSERT", "DELETE", "REPLACE", "FIND", "TRUNC",
];

/// What becomes of a function.
pub enum Function {
    Same,
    /// The same parameters and result, another name.
    Named(String),
    /// Refused, with the reason.
    None(String),
}

/// The function of the standard for one of SCL, whose first argument has this type.
pub fn function(name: &str, argument: Option<Elementary>) -> Function {
    let upper = name.to_ascii_uppercase();
    if SAME.contains(&upper.as_str()) {
        return Function::Same;
    }
    let from_argument = |to: Elementary, infix: &str| match argument {
        Some(from @ (Elementary::Real | Elementary::Lreal)) => {
            Function::Named(format!("{}{infix}{}", from.name(), to.name()))
        }
        _ => Function::None(format!("`{name}` needs the type of its argument, which the sources do not show")),
    };
    let (head, to) = upper.split_once('_').unwrap_or((&upper, "DINT"));
    match head {
        "ROUND" => {
            return match Elementary::from_word(to).filter(|ty| ty.is_integer()) {
                Some(to) => from_argument(to, "_TO_"),
                None => Function::None(format!("IEC 61131-3 has no function `{name}`")),
            };
        }
        "TRUNC" => {
            return match Elementary::from_word(to).filter(|ty| ty.is_integer()) {
                Some(to) => from_argument(to, "_TRUNC_"),
                None => Function::None(format!("IEC 61131-3 has no function `{name}`")),
            };
        }
        _ => {}
    }
    match upper.split_once("_TO_") {
        Some((from, to)) => match (Elementary::from_word(from), Elementary::from_word(to)) {
            (Some(from), Some(to)) => match conversion(from, to) {
                Ok(()) => Function::Same,
                Err(reason) => Function::None(reason),
            },
            _ => Function::None(format!("IEC 61131-3 has no function `{name}`")),
        },
        None => Function::None(format!("IEC 61131-3 has no function `{name}`")),
    }
}

/// Whether a conversion means the same in IEC 61131-3; otherwise why not.
pub fn conversion(from: Elementary, to: Elementary) -> Result<(), String> {
    let is_float = |ty| matches!(ty, Elementary::Real | Elementary::Lreal);
    let is_bits = |ty| matches!(ty, Elementary::Byte | Elementary::Word | Elementary::Dword | Elementary::Lword);
    let name = format!("{}_TO_{}", from.name(), to.name());
    match (from, to) {
        (Elementary::Time, Elementary::Dint) | (Elementary::Dint, Elementary::Time) => Ok(()),
        (_, Elementary::Bool) => Err(format!("`{name}` reads the lowest bit here, and compares with 0 in IEC 61131-3")),
        (a, b) if is_float(a) && is_bits(b) || is_bits(a) && is_float(b) => {
            Err(format!("`{name}` copies the bits here, and converts the number in other editors"))
        }
        (a, b) => {
            let is_known = |ty| ty == Elementary::Bool || is_float(ty) || is_bits(ty) || Elementary::is_integer(ty);
            match is_known(a) && is_known(b) {
                true => Ok(()),
                false => Err(format!("`{name}` has another result in IEC 61131-3, or none")),
            }
        }
    }
}

/// The address of a variable as the standard writes it; `None`: the number does not count units of the width.
pub fn address(area: char, width: Width, byte: u32, bit: u8) -> Option<String> {
    let (letter, bytes) = match width {
        Width::Bit => return Some(format!("%{area}X{byte}.{bit}")),
        Width::Byte => ('B', 1),
        Width::Word => ('W', 2),
        Width::Dword => ('D', 4),
        Width::Lword => ('L', 8),
    };
    byte.is_multiple_of(bytes).then(|| format!("%{area}{letter}{}", byte / bytes))
}
