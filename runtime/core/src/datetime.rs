//! DATE_AND_TIME and calendar steps.
//!
//! A moment of the wall clock is an `i64`: nanoseconds since 1970-01-01 00:00 in the CPU's own time, without time zone.

use jiff::civil::{Date, DateTime, Time};
use jiff::tz::Offset;
use jiff::{Span, Timestamp};

use crate::bcd;

pub const NS_PER_S: i64 = 1_000_000_000;
/// Where the wall clock of the virtual clock starts: 1994-01-01 00:00:00, as an S7 CPU without a backed-up clock.
pub const VIRTUAL_START: i64 = 757_382_400 * NS_PER_S;

/// The last DATE, 2168-12-31, in days since 1990-01-01. Source: STL reference, DATE.
pub const DATE_MAX: u16 = 65_378;

/// What is wrong with a DATE_AND_TIME.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DateTimeError {
    Date,
    Time,
}

/// Calendar form of a moment.
pub fn civil(moment: i64) -> DateTime {
    let timestamp = Timestamp::from_nanosecond(i128::from(moment)).unwrap_or(Timestamp::UNIX_EPOCH);
    Offset::UTC.to_datetime(timestamp)
}

/// The moment of a calendar form; 0 for one outside the years 1678..2262.
pub fn moment(datetime: DateTime) -> i64 {
    moment_in_range(datetime).unwrap_or(0)
}

/// The moment of a calendar form; `None` for one outside 1677-09-21 to 2262-04-11.
pub fn moment_in_range(datetime: DateTime) -> Option<i64> {
    let timestamp = Offset::UTC.to_timestamp(datetime).ok()?;
    i64::try_from(timestamp.as_nanosecond()).ok()
}

/// The eight bytes of a DATE_AND_TIME. Source: Programming with STEP 7, format of DATE_AND_TIME.
pub fn encode(moment: i64) -> [u8; 8] {
    let at = civil(moment);
    let two = |value: i64| bcd::from_int(value.unsigned_abs() as u32, 2) as u8;
    let weekday = at.date().weekday().to_sunday_one_offset() as u8;
    let bytes = [
        two(i64::from(at.year()) % 100),
        two(i64::from(at.month())),
        two(i64::from(at.day())),
        two(i64::from(at.hour())),
        two(i64::from(at.minute())),
        two(i64::from(at.second())),
        0,
        weekday,
    ];
    with_milliseconds(bytes, at.subsec_nanosecond().unsigned_abs() / 1_000_000)
}

/// A DATE_AND_TIME of a full second, with these milliseconds (0..=999) added.
pub fn with_milliseconds(second: [u8; 8], ms: u32) -> [u8; 8] {
    let digits = ms / 100 * 256 + ms / 10 % 10 * 16 + ms % 10;
    // The last four bits are the weekday.
    (u64::from_be_bytes(second) | u64::from(digits) << 4).to_be_bytes()
}

/// The moment of a DATE_AND_TIME; the weekday is ignored.
pub fn decode(bytes: [u8; 8]) -> Result<i64, DateTimeError> {
    let date_part = |index: usize| bcd::byte_to_int(bytes[index]).map(|value| value as i8).ok_or(DateTimeError::Date);
    let time_part = |index: usize| bcd::byte_to_int(bytes[index]).map(|value| value as i8).ok_or(DateTimeError::Time);
    let year = i16::from(date_part(0)?);
    let year = if year >= 90 { 1900 + year } else { 2000 + year };
    let date = Date::new(year, date_part(1)?, date_part(2)?).map_err(|_| DateTimeError::Date)?;
    if bytes[7] >> 4 > 9 {
        return Err(DateTimeError::Time);
    }
    let ms = i32::from(time_part(6)?) * 10 + i32::from(bytes[7] >> 4);
    let time =
        Time::new(time_part(3)?, time_part(4)?, time_part(5)?, ms * 1_000_000).map_err(|_| DateTimeError::Time)?;
    Ok(moment(date.to_datetime(time)))
}

/// Day of the month, from 1.
pub fn day(moment: i64) -> u8 {
    civil(moment).day().unsigned_abs()
}

/// Parses `2026-01-31T06:00:00`.
pub fn parse(text: &str) -> Option<i64> {
    text.trim().parse::<DateTime>().ok().map(moment)
}

/// How often a time-of-day interrupt comes, as the code of SFC 28.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Period {
    Once,
    Minute,
    Hour,
    Day,
    Week,
    Month,
    Year,
    EndOfMonth,
}

