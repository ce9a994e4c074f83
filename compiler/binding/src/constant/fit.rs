//! Constants as values of the type that their context has.
//!
//! Source: SCL reference, implicit conversion and type of a literal. Unlike variables, constants must not lose anything in an
//! implicit conversion: their value is known.

use plcc_syntax::{Class, Elementary};

use super::Constant;
use crate::value::Mismatch;
use plcc_model::layout;
use plcc_model::types::{DTL, DataType};

impl Constant {
    /// The bits as a value of `ty`, zero-extended from its width.
    pub fn bits(&self, ty: Elementary) -> Result<u64, Mismatch> {
        match self {
            Constant::Integer { value, based } => untyped(*value, *based, ty),
            Constant::Real(value) => match ty {
                Elementary::Real => real(*value),
                Elementary::Lreal => Ok(value.to_bits()),
                _ => Err(Mismatch::Type),
            },
            Constant::Typed { ty: own, bits } => convert(*own, *bits, ty),
            Constant::Text { bytes, .. } => match (ty, bytes.as_slice()) {
                (Elementary::Char, [letter]) => Ok(u64::from(*letter)),
                (Elementary::Wchar, [letter]) => Ok(u64::from(wide(*letter))),
                (Elementary::Char | Elementary::Wchar, _) => Err(Mismatch::Range),
                _ => Err(Mismatch::Type),
            },
            Constant::WideText(text) => match (ty, text.as_slice()) {
                (Elementary::Wchar, [letter]) => Ok(u64::from(*letter)),
                (Elementary::Wchar, _) => Err(Mismatch::Range),
                _ => Err(Mismatch::Type),
            },
            Constant::DateAndTime(_) | Constant::Dtl(_) => Err(Mismatch::Type),
        }
    }
}

/// The bytes as a variable of type `ty`, big-endian; a BOOL is one byte, 0 or 1.
pub fn bytes(constant: &Constant, ty: &DataType) -> Result<Vec<u8>, Mismatch> {
    match (ty, constant) {
        (DataType::Elementary(ty), _) => {
            let bits = constant.bits(*ty)?;
            let bytes = ty.bits().div_ceil(8) as usize;
            Ok(bits.to_be_bytes()[8 - bytes..].to_vec())
        }
        (DataType::DateAndTime, Constant::DateAndTime(bytes)) => Ok(bytes.to_vec()),
        (DataType::String(length), Constant::Text { bytes: text, .. }) => {
            if text.len() > usize::from(*length) {
                return Err(Mismatch::Range);
            }
            let mut bytes = vec![0; layout::bytes(ty) as usize];
            bytes[0] = *length;
            bytes[1] = text.len() as u8;
            bytes[2..2 + text.len()].copy_from_slice(text);
            Ok(bytes)
        }
        (DataType::String(_), Constant::Typed { ty: Elementary::Char, bits }) => {
            self::bytes(&Constant::Text { bytes: vec![*bits as u8], typed: true }, ty)
        }
        (DataType::WideString(length), Constant::WideText(text)) => {
            if text.len() > usize::from(*length) {
                return Err(Mismatch::Range);
            }
            let header = [*length, text.len() as u16];
            let mut bytes: Vec<u8> = header.iter().chain(text).flat_map(|word| word.to_be_bytes()).collect();
            bytes.resize(layout::bytes(ty) as usize, 0);
            Ok(bytes)
        }
        (DataType::WideString(_), Constant::Text { bytes: text, .. }) => {
            self::bytes(&Constant::WideText(text.iter().map(|&letter| wide(letter)).collect()), ty)
        }
        (DataType::WideString(_), Constant::Typed { ty: Elementary::Wchar, bits }) => {
            self::bytes(&Constant::WideText(vec![*bits as u16]), ty)
        }
        (DataType::Struct(structure), Constant::Dtl(bytes)) if structure.name == DTL => Ok(bytes.to_vec()),
        _ => Err(Mismatch::Type),
    }
}

/// The character of a byte of Windows-1252.
fn wide(letter: u8) -> u16 {
    // A single byte above ASCII is not valid UTF-8.
    plcc_syntax::decode(&[letter]).encode_utf16().next().unwrap_or(u16::from(letter))
}

/// All bits of a type.
pub const fn mask(ty: Elementary) -> u64 {
    u64::MAX >> (64 - ty.bits())
}

/// The bits as a signed number of the width of `ty`.
pub const fn signed(ty: Elementary, bits: u64) -> i128 {
    let unused = 64 - ty.bits();
    ((bits << unused) as i64 >> unused) as i128
}

/// The value of bits of an integer or bit string type.
pub const fn integer_of(ty: Elementary, bits: u64) -> Option<i128> {
    match ty.class() {
        Class::Signed => Some(signed(ty, bits)),
        Class::Unsigned => Some(bits as i128),
        Class::Bits if !matches!(ty, Elementary::Bool) => Some(bits as i128),
        Class::Bits | Class::Float | Class::Character | Class::Duration | Class::Date => None,
    }
}

