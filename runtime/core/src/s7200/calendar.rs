//! TODR, TODW, TODRX, TODWX. Source: S7-200 system manual, clock instructions.
//!
//! The clock of the CPU runs in standard time; what the program reads and sets may be ahead of it. The CPU does not check what it is
//! set to against the calendar: 30 February is read back until midnight, then it is the day after 2 March, which it represents.

use std::cell::Cell;

use jiff::Span;
use jiff::civil::{Date, Time};
use plcc_abi::s7200::error;

use super::{Operands, access, daylight, done, failed};
use crate::cpu::Cpu;
use crate::{bcd, datetime};

const BUFFER_BYTES: u32 = 8;
const EXTENDED_BYTES: u32 = BUFFER_BYTES + daylight::BYTES as u32;

/// What the clock keeps in addition to the time.
#[derive(Default)]
pub struct Calendar {
    /// Settings of daylight-saving time.
    daylight: Cell<[u8; daylight::BYTES]>,
    /// Days by which the day of the week lags that of the calendar, 0 to 6.
    weekday_shift: Cell<u8>,
    /// Set to 0: the clock has no day of the week.
    no_weekday: Cell<bool>,
    /// A day that the clock was set to and that the calendar does not have: the day it means, month and day in BCD.
    day: Cell<Option<(Date, u8, u8)>>,
}

/// Numbers of a clock buffer.
struct Setting {
    year: i16,
    month: i8,
    day: i8,
    time: Time,
    /// 1 Sunday to 7 Saturday, 0: none.
    weekday: u8,
}

impl Setting {
    /// `None`: not BCD, or out of range. The byte that is 0 does not count.
    fn of(buffer: [u8; BUFFER_BYTES as usize]) -> Option<Setting> {
        let [year, month, day, hour, minute, second, _, weekday] = buffer;
        let number = |byte: u8, low: u8, high: u8| {
            bcd::byte_to_int(byte).filter(|value| (low..=high).contains(value)).map(|value| value as i8)
        };
        Some(Setting {
            year: 2000 + i16::from(number(year, 0, 99)?),
            month: number(month, 1, 12)?,
            day: number(day, 1, 31)?,
            time: Time::new(number(hour, 0, 23)?, number(minute, 0, 59)?, number(second, 0, 59)?, 0).ok()?,
            weekday: number(weekday, 0, 7)? as u8,
        })
    }

    /// The day of the calendar; days after the end of a month are of the next one.
    fn date(&self) -> Option<Date> {
        let first = Date::new(self.year, self.month, 1).ok()?;
        first.checked_add(Span::new().try_days(i64::from(self.day) - 1).ok()?).ok()
    }
}

/// 1 Sunday to 7 Saturday.
fn weekday_of(date: Date) -> u8 {
    date.weekday().to_sunday_one_offset() as u8
}

pub(super) fn read(cpu: &Cpu, operands: &Operands) -> u64 {
    read_clock(cpu, operands, BUFFER_BYTES)
}

pub(super) fn read_extended(cpu: &Cpu, operands: &Operands) -> u64 {
    read_clock(cpu, operands, EXTENDED_BYTES)
}

fn read_clock(cpu: &Cpu, operands: &Operands, bytes: u32) -> u64 {
    let buffer = operands.a;
    let Some(own) = cpu.s7200().filter(|_| access::inside(cpu, buffer, bytes)) else {
        return failed(cpu, operands, error::RANGE);
    };
    let (calendar, standard) = (&own.calendar, cpu.clock.wall());
    let shown = standard.saturating_add(daylight::correction(calendar.daylight.get(), standard));
    let date = datetime::civil(shown).date();
    let [year, mut month, mut day, hour, minute, second, ..] = datetime::encode(shown);
    if let Some((_, set_month, set_day)) = calendar.day.get().filter(|&(stands_for, ..)| stands_for == date) {
        (month, day) = (set_month, set_day);
    }
    let weekday = (weekday_of(date) - 1 + calendar.weekday_shift.get()) % 7 + 1;
    let weekday = if calendar.no_weekday.get() { 0 } else { weekday };
    cpu.memory.set_bytes(buffer, [year, month, day, hour, minute, second, 0, weekday]);
    if bytes == EXTENDED_BYTES {
        cpu.memory.set_bytes(buffer + BUFFER_BYTES, calendar.daylight.get());
    }
    access::after_write(cpu, buffer, bytes);
    done()
}

pub(super) fn set(cpu: &Cpu, operands: &Operands) -> u64 {
    set_clock(cpu, operands, BUFFER_BYTES)
}

pub(super) fn set_extended(cpu: &Cpu, operands: &Operands) -> u64 {
    set_clock(cpu, operands, EXTENDED_BYTES)
}

fn set_clock(cpu: &Cpu, operands: &Operands, bytes: u32) -> u64 {
    let buffer = operands.a;
    let Some(own) = cpu.s7200().filter(|_| access::inside(cpu, buffer, bytes)) else {
        return failed(cpu, operands, error::RANGE);
    };
    let calendar = &own.calendar;
    let settings =
        if bytes == EXTENDED_BYTES { cpu.memory.bytes(buffer + BUFFER_BYTES) } else { calendar.daylight.get() };
    let raw: [u8; BUFFER_BYTES as usize] = cpu.memory.bytes(buffer);
    let setting = Setting::of(raw).filter(|_| daylight::is_valid(settings));
    let Some((setting, date)) = setting.and_then(|setting| setting.date().map(|date| (setting, date))) else {
        return failed(cpu, operands, error::CLOCK_DATA);
    };
    calendar.daylight.set(settings);
    calendar.no_weekday.set(setting.weekday == 0);
    calendar.weekday_shift.set((setting.weekday + 7 - weekday_of(date)) % 7);
    let stands_for = (date.month(), date.day()) != (setting.month, setting.day);
    calendar.day.set(stands_for.then_some((date, raw[1], raw[2])));
    let shown = datetime::moment(date.to_datetime(setting.time));
    cpu.clock.set_wall(daylight::standard(settings, shown));
    cpu.wall_clock_was_set();
    done()
}
