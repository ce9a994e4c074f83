//! Operands of statements as operands of networks.

use plcc_diag::Span;
use plcc_syntax::ast::{BlockName, Bound, Operand, OperandKind, PathPart, PathRoot, StatusOperand, Width};
use plcc_syntax::literal::Literal;
use plcc_syntax::scl::address;
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal as SclLiteral, Name, NameForm, UnaryOp};
use plcc_syntax::stl::StlInsn;
use plcc_syntax::{Class, Elementary};

use super::drawing::Reason;

/// The element and type of a comparison.
pub fn compared(insn: StlInsn) -> Option<(&'static str, &'static str)> {
    use StlInsn as I;
    Some(match insn {
        I::CompareEqI => ("EQ", "Int"),
        I::CompareNeI => ("NE", "Int"),
        I::CompareGtI => ("GT", "Int"),
        I::CompareLtI => ("LT", "Int"),
        I::CompareGeI => ("GE", "Int"),
        I::CompareLeI => ("LE", "Int"),
        I::CompareEqD => ("EQ", "DInt"),
        I::CompareNeD => ("NE", "DInt"),
        I::CompareGtD => ("GT", "DInt"),
        I::CompareLtD => ("LT", "DInt"),
        I::CompareGeD => ("GE", "DInt"),
        I::CompareLeD => ("LE", "DInt"),
        I::CompareEqR => ("EQ", "Real"),
        I::CompareNeR => ("NE", "Real"),
        I::CompareGtR => ("GT", "Real"),
        I::CompareLtR => ("LT", "Real"),
        I::CompareGeR => ("GE", "Real"),
        I::CompareLeR => ("LE", "Real"),
        _ => return None,
    })
}

/// A constant in the form of the type that it is compared with.
pub fn typed(value: Expr, ty: &str) -> Expr {
    match (&value.kind, ty) {
        (ExprKind::Literal(SclLiteral::Typed { ty: Elementary::Dint, bits }), "DInt") => {
            let number = i64::from(*bits as u32 as i32);
            whole(number, value.span)
        }
        _ => value,
    }
}

pub fn flag(status: StatusOperand) -> &'static str {
    match status {
        StatusOperand::Br => "BR_FlagContact",
        StatusOperand::Ov => "OV_FlagContact",
        StatusOperand::Os => "OS_FlagContact",
        StatusOperand::Uo => "UO_FlagContact",
        StatusOperand::Eq0 => "EQ_I_Flags_Contact",
        StatusOperand::Ne0 => "NE_I_Flags_Contact",
        StatusOperand::Gt0 => "GT_I_Flags_Contact",
        StatusOperand::Lt0 => "LT_I_Flags_Contact",
        StatusOperand::Ge0 => "GE_I_Flags_Contact",
        StatusOperand::Le0 => "LE_I_Flags_Contact",
    }
}

/// What is known of the type of an operand.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    Constant(Literal),
    /// An absolute address of so many bits.
    Bits(u32),
    Type(Elementary),
    Cell,
    Unknown,
}

/// Whether an operand is a value of a type, so that a box reads the bits that the statement reads.
pub fn fits(operand: &Operand, kind: Kind, ty: Elementary) -> bool {
    let OperandKind::Literal(literal) = &operand.kind else {
        return match kind {
            // An address has the type of its pin.
            Kind::Bits(bits) => bits == ty.bits(),
            Kind::Type(own) => own == ty,
            Kind::Unknown | Kind::Constant(_) | Kind::Cell => false,
        };
    };
    match ty {
        Elementary::Int => matches!(literal, Literal::Int(number) if i16::try_from(*number).is_ok()),
        // `L -5` fills the upper word with zeros.
        Elementary::Dint => matches!(literal, Literal::Dint(_) | Literal::Int(0..=0x7FFF)),
        Elementary::Real => matches!(literal, Literal::Real(_)),
        Elementary::Word => matches!(literal, Literal::Word(_) | Literal::Int(0..=0x7FFF)) || is_short(literal, 16),
        Elementary::Dword => {
            matches!(literal, Literal::Dword(_) | Literal::Word(_) | Literal::Int(0..=0x7FFF)) || is_short(literal, 32)
        }
        _ => false,
    }
}

