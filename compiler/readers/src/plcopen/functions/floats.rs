//! Bit strings where floats are expected: in the editors they are numbers without sign, in SCL a DWORD that becomes a REAL keeps its bits.

use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, UnaryOp};

use super::super::types::Ty;
use super::{BIT_STRINGS, FLOATS, Make};

/// Functions of a float.
const OF_FLOATS: &[&str] = &["SQRT", "LN", "LOG", "EXP", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN"];
/// Functions whose inputs have one type.
const OF_ONE_TYPE: &[&str] =
    &["ADD", "SUB", "MUL", "DIV", "EXPT", "MIN", "MAX", "LIMIT", "GT", "GE", "EQ", "LE", "LT", "NE"];
/// Functions that choose one of the inputs after the first.
const CHOICES: &[&str] = &["SEL", "MUX"];

/// The integer with as many bits as a bit string.
pub fn unsigned(bits: &str) -> &'static str {
    match bits {
        "BYTE" => "USINT",
        "WORD" => "UINT",
        "DWORD" => "UDINT",
        _ => "ULINT",
    }
}

/// The type that the inputs of a standard function need if they must be floats, and the first input that has it.
pub fn inputs(name: &str, kinds: &[Option<Ty>]) -> Option<(usize, Ty)> {
    let upper = name.to_ascii_uppercase();
    let is = |list: &[&str]| list.contains(&upper.as_str());
    if is(OF_FLOATS) {
        return Some((0, Ty::Of(Elementary::Real)));
    }
    if !is(OF_ONE_TYPE) && !is(CHOICES) {
        return None;
    }
    let first = usize::from(is(CHOICES));
    let float = kinds.iter().skip(first).flatten().find(|kind| kind.is_float())?;
    Some((first, float.clone()))
}

/// BYTE, WORD, DWORD or LWORD.
pub fn is_bit_string(ty: &Ty) -> bool {
    matches!(ty, Ty::Of(ty) if BIT_STRINGS.contains(&ty.name()))
}

/// A bit string that meets a float: the float of its value. `kind` is the type of `value`, before and after.
pub fn of_bits(value: &mut Expr, kind: &mut Option<Ty>, float: &Ty) {
    let (Some(Ty::Of(bits)), Ty::Of(wanted)) = (&*kind, float) else { return };
    let (bits, wanted) = (bits.name(), wanted.name());
    if !BIT_STRINGS.contains(&bits) || !FLOATS.contains(&wanted) || computes(value) {
        return;
    }
    let make = Make { name: value.span, span: value.span };
    let number = unsigned(bits);
    let whole = make.call(&format!("{bits}_TO_{number}"), value.clone());
    *value = make.convert(number, wanted, whole);
    *kind = Some(float.clone());
}

/// Whether a value is computed, and so is a number, although its operands are bit strings.
fn computes(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Binary { op, .. } => !matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor),
        ExprKind::Unary { op, .. } => *op != UnaryOp::Not,
        _ => false,
    }
}
