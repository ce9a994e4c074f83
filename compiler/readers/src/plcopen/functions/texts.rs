//! Texts in CODESYS. Their elements are bytes, those of a WSTRING words, counted from 0, and a text ends before a 0; in SCL they are characters,
//! counted from 1, and the length is beside them. So functions of the library read and write elements. Functions of texts have other names for
//! their inputs.

use plcc_diag::Span;
use plcc_syntax::scl::ast::{Argument, BinaryOp, Expr, ExprKind, Literal, Name, NameForm};

use super::Make;

/// The functions whose values elements are: of a STRING, of a WSTRING.
const READ: [&str; 2] = ["IEC_BYTE_OF_TEXT", "IEC_WORD_OF_TEXT"];
/// The functions that write elements, in the same order.
const WRITE: [&str; 2] = ["IEC_SET_BYTE_OF_TEXT", "IEC_SET_WORD_OF_TEXT"];

/// The value of the element `index` of `text`; `is_wide`: of a WSTRING.
pub fn element(text: Expr, index: Expr, is_wide: bool, span: Span) -> ExprKind {
    let make = Make { name: span, span };
    make.call_with(READ[usize::from(is_wide)], vec![text, index]).kind
}

/// Makes a value of [`element`] the character itself, which an output of a call becomes.
pub fn as_place(value: &mut Expr) {
    let Some((_, text, index)) = parts(value) else { return };
    let make = Make { name: index.span, span: index.span };
    let from_one = match &index.kind {
        ExprKind::Literal(Literal::Integer { value, .. }) => make.number(value.saturating_add(1)),
        _ => make.binary(BinaryOp::Add, index.clone(), make.number(1)),
    };
    value.kind = ExprKind::Index { base: Box::new(text.clone()), indices: vec![from_one] };
}

/// The call that assigns `value` to `target`, if that is an [`element`].
pub fn assignment(target: &Expr, value: &Expr) -> Option<Expr> {
    let (function, text, index) = parts(target)?;
    let name = |text: &str, span| Name { text: text.to_string(), form: NameForm::Bare, span };
    let argument = |formal: &str, value: &Expr| Argument {
        name: Some(name(formal, value.span)),
        output: false,
        span: value.span,
        value: Some(value.clone()),
    };
    let callee = Expr { kind: ExprKind::Name(name(WRITE[function], target.span)), span: target.span };
    let arguments = vec![argument("S", text), argument("INDEX", index), argument("VALUE", value)];
    Some(Expr { kind: ExprKind::Call { callee: Box::new(callee), arguments }, span: target.span })
}

/// The function in [`READ`], the text and the index of an [`element`].
fn parts(value: &Expr) -> Option<(usize, &Expr, &Expr)> {
    let ExprKind::Call { callee, arguments } = &value.kind else { return None };
    let ExprKind::Name(name) = &callee.kind else { return None };
    let function = READ.iter().position(|read| *read == name.text)?;
    let [text, index] = arguments.as_slice() else { return None };
    Some((function, text.value.as_ref()?, index.value.as_ref()?))
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
