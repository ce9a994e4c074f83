//! The time zone of the CPU: SET_TIMEZONE, and what RD_LOC_T and WR_LOC_T make of it.
//!
//! Local time is system time and a bias. In summer another bias is added, from a moment in local standard time to a moment in local daylight saving time.
//! Source: S7-1200 reference, date and time, SET_TIMEZONE.

use jiff::civil::{Date, Time, Weekday};

use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::datetime;

const NS_PER_MINUTE: i64 = 60_000_000_000;
/// Greatest bias, a day.
const BIAS_MAX: i16 = 1440;
/// Stands for the last week of a month.
const LAST_WEEK: u8 = 5;

/// When a season begins, in its own terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Switch {
    month: u8,
    /// 1 to 5; 5 is the last one.
    week: u8,
    /// 1 is Sunday.
    weekday: u8,
    hour: u8,
    minute: u8,
}

/// A time zone; the default is system time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Zone {
    bias_minutes: i16,
    /// 0: there is no daylight saving time.
    daylight_minutes: i16,
    daylight: Switch,
    standard: Switch,
}

impl Switch {
    /// The moment in `year`, in the local time that ends there.
    fn in_year(self, year: i16) -> Option<i64> {
        let weekday = Weekday::from_sunday_one_offset(self.weekday as i8).ok()?;
        let nth = if self.week == LAST_WEEK { -1 } else { self.week as i8 };
        let day = Date::new(year, self.month as i8, 1).ok()?.nth_weekday_of_month(nth, weekday).ok()?;
        let time = Time::new(self.hour as i8, self.minute as i8, 0, 0).ok()?;
        Some(datetime::moment(day.to_datetime(time)))
    }

    /// The place of the first value out of range.
    fn wrong(self) -> Option<u16> {
        let good = [
            (1..=12).contains(&self.month),
            (1..=LAST_WEEK).contains(&self.week),
            (1..=7).contains(&self.weekday),
            self.hour <= 23,
            self.minute <= 59,
        ];
        good.iter().position(|good| !good).map(|at| at as u16)
    }
}

impl Zone {
    /// Local time of a system time, and whether it is daylight saving time.
    pub fn local(&self, system: i64) -> (i64, bool) {
        let standard = system.saturating_add(i64::from(self.bias_minutes) * NS_PER_MINUTE);
        let summer = self.is_summer(standard);
        let extra = if summer { i64::from(self.daylight_minutes) * NS_PER_MINUTE } else { 0 };
        (standard.saturating_add(extra), summer)
    }

    /// System times with this local time: in standard time, and in daylight saving time.
    fn system(&self, local: i64) -> [Option<i64>; 2] {
        let bias = i64::from(self.bias_minutes) * NS_PER_MINUTE;
        let extra = i64::from(self.daylight_minutes) * NS_PER_MINUTE;
        [(0, false), (extra, true)].map(|(extra, summer)| {
            let system = local.checked_sub(bias)?.checked_sub(extra)?;
            (self.local(system) == (local, summer)).then_some(system)
        })
    }

    /// Whether it is summer at a local standard time.
    fn is_summer(&self, standard: i64) -> bool {
        if self.daylight_minutes == 0 {
            return false;
        }
        let year = datetime::civil(standard).year();
        let (Some(start), Some(end)) = (self.daylight.in_year(year), self.standard.in_year(year)) else { return false };
        let end = end - i64::from(self.daylight_minutes) * NS_PER_MINUTE;
        // South of the equator summer contains the turn of the year.
        if start < end { (start..end).contains(&standard) } else { !(end..start).contains(&standard) }
    }
}

/// The system time of a local time; `Err`: 8080 there is no daylight saving time, 8089 the hour that the change to it leaves out.
pub(super) fn system_time(zone: &Zone, local: i64, summer: bool) -> Result<i64, u16> {
    if zone.daylight_minutes == 0 && summer {
        return Err(0x8080);
    }
    match zone.system(local) {
        [Some(standard), Some(daylight)] => Ok(if summer { daylight } else { standard }),
        [one, other] => one.or(other).ok_or(0x8089),
    }
}

/// BIAS, DAYLIGHT, the begin of daylight saving time and that of standard time (month, week, weekday, hour in a double word; minute) -> 0, or 808x:
/// component x is wrong.
pub(super) fn set(call: &Call) -> Outcome {
    let switch = |word: usize, minute: usize| {
        let [month, week, weekday, hour] = call.dword(word).to_be_bytes();
        Switch { month, week, weekday, hour, minute: call.byte(minute) }
    };
    let zone = Zone {
        bias_minutes: call.word(0) as i16,
        daylight_minutes: call.word(1) as i16,
        daylight: switch(2, 3),
        standard: switch(4, 5),
    };
    let too_large = |minutes: i16| !(-BIAS_MAX..=BIAS_MAX).contains(&minutes);
    if too_large(zone.bias_minutes) {
        return error(0x8081);
    }
    if too_large(zone.daylight_minutes) {
        return error(0x8082);
    }
    if zone.daylight_minutes != 0 {
        for (switch, first) in [(zone.daylight, 0x8083), (zone.standard, 0x8088)] {
            if let Some(place) = switch.wrong() {
                return error(first + place);
            }
        }
    }
    call.cpu.zone.set(zone);
    OK
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> i64 {
        datetime::parse(text).expect("a date and time")
    }

    /// The last Sundays of March, 2 h, and October, 3 h.
    const EUROPE: Zone = Zone {
        bias_minutes: 60,
        daylight_minutes: 60,
        daylight: Switch { month: 3, week: 5, weekday: 1, hour: 2, minute: 0 },
        standard: Switch { month: 10, week: 5, weekday: 1, hour: 3, minute: 0 },
    };

    #[test]
    fn seasons_change_at_their_moment() {
        for (system, local, summer) in [
            ("2026-03-29T00:59:59", "2026-03-29T01:59:59", false),
            ("2026-03-29T01:00:00", "2026-03-29T03:00:00", true),
            ("2026-10-25T00:59:59", "2026-10-25T02:59:59", true),
            ("2026-10-25T01:00:00", "2026-10-25T02:00:00", false),
            ("2025-12-31T23:30:00", "2026-01-01T00:30:00", false),
        ] {
            assert_eq!(EUROPE.local(at(system)), (at(local), summer), "{system}");
        }
    }

    #[test]
    fn south_of_the_equator_summer_contains_the_turn_of_the_year() {
        let zone = Zone {
            bias_minutes: 600,
            daylight_minutes: 60,
            daylight: Switch { month: 10, week: 1, weekday: 1, hour: 2, minute: 0 },
            standard: Switch { month: 4, week: 1, weekday: 1, hour: 3, minute: 0 },
        };
        assert!(zone.local(at("2026-01-01T00:00:00")).1 && zone.local(at("2025-12-31T23:59:59")).1);
        assert!(!zone.local(at("2026-07-01T00:00:00")).1);
    }

    #[test]
    fn local_times_that_exist_twice_or_never() {
        let twice = at("2026-10-25T02:30:00");
        assert_eq!(system_time(&EUROPE, twice, true), Ok(at("2026-10-25T00:30:00")));
        assert_eq!(system_time(&EUROPE, twice, false), Ok(at("2026-10-25T01:30:00")));
        assert_eq!(system_time(&EUROPE, at("2026-03-29T02:30:00"), true), Err(0x8089));
        assert_eq!(system_time(&EUROPE, at("2026-07-01T12:00:00"), false), Ok(at("2026-07-01T10:00:00")));
        assert_eq!(system_time(&Zone::default(), twice, true), Err(0x8080));
    }
}
