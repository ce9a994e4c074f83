//! Durations, and dates with nanoseconds.

use crate::elementary::Elementary;
use crate::literal::{Fraction, LiteralError, UNITS_TO_MS, UNITS_TO_NS, days_of_month, leap, nanoseconds};
use crate::scl::ast::Literal;

const TIME_FORM: &str = "write units in the order D, H, M, S, MS, each once: `T#1D_2H_3M_4S_5MS`";
const LTIME_FORM: &str = "write units in the order D, H, M, S, MS, US, NS, each once: `LT#1S_2MS_3US_4NS`";
const NS_PER_DAY: u64 = 86_400_000_000_000;

/// `T#-1S_100MS`: milliseconds; what lies below is cut off.
pub fn duration(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let ms = nanoseconds(text, value, UNITS_TO_MS, Fraction::Last, TIME_FORM)? / 1_000_000;
    let ms = i32::try_from(ms).map_err(|_| {
        LiteralError::range(text, "no TIME", "a TIME lies between T#-24D_20H_31M_23S_648MS and T#24D_20H_31M_23S_647MS")
    })?;
    Ok(Literal::Typed { ty: Elementary::Time, bits: u64::from(ms as u32) })
}

/// `LT#1S_5US_7NS`: nanoseconds.
pub fn long_duration(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let ns = i64::try_from(nanoseconds(text, value, UNITS_TO_NS, Fraction::Last, LTIME_FORM)?).map_err(|_| {
        LiteralError::range(text, "no LTIME", "an LTIME lies between LT#-106751D_23H_47M_16S_854MS_775US_808NS and LT#106751D_23H_47M_16S_854MS_775US_807NS")
    })?;
    Ok(Literal::Typed { ty: Elementary::Ltime, bits: ns as u64 })
}

/// `LTOD#12:00:00.123456789`: nanoseconds since midnight.
pub fn long_time_of_day(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let clock = clock(text, value, "write hours, minutes and seconds: `LTOD#5:45:00.5`")?;
    Ok(Literal::Typed { ty: Elementary::Ltod, bits: clock.nanoseconds() })
}

/// `LDT#2024-02-03-04:05:06.7`: nanoseconds since 1970-01-01.
pub fn long_date_and_time(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let (date, clock) = date_and_clock(text, value, "write date and time: `LDT#2000-6-20-5:45:00.5`")?;
    let ns = date.days_since_1970().and_then(|days| days.checked_mul(NS_PER_DAY)?.checked_add(clock.nanoseconds()));
    let ns = ns.filter(|ns| i64::try_from(*ns).is_ok()).ok_or_else(|| {
        LiteralError::range(text, "no LDT", "an LDT lies between 1970-1-1 and 2262-4-11-23:47:16.854775807")
    })?;
    Ok(Literal::Typed { ty: Elementary::Ldt, bits: ns })
}

/// `D#1970-01-01` of IEC 61131-3: the LDT at midnight.
pub fn date_from_1970(text: &str, value: &str) -> Result<Literal, LiteralError> {
    const FORM: &str = "write year, month and day: `D#2000-6-20`";
    let (date, _) = date_and_clock(text, &format!("{value}-0:0:0"), FORM)?;
    let ns = date.days_since_1970().and_then(|days| days.checked_mul(NS_PER_DAY));
    let ns = ns.filter(|ns| i64::try_from(*ns).is_ok());
    let ns = ns.ok_or_else(|| LiteralError::range(text, "no DATE", "a DATE lies between 1970-1-1 and 2262-4-11"))?;
    Ok(Literal::Typed { ty: Elementary::Ldt, bits: ns })
}

/// `DTL#2024-5-6-07:08:09.123456789`: year, month, day, weekday from 1 = Sunday, hour, minute, second, nanoseconds.
///
/// Source: TIA Portal help, format of DTL.
pub fn dtl(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let (date, clock) = date_and_clock(text, value, "write date and time: `DTL#2000-6-20-5:45:00.5`")?;
    let days = date
        .days_since_1970()
        .filter(|_| date.year <= 2554)
        .ok_or_else(|| LiteralError::range(text, "no DTL", "a DTL lies between the years 1970 and 2554"))?;
    // 1970-01-01 was a Thursday.
    let weekday = (days + 4) % 7 + 1;
    let mut bytes = [0; 12];
    bytes[..2].copy_from_slice(&(date.year as u16).to_be_bytes());
    bytes[2..8].copy_from_slice(&[
        date.month as u8,
        date.day as u8,
        weekday as u8,
        clock.hour as u8,
        clock.minute as u8,
        clock.second as u8,
    ]);
    bytes[8..].copy_from_slice(&clock.ns.to_be_bytes());
    Ok(Literal::Dtl(bytes))
}

struct Date {
    year: u32,
    month: u32,
    day: u32,
}

struct Clock {
    hour: u32,
    minute: u32,
    second: u32,
    ns: u32,
}

impl Date {
    /// None before 1970.
    fn days_since_1970(&self) -> Option<u64> {
        let years: u64 = (1970..self.year).map(|year| if leap(year) { 366 } else { 365 }).sum();
        let months: u32 = (1..self.month).map(|month| days_of_month(self.year, month)).sum();
        (self.year >= 1970).then(|| years + u64::from(months + self.day) - 1)
    }
}

impl Clock {
    fn nanoseconds(&self) -> u64 {
        u64::from((self.hour * 60 + self.minute) * 60 + self.second) * 1_000_000_000 + u64::from(self.ns)
    }
}

fn date_and_clock(text: &str, value: &str, form: &str) -> Result<(Date, Clock), LiteralError> {
    let (date, time) = value.rsplit_once('-').ok_or_else(|| incomplete(text, form))?;
    let [year, month, day] = fields(date, '-').ok_or_else(|| incomplete(text, form))?;
    if !(1..=12).contains(&month) || !(1..=days_of_month(year, month)).contains(&day) || year > 9999 {
        return Err(LiteralError::range(text, "no day of the calendar", "the order is year, month, day: `2000-6-20`"));
    }
    Ok((Date { year, month, day }, clock(text, time, form)?))
}

/// `12:00:00.123456789`; digits behind the ninth are cut off.
fn clock(text: &str, value: &str, form: &str) -> Result<Clock, LiteralError> {
    let (time, fraction) = value.split_once('.').unwrap_or((value, "0"));
    let [hour, minute, second] = fields(time, ':').ok_or_else(|| incomplete(text, form))?;
    let fraction: String = fraction.chars().filter(|c| *c != '_').collect();
    if fraction.is_empty() || !fraction.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(incomplete(text, form));
    }
    if hour > 23 || minute > 59 || second > 59 {
        return Err(LiteralError::range(
            text,
            "no time of a day",
            "a time of day lies between 0:0:0.0 and 23:59:59.999999999",
        ));
    }
    let ns = fraction.bytes().chain(*b"00000000").take(9).fold(0, |ns, digit| ns * 10 + u32::from(digit - b'0'));
    Ok(Clock { hour, minute, second, ns })
}

fn incomplete(text: &str, form: &str) -> LiteralError {
    LiteralError::malformed(text, "not complete or not in order", form)
}

/// Exactly three unsigned numbers with `separator` between them.
fn fields(value: &str, separator: char) -> Option<[u32; 3]> {
    let mut numbers = [0; 3];
    let mut parts = value.split(separator);
    for number in &mut numbers {
        let part = parts.next()?;
        if part.is_empty() || part.len() > 6 || !part.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        *number = part.parse().ok()?;
    }
    parts.next().is_none().then_some(numbers)
}
