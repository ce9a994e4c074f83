//! Numbers as text, and back.
//!
//! - as STEP 7 V5 has it: FC 5, 16, 30, 37 to 39, and `X_TO_STRING` of the TIA Portal;
//! - as S_CONV, STRG_VAL and VAL_STRG of the TIA Portal have it.
//!
//! Source: STL reference, IEC function library; S7-1200 reference, string conversion.

use std::fmt::Write as _;

use plcc_abi::text::UNSIGNED;

use super::any::Access;
use super::parameters::Call;
use super::text::{self, Buffer, CUT, INVALID, Text};
use super::{OK, Outcome, error};
use crate::memory::Bytes;
use crate::text::way::Way;
use crate::text::{decimal, give_whole, real};

/// Value of a LINT, or with UNSIGNED of a ULINT.
fn integer(bits: u64, form: u16) -> i128 {
    if form & UNSIGNED != 0 { i128::from(bits) } else { i128::from(bits as i64) }
}

/// IN LINT, FORM -> RET_VAL, OUT STRING. A string that is too short does not change.
pub(super) fn of_integer(call: &Call) -> Outcome {
    let out = text::of(call, 3, Access::Write);
    match (decimal::write_long(call.cpu.memory.bytes_at(), call.lword(0), call.word(1), out), out) {
        (true, _) => OK,
        (false, Some(_)) => error(CUT),
        (false, None) => error(INVALID),
    }
}

/// IN DINT, FORM -> OUT STRING, as [`of_integer`].
pub(super) fn of_dint(call: &Call) -> Outcome {
    let value = call.dword(0) as i32;
    Outcome::Flag(decimal::write(call.cpu.memory.bytes_at(), value, call.word(1), text::of(call, 2, Access::Write)))
}

/// As [`of_dint`], of an INT.
pub(super) fn of_int(call: &Call) -> Outcome {
    let value = i32::from(call.word(0) as i16);
    Outcome::Flag(decimal::write(call.cpu.memory.bytes_at(), value, call.word(1), text::of(call, 2, Access::Write)))
}

/// IN REAL -> OUT STRING: `+1.2345678E+01`, 14 characters.
pub(super) fn of_real(call: &Call) -> Outcome {
    let value = f32::from_bits(call.dword(0));
    Outcome::Flag(write_real(call.cpu.memory.bytes_at(), value, text::of(call, 1, Access::Write)))
}

/// See [`of_real`]. False if it does not fit, or is not a number; then nothing is written.
#[inline(never)]
pub(crate) fn write_real(memory: Bytes, value: f32, out: Option<Text>) -> bool {
    match real::scientific(value) {
        Some(number) => give_whole(memory, out, &number),
        None => scientific(f64::from(value), 7, 2).is_some_and(|number| give_whole(memory, out, number.characters())),
    }
}

/// IN LREAL -> RET_VAL, OUT STRING: `+1.2345678901234E+001`, 21 characters.
pub(super) fn of_lreal(call: &Call) -> Outcome {
    match scientific(f64::from_bits(call.lword(0)), 13, 3) {
        Some(number) => written(call, 2, number.characters()),
        None => error(INVALID),
    }
}

/// Writes a result into parameter `index` if all of it fits.
fn written(call: &Call, index: usize, characters: &[u8]) -> Outcome {
    let out = text::of(call, index, Access::Write);
    match (give_whole(call.cpu.memory.bytes_at(), out, characters), out) {
        (true, _) => OK,
        (false, Some(_)) => error(CUT),
        (false, None) => error(INVALID),
    }
}

/// `None`: not a number, or infinite.
fn scientific(value: f64, digits: usize, exponent_digits: usize) -> Option<Buffer<32>> {
    if !value.is_finite() {
        return None;
    }
    let (mantissa, exponent) = mantissa_and_exponent(value, digits);
    let mut buffer: Buffer<32> = Buffer::new();
    if value >= 0.0 {
        // A negative zero has no sign either.
        buffer.push(b'+');
    }
    let mantissa = if value == 0.0 { mantissa.as_str().trim_start_matches('-') } else { mantissa.as_str() };
    let sign = if exponent < 0 { '-' } else { '+' };
    let _ = write!(buffer, "{mantissa}E{sign}{:0exponent_digits$}", exponent.abs());
    Some(buffer)
}