/// Whether a constant that is compared as `Int`, `DInt` or `Real` has the bits that `L` loads.
pub fn compares(literal: &Literal, ty: &str) -> bool {
    match ty {
        "Int" => match literal {
            Literal::Int(number) => i16::try_from(*number).is_ok(),
            // Bits, up to the sign.
            Literal::Word(_) | Literal::S5Time(_) | Literal::Counter(_) => true,
            literal => is_short(literal, 16),
        },
        "DInt" => {
            matches!(literal, Literal::Dint(_) | Literal::Dword(_) | Literal::Time(_) | Literal::Int(0..=0x7FFF))
                || is_short(literal, 32)
        }
        _ => matches!(literal, Literal::Real(_)),
    }
}

/// Bits without a type, no more than `bits`.
fn is_short(literal: &Literal, bits: u32) -> bool {
    matches!(literal, Literal::Bits { value, .. } if bits == 32 || value.checked_shr(bits) == Some(0))
}

/// Whether MOVE of a constant to a target of so many bits leaves what `L` and `T` leave there. `ty`: that of the target; an address has none.
pub fn keeps_bits(literal: &Literal, bits: u32, ty: Option<Elementary>) -> bool {
    let is_real = ty == Some(Elementary::Real);
    let is_plain = ty.is_none_or(|ty| ty.class() == Class::Bits);
    match literal {
        Literal::Int(number) => match bits {
            16 => true,
            8 => (0..=0xFF).contains(number),
            // `L -5` fills the upper word with zeros.
            _ => !is_real && (0..=0x7FFF).contains(number),
        },
        Literal::Byte(_) => is_plain,
        Literal::Word(_) | Literal::Counter(_) | Literal::S5Time(_) | Literal::Date(_) => {
            bits == 16 || bits == 32 && matches!(literal, Literal::Word(_)) && is_plain
        }
        Literal::Dword(_) | Literal::Dint(_) | Literal::Time(_) | Literal::TimeOfDay(_) => bits == 32 && !is_real,
        Literal::Real(_) => bits == 32 && (is_real || is_plain),
        Literal::Bits { value, .. } => !is_real && (bits == 32 || value.checked_shr(bits) == Some(0)),
        Literal::Text(bytes) => bits == 8 && bytes.len() == 1,
        Literal::Bool(_)
        | Literal::Bytes2(_)
        | Literal::Bytes4(_)
        | Literal::DateAndTime(_)
        | Literal::Pointer(_)
        | Literal::AreaPointer { .. }
        | Literal::Any(_) => false,
    }
}

/// A whole number, with a sign if it is negative.
fn whole(number: i64, span: Span) -> Expr {
    let span = Span { end: span.start, ..span };
    let literal =
        Expr { kind: ExprKind::Literal(SclLiteral::Integer { value: number.unsigned_abs(), based: false }), span };
    match number < 0 {
        true => Expr { kind: ExprKind::Unary { op: UnaryOp::Minus, operand: Box::new(literal) }, span },
        false => literal,
    }
}

/// `%X3`, which statements have as the name of a component.
fn part_of_variable(name: &str) -> Option<(Width, u32)> {
    address::slice(name).filter(|_| name.starts_with('%'))
}

