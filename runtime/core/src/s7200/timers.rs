//! Timers of an S7-200: TON, TONR, TOF with the update rules of 1, 10 and 100 ms. Source: S7-200 system manual, timer instructions.
//!
//! Value, bit and last input of a timer are in the system area. They show whether it runs: TON and TONR while their input is on, TOF while
//! its input is off and its bit still on. So clearing the three (R) stops the timer.
//!
//! | Resolution | Counts |
//! | --- | --- |
//! | 1 ms | whenever anyone looks, by the time since the last look |
//! | 10 ms | when a scan begins, by whole ticks; the box is not needed for it |
//! | 100 ms | when the box is executed, by the ticks between the last two starts of scans |

use std::cell::{Cell, RefCell};

use plcc_abi::layout;
use plcc_abi::s7200::{Resolution, TIMERS, TimerKind, is_retentive_timer, system, timer_resolution};

use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;
use crate::memory::Memory;
use crate::schedule::NEVER;

/// Timers of 1 ms.
pub(super) const OF_1_MS: [u32; 4] = [0, 32, 64, 96];
/// Timers of 1 ms that raise an event when they reach their preset, and the events.
const WITH_EVENT: [(u32, u8); 2] = [(32, 21), (96, 22)];
const LARGEST: i16 = i16::MAX;

/// Resolution of a timer that exists.
fn resolution(number: u32) -> Resolution {
    u8::try_from(number).map_or(Resolution::Ms100, timer_resolution)
}

/// True for the numbers of TONR, whose values are retentive.
fn is_retentive(number: u32) -> bool {
    u8::try_from(number).is_ok_and(is_retentive_timer)
}

/// Input and preset of a box of 1 or 10 ms when it was last executed.
#[derive(Default)]
struct LastBox {
    /// `None`: not executed since RUN began.
    kind: Cell<Option<TimerKind>>,
    preset: Cell<i16>,
    /// Millisecond up to which a timer of 1 ms has counted.
    synced: Cell<u64>,
}

/// State of timers outside the system area.
pub struct Timers {
    /// By number, as far as the numbers of 1 and 10 ms go.
    boxes: Vec<LastBox>,
    /// Timers of 1 and 10 ms whose boxes have run: only those count.
    seen: RefCell<Vec<u32>>,
    /// Ticks of 10 ms and 100 ms when the scan began.
    tick_10: Cell<u64>,
    tick_100: Cell<u64>,
}

impl Default for Timers {
    fn default() -> Timers {
        Timers {
            boxes: (0..=100).map(|_| LastBox::default()).collect(),
            seen: RefCell::default(),
            tick_10: Cell::new(0),
            tick_100: Cell::new(0),
        }
    }
}

impl Timers {
    fn last_box(&self, number: u32) -> Option<&LastBox> {
        self.boxes.get(number as usize)
    }
}

/// The three parts of a timer in the system area.
#[derive(Clone, Copy)]
struct Timer<'a> {
    memory: &'a Memory,
    number: u32,
}

