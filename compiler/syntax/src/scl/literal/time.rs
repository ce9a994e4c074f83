//! Durations, and dates with nanoseconds.

use plcc_literal::calendar::{Clock, Date};
use plcc_literal::duration::{Fraction, Smallest};

use crate::elementary::Elementary;
use crate::literal::{LiteralError, meant, nanoseconds};
use crate::scl::ast::Literal;

const NS_PER_DAY: u64 = 86_400_000_000_000;

/// `T#-1S_100MS`: milliseconds; smaller parts are cut off.
pub fn duration(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let ms = nanoseconds(text, value, Smallest::Millisecond, Fraction::Last, meant::TIME_UNITS)? / 1_000_000;
    let ms = i32::try_from(ms).map_err(|_| {
        LiteralError::range(text, "not a TIME", "a TIME is from T#-24D_20H_31M_23S_648MS to T#24D_20H_31M_23S_647MS")
    })?;
    Ok(Literal::Typed { ty: Elementary::Time, bits: u64::from(ms as u32) })
}

/// `LT#1S_5US_7NS`: nanoseconds.
pub fn long_duration(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let ns = i64::try_from(nanoseconds(
        text,
        value,
        Smallest::Nanosecond,
        Fraction::Last,
        meant::LTIME_UNITS,
    )?)
    .map_err(|_| {
        LiteralError::range(
            text,
            "not an LTIME",
            "an LTIME is from LT#-106751D_23H_47M_16S_854MS_775US_808NS to LT#106751D_23H_47M_16S_854MS_775US_807NS",
        )
    })?;
    Ok(Literal::Typed { ty: Elementary::Ltime, bits: ns as u64 })
}

/// `LTOD#12:00:00.123456789`: nanoseconds since midnight.
pub fn long_time_of_day(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let clock = clock(text, value, || meant::clock(text, value))?;
    Ok(Literal::Typed { ty: Elementary::Ltod, bits: clock.nanoseconds() })
}

/// `LDT#2024-02-03-04:05:06.7`: nanoseconds since 1970-01-01.
pub fn long_date_and_time(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let (date, clock) = date_and_clock(text, value, || meant::date_and_clock(text, value))?;
    let ns = date
        .days_since(1970)
        .and_then(|days| u64::from(days).checked_mul(NS_PER_DAY)?.checked_add(clock.nanoseconds()));
    let ns = ns.filter(|ns| i64::try_from(*ns).is_ok()).ok_or_else(|| {
        LiteralError::range(text, "not an LDT", "an LDT is from 1970-1-1 to 2262-4-11-23:47:16.854775807")
    })?;
    Ok(Literal::Typed { ty: Elementary::Ldt, bits: ns })
}

/// `D#1970-01-01` of IEC 61131-3: the LDT at midnight.
pub fn date_from_1970(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let (date, _) = date_and_clock(text, &format!("{value}-0:0:0"), || meant::date(text, value))?;
    let ns = date.days_since(1970).and_then(|days| u64::from(days).checked_mul(NS_PER_DAY));
    let ns = ns.filter(|ns| i64::try_from(*ns).is_ok());
    let ns = ns.ok_or_else(|| LiteralError::range(text, "not a DATE", "a DATE is from 1970-1-1 to 2262-4-11"))?;
    Ok(Literal::Typed { ty: Elementary::Ldt, bits: ns })
}

/// `DTL#2024-5-6-07:08:09.123456789`: year, month, day, weekday from 1 = Sunday, hour, minute, second, nanoseconds.
///
/// Source: TIA Portal help, format of DTL.
pub fn dtl(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let (date, clock) = date_and_clock(text, value, || meant::date_and_clock(text, value))?;
    let weekday = date
        .weekday()
        .filter(|_| date.year <= 2554)
        .ok_or_else(|| LiteralError::range(text, "not a DTL", "a DTL is in the years 1970 to 2554"))?;
    let mut bytes = [0; 12];
    bytes[..2].copy_from_slice(&(date.year as u16).to_be_bytes());
    bytes[2..8].copy_from_slice(&[
        date.month as u8,
        date.day as u8,
        weekday,
        clock.hour as u8,
        clock.minute as u8,
        clock.second as u8,
    ]);
    bytes[8..].copy_from_slice(&clock.ns.to_be_bytes());
    Ok(Literal::Dtl(bytes))
}

/// `help`: how to write it, if it is not complete.
fn date_and_clock(text: &str, value: &str, help: impl Fn() -> String) -> Result<(Date, Clock), LiteralError> {
    let (date, time) = value.rsplit_once('-').ok_or_else(|| incomplete(text, help()))?;
    let date = Date::parse(date).ok_or_else(|| incomplete(text, help()))?;
    if !date.exists() || date.year > 9999 {
        return Err(LiteralError::range(text, "not a day of the calendar", meant::day(text, date)));
    }
    Ok((date, clock(text, time, help)?))
}

/// `12:00:00.123456789`, cut off after nanoseconds.
fn clock(text: &str, value: &str, help: impl Fn() -> String) -> Result<Clock, LiteralError> {
    let clock = Clock::parse(value).ok_or_else(|| incomplete(text, help()))?;
    let bounds = "a time of day is from 0:0:0.0 to 23:59:59.999999999";
    Some(clock).filter(|clock| clock.exists()).ok_or_else(|| LiteralError::range(text, "not a time of day", bounds))
}

fn incomplete(text: &str, help: String) -> LiteralError {
    LiteralError::malformed(text, "not complete or not in order", help)
}
