//! Durations, dates and times of day.

use super::{Literal, LiteralError};

const S5TIME_FORM: &str = "write units in the order H, M, S, MS, each once: `S5T#1H_2M_3S_400MS`";
const TIME_FORM: &str = "write units in the order D, H, M, S, MS, each once: `T#1D_2H_3M_4S_5MS`";
const DATE_FORM: &str = "write year, month and day: `D#2000-6-20`";
const TOD_FORM: &str = "write hours, minutes and seconds: `TOD#5:45:00.5`";
const DT_FORM: &str = "write date and time: `DT#2000-6-20-5:45:00.5`";

/// `S5T#2s`: the finest time base that holds the value; digits below it are cut off.
///
/// Bits 13-12: time base (10 ms, 100 ms, 1 s, 10 s); bits 11-0: three BCD digits.
/// Source: Programming with STEP 7, format of S5TIME.
pub fn s5time(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let ms = milliseconds(text, value, S5TIME_FORM)?;
    if value.starts_with('-') || ms > 9_990_000 {
        return Err(LiteralError::range(text, "no S5TIME", "an S5TIME lies between S5T#10MS and S5T#2H_46M_30S"));
    }
    let (base, unit_ms) = [(0u16, 10), (1, 100), (2, 1_000), (3, 10_000)]
        .into_iter()
        .find(|(_, unit_ms)| ms / unit_ms <= 999)
        .unwrap_or((3, 10_000));
    let units = (ms / unit_ms).min(999) as u16;
    Ok(Literal::S5Time(base << 12 | (units / 100) << 8 | (units / 10 % 10) << 4 | (units % 10)))
}

/// `T#-1S_100MS`.
pub fn duration(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let ms = milliseconds(text, value, TIME_FORM)?;
    i32::try_from(ms).map(Literal::Time).map_err(|_| {
        LiteralError::range(text, "no TIME", "a TIME lies between T#-24D_20H_31M_23S_648MS and T#24D_20H_31M_23S_647MS")
    })
}

/// `D#2000-6-20`: days since 1990-01-01.
pub fn date(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let [year, month, day] = fields(value, '-').ok_or_else(|| bad(text, DATE_FORM))?;
    check_date(text, year, month, day)?;
    let days = days_since_1990(year, month, day);
    if !(1990..=2168).contains(&year) {
        return Err(LiteralError::range(text, "no DATE", "a DATE lies between D#1990-1-1 and D#2168-12-31"));
    }
    Ok(Literal::Date(days as u16))
}

/// `TOD#5:45:00.5`: milliseconds since midnight.
pub fn time_of_day(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let ms = time_ms(value).ok_or_else(|| bad(text, TOD_FORM))?;
    check_time(text, ms)?;
    Ok(Literal::TimeOfDay(ms[0] * 3_600_000 + ms[1] * 60_000 + ms[2] * 1_000 + ms[3]))
}

/// `DT#1991-2-3-4:5:6.789`: eight BCD bytes, the last digit the weekday from 1 = Sunday.
///
/// Source: Programming with STEP 7, format of DATE_AND_TIME.
pub fn date_and_time(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let malformed = || bad(text, DT_FORM);
    let (date, time) = value.rsplit_once('-').ok_or_else(malformed)?;
    let [mut year, month, day] = fields(date, '-').ok_or_else(malformed)?;
    // STEP 7 generates two digits, as the first byte of the value holds them: 90 to 99 lie before 2000.
    if date.find('-') == Some(2) {
        year += if year >= 90 { 1900 } else { 2000 };
    }
    let time = time_ms(time).ok_or_else(malformed)?;
    check_date(text, year, month, day)?;
    check_time(text, time)?;
    if !(1990..=2089).contains(&year) {
        return Err(LiteralError::range(text, "no DATE_AND_TIME", "a DATE_AND_TIME lies between 1990 and 2089"));
    }
    // 1990-01-01 was a Monday.
    let weekday = (days_since_1990(year, month, day) + 1) % 7 + 1;
    let bcd = |number: u32| (((number / 10) << 4) | (number % 10)) as u8;
    let [hour, minute, second, ms] = time;
    Ok(Literal::DateAndTime([
        bcd(year % 100),
        bcd(month),
        bcd(day),
        bcd(hour),
        bcd(minute),
        bcd(second),
        bcd(ms / 10),
        ((ms % 10) << 4 | weekday) as u8,
    ]))
}

fn bad(text: &str, help: &str) -> LiteralError {
    LiteralError::malformed(text, "not complete or not in order", help)
}

/// Where a duration may have a fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fraction {
    /// In each unit, also without digits on one side of the point, as STEP 7 takes it: `T#1.5H_30M`, `T#.5S`.
    Anywhere,
    /// In the last unit only.
    Last,
}

/// Units of a duration as [`nanoseconds`] counts them: H, M, S and MS behind days; LTIME has US and NS too.
pub(crate) const UNITS_TO_MS: usize = 5;
pub(crate) const UNITS_TO_NS: usize = 7;

/// Letters, nanoseconds, and from what number on the next larger unit must be used.
const UNITS: [(&str, i128, i128); UNITS_TO_NS] = [
    ("D", 86_400_000_000_000, i128::MAX),
    ("H", 3_600_000_000_000, 24),
    ("M", 60_000_000_000, 60),
    ("S", 1_000_000_000, 60),
    ("MS", 1_000_000, 1000),
    ("US", 1000, 1000),
    ("NS", 1, 1000),
];

