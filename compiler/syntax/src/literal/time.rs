//! Durations, dates and times of day.

use plcc_literal::calendar::{Clock, Date};
use plcc_literal::duration::{self, Fault, Fraction, Smallest};

use super::{Literal, LiteralError, meant};

/// `S5T#2s`: the finest time base that can represent the value; digits below it are cut off.
///
/// Bits 13-12: time base (10 ms, 100 ms, 1 s, 10 s); bits 11-0: three BCD digits.
/// Source: Programming with STEP 7, format of S5TIME.
pub fn s5time(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let ms = milliseconds(text, value, meant::S5TIME_UNITS)?;
    if value.starts_with('-') || ms > 9_990_000 {
        return Err(LiteralError::range(text, "no S5TIME", "an S5TIME is from S5T#10MS to S5T#2H_46M_30S"));
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
    let ms = milliseconds(text, value, meant::TIME_UNITS)?;
    i32::try_from(ms).map(Literal::Time).map_err(|_| {
        LiteralError::range(text, "not a TIME", "a TIME is from T#-24D_20H_31M_23S_648MS to T#24D_20H_31M_23S_647MS")
    })
}

/// `D#2000-6-20`: days since 1990-01-01.
pub fn date(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let date = Date::parse(value).ok_or_else(|| bad(text, meant::date(text, value)))?;
    check_date(text, date)?;
    match date.days_since(1990) {
        Some(days) if date.year <= 2168 => Ok(Literal::Date(days as u16)),
        _ => Err(LiteralError::range(text, "not a DATE", "a DATE is from D#1990-1-1 to D#2168-12-31")),
    }
}

/// `TOD#5:45:00.5`: milliseconds since midnight.
pub fn time_of_day(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let clock = Clock::parse(value).ok_or_else(|| bad(text, meant::clock(text, value)))?;
    check_time(text, clock)?;
    Ok(Literal::TimeOfDay(clock.milliseconds()))
}

/// `DT#1991-2-3-4:5:6.789`: eight BCD bytes, the last digit the weekday from 1 = Sunday.
///
/// Source: Programming with STEP 7, format of DATE_AND_TIME.
pub fn date_and_time(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let malformed = || bad(text, meant::date_and_clock(text, value));
    let (written, time) = value.rsplit_once('-').ok_or_else(malformed)?;
    let mut date = Date::parse(written).ok_or_else(malformed)?;
    // STEP 7 generates two digits, as the first byte of the value has them: 90 to 99 are before 2000.
    if written.find('-') == Some(2) {
        date.year += if date.year >= 90 { 1900 } else { 2000 };
    }
    let clock = Clock::parse(time).ok_or_else(malformed)?;
    check_date(text, date)?;
    check_time(text, clock)?;
    let weekday = date
        .weekday()
        .filter(|_| (1990..=2089).contains(&date.year))
        .ok_or_else(|| LiteralError::range(text, "no DATE_AND_TIME", "a DATE_AND_TIME is in the years 1990 to 2089"))?;
    let bcd = |number: u32| (((number / 10) << 4) | (number % 10)) as u8;
    let ms = clock.ns / 1_000_000;
    Ok(Literal::DateAndTime([
        bcd(date.year % 100),
        bcd(date.month),
        bcd(date.day),
        bcd(clock.hour),
        bcd(clock.minute),
        bcd(clock.second),
        bcd(ms / 10),
        ((ms % 10) << 4) as u8 | weekday,
    ]))
}

fn bad(text: &str, help: String) -> LiteralError {
    LiteralError::malformed(text, "not complete or not in order", help)
}

/// A duration as in `T#` and `S5T#`, with messages. `units`: those of its type.
pub(crate) fn nanoseconds(
    text: &str,
    value: &str,
    smallest: Smallest,
    fraction: Fraction,
    units: &[&str],
) -> Result<i128, LiteralError> {
    duration::nanoseconds(value, smallest, fraction).map_err(|fault| match fault {
        Fault::Form => bad(text, meant::duration(text, value, units)),
        Fault::Unit { number, unit } => LiteralError::range(
            text,
            format!("{number}{unit} after a larger unit"),
            meant::within_limits(text, value, units),
        ),
    })
}

/// As [`nanoseconds`] for literals of STEP 7: whole milliseconds, smaller parts are cut off.
fn milliseconds(text: &str, value: &str, units: &[&str]) -> Result<i128, LiteralError> {
    Ok(nanoseconds(text, value, Smallest::Millisecond, Fraction::Anywhere, units)? / 1_000_000)
}

fn check_date(text: &str, date: Date) -> Result<(), LiteralError> {
    if date.exists() {
        return Ok(());
    }
    Err(LiteralError::range(text, "not a day of the calendar", meant::day(text, date)))
}

fn check_time(text: &str, clock: Clock) -> Result<(), LiteralError> {
    if clock.exists() {
        return Ok(());
    }
    Err(LiteralError::range(text, "not a time of day", "a time of day is from 0:0:0.0 to 23:59:59.999"))
}