/// `-1.2300` and `-3`, correctly rounded.
fn mantissa_and_exponent(value: f64, digits: usize) -> (Buffer<24>, i32) {
    let mut all: Buffer<32> = Buffer::new();
    let _ = write!(all, "{value:.digits$e}");
    let (mantissa, exponent) = all.as_str().split_once('e').unwrap_or(("0", "0"));
    let mut buffer = Buffer::new();
    let _ = buffer.write_str(mantissa);
    (buffer, exponent.parse().unwrap_or(0))
}

/// IN REAL -> OUT STRING: fixed point, the shortest text for the same REAL. `INF` and `NaN` are errors.
pub(super) fn fixed_of_real(call: &Call) -> Outcome {
    let value = f32::from_bits(call.dword(0));
    Outcome::Flag(write_fixed_real(call.cpu.memory.bytes_at(), value, text::of(call, 1, Access::Write)))
}

/// See [`fixed_of_real`]. False if it does not fit; then nothing is written.
#[inline(never)]
pub(crate) fn write_fixed_real(memory: Bytes, value: f32, out: Option<Text>) -> bool {
    let mut buffer: Buffer<64> = Buffer::new();
    let _ = if value.is_finite() { write!(buffer, "{value}") } else { write_special(&mut buffer, f64::from(value)) };
    give_whole(memory, out, buffer.characters()) && value.is_finite()
}

/// IN LREAL -> RET_VAL, OUT STRING, as [`fixed_of_real`]; more than 254 characters are too long.
pub(super) fn fixed_of_lreal(call: &Call) -> Outcome {
    let value = f64::from_bits(call.lword(0));
    let mut buffer: Buffer<512> = Buffer::new();
    let _ = if value.is_finite() { write!(buffer, "{value}") } else { write_special(&mut buffer, value) };
    finish_special(written(call, 2, buffer.characters()), value.is_finite())
}

fn write_special<const N: usize>(buffer: &mut Buffer<N>, value: f64) -> std::fmt::Result {
    buffer.write_str(if value.is_nan() { "NaN" } else { "INF" })
}

/// NaN and infinity are errors, although they also produce a text.
fn finish_special(outcome: Outcome, finite: bool) -> Outcome {
    if outcome == OK && !finite { error(INVALID) } else { outcome }
}

/// S STRING, LONGEST INT, LOW DINT, HIGH DINT -> NUMBER DINT: an optional sign, then digits only. A number out of LOW to
/// HIGH is limited, with BR 0; a text of another form leaves NUMBER as it is, with BR 0.
pub(super) fn to_dint(call: &Call) -> Outcome {
    let Some((value, good)) = read_limited(call) else { return Outcome::Flag(false) };
    call.set_dword(4, value as u32);
    Outcome::Flag(good)
}

/// As [`to_dint`], NUMBER is an INT.
pub(super) fn to_int(call: &Call) -> Outcome {
    let Some((value, good)) = read_limited(call) else { return Outcome::Flag(false) };
    call.set_word(4, value as u16);
    Outcome::Flag(good)
}

fn read_limited(call: &Call) -> Option<(i32, bool)> {
    let (low, high) = (call.dword(2) as i32, call.dword(3) as i32);
    decimal::read(call.cpu.memory.bytes_at(), text::of(call, 0, Access::Read), call.word(1), low, high)
}

/// S STRING, NUMBER REAL: see [`read_real`]. A text of another form leaves NUMBER as it is.
pub(super) fn to_real(call: &Call) -> Outcome {
    let text = text::of(call, 0, Access::Read);
    let Some((value, good)) = read_real(call.cpu.memory.bytes_at(), text) else { return Outcome::Flag(false) };
    call.set_dword(1, value.to_bits());
    Outcome::Flag(good)
}

