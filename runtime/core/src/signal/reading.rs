//! A value that was read: as a text, a number and JSON.

use plcc_abi::image::AssertType;

use crate::address::{Bits, Width};
use crate::assertion::Value as TypedValue;
use crate::memory::Memory;
use crate::typed::{self, ValueType};
use crate::value;

/// A value that was read.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Bits(Bits, Width),
    /// A whole number of a type.
    Whole(i128),
    Number(f64),
    /// A value of another type.
    Typed(AssertType, TypedValue),
}

impl Value {
    /// Of a type.
    pub(super) fn typed(ty: AssertType, value: TypedValue, width: Width) -> Value {
        match (ty, &value) {
            (AssertType::Bool | AssertType::Bits(_), TypedValue::Bits(bits)) => Value::Bits(*bits, width),
            (AssertType::Real, TypedValue::Bits(bits)) => Value::Number(f32::from_bits(*bits as u32).into()),
            (_, TypedValue::Bits(bits)) => match typed::whole(ty, *bits) {
                Some(whole) => Value::Whole(whole),
                None => Value::Typed(ty, value),
            },
            _ => Value::Typed(ty, value),
        }
    }

    /// The value of an elementary type with these bits, zero-extended.
    pub fn of_type(ty: AssertType, bits: u64) -> Value {
        Value::typed(ty, TypedValue::Bits(bits), ValueType::of(ty).width(0))
    }

    /// The value of a type at an offset in memory; of a BOOL the bit.
    pub fn at(memory: &Memory, offset: u32, bit: u8, ty: ValueType) -> Value {
        let given = match typed::bits(ty.ty) {
            Some(1) => u64::from(memory.bit(offset, bit)),
            Some(8) => u64::from(memory.byte(offset)),
            Some(16) => u64::from(memory.word(offset)),
            Some(32) => u64::from(memory.dword(offset)),
            Some(_) => u64::from_be_bytes(memory.bytes(offset)),
            None => u64::from(offset),
        };
        let mut value = TypedValue::read(ty.ty, given, memory);
        // After the declared characters are other values, whatever the head says.
        if let TypedValue::Text(text) = &mut value {
            text.truncate(ty.length.into());
        }
        Value::typed(ty.ty, value, ty.width(bit))
    }

    /// Writes the text of a value of a type to an offset in memory. `Err`: the error as a sentence.
    pub fn put(memory: &Memory, offset: u32, bit: u8, ty: ValueType, text: &str) -> Result<(), String> {
        match (typed::parse(text, ty)?, typed::bits(ty.ty)) {
            (TypedValue::Bits(bits), Some(1)) => memory.set_bit(offset, bit, bits != 0),
            (TypedValue::Bits(bits), Some(8)) => memory.set_byte(offset, bits as u8),
            (TypedValue::Bits(bits), Some(16)) => memory.set_word(offset, bits as u16),
            (TypedValue::Bits(bits), Some(32)) => memory.set_dword(offset, bits as u32),
            (TypedValue::Bits(bits), _) => memory.set_bytes(offset, bits.to_be_bytes()),
            (TypedValue::Bytes(bytes), _) => memory.load(offset, &bytes),
            // The head has the declared length, then the one of the value.
            (TypedValue::Text(text), _) if ty.ty == AssertType::WideText => {
                memory.set_word(offset + 2, text.len() as u16);
                (0u32..).zip(&text).for_each(|(number, unit)| memory.set_word(offset + 4 + 2 * number, *unit));
            }
            (TypedValue::Text(text), _) => {
                memory.set_byte(offset + 1, text.len() as u8);
                (0u32..).zip(&text).for_each(|(number, unit)| memory.set_byte(offset + 2 + number, *unit as u8));
            }
        }
        Ok(())
    }

    /// As `--print` writes it.
    pub fn text(&self) -> String {
        match self {
            Value::Bits(bits, width) => value::text(*bits, *width),
            Value::Whole(whole) => whole.to_string(),
            Value::Number(number) => number_text(*number),
            Value::Typed(AssertType::Lreal, _) => self.number().map_or_else(String::new, short),
            Value::Typed(ty, value) => value.typed_text(*ty),
        }
    }

    /// As a number, a duration in seconds; `None`: a text or a date.
    pub fn number(&self) -> Option<f64> {
        match self {
            Value::Bits(bits, _) => Some(*bits as f64),
            Value::Whole(whole) => Some(*whole as f64),
            Value::Number(number) => Some(*number),
            Value::Typed(AssertType::Lreal, TypedValue::Bits(bits)) => Some(f64::from_bits(*bits)),
            Value::Typed(ty, value) => value.seconds(*ty),
        }
    }

