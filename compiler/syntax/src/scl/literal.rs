//! Constants of SCL as values. [`crate::literal`] reads constants that STEP 7 writes the same in every language.
//!
//! Source: SCL reference, constants; TIA Portal help, data types.

mod number;
mod text;
mod time;

use crate::elementary::Elementary;
use crate::literal::{self, LiteralError};
use crate::scl::ast::Literal;

/// A constant, and what to report about it although it is valid.
pub struct Read {
    pub value: Literal,
    /// Bits beyond the positive range of a signed type, `INT#16#FFFF`: the number that they represent.
    pub wrapped: Option<i64>,
}

impl From<Literal> for Read {
    fn from(value: Literal) -> Read {
        Read { value, wrapped: None }
    }
}

/// Reads a constant: a number without sign, one with `#`, a text in `'`, or a text of wide characters in `"` (IEC 61131-3).
pub fn parse(text: &str) -> Result<Read, LiteralError> {
    if text.starts_with('\'') {
        return text::string(text, text).map(|bytes| Literal::Text { bytes, typed: false }.into());
    }
    if text.starts_with('"') {
        return text::wide(text, text).map(|units| Literal::WideText(units).into());
    }
    let Some((prefix, value)) = text.split_once('#') else { return number::plain(text).map(Read::from) };
    if prefix.bytes().all(|byte| byte.is_ascii_digit() || byte == b'_') {
        let (value, _) = number::based(text, prefix, value)?;
        return Ok(Literal::Integer { value, based: true }.into());
    }
    let upper = prefix.to_ascii_uppercase();
    match upper.as_str() {
        "T" | "TIME" => time::duration(text, value).map(Read::from),
        "LT" | "LTIME" => time::long_duration(text, value).map(Read::from),
        "LDATE" => shared(text, &format!("D#{value}")),
        "LTOD" | "LTIME_OF_DAY" => time::long_time_of_day(text, value).map(Read::from),
        "LDT" | "DATE_AND_LTIME" | "LDATE_AND_TIME" => time::long_date_and_time(text, value).map(Read::from),
        "DTL" => time::dtl(text, value).map(Read::from),
        "STRING" => text::string(text, value).map(|bytes| Literal::Text { bytes, typed: true }.into()),
        "WSTRING" => text::wide(text, value).map(|units| Literal::WideText(units).into()),
        "CHAR" | "WCHAR" => text::character(text, &upper, value).map(Read::from),
        "B" => number::typed(text, Elementary::Byte, value),
        "W" => number::typed(text, Elementary::Word, value),
        "DW" => number::typed(text, Elementary::Dword, value),
        "LW" => number::typed(text, Elementary::Lword, value),
        "L" => number::typed(text, Elementary::Dint, value),
        "S5T" | "S5TIME" | "D" | "DATE" | "TOD" | "TIME_OF_DAY" | "DT" | "DATE_AND_TIME" | "P" | "C" | "Z" => {
            shared(text, text)
        }
        name => match Elementary::from_word(name) {
            Some(ty) => number::typed(text, ty, value),
            None => Err(LiteralError::malformed(
                text,
                format!("`{prefix}` is not a type of constants"),
                "write e.g. `INT#5` or `T#1s`",
            )),
        },
    }
}

/// A date of IEC 61131-3, whose editors count from 1970: an LDT. `None`: another constant.
pub fn iec_date(text: &str) -> Option<Result<Read, LiteralError>> {
    let (prefix, value) = text.split_once('#')?;
    match prefix.to_ascii_uppercase().as_str() {
        "D" | "DATE" => Some(time::date_from_1970(text, value).map(Read::from)),
        "DT" | "DATE_AND_TIME" => Some(time::long_date_and_time(text, value).map(Read::from)),
        _ => None,
    }
}

/// A constant that is written as in the other languages.
fn shared(text: &str, form: &str) -> Result<Read, LiteralError> {
    let typed = |ty, bits: u64| Ok(Literal::Typed { ty, bits }.into());
    match literal::parse(form)? {
        literal::Literal::S5Time(bits) => typed(Elementary::S5Time, bits.into()),
        literal::Literal::Date(days) => typed(Elementary::Date, days.into()),
        literal::Literal::TimeOfDay(ms) => typed(Elementary::TimeOfDay, ms.into()),
        literal::Literal::Counter(bits) => typed(Elementary::Word, bits.into()),
        literal::Literal::DateAndTime(bytes) => Ok(Literal::DateAndTime(bytes).into()),
        literal::Literal::Pointer(pointer) => Ok(Literal::Pointer { db: 0, pointer }.into()),
        literal::Literal::AreaPointer { db, pointer } => Ok(Literal::Pointer { db, pointer }.into()),
        literal::Literal::Any(bytes) => Ok(Literal::Any(bytes).into()),
        _ => Err(LiteralError::malformed(text, "no constant of SCL", "write e.g. `INT#5` or `T#1s`")),
    }
}