/// Exactly `+v.nnnnnnnE+xx` at the beginning. `None`: another form. The value is limited; the second result says whether it was in the range.
#[inline(never)]
pub(crate) fn read_real(memory: Bytes, text: Option<Text>) -> Option<(f32, bool)> {
    const FORM: &[u8] = b"+9.9999999E+99";
    let fits = |(&form, &character): (&u8, &u8)| match form {
        b'+' => matches!(character, b'+' | b'-'),
        b'9' => character.is_ascii_digit(),
        other => character == other,
    };
    let value = text?.view(memory, |characters| {
        let number = characters.get(..FORM.len())?;
        if FORM.iter().zip(number).all(fits) { real_of_digits(number) } else { None }
    })?;
    let limited = value.clamp(f32::MIN, f32::MAX);
    Some((limited, limited == value))
}

/// The REAL that digits, sign, point and exponent mean.
fn real_of_digits(digits: &[u8]) -> Option<f32> {
    real::parse(digits).or_else(|| std::str::from_utf8(digits).ok()?.parse().ok())
}

/// A number at the beginning of a text.
struct Scanned {
    /// Digits, sign, point and exponent as Rust reads them.
    digits: Buffer<300>,
    /// Characters that belong to it, blanks in front included.
    length: usize,
}

/// FORMAT: the comma is the decimal sign.
const COMMA: u16 = 1;
/// FORMAT: an exponent may follow, or is written.
const EXPONENT: u16 = 2;
/// FORMAT of VAL_STRG: always a sign.
const SIGN: u16 = 4;

/// Blanks, a sign, digits with separators of thousands, a decimal sign, digits. `None` without a digit.
fn scan(text: &[u8], format: u16) -> Option<Scanned> {
    let (point, separator) = if format & COMMA != 0 { (b',', b'.') } else { (b'.', b',') };
    let mut digits: Buffer<300> = Buffer::new();
    let mut at = text.iter().take_while(|&&character| character == b' ').count();
    if let Some(&sign @ (b'+' | b'-')) = text.get(at) {
        digits.push(sign);
        at += 1;
    }
    let (mut any, mut fraction) = (false, false);
    while let Some(&character) = text.get(at) {
        match character {
            b'0'..=b'9' => {
                any = true;
                digits.push(character);
            }
            _ if character == point && !fraction => {
                fraction = true;
                if !any {
                    digits.push(b'0');
                }
                digits.push(b'.');
            }
            _ if character == separator && !fraction => {}
            _ => break,
        }
        at += 1;
    }
    if !any {
        return None;
    }
    if format & EXPONENT != 0
        && let Some(length) = exponent_length(&text[at..])
    {
        text[at..at + length].iter().for_each(|&character| digits.push(character));
        at += length;
    }
    Some(Scanned { digits, length: at })
}

/// Characters of `E-12`; `None` if there is no exponent.
fn exponent_length(text: &[u8]) -> Option<usize> {
    let [b'e' | b'E', rest @ ..] = text else { return None };
    let sign = usize::from(matches!(rest.first(), Some(b'+' | b'-')));
    let digits = rest[sign..].iter().take_while(|character| character.is_ascii_digit()).count();
    (digits > 0).then_some(1 + sign + digits)
}

/// Scans a text from position `position` on.
fn scan_text<R>(
    memory: Bytes,
    text: Option<Text>,
    format: u16,
    position: i16,
    scan: impl FnOnce(&[u8], u16) -> Option<R>,
) -> Option<R> {
    let start = usize::try_from(position).ok()?.checked_sub(1)?;
    let from_start = |characters: &[u8]| {
        let rest = characters.get(start..).filter(|rest| !rest.is_empty())?;
        if format <= COMMA | EXPONENT { scan(rest, format) } else { None }
    };
    text?.view(memory, from_start)
}

/// As [`scan_text`], of a call with the parameters S, FORMAT, P.
fn scan_call<R>(call: &Call, scan: impl FnOnce(&[u8], u16) -> Option<R>) -> Option<R> {
    scan_text(call.cpu.memory.bytes_at(), text::of(call, 0, Access::Read), call.word(1), call.word(2) as i16, scan)
}

