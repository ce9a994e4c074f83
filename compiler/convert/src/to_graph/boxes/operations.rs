//! Instructions of STL that are the operation of a box.

use plcc_syntax::Elementary;
use plcc_syntax::stl::StlInsn;

/// An operation between loads and a transfer.
pub struct Operation {
    pub row: &'static str,
    /// Types of the inputs and of the result, by the names of their settings.
    pub source: Option<&'static str>,
    pub destination: Option<&'static str>,
    pub inputs: Vec<(&'static str, Elementary)>,
    pub result: Elementary,
    /// Whether OV says that the result is wrong.
    pub checked: bool,
}

/// Of two operands: element, type, and whether OV says that the result is wrong.
pub fn binary(insn: StlInsn) -> Option<(&'static str, Elementary, bool)> {
    use Elementary::{Dint, Dword, Int, Real, Word};
    use StlInsn as I;
    Some(match insn {
        I::AddI => ("Add", Int, true),
        I::SubI => ("Sub", Int, true),
        I::MulI => ("Mul", Int, true),
        I::DivI => ("Div", Int, true),
        I::AddD => ("Add", Dint, true),
        I::SubD => ("Sub", Dint, true),
        I::MulD => ("Mul", Dint, true),
        I::DivD => ("Div", Dint, true),
        I::ModD => ("Mod", Dint, true),
        I::AddR => ("Add", Real, true),
        I::SubR => ("Sub", Real, true),
        I::MulR => ("Mul", Real, true),
        I::DivR => ("Div", Real, true),
        I::AndW => ("And", Word, false),
        I::OrW => ("Or", Word, false),
        I::XorW => ("Xor", Word, false),
        I::AndD => ("And", Dword, false),
        I::OrD => ("Or", Dword, false),
        I::XorD => ("Xor", Dword, false),
        _ => return None,
    })
}

/// Shifts and rotations: element and type.
pub fn shift(insn: StlInsn) -> Option<(&'static str, Elementary)> {
    use Elementary::{Dint, Dword, Int, Word};
    use StlInsn as I;
    Some(match insn {
        I::ShiftLeftW => ("Shl", Word),
        I::ShiftLeftD => ("Shl", Dword),
        I::ShiftRightW => ("Shr", Word),
        I::ShiftRightD => ("Shr", Dword),
        I::ShiftSignedI => ("Shr", Int),
        I::ShiftSignedD => ("Shr", Dint),
        I::RotateLeftD => ("Rol", Dword),
        I::RotateRightD => ("Ror", Dword),
        _ => return None,
    })
}

/// A shift by a number of places.
pub fn shifted(row: &'static str, ty: Elementary) -> Operation {
    let inputs = vec![("in", ty), ("n", Elementary::Word)];
    Operation { row, source: Some(type_name(ty)), destination: None, inputs, result: ty, checked: false }
}

/// A conversion; `from` and `to` as settings of elements name them.
pub fn converted(from: &'static str, source: Elementary, to: &'static str, result: Elementary) -> Operation {
    let checked = to.starts_with("BCD");
    let inputs = vec![("in", source)];
    Operation { row: "Convert", source: Some(from), destination: Some(to), inputs, result, checked }
}

/// Of one operand.
pub fn unary(insn: StlInsn) -> Option<Operation> {
    use Elementary::{Dint, Dword, Int, Real, Word};
    use StlInsn as I;
    let of = |row, ty, checked| Operation {
        row,
        source: Some(type_name(ty)),
        destination: None,
        inputs: vec![("in", ty)],
        result: ty,
        checked,
    };
    let round = |row| Operation {
        row,
        source: Some("Real"),
        destination: Some("DInt"),
        inputs: vec![("in", Real)],
        result: Dint,
        checked: true,
    };
    Some(match insn {
        I::NegI => of("Neg", Int, true),
        I::NegD => of("Neg", Dint, true),
        I::NegR => of("Neg", Real, false),
        I::InvertI => of("Inv", Word, false),
        I::InvertD => of("Inv", Dword, false),
        I::AbsR => of("Abs", Real, false),
        I::SqrR => of("Sqr", Real, true),
        I::SqrtR => of("Sqrt", Real, true),
        I::LnR => of("Ln", Real, true),
        I::ExpR => of("Exp", Real, true),
        I::SinR => of("Sin", Real, true),
        I::CosR => of("Cos", Real, true),
        I::TanR => of("Tan", Real, true),
        I::AsinR => of("Asin", Real, true),
        I::AcosR => of("Acos", Real, true),
        I::AtanR => of("Atan", Real, true),
        I::IToD => converted("Int", Int, "DInt", Dint),
        I::DToR => converted("DInt", Dint, "Real", Real),
        I::IToBcd => converted("Int", Int, "BCD16", Word),
        I::BcdToI => converted("BCD16", Word, "Int", Int),
        I::DToBcd => converted("DInt", Dint, "BCD32", Dword),
        I::BcdToD => converted("BCD32", Dword, "DInt", Dint),
        I::Round => round("Round"),
        I::Truncate => round("Trunc"),
        I::RoundUp => round("Ceil"),
        I::RoundDown => round("Floor"),
        _ => return None,
    })
}

/// As settings of elements write it.
pub fn type_name(ty: Elementary) -> &'static str {
    match ty {
        Elementary::Int => "Int",
        Elementary::Dint => "DInt",
        Elementary::Real => "Real",
        Elementary::Word => "Word",
        Elementary::Dword => "DWord",
        other => other.name(),
    }
}