/// The bits of `value` as a number of type `ty`, if it fits the type.
pub fn in_range(ty: Elementary, value: i128) -> Option<u64> {
    let width = ty.bits();
    let (low, high) =
        if ty.is_signed() { (-(1i128 << (width - 1)), (1i128 << (width - 1)) - 1) } else { (0, (1i128 << width) - 1) };
    (low..=high).contains(&value).then_some(value as u64 & mask(ty))
}

/// An integer without a type. Bits (`16#FFFF`) also mean the negative number with this pattern.
fn untyped(value: i128, based: bool, ty: Elementary) -> Result<u64, Mismatch> {
    match ty.class() {
        // Every integer that can be written fits a REAL.
        Class::Float if ty == Elementary::Real => Ok(u64::from((value as f32).to_bits())),
        Class::Float => Ok((value as f64).to_bits()),
        Class::Bits | Class::Signed | Class::Unsigned => {
            let half = 1i128 << (ty.bits() - 1);
            let pattern = based && ty != Elementary::Bool && (-half..2 * half).contains(&value);
            if pattern { Ok(value as u64 & mask(ty)) } else { in_range(ty, value).ok_or(Mismatch::Range) }
        }
        Class::Character | Class::Duration | Class::Date => Err(Mismatch::Type),
    }
}

/// Whether the digits of a number, not the LREAL that is nearest to them, decide which REAL is nearest: the LREAL is halfway between two.
pub fn is_halfway(value: f64) -> bool {
    let near = value as f32;
    let rest = value - f64::from(near);
    let other = if rest > 0.0 { near.next_up() } else { near.next_down() };
    rest != 0.0 && f64::from(other) - value == rest
}

/// The REAL that is nearest to the number in a text, if that number is `value`.
pub fn nearest_real(value: f64, text: &str) -> Option<f32> {
    let digits: String = text.chars().filter(|letter| !matches!(letter, '_' | ' ')).collect();
    if !digits.trim_start_matches(['+', '-']).starts_with(|first: char| first.is_ascii_digit()) {
        return None;
    }
    let (long, short): (f64, f32) = (digits.parse().ok()?, digits.parse().ok()?);
    (long == value).then_some(short)
}

fn real(value: f64) -> Result<u64, Mismatch> {
    let narrow = value as f32;
    if narrow.is_infinite() && value.is_finite() { Err(Mismatch::Range) } else { Ok(u64::from(narrow.to_bits())) }
}

/// A value of type `own` where one of type `ty` is needed.
fn convert(own: Elementary, bits: u64, ty: Elementary) -> Result<u64, Mismatch> {
    if own == ty {
        return Ok(bits);
    }
    let same_width = own.bits() == ty.bits();
    match (own.class(), ty.class()) {
        (Class::Bits, Class::Bits) => in_range(ty, i128::from(bits)).ok_or(Mismatch::Range),
        (Class::Signed | Class::Unsigned | Class::Bits, Class::Signed | Class::Unsigned | Class::Bits) => {
            match integer_of(own, bits) {
                // The pattern: 16#FFFF is the INT -1.
                Some(_) if same_width && (own.class() == Class::Bits || ty.class() == Class::Bits) => Ok(bits),
                Some(value) => in_range(ty, value).ok_or(Mismatch::Range),
                None => Err(Mismatch::Type),
            }
        }
        (Class::Signed | Class::Unsigned, Class::Float) => match integer_of(own, bits) {
            Some(value) => untyped(value, false, ty),
            None => Err(Mismatch::Type),
        },
        (Class::Float, Class::Float) if ty == Elementary::Lreal => Ok(f64::from(f32::from_bits(bits as u32)).to_bits()),
        (Class::Character, Class::Character) if ty == Elementary::Wchar => Ok(u64::from(wide(bits as u8))),
        (Class::Duration, Class::Duration) => match (own, ty) {
            (Elementary::Time, Elementary::S5Time) => s5time(signed(own, bits)).ok_or(Mismatch::Range),
            (Elementary::Time, Elementary::Ltime) => Ok((signed(own, bits) * 1_000_000) as u64),
            _ => Err(Mismatch::Type),
        },
        // Relaxed: the pattern of a duration or date, or of a byte as a character.
        (Class::Bits, Class::Duration | Class::Date | Class::Character)
        | (Class::Duration | Class::Date | Class::Character, Class::Bits)
            if same_width =>
        {
            Ok(bits)
        }
        (Class::Signed | Class::Unsigned, Class::Duration) | (Class::Duration, Class::Signed | Class::Unsigned)
            if same_width && ty != Elementary::S5Time && own != Elementary::S5Time =>
        {
            Ok(bits)
        }
        _ => Err(Mismatch::Type),
    }
}