    /// As [`Value::number`], of a REAL as a user would write it: 0.1, not 0.10000000149011612.
    pub fn written_number(&self) -> Option<f64> {
        match self {
            Value::Number(number) if f64::from(*number as f32) == *number => Some(shortest(*number as f32)),
            Value::Number(_) | Value::Bits(..) | Value::Whole(_) | Value::Typed(..) => self.number(),
        }
    }

    /// As JSON: a number, true or false where it is one, else a text.
    pub fn json(&self) -> serde_json::Value {
        match self {
            Value::Bits(bits, Width::Bit(_)) => (*bits != 0).into(),
            Value::Bits(bits, _) => (*bits).into(),
            Value::Whole(whole) => match (i64::try_from(*whole), u64::try_from(*whole)) {
                (Ok(whole), _) => whole.into(),
                (_, Ok(whole)) => whole.into(),
                _ => whole.to_string().into(),
            },
            // NaN and infinite numbers are null.
            Value::Number(number) => number_text(*number).parse::<f64>().unwrap_or(*number).into(),
            Value::Typed(AssertType::Lreal, _) => self.number().into(),
            Value::Typed(
                AssertType::Text | AssertType::WideText | AssertType::Char | AssertType::Wchar,
                TypedValue::Bits(_) | TypedValue::Text(_) | TypedValue::Bytes(_),
            ) => self.plain_text().into(),
            Value::Typed(..) => self.text().into(),
        }
    }

    /// As [`Value::json`], for other programs: a REAL has all digits that tell it from its neighbours, not six.
    pub fn exact_json(&self) -> serde_json::Value {
        match self {
            // The value of an analog channel is computed, and its last digits mean nothing.
            Value::Number(number) if f64::from(*number as f32) == *number => shortest(*number as f32).into(),
            Value::Number(_) | Value::Bits(..) | Value::Whole(_) | Value::Typed(..) => self.json(),
        }
    }

    /// A text without quotes.
    pub fn plain_text(&self) -> String {
        match self {
            Value::Typed(ty, value) => value.plain_text(*ty),
            Value::Bits(..) | Value::Whole(_) | Value::Number(_) => self.text(),
        }
    }
}

/// The number with the fewest digits that mean this REAL: 0.1, not 0.10000000149011612.
fn shortest(real: f32) -> f64 {
    // No `-0`.
    real.to_string().parse().unwrap_or(f64::from(real)) + 0.0
}

/// Up to this number a REAL holds each integer.
const WHOLE_MAX: f64 = 16_777_216.0;

/// Six digits, the precision of a REAL; of an integer that a REAL holds all digits.
pub fn number_text(number: f64) -> String {
    let is_whole = number.fract() == 0.0 && number.abs() <= WHOLE_MAX;
    let rounded = if is_whole { number } else { format!("{number:.5e}").parse::<f64>().unwrap_or(number) };
    // No `-0`.
    short(rounded + 0.0)
}

/// With an exponent where most digits would be zeros.
fn short(number: f64) -> String {
    let size = number.abs();
    let is_long = size.is_finite() && (size >= 1e16 || size > 0.0 && size < 1e-9);
    if is_long { format!("{number:e}") } else { number.to_string() }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value as Json, json};

    use super::{Value, number_text};

    #[test]
    fn integers_have_all_their_digits() {
        let texts = [1_234_567.0, -16_777_216.0, 1_234_567.5, f64::from(0.1f32), -0.0].map(number_text);
        assert_eq!(texts, ["1234567", "-16777216", "1234570", "0.1", "0"]);
    }

    #[test]
    fn numbers_far_from_one_have_an_exponent() {
        let texts = [1e300, -2.5e-12, 1.5e15, 0.001, 0.0, -0.0].map(number_text);
        assert_eq!(texts, ["1e300", "-2.5e-12", "1500000000000000", "0.001", "0", "0"]);
        assert_eq!(number_text(f64::INFINITY), "inf");
    }

    #[test]
    fn other_programs_get_every_digit_of_a_real() {
        let of = |real: f32| Value::Number(real.into()).exact_json();
        assert_eq!(of(1_234_567.0), json!(1_234_567.0));
        assert_eq!(of(33.0 / 7.0), json!(4.714286));
        assert_eq!(of(0.1), json!(0.1));
        assert_eq!(of(1e38), json!(1e38));
        assert_eq!(of(-0.0).to_string(), "0.0");
        assert_eq!((of(f32::NAN), of(f32::INFINITY)), (Json::Null, Json::Null));
        // Of an analog channel.
        assert_eq!(Value::Number(12.000_000_000_000_002).exact_json(), json!(12.0));
    }
}