/// Signed sum of `1D2H3M4S5MS` in any letter case with `_` between the units, of which the first `units` are known. Exact: what lies
/// below a nanosecond is cut off.
pub(crate) fn nanoseconds(
    text: &str,
    value: &str,
    units: usize,
    fraction: Fraction,
    form: &str,
) -> Result<i128, LiteralError> {
    let malformed = || bad(text, form);
    let compact: String = value.chars().filter(|c| *c != '_').collect::<String>().to_ascii_uppercase();
    let (negative, mut rest) = match compact.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, compact.strip_prefix('+').unwrap_or(&compact)),
    };
    let mut total = 0i128;
    let mut next_unit = 0;
    let mut ended = false;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').ok_or_else(malformed)?;
        let letters = rest[digits..].find(|c: char| !c.is_ascii_alphabetic()).map_or(rest.len(), |at| digits + at);
        let (number, name) = (&rest[..digits], &rest[digits..letters]);
        let unit = UNITS[..units].iter().position(|(unit, ..)| *unit == name).ok_or_else(malformed)?;
        let (_, unit_ns, limit) = UNITS[unit];
        if unit < next_unit || ended {
            return Err(malformed());
        }
        let (whole, part) = number.split_once('.').unwrap_or((number, ""));
        let has_point = number.contains('.');
        let one_side = fraction == Fraction::Anywhere && !(whole.is_empty() && part.is_empty());
        if part.contains('.') || (whole.is_empty() || has_point && part.is_empty()) && !one_side {
            return Err(malformed());
        }
        ended = has_point && fraction == Fraction::Last;
        // Above 18 digits every type is exceeded.
        let whole: i128 = if whole.len() > 18 { i128::from(i64::MAX) } else { whole.parse().unwrap_or(0) };
        if next_unit > 0 && whole >= limit {
            return Err(LiteralError::range(
                text,
                format!("{whole}{name} behind a larger unit"),
                "only the first unit may exceed its natural limit: `T#90S`, but `T#1M_30S`",
            ));
        }
        // Behind this many digits of a day no nanosecond is left.
        let part = &part[..part.len().min(15)];
        let part_ns = part.parse::<i128>().unwrap_or(0) * unit_ns / 10i128.pow(part.len() as u32);
        total += whole * unit_ns + part_ns;
        next_unit = unit + 1;
        rest = &rest[letters..];
    }
    if next_unit == 0 { Err(malformed()) } else { Ok(if negative { -total } else { total }) }
}

/// As [`nanoseconds`] for literals of STEP 7: whole milliseconds, what lies below is cut off.
fn milliseconds(text: &str, value: &str, form: &str) -> Result<i128, LiteralError> {
    Ok(nanoseconds(text, value, UNITS_TO_MS, Fraction::Anywhere, form)? / 1_000_000)
}

/// Exactly `N` unsigned numbers with `separator` between them.
fn fields<const N: usize>(value: &str, separator: char) -> Option<[u32; N]> {
    let mut numbers = [0; N];
    let mut parts = value.split(separator);
    for number in &mut numbers {
        *number = unsigned(parts.next()?.trim())?;
    }
    parts.next().is_none().then_some(numbers)
}

fn unsigned(digits: &str) -> Option<u32> {
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) || digits.len() > 6 {
        return None;
    }
    digits.parse().ok()
}

/// Hours, minutes, seconds and milliseconds of `5:45:00.5`; digits behind the third are cut off.
fn time_ms(value: &str) -> Option<[u32; 4]> {
    let (time, fraction) = value.split_once('.').unwrap_or((value, "0"));
    let [hour, minute, second] = fields(time, ':')?;
    if fraction.is_empty() || !fraction.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let ms = fraction.bytes().chain(*b"00").take(3).fold(0, |ms, digit| ms * 10 + u32::from(digit - b'0'));
    Some([hour, minute, second, ms])
}

fn check_date(text: &str, year: u32, month: u32, day: u32) -> Result<(), LiteralError> {
    if (1..=12).contains(&month) && (1..=days_of_month(year, month)).contains(&day) {
        return Ok(());
    }
    Err(LiteralError::range(text, "no day of the calendar", "the order is year, month, day: `D#2000-6-20`"))
}

fn check_time(text: &str, [hour, minute, second, _]: [u32; 4]) -> Result<(), LiteralError> {
    if hour < 24 && minute < 60 && second < 60 {
        return Ok(());
    }
    Err(LiteralError::range(text, "no time of a day", "a time of day lies between 0:0:0.0 and 23:59:59.999"))
}

pub(crate) fn leap(year: u32) -> bool {
    year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400)
}

pub(crate) fn days_of_month(year: u32, month: u32) -> u32 {
    match month {
        4 | 6 | 9 | 11 => 30,
        2 if leap(year) => 29,
        2 => 28,
        _ => 31,
    }
}

/// Days from 1990-01-01; years outside 1990..=2168 give what the caller rejects.
fn days_since_1990(year: u32, month: u32, day: u32) -> u32 {
    let year = year.clamp(1990, 2168);
    let years: u32 = (1990..year).map(|year| if leap(year) { 366 } else { 365 }).sum();
    let months: u32 = (1..month).map(|month| days_of_month(year, month)).sum();
    years + months + day - 1
}
