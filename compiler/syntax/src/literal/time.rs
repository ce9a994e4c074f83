//! Durations, dates and times of day.

use plcc_literal::calendar::{Clock, Date};
use plcc_literal::duration::{self, Fault, Fraction, Smallest};

use super::{Literal, LiteralError};

const S5TIME_FORM: &str = "write units in the order H, M, S, MS, each once: `S5T#1H_2M_3S_400MS`";
const TIME_FORM: &str = "write units in the order D, H, M, S, MS, each once: `T#1D_2H_3M_4S_5MS`";
const DATE_FORM: &str = "write year, month and day: `D#2000-6-20`";
const TOD_FORM: &str = "write hours, minutes and seconds: `TOD#5:45:00.5`";
const DT_FORM: &str = "write date and time: `DT#2000-6-20-5:45:00.5`";

/// How to write the duration that the author of `text` means; `form` if that is not clear.
///
/// `S5TIME#10` has no unit, `T#5S_2H` not their order, `T#5sec` not their names, `T#1,5s` a comma.
pub(crate) fn form(text: &str, value: &str, form: &str) -> String {
    let prefix = text.split('#').next().unwrap_or_default();
    let compact: String =
        value.chars().filter(|c| *c != '_' && !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    if !compact.is_empty() && compact.bytes().all(|digit| digit.is_ascii_digit()) {
        return format!("write the unit: `{prefix}#{compact}S` for seconds, `{prefix}#{compact}MS` for milliseconds");
    }
    let pointed = compact.replace(',', ".");
    if pointed != compact && duration::nanoseconds(&pointed, Smallest::Nanosecond, Fraction::Last).is_ok() {
        return format!("a fraction has a point: write `{prefix}#{pointed}`");
    }
    match in_order(&compact) {
        Some(units) => format!("write `{prefix}#{units}`"),
        None => form.to_owned(),
    }
}

/// Numbers with their units, in descending order; none: a unit is unknown, or is there twice.
fn in_order(compact: &str) -> Option<String> {
    const UNITS: [(&str, &[&str]); 5] = [
        ("D", &["D", "DAY", "DAYS"]),
        ("H", &["H", "HR", "HOUR", "HOURS", "STD"]),
        ("M", &["M", "MIN", "MINUTE", "MINUTES"]),
        ("S", &["S", "SEC", "SECOND", "SECONDS", "SEK"]),
        ("MS", &["MS", "MSEC", "MILLISECONDS"]),
    ];
    let mut parts: Vec<(usize, &str)> = Vec::new();
    let mut rest = compact;
    while !rest.is_empty() {
        let letters = rest.find(|c: char| !c.is_ascii_digit()).filter(|at| *at > 0)?;
        let (number, tail) = rest.split_at(letters);
        let end = tail.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(tail.len());
        let unit = UNITS.iter().position(|(_, names)| names.contains(&&tail[..end]))?;
        if parts.iter().any(|(other, _)| *other == unit) {
            return None;
        }
        parts.push((unit, number));
        rest = &tail[end..];
    }
    parts.sort_unstable_by_key(|(unit, _)| *unit);
    let written: Vec<String> = parts.iter().map(|(unit, number)| format!("{number}{}", UNITS[*unit].0)).collect();
    (!written.is_empty()).then(|| written.join("_"))
}

/// `S5T#2s`: the finest time base that can represent the value; digits below it are cut off.
///
/// Bits 13-12: time base (10 ms, 100 ms, 1 s, 10 s); bits 11-0: three BCD digits.
/// Source: Programming with STEP 7, format of S5TIME.
pub fn s5time(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let ms = milliseconds(text, value, &form(text, value, S5TIME_FORM))?;
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
    let ms = milliseconds(text, value, &form(text, value, TIME_FORM))?;
    i32::try_from(ms).map(Literal::Time).map_err(|_| {
        LiteralError::range(text, "not a TIME", "a TIME is from T#-24D_20H_31M_23S_648MS to T#24D_20H_31M_23S_647MS")
    })
}

/// `D#2000-6-20`: days since 1990-01-01.
pub fn date(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let date = Date::parse(value).ok_or_else(|| bad(text, DATE_FORM))?;
    check_date(text, date)?;
    match date.days_since(1990) {
        Some(days) if date.year <= 2168 => Ok(Literal::Date(days as u16)),
        _ => Err(LiteralError::range(text, "not a DATE", "a DATE is from D#1990-1-1 to D#2168-12-31")),
    }
}

/// `TOD#5:45:00.5`: milliseconds since midnight.
pub fn time_of_day(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let clock = Clock::parse(value).ok_or_else(|| bad(text, TOD_FORM))?;
    check_time(text, clock)?;
    Ok(Literal::TimeOfDay(clock.milliseconds()))
}

/// `DT#1991-2-3-4:5:6.789`: eight BCD bytes, the last digit the weekday from 1 = Sunday.
///
/// Source: Programming with STEP 7, format of DATE_AND_TIME.
pub fn date_and_time(text: &str, value: &str) -> Result<Literal, LiteralError> {
    let malformed = || bad(text, DT_FORM);
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

fn bad(text: &str, help: &str) -> LiteralError {
    LiteralError::malformed(text, "not complete or not in order", help)
}

/// A duration as in `T#` and `S5T#`, with messages.
pub(crate) fn nanoseconds(
    text: &str,
    value: &str,
    smallest: Smallest,
    fraction: Fraction,
    form: &str,
) -> Result<i128, LiteralError> {
    duration::nanoseconds(value, smallest, fraction).map_err(|fault| match fault {
        Fault::Form => bad(text, form),
        Fault::Unit { number, unit } => LiteralError::range(
            text,
            format!("{number}{unit} after a larger unit"),
            "only the first unit may exceed its natural limit: `T#90S`, but `T#1M_30S`",
        ),
    })
}

/// As [`nanoseconds`] for literals of STEP 7: whole milliseconds, smaller parts are cut off.
fn milliseconds(text: &str, value: &str, form: &str) -> Result<i128, LiteralError> {
    Ok(nanoseconds(text, value, Smallest::Millisecond, Fraction::Anywhere, form)? / 1_000_000)
}

fn check_date(text: &str, date: Date) -> Result<(), LiteralError> {
    if date.exists() {
        return Ok(());
    }
    Err(LiteralError::range(text, "not a day of the calendar", "the order is year, month, day: `D#2000-6-20`"))
}

fn check_time(text: &str, clock: Clock) -> Result<(), LiteralError> {
    if clock.exists() {
        return Ok(());
    }
    Err(LiteralError::range(text, "not a time of day", "a time of day is from 0:0:0.0 to 23:59:59.999"))
}
