//! DTL, the date and time of the TIA Portal in 12 bytes: year (2), month, day, weekday, hour, minute, second, nanoseconds (4).
//!
//! Source: S7-1200 reference, date and time. The clock is the CPU's.

use jiff::civil::{Date, Time};

use super::parameters::Call;
use super::zone;
use super::{OK, Outcome, error};
use crate::datetime;

const NS_PER_MS: i64 = 1_000_000;
const MS_PER_DAY: i64 = 86_400_000;
/// Days from 1970-01-01 to 1990-01-01, where DATE begins.
const FIRST_DAY: i64 = 7305;
const YEARS: std::ops::RangeInclusive<u16> = 1970..=LAST_YEAR;
/// The year in which the moments end: the clock cannot be set to it.
const LAST_YEAR: u16 = 2262;

/// The moment of a DTL, up to 2262-04-11-23:47:16.854775807; `Err`: the error code of WR_SYS_T. The weekday does not count.
pub(crate) fn decode(bytes: [u8; 12]) -> Result<i64, u16> {
    let [year_high, year_low, month, day, _, hour, minute, second, ns @ ..] = bytes;
    let (year, ns) = (u16::from_be_bytes([year_high, year_low]), u32::from_be_bytes(ns));
    if !YEARS.contains(&year) {
        return Err(0x8081);
    }
    if !(1..=12).contains(&month) {
        return Err(0x8082);
    }
    let date = Date::new(year as i16, month as i8, i8::try_from(day).unwrap_or(0)).map_err(|_| 0x8083u16)?;
    for (value, limit, code) in [(hour, 23, 0x8084), (minute, 59, 0x8085), (second, 59, 0x8086)] {
        if value > limit {
            return Err(code);
        }
    }
    let ns = i32::try_from(ns).ok().filter(|&ns| ns <= 999_999_999).ok_or(0x8087u16)?;
    let time = Time::new(hour as i8, minute as i8, second as i8, ns).map_err(|_| 0x8087u16)?;
    datetime::moment_in_range(date.to_datetime(time)).ok_or(0x8081)
}

/// The moment of a DTL to which the clock is set; `Err` as from [`decode`].
fn clock_time(bytes: [u8; 12]) -> Result<i64, u16> {
    if u16::from_be_bytes([bytes[0], bytes[1]]) == LAST_YEAR {
        return Err(0x8081);
    }
    decode(bytes)
}

pub(crate) fn encode(moment: i64) -> [u8; 12] {
    let at = datetime::civil(moment);
    let [year_high, year_low] = (at.year() as u16).to_be_bytes();
    let weekday = at.date().weekday().to_sunday_one_offset() as u8;
    let [a, b, c, d] = (at.subsec_nanosecond() as u32).to_be_bytes();
    let (month, day) = (at.month() as u8, at.day() as u8);
    [year_high, year_low, month, day, weekday, at.hour() as u8, at.minute() as u8, at.second() as u8, a, b, c, d]
}

/// -> RET_VAL, OUT.
pub(super) fn read_clock(call: &Call) -> Outcome {
    call.set_dtl(1, encode(call.cpu.clock.wall()));
    OK
}

/// -> RET_VAL: 1 in daylight saving time, OUT.
pub(super) fn read_clock_local(call: &Call) -> Outcome {
    let (local, summer) = call.cpu.zone.get().local(call.cpu.clock.wall());
    call.set_dtl(1, encode(local));
    Outcome::RetVal(u16::from(summer))
}

/// IN -> RET_VAL: 8081 year to 8087 nanoseconds.
pub(super) fn set_clock(call: &Call) -> Outcome {
    match clock_time(call.dtl(0)) {
        Ok(moment) => {
            call.cpu.clock.set_wall(moment);
            call.cpu.wall_clock_was_set();
            OK
        }
        Err(code) => error(code),
    }
}

/// LOCTIME, DST -> RET_VAL, as [`set_clock`]; 8080, 8089 of [`zone::system_time`].
pub(super) fn set_clock_local(call: &Call) -> Outcome {
    let summer = call.byte(1) & 1 != 0;
    let system = clock_time(call.dtl(0)).and_then(|local| zone::system_time(&call.cpu.zone.get(), local, summer));
    match system {
        Ok(moment) => {
            call.cpu.clock.set_wall(moment);
            call.cpu.wall_clock_was_set();
            OK
        }
        Err(code) => error(code),
    }
}

