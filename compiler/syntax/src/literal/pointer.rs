//! Pointers `P#…` and ANY pointers.

use super::{Literal, LiteralError, pointer_bits};

/// Data types that an ANY pointer names, with their codes. Source: Programming with STEP 7, format of POINTER and ANY.
pub const ANY_TYPES: &[(&str, u8)] = &[
    ("VOID", 0x00),
    ("NIL", 0x00),
    ("BOOL", 0x01),
    ("BYTE", 0x02),
    ("CHAR", 0x03),
    ("WORD", 0x04),
    ("INT", 0x05),
    ("DWORD", 0x06),
    ("DINT", 0x07),
    ("REAL", 0x08),
    ("DATE", 0x09),
    ("TIME_OF_DAY", 0x0A),
    ("TOD", 0x0A),
    ("TIME", 0x0B),
    ("S5TIME", 0x0C),
    ("DATE_AND_TIME", 0x0E),
    ("DT", 0x0E),
    ("STRING", 0x13),
    ("BLOCK_FB", 0x17),
    ("BLOCK_FC", 0x18),
    ("BLOCK_DB", 0x19),
    ("BLOCK_SDB", 0x1A),
    ("COUNTER", 0x1C),
    ("TIMER", 0x1D),
];

/// Area letters of pointers in both mnemonic sets, with area codes. Source: Programming with STEP 7, format of POINTER and ANY.
const AREAS: &[(&str, u8)] = &[
    ("P", 0x80),
    ("I", 0x81),
    ("E", 0x81),
    ("Q", 0x82),
    ("A", 0x82),
    ("M", 0x83),
    ("DBX", 0x84),
    ("DB", 0x84),
    ("DIX", 0x85),
    ("DI", 0x85),
    ("L", 0x86),
    ("V", 0x87),
    ("C", 0x7B),
    ("Z", 0x7B),
    ("T", 0x7C),
];

const NAME_FORM: &str =
    "write area, byte and bit, as in `P#DB10.DBX 20.0`; as an actual parameter pass the variable itself, without `P#`";

const FORM: &str = "write `P#10.3`, `P#M 10.0`, `P#DB10.DBX 20.0`, or with type and number `P#DB11.DBX 20.0 INT 10`";

/// `10.3`, `M 10.0`, `DB10.DBX 20.0`, `DB11.DBX 20.0 INT 10`.
pub fn pointer(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let (db, rest) = data_block(text, value)?;
    let malformed = |label: &str| {
        let help = match meant(text, rest, db.is_some()) {
            Some(meant) => format!("write `{meant}`"),
            None => FORM.to_owned(),
        };
        LiteralError::malformed(text, label, help)
    };
    let letters = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
    let is_name = letters > 0
        && (rest[letters..].starts_with('_')
            || AREAS.iter().all(|(name, _)| !name.eq_ignore_ascii_case(&rest[..letters])));
    if db.is_some() && is_name && meant(text, rest, true).is_none() {
        return Err(LiteralError::malformed(text, "the name of a variable instead of its address", NAME_FORM));
    }
    let area = &rest[..letters];
    let code = AREAS.iter().find(|(name, _)| name.eq_ignore_ascii_case(area)).map(|(_, code)| *code);
    if code.is_none() && !area.is_empty() {
        let is_variable = rest.chars().all(|c| c.is_alphanumeric() || c == '_');
        if db.is_none() && is_variable && meant(text, rest, false).is_none() {
            let help = format!(
                "in STL `P##{rest}` is the address of a variable of the block; a constant names an area, as in `P#M 10.0`"
            );
            return Err(LiteralError::malformed(text, format!("`{rest}` is not an area"), help));
        }
        return Err(malformed(&format!("`{area}` is not an area")));
    }
    let mut words = rest[letters..].split_ascii_whitespace();
    let address = words.next().ok_or_else(|| malformed("not an address"))?;
    let (byte, bit) = address.split_once('.').ok_or_else(|| malformed("the bit number is missing"))?;
    let bits = address_bits(text, byte, bit)?;
    let Some(code) = code else {
        return match (db, words.next()) {
            (None, None) => Ok(Literal::Pointer(bits)),
            _ => Err(malformed("the area is missing")),
        };
    };
    if db.is_some() && !matches!(code, 0x84 | 0x85) {
        return Err(malformed("`DBX` must follow the data block"));
    }
    let (db, pointer) = (db.unwrap_or(0), u32::from(code) << 24 | bits);
    let Some(type_name) = words.next() else {
        return Ok(Literal::AreaPointer { db, pointer });
    };
    let type_code = ANY_TYPES.iter().find(|(name, _)| name.eq_ignore_ascii_case(type_name)).map(|(_, code)| *code);
    let type_code = type_code.ok_or_else(|| malformed(&format!("`{type_name}` is not a data type")))?;
    let count = words.next().ok_or_else(|| malformed("the number of elements is missing"))?;
    let count: u16 = count.replace('_', "").parse().map_err(|_| {
        LiteralError::range(text, "not a number of elements", "an ANY pointer counts 0 to 65535 elements")
    })?;
    if words.next().is_some() {
        return Err(malformed("surplus text after the number of elements"));
    }
    let mut any = [0x10, type_code, 0, 0, 0, 0, 0, 0, 0, 0];
    any[2..4].copy_from_slice(&count.to_be_bytes());
    any[4..6].copy_from_slice(&db.to_be_bytes());
    // The pointer of timers and counters is the number of the first, without an area. Source: Programming with STEP 7, format of
    // parameter type ANY for parameter types.
    let numbered = matches!((type_code, code), (0x1C, 0x7B) | (0x1D, 0x7C));
    let place = if numbered { bits >> 3 } else { pointer };
    any[6..10].copy_from_slice(&place.to_be_bytes());
    Ok(Literal::Any(any))
}

