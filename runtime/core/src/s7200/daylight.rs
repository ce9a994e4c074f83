//! Daylight-saving time of the clock. Source: S7-200 system manual, extended clock instructions.

use jiff::civil::{Date, DateTime, Time, Weekday};

use crate::bcd;
use crate::datetime::{self, NS_PER_S};

/// Bytes of the settings: mode, correction (hours, minutes), begin and end (month, day, hour, minute). BCD but for the mode.
pub const BYTES: usize = 11;

/// The mode in which the program sets start and end.
const USER: u8 = 0xFF;

/// A Sunday at full hour in standard time.
struct Sunday {
    month: i8,
    /// The n-th of the month; -1: the last.
    nth: i8,
    /// Only from this day of the month on.
    from_day: i8,
    hour: i8,
}

const fn sunday(nth: i8, month: i8, hour: i8) -> Sunday {
    Sunday { month, nth, from_day: 1, hour }
}

/// Begin and end in the modes of the CPU, in standard time. Europe changes at 1:00 UTC.
fn convention(mode: u8) -> Option<(Sunday, Sunday)> {
    Some(match mode {
        0x01 => (sunday(-1, 3, 1), sunday(-1, 10, 1)),
        0x02 => (sunday(-1, 3, 2), sunday(-1, 10, 2)),
        0x03 => (sunday(-1, 3, 3), sunday(-1, 10, 3)),
        0x08 => (sunday(-1, 3, 0), sunday(-1, 10, 0)),
        0x10 => (sunday(2, 3, 2), sunday(1, 11, 1)),
        0x11 => (sunday(-1, 10, 2), sunday(-1, 3, 2)),
        0x12 => (sunday(1, 10, 2), sunday(-1, 3, 2)),
        0x13 => (sunday(1, 10, 2), Sunday { month: 3, nth: 1, from_day: 15, hour: 2 }),
        _ => return None,
    })
}

impl Sunday {
    fn in_year(&self, year: i16) -> Option<DateTime> {
        let month = Date::new(year, self.month, 1).ok()?;
        let first = month.nth_weekday_of_month(self.nth, Weekday::Sunday).ok()?;
        let weeks_later = (i64::from(self.from_day) - i64::from(first.day()) + 6).max(0) / 7;
        let date = first.checked_add(jiff::Span::new().try_weeks(weeks_later).ok()?).ok()?;
        Some(date.to_datetime(Time::new(self.hour, 0, 0, 0).ok()?))
    }
}

/// Whether the settings are ones that the CPU takes.
pub fn is_valid(settings: [u8; BYTES]) -> bool {
    match settings[0] {
        0 => true,
        USER => User::of(settings).is_some(),
        mode => convention(mode).is_some(),
    }
}

/// The settings of the program in mode FF.
struct User {
    correction_ns: i64,
    begin: [i8; 4],
    /// By the corrected time.
    end: [i8; 4],
}

impl User {
    fn of(settings: [u8; BYTES]) -> Option<User> {
        let [
            _,
            hours,
            minutes,
            begin_month,
            begin_day,
            begin_hour,
            begin_minute,
            end_month,
            end_day,
            end_hour,
            end_minute,
        ] = settings;
        let number = |byte: u8, low: u8, high: u8| {
            bcd::byte_to_int(byte).filter(|value| (low..=high).contains(value)).map(|value| value as i8)
        };
        let moment = |[month, day, hour, minute]: [u8; 4]| {
            Some([number(month, 1, 12)?, number(day, 1, 31)?, number(hour, 0, 23)?, number(minute, 0, 59)?])
        };
        let minutes = i64::from(number(hours, 0, 23)?) * 60 + i64::from(number(minutes, 0, 59)?);
        Some(User {
            correction_ns: minutes * 60 * NS_PER_S,
            begin: moment([begin_month, begin_day, begin_hour, begin_minute])?,
            end: moment([end_month, end_day, end_hour, end_minute])?,
        })
    }
}

/// A day that the month does not have counts as its last one.
fn in_year(year: i16, [month, day, hour, minute]: [i8; 4]) -> Option<i64> {
    let first = Date::new(year, month, 1).ok()?;
    let date = Date::new(year, month, day.min(first.days_in_month())).ok()?;
    Some(datetime::moment(date.to_datetime(Time::new(hour, minute, 0, 0).ok()?)))
}

/// Nanoseconds by which the clock is ahead of standard time at the moment `standard`.
pub fn correction(settings: [u8; BYTES], standard: i64) -> i64 {
    let year = datetime::civil(standard).year();
    let (begin, end, ns) = match (convention(settings[0]), User::of(settings)) {
        (Some((begin, end)), _) => {
            let moment = |sunday: Sunday| sunday.in_year(year).map(datetime::moment);
            (moment(begin), moment(end), 3600 * NS_PER_S)
        }
        (None, Some(user)) if settings[0] == USER => {
            let end = in_year(year, user.end).map(|end| end.saturating_sub(user.correction_ns));
            (in_year(year, user.begin), end, user.correction_ns)
        }
        (None, _) => return 0,
    };
    let (Some(begin), Some(end)) = (begin, end) else { return 0 };
    // In the south it lasts over the turn of the year.
    let ahead = if begin <= end { (begin..end).contains(&standard) } else { standard >= begin || standard < end };
    if ahead { ns } else { 0 }
}

/// The moment in standard time at which the clock shows `shown`. Of a time that the clock shows twice, the first.
pub fn standard(settings: [u8; BYTES], shown: i64) -> i64 {
    let ahead = match (convention(settings[0]), User::of(settings)) {
        (Some(_), _) => 3600 * NS_PER_S,
        (None, Some(user)) if settings[0] == USER => user.correction_ns,
        (None, _) => 0,
    };
    let earlier = shown.saturating_sub(ahead);
    if correction(settings, earlier) == ahead { earlier } else { shown }
}
