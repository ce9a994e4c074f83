//! Texts in CODESYS. Their elements are bytes, those of a WSTRING words, counted from 0; in SCL they are characters, counted from 1. Functions of
//! texts have other names for their inputs.

use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Literal};

use super::Make;

/// The functions whose values elements are: of a STRING, of a WSTRING.
const AS_NUMBER: [&str; 2] = ["CHAR_TO_BYTE", "WCHAR_TO_WORD"];

/// The index that SCL has for the element `index`.
pub fn from_one(index: &mut Expr) {
    if let ExprKind::Literal(Literal::Integer { value, .. }) = &mut index.kind {
        *value = value.saturating_add(1);
        return;
    }
    let make = Make { name: index.span, span: index.span };
    *index = make.binary(BinaryOp::Add, index.clone(), make.number(1));
}

/// The value of the character `element`; `is_wide`: of a WSTRING.
pub fn as_number(element: Expr, is_wide: bool) -> ExprKind {
    let make = Make { name: element.span, span: element.span };
    make.call(AS_NUMBER[usize::from(is_wide)], element).kind
}

/// Makes a value of [`as_number`] the character itself, which a statement assigns.
pub fn as_place(value: &mut Expr) {
    let ExprKind::Call { callee, arguments } = &mut value.kind else { return };
    let is_element = matches!(&callee.kind, ExprKind::Name(name) if AS_NUMBER.contains(&name.text.as_str()));
    if is_element
        && let [argument] = arguments.as_mut_slice()
        && let Some(element) = argument.value.take()
    {
        *value = element;
    }
}

/// The name in SCL of an input that CODESYS calls `STR`, `STR1`, `SIZE`, `LEN`, `POS`; none of other inputs and functions.
pub fn input(function: &str, written: &str) -> Option<&'static str> {
    let of = |names: &[&str]| names.iter().any(|name| name.eq_ignore_ascii_case(function));
    let one = of(&["LEN", "LEFT", "RIGHT", "MID", "DELETE"]);
    let two = of(&["CONCAT", "INSERT", "REPLACE", "FIND"]);
    match written.to_ascii_uppercase().as_str() {
        "STR" if one => Some("IN"),
        "STR1" if two => Some("IN1"),
        "STR2" if two => Some("IN2"),
        "SIZE" if of(&["LEFT", "RIGHT"]) => Some("L"),
        "LEN" if of(&["MID", "DELETE"]) => Some("L"),
        "POS" if of(&["MID", "DELETE", "INSERT"]) => Some("P"),
        _ => None,
    }
}