/// Reads a DTL. An invalid one yields 1970-01-01 with an error.
fn give(call: &Call, index: usize, moment: Option<i64>) -> Outcome {
    call.set_dtl(index, encode(moment.unwrap_or(0)));
    Outcome::Flag(moment.is_some())
}

/// DATE, TIME_OF_DAY -> DTL.
pub(super) fn combine(call: &Call) -> Outcome {
    let ms = (FIRST_DAY + i64::from(call.word(0))) * MS_PER_DAY + i64::from(call.dword(1));
    give(call, 2, Some(ms * NS_PER_MS))
}

/// DTL -> DATE or TIME_OF_DAY.
fn split(call: &Call) -> Option<(u16, u32)> {
    let moment = decode(call.dtl(0)).ok()?;
    let (days, ms) = ((moment / NS_PER_MS).div_euclid(MS_PER_DAY), (moment / NS_PER_MS).rem_euclid(MS_PER_DAY));
    Some((u16::try_from(days - FIRST_DAY).ok()?, ms as u32))
}

/// DTL -> DATE.
pub(super) fn to_date(call: &Call) -> Outcome {
    let parts = split(call);
    call.set_word(1, parts.map_or(0, |(date, _)| date));
    Outcome::Flag(parts.is_some())
}

/// DTL -> TIME_OF_DAY.
pub(super) fn to_tod(call: &Call) -> Outcome {
    let moment = decode(call.dtl(0)).ok();
    call.set_dword(1, moment.map_or(0, |moment| (moment / NS_PER_MS).rem_euclid(MS_PER_DAY) as u32));
    Outcome::Flag(moment.is_some())
}

/// DATE -> DTL.
pub(super) fn from_date(call: &Call) -> Outcome {
    give(call, 1, Some((FIRST_DAY + i64::from(call.word(0))) * MS_PER_DAY * NS_PER_MS))
}

/// DATE_AND_TIME -> DTL.
pub(super) fn from_dt(call: &Call) -> Outcome {
    give(call, 1, datetime::decode(call.date_and_time(0)).ok())
}

/// DTL -> DATE_AND_TIME.
pub(super) fn to_dt(call: &Call) -> Outcome {
    let (bytes, limited) = super::dates::encode(decode(call.dtl(0)).unwrap_or(i64::MIN));
    call.set_date_and_time(1, bytes);
    Outcome::Flag(!limited)
}

/// LDT (ns since 1970) -> DTL.
pub(super) fn from_ldt(call: &Call) -> Outcome {
    give(call, 1, i64::try_from(call.lword(0)).ok())
}

/// DTL -> LDT.
pub(super) fn to_ldt(call: &Call) -> Outcome {
    let moment = decode(call.dtl(0)).ok();
    call.set_lword(1, moment.unwrap_or(0) as u64);
    Outcome::Flag(moment.is_some())
}

/// DTL, TIME, BACK -> DTL: IN1 + IN2, or with BACK IN1 - IN2.
pub(super) fn add(call: &Call) -> Outcome {
    step(call, i64::from(call.dword(1) as i32) * NS_PER_MS)
}

/// DTL, LTIME, BACK -> DTL, as [`add`].
pub(super) fn add_long(call: &Call) -> Outcome {
    step(call, call.lword(1) as i64)
}

fn step(call: &Call, ns: i64) -> Outcome {
    let moment = decode(call.dtl(0)).ok();
    let sum =
        moment.and_then(|moment| if call.byte(2) & 1 != 0 { moment.checked_sub(ns) } else { moment.checked_add(ns) });
    give(call, 3, sum.filter(|&sum| sum >= 0))
}

/// DTL, DTL -> TIME: IN1 - IN2.
pub(super) fn difference(call: &Call) -> Outcome {
    let ms = between(call).and_then(|ns| i32::try_from(ns / NS_PER_MS).ok());
    call.set_dword(2, ms.unwrap_or(0) as u32);
    Outcome::Flag(ms.is_some())
}

/// DTL, DTL -> LTIME: IN1 - IN2.
pub(super) fn long_difference(call: &Call) -> Outcome {
    let ns = between(call);
    call.set_lword(2, ns.unwrap_or(0) as u64);
    Outcome::Flag(ns.is_some())
}

/// Nanoseconds from the second DTL to the first; `None`: one is not a date.
fn between(call: &Call) -> Option<i64> {
    Some(decode(call.dtl(0)).ok()? - decode(call.dtl(1)).ok()?)
}
