//! By which types the sides of an assertion compare. The rules are in docs/testing.md and are the same for every language.

use plcc_abi::image::{AssertCondition, AssertConstant, AssertKind, AssertOp, AssertType};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast;
use plcc_syntax::{Class, Elementary};

use crate::constant::Constant;
use plcc_model::types::value_type;
use plcc_model::{Compared, ComparedValue, Comparison};

/// A declared type that values of assertions have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    Elementary(Elementary),
    DateAndTime,
    Dtl,
    Text,
    WideText,
}

/// A constant that gets its type from the other side.
#[derive(Clone, Debug)]
pub struct Literal {
    pub constant: Option<Constant>,
    /// The bits that `L` loads; `None`: it cannot be loaded, or the width of the other side decides.
    pub loaded: Option<u64>,
}

/// A side before the other one is known.
#[derive(Clone, Debug)]
pub struct Side<S> {
    pub what: What<S>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum What<S> {
    Literal(Literal),
    Value {
        value: ComparedValue<S>,
        /// `None`: bits without a meaning.
        ty: Option<Type>,
        /// In bits.
        width: u8,
    },
}

/// Why sides cannot be compared: position, what is wrong, what to write.
pub struct Mismatch {
    pub span: Span,
    pub title: String,
    pub help: String,
}

impl Mismatch {
    pub fn message(self) -> Diagnostic {
        Diagnostic::new(Code::Pragma, self.span, self.title).label("cannot be compared like this").help(self.help)
    }
}

impl Type {
    /// The type after `as`.
    pub fn from_word(word: &str) -> Option<Type> {
        match word.to_ascii_uppercase().as_str() {
            "STRING" => Some(Type::Text),
            "WSTRING" => Some(Type::WideText),
            "DT" | "DATE_AND_TIME" => Some(Type::DateAndTime),
            "DTL" => Some(Type::Dtl),
            word => Elementary::from_word(word).map(Type::Elementary),
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            Type::Elementary(ty) => ty.name(),
            Type::DateAndTime => "DATE_AND_TIME",
            Type::Dtl => "DTL",
            Type::Text => "STRING",
            Type::WideText => "WSTRING",
        }
    }

    /// Code supplies the address of the value, not the value.
    pub const fn is_in_memory(self) -> bool {
        matches!(self, Type::Dtl | Type::Text | Type::WideText)
    }

    /// In bits; for a value in memory that of a byte, where it begins.
    pub const fn width(self) -> u8 {
        match self {
            Type::Elementary(ty) => ty.bits() as u8,
            Type::DateAndTime => 64,
            Type::Dtl | Type::Text | Type::WideText => 8,
        }
    }

    const fn compared(self) -> AssertType {
        match self {
            Type::DateAndTime => AssertType::DateAndTime,
            Type::Dtl => AssertType::Dtl,
            Type::Text => AssertType::Text,
            Type::WideText => AssertType::WideText,
            Type::Elementary(ty) => value_type(ty),
        }
    }

    /// The type as which its values compare with others of its kind.
    const fn kind(self) -> AssertKind {
        match self {
            Type::DateAndTime | Type::Dtl => AssertKind::Moment,
            Type::Text | Type::WideText => AssertKind::Text,
            Type::Elementary(ty) => match ty.class() {
                Class::Float => AssertKind::Float,
                Class::Duration => AssertKind::Duration,
                Class::Date => match ty {
                    Elementary::TimeOfDay | Elementary::Ltod => AssertKind::TimeOfDay,
                    _ => AssertKind::Moment,
                },
                Class::Character => AssertKind::Text,
                Class::Bits | Class::Signed | Class::Unsigned => AssertKind::Whole,
            },
        }
    }

    const fn is_bits(self) -> bool {
        matches!(self, Type::Elementary(Elementary::Byte | Elementary::Word | Elementary::Dword | Elementary::Lword))
    }