/// The range of an integer type: 1 SINT, 2 INT, 3 DINT, 4 LINT, 5 USINT, 6 UINT, 7 UDINT, 8 ULINT.
fn range(ty: u16) -> Option<std::ops::RangeInclusive<i128>> {
    let bits = 8u32 << ((ty.checked_sub(1)?) % 4);
    match ty {
        1..=4 => Some(-(1 << (bits - 1))..=(1 << (bits - 1)) - 1),
        5..=8 => Some(0..=(1 << bits) - 1),
        _ => None,
    }
}

/// An integer, or a number whose fraction is dropped; and its characters.
fn scan_integer(text: &[u8], format: u16) -> Option<(i128, usize)> {
    let scanned = scan(text, format)?;
    let digits = scanned.digits.as_str();
    let value = if digits.contains(['e', 'E']) {
        // Larger numbers are out of every range, and their conversion saturates.
        digits.parse::<f64>().ok().filter(|value| value.is_finite())?.trunc() as i128
    } else {
        let whole = digits.split('.').next().unwrap_or("");
        whole.parse::<i128>().ok()?
    };
    Some((value, scanned.length))
}

/// The integer of type `kind` (see [`range`]) at the beginning of a text, and how many characters belong to it: 0 if there is none, or it is
/// outside the range; then the integer is 0. A fraction is dropped.
#[inline(always)]
pub(crate) fn scan_start<W: Way>(way: &W, text: Option<Text>, kind: u16) -> Option<(i64, usize)> {
    let memory = way.bytes();
    if matches!(kind, 1..=4)
        && let Some(text) = text
        && let Some((negative, magnitude, length)) = text.view(memory, decimal::scan)
    {
        let value = if negative { -(magnitude as i64) } else { magnitude as i64 };
        let unused = 64 - (8 << (kind - 1));
        return Some(if value << unused >> unused == value { (value, length) } else { (0, 0) });
    }
    if W::GIVES_UP {
        return None;
    }
    let (value, length) = scan_range(memory, text, 0, 1, kind);
    Some((value as i64, length))
}

/// As [`scan_start`], from position `position` on.
#[inline(never)]
fn scan_range(memory: Bytes, text: Option<Text>, format: u16, position: i16, kind: u16) -> (i128, usize) {
    let value = range(kind).and_then(|range| {
        let value = scan_text(memory, text, format, position, |text, format| match decimal::scan(text) {
            Some((negative, magnitude, length)) => {
                let value = i128::from(magnitude);
                Some((if negative { -value } else { value }, length))
            }
            None => scan_integer(text, format),
        });
        value.filter(|(value, _)| range.contains(value))
    });
    value.unwrap_or((0, 0))
}

/// IN STRING, FORMAT WORD, P INT, TYPE INT -> RET_VAL, OUT LINT, NEXT INT. A fraction is dropped. Out of the range of the type, or
/// without a number, OUT is 0 and NEXT is P.
pub(super) fn integer_of(call: &Call) -> Outcome {
    const OUT: usize = 5;
    let text = text::of(call, 0, Access::Read);
    let (value, length) = scan_range(call.cpu.memory.bytes_at(), text, call.word(1), call.word(2) as i16, call.word(3));
    call.set_lword(OUT, value as u64);
    call.set_word(OUT + 1, call.word(2).wrapping_add(length as u16));
    if length == 0 { error(INVALID) } else { OK }
}

/// IN STRING, KIND -> OUT DINT: the number at the beginning of the text; 0 if there is none in the range of the type.
pub(super) fn dint_at_start(call: &Call) -> Outcome {
    let (value, length) = at_start(call);
    call.set_dword(2, value as u32);
    Outcome::Flag(length != 0)
}

/// As [`dint_at_start`], OUT is an INT.
pub(super) fn int_at_start(call: &Call) -> Outcome {
    let (value, length) = at_start(call);
    call.set_word(2, value as u16);
    Outcome::Flag(length != 0)
}

fn at_start(call: &Call) -> (i64, usize) {
    scan_start(&call.cpu.memory.bytes_at(), text::of(call, 0, Access::Read), call.word(1)).unwrap_or((0, 0))
}