impl Timer<'_> {
    fn value(self) -> i16 {
        self.memory.word(layout::SYSTEM + system::TIMER_VALUES + 2 * self.number) as i16
    }

    fn set_value(self, value: i16) {
        self.memory.set_word(layout::SYSTEM + system::TIMER_VALUES + 2 * self.number, value as u16);
    }

    fn bit(self) -> bool {
        self.memory.byte(layout::SYSTEM + system::TIMER_BITS + self.number) != 0
    }

    fn set_bit(self, on: bool) {
        self.memory.set_byte(layout::SYSTEM + system::TIMER_BITS + self.number, on.into());
    }

    fn input(self) -> bool {
        self.memory.byte(layout::SYSTEM + system::TIMER_INPUTS + self.number) != 0
    }

    fn set_input(self, on: bool) {
        self.memory.set_byte(layout::SYSTEM + system::TIMER_INPUTS + self.number, on.into());
    }

    fn is_running(self, kind: TimerKind) -> bool {
        match kind {
            TimerKind::Ton | TimerKind::Tonr => self.input(),
            TimerKind::Tof => !self.input() && self.bit(),
        }
    }

    /// Adds ticks to the running timer and renews its bit. Result: whether it reached its preset.
    fn count(self, kind: TimerKind, preset: i16, ticks: u64) -> bool {
        let old = self.value();
        let sum = i64::from(old) + ticks.min(u64::from(u16::MAX)) as i64;
        let new = i16::try_from(sum).unwrap_or(LARGEST);
        match kind {
            TimerKind::Ton | TimerKind::Tonr => {
                self.set_value(new);
                self.set_bit(new >= preset);
                old < preset && new >= preset
            }
            TimerKind::Tof if new >= preset => {
                // It is at its preset.
                self.set_value(old.max(preset));
                self.set_bit(false);
                true
            }
            TimerKind::Tof => {
                self.set_value(new);
                false
            }
        }
    }

    /// The box with its input on or off, after the timer has counted.
    fn switch(self, kind: TimerKind, preset: i16, enable: bool) {
        let was = self.input();
        self.set_input(enable);
        match (kind, enable) {
            (TimerKind::Ton | TimerKind::Tonr, true) if !was => self.set_bit(self.value() >= preset),
            (TimerKind::Ton | TimerKind::Tonr, true) | (TimerKind::Tonr, false) => {}
            (TimerKind::Ton, false) => {
                self.set_value(0);
                self.set_bit(false);
            }
            (TimerKind::Tof, true) => {
                self.set_value(0);
                self.set_bit(true);
            }
            (TimerKind::Tof, false) if was => {
                self.set_value(0);
                self.set_bit(preset > 0);
            }
            (TimerKind::Tof, false) => {}
        }
    }
}

fn kind_of(number: u32) -> Option<TimerKind> {
    [TimerKind::Ton, TimerKind::Tonr, TimerKind::Tof].into_iter().find(|kind| *kind as u32 == number)
}