    const fn is_number(self) -> bool {
        match self {
            Type::Elementary(ty) => matches!(ty.class(), Class::Bits | Class::Signed | Class::Unsigned),
            _ => false,
        }
    }
}

/// How comparisons are joined, for the program.
pub fn condition(condition: &ast::Condition) -> AssertCondition {
    match condition {
        ast::Condition::Compare(index) => AssertCondition::Compare(*index),
        ast::Condition::Not(inner) => AssertCondition::Not(Box::new(self::condition(inner))),
        ast::Condition::All(list) => AssertCondition::All(list.iter().map(self::condition).collect()),
        ast::Condition::Any(list) => AssertCondition::Any(list.iter().map(self::condition).collect()),
    }
}

pub const fn op(op: ast::AssertOp) -> AssertOp {
    match op {
        ast::AssertOp::Eq => AssertOp::Eq,
        ast::AssertOp::Ne => AssertOp::Ne,
        ast::AssertOp::Lt => AssertOp::Lt,
        ast::AssertOp::Le => AssertOp::Le,
        ast::AssertOp::Gt => AssertOp::Gt,
        ast::AssertOp::Ge => AssertOp::Ge,
    }
}

/// True for an assertion that marks code that must not be reached.
pub fn is_trap<S>(condition: &AssertCondition, comparisons: &[Comparison<S>]) -> bool {
    match (condition, comparisons) {
        (AssertCondition::Compare(_), [Comparison { left, right, .. }]) => match (&left.value, &right.value) {
            (ComparedValue::Constant(left), ComparedValue::Constant(right)) => left != right,
            _ => false,
        },
        _ => false,
    }
}

/// A literal with `as TYPE` after it.
pub fn typed_literal<S>(literal: &Literal, ty: Type, span: Span) -> Result<Side<S>, Mismatch> {
    let (_, own, constant) = beside(ty, literal, AssertOp::Lt, span)?;
    if own != ty {
        return Err(does_not_fit(ty.name(), span));
    }
    Ok(Side { what: What::Value { value: ComparedValue::Constant(constant), ty: Some(ty), width: ty.width() }, span })
}

/// Settles how two sides compare.
pub fn compare<S>(op: AssertOp, left: Side<S>, right: Side<S>) -> Result<Comparison<S>, Mismatch> {
    let (left_span, right_span) = (left.span, right.span);
    let made = |kind, (left_ty, left), (right_ty, right)| Comparison {
        op,
        kind,
        left: Compared { ty: left_ty, value: left },
        right: Compared { ty: right_ty, value: right },
    };
    match (left.what, right.what) {
        (What::Literal(left), What::Literal(right)) => {
            let (left, right) = match (left.loaded, right.loaded) {
                (Some(left), Some(right)) => {
                    let side = |bits| (AssertType::Bits(32), ComparedValue::Constant(AssertConstant::Bits(bits)));
                    return Ok(made(AssertKind::Bits, side(left), side(right)));
                }
                _ => (natural(&left, left_span)?, natural(&right, right_span)?),
            };
            let kind = between(left.0, right.0, left_span, right_span)?;
            let side = |(ty, constant): (Type, AssertConstant)| (ty.compared(), ComparedValue::Constant(constant));
            Ok(made(kind, side(left), side(right)))
        }
        (What::Value { value, ty, width }, What::Literal(literal)) => {
            let (kind, own, (other, constant)) = with_literal(ty, width, &literal, op, right_span)?;
            Ok(made(kind, (own, value), (other, ComparedValue::Constant(constant))))
        }
        (What::Literal(literal), What::Value { value, ty, width }) => {
            let (kind, own, (other, constant)) = with_literal(ty, width, &literal, op, left_span)?;
            Ok(made(kind, (other, ComparedValue::Constant(constant)), (own, value)))
        }
        (
            What::Value { value: left, ty: left_ty, width: left_width },
            What::Value { value: right, ty: right_ty, width: right_width },
        ) => {
            let bits = |width| AssertType::Bits(width);
            let (kind, own, other) = match (left_ty, right_ty) {
                (None, None) => (AssertKind::Bits, bits(left_width), bits(right_width)),
                (Some(ty), None) => {
                    let (kind, other) = with_bits(ty, right_width, op, left_span, right_span)?;
                    (kind, ty.compared(), other)
                }
                (None, Some(ty)) => {
                    let (kind, other) = with_bits(ty, left_width, op, right_span, left_span)?;
                    (kind, other, ty.compared())
                }
                (Some(left), Some(right)) => {
                    // A bit string is a pattern of the other side's type if the widths are the same.
                    let same = left.width() == right.width() && left.is_bits() != right.is_bits();
                    let same = same && !left.is_in_memory() && !right.is_in_memory();
                    let (left, right) = match (same, left.is_bits()) {
                        (true, true) => (right, right),
                        (true, false) => (left, left),
                        (false, _) => (left, right),
                    };
                    (between(left, right, left_span, right_span)?, left.compared(), right.compared())
                }
            };
            Ok(made(kind, (own, left), (other, right)))
        }
    }
}

/// A value of type `ty` next to bits without a type.
fn with_bits(ty: Type, width: u8, op: AssertOp, typed: Span, bits: Span) -> Result<(AssertKind, AssertType), Mismatch> {
    if width == ty.width() && !ty.is_in_memory() {
        return Ok((if ty.is_bits() { AssertKind::Bits } else { ty.kind() }, ty.compared()));
    }
    let refused = Mismatch {
        span: bits,
        title: format!("these {width} bits are not a value of type {}", ty.name()),
        help: format!("write the type after it, e.g. `as {}`", if ty.is_in_memory() { ty.name() } else { "INT" }),
    };
    match ty {
        Type::Elementary(own) if !own.is_float() => {
            if width < ty.width() {
                return Ok((AssertKind::Whole, AssertType::Bits(width)));
            }
            // A register with the value in its low part.
            if own.is_signed() && matches!(op, AssertOp::Lt | AssertOp::Le | AssertOp::Gt | AssertOp::Ge) {
                return Err(Mismatch { span: typed.to(bits), ..refused });
            }
            Ok((AssertKind::Bits, AssertType::Bits(width)))
        }
        _ => Err(refused),
    }
}

/// How values of two types compare.
fn between(left: Type, right: Type, left_span: Span, right_span: Span) -> Result<AssertKind, Mismatch> {
    let (own, other) = (left.kind(), right.kind());
    let is_day = |ty: Type| matches!(ty, Type::Elementary(own) if matches!(own.class(), Class::Duration | Class::Date | Class::Character));
    if own == other {
        return Ok(own);
    }
    match (left.is_number(), right.is_number()) {
        (true, false) if other == AssertKind::Float => Ok(AssertKind::Float),
        (false, true) if own == AssertKind::Float => Ok(AssertKind::Float),
        // The number of milliseconds, of days, of a character.
        (true, false) if is_day(right) => Ok(AssertKind::Whole),
        (false, true) if is_day(left) => Ok(AssertKind::Whole),
        _ => Err(Mismatch {
            span: left_span.to(right_span),
            title: format!("{} and {} cannot be compared", left.name(), right.name()),
            help: "compare values of related types, or interpret the bits of one side as another type: `as INT`"
                .to_string(),
        }),
    }
}

/// Kind, type of the value, type and value of the constant.
type WithLiteral = (AssertKind, AssertType, (AssertType, AssertConstant));

/// A value next to a constant, which gets its type.
fn with_literal(
    ty: Option<Type>,
    width: u8,
    literal: &Literal,
    op: AssertOp,
    span: Span,
) -> Result<WithLiteral, Mismatch> {
    match ty {
        Some(ty) if !ty.is_bits() => {
            let (kind, own, constant) = beside(ty, literal, op, span)?;
            Ok((kind, ty.compared(), (own.compared(), constant)))
        }
        Some(_) | None => with_untyped(width, literal, op, span),
    }
}

fn is_order(op: AssertOp) -> bool {
    !matches!(op, AssertOp::Eq | AssertOp::Ne)
}

/// Bits next to a constant: as `L` loads it.
fn with_untyped(width: u8, literal: &Literal, op: AssertOp, span: Span) -> Result<WithLiteral, Mismatch> {
    let bits = AssertType::Bits(width);
    if let Some(Constant::Real(value)) = literal.constant {
        let (ty, pattern) = match width {
            32 => (AssertType::Real, u64::from((value as f32).to_bits())),
            64 => (AssertType::Lreal, value.to_bits()),
            _ => {
                let title = format!("a REAL has 32 bits, the other side {width}");
                return Err(Mismatch { span, title, help: "compare a double word".to_string() });
            }
        };
        return Ok((AssertKind::Float, ty, (ty, AssertConstant::Bits(pattern))));
    }
    let limit = 1i128 << width;
    let whole = match &literal.constant {
        Some(Constant::Integer { value, based: false }) => Some(*value),
        _ => None,
    };
    if is_order(op) && whole.is_some_and(|value| value < 0) {
        return Err(Mismatch {
            span,
            title: "bits without a type have no sign".to_string(),
            help: "write the type after the other side, as in `MW 10 as INT > -5`".to_string(),
        });
    }
    let value = match (whole, literal.loaded) {
        // `L -5` loads 16 bits, with zeros before them; a byte keeps its own bits.
        (Some(value), Some(loaded)) if value >= 0 || width >= 16 => Some(i128::from(loaded)),
        (Some(value), _) => (value >= -limit / 2).then(|| value.rem_euclid(limit)).filter(|_| value < limit),
        (None, Some(loaded)) => Some(i128::from(loaded)),
        (None, None) => literal.constant.as_ref().and_then(|constant| pattern(constant, width)),
    };
    // A pattern may be wider: both are compared as numbers, and a failure shows them.
    let is_wide = literal.constant.as_ref().is_none_or(is_pattern);
    let value = value.filter(|value| *value >= 0 && (is_wide || *value < limit));
    let value = value.and_then(|value| u64::try_from(value).ok());
    let value = value.ok_or_else(|| does_not_fit(&format!("{width} bits"), span))?;
    Ok((AssertKind::Bits, bits, (bits, AssertConstant::Bits(value))))
}

fn does_not_fit(what: &str, span: Span) -> Mismatch {
    Mismatch {
        span,
        title: format!("this constant does not fit {what}"),
        help: "an assertion that no value or every value satisfies tests nothing".to_string(),
    }
}

/// The bits of a constant with a type, or of an integer.
fn pattern(constant: &Constant, width: u8) -> Option<i128> {
    match constant {
        Constant::Integer { value, .. } => Some(*value),
        Constant::Typed { ty, bits } if ty.is_signed() && u32::from(width) > ty.bits() => {
            let unused = 64 - ty.bits();
            Some(i128::from((bits << unused) as i64 >> unused).rem_euclid(1i128 << width))
        }
        Constant::Typed { bits, .. } => Some(i128::from(*bits)),
        _ => None,
    }
}

/// True for `16#FF`, `W#16#FF`, `2#1`.
fn is_pattern(constant: &Constant) -> bool {
    match constant {
        Constant::Integer { based, .. } => *based,
        Constant::Typed { ty, .. } => ty.class() == Class::Bits && *ty != Elementary::Bool,
        _ => false,
    }
}

/// A constant next to a value of type `ty`: how they compare, and the constant with its type.
fn beside(
    ty: Type,
    literal: &Literal,
    op: AssertOp,
    span: Span,
) -> Result<(AssertKind, Type, AssertConstant), Mismatch> {
    let wrong = || Mismatch {
        span,
        title: format!("this constant is not of type {}", ty.name()),
        help: match ty {
            Type::Elementary(own) => crate::rewrite::wanted(own),
            Type::DateAndTime | Type::Dtl => "write it as DT#2000-6-20-5:45:00 or DTL#2000-6-20-5:45:00".to_string(),
            Type::Text | Type::WideText => "write a text in quotes: 'text'".to_string(),
        },
    };
    let bits = |kind, own, bits| Ok((kind, Type::Elementary(own), AssertConstant::Bits(bits)));
    let Some(constant) = &literal.constant else {
        // `B#(1,8)`, a pointer: its bits.
        return match (ty, literal.loaded) {
            (Type::Elementary(own), Some(loaded)) if loaded < 1 << own.bits().min(63) && !is_order(op) => {
                bits(AssertKind::Bits, own, loaded)
            }
            _ => Err(wrong()),
        };
    };
    let own = match ty {
        Type::Elementary(own) => own,
        Type::Text | Type::WideText => {
            let text = match constant {
                Constant::Text { bytes, .. } => (Type::Text, bytes.iter().map(|&byte| u16::from(byte)).collect()),
                Constant::WideText(units) => (Type::WideText, units.clone()),
                Constant::Typed { ty: Elementary::Char, bits } => (Type::Text, vec![*bits as u16]),
                Constant::Typed { ty: Elementary::Wchar, bits } => (Type::WideText, vec![*bits as u16]),
                _ => return Err(wrong()),
            };
            return Ok((AssertKind::Text, text.0, AssertConstant::Text(text.1)));
        }
        Type::DateAndTime | Type::Dtl => return moment(constant).ok_or_else(wrong),
    };
    // A pattern is equal to anything with its bits, even a NaN.
    let number = constant.integer();
    let raw = |kind: AssertKind| {
        let value = number.ok_or_else(wrong)?;
        let limit = 1i128 << own.bits();
        if !(-limit / 2..limit).contains(&value) {
            return Err(does_not_fit(&format!("type {}", own.name()), span));
        }
        bits(kind, own, value.rem_euclid(limit) as u64)
    };
    let fitted = |kind: AssertKind| match constant.bits(own) {
        Ok(value) => bits(kind, own, value),
        Err(crate::value::Mismatch::Range) => Err(does_not_fit(&format!("type {}", own.name()), span)),
        Err(crate::value::Mismatch::Type) => Err(wrong()),
    };
    match own.class() {
        Class::Float if is_pattern(constant) => raw(if is_order(op) { AssertKind::Float } else { AssertKind::Bits }),
        Class::Float => fitted(AssertKind::Float),
        Class::Duration => match constant {
            Constant::Typed { ty: other, bits: value } if other.class() == Class::Duration => {
                bits(AssertKind::Duration, *other, *value)
            }
            _ if own == Elementary::S5Time || is_pattern(constant) && !is_order(op) => raw(AssertKind::Bits),
            _ => raw(AssertKind::Whole),
        },
        Class::Date => match (constant, Type::Elementary(own).kind()) {
            (Constant::Typed { ty: other, bits: value }, kind)
                if other.class() == Class::Date && Type::Elementary(*other).kind() == kind =>
            {
                bits(kind, *other, *value)
            }
            (Constant::DateAndTime(_) | Constant::Dtl(_), AssertKind::Moment) => moment(constant).ok_or_else(wrong),
            _ => raw(AssertKind::Whole),
        },
        Class::Character => match number {
            Some(_) => raw(AssertKind::Whole),
            None => fitted(AssertKind::Text),
        },
        Class::Signed | Class::Unsigned => match constant {
            Constant::Real(value) => bits(AssertKind::Float, Elementary::Lreal, value.to_bits()),
            Constant::Text { .. } => match literal.loaded {
                Some(loaded) if loaded < 1 << own.bits().min(63) => bits(AssertKind::Bits, own, loaded),
                _ => Err(wrong()),
            },
            _ => fitted(AssertKind::Whole),
        },
        Class::Bits => fitted(AssertKind::Whole),
    }
}

fn moment(constant: &Constant) -> Option<(AssertKind, Type, AssertConstant)> {
    let (ty, constant) = match constant {
        Constant::DateAndTime(bytes) => (Type::DateAndTime, AssertConstant::Bits(u64::from_be_bytes(*bytes))),
        Constant::Dtl(bytes) => (Type::Dtl, AssertConstant::Bytes(bytes.to_vec())),
        Constant::Typed { ty: ty @ (Elementary::Date | Elementary::Ldt), bits } => {
            (Type::Elementary(*ty), AssertConstant::Bits(*bits))
        }
        _ => return None,
    };
    Some((AssertKind::Moment, ty, constant))
}

/// A constant next to another constant: its own type.
fn natural(literal: &Literal, span: Span) -> Result<(Type, AssertConstant), Mismatch> {
    let elementary = |ty, bits| Ok((Type::Elementary(ty), AssertConstant::Bits(bits)));
    let none = || Mismatch {
        span,
        title: "this constant cannot be compared with another one".to_string(),
        help: "compare a value with it".to_string(),
    };
    match (&literal.constant, literal.loaded) {
        (Some(Constant::Integer { value, .. }), _) => match i64::try_from(*value) {
            Ok(value) => elementary(Elementary::Lint, value as u64),
            Err(_) => elementary(Elementary::Ulint, *value as u64),
        },
        (Some(Constant::Real(value)), _) => elementary(Elementary::Lreal, value.to_bits()),
        (Some(Constant::Typed { ty, bits }), _) => elementary(*ty, *bits),
        (Some(Constant::Text { bytes, .. }), _) => {
            Ok((Type::Text, AssertConstant::Text(bytes.iter().map(|&byte| u16::from(byte)).collect())))
        }
        (Some(Constant::WideText(units)), _) => Ok((Type::WideText, AssertConstant::Text(units.clone()))),
        (Some(constant @ (Constant::DateAndTime(_) | Constant::Dtl(_))), _) => {
            moment(constant).map(|(_, ty, constant)| (ty, constant)).ok_or_else(none)
        }
        (None, Some(loaded)) => elementary(Elementary::Dword, loaded),
        (None, None) => Err(none()),
    }
}