/// Number of the data block before the dot, and what follows.
fn data_block<'t>(text: &str, value: &'t str) -> Result<(Option<u16>, &'t str), LiteralError> {
    let prefix = value.get(..2).unwrap_or("");
    let rest = value.get(2..).unwrap_or("").trim_start();
    if !(prefix.eq_ignore_ascii_case("DB") || prefix.eq_ignore_ascii_case("DI"))
        || !rest.starts_with(|c: char| c.is_ascii_digit())
    {
        return Ok((None, value));
    }
    let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    let Some(address) = rest[digits..].trim_start().strip_prefix('.') else {
        let (block, tail) = text.split_at(text.len() - rest[digits..].len());
        let is_whole = prefix.eq_ignore_ascii_case("DB") && (tail.is_empty() || tail.starts_with([' ', '\t']));
        let help = if is_whole { format!("write `{block}.DBX 0.0{tail}`") } else { FORM.to_owned() };
        return Err(LiteralError::malformed(text, "not an address", help));
    };
    // `P#DB 5.3` does not occur: an area follows the dot.
    let number = rest[..digits]
        .parse()
        .map_err(|_| LiteralError::range(text, "not a data block", "data blocks are numbered 1 to 65535"))?;
    Ok((Some(number), address.trim_start()))
}

/// The pointer that is meant where an address has the letters of a width or no bit, or no area follows a data block: `P#M 10.0` for
/// `P#MW 10`. `rest` is the end of `text`, from the letters of the area on.
fn meant(text: &str, rest: &str, in_block: bool) -> Option<String> {
    let before = &text[..text.len() - rest.len()];
    let letters = rest.find(|c: char| !c.is_ascii_alphabetic())?;
    let (area, address) = rest.split_at(letters);
    let (blanks, address) = address.split_at(address.len() - address.trim_start().len());
    let end = address.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(address.len());
    let (number, tail) = address.split_at(end);
    let bit = match number.split_once('.') {
        Some((byte, bit)) if byte.is_empty() || bit.is_empty() || bit.contains('.') => return None,
        Some(_) => "",
        None if number.is_empty() => return None,
        None => ".0",
    };
    let meant = match area.to_ascii_uppercase().as_str() {
        "" if in_block => format!("{before}DBX {number}{bit}{tail}"),
        "DBB" | "DBW" | "DBD" => format!("{before}DBX{blanks}{number}{bit}{tail}"),
        "DIB" | "DIW" | "DID" => format!("{before}DIX{blanks}{number}{bit}{tail}"),
        upper if AREAS.iter().any(|(name, _)| *name == upper) || upper.is_empty() => {
            format!("{before}{area}{blanks}{number}{bit}{tail}")
        }
        upper => {
            let area = upper.strip_suffix(['B', 'W', 'D']).filter(|_| !in_block)?;
            let area = if ["PI", "PE", "PQ", "PA"].contains(&area) { "P" } else { area };
            let known = area.len() == 1 && AREAS.iter().any(|(name, _)| *name == area);
            known.then(|| format!("{before}{area}{blanks}{number}{bit}{tail}"))?
        }
    };
    (meant != text).then_some(meant)
}

/// Byte and bit as bits.
fn address_bits(text: &str, byte: &str, bit: &str) -> Result<u32, LiteralError> {
    let digits = |number: &str| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit());
    if !digits(byte) || !digits(bit) {
        return Err(LiteralError::malformed(text, "not an address", FORM));
    }
    match (byte.parse::<u32>(), bit.parse::<u8>()) {
        (Ok(byte @ 0..=65_535), Ok(bit @ 0..=7)) => Ok(pointer_bits(byte, bit)),
        _ => {
            let help = match crate::scl::address::with_carried_bit(text) {
                Some(meant) => format!("the bit is from 0 to 7: is `{meant}` meant?"),
                None => "the byte is from 0 to 65535, the bit from 0 to 7".to_string(),
            };
            Err(LiteralError::range(text, "not an address", help))
        }
    }
}