/// IN STRING, FORMAT WORD, P INT -> RET_VAL, OUT LREAL, NEXT INT.
pub(super) fn float_of(call: &Call) -> Outcome {
    const OUT: usize = 4;
    let value = scan_call(call, scan)
        .and_then(|scanned| scanned.digits.as_str().parse::<f64>().ok().map(|value| (value, scanned.length)));
    let (value, length) = value.unwrap_or((0.0, 0));
    call.set_lword(OUT, value.to_bits());
    call.set_word(OUT + 1, call.word(2).wrapping_add(length as u16));
    if length == 0 { error(INVALID) } else { OK }
}

/// IN STRING, FORMAT WORD, P INT -> RET_VAL, OUT REAL, NEXT INT. A value too small for a normal number becomes 0.
pub(super) fn real_of(call: &Call) -> Outcome {
    const OUT: usize = 4;
    let (value, length) = scan_call(call, scan_real).unwrap_or((0.0, 0));
    call.set_dword(OUT, value.to_bits());
    call.set_word(OUT + 1, call.word(2).wrapping_add(length as u16));
    if length == 0 { error(INVALID) } else { OK }
}

/// A REAL, 0 if it is too small for a normal number; and its characters.
fn scan_real(text: &[u8], format: u16) -> Option<(f32, usize)> {
    let scanned = scan(text, format)?;
    let value = real_of_digits(scanned.digits.characters())?;
    Some((if value.is_subnormal() { 0.0 } else { value }, scanned.length))
}

/// IN STRING -> OUT REAL: the number at the beginning of the text, without an exponent; 0 if there is none.
pub(super) fn real_at_start(call: &Call) -> Outcome {
    let (value, length) = real_start(call.cpu.memory.bytes_at(), text::of(call, 0, Access::Read));
    call.set_dword(1, value.to_bits());
    Outcome::Flag(length != 0)
}

/// See [`real_at_start`]; the number of its characters is 0 if there is none.
#[inline(never)]
pub(crate) fn real_start(memory: Bytes, text: Option<Text>) -> (f32, usize) {
    scan_text(memory, text, 0, 1, scan_real).unwrap_or((0.0, 0))
}

/// The parameters of VAL_STRG after its number.
struct Field {
    size: usize,
    precision: usize,
    format: u16,
    position: usize,
}

/// SIZE, PREC, FORMAT, P at parameter 1 and the following.
fn field(call: &Call, first: usize) -> Option<Field> {
    let word = |index: usize| usize::from(call.word(first + index));
    let field = Field { size: word(0), precision: word(1), format: call.word(first + 2), position: word(3) };
    let legal = field.format <= COMMA | EXPONENT | SIGN && field.size > field.precision && field.position > 0;
    legal.then_some(field)
}

/// Writes `number` into the field, right-justified.
fn fill_field(call: &Call, out: usize, field: &Field, number: &[u8]) -> Outcome {
    let Some(text) = text::of(call, out, Access::Write) else { return error(INVALID) };
    let end = field.position - 1 + field.size;
    if number.len() > field.size || end > text.maximum() as usize {
        return error(CUT);
    }
    let Some(old) = text::characters(call, out) else { return error(INVALID) };
    let mut buffer: Buffer<{ text::LONGEST }> = Buffer::new();
    for index in 0..end.max(old.characters().len()) {
        let blank_or_old = old.characters().get(index).copied().unwrap_or(b' ');
        let in_field = index.checked_sub(field.position - 1).filter(|_| index < end);
        buffer.push(match in_field {
            None => blank_or_old,
            Some(place) => (place + number.len()).checked_sub(field.size).map_or(b' ', |digit| number[digit]),
        });
    }
    text.write(call.cpu.memory.bytes_at(), buffer.characters());
    OK
}