/// An operand as networks have it.
pub fn expression(operand: &Operand) -> Result<Expr, Reason> {
    // Without text of its own: the notation of the source is another one.
    let span = Span { end: operand.span.start, ..operand.span };
    let name = |text: &str, form: NameForm| ExprKind::Name(Name { text: text.to_string(), form, span });
    let of = |kind: ExprKind| Expr { kind, span };
    let kind = match &operand.kind {
        OperandKind::Absolute { .. } | OperandKind::Cell { .. } => ExprKind::Absolute(operand.kind.clone()),
        OperandKind::Block(BlockName::Symbol { name: text, .. }) => name(text, NameForm::Quoted),
        OperandKind::Block(BlockName::Numbered { .. }) => ExprKind::Absolute(operand.kind.clone()),
        OperandKind::DbAbsolute { db, width, byte, bit } => {
            let base = match db {
                BlockName::Symbol { name: text, .. } => name(text, NameForm::Quoted),
                BlockName::Numbered { .. } => ExprKind::Absolute(OperandKind::Block(db.clone())),
            };
            ExprKind::MemberAbsolute { base: Box::new(of(base)), width: *width, byte: *byte, bit: *bit }
        }
        OperandKind::Path(path) => {
            let root = match &path.root {
                PathRoot::Local { name: text, .. } => name(text, NameForm::Local),
                PathRoot::Quoted { name: text, .. } => name(text, NameForm::Quoted),
                PathRoot::Bare { .. } => return Err("a name without `#` or quotes".to_string()),
                PathRoot::Block(block) => ExprKind::Absolute(OperandKind::Block(block.clone())),
            };
            let mut value = of(root);
            for part in &path.parts {
                value = of(match part {
                    PathPart::Member { name: text, .. } => match part_of_variable(text) {
                        Some((width, index)) => ExprKind::Slice { base: Box::new(value), width, index },
                        None => ExprKind::Member {
                            base: Box::new(value),
                            name: Name { text: text.clone(), form: NameForm::Bare, span },
                        },
                    },
                    PathPart::Index { values, .. } => {
                        let mut indices = Vec::new();
                        for bound in values {
                            match bound {
                                Bound::Number(number, _) => indices.push(whole(*number, span)),
                                Bound::Name(..) | Bound::Expr(_) | Bound::Path(_) => {
                                    return Err("an index that is a name".to_string());
                                }
                            }
                        }
                        ExprKind::Index { base: Box::new(value), indices }
                    }
                });
            }
            return Ok(value);
        }
        OperandKind::Literal(literal) => return constant(literal, span),
        OperandKind::MemoryIndirect { .. }
        | OperandKind::CellIndirect { .. }
        | OperandKind::BlockIndirect { .. }
        | OperandKind::RegisterIndirect { .. } => return Err("an indirect address".to_string()),
        OperandKind::Peripheral(_) => return Err("a symbol with `:P`".to_string()),
        OperandKind::AddressOf(_) => return Err("a pointer to a variable".to_string()),
        OperandKind::Status(_) | OperandKind::Special(_) | OperandKind::Register(_) => {
            return Err("a register of the CPU".to_string());
        }
        OperandKind::Label(_) | OperandKind::Error => return Err("this operand".to_string()),
    };
    Ok(of(kind))
}

pub fn constant(literal: &Literal, span: Span) -> Result<Expr, Reason> {
    let typed = |ty: Elementary, bits: u64| ExprKind::Literal(SclLiteral::Typed { ty, bits });
    let kind = match literal {
        Literal::Bool(value) => typed(Elementary::Bool, u64::from(*value)),
        Literal::Int(number) => return Ok(whole(*number, span)),
        Literal::Dint(number) => typed(Elementary::Dint, u64::from(*number as u32)),
        Literal::Byte(value) => typed(Elementary::Byte, u64::from(*value)),
        Literal::Word(value) | Literal::Counter(value) => typed(Elementary::Word, u64::from(*value)),
        Literal::Dword(value) => typed(Elementary::Dword, u64::from(*value)),
        Literal::Bits { value, .. } => ExprKind::Literal(SclLiteral::Integer { value: u64::from(*value), based: true }),
        Literal::Real(value) => typed(Elementary::Real, u64::from(value.to_bits())),
        Literal::S5Time(value) => typed(Elementary::S5Time, u64::from(*value)),
        Literal::Time(ms) => typed(Elementary::Time, u64::from(*ms as u32)),
        Literal::Date(days) => typed(Elementary::Date, u64::from(*days)),
        Literal::TimeOfDay(ms) => typed(Elementary::TimeOfDay, u64::from(*ms)),
        Literal::Text(bytes) => ExprKind::Literal(SclLiteral::Text { bytes: bytes.clone(), typed: false }),
        Literal::Bytes2(_)
        | Literal::Bytes4(_)
        | Literal::DateAndTime(_)
        | Literal::Pointer(_)
        | Literal::AreaPointer { .. }
        | Literal::Any(_) => return Err("this constant".to_string()),
    };
    Ok(Expr { kind, span })
}
