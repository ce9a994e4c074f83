//! Values that are known at compile time: constants of blocks, array bounds, CASE labels, initial values.
//!
//! [`fold`] computes operators, [`fit`] gives a constant the type of its context.

pub mod fit;
pub mod fold;

use plcc_syntax::scl::ast::Literal;
use plcc_syntax::{Elementary, literal};
use rustc_hash::FxHashMap;

/// A constant value.
#[derive(Clone, Debug, PartialEq)]
pub enum Constant {
    /// An integer without a type; `based` if it was written as bits (`16#FF`).
    Integer {
        value: i128,
        based: bool,
    },
    /// A floating-point number without a type.
    Real(f64),
    /// The bits, zero-extended from the width of the type.
    Typed {
        ty: Elementary,
        bits: u64,
    },
    /// In Windows-1252; if not `typed` and one character long, it may be a CHAR.
    Text {
        bytes: Vec<u8>,
        typed: bool,
    },
    WideText(Vec<u16>),
    DateAndTime([u8; 8]),
    Dtl([u8; 12]),
}

/// Constants of a block by folded name, for the binder.
pub type Constants = FxHashMap<String, Constant>;

impl Constant {
    /// A constant as STL writes it. Errors: pointers, which are not values of variables.
    pub fn of_stl(value: &literal::Literal) -> Option<Constant> {
        use literal::Literal;
        let typed = |ty, bits| Some(Constant::Typed { ty, bits });
        match value {
            Literal::Bool(value) => typed(Elementary::Bool, u64::from(*value)),
            Literal::Int(value) => Some(Constant::Integer { value: i128::from(*value), based: false }),
            Literal::Dint(value) => typed(Elementary::Dint, u64::from(*value as u32)),
            Literal::Byte(value) => typed(Elementary::Byte, u64::from(*value)),
            Literal::Word(value) | Literal::Counter(value) => typed(Elementary::Word, u64::from(*value)),
            Literal::Dword(value) => typed(Elementary::Dword, u64::from(*value)),
            Literal::Bits { value, .. } => Some(Constant::Integer { value: i128::from(*value), based: true }),
            Literal::Bytes2(bytes) => typed(Elementary::Word, u64::from(u16::from_be_bytes(*bytes))),
            Literal::Bytes4(bytes) => typed(Elementary::Dword, u64::from(u32::from_be_bytes(*bytes))),
            Literal::Real(value) => Some(Constant::Real(f64::from(*value))),
            Literal::S5Time(value) => typed(Elementary::S5Time, u64::from(*value)),
            Literal::Time(value) => typed(Elementary::Time, u64::from(*value as u32)),
            Literal::Date(value) => typed(Elementary::Date, u64::from(*value)),
            Literal::TimeOfDay(value) => typed(Elementary::TimeOfDay, u64::from(*value)),
            Literal::DateAndTime(bytes) => Some(Constant::DateAndTime(*bytes)),
            Literal::Text(bytes) => Some(Constant::Text { bytes: bytes.clone(), typed: false }),
            Literal::Pointer(_) | Literal::AreaPointer { .. } | Literal::Any(_) => None,
        }
    }

    /// The constant as STL writes it; `None`: STL has no constants of its type.
    pub fn in_stl(&self) -> Option<literal::Literal> {
        use literal::Literal;
        Some(match self {
            Constant::Integer { value, based: false } => Literal::Int(i64::try_from(*value).ok()?),
            Constant::Integer { value, based: true } => {
                let value = u32::try_from(*value).ok()?;
                Literal::Bits { value, digits: if value > 0xFFFF { 32 } else { 16 } }
            }
            Constant::Real(value) => Literal::Real(*value as f32),
            Constant::Typed { ty, bits } => match ty {
                Elementary::Bool => Literal::Bool(*bits != 0),
                Elementary::Byte => Literal::Byte(*bits as u8),
                Elementary::Char => Literal::Text(vec![*bits as u8]),
                Elementary::Word => Literal::Word(*bits as u16),
                Elementary::Dword => Literal::Dword(*bits as u32),
                Elementary::Sint | Elementary::Int => Literal::Int(i64::try_from(fit::integer_of(*ty, *bits)?).ok()?),
                Elementary::Usint | Elementary::Uint | Elementary::Udint => {
                    Literal::Bits { value: *bits as u32, digits: ty.bits() as u8 }
                }
                Elementary::Dint => Literal::Dint(*bits as i32),
                Elementary::Real => Literal::Real(f32::from_bits(*bits as u32)),
                Elementary::S5Time => Literal::S5Time(*bits as u16),
                Elementary::Time => Literal::Time(*bits as i32),
                Elementary::Date => Literal::Date(*bits as u16),
                Elementary::TimeOfDay => Literal::TimeOfDay(*bits as u32),
                _ => return None,
            },
            Constant::Text { bytes, .. } => Literal::Text(bytes.clone()),
            Constant::DateAndTime(bytes) => Literal::DateAndTime(*bytes),
            Constant::WideText(_) | Constant::Dtl(_) => return None,
        })
    }

    /// The constant for a literal of SCL; none for pointers, NIL and NULL.
    pub fn of_literal(value: &Literal) -> Option<Constant> {
        match value {
            Literal::Integer { value, based } => Some(Constant::Integer { value: i128::from(*value), based: *based }),
            Literal::Real(value) => Some(Constant::Real(*value)),
            Literal::Typed { ty, bits } => Some(Constant::Typed { ty: *ty, bits: *bits }),
            Literal::Text { bytes, typed } => Some(Constant::Text { bytes: bytes.clone(), typed: *typed }),
            Literal::WideText(text) => Some(Constant::WideText(text.clone())),
            Literal::DateAndTime(bytes) => Some(Constant::DateAndTime(*bytes)),
            Literal::Dtl(bytes) => Some(Constant::Dtl(*bytes)),
            Literal::Pointer { .. } | Literal::Any(_) | Literal::Nil | Literal::Null => None,
        }
    }

    /// Its value, if it is an integer or a bit string.
    pub fn integer(&self) -> Option<i128> {
        match self {
            Constant::Integer { value, .. } => Some(*value),
            Constant::Typed { ty, bits } => fit::integer_of(*ty, *bits),
            _ => None,
        }
    }

    /// A description of it, for messages.
    pub fn describe(&self) -> String {
        match self {
            Constant::Integer { .. } => "an integer constant".to_string(),
            Constant::Real(_) => "a REAL constant".to_string(),
            Constant::Typed { ty, .. } => format!("a constant of type {}", ty.name()),
            Constant::Text { .. } => "a text".to_string(),
            Constant::WideText(_) => "a WSTRING constant".to_string(),
            Constant::DateAndTime(_) => "a DATE_AND_TIME constant".to_string(),
            Constant::Dtl(_) => "a DTL constant".to_string(),
        }
    }
}