/// Milliseconds in the finest time base that has room for them; digits below it are cut off. Source: STL reference, S5TIME.
fn s5time(ms: i128) -> Option<u64> {
    if !(0..=9_990_000).contains(&ms) {
        return None;
    }
    let (base, unit) = [(0, 10), (1, 100), (2, 1_000), (3, 10_000)].into_iter().find(|(_, unit)| ms / unit <= 999)?;
    let units = (ms / unit) as u64;
    Some(base << 12 | (units / 100) << 8 | (units / 10 % 10) << 4 | (units % 10))
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn int(value: i128) -> Constant {
        Constant::Integer { value, based: false }
    }

    const fn based(value: i128) -> Constant {
        Constant::Integer { value, based: true }
    }

    const fn of(ty: Elementary, bits: u64) -> Constant {
        Constant::Typed { ty, bits }
    }

    #[test]
    fn untyped_numbers_fit_what_holds_them() {
        assert_eq!(int(-1).bits(Elementary::Int), Ok(0xFFFF));
        assert_eq!(int(200).bits(Elementary::Usint), Ok(200));
        assert_eq!(int(200).bits(Elementary::Sint), Err(Mismatch::Range));
        assert_eq!(based(0xFFFF).bits(Elementary::Int), Ok(0xFFFF));
        assert_eq!(int(65_535).bits(Elementary::Int), Err(Mismatch::Range));
        assert_eq!(int(1).bits(Elementary::Bool), Ok(1));
        assert_eq!(based(2).bits(Elementary::Bool), Err(Mismatch::Range));
        assert_eq!(int(3).bits(Elementary::Real), Ok(0x4040_0000));
        assert_eq!(int(3).bits(Elementary::Time), Err(Mismatch::Type));
        assert_eq!(Constant::Real(1e39).bits(Elementary::Real), Err(Mismatch::Range));
        assert_eq!(int(9_007_199_791_611_905).bits(Elementary::Real), Ok(0x5A00_0001));
        assert_eq!(Constant::Real(0.5).bits(Elementary::Lreal), Ok(0x3FE0_0000_0000_0000));
        assert_eq!(Constant::Real(1.0).bits(Elementary::Int), Err(Mismatch::Type));
    }

    /// Source: SCL reference, implicit conversion.
    #[test]
    fn typed_values_convert() {
        assert_eq!(of(Elementary::Int, 0xFFFB).bits(Elementary::Dint), Ok(0xFFFF_FFFB));
        assert_eq!(of(Elementary::Int, 5).bits(Elementary::Real), Ok(0x40A0_0000));
        assert_eq!(of(Elementary::Word, 0xFFFF).bits(Elementary::Int), Ok(0xFFFF));
        assert_eq!(of(Elementary::Dint, 70_000).bits(Elementary::Int), Err(Mismatch::Range));
        assert_eq!(of(Elementary::Bool, 1).bits(Elementary::Int), Err(Mismatch::Type));
        assert_eq!(of(Elementary::Time, 12_300).bits(Elementary::S5Time), Ok(0x1123));
        assert_eq!(of(Elementary::Real, 0x3F80_0000).bits(Elementary::Int), Err(Mismatch::Type));
    }

    #[test]
    fn texts() {
        let text = |text: &str| Constant::Text { bytes: text.as_bytes().to_vec(), typed: false };
        assert_eq!(text("a").bits(Elementary::Char), Ok(0x61));
        assert_eq!(text("ab").bits(Elementary::Char), Err(Mismatch::Range));
        assert_eq!(bytes(&text("ab"), &DataType::String(3)), Ok(vec![3, 2, b'a', b'b', 0, 0]));
        assert_eq!(bytes(&text("abcd"), &DataType::String(3)), Err(Mismatch::Range));
        assert_eq!(
            bytes(&Constant::WideText(vec![0x20AC]), &DataType::WideString(2)),
            Ok(vec![0, 2, 0, 1, 0x20, 0xAC, 0, 0])
        );
        let euro = Constant::Text { bytes: vec![0x80], typed: false };
        assert_eq!(bytes(&euro, &DataType::WideString(1)), Ok(vec![0, 1, 0, 1, 0x20, 0xAC]));
    }

    #[test]
    fn rounds_digits_once() {
        let text = "-1.000_000_178_813_934_326_171_874_99";
        let value = -1.000_000_178_813_934_3;
        assert!(is_halfway(value));
        assert_eq!(nearest_real(value, text).map(f32::to_bits), Some(0xBF80_0001));
        assert_eq!(nearest_real(value, "infinity"), None);
        assert_eq!(nearest_real(value, "2.5"), None);
        assert!(!is_halfway(0.1) && !is_halfway(1.5) && !is_halfway(0.0) && !is_halfway(f64::MAX));
    }
}