impl Cpu {
    fn timer(&self, number: u32) -> Timer<'_> {
        Timer { memory: &self.memory, number }
    }

    fn millisecond(&self) -> u64 {
        self.clock.now() / NS_PER_MS
    }

    /// See [`RuntimeFn::S7200Timer`](plcc_abi::RuntimeFn::S7200Timer).
    pub(crate) fn s7200_timer(&self, number: u32, kind: u32, preset: i16, enable: bool) {
        let (Some(own), Some(kind)) = (self.s7200(), kind_of(kind)) else { return };
        if number >= TIMERS {
            return;
        }
        let timer = self.timer(number);
        match resolution(number) {
            Resolution::Ms1 => {
                self.s7200_timer_sync(number);
                // Its bit goes by the new preset from now on; a millisecond later it would anyway.
                if enable && timer.input() && kind != TimerKind::Tof {
                    timer.set_bit(timer.value() >= preset);
                }
            }
            Resolution::Ms10 => {}
            Resolution::Ms100 => {
                let stays = enable == timer.input();
                if stays && timer.is_running(kind) {
                    let ticks = self.memory.dword(layout::SYSTEM + system::TICKS_100_MS);
                    timer.count(kind, preset, u64::from(ticks));
                }
            }
        }
        timer.switch(kind, preset, enable);
        if let Some(last) = own.timers.last_box(number) {
            if last.kind.get().is_none() && resolution(number) != Resolution::Ms100 {
                own.timers.seen.borrow_mut().push(number);
            }
            last.kind.set(Some(kind));
            last.preset.set(preset);
            if WITH_EVENT.iter().any(|&(with_event, event)| with_event == number && self.s7200_is_attached(event)) {
                self.rearm();
            }
        }
    }

    /// See [`RuntimeFn::S7200TimerSync`](plcc_abi::RuntimeFn::S7200TimerSync). Other timers than those of 1 ms are always up to date.
    pub(crate) fn s7200_timer_sync(&self, number: u32) {
        if resolution(number) != Resolution::Ms1 {
            return;
        }
        let Some(last) = self.s7200().and_then(|own| own.timers.last_box(number)) else { return };
        let now = self.millisecond();
        let ticks = now.saturating_sub(last.synced.replace(now));
        let timer = self.timer(number);
        let Some(kind) = last.kind.get().filter(|&kind| ticks > 0 && timer.is_running(kind)) else { return };
        if timer.count(kind, last.preset.get(), ticks)
            && let Some(&(_, event)) = WITH_EVENT.iter().find(|(with_event, _)| *with_event == number)
        {
            self.s7200_event(event, None);
        }
    }

    /// RUN begins: no timer runs; values of TONR are kept.
    pub(super) fn s7200_start_timers(&self) {
        let Some(own) = self.s7200() else { return };
        self.memory.clear(layout::SYSTEM + system::TIMER_BITS, TIMERS);
        self.memory.clear(layout::SYSTEM + system::TIMER_INPUTS, TIMERS);
        for number in (0..TIMERS).filter(|&number| !is_retentive(number)) {
            self.timer(number).set_value(0);
        }
        own.timers.seen.borrow_mut().clear();
        for last in &own.timers.boxes {
            last.kind.set(None);
            last.synced.set(self.millisecond());
        }
        own.timers.tick_10.set(self.millisecond() / 10);
        own.timers.tick_100.set(self.millisecond() / 100);
    }

    /// A scan begins: timers of 10 ms count, the ticks for those of 100 ms are known.
    pub(super) fn s7200_scan_timers(&self) {
        let Some(own) = self.s7200() else { return };
        let now = self.millisecond();
        let ticks = (now / 10).saturating_sub(own.timers.tick_10.replace(now / 10));
        let seen = own.timers.seen.borrow();
        for &number in seen.iter().filter(|&&number| resolution(number) == Resolution::Ms10) {
            let (timer, Some(last)) = (self.timer(number), own.timers.last_box(number)) else { continue };
            if let Some(kind) = last.kind.get().filter(|&kind| timer.is_running(kind)) {
                timer.count(kind, last.preset.get(), ticks);
            }
        }
        let ticks = (now / 100).saturating_sub(own.timers.tick_100.replace(now / 100));
        self.memory.set_dword(layout::SYSTEM + system::TICKS_100_MS, u32::try_from(ticks).unwrap_or(u32::MAX));
        seen.iter().for_each(|&number| self.s7200_timer_sync(number));
    }

    /// When a timer next raises an event to which a routine is attached.
    pub(super) fn s7200_timers_due(&self) -> u64 {
        let Some(own) = self.s7200() else { return NEVER };
        let due = |&(number, event): &(u32, u8)| {
            let (timer, last) = (self.timer(number), own.timers.last_box(number)?);
            let kind = last.kind.get().filter(|&kind| self.s7200_is_attached(event) && timer.is_running(kind))?;
            let left = i64::from(last.preset.get()) - i64::from(timer.value());
            // TOF ends at the next tick at the latest if its preset has become smaller than its value.
            let left = if kind == TimerKind::Tof { left.max(1) } else { left };
            let left = u64::try_from(left).ok().filter(|&left| left > 0)?;
            Some(last.synced.get().saturating_add(left).saturating_mul(NS_PER_MS))
        };
        WITH_EVENT.iter().filter_map(due).min().unwrap_or(NEVER)
    }

    /// Timers with events count up to now.
    pub(super) fn s7200_poll_timers(&self) {
        WITH_EVENT.iter().filter(|(_, event)| self.s7200_is_attached(*event)).for_each(|&(number, _)| {
            self.s7200_timer_sync(number);
        });
    }
}