/// IN LINT, SIZE, PREC, FORMAT, P, FORM -> RET_VAL, OUT STRING. PREC places the point.
pub(super) fn field_of_integer(call: &Call) -> Outcome {
    const OUT: usize = 7;
    let Some(field) = field(call, 1) else { return error(INVALID) };
    let value = integer(call.lword(0), call.word(5));
    let mut digits: Buffer<300> = Buffer::new();
    let width = field.precision + 1;
    let mut number: Buffer<320> = Buffer::new();
    push_sign(&mut number, value < 0, field.format);
    let (places, exponent) = if field.format & EXPONENT == 0 {
        let _ = write!(digits, "{:0width$}", value.unsigned_abs());
        (digits.characters().len() - field.precision, None)
    } else {
        let (mantissa, exponent) = rounded(value.unsigned_abs(), field.precision);
        let _ = write!(digits, "{mantissa:0<width$}");
        (1, Some(exponent))
    };
    let (whole, fraction) = digits.characters().split_at(places);
    whole.iter().for_each(|&digit| number.push(digit));
    if !fraction.is_empty() {
        number.push(decimal_sign(field.format));
        fraction.iter().for_each(|&digit| number.push(digit));
    }
    if let Some(exponent) = exponent {
        let _ = write!(number, "E{exponent:+}");
    }
    fill_field(call, OUT, &field, number.characters())
}

/// A number whose last `precision` digits are decimals, for a field with an exponent: its first digits, one and at most `precision` more,
/// and the exponent. A half becomes an even digit, as in a float.
fn rounded(magnitude: u128, precision: usize) -> (u128, i64) {
    let Some(places) = magnitude.checked_ilog10() else { return (0, 0) };
    let mut exponent = i64::from(places) - precision as i64;
    let dropped = places.saturating_sub(precision as u32);
    let unit = 10u128.pow(dropped);
    let (mut kept, rest) = (magnitude / unit, magnitude % unit);
    if rest * 2 > unit || (rest * 2 == unit && kept % 2 == 1) {
        kept += 1;
        // 9.99 has become 10.0.
        if kept.ilog10() > places - dropped {
            kept /= 10;
            exponent += 1;
        }
    }
    (kept, exponent)
}

/// IN LREAL, SIZE, PREC, FORMAT, P, LONGEST -> RET_VAL, OUT STRING. LONGEST is the greatest PREC.
pub(super) fn field_of_lreal(call: &Call) -> Outcome {
    const OUT: usize = 7;
    let value = f64::from_bits(call.lword(0));
    let Some(field) = field(call, 1).filter(|field| field.precision <= usize::from(call.word(5))) else {
        return error(INVALID);
    };
    match field_of_float(value, &field) {
        Some(number) => finish_special(fill_field(call, OUT, &field, number.characters()), value.is_finite()),
        None => error(CUT),
    }
}

/// The characters of a float; `None` if there are too many.
fn field_of_float(value: f64, field: &Field) -> Option<Buffer<320>> {
    let mut number: Buffer<320> = Buffer::new();
    if value.is_nan() {
        write_special(&mut number, value).ok()?;
        return Some(number);
    }
    // Infinity always has its sign.
    push_sign(&mut number, value < 0.0, if value.is_infinite() { SIGN } else { field.format });
    if value.is_infinite() {
        write_special(&mut number, value).ok()?;
        return Some(number);
    }
    let (precision, magnitude) = (field.precision, value.abs());
    let mut digits: Buffer<320> = Buffer::new();
    if field.format & EXPONENT != 0 {
        let _ = write!(digits, "{magnitude:.precision$e}");
    } else {
        let _ = write!(digits, "{magnitude:.precision$}");
    }
    let (mantissa, exponent) = digits.as_str().split_once('e').map_or((digits.as_str(), None), |(m, e)| (m, Some(e)));
    mantissa.bytes().for_each(|digit| number.push(if digit == b'.' { decimal_sign(field.format) } else { digit }));
    if let Some(exponent) = exponent {
        number.push(b'E');
        if !exponent.starts_with('-') {
            number.push(b'+');
        }
        number.write_str(exponent).ok()?;
    }
    Some(number)
}

fn push_sign<const N: usize>(number: &mut Buffer<N>, negative: bool, format: u16) {
    if negative {
        number.push(b'-');
    } else if format & SIGN != 0 {
        number.push(b'+');
    }
}

fn decimal_sign(format: u16) -> u8 {
    if format & COMMA != 0 { b',' } else { b'.' }
}
