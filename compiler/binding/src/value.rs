//! Constants: what `L` loads, and the bytes of a value of a type.

use plcc_syntax::literal::Literal;

use plcc_model::types::Elementary;

/// `DT#1990-1-1-0:0:0.0`, a Monday.
pub const DT_DEFAULT: [u8; 8] = [0x90, 0x01, 0x01, 0, 0, 0, 0, 0x02];

/// Why a constant is not a value of a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mismatch {
    /// Another type.
    Type,
    /// The value is outside the range of the type.
    Range,
}

/// Where a constant is: declarations accept a little more than calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// An initial value or a value after BEGIN.
    Declaration,
    /// An actual parameter.
    Call,
}

/// The bytes of `literal` as a value of `ty`, big-endian; a BOOL is one byte, 0 or 1.
pub fn elementary_bytes(ty: Elementary, literal: &Literal, place: Place) -> Result<Vec<u8>, Mismatch> {
    let declaration = place == Place::Declaration;
    let bits = |value: u32, limit: u32| if value <= limit { Ok(value) } else { Err(Mismatch::Range) };
    let word = |value: u16| Ok(value.to_be_bytes().to_vec());
    let dword = |value: u32| Ok(value.to_be_bytes().to_vec());
    match (ty, literal) {
        (Elementary::Bool, Literal::Bool(value)) => Ok(vec![u8::from(*value)]),
        (Elementary::Bool, Literal::Int(value)) if declaration => match value {
            0 | 1 => Ok(vec![*value as u8]),
            _ => Err(Mismatch::Range),
        },
        (Elementary::Bool, Literal::Bits { value, .. }) if declaration => Ok(vec![bits(*value, 1)? as u8]),
        (Elementary::Byte, Literal::Byte(value)) => Ok(vec![*value]),
        (Elementary::Byte, Literal::Bits { value, .. }) => Ok(vec![bits(*value, 0xFF)? as u8]),
        (Elementary::Word, Literal::Word(value) | Literal::Counter(value)) => word(*value),
        (Elementary::Word | Elementary::Int, Literal::Bits { value, .. }) => word(bits(*value, 0xFFFF)? as u16),
        (Elementary::Word, Literal::Bytes2(bytes)) => Ok(bytes.to_vec()),
        (Elementary::Dword, Literal::Dword(value)) => dword(*value),
        (Elementary::Dword | Elementary::Dint, Literal::Bits { value, .. }) => dword(*value),
        (Elementary::Dword, Literal::Bytes4(bytes)) => Ok(bytes.to_vec()),
        (Elementary::Dword, Literal::Pointer(value) | Literal::AreaPointer { db: 0, pointer: value }) => dword(*value),
        (Elementary::Char, Literal::Text(text)) => match text.as_slice() {
            [letter] => Ok(vec![*letter]),
            _ => Err(Mismatch::Range),
        },
        (Elementary::Int, Literal::Int(value)) => {
            i16::try_from(*value).map(|value| value.to_be_bytes().to_vec()).map_err(|_| Mismatch::Range)
        }
        (Elementary::Dint, Literal::Dint(value)) => dword(*value as u32),
        // Sources of the TIA Portal write DINT values without `L#`.
        (Elementary::Dint, Literal::Int(value)) if declaration => {
            i32::try_from(*value).map(|value| value.to_be_bytes().to_vec()).map_err(|_| Mismatch::Range)
        }
        (Elementary::Real, Literal::Real(value)) => dword(value.to_bits()),
        (Elementary::S5Time, Literal::S5Time(value)) => word(*value),
        (Elementary::Time, Literal::Time(value)) => dword(*value as u32),
        (Elementary::Date, Literal::Date(value)) => word(*value),
        (Elementary::TimeOfDay, Literal::TimeOfDay(value)) => dword(*value),
        _ => Err(Mismatch::Type),
    }
}

/// The bytes of a number without a type as an actual of type `ty`, as sources of the TIA Portal have them: `Rev := 0`, `LADDR := 320`.
/// `None`: it is not a number of this kind, or does not fit.
pub fn untyped_bytes(ty: Elementary, literal: &Literal) -> Option<Vec<u8>> {
    let value = match literal {
        Literal::Int(value) => *value,
        Literal::Bits { value, .. } => i64::from(*value),
        _ => return None,
    };
    let (low, high) = match ty {
        Elementary::Bool => (0, 1),
        Elementary::Byte | Elementary::Usint => (0, 0xFF),
        Elementary::Word | Elementary::Uint => (0, 0xFFFF),
        Elementary::Dword | Elementary::Udint => (0, 0xFFFF_FFFF),
        Elementary::Sint => (-0x80, 0x7F),
        Elementary::Dint => (i64::from(i32::MIN), i64::from(i32::MAX)),
        Elementary::Lint => (i64::MIN, i64::MAX),
        Elementary::Lword | Elementary::Ulint => (0, i64::MAX),
        _ => return None,
    };
    let bytes = (ty.bits().div_ceil(8)) as usize;
    (low..=high).contains(&value).then(|| value.to_be_bytes()[8 - bytes..].to_vec())
}

/// A REAL constant with the digits that an LREAL has, from its text: `0.1`, `LREAL#1.5e+3`. `None`: it is not a number.
pub fn long_real(text: &str) -> Option<f64> {
    let value = text.split_once('#').map_or(text, |(_, value)| value);
    let digits: String = value.chars().filter(|c| !matches!(c, '_' | ' ')).collect();
    digits.parse().ok()
}