impl Period {
    /// Source: System and standard functions, OB 10.
    pub fn from_code(code: u16) -> Option<Period> {
        Some(match code {
            0x0000 => Period::Once,
            0x0201 => Period::Minute,
            0x0401 => Period::Hour,
            0x1001 => Period::Day,
            // The reference for STEP 7 V5 has 1201, that of the TIA Portal 1202.
            0x1201 | 0x1202 => Period::Week,
            0x1401 => Period::Month,
            0x1801 => Period::Year,
            0x2001 => Period::EndOfMonth,
            _ => return None,
        })
    }

    /// The moment `count` periods after `start`; `None` for `Once` and where the calendar ends. Monthly and yearly
    /// intervals count from the start, so that February does not change a 31st permanently.
    pub fn after(self, start: i64, count: i64) -> Option<i64> {
        let step = |span: Span| civil(start).checked_add(span).ok().map(moment);
        match self {
            Period::Once => None,
            Period::Minute => start.checked_add(count.checked_mul(60 * NS_PER_S)?),
            Period::Hour => start.checked_add(count.checked_mul(3600 * NS_PER_S)?),
            Period::Day => start.checked_add(count.checked_mul(86_400 * NS_PER_S)?),
            Period::Week => start.checked_add(count.checked_mul(7 * 86_400 * NS_PER_S)?),
            Period::Month => step(Span::new().try_months(count).ok()?),
            Period::Year => step(Span::new().try_years(count).ok()?),
            Period::EndOfMonth => {
                let at = civil(start).checked_add(Span::new().try_months(count).ok()?).ok()?;
                Some(moment(at.date().last_of_month().to_datetime(at.time())))
            }
        }
    }

    /// The first of the moments `start`, one period later, ... that is after `now`, with its number of periods.
    pub fn next_after(self, start: i64, now: i64) -> Option<(i64, i64)> {
        let first = if self == Period::EndOfMonth { self.after(start, 0)? } else { start };
        if first > now {
            return Some((first, 0));
        }
        // Estimated from below, then by single steps.
        let longest_s = match self {
            Period::Once => return None,
            Period::Minute => 60,
            Period::Hour => 3600,
            Period::Day => 86_400,
            Period::Week => 7 * 86_400,
            Period::Month | Period::EndOfMonth => 31 * 86_400,
            Period::Year => 366 * 86_400,
        };
        let mut count = (now.checked_sub(start)? / (longest_s * NS_PER_S)).max(0);
        loop {
            let at = self.after(start, count)?;
            if at > now {
                return Some((at, count));
            }
            count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn example_of_the_reference() {
        let bytes = [0x91, 0x02, 0x03, 0x04, 0x05, 0x06, 0x78, 0x91];
        let moment = decode(bytes).unwrap();
        assert_eq!(civil(moment).to_string(), "1991-02-03T04:05:06.789");
        assert_eq!(encode(moment), bytes);
    }

    #[test]
    fn bad_parts_are_told_apart() {
        assert_eq!(decode([0x91, 0x13, 0x03, 0, 0, 0, 0, 0]), Err(DateTimeError::Date));
        assert_eq!(decode([0x91, 0x02, 0x30, 0, 0, 0, 0, 0]), Err(DateTimeError::Date));
        assert_eq!(decode([0x91, 0x02, 0x03, 0x24, 0, 0, 0, 0]), Err(DateTimeError::Time));
        assert_eq!(decode([0x91, 0x02, 0x03, 0x1A, 0, 0, 0, 0]), Err(DateTimeError::Time));
        assert_eq!(decode([0x89, 0x12, 0x31, 0x23, 0x59, 0x59, 0x99, 0x97]).map(|m| civil(m).year()), Ok(2089));
    }

    #[test]
    fn monthly_on_the_last_days() {
        let start = parse("2026-01-31T06:00:00").unwrap();
        let end_of_month = |count| civil(Period::EndOfMonth.after(start, count).unwrap()).to_string();
        assert_eq!(end_of_month(1), "2026-02-28T06:00:00");
        assert_eq!(end_of_month(2), "2026-03-31T06:00:00");
        let now = parse("2026-03-01T00:00:00").unwrap();
        assert_eq!(Period::Minute.next_after(start, start), Some((start + 60 * NS_PER_S, 1)));
        assert_eq!(
            Period::Month.next_after(start, now).map(|(at, _)| civil(at).to_string()).unwrap(),
            "2026-03-31T06:00:00"
        );
        assert_eq!(Period::Once.next_after(start, now), None);
    }
}
