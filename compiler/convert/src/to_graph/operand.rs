//! Operands of statements as operands of networks.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{BlockName, Bound, Operand, OperandKind, PathPart, PathRoot, StatusOperand};
use plcc_syntax::literal::Literal;
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal as SclLiteral, Name, NameForm, UnaryOp};
use plcc_syntax::stl::StlInsn;

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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Constant(Form),
    /// An absolute address of so many bits.
    Bits(u32),
    Type(Elementary),
    Cell,
    Unknown,
}

/// How a constant is written. `L` brings its bits as they are; elements of networks convert numbers to the type of their operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A number of 16 bits. `L` does not extend its sign.
    Int {
        negative: bool,
    },
    Dint,
    Real,
    Other,
}

impl Form {
    pub fn of(literal: &Literal) -> Form {
        match literal {
            Literal::Int(number) => Form::Int { negative: *number < 0 },
            Literal::Dint(_) => Form::Dint,
            Literal::Real(_) => Form::Real,
            Literal::Bool(_)
            | Literal::Byte(_)
            | Literal::Word(_)
            | Literal::Counter(_)
            | Literal::Dword(_)
            | Literal::Bits { .. }
            | Literal::S5Time(_)
            | Literal::Time(_)
            | Literal::Date(_)
            | Literal::TimeOfDay(_)
            | Literal::Text(_)
            | Literal::Bytes2(_)
            | Literal::Bytes4(_)
            | Literal::DateAndTime(_)
            | Literal::Pointer(_)
            | Literal::AreaPointer { .. }
            | Literal::Any(_) => Form::Other,
        }
    }

    /// Whether an element makes of the constant the bits that `L` brings, for an operand of so many bits that is a REAL or not.
    pub fn keeps_bits(self, bits: u32, is_real: bool) -> bool {
        match self {
            Form::Int { negative } => !is_real && (bits == 16 || !negative),
            Form::Dint => !is_real,
            Form::Real => is_real || bits == 32,
            Form::Other => true,
        }
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
                    PathPart::Member { name: text, .. } => ExprKind::Member {
                        base: Box::new(value),
                        name: Name { text: text.clone(), form: NameForm::Bare, span },
                    },
                    PathPart::Index { values, .. } => {
                        let mut indices = Vec::new();
                        for bound in values {
                            match bound {
                                Bound::Number(number, _) => indices.push(whole(*number, span)),
                                Bound::Name(..) | Bound::Expr(_) => {
                                    return Err("an index that is a constant".to_string());
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