/// A description of a constant, for messages.
pub const fn literal_kind(literal: &Literal) -> &'static str {
    match literal {
        Literal::Bool(_) => "a BOOL constant",
        Literal::Int(_) => "an INT constant",
        Literal::Dint(_) => "a DINT constant",
        Literal::Byte(_) => "a BYTE constant",
        Literal::Word(_) => "a WORD constant",
        Literal::Dword(_) => "a DWORD constant",
        Literal::Bits { .. } => "a bit pattern",
        Literal::Bytes2(_) => "a constant of 2 bytes",
        Literal::Bytes4(_) => "a constant of 4 bytes",
        Literal::Real(_) => "a REAL constant",
        Literal::S5Time(_) => "an S5TIME constant",
        Literal::Time(_) => "a TIME constant",
        Literal::Date(_) => "a DATE constant",
        Literal::TimeOfDay(_) => "a TIME_OF_DAY constant",
        Literal::DateAndTime(_) => "a DATE_AND_TIME constant",
        Literal::Counter(_) => "a counter value",
        Literal::Text(_) => "a text",
        Literal::Pointer(_) | Literal::AreaPointer { .. } => "a pointer constant",
        Literal::Any(_) => "an ANY constant",
    }
}

/// The value that `L literal` leaves in ACCU1, and whether all 32 bits belong to the constant.
///
/// An INT is zero-extended, even if negative. Source: STL reference, loading literals.
/// Errors: why it cannot be loaded, as text for a label.
pub fn loaded(literal: &Literal) -> Result<(u32, bool), String> {
    Ok(match literal {
        Literal::Int(value) => match i16::try_from(*value) {
            Ok(value) => (u32::from(value as u16), false),
            Err(_) => return Err("an INT goes from -32768 to 32767".to_string()),
        },
        Literal::Byte(value) => (u32::from(*value), false),
        Literal::Word(value) | Literal::S5Time(value) | Literal::Date(value) | Literal::Counter(value) => {
            (u32::from(*value), false)
        }
        Literal::Bytes2(bytes) => (u32::from(u16::from_be_bytes(*bytes)), false),
        Literal::Bytes4(bytes) => (u32::from_be_bytes(*bytes), true),
        Literal::Dint(value) | Literal::Time(value) => (*value as u32, true),
        Literal::Dword(value) | Literal::TimeOfDay(value) => (*value, true),
        Literal::Pointer(value) | Literal::AreaPointer { db: 0, pointer: value } => (*value, true),
        Literal::Bits { value, digits } => (*value, *digits > 16),
        Literal::Real(value) => (value.to_bits(), true),
        Literal::Text(text) if (1..=4).contains(&text.len()) => {
            (text.iter().fold(0, |value, &byte| value << 8 | u32::from(byte)), text.len() > 2)
        }
        Literal::Text(_) => return Err("1 to 4 characters fit into ACCU1".to_string()),
        Literal::AreaPointer { .. } => return Err("a pointer with a DB number has 48 bits".to_string()),
        Literal::Bool(_) | Literal::DateAndTime(_) | Literal::Any(_) => {
            return Err(format!("{} cannot be loaded", literal_kind(literal)));
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_as_l_loads_them() {
        assert_eq!(loaded(&Literal::Int(-1)), Ok((0x0000_FFFF, false)));
        assert_eq!(loaded(&Literal::Dint(-1)), Ok((0xFFFF_FFFF, true)));
        assert_eq!(loaded(&Literal::Text(b"ABC".to_vec())), Ok((0x0041_4243, true)));
        assert_eq!(loaded(&Literal::Bytes2([1, 8])), Ok((0x0108, false)));
        assert_eq!(loaded(&Literal::Bits { value: 0x1F, digits: 8 }), Ok((0x1F, false)));
        assert!(loaded(&Literal::Int(40_000)).is_err());
        assert!(loaded(&Literal::Bool(true)).is_err());
        assert!(loaded(&Literal::Text(b"ABCDE".to_vec())).is_err());
    }

    #[test]
    fn constants_in_memory() {
        let bytes = |ty, literal| elementary_bytes(ty, &literal, Place::Call);
        assert_eq!(bytes(Elementary::Int, Literal::Int(-2)), Ok(vec![0xFF, 0xFE]));
        assert_eq!(bytes(Elementary::Dint, Literal::Int(5)), Err(Mismatch::Type));
        assert_eq!(bytes(Elementary::Real, Literal::Real(1.0)), Ok(vec![0x3F, 0x80, 0, 0]));
        assert_eq!(bytes(Elementary::Byte, Literal::Bits { value: 0x100, digits: 12 }), Err(Mismatch::Range));
        assert_eq!(bytes(Elementary::Word, Literal::Counter(0x20)), Ok(vec![0, 0x20]));
        assert_eq!(bytes(Elementary::Time, Literal::Time(-1)), Ok(vec![0xFF; 4]));
        assert_eq!(bytes(Elementary::Bool, Literal::Int(1)), Err(Mismatch::Type));
        assert_eq!(untyped_bytes(Elementary::Bool, &Literal::Int(1)), Some(vec![1]));
        assert_eq!(untyped_bytes(Elementary::Word, &Literal::Int(320)), Some(vec![1, 0x40]));
        assert_eq!(untyped_bytes(Elementary::Byte, &Literal::Int(256)), None);
        assert_eq!(untyped_bytes(Elementary::Real, &Literal::Int(1)), None);
        assert_eq!(elementary_bytes(Elementary::Bool, &Literal::Int(1), Place::Declaration), Ok(vec![1]));
    }
}
