//! Conversions between numbers and texts: functions of the library with the types in their names, which are S_CONV, STRG_VAL and VAL_STRG in
//! STL of an S7-1500.
//!
//! Source: S7-1500 information system, extended instructions of STL.

use plcc_model::CodeBlock;
use plcc_model::scl::{Actual, Call, Conversion, Expr, ExprKind};
use plcc_model::types::Elementary;

use super::text::TextInstruction;

/// The type of a text in the braces of a call.
const TEXT: &str = "String";

/// The instruction that a call of a function of the library is.
pub fn conversion(callee: &CodeBlock, call: &Call) -> Option<TextInstruction> {
    for (prefix, name) in [("STRING_TO_", "S_CONV"), ("STRG_VAL_", "STRG_VAL")] {
        let ty = callee.name.strip_prefix(prefix).and_then(Elementary::from_word);
        if let Some(ty) = ty.filter(|ty| is_number(*ty)) {
            return Some(TextInstruction::converting(name, TEXT, ty.name()));
        }
    }
    for (prefix, name) in [("S_CONV_", "S_CONV"), ("VAL_STRG_", "VAL_STRG")] {
        let Some(written) = callee.name.strip_prefix(prefix) else { continue };
        let (ty, _) = number(callee, call)?;
        let own = if ty == Elementary::Real { "REAL" } else { "LINT" };
        return (written == own).then(|| TextInstruction::converting(name, ty.name(), TEXT));
    }
    None
}

/// The number at the input IN, as it is before it gets the type of the function, and its type.
pub fn number<'c>(callee: &CodeBlock, call: &'c Call) -> Option<(Elementary, &'c Expr)> {
    let parameters = &callee.interface.parameters;
    let argument = call.arguments.iter().find(|argument| parameters[argument.parameter].name == "IN")?;
    let Actual::Value(value) = &argument.actual else { return None };
    match &value.kind {
        ExprKind::Convert { conversion: Conversion::Value(_) | Conversion::Bits { .. }, operand }
            if is_number(operand.ty) && value.ty == widened(operand.ty) =>
        {
            Some((operand.ty, &**operand))
        }
        // A number without a type.
        ExprKind::Const(bits) if value.ty == Elementary::Lint => {
            i32::try_from(bits.cast_signed()).ok().map(|_| (Elementary::Dint, value))
        }
        _ => is_number(value.ty).then_some((value.ty, value)),
    }
}

/// The type that functions of the library have for a number.
fn widened(ty: Elementary) -> Elementary {
    if ty == Elementary::Real { Elementary::Lreal } else { Elementary::Lint }
}

/// A number with which statements can do something.
fn is_number(ty: Elementary) -> bool {
    use Elementary::{Dint, Int, Real, Sint, Udint, Uint, Usint};
    matches!(ty, Sint | Int | Dint | Usint | Uint | Udint | Real)
}
